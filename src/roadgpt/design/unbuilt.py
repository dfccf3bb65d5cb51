"""Names features that a Brief can ask for but no designer can build yet."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, pairwise

from roadgpt.brief.amount import span
from roadgpt.brief.junctions import RAMPS, JunctionClause
from roadgpt.brief.model import Brief
from roadgpt.errors import DesignError
from roadgpt.language.names import JunctionKind
from roadgpt.plural import plural
from roadgpt.road.design import LanesDesign

TURNING_LANES: Mapping[JunctionKind, int] = {"t_junction": 1, "crossroads": 2}
"""For each kind of junction, how many lanes per direction can turn off there or come from the side."""


def check_built(brief: Brief) -> None:
    """Raises DesignError if a Brief asks for something that cannot be built yet; the message names it."""
    if any(_crosses_oncoming(brief, n) for n in range(len(brief.junctions))):
        side = "right" if brief.left_hand else "left"
        raise DesignError(
            f"a ramp on the {side} would cross the oncoming lanes of its road, and bridges cannot be built "
            "yet; ask for a one-way road or for a ramp on the other side"
        )
    every = (_unbuilt(place, *brief.stretches[n : n + 2]) for n, place in enumerate(brief.junctions))
    *others, last = dict.fromkeys(chain.from_iterable(every)) or [""]
    if last:
        named = f"{', '.join(others)} and {last}" if others else last
        raise DesignError(f"{named} cannot be built yet; leave {'them' if others else 'it'} out")


def check_lanes_across(places: Sequence[JunctionClause], lanes: Sequence[LanesDesign]) -> None:
    """Raises DesignError if a lane of a road leads nowhere at a junction where a route goes straight on.
    Lanes that do not continue there turn off, or come from the side: one to the left and one to the right at
    most. ``lanes`` are those of each road before, between and behind the ``places``."""
    for place, (before, behind) in zip(places, pairwise(lanes), strict=True):
        most = TURNING_LANES.get(place.kind) if place.take == "straight" else None
        pairs = (before.forward, behind.forward), (before.backward, behind.backward)
        more = max((abs(one - other) for one, other in pairs if one and other), default=0)
        if most is not None and more > most:
            raise DesignError(
                f"straight on over a {place.name}, the roads before and behind it can differ by "
                f"{plural(most, 'lane')} in each direction, which turn off or join there, and not by {more}; "
                "give the roads more equal numbers of lanes, or let lanes end before it (lane_drop) or begin "
                "behind it (lane_gain)"
            )


def _crosses_oncoming(brief: Brief, number: int) -> bool:
    ramp, roads = brief.junctions[number], brief.stretches[number : number + 2]
    if ramp.kind not in RAMPS or ramp.side != ("right" if brief.left_hand else "left"):
        return False
    main = roads if ramp.take == "main" else [roads[ramp.kind == "merge"]]
    return any(span(road.against).lo > 0 or road.divided for road in main)


def _unbuilt(junction: JunctionClause, before: Brief, after: Brief) -> Iterator[str]:
    if junction.kind in RAMPS and junction.take != "main":
        ramp = before if junction.kind == "merge" else after
        if span(ramp.lanes).lo > 1 or span(ramp.against).lo > 0 or ramp.divided:
            yield "a ramp with several lanes or oncoming traffic"
    if junction.kind == "roundabout":
        from roadgpt.network.building import MOST_LANES as MOST_RING_LANES

        lanes = [span(each).lo for road in (before, after) for each in (road.lanes, road.against)]
        if junction.size == "mini" and max(lanes) > 1:
            yield "a mini roundabout on a road with several lanes in one direction"
        elif max(lanes) > min(span(junction.lanes).hi, MOST_RING_LANES):
            yield f"a roundabout with fewer lanes than the {max(lanes):g} of a road that it joins"
