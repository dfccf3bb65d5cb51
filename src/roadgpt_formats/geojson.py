"""Exports roads as GeoJSON (RFC 7946) in geographic coordinates, for maps and geographic tools."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.export.ego import Poses
from roadgpt.geometry.curve import Array
from roadgpt.network import Network, network_of, only_road
from roadgpt.road import Road, World
from roadgpt.road.edges import finite
from roadgpt_formats.georeference import degrees

STEP = 1.0  # m
SAME = 1e-6  # m; a width that varies by less is taken as constant
DECIMALS = 9  # of a degree: 0.1 mm
HEIGHT_DECIMALS = 4  # of a metre


class GeoJson:
    """GeoJSON: centre line, all lanes and the drive in longitude, latitude and height."""

    name = "geojson"
    suffix = ".geojson"
    holds_junctions = True
    lacks = ("the land around",)

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes one feature collection.

        ``roadgpt_formats.georeference`` defines the geographic position of the map. For a route through
        junctions, the paved area of the whole network takes the place of the lanes. A map without a route has
        no centre line."""
        s = road.sample(STEP).s
        about = {"length_m": road.length}
        about |= {"speed_kmh": world.limits.speed_limit * 3.6} if world.limits.limit_stated else {}
        is_only = only_road(road, world) is not None
        beside = _lanes(road, world, s) if is_only else _paved(network_of(road, world), world)
        lines = [_line("centre line", road.at(s), about)] if road.has_way else []
        features = [*lines, *beside]
        if poses is not None:
            way = np.stack([poses.x, poses.y, poses.z], axis=-1)
            seconds = (np.round(poses.time, 3) + 0.0).tolist()
            features.append(_line("drive", way, {"time_s": seconds}))
        data = {"type": "FeatureCollection", "features": features}
        path.write_bytes((json.dumps(data, allow_nan=False) + "\n").encode())


def _lanes(road: Road, world: World, s: Array) -> Iterator[dict[str, Any]]:
    """Yields one polygon for each driving lane: first those on the right, then those on the left, each from
    the centre line outwards.

    If there are several lanes on a side, their names contain numbers, from 1 at the centre line."""
    profile = world.profile_of(road)
    sides = profile.along_ids, profile.against_ids
    for side, ids in zip(("right", "left"), sides[::-1] if profile.left_hand else sides, strict=True):
        for n, lane in enumerate(ids, 1):
            high, low = profile.edges_of(lane, s)
            width = high - low
            one = {"width_m": float(width[0])}
            several = {"width_min_m": float(width.min()), "width_max_m": float(width.max())}
            properties = {**(several if np.ptp(width) > SAME else one), "friction": world.site.friction}
            name = f"{side} lane" if len(ids) == 1 else f"{side} lane {n}"
            # counter-clockwise, as the standard requires
            right, left = road.at(s, low), road.at(s, high)
            ring = _on_globe(np.concatenate([right, left[::-1], right[:1]]))
            yield _feature(name, {"type": "Polygon", "coordinates": [ring]}, properties)


def _paved(network: Network, world: World) -> Iterator[dict[str, Any]]:
    """Yields one polygon for each part of the paved area of a network, without heights."""
    from shapely import get_parts
    from shapely.geometry.polygon import orient

    for part in get_parts(network.paved):
        turned = orient(part)  # the outline counter-clockwise and holes clockwise, as the standard requires
        rings = [np.asarray(each.coords, float) for each in (turned.exterior, *turned.interiors)]
        level = [np.column_stack([ring, np.zeros(len(ring))]) for ring in rings]
        outlines = [[each[:2] for each in _on_globe(ring)] for ring in level]
        geometry = {"type": "Polygon", "coordinates": outlines}
        yield _feature("paved area", geometry, {"friction": world.site.friction})


def _line(name: str, points: Array, properties: dict[str, Any]) -> dict[str, Any]:
    return _feature(name, {"type": "LineString", "coordinates": _on_globe(points)}, properties)


def _feature(name: str, geometry: dict[str, Any], properties: dict[str, Any]) -> dict[str, Any]:
    pairs = properties.items()
    rounded = {key: round(value, 3) if isinstance(value, float) else value for key, value in pairs}
    return {"type": "Feature", "properties": {"name": name, **rounded}, "geometry": geometry}


def _on_globe(points: Array) -> list[list[float]]:
    x, y, z = finite(points).T
    columns = [np.round(each, DECIMALS) for each in degrees(x, y)]
    rows: list[list[float]] = np.column_stack([*columns, np.round(z, HEIGHT_DECIMALS) + 0.0]).tolist()
    return rows
