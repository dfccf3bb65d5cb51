"""Finds ways that meet the tested car's: across its road, through a junction, on the ring of a roundabout,
from a ramp, and off its road."""

import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from roadgpt.brief.junctions import RAMPS
from roadgpt.brief.scene import ON_ITS_WAY, Role
from roadgpt.errors import SceneError
from roadgpt.geometry import wrap_angle
from roadgpt.language.names import What
from roadgpt.language.table import MANEUVERS
from roadgpt.network import Passage, Route, is_route
from roadgpt.network.lane_along import LONGEST, SHARE
from roadgpt.network.lanes import HEADROOM, STRAIGHT_AHEAD, Lanes, lanes_of
from roadgpt.network.line import SPACING, Line, driven_line
from roadgpt.network.network import Leg
from roadgpt.road import Road, World
from roadgpt.road.road import GOAL
from roadgpt.traffic.actor import SIZES, FloatArray
from roadgpt.traffic.lane_map import LEAST
from roadgpt.traffic.lights import Lights, comes_from_side
from roadgpt.traffic.places import BESIDE, CLEAR, SIGN, reach_of

KERB = 1.1  # m, between the lanes and who stands before a crosswalk, to walk at its speed on it (CPNA)
BEFORE, BEHIND = 5.0, 8.0  # m, from a junction to those who cross the road before and behind it
DRIVEWAY = 6.0  # m, radius in which somebody turns from beside the road into a lane
REACH = 300.0  # m of a way before and behind the lanes for which it was chosen, as far as there are others
OPPOSITE = math.radians(40.0)  # an arm that is farther from straight ahead is on the left or on the right
MERGED = 0.5  # m between the middles of two ways that have become one
AROUND = 30.0  # m of the tested car's path before and behind a junction on which somebody may meet it
STRAIGHT = math.radians(60.0)  # within which who crosses goes straight on
TURNS: Mapping[What, tuple[float, float, tuple[bool, ...]]] = {
    "cross": (0.0, math.pi, (False, True)),
    "turn_across": (OPPOSITE, math.pi, (False, True)),
    "turn_in": (0.0, math.pi, (True,)),
    "merge": (0.0, OPPOSITE, (True,)),
}
"""By what angles somebody turns in a junction, the least and the most, and whether into the tested car's
lane."""


def way_of(
    role: Role, near: float, road: Road, world: World, away: float | None = None, angle: float | None = None
) -> Line:
    """Returns the way of somebody who crosses the tested car's path, comes to it along other lanes, or turns
    off. ``meets`` is where, at station ``near`` of the tested car's road or later. Who crosses is ``away``
    metres from the path at first; None: beside the lanes. Who is in a bay is at an ``angle`` to them. Raises
    SceneError if the road has no such place."""
    turns_off = role.where != "oncoming" and any(each.what == "turn_off" for each in role.actions)
    if not turns_off and role.where not in (*WAYS, "oncoming"):
        return _across(role, near, road, world, away, angle)
    place = role.where if role.where in WAYS else "junction"
    find, wanted = WAYS["turn_off" if turns_off and place != "roundabout" else place]
    passages, mark = road.passages, role.at
    if mark and mark.of == "junction":
        at = mark.number - 1 if mark.number > 0 else len(passages) + mark.number
        passages = passages[at + (mark.word == "after") :][:1]
    if is_route(road):
        for way in find(_Around(role, road, lanes_of(road.network), driven_line(road, world), passages)):
            if way is not None and way.meets is not None and way.meets[1] >= near:
                return way
    side = f"the {role.side}{' side' * (role.side == 'opposite')}" if role.side else "another side"
    does = MANEUVERS[next((each.what for each in role.actions if each.what in ON_ITS_WAY), role.goes)].said
    lacks = wanted.format(near=near, side=side, does=does, where=role.where)
    raise SceneError(f"the route passes no {lacks}; change one of them")


def _across(
    role: Role, near: float, road: Road, world: World, away: float | None, angle: float | None
) -> Line:
    """Returns the way straight across the road, at right angles to the tested car's path or at that of a bay
    from which somebody reverses, or into its lane for who turns in."""
    s = near if role.where != "crosswalk" else _crosswalk(near, road, role.at is None)
    for passage in road.passages if role.where != "crosswalk" else ():
        if passage.start - BEFORE < s < passage.end + BEHIND and role.gap is None:
            s = passage.end + BEHIND
    if near > road.length - GOAL:
        raise SceneError(f"the road ends at {road.length:.0f} m, before anybody can cross it; make it longer")
    s = s if s <= road.length - GOAL else near
    profile = world.profile_of(road)
    edges, rims, middle = profile.edges(s), profile.rims(s), float(profile.middle(s))
    reach = {"left": float(edges.left) - middle, "right": middle - float(edges.right)}
    side = str(role.side or ("left" if profile.left_hand else "right"))
    half = SIZES[role.kind].length / 2
    beyond = half + KERB if role.where == "crosswalk" else max(BESIDE, half + 1.0)
    begin, sharp, slant = reach[side] + beyond, math.pi / 2, 0.0
    if angle is not None:
        begin, sharp, slant = reach[side] + CLEAR + reach_of(role.kind, angle) / 2, angle, 1 / math.tan(angle)
    begin = begin if away is None else away
    end = reach["right" if side == "left" else "left"] + beyond
    across = np.linspace(begin, -end, math.ceil((begin + end) / SPACING) + 1)
    along = np.full(len(across), s) + slant * across
    if turns_in := "turn_in" in (each.what for each in role.actions):
        radius = min(DRIVEWAY, begin)
        s += radius / 2  # so that it comes into the lane behind the station
        turn = np.linspace(math.pi / 2 - sharp, math.pi / 2, math.ceil(radius * sharp / SPACING) + 1)
        deep = radius * (1 - math.sin(turn[0]))
        straight, rest = across[across > deep], np.arange(s + SPACING, road.length, SPACING)
        across = np.r_[straight, radius * (1 - np.sin(turn)), 0 * rest]
        before = s - radius * math.cos(turn[0]) - slant * (straight - deep)
        along = np.r_[before, s - radius * np.cos(turn), rest]
    t = profile.middle(along) + SIGN[side] * across
    xyz = road.at(along, t)
    xyz[:, 2] = road.at(along, np.clip(t, rims.right, rims.left))[:, 2]
    way, first = Line.through(xyz), int((across <= MERGED).argmax())
    met = (float(way.stations[first]), float(along[first])) if turns_in else (begin / math.sin(sharp), s)
    return replace(way, meets=met)


def _crosswalk(near: float, road: Road, is_open: bool) -> float:
    """Returns the station of the first crosswalk from ``near`` on; where the place is left open, that behind
    a junction at which the tested car turns."""
    found = [each for each in road.crosswalks if each.s >= near]
    for n, each in enumerate(found):
        if (way := each.passage) and is_open and not each.is_behind:
            turn = abs(float(wrap_angle(road.heading(way.end) - road.heading(way.start))))
            turns = turn > OPPOSITE or (is_route(road) and way.entered.id in road.network.roundabout_of)
            if turns and any(other.passage is way for other in found[n + 1 :]):
                continue
        return float(each.s)
    if road.crosswalks:
        raise SceneError(
            f"the route passes its last crosswalk at {road.crosswalks[-1].s:.0f} m, and the tested car is "
            f"there too soon: give it a lower speed, or more road before, at least {near:.0f} m in all"
        )
    raise SceneError("the route passes no crosswalk; write // crosswalk //, or crosswalk behind a junction")


class _Around(NamedTuple):
    """Somebody, and what is around the tested car: its route, the lanes of the map, its path, and its
    passages where they are to meet."""

    role: Role
    route: Route
    lanes: Lanes
    path: Line
    passages: Sequence[Passage]

    @property
    def s(self) -> FloatArray:
        """The stations along the route of the points of the path."""
        return np.asarray(self.path.road_stations)

    def turns(self, passage: Passage, start: Leg) -> Iterator[tuple[float, tuple[Leg, ...]]]:
        """Yields the ways through a junction or a roundabout, from a lane that leads into it or one of the
        ring: the change of heading in radians, positive to the left, and the lanes."""
        network, first = self.route.network, self.lanes[start]
        ring = network.roundabout_of.get(passage.entered.id)
        junctions = tuple(map(network.junction, ring.junctions)) if ring else (passage.entered,)
        inside, waiting = {each.id for each in network.inside(junctions)}, list[tuple[Leg, ...]]([(start,)])
        for way in waiting:
            for each in self.lanes[way[-1]].successors:
                if each.road in inside:
                    waiting += [(*way, each)] * (each not in way)
                else:
                    turn = self.lanes[each].heading(0.0) - first.heading(first.length)
                    yield float(wrap_angle(turn)), (*way, each)

    def before(self, passage: Passage) -> Leg:
        """Returns the lane in which the tested car comes to a passage."""
        return self.route.legs[bisect_right(self.route.starts, passage.start - SPACING) - 1]

    def whole(self, legs: Sequence[Leg]) -> tuple[Line, float]:
        """Returns the way that comes to the first of some lanes as straight as possible, and not along the
        tested car's, and goes on so behind the last one; and where the first lane begins."""
        before, behind = list[Leg](), list[Leg]()
        for more, first in ((before, legs[0]), (behind, legs[-1])):
            here, metres = self.lanes[first], 0.0
            while metres < REACH:
                near = here.successors if more is behind else {*here.predecessors} - {*self.route.legs}
                free = [self.lanes[each] for each in near if each not in (*legs, *before, *behind)]
                if not free:
                    break
                here = min(free, key=lambda lane: (abs(lane.turn), lane.id))
                more.append(here.id)
                metres += here.length
        parts = list[FloatArray]()
        for lane in map(self.lanes.__getitem__, (*before[::-1], *legs, *behind)):
            rows = lane.at(np.linspace(0.0, lane.length, max(2, math.ceil(lane.length / SPACING) + 1)))
            is_joined = bool(parts) and math.dist(parts[-1][-1, :2], rows[0, :2]) < SPACING / 2
            parts.append(rows[1:] if is_joined else rows)
        return Line.through(np.concatenate(parts)), sum(self.lanes[each].length for each in before)

    def met(self, legs: Sequence[Leg], passage: Passage, since: int = 0) -> Line | None:
        """Returns the way along lanes with the first place at a passage where it crosses the tested car's
        path or, if they have a lane in common, becomes one with it. Lanes before number ``since`` do not
        count. None if there is no such place."""
        import shapely

        way, begin = self.whole(legs)
        begin += sum(self.lanes[each].length for each in legs[:since])
        one, other = (shapely.LineString(each.points[:, :2]) for each in (way, self.path))
        places = shapely.points(shapely.get_coordinates(one.intersection(other)))
        if {*legs[since:]} & {*self.route.legs}:
            places = shapely.points(way.points[:, :2])
            places = places[shapely.distance(places, other) <= MERGED]
        own, along = shapely.line_locate_point(one, places), shapely.line_locate_point(other, places)
        apart = np.interp(own, way.stations, way.points[:, 2])
        apart -= np.interp(along, self.path.stations, self.path.points[:, 2])
        s = np.interp(along, self.path.stations, self.s)
        is_there = (own >= begin) & (np.abs(apart) < HEADROOM)
        is_there &= (s >= passage.start - AROUND) & (s <= passage.end + AROUND)
        places = sorted(zip(own[is_there].tolist(), s[is_there].tolist(), strict=True))
        return replace(way, meets=places[0]) if places else None

    def passed(self, legs: Sequence[Leg], passage: Passage) -> Line:
        """Returns the way along lanes that meet the tested car's path nowhere, as if they met in the middle
        of the junction."""
        way, own = self.whole(legs)
        own += sum(self.lanes[each].length / (1 if each == legs[0] else 2) for each in legs[:-1])
        return replace(way, meets=(own, (passage.start + passage.end) / 2))


def _through_junction(around: _Around) -> Iterator[Line | None]:
    """Yields the ways from an arm of a junction through it: straight on, where that is possible, or for who
    turns across the tested car's path or into it; and at last those on which somebody passes it."""
    role, route, network = around.role, around.route, around.route.network
    usual = ["left", "right", "opposite"] if network.left_hand else ["right", "left", "opposite"]
    sides = [str(role.side)] if role.side else usual[::-1] if role.goes == "turn_across" else usual
    least, most, kinds = TURNS[role.goes]
    whats = {each.what: each.side for each in role.actions}
    phases = Lights(network, 0, [role]).phases
    directions = {arm.end: arm.direction for each in network.junctions for arm in each.arms}
    passing = list[Line]()
    for passage in around.passages:
        found, own = list[tuple[Any, ...]](), phases.get(passage.arrival)
        is_plain = passage.entered.id not in network.roundabout_of and passage.entered.kind not in RAMPS
        came = directions[passage.arrival] + math.pi
        ahead = {end: float(wrap_angle(directions[end] - came)) for end in passage.arms[1:]}
        straightest = min(ahead, key=lambda end: abs(ahead[end]))
        for end, turn in ahead.items():
            side = "left" if turn > 0 else "right"
            if abs(turn) <= OPPOSITE or (end == straightest and len(ahead) > 3):  # in a star
                side = "opposite"
            is_there = end == straightest if role.where == "oncoming" else side in sides
            is_across = end in phases and phases[end] != own
            if not is_there or ("run_light" in whats and not is_across):
                continue
            lanes = [Leg(end.road, each) for each in network.lanes_into(end)]
            turns = [each for lane in lanes for each in around.turns(passage, lane)]
            if role.goes == "cross" and is_plain:
                turns = [each for each in turns if abs(each[0]) <= STRAIGHT] or turns
            is_wrong = end in phases and is_across != comes_from_side(role)
            for by, legs in turns:
                yields = not {*route.legs}.isdisjoint(around.lanes.gives_way_to(legs[1]))
                is_fit = least <= abs(by) <= most and (legs[-1] in route.legs) in kinds
                if is_fit and whats.get("turn_off") in (None, "left" if by < 0 else "right"):
                    best = is_wrong, "run_sign" in whats and not yields, [*sides, side].index(side), abs(turn)
                    found.append((*best, abs(by) > STRAIGHT and legs[-1] in route.legs, abs(by), legs))
        for *_, legs in sorted(found):
            yield around.met(legs, passage)
            passing += [around.passed(legs, passage)] * is_plain
    yield from passing


def _on_ring(around: _Around) -> Iterator[Line | None]:
    """Yields the ways around the ring of a roundabout, past the place where the tested car enters, to exits
    that it does not take."""
    route, rings = around.route, around.route.network.roundabout_of
    for passage in around.passages:
        if (ring := rings.get(passage.entered.id)) is None:
            continue
        own = route.legs[route.legs.index(around.before(passage)) :]
        entry = next(each for each in own if each.road in ring.ring)
        for each in around.lanes[entry].successors:
            loop = around.lanes.shortest(each, entry, "changes")
            if loop and all(rings.get(leg.road) is ring for leg in loop):
                for _, onward in around.turns(passage, entry):
                    if onward[-1].road != passage.departure.road:
                        yield around.met((*loop[:-1], *onward), passage, len(loop) - 2)


def _from_ramp(around: _Around) -> Iterator[Line | None]:
    """Yields the ways along a lane that ends beside the tested car's, such as one for acceleration behind a
    ramp, and into that; and along a ramp that joins it without such a lane."""
    lanes, legs = around.lanes, around.route.legs
    for own in map(lanes.__getitem__, legs):
        for key in (own.left, own.right):
            if key is not None and key not in legs and own.successors and not lanes[key].successors:
                way, begin = around.whole([key])
                s = np.arange(0.0, lanes[key].length, SPACING)
                wide = begin + s[lanes[key].width(s) >= LEAST]
                if len(wide):
                    yield _into(around, way, wide[0], wide[-1])
    merges = [each for each in around.passages if each.entered.kind == "merge"]
    yield from _through_junction(around._replace(passages=merges))


def _into(around: _Around, way: Line, begin: float, end: float) -> Line | None:
    """Returns the way that changes to the tested car's path in the middle between two of its stations."""
    path, length = around.path, min(LONGEST, SHARE * (end - begin))
    kept = way.stations < (begin + end - length) / 2
    if kept.sum() < 2:
        return None
    at, aside = map(float, path.locate(*way.points[kept][-1, :2]))
    ahead = path.stations > at
    cos, sin = np.cos(path.points[ahead, 3]), np.sin(path.points[ahead, 3])
    left = aside * (1 + np.cos(np.pi * np.minimum((path.stations[ahead] - at) / length, 1.0))) / 2
    rest = path.points[ahead, :3] + np.column_stack([-left * sin, left * cos, 0 * left])
    whole = Line.through(np.vstack([way.points[kept, :3], rest]))
    first = int((np.abs(left) <= MERGED).argmax())
    return replace(whole, meets=(float(whole.stations[kept.sum() + first]), float(around.s[ahead][first])))


def _turning_off(around: _Around) -> Iterator[Line | None]:
    """Yields the ways along the tested car's lane that leave its road at a junction, which is where they meet
    last."""
    role, path = around.role, around.path
    side = next(each.side for each in role.actions if each.what == "turn_off")
    for passage in around.passages:
        turns = sorted(around.turns(passage, around.before(passage)), key=lambda each: -abs(each[0]))
        for by, legs in turns:
            is_there = legs[-1].road != passage.departure.road
            if side:  # there the tested car may go, too
                is_there = abs(by) > STRAIGHT_AHEAD and (by > 0) == (side == "left")
            if is_there:
                kept, (rest, _) = around.s < passage.start - SPACING / 2, around.whole(legs[1:])
                way = Line.through(np.vstack([path.points[kept, :3], rest.points[:, :3]]))
                behind = way.stations[kept.sum() :]
                beyond = passage.start + behind - behind[0]
                met = float(behind[0]), passage.start
                yield replace(way, meets=met, road_stations=np.r_[around.s[kept], beyond])


WAYS: Mapping[str, tuple[Callable[[_Around], Iterator[Line | None]], str]] = {
    "junction": (
        _through_junction,
        "junction after {near:.0f} m at which somebody from {side} who {does} meets the tested car",
    ),
    "roundabout": (_on_ring, "roundabout after {near:.0f} m"),
    "ramp": (_from_ramp, "ramp that joins its lane after {near:.0f} m"),
    "turn_off": (_turning_off, "junction after {near:.0f} m where somebody {where} can turn off"),
}
"""The ways of those at a place, or who turn off, best first, and what is missing if there are none."""
