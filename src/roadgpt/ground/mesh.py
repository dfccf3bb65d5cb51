"""Divides the ground into triangles that meet the rims of the roads without a seam: fine near roads, coarse
far away."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import Delaunay, cKDTree

from roadgpt.geometry.curve import Array
from roadgpt.ground.ground import Ground, Portal

SIZES = ((32.0, np.inf), (16.0, 130.0), (8.0, 60.0), (4.0, 24.0), (2.0, 7.0))
"""Side of the squares in metres, and the distance from a road up to which they are divided so far."""
LINTEL = 1.5  # m of land above the mouth of a tunnel that is one strip
THIN = 0.2  # m from the mouth of a tunnel to the land above it
WATERSIDE = 8.0  # m, side of the squares beside water
OPEN_SEA = 0.25  # share of the border of the land from which on water there goes on to the horizon
NEAREST = 0.55  # of a square's side; a corner that is nearer to a rim is left out
APART = 1.0  # m between the points of a rim from which that is measured
ROUNDS = 6  # of halving those segments of rims that no triangle has as a side


@dataclass(frozen=True, eq=False)
class GroundMesh:
    """Triangles of the ground, without the roads, in metres with z up."""

    points: Array  # (n, 3)
    triangles: NDArray[np.int64]  # indices of points, (m, 3), counter-clockwise from above

    @cached_property
    def normals(self) -> Array:
        """The upward unit normals at the points, (n, 3): means of those of the triangles around."""
        a, b, c = (self.points[self.triangles[:, k]] for k in range(3))
        facing = np.cross(b - a, c - a)
        found = np.zeros_like(self.points)
        for k in range(3):
            np.add.at(found, self.triangles[:, k], facing)
        found[:, 2] += 1e-12
        return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def mesh_of(ground: Ground, to_horizon: bool = True) -> GroundMesh:
    """Returns the ground from the rims of the roads to the horizon, or to the border of its grid."""
    rings, portals = ground.pavement.rims, ground.pavement.portals
    corners = _corners(ground)
    for portal in portals:
        corners = corners[~_is_before(corners, portal, LINTEL)]
    corners = np.concatenate([*(_lintel(portal, ground) for portal in portals), corners])
    far = ground.relief.beyond if to_horizon else np.empty((0, 3))
    for _ in range(ROUNDS):
        rims = np.concatenate(rings) if rings else np.empty((0, 3))
        points = np.concatenate([rims, corners, far])
        triangles = _triangles(points, ground)
        halved = _with_missing_halved(rings, triangles)
        for portal in portals:  # which is open
            triangles = triangles[~_is_before(points, portal, 2 * THIN)[triangles].all(axis=1)]
        if not halved:
            break
        rings = halved
    return GroundMesh(points, triangles)


def _is_before(points: Array, portal: Portal, reach: float) -> NDArray[np.bool_]:
    """Returns whether points lie within ``reach`` metres of the line across the mouth of a tunnel."""
    off = points[:, :2] - (portal.left + portal.right)[:2] / 2
    half = np.hypot(*(portal.left - portal.right)[:2]) / 2
    across = np.abs(off @ [-portal.ahead[1], portal.ahead[0]])
    return np.asarray((np.abs(off @ portal.ahead) < reach) & (across < half + THIN))


def _lintel(portal: Portal, ground: Ground) -> Array:
    """Returns points ``(n, 3)`` of the land just above the mouth of a tunnel."""
    n = int(np.hypot(*(portal.left - portal.right)[:2]) / THIN) + 2  # closer together than they are to it
    line = portal.left + (portal.right - portal.left) * np.linspace(0.0, 1.0, n)[:, None]
    flat = line[:, :2] + THIN * portal.ahead
    return np.column_stack([flat, np.maximum(ground.beside(*flat.T), line[:, 2] + portal.high)])


def water_of(ground: Ground) -> GroundMesh:
    """Returns the surface of all water. It reaches a little into the land, which hides it there, and a sea as
    far as the horizon."""
    relief = ground.relief
    wet = ~np.isnan(relief.water)
    cells = wet[:-1, :-1] & wet[1:, :-1] & wet[:-1, 1:] & wet[1:, 1:]
    low = relief.heights < np.nan_to_num(relief.water, nan=-np.inf)
    cells &= low[:-1, :-1] | low[1:, :-1] | low[:-1, 1:] | low[1:, 1:]
    rows, columns = np.nonzero(cells)
    wide = relief.heights.shape[1]
    a, b = rows * wide + columns, (rows + 1) * wide + columns
    quads = np.concatenate([np.stack([a, a + 1, b + 1], axis=1), np.stack([a, b + 1, b], axis=1)])
    used, triangles = np.unique(quads, return_inverse=True)
    j, i = used // wide, used % wide
    points = np.column_stack([relief.x + relief.cell * i, relief.y + relief.cell * j, relief.water[j, i]])
    triangles = triangles.reshape(-1, 3)
    at_border = (i == 0) | (i == wide - 1) | (j == 0) | (j == len(wet) - 1)
    if len(relief.beyond) and at_border.sum() > OPEN_SEA * 2 * sum(wet.shape):
        (x0, y0), (x1, y1) = (relief.x, relief.y), np.add((relief.x, relief.y), relief.size)
        far, level = np.ptp(relief.beyond[:, 0]) / 2, float(np.median(points[at_border, 2]))
        corners = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        corners += [(x0 - far, y0 - far), (x1 + far, y0 - far), (x1 + far, y1 + far), (x0 - far, y1 + far)]
        ring = np.array([(k + 4, (k + 1) % 4 + 4, (k + 1) % 4, k + 4, (k + 1) % 4, k) for k in range(4)])
        triangles = np.concatenate([triangles, len(points) + ring.reshape(-1, 3)])
        points = np.concatenate([points, [(*corner, level) for corner in corners]])
    return GroundMesh(points, triangles)


def _corners(ground: Ground) -> Array:
    """Returns the corners ``(n, 3)`` of squares that become smaller towards the roads, beside the roads."""
    x0, y0, x1, y1 = ground.x[0], ground.y[0], ground.x[-1], ground.y[-1]
    rings = [shapely.linearrings(ring[:, :2]) for ring in ground.pavement.rims]
    tree = cKDTree(shapely.get_coordinates(shapely.segmentize(rings, APART))) if rings else None
    found, size = [], SIZES[0][0]
    columns, rows = np.arange(x0, x1, size), np.arange(y0, y1, size)
    cells = np.stack(np.meshgrid(columns, rows), axis=-1).reshape(-1, 2)
    for size, _ in SIZES:
        around = np.concatenate([cells + [a * size, b * size] for a in (0, 1) for b in (0, 1)])
        around = np.unique(np.minimum(around, [x1, y1]), axis=0)
        away = np.full(len(around), np.inf) if tree is None else tree.query(around)[0]
        found.append(around[away > NEAREST * size])
        if tree is None or size == SIZES[-1][0]:
            break
        half, reach = size / 2, SIZES[len(found)][1]
        near = tree.query(cells + half)[0] < reach + size * 0.71
        near |= (size > WATERSIDE) & ~np.isnan(ground.water_level(*(cells + half).T))
        cells = np.concatenate([cells[near] + [a * half, b * half] for a in (0, 1) for b in (0, 1)])
    flat = np.unique(np.concatenate(found), axis=0)
    if tree is not None:  # corners of larger squares, between those of smaller ones
        away = tree.query(flat)[0]
        flat = flat[away > NEAREST * SIZES[-1][0]]
    flat = flat[np.isnan(ground.road(*flat.T))]
    return np.column_stack([flat, ground.beside(*flat.T)])


def _triangles(points: Array, ground: Ground) -> NDArray[np.int64]:
    middle = points[:, :2].mean(axis=0)
    found = np.asarray(Delaunay(points[:, :2] - middle).simplices, np.int64)
    a, b, c = (points[found[:, k], :2] for k in range(3))
    turn = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    found[turn < 0] = found[turn < 0][:, ::-1]
    inside = ~np.isnan(ground.road(*((a + b + c) / 3).T))
    return found[~inside & (np.abs(turn) > 1e-9)]


def _with_missing_halved(rings: tuple[Array, ...], triangles: NDArray[np.int64]) -> tuple[Array, ...] | None:
    """Returns the rings with a point in the middle of each segment that is no triangle's side, or None."""
    n = int(triangles.max(initial=0)) + 1
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    there = np.unique(sides.min(axis=1) * n + sides.max(axis=1))
    out, start, is_whole = [], 0, True
    for ring in rings:
        one = start + np.arange(len(ring))
        other = np.roll(one, -1)
        lost = ~np.isin(np.minimum(one, other) * n + np.maximum(one, other), there)
        start += len(ring)
        if lost.any():
            is_whole = False
            middles = (ring + np.roll(ring, -1, axis=0)) / 2
            ring = np.insert(ring, np.flatnonzero(lost) + 1, middles[lost], axis=0)
        out.append(ring)
    return None if is_whole else tuple(out)
