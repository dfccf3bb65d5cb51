"""The lanes of a network: where they lead, what lies beside them, where they meet, and who gives way there.

Everything here is derived from the roads and junctions of a Network; ``lanes_of`` computes it once. A
lane is driven from its start to its end, whatever the direction of its road: its station ``s`` is the
distance in metres along its middle, and its offset ``t`` is positive to the left of the traffic in it."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from heapq import heappop, heappush
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.geometry import wrap_angle
from roadgpt.geometry.curve import Array
from roadgpt.language.names import Control
from roadgpt.network.markings import STOP_LINE, gives_way_to_ring, line_before
from roadgpt.network.network import Connection, Junction, Leg, Network, NetworkRoad, RoadEnd
from roadgpt.network.paved import GRID, stations_of
from roadgpt.road.profile import Kind

if TYPE_CHECKING:
    from shapely import Polygon, STRtree

STEP = 0.25  # m, between the stations at which the length of a lane is summed up
TOUCH = 0.01  # m^2; lanes that share less than this lie beside or behind each other
HEADROOM = 2.5  # m; a lane this far above another one passes over it
STRAIGHT_AHEAD = math.radians(30.0)  # a way through a junction that turns by less is neither left nor right
OPPOSITE = math.radians(135.0)  # two ways whose headings at the entry differ by more come from opposite arms
RANK: Mapping[Control, int] = {"priority": 2, "lights": 1, "none": 1, "yield": 0, "stop": 0}
"""Of two ways with different ranks, the one with the lower rank gives way (Vienna Convention on Road Signs
and Signals, 1968, Annex 1, B 1 to B 4)."""
CROSSED = ("broken", "none")  # markings that a car may cross to change lanes
Cost = tuple[float, float]
"""What a way costs: the smaller first number is better and, where both are equal, the smaller second one."""
State = TypeVar("State", bound=tuple[Any, ...])


class LanePlace(NamedTuple):
    """A place in a lane."""

    lane: "Lane"
    s: float  # m along the middle of the lane from its start
    t: float  # m to the left of the middle


class Overlap(NamedTuple):
    """Where the areas of two lanes meet: on each, the stations in metres of the first and last common
    point."""

    own: tuple[float, float]
    others: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Lane:
    """One lane of one road of a network, or one strip beside the lanes."""

    id: Leg
    """The id of the road, and OpenDRIVE's id of the lane on it."""
    kind: Kind
    member: NetworkRoad
    is_along: bool
    """Whether the lane is driven in the direction of its road's reference line."""
    left: Leg | None
    """The lane of the same direction to the left; None if there is none."""
    right: Leg | None
    may_change_left: bool
    """Whether the marking between this lane and ``left`` may be crossed."""
    may_change_right: bool
    verge: Leg | None
    """The strip outside the driving lanes of this direction, such as a shoulder or a sidewalk, which its kind
    says; None for a strip, or if there is none."""
    successors: tuple[Leg, ...] = ()
    """The lanes that continue this one, in the order of their junction's connections."""
    predecessors: tuple[Leg, ...] = ()
    control: Control = "none"
    """The sign or light that traffic in the lane meets at its end."""
    before_line: float | None = None
    """The distance in metres from the end of the road to the near edge of the line at which traffic stops or
    gives way; None if there is no line on this road."""

    def __repr__(self) -> str:
        return f"Lane({self.id.road}, {self.id.lane}, {self.kind}, {self.length:.1f} m)"

    def _edges(self, station: ArrayLike) -> tuple[Array, Array]:
        """Returns the offsets from the reference line of the inner and the outer edge."""
        left, right = self.member.profile.edges_of(self.id.lane, station)
        return (right, left) if self.id.lane > 0 else (left, right)

    @cached_property
    def _along(self) -> tuple[Array, Array]:
        """Stations of the road in the direction of its reference line, and the length of the lane from the
        first one to each."""
        road = self.member.road
        station = np.linspace(0.0, road.length, max(2, math.ceil(road.length / STEP) + 1))
        inner, outer = self._edges(station)
        steps = np.diff(road.at(station, (inner + outer) / 2)[:, :2], axis=0)
        lengths = np.hypot(steps[:, 0], steps[:, 1])
        return station, np.r_[0.0, np.cumsum(lengths)]

    @cached_property
    def length(self) -> float:
        """The length of the middle of the lane in metres, seen from above."""
        return float(self._along[1][-1])

    def station(self, s: ArrayLike) -> Array:
        """Returns the stations on the road of stations of the lane."""
        road, own = self._along
        forward = np.asarray(s, float)
        return np.interp(forward if self.is_along else self.length - forward, own, road)

    def _own_station(self, station: ArrayLike) -> Array:
        road, own = self._along
        s = np.interp(np.asarray(station, float), road, own)
        return np.asarray(s if self.is_along else self.length - s)

    def width(self, s: ArrayLike) -> Array:
        """Returns widths in metres."""
        inner, outer = self._edges(self.station(s))
        return np.abs(outer - inner)

    def at(self, s: ArrayLike, t: ArrayLike = 0.0) -> Array:
        """Returns points ``(..., 3)`` in metres at stations and offsets of the lane."""
        station = self.station(s)
        inner, outer = self._edges(station)
        aside = np.asarray(t, float) * (1.0 if self.is_along else -1.0)
        return self.member.road.at(station, (inner + outer) / 2 + aside)

    def heading(self, s: ArrayLike) -> Array:
        """Returns the headings in radians of traffic in the lane."""
        found = self.member.road.heading(self.station(s))
        return found if self.is_along else wrap_angle(found + np.pi)

    def locate(self, x: ArrayLike, y: ArrayLike) -> tuple[Array, Array]:
        """Returns the stations and offsets of points given in plan, projected onto the road."""
        station, offset = self.member.road.locate(x, y)
        inner, outer = self._edges(station)
        t = offset - (inner + outer) / 2
        return self._own_station(station), t if self.is_along else -t

    @property
    def stop(self) -> float | None:
        """The station at which the front of a stopping car comes to rest; None if there is no line."""
        if self.before_line is None:
            return None
        before = min(self.before_line, self.member.road.length)
        return float(self._own_station(self.member.road.length - before if self.is_along else before))

    @cached_property
    def area(self) -> "Polygon":
        """The area of the lane seen from above."""
        import shapely

        road = self.member.road
        station = stations_of(road)
        inner, outer = (road.at(station, t)[:, :2] for t in self._edges(station))
        ring = np.round(np.concatenate((inner, outer[::-1])) / GRID) * GRID
        return shapely.make_valid(shapely.Polygon(ring))

    @cached_property
    def turn(self) -> float:
        """The change of heading in radians from the start to the end, positive to the left; at most pi."""
        return float(wrap_angle(self.heading(self.length) - self.heading(0.0)))


@dataclass(frozen=True, eq=False)
class Lanes:
    """All lanes of a network, by their ids."""

    network: Network
    _meetings: dict[tuple[Leg, Leg], Overlap | None] = field(default_factory=dict, repr=False)

    @cached_property
    def by_id(self) -> Mapping[Leg, Lane]:
        """The lanes in the order of the roads, on each from the left to the right of its reference line."""
        following, ends = self.network.following, _ends(self.network)
        preceding: dict[Leg, list[Leg]] = {}
        for one, others in following.items():
            for other in others:
                preceding.setdefault(other, []).append(one)
        return {
            lane.id: lane
            for member in self.network.roads
            for lane in _of_road(member, following, preceding, ends)
        }

    def __getitem__(self, key: Leg) -> Lane:
        return self.by_id[key]

    def __iter__(self) -> Iterator[Lane]:
        return iter(self.by_id.values())

    def __len__(self) -> int:
        return len(self.by_id)

    @cached_property
    def _tree(self) -> "tuple[STRtree, list[Lane]]":
        import shapely

        lanes = list(self)
        return shapely.STRtree([lane.area for lane in lanes]), lanes

    def places(self, points: ArrayLike) -> list[tuple[LanePlace, ...]]:
        """Returns the places of points ``(n, 2)`` in metres: for each, one in every lane that holds it.
        Inside junctions several lanes may hold a point, and outside of all lanes none does."""
        import shapely

        points = np.asarray(points, float).reshape(-1, 2)
        tree, lanes = self._tree
        which, found = tree.query(shapely.points(points), predicate="intersects")
        out: list[list[LanePlace]] = [[] for _ in points]
        for number in np.unique(found):
            lane, own = lanes[number], which[found == number]
            for point, s, t in zip(own, *lane.locate(*points[own].T), strict=True):
                out[point].append(LanePlace(lane, float(s), float(t)))
        return [tuple(each) for each in out]

    def shortest(
        self, start: Leg, goal: Leg, least: Literal["length", "changes"] = "length"
    ) -> list[Leg] | None:
        """Returns the lanes of the shortest way from one lane to another one, both included; None if no way
        leads there. A change to the neighbouring lane is one step of the way. ``length`` counts the metres of
        all lanes that are driven to their end, and ``changes`` first the changes of lane."""

        def steps(here: Leg) -> Iterator[tuple[Leg, Cost]]:
            lane = self.by_id[here]
            for each in lane.successors:
                yield each, (lane.length, 0.0) if least == "length" else (0.0, lane.length)
            for beside, may in ((lane.left, lane.may_change_left), (lane.right, lane.may_change_right)):
                if beside is not None and may:
                    yield beside, (0.0, 1.0) if least == "length" else (1.0, 0.0)

        return cheapest([start], lambda here: here == goal, steps)

    def ahead(self, start: Leg, s: float, metres: float) -> list[tuple[Leg, ...]]:
        """Returns every way on from station ``s`` of a lane, without changes of lane, as long as it is needed
        to get ``metres`` ahead, or until its lane ends."""
        found: list[tuple[Leg, ...]] = []
        open_ways: list[tuple[tuple[Leg, ...], float]] = [((start,), self.by_id[start].length - s)]
        while open_ways:
            way, driven = open_ways.pop()
            onward = self.by_id[way[-1]].successors if driven < metres else ()
            if not onward:
                found.append(way)
            open_ways += [((*way, each), driven + self.by_id[each].length) for each in reversed(onward)]
        return found

    def meeting(self, one: Leg, other: Leg) -> Overlap | None:
        """Returns where the areas of two lanes meet; None if they do not, or only along a common edge or end,
        or where one passes over the other."""
        if (one, other) not in self._meetings:
            found = self._met(self.by_id[one], self.by_id[other])
            self._meetings[one, other] = found
            self._meetings[other, one] = None if found is None else Overlap(found.others, found.own)
        return self._meetings[one, other]

    def _met(self, one: Lane, other: Lane) -> Overlap | None:
        import shapely

        common = shapely.intersection(one.area, other.area)
        parts = [part for part in shapely.get_parts(common) if part.area > TOUCH]
        if one.id == other.id or not parts:
            return None
        points = np.concatenate([np.asarray(part.exterior.coords, float) for part in parts])
        (s, _), (s_other, _) = one.locate(*points.T), other.locate(*points.T)
        apart = np.abs(one.at(s)[:, 2] - other.at(s_other)[:, 2])
        if apart.min() > HEADROOM:
            return None
        return Overlap((float(s.min()), float(s.max())), (float(s_other.min()), float(s_other.max())))

    def met_by(self, key: Leg) -> tuple[Leg, ...]:
        """Returns the driving lanes whose areas meet that of a lane, in the order of ``by_id``."""
        tree, lanes = self._tree
        near = np.sort(tree.query(self.by_id[key].area, predicate="intersects"))
        others = (lanes[number] for number in near)
        return tuple(
            each.id for each in others if each.kind == "driving" and self.meeting(key, each.id) is not None
        )

    def gives_way_to(self, key: Leg) -> tuple[Leg, ...]:
        """Returns the lanes to whose traffic the traffic in a lane gives way. Where a lane ends, as one for
        acceleration does, it gives way to those beside it that go on. All others are lanes of a junction.

        The signs decide: an arm with a sign to give way or to stop gives way to arms without one, and those
        to an arm with priority; in a roundabout, the arms give way to the ring. Where the signs are the same,
        who turns across the oncoming traffic gives way to it, and otherwise, unless there are lights, who has
        the other one on the side on which traffic drives (Vienna Convention on Road Traffic, 1968, articles
        16 and 18)."""
        if (found := self.network.connection_of.get(key.road)) is None:
            lane = self.by_id[key]
            beside = () if lane.successors else (lane.left, lane.right)
            return tuple(each for each in beside if each is not None and self.by_id[each].successors)
        junction, own = found
        return tuple(
            other
            for other in self.met_by(key)
            if (known := self.network.connection_of.get(other.road)) is not None
            and known[0].id == junction.id
            and known[1].incoming != own.incoming
            and self._yields(junction, (key, own), (other, known[1]))
        )

    def _yields(self, junction: Junction, own: tuple[Leg, Connection], other: tuple[Leg, Connection]) -> bool:
        ranks = [self._rank(junction, way.incoming) for _, way in (own, other)]
        if ranks[0] != ranks[1]:
            return ranks[0] < ranks[1]
        one, two = self.by_id[own[0]], self.by_id[other[0]]
        side = -1.0 if self.network.left_hand else 1.0
        between = float(wrap_angle(two.heading(0.0) - one.heading(0.0))) * side
        if abs(between) > OPPOSITE:
            return one.turn * side > STRAIGHT_AHEAD > two.turn * side
        controls = {arm.end: arm.control for arm in junction.arms}
        has_lights = "lights" in (controls[own[1].incoming], controls[other[1].incoming])
        return between > 0.0 and not has_lights  # who comes from the right heads to the left of this lane

    def _rank(self, junction: Junction, end: RoadEnd) -> int:
        ring = self.network.roundabout_of.get(junction.id)
        if ring is not None and end.road in ring.ring:
            return max(RANK.values()) + 1
        return RANK[next(arm.control for arm in junction.arms if arm.end == end)]


def cheapest(
    starts: Iterable[State],
    is_goal: Callable[[State], bool],
    steps: Callable[[State], Iterable[tuple[State, Cost]]],
) -> list[State] | None:
    """Returns the states of the cheapest way from one of the starts to a goal, both included; None if no way
    leads there. ``steps`` gives the states that follow a state, and what each step costs. Source: Dijkstra,
    A note on two problems in connexion with graphs, Numerische Mathematik 1 (1959)."""
    best, came, done = dict.fromkeys(starts, (0.0, 0.0)), dict[State, State](), set[State]()
    queue = [(cost, state) for state, cost in best.items()]
    while queue:
        (first, second), here = heappop(queue)
        if here in done:
            continue
        if is_goal(here):
            way = [here]
            while way[-1] in came:
                way.append(came[way[-1]])
            return way[::-1]
        done.add(here)
        for there, more in steps(here):
            total = (first + more[0], second + more[1])
            if total < best.get(there, (math.inf, math.inf)):
                best[there], came[there] = total, here
                heappush(queue, (total, there))
    return None


@lru_cache(maxsize=16)
def lanes_of(network: Network) -> Lanes:
    """Returns the lanes of a network; the same object for the same network."""
    return Lanes(network)


_Ends = dict[RoadEnd, tuple[Control, float | None]]


def _ends(network: Network) -> _Ends:
    """Returns the sign or light that traffic meets at an end of a road, and the distance in metres of its
    line from this end; None if there is no line on this road."""
    found: _Ends = {}
    for junction in network.junctions:
        for arm in junction.arms:
            has_line = arm.control not in ("none", "priority") and not gives_way_to_ring(
                network, junction, arm
            )
            found[arm.end] = arm.control, line_before(arm) + STOP_LINE if has_line else None
    return found


def _of_road(
    member: NetworkRoad,
    following: Mapping[Leg, Sequence[Leg]],
    preceding: Mapping[Leg, Sequence[Leg]],
    ends: _Ends,
) -> Iterator[Lane]:
    """Yields the lanes of a road, from its left edge to its right edge."""
    profile, rows = member.profile, list[list[Lane]]()
    for side, strips in ((1, profile.left), (-1, profile.right)):
        is_along = side == profile.side
        ids = [Leg(member.id, side * number) for number in range(1, 1 + len(strips))]
        driving = [strip.kind == "driving" for strip in strips]
        outside = max((number for number, is_driven in enumerate(driving, 1) if is_driven), default=0)
        verge = ids[outside] if outside < len(ids) else None
        control, before = ends.get(RoadEnd(member.id, "end" if is_along else "start"), ("none", None))
        row = []
        for n, strip in enumerate(strips):
            inner = ids[n - 1] if n and driving[n] and driving[n - 1] else None
            outer = ids[n + 1] if driving[n] and n + 1 < len(ids) and driving[n + 1] else None
            may = (n > 0 and strips[n - 1].marking in CROSSED, strip.marking in CROSSED)
            beside = [(inner, inner is not None and may[0]), (outer, outer is not None and may[1])]
            (left, may_left), (right, may_right) = beside[::-1] if profile.left_hand else beside
            lane = Lane(
                ids[n],
                strip.kind,
                member,
                is_along,
                left,
                right,
                may_left,
                may_right,
                verge if driving[n] else None,
                tuple(following.get(ids[n], ())),
                tuple(preceding.get(ids[n], ())),
                control if driving[n] else "none",
                before if driving[n] else None,
            )
            row.append(lane)
        rows.append(row)
    yield from rows[0][::-1]
    yield from rows[1]
