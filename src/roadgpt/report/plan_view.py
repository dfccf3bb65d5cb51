"""Draws the road from above, to scale: shoulders, carriageway, edge lines and centre dashes."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Polygon
from matplotlib.ticker import MultipleLocator

from roadgpt.geometry.curve import Array
from roadgpt.network import has_no_route, is_route
from roadgpt.report.canvas import GRASS
from roadgpt.report.text_width import POINTS
from roadgpt.road import Edges, Road, World

GROUND, VERGE, ASPHALT, PAINT = "#eef1ea", "#dcd9c3", "#b9bdc3", "#ffffff"
NARROWEST, WIDEST = 0.72, 2.0  # width over height of a frame
MOST_STATIONS, MOST_POINTS = 20_000, 1500  # of a road; of its centre line, beside which labels stand
FINEST = 0.5  # m
FAR_ASPHALT, THINNEST_LANE = "#8d939c", 2.5  # points: of a road that is seen from far away
STEPS = [step * 10.0**power for power in range(1, 7) for step in (1, 2, 2.5, 5)]  # m, cells of the grid
DASH, GAP = 3.0, 6.0  # m, of the centre line


@dataclass(frozen=True)
class Frame:
    """The part of the plane that a picture shows, in metres."""

    x0: float
    x1: float
    y0: float
    y1: float

    @classmethod
    def around(cls, points: Array, margin: float, least: float, size: float) -> "Frame":
        """Returns a frame that shows points ``(n, 2)`` with a margin, and is at least ``least`` wide and
        high. If possible, the frame ends at most ``margin`` outside the map, a square with the side ``size``.
        All is in metres.
        """
        low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
        width, height = np.maximum(high - low, least)
        shape = np.array([max(width, height * NARROWEST), max(height, width / WIDEST)])
        corner = (low + high - shape) / 2
        corner = np.clip(corner, -margin, np.maximum(size + margin - shape, -margin))
        corner = np.clip(corner, high - shape, low)
        return cls(corner[0], corner[0] + shape[0], corner[1], corner[1] + shape[1])

    def holds(self, x: float, y: float) -> bool:
        """Returns whether a point is inside the frame."""
        return self.x0 <= x <= self.x1 and self.y0 <= y <= self.y1

    @property
    def width(self) -> float:
        """Width in metres."""
        return self.x1 - self.x0

    @property
    def height(self) -> float:
        """Height in metres."""
        return self.y1 - self.y0


def show_from_above(axes: Axes, frame: Frame, most: int) -> None:
    """Sets limits, labels and grid of axes that show a frame to scale; the grid has at most ``most`` cells
    across.
    """
    axes.set(xlim=(frame.x0, frame.x1), ylim=(frame.y0, frame.y1), aspect="equal")
    axes.set_xlabel("x, metres east")
    axes.set_ylabel("y, metres north")
    step = next(step for step in STEPS if frame.width / step <= most)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MultipleLocator(step))
    axes.grid(color="white", lw=0.8, zorder=0.5)
    axes.set_axisbelow(True)


def stations_of(road: Road) -> Array:
    """Returns stations, shape ``(n,)``, close enough for smooth edges and including both ends of the road."""
    count = int(np.clip(road.length / FINEST, 2, MOST_STATIONS))
    return np.linspace(0.0, road.length, count + 1)


def plan_points(road: Road) -> Array:
    """Returns points, shape ``(n, 2)``, along the centre line of a road; for a route, also along the
    reference lines of all roads in its network."""
    s = stations_of(road)
    points: Array = road.at(s[np.linspace(0, len(s) - 1, min(len(s), MOST_POINTS)).astype(int)])[:, :2]
    if is_route(road):
        lines = [each.road.centreline(2.0)[:, :2] for each in road.network.roads]
        return np.concatenate([points, *lines])
    return points


def draw_road(axes: Axes, road: Road, world: World, per_inch: float) -> None:
    """Draws shoulders, carriageway and, where lanes are wide enough, markings; ``per_inch`` is the number
    of metres per inch of the picture. For a route, draws the whole network.
    """
    s, profile = stations_of(road), world.profile_of(road)
    if is_route(road):
        from roadgpt.report.network_view import draw_network, draw_network_from_far

        if is_far(road, world, per_inch):
            draw_network_from_far(axes, road, THINNEST_LANE)
        else:
            draw_network(axes, road, per_inch)
        return
    if profile.has_shoulders:
        _ribbon(axes, road, s, profile.rims(s), VERGE, 1)
    _ribbon(axes, road, s, profile.edges(s), ASPHALT, 2)
    if profile.median:
        _ribbon(axes, road, s, profile.sides(s), GRASS, 2.1)
    if is_far(road, world, per_inch):
        line = road.at(s)
        axes.plot(line[:, 0], line[:, 1], color=FAR_ASPHALT, lw=THINNEST_LANE, zorder=2)
        return
    solid = [t for mark, t in reversed(profile.boundaries(s)) if mark in ("solid", "double")]
    for t in solid:
        edge = road.at(s, t)
        axes.plot(edge[:, 0], edge[:, 1], color=PAINT, lw=1.1, zorder=3, solid_capstyle="butt")
    starts = np.arange(0.0, road.length, DASH + GAP)
    along = np.linspace(starts, np.minimum(starts + DASH, road.length), 4)
    broken = [t for mark, t in profile.boundaries(along) if mark == "broken"]
    for t in broken:
        dashes = road.at(along, t)[..., :2].swapaxes(0, 1)
        axes.add_collection(LineCollection(list(dashes), colors=PAINT, linewidths=1.1, zorder=3))


def is_far(road: Road, world: World, per_inch: float) -> bool:
    """Returns whether roads are drawn as lines, because their lanes are too narrow in the picture. The
    picture has ``per_inch`` metres per inch."""
    return float(world.profile_of(road).width(0.0)) / per_inch * POINTS < THINNEST_LANE


def _ribbon(axes: Axes, road: Road, s: Array, edges: Edges, colour: str, layer: float) -> None:
    outline = np.concatenate([road.at(s, edges.left), road.at(s, edges.right)[::-1]])[:, :2]
    axes.add_artist(Polygon(outline, closed=True, fc=colour, ec="none", zorder=layer))


def draw_ends(axes: Axes, road: Road, world: World) -> None:
    """Draws a black bar at the start of the road and a chequered bar at the end, over the lanes in the
    direction of the drive; nothing for a map without a route."""
    if has_no_route(road):
        return
    profile = world.profile_of(road)
    for s, colours in ((0.0, ("#1b1e23",)), (road.length, ("#1b1e23", "white"))):
        outer, inner = profile.edges(s), profile.sides(s)
        edges = (outer.left, inner.left) if profile.left_hand else (inner.right, outer.right)
        left, right = (float(t) for t in edges)
        count = max(4, 2 * round((left - right) / 2)) + 1  # squares of about a metre, at least four
        across = road.at(np.full(count, s), np.linspace(right, left, count))[:, :2]
        pairs = np.stack([across[:-1], across[1:]], axis=1)
        shades = [colours[i % len(colours)] for i in range(len(pairs))]
        axes.add_collection(LineCollection(list(pairs), colors=shades, linewidths=3.2, zorder=5))
