"""Makes the ground around a road: the land that its World asks for, with all roads of its network in it, on
bridges and in tunnels where the land asks for them."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import groupby, pairwise
from typing import Literal, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.ground.given import GivenGround
from roadgpt.ground.ground import SLOPE, Ground, Pavement, Span, slope_for
from roadgpt.ground.relief import Relief, Stretch, Way, made, rings_around, stretches
from roadgpt.ground.sight import OPEN, Horizon, horizon_of
from roadgpt.network.network import NetworkRoad
from roadgpt.network.road_or_route import is_route, network_of
from roadgpt.network.surface import COVER, UNDER, pavement_of
from roadgpt.road import Road, World

STEP = 2.0  # m between the points of roads that land is made around
BEHIND = 16.0  # m of land beyond the ends of a road that leads on as the road does
MARGIN = 8.0  # m of road before and behind a bridge or a tunnel
CLEARANCE = 5.5  # m from a road to one that lies over it: 4.7 m for vehicles and the bridge
SHARPEST = 0.35  # sine of the angle between them, of which bridges do not become longer
SHORTEST = 12.0  # m, of a bridge or a tunnel


@lru_cache(maxsize=4)
def ground_around(road: Road, world: World) -> Ground:
    """Returns the land with all roads of a road's network in it; always the same for the same arguments.

    Roads without shoulders float above flat land, as in the RoadGPT thesis, unless the World has ground of
    its own. Raises UsageError if the heights of given land are not at hand."""
    road = world.lay(road)
    network = network_of(road, world)
    lines = [each.road.centreline(STEP) for each in network.roads_outside]
    way = Way(road.centreline(STEP) if road.has_way else np.concatenate(lines), np.concatenate(lines))
    if not (world.has_ground or any(each.profile.has_shoulders for each in network.roads)):
        level = min(world.site.z_floor, float(way.others[:, 2].min()) - 1.0)
        return Ground.of(_level_land(way, level), Pavement(np.empty((0, 3, 3)), ()))
    if len(lines) == 1:
        way = replace(way, others=_with_room_at_ends(way.others))
    parts = _stretches(road, world)
    spans = [*_over_others(road, world), *filter(None, (_span(each, road, world) for each in parts))]
    relief = _land(way, world, parts)
    is_given = isinstance(world.site.ground, GivenGround)
    slope = slope_for(relief, way.others) if is_given else SLOPE
    return Ground.of(relief, pavement_of(network, spans), slope)


def _stretches(road: Road, world: World) -> list[Stretch]:
    """Returns the stretches of a road through its landscape. Those with a bridge or a tunnel are moved, and
    shortened, so that they lie on one road between junctions; where there is no room they keep their place
    and have neither."""
    over = _on_the_way(_over_others(road, world), road, world)
    found, taken = [], [(each.start, each.end) for each in over]
    for each in stretches(world.scene.landscape, road.length):
        if (kind := _kind(each)) is None:
            found.append(each)
            continue
        best = None
        for part in _parts_of(road, world):
            low, high = part.start + MARGIN, part.end - MARGIN
            for a, b in taken:  # what lies before or behind other structures on the same road
                is_behind = each.middle > (a + b) / 2
                if a < high and b > low:
                    low, high = (b + MARGIN, high) if is_behind else (low, a - MARGIN)
            long = min(max(each.length, SHORTEST), high - low)
            if long >= SHORTEST:
                middle = min(max(each.middle, low + long / 2), high - long / 2)
                fit = (each.length - long + abs(middle - each.middle), middle, long)
                if _has_room(road, world, kind, middle):
                    best = fit if best is None or fit < best else best
        if best is None:  # without the bridge or the tunnel
            if each.structure is not None:
                found.append(replace(each, structure=None))
            continue
        _, middle, long = best
        taken.append((middle - long / 2, middle + long / 2))
        found.append(replace(each, start=middle - long / 2, end=middle + long / 2))
    return found


@lru_cache(maxsize=4)
def horizon_around(road: Road, world: World) -> Horizon:
    """Returns what may hide others on a road: nothing, if the World has no land."""
    return horizon_of(ground_around(road, world)) if world.has_ground else OPEN


class Crossing(NamedTuple):
    """A bridge or a tunnel of the tested car's road."""

    kind: Literal["bridge", "tunnel"]
    start: float  # station in metres along the road, or the route
    end: float


def crossings(road: Road, world: World) -> tuple[Crossing, ...]:
    """Returns the bridges and tunnels of a road, in driving order."""
    found = [
        Crossing(kind, each.start, each.end) for each in _stretches(road, world) if (kind := _kind(each))
    ]
    found += _on_the_way(_over_others(road, world), road, world)
    return tuple(sorted(found, key=lambda each: each.start))


def _on_the_way(spans: Sequence[Span], road: Road, world: World) -> list[Crossing]:
    """Returns the bridges and tunnels of a network that lie on a road or a route, by its stations."""
    found = []
    for span in spans:
        for part in _parts_of(road, world):
            if part.member.id == span.road:
                ends = (part.station(at) for at in (span.start, span.end))
                start, end = (min(max(at, part.start), part.end) for at in sorted(ends))
                found += [Crossing(span.kind, start, end)] if start < end else []
    return found


@lru_cache(maxsize=4)
def _over_others(road: Road, world: World) -> tuple[Span, ...]:
    """Returns bridges where a road lies over another one, or over itself, outside junctions."""
    found = list[Span]()
    if not world.has_ground:
        return ()
    members = network_of(road, world).roads_outside
    stations = [np.arange(0.0, each.road.length, STEP) for each in members]
    owner, s = np.repeat(np.arange(len(members)), [*map(len, stations)]), np.concatenate(stations)
    points = np.concatenate([each.road.at(own) for each, own in zip(members, stations, strict=True)])
    pairs = cKDTree(points[:, :2]).query_pairs(0.75 * STEP, output_type="ndarray")
    pairs = np.take_along_axis(pairs, points[pairs, 2].argsort(axis=1), axis=1)
    rises = np.diff(points[pairs, 2], axis=1)[:, 0]
    for (low, top), rise in zip(pairs[rises >= CLEARANCE], rises[rises >= CLEARANCE].tolist(), strict=True):
        member, under, at = members[owner[top]], members[owner[low]], float(s[top])
        if any(each.road == member.id and each.start < at < each.end for each in found):
            continue
        turn = float(member.road.heading(s[[top]])[0] - under.road.heading(s[[low]])[0])
        half = under.profile.reach / max(abs(math.sin(turn)), SHARPEST) + rise + MARGIN / 2
        start, end = max(at - half, MARGIN), min(at + half, member.road.length - MARGIN)
        found += [Span("bridge", member.id, start, end)] if end - start >= SHORTEST else []
    return tuple(found)


def _kind(stretch: Stretch) -> Literal["bridge", "tunnel"] | None:
    kind = (stretch.structure or stretch.land).kind
    return kind if kind in ("bridge", "tunnel") else None


class _Part(NamedTuple):
    """A part of a road or a route outside junctions, along one road of the network."""

    start: float  # station in metres along the road or the route
    end: float
    member: NetworkRoad
    is_along: bool  # whether it leads in the direction of the member's own stations

    def station(self, at: float) -> float:
        """Returns the station along the road or the route of one of the member."""
        at *= (self.end - self.start) / self.member.road.length
        return self.start + at if self.is_along else self.end - at


def _parts_of(road: Road, world: World) -> list[_Part]:
    if not is_route(road):
        return [_Part(0.0, road.length, network_of(road, world).roads[0], is_along=True)]
    found = []
    groups = groupby(road.legs, key=lambda leg: leg.road) if road.has_way else ()
    for (start, end), (number, legs) in zip(pairwise(road.ends), groups, strict=False):
        member = road.network.road(number)
        if member.junction is None and number not in road.network.roundabout_of:
            found.append(_Part(start, end, member, member.profile.leads_along(next(legs).lane)))
    return found


def _span(stretch: Stretch, road: Road, world: World) -> Span | None:
    if (kind := _kind(stretch)) is None:
        return None
    for part in _parts_of(road, world):
        if part.start <= stretch.start and stretch.end <= part.end:
            # a route may follow the middle of a lane, which is longer or shorter than its road
            scale = part.member.road.length / (part.end - part.start)
            low, high = ((at - part.start) * scale for at in (stretch.start, stretch.end))
            if not part.is_along:
                low, high = part.member.road.length - high, part.member.road.length - low
            return Span(kind, part.member.id, low, high)
    return None


def _has_room(road: Road, world: World, kind: str, middle: float) -> bool:
    """Returns whether given land leaves room under a bridge, or covers a tunnel, at its middle."""
    given = world.site.ground
    if not isinstance(given, GivenGround):
        return True
    x, y, z = road.at(middle).tolist()
    land = float(given.relief.at(np.array([x]), np.array([y]))[0])
    return bool(land < z - UNDER if kind == "bridge" else land > z + COVER)


def _with_room_at_ends(line: Array) -> Array:
    """Returns a line ``(n, 3)`` that leads straight on at both ends, where cameras stand."""
    far = np.arange(STEP, BEHIND + STEP, STEP)[:, None]
    ahead, back = line[-1] - line[-2], line[0] - line[1]
    start, end = (far * step / max(float(np.hypot(*step[:2])), 1e-9) for step in (back, ahead))
    return np.concatenate([(line[0] + start)[::-1], line, line[-1] + end])


def _level_land(way: Way, level: float) -> Relief:
    """Returns flat land around a way, ``level`` metres high and a little lower at the horizon."""
    low, high = way.box
    side = float((high - low).max())
    shape = np.full((2, 2), level)
    rings = rings_around(low, high)
    beyond = np.column_stack([rings, np.full(len(rings), level - 4.0)])
    return Relief(float(low[0]), float(low[1]), side, shape, np.full((2, 2), np.nan), beyond)


def _land(way: Way, world: World, parts: Sequence[Stretch]) -> Relief:
    given = world.site.ground
    if isinstance(given, GivenGround):
        return given.relief
    if world.site.made_ground is None and given:
        raise UsageError(f"the heights of the land '{given}' are not at hand; give its file with --ground")
    kind, seed = world.site.made_ground or (world.scene.hills, 0)
    return made(way, kind, parts, seed)
