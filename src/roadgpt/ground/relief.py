"""Shapes the land before any road is laid into it: heights and water by kind of land, around a given way.

The way comes first. Near it the land has its height; away from it hills, valleys, ridges and water grow.
Noise is gradient noise in several octaves. Source: Perlin, *Improving Noise*, SIGGRAPH 2002."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from roadgpt.brief.amount import span
from roadgpt.brief.scene import Land
from roadgpt.brief.words import LandKind
from roadgpt.compiled import compiled, inlined
from roadgpt.geometry.curve import Array
from roadgpt.language.table import LANDFORMS

CELL = 8.0  # m between the points of land that is made
MARGIN = 130.0  # m of land around the way
LEAST = 40.0  # m, least side of the area without the margin
HORIZON = (300.0, 700.0, 1500.0, 3000.0, 6000.0, 9000.0)  # m beyond the margin: rings of points that are seen
BEARINGS = 72  # points of each ring
FREE = 4.0  # m beside the centre line, up to which the land has the height of the way
PASSES = 2  # of smoothing
SHORE = 1.2  # m, least height of any road above water near it
DEEP = 3.0  # m of water
BANK, BEACH = 0.25, 0.12  # slopes below and above the edge of water
BESIDE = 45.0  # m beside a stretch that is crossed, within which roads belong to it
DAMMED = 70.0  # m from the edge of water within which roads are not lower than it
GORGE = 5.0  # m below a road, most that a river is lower beside it than elsewhere
STRAIGHT_ON = 5.0  # m between the points by which a line is continued before its start and behind its end

OVER: dict[str, tuple[str, ...]] = {
    "valley": ("bridge", "embankment"), "river": ("bridge",), "lake": ("bridge",), "coast": ("bridge",),
    "ridge": ("tunnel", "cutting"),
}  # fmt: skip
"""What a way crosses something on, or in."""
RISES = {
    ("valley", "bridge"): (-16.0, 0.4, 20.0), ("ridge", "tunnel"): (22.0, 0.6, 22.0),
    ("bridge", ""): (-11.0, 0.5, 12.0), ("tunnel", ""): (18.0, 0.6, 22.0),
    ("cutting", ""): (7.0, 0.6, 25.0), ("embankment", ""): (-6.0, 0.6, 25.0),
    ("valley", ""): (-9.0, 0.6, 25.0), ("ridge", ""): (13.0, 0.6, 25.0),
}  # fmt: skip
"""Rises of land that is crossed: m, share of half the length up to which it is so high, and m beyond it."""


@dataclass(frozen=True)
class _Hills:
    hills: float  # m, height of the hills; their length is next
    length: float
    far: float  # m, height of the hills at the horizon
    grown: float  # m from the way, where they have their height


HILLS: dict[LandKind, _Hills] = {
    "flat": _Hills(1.5, 140.0, 8.0, 90.0),
    "rolling": _Hills(5.0, 150.0, 30.0, 80.0),
    "hilly": _Hills(14.0, 220.0, 120.0, 110.0),
    "mountain": _Hills(60.0, 420.0, 900.0, 190.0),
}
"""Ours: heights that fit the names in a landscape of Central Europe."""


@dataclass(frozen=True, eq=False)
class Relief:
    """Heights of the land on a square grid, as it would be without roads."""

    x: float  # of the first column in metres
    y: float  # of the first row
    cell: float  # m between rows and columns
    heights: Array
    """Heights in metres, of shape (rows, columns). Between the points, the surface is the cubic of Catmull
    and Rom, which passes through them; outside, the land has the height of the border."""
    water: Array
    """Heights of the surface of water in metres, of the same shape; NaN where there is none near. Where the
    land is higher than the water, it is dry."""
    beyond: Array
    """Points ``(n, 3)`` in metres outside the grid, as far as the horizon; may be empty."""

    @property
    def size(self) -> tuple[float, float]:
        """The extent along x and y in metres."""
        rows, columns = self.heights.shape
        return (columns - 1) * self.cell, (rows - 1) * self.cell

    def at(self, x: Array, y: Array) -> Array:
        """Returns the heights ``(n,)`` in metres at points ``x``, ``y``, ``(n,)`` each."""
        return sampled(self.heights, self.x, self.y, self.cell, np.asarray(x, float), np.asarray(y, float))


@inlined
def cubic_at(table: Array, x0: float, y0: float, cell: float, x: float, y: float) -> float:
    """Returns the height of Catmull's and Rom's surface through a grid at one point."""
    rows, columns = table.shape
    u = min(max((x - x0) / cell, 0.0), columns - 1.0)
    v = min(max((y - y0) / cell, 0.0), rows - 1.0)
    i, j = min(int(u), columns - 2), min(int(v), rows - 2)
    across, up = _weights(u - i), _weights(v - j)
    found = 0.0
    for b in range(4):
        row = 0.0
        at = min(max(j + b - 1, 0), rows - 1)
        for a in range(4):
            row += across[a] * table[at, min(max(i + a - 1, 0), columns - 1)]
        found += up[b] * row
    return found


@inlined
def _weights(u: float) -> tuple[float, float, float, float]:
    first, last = -0.5 * u * (1.0 - u) * (1.0 - u), -0.5 * u * u * (1.0 - u)
    return first, 1.0 + u * u * (1.5 * u - 2.5), u * (0.5 + u * (2.0 - 1.5 * u)), last


@compiled
def sampled(table: Array, x0: float, y0: float, cell: float, x: Array, y: Array) -> Array:
    """Returns the heights ``(n,)`` of the surface through a grid at n points."""
    found = np.empty(len(x))
    for n in range(len(x)):
        found[n] = cubic_at(table, x0, y0, cell, x[n], y[n])
    return found


@dataclass(frozen=True, eq=False)
class Way:
    """The points of a way that land is made around, and those of all roads."""

    points: Array  # (n, 3) along the tested car's road, in metres
    others: Array  # (m, 3) on all roads, those of the way among them

    @classmethod
    def through_the_middle(cls, size: float, height: float, seed: int) -> "Way":
        """Returns a way from west to east through a square, for land that is made without any road."""
        rng = np.random.default_rng(seed)
        x = np.arange(0.0, size + 2.0, 2.0)
        waves = np.sin(np.outer(x * np.pi / size, (1, 2, 4)) + rng.uniform(0, 2 * np.pi, 3))
        y = size * (0.5 + waves @ (0.06, 0.04, 0.02))
        points = np.column_stack([x, y, np.full_like(x, height)])
        return cls(points, points)

    @property
    def box(self) -> tuple[Array, Array]:
        """The least and the greatest x and y of land around it, in metres."""
        low, high = self.others[:, :2].min(axis=0), self.others[:, :2].max(axis=0)
        low, high = np.minimum(low, (low + high - LEAST) / 2), np.maximum(high, (low + high + LEAST) / 2)
        return low - MARGIN, high + MARGIN


@dataclass(frozen=True)
class Stretch:
    """A part of a way that leads through or along something of the landscape, in metres along the way."""

    land: Land
    start: float
    end: float
    of: float  # the length of the way
    structure: Land | None = None  # the bridge or the tunnel by which the way crosses it

    @property
    def middle(self) -> float:
        """The station of its middle in metres."""
        return (self.start + self.end) / 2

    @property
    def length(self) -> float:
        """Its length in metres."""
        return self.end - self.start


def crosses(land: Land) -> bool:
    """Returns whether a way leads across something of the landscape, and has a bridge, tunnel, cutting or
    embankment there."""
    row = LANDFORMS[land.kind]
    return row.structure or (land.lie in ("across", "through") and row.crossed is not None)


def stretches(lands: Sequence[Land], length: float) -> tuple[Stretch, ...]:
    """Returns where a way of this length leads along or across each of the lands, in their order.

    A bridge belongs to the valley or the water that is named beside it, and a tunnel to the ridge. A river
    is crossed on a bridge, also where none is named. What is crossed shares the way evenly."""
    crossed: list[tuple[Land, Land | None]] = []
    for land in lands:
        for _ in range(max(1, round(span(land.count).lo)) if crosses(land) else 0):
            alone = [n for n, (each, own) in enumerate(crossed) if own is None]
            over = next((n for n in alone if land.kind in OVER.get(crossed[n][0].kind, ())), None)
            under = next((n for n in alone if crossed[n][0].kind in OVER.get(land.kind, ())), None)
            if over is not None:
                crossed[over] = crossed[over][0], land
            elif under is not None:
                crossed[under] = land, crossed[under][0]
            else:
                crossed.append((land, None))
    found = [Stretch(land, 0.0, length, length) for land in lands if not crosses(land)]
    for number, (land, structure) in enumerate(crossed):
        if structure is None and land.kind in ("river", "lake", "coast"):
            structure = Land(kind="bridge")
        named = structure or land
        row = LANDFORMS[named.kind]
        said = span(named.length).lo if named.length else row.length or row.crossed or 0.0
        long = min(said, 0.7 * length / len(crossed))
        middle = (number + 0.5) * length / len(crossed)
        found.append(Stretch(land, middle - long / 2, middle + long / 2, length, structure))
    return tuple(found)


def away_of(land: Land) -> float:
    """Returns how far what lies beside the way is away from it, in metres."""
    return span(land.away).lo if land.away else LANDFORMS[land.kind].away or 0.0


@dataclass(frozen=True, eq=False)
class _Places:
    """Where points lie from the way and the roads."""

    x: Array
    y: Array
    share: Array  # of the way, 0 at its start and 1 at its end
    side: Array  # 1 left of it, -1 right
    away: Array  # m from the way
    free: Array  # m from the nearest road

    @classmethod
    def of(cls, x: Array, y: Array, way: Way) -> "_Places":
        flat, points = np.column_stack([x.ravel(), y.ravel()]), way.points[:, :2]
        free = np.asarray(cKDTree(way.others[:, :2]).query(flat)[0])
        line = _continued(points)
        away, nearest = map(np.asarray, cKDTree(line).query(flat))
        ahead = np.gradient(line, axis=0)[nearest]
        off = flat - line[nearest]
        side = np.where(ahead[:, 0] * off[:, 1] - ahead[:, 1] * off[:, 0] >= 0, 1.0, -1.0)
        share = (nearest - (len(line) - len(points)) // 2).clip(0, len(points) - 1) / max(1, len(points) - 1)
        return cls(x, y, *(each.reshape(x.shape) for each in (share, side, away, free)))


def _continued(line: Array) -> Array:
    """Returns a line ``(n, 2)`` that leads straight on before its start and behind its end."""
    steps = np.arange(STRAIGHT_ON, STRAIGHT_ON * 160, STRAIGHT_ON)[:, None]
    ahead = line[-1] - line[-2], line[0] - line[1]
    out, back = (v / max(float(np.hypot(*v)), 1e-9) for v in ahead)
    return np.concatenate([(line[0] + steps * back)[::-1], line, line[-1] + steps * out])


def made(
    way: Way, kind: LandKind, stretches: Sequence[Stretch], seed: int, box: tuple[Array, Array] | None = None
) -> Relief:
    """Returns land of a kind around a way, with valleys, ridges and water.

    ``box`` are the least and the greatest x and y; None: as far around the roads as pictures need it."""
    low, high = way.box if box is None else box
    if box is None:  # with room for what lies far away
        far_away = [away_of(each.land) - (LANDFORMS[each.land.kind].away or 0.0) for each in stretches]
        low, high = low - max([0.0, *far_away]), high + max([0.0, *far_away])
    x, y = (np.arange(low[i], high[i] + CELL, CELL) for i in (0, 1))
    places = _Places.of(*np.meshgrid(x, y), way)
    base = _base(places, way, x, y)
    heights, water = _shaped(places, base, way, kind, stretches, seed)
    far = () if box else _beyond(low, high, float(base.mean()), way, kind, stretches, seed)
    beyond = np.reshape(far, (-1, 3))
    return Relief(float(x[0]), float(y[0]), CELL, heights, water, beyond)


def rings_around(low: Array, high: Array) -> Array:
    """Returns points ``(n, 2)`` as far as the horizon around the box from ``low`` to ``high``."""
    middle, radius = (low + high) / 2, float(np.hypot(*(high - low))) / 2
    turn = np.arange(BEARINGS) * 2 * np.pi / BEARINGS
    rings = [
        middle + (radius + far) * np.column_stack([np.cos(turn + n), np.sin(turn + n)])
        for n, far in enumerate(HORIZON)
    ]
    return np.concatenate(rings)


def _beyond(
    low: Array, high: Array, level: float, way: Way, kind: LandKind, stretches: Sequence[Stretch], seed: int
) -> Array:
    flat = rings_around(low, high)
    places = _Places.of(flat[:, 0], flat[:, 1], way)
    heights, water = _shaped(places, np.full(len(flat), level), way, kind, stretches, seed)
    far = np.repeat(HORIZON, BEARINGS)
    rise = HILLS[kind].far * (0.5 + noise(flat[:, 0], flat[:, 1], 2600.0, 3, seed + 1))
    heights = heights + np.where(np.isnan(water), rise * smooth(far, 0.0, 4000.0), 0.0)
    heights[-BEARINGS:] = np.minimum(heights[-BEARINGS:], level - 10.0)
    return np.column_stack([flat, heights])


def _base(places: _Places, way: Way, x: Array, y: Array) -> Array:
    """Returns the heights of the roads, continued smoothly over a whole grid: means of means of what is near
    (push and pull; Gortler et al., *The Lumigraph*, SIGGRAPH 1996)."""
    total, count = np.zeros(places.x.shape), np.zeros(places.x.shape)
    i = np.rint((way.others[:, 0] - x[0]) / CELL).astype(int).clip(0, len(x) - 1)
    j = np.rint((way.others[:, 1] - y[0]) / CELL).astype(int).clip(0, len(y) - 1)
    np.add.at(total, (j, i), way.others[:, 2])
    np.add.at(count, (j, i), 1.0)
    known, heights = (count > 0).astype(float), np.zeros(places.x.shape)
    for _ in range(PASSES):  # each brings what smoothing left over
        left = known * (total / np.maximum(count, 1) - heights)
        heights += gaussian_filter(_pulled(left, known), 1.0, mode="nearest")
    return heights


def _pulled(values: Array, known: Array) -> Array:
    if known.all():
        return values
    rows, columns = (-(-n // 2) * 2 for n in values.shape)
    pad = [(0, rows - values.shape[0]), (0, columns - values.shape[1])]
    weights = np.pad(known, pad)
    sums = np.pad(values * known, pad)
    weights, sums = (a.reshape(rows // 2, 2, columns // 2, 2).sum(axis=(1, 3)) for a in (weights, sums))
    below = _pulled(sums / np.maximum(weights, 1e-12), np.minimum(weights, 1.0))
    below = gaussian_filter(below, 1.0, mode="nearest")
    above = np.repeat(np.repeat(below, 2, axis=0), 2, axis=1)[: values.shape[0], : values.shape[1]]
    return values * known + above * (1.0 - known)


def _shaped(
    places: _Places, base: Array, way: Way, kind: LandKind, stretches: Sequence[Stretch], seed: int
) -> tuple[Array, Array]:
    usual = HILLS[kind]
    hills = noise(places.x, places.y, usual.length, 4, seed)
    if kind == "mountain":
        hills = 1.0 - 2.0 * np.abs(hills)  # ridges where noise changes its sign (Musgrave 1994)
    heights = base + usual.hills * hills * smooth(places.free, FREE, usual.grown)
    if kind == "mountain":  # the way lies on a slope
        uphill = places.side * _chosen(seed)
        lean = np.where(uphill > 0, 0.5, -0.4) * np.minimum(np.maximum(places.free - FREE, 0.0), 160.0)
        if lean.ndim == 2:  # without steps between the sides of the way, far from it
            lean = gaussian_filter(lean, 1.5, mode="nearest")
        heights = heights + lean
    water = np.full(heights.shape, np.nan)
    sides = _free_sides(stretches, seed)
    for number, (stretch, side) in enumerate(zip(stretches, sides, strict=True)):
        wave = noise(places.x, places.y, 160.0, 3, seed + 11 * number + 3)
        if stretch.land.kind in ("lake", "coast", "river"):
            heights, water = _with_water(heights, water, stretch, side, places, way, wave)
        else:
            heights = heights + _rise(stretch, side, places, wave, way)
    return heights, water


def _free_sides(stretches: Sequence[Stretch], seed: int) -> list[float]:
    """Returns the side of each stretch: 1 left, -1 right. Where none is said, water and ridges take turns."""
    found, turn = [], _chosen(seed)
    for stretch in stretches:
        said = {"left": 1.0, "right": -1.0}.get(stretch.land.side or "", turn)
        if stretch.land.side or stretch.land.kind in ("lake", "coast", "river", "ridge"):
            turn = -said
        found.append(said)
    return found


def _chosen(seed: int) -> float:
    return 1.0 if np.random.default_rng([seed, 5]).random() < 0.5 else -1.0


def _across(stretch: Stretch, places: _Places, way: Way) -> tuple[Array, Array]:
    """Returns how far points lie from the middle of a stretch, in metres along the way's direction there; and
    a share from 0 to 1 that falls to 0 near all parts of roads that are not this stretch."""
    points, stations = way.points, np.linspace(0.0, stretch.of, len(way.points))
    at = int(np.abs(stations - stretch.middle).argmin())
    ahead = points[min(at + 1, len(points) - 1), :2] - points[max(at - 1, 0), :2]
    ahead = ahead / max(float(np.hypot(*ahead)), 1e-9)
    along = (places.x - points[at, 0]) * ahead[0] + (places.y - points[at, 1]) * ahead[1]
    reach = stretch.length / 2 + BESIDE
    near = np.hypot(*(way.others[:, :2] - points[at, :2]).T) < reach
    own = points[np.abs(stations - stretch.middle) < reach, :2]
    other = way.others[~near, :2]
    if not len(other):
        return along, np.ones_like(along)
    away = _from(other, places)
    if len(own):
        away = np.where(_from(own, places) < FREE + 6.0, np.inf, away)
    return along, smooth(away, 12.0, 60.0)


def _beside(stretch: Stretch, side: float, way: Way, first: float, share: float) -> Array:
    """Returns a line ``(n, 2)`` beside the middle ``share`` of a stretch, ``first`` metres from the way."""
    stations = np.linspace(0.0, stretch.of, len(way.points))
    line = way.points[:, :2]
    ahead = np.gradient(line, axis=0)
    ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    off = line + side * first * np.column_stack([-ahead[:, 1], ahead[:, 0]])
    kept = np.abs(stations - stretch.middle) <= share * stretch.of / 2
    return np.asarray(off[kept] if kept.any() else off)


def _from(line: Array, places: _Places) -> Array:
    flat = np.column_stack([places.x.ravel(), places.y.ravel()])
    return np.asarray(cKDTree(line).query(flat)[0]).reshape(places.x.shape)


def _rise(stretch: Stretch, side: float, places: _Places, wave: Array, way: Way) -> Array:
    """Returns by how much a valley, a ridge, a cutting or an embankment raises the land."""
    land, free = stretch.land, places.free
    if crosses(stretch.land):
        return _crossing_rise(stretch, places, way)
    if land.kind == "valley":
        rise = 90.0 * np.tanh(np.maximum(free - 18.0, 0.0) / 150.0) * (1.0 + 0.35 * wave)
        return rise if land.side is None else -rise * (places.side == side) / 2
    if land.is_crest:
        return np.asarray(-45.0 * np.tanh(np.maximum(free - 12.0, 0.0) / 90.0))
    if land.kind == "ridge":
        away = _from(_beside(stretch, side, way, away_of(land), 1.0), places)
        return np.asarray(
            55.0 * np.exp(-((away / 45.0) ** 2)) * (1.0 + 0.3 * wave) * smooth(free, FREE, 60.0)
        )
    return np.zeros_like(free)


def _crossing_rise(stretch: Stretch, places: _Places, way: Way) -> Array:
    structure = stretch.structure.kind if stretch.structure else ""
    height, inner, outer = RISES.get((stretch.land.kind, structure)) or RISES[stretch.land.kind, ""]
    along, share = _across(stretch, places, way)
    half = max(stretch.length / 2, 12.0)
    return np.asarray(height * share * (1.0 - smooth(np.abs(along), half * inner, half + outer)))


def _with_water(
    heights: Array, water: Array, stretch: Stretch, side: float, places: _Places, way: Way, wave: Array
) -> tuple[Array, Array]:
    """Returns heights and water with a lake, a river or a coast beside the way or across it."""
    kind = stretch.land.kind
    stations = np.linspace(0.0, stretch.of, len(way.points))
    if crosses(stretch.land):
        wide = min({"river": 8.0, "lake": 40.0, "coast": 40.0}[kind], max(stretch.length / 2 - 6.0, 5.0))
        along, share = _across(stretch, places, way)
        out = np.abs(along + 14.0 * wave * smooth(places.away, 20.0, 80.0)) - wide
        if kind != "river":
            out = np.maximum(out, places.away - 200.0)
        near = way.points[np.abs(stations - stretch.middle) <= 2 * wide, 2]
        level = np.full(heights.shape, float(near.min(initial=way.points[:, 2].max())) - 6.0)
        reach = 14.0
        out = np.where(share > 0.5, out, np.maximum(out, 60.0 * (1.0 - 2.0 * share)))
    else:
        first = away_of(stretch.land)
        wide, part = {"river": (9.0, 1.0), "lake": (70.0, 0.55), "coast": (90.0, 1.0)}[kind]
        axis = _beside(stretch, side, way, first + wide, part)
        axis = _continued(axis) if kind == "river" else axis
        away, nearest = cKDTree(axis).query(np.stack([places.x, places.y], axis=-1))
        out = away - wide + 8.0 * wave
        if kind == "coast":
            out = np.minimum(out, _behind(way, side, places) + 8.0 * wave)
        out = np.maximum(out, first - 10.0 - places.free)
        reach = max(45.0 if kind == "river" else DAMMED, first + 15.0)
        near = cdist(axis, way.others[:, :2]) < wide + reach
        if kind == "river":
            level = _falling(axis, near, way)[nearest]
        else:
            lowest = float(way.others[near.any(axis=0) | (kind == "coast"), 2].min())
            level = np.full(heights.shape, lowest - SHORE - 0.8)
        reach = 40.0
    shore = level + np.where(out < 0.0, np.maximum(BANK * out, -DEEP), BEACH * out)
    inland = smooth(out, 6.0, reach)
    drawn = np.where(out < reach, shore + (heights - shore) * inland, heights)
    dam = level + 0.5 * (1.0 - smooth(out, 40.0, 60.0))
    lowered = np.where((out > 4.0) & (out < 60.0), np.maximum(drawn, dam), drawn)
    return lowered, np.where(out < 3.0 * CELL, level, water)


def _falling(axis: Array, near: NDArray[np.bool_], way: Way) -> Array:
    """Returns the heights ``(n,)`` of the water along a river: below all roads near it, and lower and lower
    on its way, unless a road beside it climbs out of reach."""
    lowest = np.where(near, way.others[:, 2], np.inf).min(axis=1)
    known = np.flatnonzero(np.isfinite(lowest))
    lowest = np.interp(np.arange(len(axis)), known, lowest[known])
    down = slice(None) if lowest[0] > lowest[-1] else slice(None, None, -1)
    falling = np.maximum(np.minimum.accumulate(lowest[down])[down], lowest - GORGE)
    return np.asarray(falling - SHORE - 2.5)


def _behind(way: Way, side: float, places: _Places) -> Array:
    """Returns the distance in metres from the open sea: all that lies on one side of all roads."""
    chord = way.points[-1, :2] - way.points[0, :2]
    chord = chord / max(float(np.hypot(*chord)), 1e-9)
    normal = side * np.array([-chord[1], chord[0]])
    edge = float((way.others[:, :2] @ normal).max()) + 70.0
    return np.asarray(edge - places.x * normal[0] - places.y * normal[1])


def smooth(values: Array, low: float, high: float) -> Array:
    """Returns 0 up to ``low``, 1 from ``high`` on, and a smooth step in between."""
    share = np.clip((values - low) / (high - low), 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share))


def noise(x: Array, y: Array, length: float, octaves: int, seed: int) -> Array:
    """Returns gradient noise between about -1 and 1 at points, with waves ``length`` metres long, and shorter
    ones of half the height for each octave."""
    found, height = np.zeros(np.shape(x)), 1.4
    for octave in range(octaves):
        found += height * _gradient_noise(x / length, y / length, seed * 131 + octave)
        length, height = length / 2.0, height / 2.1
    return found


def _gradient_noise(u: Array, v: Array, seed: int) -> Array:
    i, j = np.floor(u).astype(np.int64), np.floor(v).astype(np.int64)
    du, dv = u - i, v - j
    su, sv = (d * d * d * (d * (d * 6 - 15) + 10) for d in (du, dv))
    rows = []
    for b in (0, 1):
        knots = []
        for a in (0, 1):
            angle = _hashed(i + a, j + b, seed) * (2 * np.pi / 4294967296.0)
            knots.append(np.cos(angle) * (du - a) + np.sin(angle) * (dv - b))
        rows.append(knots[0] + su * (knots[1] - knots[0]))
    return np.asarray(rows[0] + sv * (rows[1] - rows[0]))


def _hashed(i: NDArray[np.int64], j: NDArray[np.int64], seed: int) -> NDArray[np.float64]:
    """Returns whole numbers below 2^32 that look random (Wang's mixing of bits)."""
    mask = np.int64(0xFFFFFFFF)
    h = (i * 374761393 + j * 668265263 + seed * 2246822519) & mask
    h = ((h ^ (h >> 13)) * 1274126177) & mask
    h = ((h ^ (h >> 16)) * 2246822519) & mask
    return np.asarray((h ^ (h >> 15)), float)
