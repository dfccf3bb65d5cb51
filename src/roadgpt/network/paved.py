"""Computes the paved area of roads: the union of their carriageways, seen from above."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.geometry import CubicProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.network.polygon import Area
from roadgpt.road import Road

if TYPE_CHECKING:
    from shapely import Polygon

SAG = 0.002  # m, between the edge of a bend and the chords of its polygon
GRID = 1e-4  # m, to which corners are rounded, so that roads that touch are joined
LONGEST = 8.0  # m, of a chord
SLIVER = 1.0  # m^2; a smaller hole between ways is paved, as it is too small for an island


def paved_by(roads: Sequence[Road]) -> Area:
    """Returns the area that the carriageways of roads cover together."""
    import shapely

    ribbons = [ribbon(road) for road in roads]
    # where a road turns more tightly than it is wide, its ribbon crosses itself
    whole = [each if each.is_valid else shapely.make_valid(each) for each in ribbons]
    return filled(shapely.union_all(whole, grid_size=GRID))


def filled(area: Area) -> Area:
    """Returns an area without holes that are smaller than ``SLIVER``."""
    import shapely

    parts = []
    for part in shapely.get_parts(area):
        holes = [hole for hole in part.interiors if shapely.Polygon(hole).area > SLIVER]
        parts.append(shapely.Polygon(part.exterior, holes))
    return parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)


def ribbon(road: Road) -> "Polygon":
    """Returns the polygon of a road's carriageway, which begins along the right edge.

    The ends of the line between its lanes are corners of it, because lanes of other roads may end there:
    rounding would otherwise leave a gap between this road and a corner of another road on its end. The road
    has no superelevation.
    """
    from shapely import Polygon

    s = stations_of(road)
    assert road.profile is not None
    edges, centre, heading = road.profile.edges(s), road.plan.at(s), road.plan.heading(s)
    to_left = np.stack((-np.sin(heading), np.cos(heading)), axis=-1)
    left, right, middle = (centre + t[:, None] * to_left for t in (*edges, road.profile.centre(s)))
    return Polygon(np.concatenate((right, middle[-1:], left[::-1], middle[:1])))


def stations_of(road: Road) -> Array:
    """Returns stations of a road so close together that its edges deviate from their chords by ``SAG`` at
    most; every change of its curvature and of its lanes is among them.
    """
    profile = road.profile
    assert isinstance(road.plan, PieceCurve)
    assert profile is not None
    stops, at = [0.0], 0.0
    for piece in road.plan.pieces:
        bend = max(abs(piece.k0), abs(piece.k1))
        step = LONGEST if bend == 0 else min(LONGEST, np.sqrt(8 * SAG / (bend * (1 + bend * profile.reach))))
        count = max(1, int(np.ceil(piece.length / step))) if bend else 1
        stops += (at + piece.length * np.arange(1, count + 1) / count).tolist()
        at += piece.length
    own = [s for s in _changes(road) if 0 < s < at]
    return np.unique(np.round(np.r_[stops, own], 9)) if own else np.array(stops)


def _changes(road: Road) -> list[float]:
    """Returns stations, 1 m apart, at which widths vary."""
    assert road.profile is not None
    widths = [road.profile.offset, *(lane.width for lane in (*road.profile.left, *road.profile.right))]
    if not any(isinstance(width, CubicProfile) for width in widths):
        return []
    stations: list[float] = np.linspace(0.0, road.length, max(2, round(road.length) + 1)).tolist()
    return stations


def outline_of(area: Area) -> Array:
    """Returns the outer outline ``(n, 2)`` of the largest part of an area, counter-clockwise, not closed."""
    import shapely
    from shapely.geometry.polygon import orient

    largest = max(shapely.get_parts(area), key=lambda part: part.area)
    return np.asarray(orient(largest).exterior.coords, float)[:-1]
