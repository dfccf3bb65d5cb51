"""Defines the Route: a way through a network. A Route is itself a Road.

The centre line of a Route consists of the reference lines of its roads, one after another. Everything that
can be done with a Road can be done with a Route: check, drive, judge and draw it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate, groupby, pairwise
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.geometry.elevation import Cubic, closed
from roadgpt.language.names import Control
from roadgpt.network.lane_along import LaneAlong, change_windows, cubics_at, lane_along
from roadgpt.network.lane_line import along_lanes, continue_each_other
from roadgpt.network.markings import CROSSWALK, STOP_LINE, line_before
from roadgpt.network.network import Arm, Junction, Leg, Network, NetworkRoad, RoadEnd, network_to_json
from roadgpt.network.paved import Area, paved_by
from roadgpt.network.stretch import joined_heights, joined_plans, turned
from roadgpt.network.surface import ROUND, polygons, with_shoulders
from roadgpt.road import Edges, Profile, Road
from roadgpt.road.profile import LaneStrip, Marking, Width

FARTHEST = 40.0  # m, from the reference line; ground farther away is left out
STEP = 0.5  # m, between the stations at which edges are computed
JUST = 1e-6  # m, before or behind a station, so that a jump of widths at the station does not matter
AROUND = 20.0  # m, before and after a junction, where kerbs may still curve


class Passage(NamedTuple):
    """The way of a route through one junction or one roundabout."""

    start: float  # station in metres at which the route enters the junction or roundabout
    end: float  # station in metres at which the route leaves the junction or roundabout
    entered: Junction  # the junction; for a roundabout, the junction of the arm on which the route arrives
    arrival: RoadEnd  # the end, at the junction, of the road on which the route arrives
    departure: RoadEnd  # the end, at the junction, of the road on which the route goes on
    arms: tuple[RoadEnd, ...]
    """The ends of all roads that meet there, first the road of arrival, then counter-clockwise if traffic
    drives on the right and clockwise if it drives on the left."""

    @property
    def exit(self) -> int:
        """Number of the exit, from 1 in the order of ``arms``; the road of arrival is the last exit."""
        return self.arms.index(self.departure) or len(self.arms)

    @property
    def stop_line(self) -> float | None:
        """Station in metres at which the line of a stop sign begins; None if there is no stop sign."""
        return self.line if self.control == "stop" else None

    @property
    def light_line(self) -> float | None:
        """Station in metres at which the line before traffic lights begins; None if there are none."""
        return self.line if self.control == "lights" else None

    @property
    def line(self) -> float:
        """Station in metres at which the line that belongs to the sign or the lights begins, or would
        begin."""
        return self.start - line_before(self._arm) - STOP_LINE

    @property
    def control(self) -> Control:
        """The sign or the light that the route meets at the road of arrival."""
        return self._arm.control

    @property
    def _arm(self) -> Arm:
        return next(arm for arm in self.entered.arms if arm.end == self.arrival)


class Crosswalk(NamedTuple):
    """A crosswalk on the way of a route."""

    s: float  # station in metres of its middle
    passage: Passage | None  # the junction or roundabout at which it lies; None away from these
    is_behind: bool  # whether it lies behind it


def _place(network: Network, leg: Leg) -> tuple[str, int] | None:
    """Returns a key for the junction or roundabout in which a leg lies; None outside junctions."""
    ring = network.roundabout_of.get(leg.road)
    if ring is not None:
        return "roundabout", ring.junctions[0]
    junction = network.road(leg.road).junction
    return None if junction is None else ("junction", junction)


def _passage(network: Network, one: Leg, other: Leg, start: float, end: float) -> Passage:
    entered, first = network.connection_of[one.road]
    last = network.connection_of[other.road][1]
    ring = network.roundabout_of.get(entered.id)
    # the first arm of each junction of a roundabout is the one that is no part of the ring
    arms = entered.arms if ring is None else [network.junction(each).arms[0] for each in ring.junctions]
    if ring is None and network.left_hand:
        arms = arms[::-1]
    ends = [arm.end for arm in arms]
    if ring is None:
        at = ends.index(first.incoming)
        around = [*ends[at:], *ends[:at]]
    else:
        at = ring.junctions.index(entered.id)
        left = network.connection_of[other.road][0].arms[0].end
        around = [*ends[at:], *ends[:at]]
        if last.outgoing.road in ring.ring:  # the route ends on the ring
            around.insert(around.index(left) + 1, last.outgoing)
        if first.incoming.road in ring.ring:
            around.insert(0, first.incoming)
    return Passage(start, end, entered, first.incoming, last.outgoing, tuple(around))


def area_with_verges(network: Network) -> Area:
    """Returns the paved area of a network, widened by its usual shoulder, with the wider ones of roads."""
    area, shoulder = network.paved, network.shoulder
    if shoulder <= 0:
        return area
    wide = [with_shoulders(each) for each in network.roads_outside if each.shoulder > shoulder]
    ground = area.buffer(shoulder, quad_segs=ROUND)
    return polygons(ground.union(paved_by(wide))) if wide else ground


def _edges_of_ground(route: Road, ground: Area, s: Array) -> Edges:
    """Returns the offsets of the left and the right edge of the ground at stations ``s`` ``(n,)``: at right
    angles to the route, the first edge, or ``FARTHEST`` where there is none."""
    import shapely

    boundary, starts = ground.boundary, route.plan.at(s)
    found = []
    for side in (1.0, -1.0):
        ends = route.at(s, side * FARTHEST)[:, :2]
        rays = shapely.linestrings(np.stack((starts, ends), axis=1))
        hits = shapely.intersection(rays, boundary)
        away = shapely.distance(shapely.points(starts), hits)
        found.append(side * np.where(np.isnan(away), FARTHEST, away))
    return Edges(*found)


def windows(passages: Sequence[Passage], length: float) -> list[tuple[float, float]]:
    """Returns the first and last station in metres of each stretch of a route within ``AROUND`` metres of its
    passages. Stretches that overlap are merged. ``length`` is that of the route in metres."""
    found: list[tuple[float, float]] = []
    for each in passages:
        low, high = max(0.0, each.start - AROUND), min(length, each.end + AROUND)
        if found and low <= found[-1][1]:
            found[-1] = (found[-1][0], high)
        else:
            found.append((low, high))
    return found


def _shoulders_on_ground(route: "Route", profile: Profile) -> tuple[CubicProfile, CubicProfile]:
    """Returns the widths in metres of the left and the right shoulder of a route, along its stations. Outside
    the ``windows``, the shoulders are as wide as those of the roads; inside, they reach to the edge of the
    ground."""
    ground = area_with_verges(route.network)
    rows: tuple[list[tuple[float, Cubic]], list[tuple[float, Cubic]]] = ([], [])
    last = 0.0
    for low, high in windows(route.passages, route.length):
        s = np.linspace(low, high, max(2, round((high - low) / STEP) + 1))
        s = np.union1d(s, [each for each in route.starts if low < each < high])
        ends = _edges_of_ground(route, ground, s)
        # lanes begin and end where a junction does, so the shoulder beside them jumps there
        after, before = profile.edges(s[:-1] + JUST), profile.edges(s[1:] - JUST)
        begins = (ends.left[:-1] - after.left, after.right - ends.right[:-1])
        stops = (ends.left[1:] - before.left, before.right - ends.right[1:])
        for side, begin, stop, usual in zip(rows, begins, stops, _usual(profile, last), strict=True):
            if low > last:
                side.append((last, (usual, 0.0, 0.0, 0.0)))
            widths = np.maximum(begin, 0.0)
            slopes = (np.maximum(stop, 0.0) - widths) / np.diff(s)
            side += [
                (at, (a, b, 0.0, 0.0)) for at, a, b in np.column_stack((s[:-1], widths, slopes)).tolist()
            ]
        last = high
    for side, usual in zip(rows, _usual(profile, last), strict=True):
        end = min(last, route.length - 1e-6)
        while side and side[-1][0] >= end:
            side.pop()
        side.append((end, (usual, 0.0, 0.0, 0.0)))
    left, right = map(CubicProfile.of_rows, rows)
    return left, right


def _usual(profile: Profile, s: float) -> tuple[float, float]:
    rims, edges = profile.rims(s), profile.edges(s)
    return float(rims.left - edges.left), float(edges.right - rims.right)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Route(Road):
    """A way through a network.

    Its profile has the lane that the route follows, and on each side of this lane a single lane that is as
    wide as all lanes of that side together. Inside junctions the profile has no oncoming lanes, and no
    shoulders until ``on_ground`` adds them.

    A network through which no route was asked for is a Route without legs: it ``has_way`` False. Nothing can
    drive such a Route. Its centre line is that of the network's first road outside junctions."""

    is_route: ClassVar[bool] = True
    network: Network
    legs: tuple[Leg, ...]
    ends: tuple[float, ...]
    """The stations in metres of the start of each road and, as the last one, of the end of the route."""

    @classmethod
    def along(cls, network: Network, legs: Sequence[Leg]) -> Self:
        """Returns the route that follows these legs through a network, in this order. ``legs`` may be empty.
        Raises UsageError if the network has no road outside junctions, a road or a lane does not exist, two
        legs that follow each other are not joined, or the route begins or ends inside a junction."""
        legs = tuple(map(Leg._make, legs))
        for leg in legs:
            _check_leg(network, leg)
        for one, two in pairwise(legs):
            _check_joint(network, one, two)
        if network.left_hand:
            return cls.along(network.mirrored, _mirrored_legs(legs)).mirrored
        if not legs and not network.plain_roads:
            raise UsageError("the network has no road outside junctions; make the road again")
        outside = network.roads_outside or network.plain_roads
        first = outside[0] if not legs else network.road(legs[0].road)
        followed = legs or (Leg(first.id, (*first.profile.along_ids, *first.profile.against_ids)[0]),)
        if any(network.road(followed[n].road).junction is not None for n in (0, -1)):
            raise UsageError("a route begins and ends on a road outside junctions")
        roads, lanes = _parts(network, followed)
        if continue_each_other(roads):
            starts = [0.0, *accumulate(road.length for road in roads)]
            line = Road(joined_plans(roads), joined_heights(roads))
            beside = [_joined_widths(each, roads, starts) for each in zip(*lanes, strict=True)]
        else:
            line, beside, starts = along_lanes(roads, lanes)
        profile = _profile(roads, beside, starts)
        return cls(line.plan, line.elevation, profile=profile, network=network, legs=legs, ends=tuple(starts))

    def __repr__(self) -> str:
        if not self.legs:
            return f"Route(none asked for, {len(self.network.roads_outside)} roads)"
        kinds = ", ".join(each.entered.kind.replace("_", "-") for each in self.passages)
        return f"Route({self.length:.1f} m, junctions: {kinds or 'none'})"

    @cached_property
    def starts(self) -> tuple[float, ...]:
        """The stations in metres of the start of each leg and, as the last one, of the end of the route. A
        leg on the same road as the leg before begins in the middle of the lane change between them."""
        found = list[float]()
        groups = groupby(self.legs, key=lambda leg: leg.road)
        for (start, end), (_, group) in zip(pairwise(self.ends), groups, strict=False):
            windows = change_windows(end - start, len(list(group)) - 1)
            found += [start, *(start + (a + b) / 2 for a, b in windows)]
        return (*found, self.ends[-1]) if self.legs else (0.0,)

    @cached_property
    def roads(self) -> tuple[tuple[float, NetworkRoad], ...]:
        """The roads outside junctions and roundabouts, as pairs (station in metres of its start, road)."""
        own = zip(self.starts, self.legs, strict=False)
        firsts = [next(group) for _, group in groupby(own, key=lambda each: each[1].road)]
        members = [(start, self.network.road(leg.road)) for start, leg in firsts]
        return tuple(
            (start, member)
            for start, member in members
            if member.junction is None and member.id not in self.network.roundabout_of
        )

    @cached_property
    def passages(self) -> tuple[Passage, ...]:
        """The passages through junctions in driving order. A way through a roundabout is one passage, though
        a roundabout has several junctions. If the route begins or ends on its ring, the passage begins behind
        or ends before this piece of the ring."""
        network, legs, starts = self.network, self.legs, self.starts
        groups = groupby(range(len(legs)), key=lambda n: _place(network, legs[n]))
        through = [[*group] for place, group in groups if place is not None]
        ways = [[n for n in own if network.road(legs[n].road).junction is not None] for own in through]
        return tuple(
            _passage(network, legs[own[0]], legs[own[-1]], starts[own[0]], starts[own[-1] + 1])
            for own in ways
            if own
        )

    @cached_property
    def crosswalks(self) -> tuple[Crosswalk, ...]:
        """The crosswalks on the way, in driving order."""
        away, crossed, found = CROSSWALK[0] + CROSSWALK[1] / 2, self.network.crossed, list[Crosswalk]()
        for way in self.passages:
            found += [Crosswalk(way.start - away, way, False)] * (way.arrival in crossed)
            found += [Crosswalk(way.end + away, way, True)] * (way.departure in crossed)
        for each in self.network.continuations if crossed else ():
            for (_, one), (start, two) in pairwise(self.roads):
                before, after = (one, two) if each.before.road == one.id else (two, one)
                if each.crosswalk and (each.before.road, each.after.road) == (before.id, after.id):
                    found.append(Crosswalk(start - (away if before is one else -away), None, False))
        return tuple(sorted(found, key=lambda each: each.s))

    @property
    def has_way(self) -> bool:
        """Whether a route was asked for."""
        return bool(self.legs)

    @property
    def mirrored(self) -> Self:
        """The route with the sign of y changed, in the mirror image of its network."""
        return replace(super().mirrored, network=self.network.mirrored, legs=_mirrored_legs(self.legs))

    def moved(self, x: float, y: float, z: float = 0.0) -> "Route":
        """Returns the route through its network, shifted by the given distances along each axis."""
        return Route.along(self.network.moved(x, y, z), self.legs).on_ground()

    def on_ground(self) -> Self:
        """Returns the route with shoulders that reach to the edge of the ground: the paved area of the
        network with its shoulders."""
        assert self.profile is not None
        left, right = _shoulders_on_ground(self, self.profile)
        profile = replace(
            self.profile,
            left=(*self.profile.left[:-1], LaneStrip("shoulder", left)),
            right=(*self.profile.right[:-1], LaneStrip("shoulder", right)),
        )
        return self.with_profile(profile)

    def to_json(self) -> dict[str, Any]:
        """Returns the route and its network as JSON data, for ``network.road_from_json``."""
        return {"route": [list(leg) for leg in self.legs], "network": network_to_json(self.network)}


def _mirrored_legs(legs: Sequence[Leg]) -> tuple[Leg, ...]:
    return tuple(Leg(leg.road, -leg.lane) for leg in legs)


def _check_leg(network: Network, leg: Leg) -> None:
    try:
        profile = network.road(leg.road).profile
    except KeyError as error:
        raise UsageError(f"the route names road {leg.road}, which is not in the network") from error
    if leg.lane not in (*profile.along_ids, *profile.against_ids):
        raise UsageError(f"the route names lane {leg.lane} of road {leg.road}, which has no such lane")


def _check_joint(network: Network, one: Leg, two: Leg) -> None:
    if one.road == two.road:
        is_joined = network.road(one.road).junction is None and abs(one.lane - two.lane) == 1
        if not is_joined or one.lane * two.lane < 0:
            raise UsageError(
                f"the route cannot change from lane {one.lane} to lane {two.lane} of road {one.road}; change "
                "to the next lane of the same direction"
            )
        return
    if two not in network.following.get(one, ()):
        raise UsageError(f"no way leads from road {one.road} to road {two.road}, as the route asks")


def _parts(network: Network, legs: Sequence[Leg]) -> tuple[list[Road], list[LaneAlong]]:
    """Returns the roads of a route in its direction, and the lane that the route follows on each; legs that
    follow each other on one road are one part."""
    roads, lanes = list[Road](), list[LaneAlong]()
    for number, group in groupby(legs, key=lambda leg: leg.road):
        own, member = list(group), network.road(number)
        roads.append(member.road if member.profile.leads_along(own[0].lane) else turned(member.road))
        lanes.append(lane_along(roads[-1], [abs(leg.lane) - 1 for leg in own]))
    return roads, lanes


def _profile(roads: Sequence[Road], beside: Sequence[Width], starts: Sequence[float]) -> Profile:
    left_shoulder, left, offset, width, right, right_shoulder = beside
    first = next(road.profile for road in roads if road.profile is not None)
    angles = [road.profile.superelevation_angle for road in roads if road.profile is not None]
    angle = _joined_widths([0.0 if each is None else each for each in angles], roads, starts)
    marking, edge = first.centre_marking, first.lanes[first.along_ids[-1]].marking
    outer = () if right == 0 else (LaneStrip("driving", right, edge),)
    own: Marking = "broken" if outer else edge
    return Profile(
        (LaneStrip("driving", left, edge), LaneStrip("shoulder", left_shoulder)),
        (LaneStrip("driving", width, own), *outer, LaneStrip("shoulder", right_shoulder)),
        0,
        marking,
        angle if isinstance(angle, CubicProfile) else None,
        offset,
    )


def _joined_widths(widths: Sequence[Width], roads: Sequence[Road], starts: Sequence[float]) -> Width:
    if all(width == widths[0] and not isinstance(width, CubicProfile) for width in widths):
        return widths[0]
    rows: list[tuple[float, Cubic]] = []
    for width, road, start in zip(widths, roads, starts, strict=False):
        own = width.stations if isinstance(width, CubicProfile) else ()
        inside = [0.0, *(s for s in own if 0 < s < road.length - 1e-9)]
        rows += zip((start + s for s in inside), cubics_at(width, inside), strict=True)
    return closed(rows, starts[-1])
