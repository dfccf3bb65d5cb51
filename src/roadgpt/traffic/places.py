"""Finds where the others of a scene are and which ways they go: geometry without time."""

import math
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.brief.outline import USUALLY_WIDEST
from roadgpt.brief.scene import Mark, Roadworks, Scene
from roadgpt.check.measures import measure
from roadgpt.errors import SceneError
from roadgpt.geometry.boxes import corners
from roadgpt.language.names import ActorKind, Side, Where
from roadgpt.language.table import ROADWORKS
from roadgpt.network import is_route, network_of
from roadgpt.network.lanes import lanes_of
from roadgpt.network.line import SPACING, Line
from roadgpt.network.markings import CROSSWALK
from roadgpt.network.stretch import BAY as BAY_OF_BUS
from roadgpt.plural import plural
from roadgpt.traffic.actor import HEADING, SIZES, FloatArray
from roadgpt.traffic.lane_map import LEAST
from roadgpt.traffic.maneuver import ROLL, drawn

if TYPE_CHECKING:
    from roadgpt.road import Road, World

BESIDE = 2.0  # m, from the outermost driving lane to the middle of who stands or walks beside it
CLEAR = 0.15  # m, from a driving lane to a parked vehicle: 1 m to a car in a lane of 3.5 m (Euro NCAP, CPNCO)
PLACE = 7.0  # m of a row for each parked vehicle: at least 6.5 m, of a delivery van
BAY = 2.5  # m, width of a parking bay at an angle (RASt 06, section 6.1.5)
FREE, VANS = 0.15, 0.1  # shares of the places that are free, and of vans among the parked vehicles
KEPT_FREE = 5.0 + sum(CROSSWALK) + PLACE / 2
"""Metres from a junction to the middle of a parked vehicle: 5 m before and behind it and its crosswalks stay
free (Germany, StVO, section 12)."""
ALONG = 2.5  # m before and behind a parked car where the edge of the lanes is looked at
WIDEST = (USUALLY_WIDEST, 1000.0, 4000.0)
"""The radii in metres of the widest bends that are turns: the wider ones if there are not enough others."""
ROOM = 1.5  # m, from the middle of a way to the vehicles that are parked beside it
SPACED = 0.682  # s at the limit, between cones of a taper: 1 ft for each mph (MUTCD, 6F.63); else twice
TO_ENTER, LEAST_ROOM = 20.0, 5.0  # m before and behind the tested car, in which no roadworks stand in its way
SIGN = {"left": 1.0, "right": -1.0}


def offset_of(where: Where, side: Side | None, s: float, road: "Road", world: "World", width: float) -> float:
    """Returns how many metres to the left of the tested car's path, at a station of its road, the middle of a
    place is: of the next "lane" of the same direction or the one beyond, which is "far", of the nearest
    "oncoming" lane, of a box that is "parked" beside the driving lanes, or of who is "beside" them.

    Without a side, "lane" is on the side of the centre line if there is one, and the others are on the outer
    side. "far" is beside the road where there is no such lane. Within junctions, the offset changes evenly
    from that before to that behind it. Raises SceneError if there is no such place."""
    for passage in road.passages:
        if passage.start < s < passage.end and where in ("lane", "far", "oncoming"):
            ends = [passage.start - SPACING, passage.end + SPACING]
            return float(np.interp(s, ends, [offset_of(where, side, e, road, world, width) for e in ends]))
    profile = world.profile_of(road)
    outer: Side = "left" if profile.left_hand else "right"
    inner: Side = "right" if profile.left_hand else "left"
    if where in ("lane", "far", "oncoming"):
        beside = _lanes_beside(s, road, world, width)
        sides = {"oncoming": ["oncoming"]}.get(where, [side] if side else [inner, outer])
        found = [beside[each][where == "far"] for each in sides if len(beside[each]) > (where == "far")]
        if found:
            return found[0]
        if where != "far":
            lacks = "oncoming lane" if where == "oncoming" else "second lane of the same direction"
            on = f" on the {side}" if side else ""
            raise SceneError(f"the road has no {lacks}{on} at {s:.0f} m; give it one, or another place")
    side = side or outer
    around = np.clip([s - ALONG, s, s + ALONG], 0.0, road.length)
    edges = getattr(profile.edges(around), side) - profile.middle(around)
    edge = float(edges.max() if side == "left" else edges.min())
    return edge + SIGN[side] * (CLEAR + width / 2 if where == "parked" else BESIDE)


def bus_bays(road: "Road") -> list[tuple[float, Side]]:
    """Returns the stations of the middles of the bus bays that a route passes, and on which side they are."""
    middle = (BAY_OF_BUS[1][0] + BAY_OF_BUS[2][0]) / 2
    return [
        (start + middle, "left" if each.profile.left_hand else "right")
        for start, each in (road.roads if is_route(road) else ())
        if each.profile and "parking" in (strip.kind for strip in each.profile.along)
    ]


def _lanes_beside(s: float, road: "Road", world: "World", width: float) -> dict[str, list[float]]:
    """Returns the offsets of the lanes of this width of the tested car's direction, to its left and to its
    right, and of the oncoming ones, each from the nearest to the farthest."""
    found: dict[str, list[float]] = {"left": [], "right": [], "oncoming": []}
    for left, right, is_same, is_own in _lanes_at(s, road, world):
        if not is_own and left - right >= width:
            side = ("left" if left + right > 0 else "right") if is_same else "oncoming"
            found[side].append((left + right) / 2)
    return {name: sorted(offsets, key=abs) for name, offsets in found.items()}


def _lanes_at(s: float, road: "Road", world: "World") -> Iterator[tuple[float, float, bool, bool]]:
    """Yields the left and the right edge of each driving lane, in metres to the left of the tested car's
    path, whether it leads as the tested car's does, and whether it is that."""
    profile = world.profile_of(road)
    station, t, lane = s, float(profile.middle(s)), profile.driven_id
    if is_route(road):
        leg = road.legs[min(max(bisect_right(road.starts, s) - 1, 0), len(road.legs) - 1)]
        member, lane = road.network.road(leg.road), leg.lane
        station, t = (float(each) for each in member.road.locate(*road.at(s, t)[:2]))
        profile = replace(member.profile, aside=profile.aside)
    is_along = profile.leads_along(lane)
    ids = (profile.along_ids, profile.against_ids)[:: 1 if is_along else -1]
    for each in (*ids[0], *ids[1]):
        edges = [float(edge - t) * (1 if is_along else -1) for edge in profile.edges_of(each, station)]
        is_own = each == lane if profile.aside == 0.0 else min(edges) <= 0.0 <= max(edges)
        yield max(edges), min(edges), each in ids[0], is_own


def stretch_of(mark: Mark, road: "Road", path: Line) -> tuple[float, float]:
    """Returns the first and the last station, along the tested car's lane, of a part of its route."""
    spans = passages = [(each.start, each.end) for each in road.passages]
    if mark.of == "crosswalk":
        spans = [(each.s - CROSSWALK[1] / 2, each.s + CROSSWALK[1] / 2) for each in road.crosswalks]
    if mark.of == "turn":
        edges = [0.0, *(edge for span in passages for edge in span), road.length]
        free = [(a, b) for a, b in list(pairwise(edges))[::2] if b - a > 10.0]
        lines = [road.at(np.linspace(a, b, math.ceil(b - a) + 1)) for a, b in free]
        for widest in WIDEST:  # m: turns of a motorway are wide
            turns = [
                (a, each)
                for (a, _), line in zip(free, lines, strict=True)
                for each in measure(line, widest).turns
            ]
            spans = [(a + turn.start, a + turn.end) for a, turn in turns]
            if len(spans) >= abs(mark.number):
                break
    at = mark.number - 1 if mark.number > 0 else len(spans) + mark.number
    if not 0 <= at < len(spans):
        raise SceneError(
            f"the scene names {mark.of} {mark.number}, but the road has "
            f"{plural(len(spans), str(mark.of)) if spans else f'no {mark.of}'}; name another place"
        )
    return path.from_road(spans[at][0]), path.from_road(spans[at][1])


def reach_of(kind: ActorKind, angle: float) -> float:
    """Returns how far across the road somebody is who stands at an angle to it."""
    length, width, _ = SIZES[kind]
    return length * math.sin(angle) + width * math.cos(angle)


def parked_rows(
    scene: Scene, road: "Road", world: "World", seed: int, free: Sequence[FloatArray] = ()
) -> list[tuple[ActorKind, FloatArray]]:
    """Returns the cars and vans that are parked in rows along the road, each with its state. Nobody is parked
    in or close to junctions and crosswalks, in driving lanes, such as in a tight bend, or close to the
    lines in ``free``, whose first columns are x and y."""
    import shapely

    rng = np.random.default_rng([seed, len(scene.actors), len(scene.parked)])
    angle = drawn(scene, np.random.default_rng([seed, 109])).get("angle", 0.0)
    place = BAY / math.sin(angle) if angle else PLACE
    lanes, middle = lanes_of(network_of(road, world)), world.profile_of(road).middle
    outer = "left" if world.profile_of(road).left_hand else "right"
    lines = [shapely.LineString(each[:, :2]).buffer(ROOM) for each in free]
    found = list[tuple[ActorKind, FloatArray]]()
    for side in scene.parked:
        for s in np.arange(place / 2, road.length - place / 2, place).tolist():
            is_free, is_van = rng.random(2) < (FREE, VANS)
            if is_free or any(each.start - KEPT_FREE < s < each.end + KEPT_FREE for each in road.passages):
                continue
            kind: ActorKind = "van" if is_van else "car"
            deep = reach_of(kind, angle)
            t = float(middle(s)) + offset_of("parked", side, s, road, world, deep)
            turned = side != outer and bool(_lanes_beside(s, road, world, LEAST)["oncoming"])
            if angle:  # in the middle of its bay
                s += (-1 if turned else 1) * deep / 2 / math.tan(angle)
            state = np.array([*road.at(s, t), float(road.heading(s)) + math.pi * turned, 0.0])
            state[HEADING] += SIGN[side] * (-1 if turned else 1) * angle
            box = corners(state[:2], state[HEADING], np.array(SIZES[kind]))
            is_in_lane = any(each.lane.kind == "driving" for places in lanes.places(box) for each in places)
            if not is_in_lane and not any(line.intersects(shapely.Polygon(box)) for line in lines):
                found.append((kind, state))
    return found


def works_rows(road: "Road", world: "World", seed: int) -> list[tuple[ActorKind, FloatArray]]:
    """Returns the cones of roadworks and what stands behind them, each with its state; nothing stands in
    junctions. Raises SceneError if the road has no such place, or the tested car starts there."""
    found, parks, start = list[tuple[ActorKind, FloatArray]](), world.scene.parks, world.start_on(road)
    at_first = offset_of("parked", parks, start, road, world, SIZES["car"].width) if parks else 0.0
    to_left = max(at_first, 0.0) + SIZES["car"].width / 2
    to_right = min(at_first, 0.0) - SIZES["car"].width / 2
    for number, works in enumerate(world.scene.roadworks):
        n, row = drawn(works, np.random.default_rng([seed, 107, number])), ROADWORKS[works.kind]
        first = n.get("station", world.start_on(road) + ROLL * world.first_speed)
        outer, inner, is_against = _strip(works, min(first, road.length), road, world)
        aside, limit = n.get("shift", row.covers or abs(inner - outer)), world.limits.speed_limit
        ends = works.stations(first, n["length"], aside, limit)
        ends = [first + ends[-1] - each for each in ends[::-1]] if is_against else ends
        if ends[-1] > road.length or aside < SIZES["cones"].width:
            has = f"ends at {road.length:.0f} m" if ends[-1] > road.length else "has no such shoulder"
            raise SceneError(f"{works} end at {ends[-1]:.0f} m, and the road {has}; change one of them")
        is_inside = (outer > inner) != world.profile_of(road).left_hand and not is_against
        least = is_inside * SIZES["cones"].width  # so that none stands in the next lane
        things = list[tuple[ActorKind, float]]()
        for a, b, apart in zip(ends, ends[1:], (SPACED, 2 * SPACED, SPACED), strict=False):
            at = np.linspace(a, b, math.ceil((b - a) / apart / limit) + 1)[a > first :]
            things += [("cones", s) for s in at.tolist()]
        rest = np.linspace(ends[1], (ends[1] + ends[2]) / 2, max(len(row.inside), 1))
        for kind, s in [*things, *zip(row.inside, rest.tolist(), strict=False)]:
            outer, inner, _ = _strip(works, s, road, world)
            into = float(np.interp(s, ends, [least, aside, aside, least])) - SIZES[kind].width / 2
            into = into if kind == "cones" else abs(inner - outer) / 2
            t = outer + into * math.copysign(1.0, inner - outer)
            if -LEAST_ROOM < s - start < TO_ENTER and to_right < t < to_left:
                raise SceneError(
                    f"{works} stand in the way of the tested car, which starts at {start:.0f} m; let them "
                    f"begin at {start + TO_ENTER:.0f} m or later"
                )
            t += float(world.profile_of(road).middle(s))
            if not any(each.start < s < each.end for each in road.passages):
                found.append((kind, np.array([*road.at(s, t), float(road.heading(s)), 0.0])))
    return found


def _strip(works: Roadworks, s: float, road: "Road", world: "World") -> tuple[float, float, bool]:
    """Returns the outer and inner edge of the lane of roadworks, or the shoulder, in metres to the left of
    the tested car's path, and whether it is oncoming: on the far side, where one lane leads along."""
    profile, lanes = world.profile_of(road), [*_lanes_at(s, road, world)]
    own, against = ([each for each in lanes if each[2] == same] for same in (True, False))
    side = works.side or ("left" if profile.left_hand else "right")
    is_far = (side == "left") != profile.left_hand and (len(own) == 1 or works.kind == "shoulder")
    left, right, *_ = (max if side == "left" else min)(against if is_far and against else own)
    outer, inner = (left, right) if side == "left" else (right, left)
    if works.kind == "shoulder":
        outer, inner = float(getattr(profile.rims(s), side) - profile.middle(s)), outer
    return outer, inner, is_far and bool(against)
