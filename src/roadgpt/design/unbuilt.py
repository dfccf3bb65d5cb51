"""Names features that a Brief can ask for but no designer can build yet."""

from collections.abc import Iterator

from roadgpt.brief.amount import span
from roadgpt.brief.junctions import RAMPS, JunctionClause
from roadgpt.brief.model import Brief
from roadgpt.errors import DesignError
from roadgpt.network.ring import MOST_LANES as MOST_RING_LANES


def check_built(brief: Brief) -> None:
    """Checks that everything that a Brief asks for can be built.

    Raises:
        DesignError: Something cannot be built yet; the message names it.
    """
    if any(_crosses_oncoming(brief, n) for n in range(len(brief.junctions))):
        side = "right" if brief.left_hand else "left"
        raise DesignError(
            f"a ramp on the {side} would cross the oncoming lanes of its road, and bridges cannot be built "
            "yet; ask for a one-way road or for a ramp on the other side"
        )
    found = list(dict.fromkeys(_unbuilt(brief)))
    if found:
        *others, last = found
        named = f"{', '.join(others)} and {last}" if others else last
        raise DesignError(f"{named} cannot be built yet; leave {'them' if others else 'it'} out")


def _unbuilt(brief: Brief) -> Iterator[str]:
    for n, junction in enumerate(brief.junctions):
        yield from _of_junction(junction, *brief.stretches[n : n + 2])


def _crosses_oncoming(brief: Brief, number: int) -> bool:
    """Returns whether a junction is a ramp on the side of the oncoming lanes of its road."""
    ramp, roads = brief.junctions[number], brief.stretches[number : number + 2]
    if ramp.kind not in RAMPS or ramp.side != ("right" if brief.left_hand else "left"):
        return False
    main = roads if ramp.take == "main" else [roads[ramp.kind == "merge"]]
    return any(span(road.against).lo > 0 or road.divided for road in main)


def _of_junction(junction: JunctionClause, before: Brief, after: Brief) -> Iterator[str]:
    """Yields the features of a junction, and of the roads before and behind it, that cannot be built."""
    if junction.kind in RAMPS and junction.take != "main":
        ramp = before if junction.kind == "merge" else after
        if span(ramp.lanes).lo > 1 or span(ramp.against).lo > 0 or ramp.divided:
            yield "a ramp with several lanes or oncoming traffic"
    if junction.kind == "roundabout":
        lanes = [span(each).lo for road in (before, after) for each in (road.lanes, road.against)]
        if max(lanes) > min(span(junction.lanes).hi, MOST_RING_LANES):
            yield f"a roundabout with fewer lanes than the {max(lanes):g} of a road that it joins"
