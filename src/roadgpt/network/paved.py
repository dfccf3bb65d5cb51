"""Computes the paved area of roads: the union of their carriageways, seen from above.

All roads here have a profile, a reference line of pieces, and no superelevation."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry import CubicProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.geometry.pieces import along_all
from roadgpt.road import Road

if TYPE_CHECKING:
    from shapely import MultiPolygon, Polygon

Area: TypeAlias = "Polygon | MultiPolygon"
"""One or more polygons in the plane, with holes where there are islands."""
SAG = 0.002  # m, largest distance between the edge of a bend and the chords of its polygon
GRID = 1e-4  # m, step to which corners are rounded, so that roads that touch are joined
LONGEST = 8.0  # m, longest chord of a bend
SLIVER = 1.0  # m^2; a smaller hole between ways is too small for an island and is paved
ISLAND = 7.0  # m^2, area of the smallest island where roads cross (AASHTO Green Book 9.6.3: 75 square feet)
NEAR = 1e-3  # m, largest distance from a junction to a hole that the junction encloses


def paved_by(roads: Sequence[Road], sag: float = SAG) -> Area:
    """Returns the area that carriageways of roads cover together; holes up to ``SLIVER`` m^2 are filled."""
    return covered_by(areas_of(roads, sag))


def areas_of(roads: Sequence[Road], sag: float = SAG) -> NDArray[np.object_]:
    """Returns the area of the carriageway of each road, as a valid polygon without edges that cross."""
    import shapely

    areas = ribbons(roads, sag)
    # where a road turns more tightly than it is wide, its ribbon crosses itself
    crossed = ~shapely.is_valid(areas)
    areas[crossed] = shapely.make_valid(areas[crossed])
    return areas


def bays_of(roads: Sequence[Road]) -> list[Area]:
    """Returns the areas of the bays and parking lanes beside the lanes of roads, seen from above."""
    import shapely

    found = []
    for road in roads:
        s, profile = stations_of(road), road.profile
        assert profile is not None
        for number in (number for number, lane in profile.lanes.items() if lane.kind == "parking"):
            left, right = (road.at(s, t)[:, :2] for t in profile.edges_of(number, s))
            found.append(shapely.Polygon([*left, *right[::-1]]).buffer(0.0))
    return found


def covered_by(areas: Sequence[Area] | NDArray[np.object_]) -> Area:
    """Returns the area that several areas cover together; holes up to ``SLIVER`` m^2 are filled. The corners
    of ``areas`` should be rounded to ``GRID``. The corners of the union are rounded afterwards, which takes
    half as long as letting shapely round them during the union."""
    import shapely

    return filled(shapely.set_precision(shapely.union_all(areas), GRID))


def filled(area: Area) -> Area:
    """Returns an area with all holes up to ``SLIVER`` m^2 filled."""
    import shapely

    parts = []
    for part in polygons_in(area):
        rings = shapely.get_rings(part)
        holes = rings[1:][shapely.area(shapely.polygons(rings[1:])) > SLIVER]
        parts.append(shapely.Polygon(rings[0], holes))
    return parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)


def polygons_in(shape: Any) -> list["Polygon"]:
    """Returns the polygons of a shape, also those inside of its collections, without lines and points: a road
    that is nowhere wide at one place leaves a line there."""
    import shapely

    parts = shapely.get_parts(shapely.get_parts(shape))
    return [part for part in parts if part.geom_type == "Polygon" and part.area > 0]


def without_small_islands(whole: Area, nodes: Sequence[Area], least: Sequence[float]) -> tuple[Area, ...]:
    """Returns the paved areas of a network and then of each of its junctions, with small islands paved over.

    An island may lie between the ways of a junction and the end of a road. It is then a hole in the area of
    the network, but not in that of the junction; if it is smaller than ``least`` square metres at this
    junction, it is added to both."""
    import shapely

    parts, paved = [], [[node] for node in nodes]
    for part in shapely.get_parts(whole):
        holes = []
        for ring in part.interiors:
            hole = shapely.Polygon(ring)
            close = (n for n, node in enumerate(nodes) if hole.area < least[n] and hole.dwithin(node, NEAR))
            if (at := next(close, None)) is None:
                holes.append(ring)
            else:
                paved[at].append(hole)
        parts.append(shapely.Polygon(part.exterior, holes))
    new = parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)
    inside = [
        each[0] if len(each) == 1 else shapely.set_precision(shapely.union_all(each), GRID) for each in paved
    ]
    return new, *inside


def ribbon(road: Road) -> "Polygon":
    """Returns the polygon of the carriageway of one road; see ``ribbons``."""
    found: Polygon = ribbons([road])[0]
    return found


def ribbons(roads: Sequence[Road], sag: float = SAG) -> NDArray[np.object_]:
    """Returns one polygon for each road: its carriageway, beginning with the right edge.

    The line that separates the two directions of traffic has a corner of the polygon at each end, because
    lanes of other roads may have a corner there. Without these corners, rounding would leave a gap between
    the end of the road and such a lane."""
    import shapely

    if not roads:
        return np.array([], object)
    stations = [stations_of(road, sag) for road in roads]
    centre, heading = along_all([_pieces_of(road) for road in roads], stations)
    to_left = np.stack((-np.sin(heading), np.cos(heading)), axis=-1)
    profiles = [road.profile for road in roads if road.profile is not None]
    rows = [(*own.edges(s), own.centre(s)) for own, s in zip(profiles, stations, strict=True)]
    left, right, middle = (centre + np.concatenate(t)[:, None] * to_left for t in zip(*rows, strict=True))
    ends = np.cumsum([len(s) for s in stations]).tolist()
    corners = [
        np.concatenate((right[a:b], middle[b - 1 : b], left[a:b][::-1], middle[a : a + 1]))
        for a, b in pairwise([0, *ends])
    ]
    numbers = np.repeat(np.arange(len(roads)), [len(each) for each in corners])
    found: NDArray[np.object_] = shapely.polygons(
        shapely.linearrings(np.round(np.concatenate(corners) / GRID) * GRID, indices=numbers)
    )
    return found


def _pieces_of(road: Road) -> PieceCurve:
    assert isinstance(road.plan, PieceCurve)
    return road.plan


def stations_of(road: Road, sag: float = SAG) -> Array:
    """Returns stations in metres along a road, so close together that chords between them deviate from the
    edges of the road by at most ``sag`` metres. The ends of all pieces of the reference line are stations; if
    widths vary, there is also a station about every metre."""
    profile = road.profile
    assert profile is not None
    stops, at = [0.0], 0.0
    for piece in _pieces_of(road).pieces:
        bend, count = max(abs(piece.k0), abs(piece.k1)), 1
        if bend:
            step = min(LONGEST, math.sqrt(8 * sag / (bend * (1 + bend * profile.reach))))
            count = max(1, math.ceil(piece.length / step))
        stops += [at + piece.length * n / count for n in range(1, count + 1)]
        at += piece.length
    widths = [profile.offset, *(lane.width for lane in (*profile.left, *profile.right))]
    count = round(road.length) if any(isinstance(width, CubicProfile) for width in widths) else 0
    own = np.linspace(0.0, road.length, max(2, count + 1))
    own = own[(own > 0) & (own < at)]
    return np.unique(np.round(np.r_[stops, own], 9)) if own.size else np.array(stops)


def outline_of(area: Area) -> Array:
    """Returns the outer outline ``(n, 2)`` in metres of the largest part of an area, counter-clockwise,
    without the first point repeated at the end."""
    import shapely
    from shapely.geometry.polygon import orient

    largest = max(shapely.get_parts(area), key=lambda part: part.area)
    return np.asarray(orient(largest).exterior.coords, float)[:-1]
