"""Divides the lanes of a road or of a network into lanelets, for formats that describe roads as chains of
lanelets.

Lanelets that lie side by side share the line between them. Consecutive lanelets of a lane share their end
points. A lane is left out of the sections in which it has no width."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.network import Arm, Junction, Leg, Network, network_of
from roadgpt.network.lanes import lanes_of
from roadgpt.road import Profile, Road, World
from roadgpt.road.edges import line, stations
from roadgpt.road.profile import Marking

LENGTH = 50.0  # m, approximate length of a section
LEAST = 1.0  # m, minimum length of a section
DECIMALS = 4  # of a metre
THIN = 0.05  # m; a lane that is nowhere wider than this in a section is left out of the section


@dataclass(frozen=True, eq=False)
class LaneletBound:
    """A line between two lanes, or at an edge of the carriageway: a polyline ``(n, 3)`` along the road."""

    points: Array
    marking: Marking


LaneletSection = dict[int, tuple[LaneletBound, LaneletBound]]
"""The driving lanes of one section of a road, from right to left. Maps the id of a lane in OpenDRIVE to the
right and the left bound of the lane, as seen along the road. Neighbouring lanes share a bound, except across
a median."""


@dataclass(frozen=True, eq=False)
class Lanelet:
    """A piece of a lane. Left, right, before and after are as seen by those who drive on the lane."""

    id: int
    road: int  # the id of the road
    lane: int  # the id of the lane, as in OpenDRIVE
    section: int  # the index of the section, counted from the start of the road
    left: LaneletBound
    right: LaneletBound
    is_along: bool
    """Whether the lane is driven along the road. If not, the points of the bounds run against the traffic."""
    before: tuple[int, ...]  # the ids of the lanelets that lead to this lanelet
    after: tuple[int, ...]  # the ids of the lanelets to which this lanelet leads
    is_followed_on_road: bool
    """Whether the lane continues in the next section of the road, in driving direction."""
    beside: tuple[tuple[int, bool] | None, tuple[int, bool] | None]
    """For the left and for the right side, the id of the neighbouring lanelet and whether its traffic drives
    in the same direction; None if there is no neighbour."""


def lanelets_of(road: Road, world: World) -> list[Lanelet]:
    """Returns the lanelets of the whole network of a road or a route, road by road, and on each road lane by
    lane in the order in which they are driven."""
    network = network_of(road, world)
    lanes, found = lanes_of(network), list[Lanelet]()
    sections = {each.id: lanelet_sections(each.road, each.profile) for each in network.roads}
    driven = [
        Leg(each.id, lane)
        for each in network.roads
        for lane in (*each.profile.along_ids, *each.profile.against_ids)
    ]
    places = [(leg, n) for leg in driven for n, own in enumerate(sections[leg.road]) if leg.lane in own]
    ids = {place: number for number, place in enumerate(places, 1)}

    def ends(leg: Leg) -> tuple[int, int]:
        last = len(sections[leg.road]) - 1
        return (0, last) if lanes[leg].is_along else (last, 0)

    def joined(legs: Sequence[Leg], which: int) -> tuple[int, ...]:
        """Returns the first (0) or the last (1) lanelet of lanes that have a width there."""
        return tuple(ids[leg, ends(leg)[which]] for leg in legs if (leg, ends(leg)[which]) in ids)

    def beside(leg: Leg, n: int, step: int) -> tuple[int, bool] | None:
        """Returns the neighbour to the left as seen along the road, or with ``step`` -1 to the right."""
        section = sections[leg.road][n]
        row = list(section)
        at = row.index(leg.lane) + step
        # by identity: neighbours share the very bound, unless there is a median between them
        if not 0 <= at < len(row) or section[leg.lane][step > 0] not in section[row[at]]:
            return None
        other = Leg(leg.road, row[at])
        return ids[other, n], lanes[other].is_along == lanes[leg].is_along

    for leg in driven:
        lane, (first, last) = lanes[leg], ends(leg)
        step = 1 if lane.is_along else -1
        for n in range(first, last + step, step):
            if (leg, n) not in ids:
                continue
            right, left = sections[leg.road][n][leg.lane]
            before, after = ids.get((leg, n - step)), ids.get((leg, n + step))
            found.append(
                Lanelet(
                    ids[leg, n],
                    *leg,
                    n,
                    *((left, right) if lane.is_along else (right, left)),
                    lane.is_along,
                    (before,) if before else joined(lane.predecessors, 1) if n == first else (),
                    (after,) if after else joined(lane.successors, 0) if n == last else (),
                    after is not None,
                    (beside(leg, n, step), beside(leg, n, -step)),
                )
            )
    return found


def arms_of(network: Network, lanelets: Iterable[Lanelet]) -> list[tuple[Junction, Arm, list[Lanelet]]]:
    """Returns the arms of all junctions, each with the last lanelets of the lanes that lead there, from the
    centre line outwards. An arm to which no lanelet leads is left out."""
    last = {(each.road, each.lane): each for each in lanelets if not each.is_followed_on_road}
    arms = [(junction, arm) for junction in network.junctions for arm in junction.arms]
    keys = [[(arm.end.road, lane) for lane in network.lanes_into(arm.end)] for _, arm in arms]
    found = [(*arm, [last[key] for key in own if key in last]) for arm, own in zip(arms, keys, strict=True)]
    return [each for each in found if each[2]]


def lanelet_sections(road: Road, profile: Profile) -> list[LaneletSection]:
    """Returns the consecutive sections of a road from its start to its end; there is at least one."""
    fine = stations(road, profile.paved_reach)
    count = max(1, round(road.length / LENGTH))
    cuts = _with_ends_of_lanes(np.linspace(0.0, road.length, count + 1), profile)
    out = []
    for start, end in zip(cuts.tolist(), cuts[1:].tolist(), strict=False):
        s = np.r_[start, fine[(fine > start + 1e-3) & (fine < end - 1e-3)], end]
        out.append(_section(road, profile, s))
    return out


def _with_ends_of_lanes(cuts: Array, profile: Profile) -> Array:
    lanes = [lane for side in (profile.right, profile.left) for lane in side if lane.kind == "driving"]
    widths = [lane.width for lane in lanes]
    for width in (width for width in widths if isinstance(width, CubicProfile)):
        ends = [s for s in width.stations if abs(float(width.height(s))) < THIN / 10]
        for s in (s for s in ends if np.abs(cuts - s).min() > LEAST and cuts[0] < s < cuts[-1]):
            cuts = np.sort(np.r_[cuts, s])
    return cuts


def _section(road: Road, profile: Profile, s: Array) -> LaneletSection:
    def bound(marking: Marking, t: Array) -> LaneletBound:
        return LaneletBound(np.round(line(road, s, t), DECIMALS) + 0.0, marking)

    centre = bound(profile.centre_marking, profile.centre(s))
    sides = list[LaneletSection]()
    for sign, side, count in zip((1, -1), (profile.left, profile.right), profile.carriageway, strict=True):
        inner, lanes = centre, LaneletSection()
        for number, lane in enumerate(side[: max(count, 0)], 1):
            left, right = profile.edges_of(sign * number, s)
            if np.abs(left - right).max() > THIN:
                outer = bound(lane.marking, left if sign > 0 else right)
                if lane.kind == "driving":
                    lanes[sign * number] = (inner, outer) if sign > 0 else (outer, inner)
                inner = outer
        sides.append(lanes)
    left_lanes, right_lanes = sides
    return {**dict(reversed(right_lanes.items())), **left_lanes}
