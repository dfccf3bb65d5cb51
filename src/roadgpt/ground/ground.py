"""Defines the Ground: the land around roads, with the roads laid into it.

On carriageways, junctions and verges, the height is that of the road's own surface. Beside them, slopes lead
up or down to the land."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from roadgpt.geometry.curve import Array
from roadgpt.ground import grading
from roadgpt.ground.grading import Layers
from roadgpt.ground.relief import Relief

SLOPE = 0.5  # metres up or down for each metre aside: 1:2, usual for earthworks (FHWA, AASHTO 4.8.4)
STEEPER, STEEPEST = 1.5, 3.0  # than the land, of slopes on steep land; metres up for each metre aside at most
ASIDE = 10.0  # m, where the slope of the land is measured
FINEST, MOST_CELLS = 1.0, 1_100_000  # m, smallest cell; cells of a grid at most
SAME = 2e-4  # m between a corner of an outline and the corner of the surface that it is
INSIDE = 1e-4  # m inside an outline, where the height of the surface is read


def _left_of(ring: Array) -> Array:
    """Returns unit vectors ``(n, 2)`` to the left of a closed ring ``(n, 2)`` at its corners."""
    ahead = np.roll(ring, -1, axis=0) - ring
    ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    both = ahead + np.roll(ahead, 1, axis=0)
    left = np.column_stack([-both[:, 1], both[:, 0]])
    return np.asarray(left / np.maximum(np.hypot(*left.T), 1e-9)[:, None])


def _sides_of(triangles: Array) -> Array:
    """Returns the outer edges ``(n, 6)`` of triangles ``(k, 3, 3)``: those that no two of them share."""
    corners = np.round(triangles.reshape(-1, 3), 6)
    points, at = np.unique(corners, axis=0, return_inverse=True)
    numbers = at.reshape(-1, 3)
    edges = np.concatenate([numbers[:, k] for k in ([0, 1], [1, 2], [2, 0])])
    single, counts = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    return np.asarray(points[single[counts == 1]].reshape(-1, 6))


def slope_for(relief: Relief, points: Array) -> float:
    """Returns the slope of cuttings and fills for a road through points ``(n, 3)``: SLOPE, or steeper where
    the land is so steep that slopes of SLOPE would hardly end."""
    x, y = np.asarray(points[:, 0]), np.asarray(points[:, 1])
    rise_x, rise_y = (
        (relief.at(x + dx, y + dy) - relief.at(x - dx, y - dy)) / (2 * ASIDE)
        for dx, dy in ((ASIDE, 0.0), (0.0, ASIDE))
    )
    steep = float(np.quantile(np.hypot(rise_x, rise_y), 0.95))
    return float(np.clip(STEEPER * steep, SLOPE, STEEPEST))


class Span(NamedTuple):
    """A part of a road on a bridge or in a tunnel: there, the ground does not meet the road."""

    kind: Literal["bridge", "tunnel"]
    road: int  # the id of the road
    start: float  # station in metres
    end: float


class Portal(NamedTuple):
    """The mouth of a tunnel."""

    left: Array  # the corner (3,) of the road's surface on the left of someone who drives in, in metres
    right: Array
    ahead: Array  # unit vector (2,) into the tunnel
    high: float  # m from the road to the land above the tunnel


@dataclass(frozen=True, eq=False)
class Pavement:
    """The surface of all roads that lie on the ground, with their verges, in metres."""

    triangles: Array
    """The corners of triangles, ``(m, 3, 3)``. Where verges lie over a carriageway, those of the carriageway
    come first and count."""
    rims: tuple[Array, ...]
    """The outlines of the whole surface, closed rings ``(n, 3)``; the ground is on the right of each."""
    portals: tuple[Portal, ...] = ()
    covers: Array = field(default_factory=lambda: np.empty((0, 3, 3)))
    """The corners of triangles ``(k, 3, 3)`` over tunnels: the land is not lower there."""
    clear: Array = field(default_factory=lambda: np.empty((0, 3, 3)))
    """The corners of triangles ``(k, 3, 3)`` under bridges: the land is not higher there."""
    spans: tuple[Span, ...] = ()
    decks: Array = field(default_factory=lambda: np.empty((0, 3, 3)))
    """The corners of the surface of the road on the spans, ``(k, 3, 3)``."""

    @classmethod
    def of(cls, triangles: Array, outlines: Sequence[Array], **more: Any) -> "Pavement":
        """Returns the surface of triangles ``(m, 3, 3)`` with these outlines, rings ``(n, 2)`` that get the
        heights of the surface; ``more`` are the other fields."""
        if not outlines:
            return cls(triangles, (), **more)
        flat = np.concatenate(outlines)
        low, high = flat.min(axis=0) - 1.0, flat.max(axis=0) + 1.0
        side = max(FINEST, float(np.sqrt(np.prod(high - low) / MOST_CELLS)))
        rows, columns = (int(n / side) + 2 for n in (high - low)[::-1])
        plain = np.ascontiguousarray(triangles.reshape(-1, 9))
        x, y = low.tolist()
        starts, members = grading.buckets(plain, x, y, side, rows, columns)
        none, no = np.empty((rows, columns)), np.empty((0, 0), np.int32)
        layers = Layers(
            x, y, side, none, no, no, none, 0.0, 0.0, 1.0, none, 0, 0, plain, starts, members, SLOPE, none,
            none, none,
        )  # fmt: skip
        inwards = np.concatenate([_left_of(ring) for ring in outlines])
        heights = grading.roads_at(layers, *(flat + INSIDE * inwards).T)
        corners = triangles.reshape(-1, 3)
        away, nearest = map(np.asarray, cKDTree(corners[:, :2]).query(flat))
        points = np.column_stack([flat, np.where(np.isnan(heights), corners[nearest, 2], heights)])
        points[away < SAME] = corners[nearest[away < SAME]]
        ends = np.cumsum([len(ring) for ring in outlines])[:-1]
        rims = (ring[np.any(ring != np.roll(ring, 1, axis=0), axis=1)] for ring in np.split(points, ends))
        return cls(triangles, tuple(ring for ring in rims if len(ring) > 2), **more)

    @cached_property
    def segments(self) -> Array:
        """The segments of all rims at which slopes begin, ``(n, 6)``: all but those at portals."""
        parts = [np.hstack([ring, np.roll(ring, -1, axis=0)]) for ring in self.rims]
        found = np.concatenate(parts) if parts else np.empty((0, 6))
        for portal in self.portals:
            middle = (found[:, :3] + found[:, 3:]) / 2 - (portal.left + portal.right) / 2
            across = (found[:, :2] - found[:, 3:5]) @ portal.ahead
            at = np.hypot(*middle[:, :2].T) < np.hypot(*(portal.left - portal.right)[:2]) / 2 + SAME
            found = found[~(at & (np.abs(across) < 1e-2) & (np.abs(middle[:, :2] @ portal.ahead) < 0.05))]
        return found

    @cached_property
    def lintels(self) -> Array:
        """The lines ``(k, 6)`` above the mouths of tunnels from which the land rises."""
        lines = [np.r_[each.left, each.right] + [0, 0, each.high] * 2 for each in self.portals]
        return np.array(lines).reshape(-1, 6)


class Earthworks(NamedTuple):
    """What has to be dug and heaped up to lay the roads into the land."""

    cut: float  # m^3
    fill: float  # m^3


def _on_grid(relief: Relief, x: float, y: float, cell: float, rows: int, columns: int) -> Array:
    flat = np.meshgrid(x + cell * np.arange(columns), y + cell * np.arange(rows))
    return relief.at(*(each.ravel() for each in flat)).reshape(rows, columns)


@dataclass(frozen=True, eq=False)
class Ground:
    """Heights of the land with its roads, at every point."""

    relief: Relief
    pavement: Pavement
    layers: Layers

    @classmethod
    def of(
        cls, relief: Relief, pavement: Pavement, slope: float = SLOPE, cell: float | None = None
    ) -> "Ground":
        """Lays roads into land.

        Args:
            relief: the land without roads.
            pavement: the surface of the roads.
            slope: the largest slope of cuttings and fills, in metres up for each metre aside.
            cell: distance in metres between the points of the grid; None: 1 m, more on large maps."""
        rows, columns = (n - 1 for n in relief.heights.shape)
        if cell is None:
            cell = max(FINEST, float(np.sqrt(rows * columns * relief.cell**2 / MOST_CELLS)))
        shape = tuple(int(n * relief.cell / cell) + 1 for n in (rows, columns))
        triangles = np.ascontiguousarray(pavement.triangles.reshape(-1, 9))
        place = relief.x, relief.y, cell
        none, no = np.empty((1, 1)), np.empty((0, 0), np.int32)
        starts, members = grading.buckets(triangles, *place, *shape)
        under, over = _sides_of(pavement.clear), _sides_of(pavement.covers)
        segments = np.concatenate([under, pavement.segments, over])
        floors, rims = len(under), len(under) + len(pavement.segments)
        layers = Layers(
            *place, none, no, no, relief.heights, relief.x, relief.y, relief.cell,
            segments, floors, rims, triangles, starts, members, slope,
            np.ascontiguousarray(pavement.covers.reshape(-1, 9)), pavement.lintels,
            np.ascontiguousarray(pavement.clear.reshape(-1, 9)),
        )  # fmt: skip
        roofs = grading.on_roads(layers.covers, *place, *shape)
        land = _on_grid(relief, *place, *shape)
        if (at := np.argwhere(~np.isnan(roofs))).size:
            x, y = np.asarray(layers.x + cell * at[:, 1]), np.asarray(layers.y + cell * at[:, 0])
            land[tuple(at.T)] = grading.heights_at(layers, x, y, False)
        roads = grading.on_roads(triangles, *place, *shape)
        fixed = np.where(np.isnan(roads), roofs, roads)
        cuts, top = grading.spread(segments[:rims], land, fixed, *place, slope, 1.0)
        fills, floor = grading.spread(segments[floors:], land, fixed, *place, slope, -1.0)
        fills[fills >= 0] += floors
        graded = np.where(np.isnan(roofs), np.minimum(np.maximum(land, floor), top), land)
        heights = np.where(np.isnan(roads), graded, roads)
        layers = layers._replace(heights=heights, cuts=cuts, fills=fills)
        # on the exact cones, also where they met on the grid
        j, i = np.nonzero(((cuts >= 0) | (fills >= 0)) & np.isnan(roads))
        x, y = np.asarray(layers.x + cell * i), np.asarray(layers.y + cell * j)
        heights[j, i] = grading.heights_at(layers, x, y, False)
        return cls(relief, pavement, layers)

    @property
    def cell(self) -> float:
        """Distance in metres between the points of the grid."""
        return self.layers.cell

    @property
    def heights(self) -> Array:
        """Heights in metres at the points of the grid, roads included, (rows, columns)."""
        return self.layers.heights

    @cached_property
    def x(self) -> Array:
        """The columns of the grid in metres."""
        return np.asarray(self.layers.x + self.cell * np.arange(self.heights.shape[1]))

    @cached_property
    def y(self) -> Array:
        """The rows of the grid in metres."""
        return np.asarray(self.layers.y + self.cell * np.arange(self.heights.shape[0]))

    def height(self, x: Array, y: Array) -> Array:
        """Returns the exact heights ``(n,)`` in metres at points ``x``, ``y``, ``(n,)`` each, roads
        included. Beyond the grid, the height is that of the nearest point on its border."""
        return grading.heights_at(self.layers, np.asarray(x, float), np.asarray(y, float), True)

    def beside(self, x: Array, y: Array) -> Array:
        """Returns the heights ``(n,)`` that the ground would have if it were nowhere covered by roads."""
        return grading.heights_at(self.layers, np.asarray(x, float), np.asarray(y, float), False)

    def road(self, x: Array, y: Array) -> Array:
        """Returns the heights ``(n,)`` of the roads' surface in metres, NaN beside the roads."""
        return grading.roads_at(self.layers, np.asarray(x, float), np.asarray(y, float))

    def water(self, x: Array, y: Array) -> Array:
        """Returns the heights ``(n,)`` of the water's surface in metres, NaN where the ground is dry."""
        found = self.water_level(x, y)
        return np.asarray(np.where(self.height(x, y) < found, found, np.nan))

    def water_level(self, x: Array, y: Array) -> Array:
        """Returns the heights ``(n,)`` of the surface of water, also near its edge, else NaN."""
        level = self.relief.water
        i = np.rint((np.asarray(x, float) - self.relief.x) / self.relief.cell).astype(int)
        j = np.rint((np.asarray(y, float) - self.relief.y) / self.relief.cell).astype(int)
        rows, columns = level.shape
        return np.asarray(level[j.clip(0, rows - 1), i.clip(0, columns - 1)])

    @cached_property
    def earthworks(self) -> Earthworks:
        """The volumes of soil between the land and the ground that was made of it."""
        land = _on_grid(self.relief, self.layers.x, self.layers.y, self.cell, *self.heights.shape)
        above = (land - self.heights) * self.cell**2
        return Earthworks(float(above.clip(min=0).sum()), float((-above).clip(min=0).sum()))
