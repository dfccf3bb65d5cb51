"""Divides the lanes of a road or of a network into lanelets, for formats that describe roads as chains of
lanelets.

Lanelets that lie side by side share the line between them. Consecutive lanelets of a lane share their end
points. A lane is left out of the sections in which it has no width."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from roadgpt.export.edges import line, stations
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.network import Network, RoadEnd, Route
from roadgpt.road import Profile, Road, World
from roadgpt.road.profile import Lane, Marking

LENGTH = 50.0  # m, approximate length of a section
LEAST = 1.0  # m, minimum length of a section
DECIMALS = 4  # of a metre
THIN = 0.05  # m; a lane that is nowhere wider than this in a section is left out of the section
ONLY = 0  # id of a road that is not part of a network


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
    road: int  # the id of the road; ``ONLY`` for a road that is not part of a network
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
    """Returns the lanelets of a road, or of the whole network of a route, road by road."""
    roads = {each.id: each.road for each in road.network.roads} if isinstance(road, Route) else {ONLY: road}
    pieces = _NumberedLanelets(roads, world)
    joined = _joined(pieces, road.network) if isinstance(road, Route) else []
    return list(pieces.lanelets(joined))


def leading_to(lanelets: Iterable[Lanelet], network: Network, end: RoadEnd) -> list[Lanelet]:
    """Returns the last lanelet of each lane that leads towards ``end``, one of the two ends of a road. The
    lanes are in order from the centre line outwards."""
    ids = network.road(end.road).ids_towards(end.contact)
    last = {each.lane: each for each in lanelets if each.road == end.road and not each.is_followed_on_road}
    return [last[lane] for lane in ids if lane in last]


class _NumberedLanelets:
    def __init__(self, roads: Mapping[int, Road], world: World) -> None:
        self.sections = {number: lanelet_sections(road, world) for number, road in roads.items()}
        self.profiles = {number: world.profile_of(road) for number, road in roads.items()}
        places = [
            (road, n, lane)
            for road, sections in self.sections.items()
            for lane in self._lanes(road)
            for n, each in enumerate(sections)
            if lane in each
        ]
        self.ids = {place: number for number, place in enumerate(places, 1)}

    def _lanes(self, road: int) -> list[int]:
        profile = self.profiles[road]
        return [*profile.along_ids, *profile.against_ids]

    def at(self, end: RoadEnd, lane: int) -> int | None:
        """Returns the id of the lanelet of a lane at one end of a road; None if it has no width there."""
        last = len(self.sections[end.road]) - 1
        return self.ids.get((end.road, 0 if end.contact == "start" else last, lane))

    def lanelets(self, joined: Iterable[tuple[int, int]]) -> Iterator[Lanelet]:
        """Yields the lanelets, lane by lane in the order in which they are driven.

        ``joined`` holds the pairs of ids of lanelets that follow each other from one road to another."""
        before, after = dict[int, list[int]](), dict[int, list[int]]()
        for one, other in joined:
            after.setdefault(one, []).append(other)
            before.setdefault(other, []).append(one)
        for road, sections in self.sections.items():
            for lane in self._lanes(road):
                is_along = self.profiles[road].leads_along(lane)
                step = 1 if is_along else -1
                for n in range(len(sections))[::step]:
                    number = self.ids.get((road, n, lane))
                    if number is None:
                        continue
                    own = [self.ids.get((road, n + way, lane)) for way in (-step, step)]
                    right, left = sections[n][lane]
                    yield Lanelet(
                        number,
                        road,
                        lane,
                        n,
                        left if is_along else right,
                        right if is_along else left,
                        is_along,
                        tuple([own[0]] if own[0] else before.get(number, ())),
                        tuple([own[1]] if own[1] else after.get(number, ())),
                        own[1] is not None,
                        (self._beside(road, n, lane, step), self._beside(road, n, lane, -step)),
                    )

    def _beside(self, road: int, n: int, lane: int, step: int) -> tuple[int, bool] | None:
        """Returns the id of the lanelet that shares a bound, and whether both lead in the same direction;
        None if there is none. ``step`` is 1 for the left neighbour as seen along the road, and -1 for the
        right one."""
        section, profile = self.sections[road][n], self.profiles[road]
        lanes = list(section)
        at = lanes.index(lane) + step
        if not 0 <= at < len(lanes):
            return None
        other, (right, left) = lanes[at], section[lane]
        # by identity: neighbours share the very bound, unless there is a median between them
        if (left if step > 0 else right) not in section[other]:
            return None
        return self.ids[road, n, other], profile.leads_along(other) == profile.leads_along(lane)


def _joined(pieces: _NumberedLanelets, network: Network) -> list[tuple[int, int]]:
    pairs: list[tuple[int | None, int | None]] = []
    for junction in network.junctions:
        for way in junction.connections:
            start, end = RoadEnd(way.road, "start"), RoadEnd(way.road, "end")
            for link in way.lanes:
                pairs.append((pieces.at(way.incoming, link.incoming), pieces.at(start, link.own)))
                pairs.append((pieces.at(end, link.own), pieces.at(way.outgoing, link.outgoing)))
    for each in network.continuations:
        for before, after in each.lanes:
            pair = pieces.at(each.before, before), pieces.at(each.after, after)
            is_along = before in network.road(each.before.road).ids_towards(each.before.contact)
            pairs.append(pair if is_along else pair[::-1])
    return [(one, other) for one, other in pairs if one is not None and other is not None]


def lanelet_sections(road: Road, world: World) -> list[LaneletSection]:
    """Returns the consecutive sections of a road from its start to its end; there is at least one."""
    profile = world.profile_of(road)
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
    edges, begin = profile.lane_edges(s), profile.sides(s)
    left_ids, right_ids = profile.along_ids, profile.against_ids
    if not profile.left_hand:
        left_ids, right_ids = right_ids, left_ids

    def bound(marking: Marking, t: Array) -> LaneletBound:
        return LaneletBound(np.round(line(road, s, t), DECIMALS) + 0.0, marking)

    first = bound(profile.centre_marking, begin.right)
    inner, lanes = first, LaneletSection()
    for lane, marking, t in _wide(right_ids, profile.right, edges[1], begin.right):
        outer = bound(marking, t)
        lanes[lane], inner = (outer, inner), outer
    lanes = dict(reversed(lanes.items()))
    inner = bound(profile.centre_marking, begin.left) if profile.median else first
    for lane, marking, t in _wide(left_ids, profile.left, edges[0], begin.left):
        outer = bound(marking, t)
        lanes[lane], inner = (inner, outer), outer
    return lanes


def _wide(
    ids: range, lanes: tuple[Lane, ...], edges: list[Array], begin: Array
) -> list[tuple[int, Marking, Array]]:
    """Returns the driving lanes of one side that have a width, from the centre line outwards: the id, the
    marking and the offsets of the outer edge."""
    inner = [begin, *edges]
    return [
        (lane, lanes[n].marking, edges[n])
        for n, lane in enumerate(ids)
        if np.abs(edges[n] - inner[n]).max() > THIN
    ]
