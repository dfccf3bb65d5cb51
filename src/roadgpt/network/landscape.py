"""Makes the ground around a road: the land that its World asks for, with all roads of its network in it, on
bridges and in tunnels where the land asks for them."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.ground.given import GivenGround
from roadgpt.ground.ground import SLOPE, Ground, Pavement, Span, slope_for
from roadgpt.ground.relief import Kind, Relief, Stretch, Way, level_land, made, stretches
from roadgpt.ground.sight import OPEN, Horizon, horizon_of, sight_distances
from roadgpt.network.network import NetworkRoad
from roadgpt.network.road_or_route import is_route, network_of
from roadgpt.network.surface import pavement_of
from roadgpt.road import Road, World

STEP = 2.0  # m between the points of roads that land is made around
USUAL: Kind = "rolling"  # the kind of land in pictures where nothing is asked for
MARGIN = 8.0  # m of road before and behind a bridge or a tunnel
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
        return Ground.of(level_land(way, level), Pavement(np.empty((0, 3, 3)), ()))
    parts = _stretches(road, world)
    spans = [span for each in parts if (span := _span(each, road, world)) is not None]
    relief = _land(way, world, parts)
    is_given = isinstance(world.site.ground, GivenGround)
    slope = slope_for(relief, way.others) if is_given else SLOPE
    return Ground.of(relief, pavement_of(network, spans), slope)


def _stretches(road: Road, world: World) -> list[Stretch]:
    """Returns the stretches of a road through its landscape. Those with a bridge or a tunnel are moved, and
    shortened, so that they lie on one road between junctions; where there is no room they keep their place
    and have neither."""
    found, taken = [], list[tuple[float, float]]()
    for each in stretches(world.scene.landscape, road.length):
        if _kind(each) is None:
            found.append(each)
            continue
        best = None
        for start, member in _roads(road, world):
            low, high = start + MARGIN, start + member.road.length - MARGIN
            for a, b in taken:  # what lies before or behind other structures on the same road
                is_behind = each.middle > (a + b) / 2
                if a < high and b > low:
                    low, high = (b + MARGIN, high) if is_behind else (low, a - MARGIN)
            long = min(each.length, high - low)
            if long >= SHORTEST:
                middle = min(max(each.middle, low + long / 2), high - long / 2)
                fit = (each.length - long + abs(middle - each.middle), middle, long)
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


def sight_along(road: Road, world: World, step: float = 5.0) -> tuple[Array, Array]:
    """Returns stations about every ``step`` metres, and how far in metres the driver of the tested car sees
    an object on the road from each of them (see ``ground.sight``): infinite where it is seen to the end."""
    road = world.lay(road)
    s = np.linspace(0.0, road.length, max(2, round(road.length / step) + 1))
    points = road.at(s, world.profile_of(road).middle(s))
    horizon = horizon_of(ground_around(road, world))
    return s, sight_distances(horizon, np.ascontiguousarray(points), road.length / (len(s) - 1))


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
    return tuple(sorted(found, key=lambda each: each.start))


def _kind(stretch: Stretch) -> Literal["bridge", "tunnel"] | None:
    kind = (stretch.structure or stretch.land).kind
    return kind if kind in ("bridge", "tunnel") else None


def _roads(road: Road, world: World) -> Sequence[tuple[float, NetworkRoad]]:
    """Returns the roads outside junctions that a road follows, each with the station where it begins."""
    if is_route(road):
        return road.roads if road.has_way else ()
    return ((0.0, network_of(road, world).roads[0]),)


def _span(stretch: Stretch, road: Road, world: World) -> Span | None:
    kind = _kind(stretch)
    if kind is None:
        return None
    for start, member in _roads(road, world):
        low, high = stretch.start - start, stretch.end - start
        if low >= 0 and high <= member.road.length:
            along = True
            if is_route(road):
                leg = next(each for each in road.legs if each.road == member.id)
                along = member.profile.leads_along(leg.lane)
            if not along:
                low, high = member.road.length - high, member.road.length - low
            return Span(kind, member.id, low, high)
    return None


def _land(way: Way, world: World, parts: Sequence[Stretch]) -> Relief:
    given = world.site.ground
    if isinstance(given, GivenGround):
        return given.relief
    if world.site.made_ground is None and given:
        raise UsageError(f"the heights of the land '{given}' are not at hand; give its file with --ground")
    hills: Kind = "hilly" if any(each.land.kind in ("valley", "ridge") for each in parts) else USUAL
    kind, seed = world.site.made_ground or (hills, 0)
    return made(way, kind, parts, seed)
