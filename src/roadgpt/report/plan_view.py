"""Draws the road from above, to scale: shoulders, carriageway, edge lines and centre dashes; and places
labels so that they cover neither the road nor each other."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.markers import MarkerStyle
from matplotlib.patches import PathPatch, Polygon
from matplotlib.path import Path as Outline
from matplotlib.ticker import MultipleLocator
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.language.names import Control
from roadgpt.network import network_of, only_road
from roadgpt.report.canvas import GRASS, HALO, INK, POINTS, SOFT, inches
from roadgpt.road import Edges, Road, World

if TYPE_CHECKING:
    from roadgpt.network import Network
    from roadgpt.network.markings import JunctionSign
    from roadgpt.network.paved import Area

TINT, ARROW = "#8fb3d6", "#0072b2"
KERB = "#e9e6dc"
FAR_ROADS, FAR_ROUTE = "#a7adb5", "#4d86b8"
LINE_POINTS, STOP_POINTS = 1.1, 2.2  # points, least width of a line on paper
SIGNS = {"stop": "#c1272d", "yield": "#c1272d", "priority": "#e0a800", "lights": "#2b2f36"}
SHAPES = {"stop": "8", "yield": "v", "priority": "D", "lights": "s"}
SIGN_NAMES = {
    "stop": "stop sign", "yield": "give-way sign", "priority": "priority sign", "lights": "traffic lights",
}  # fmt: skip
SIGN_SIZE = 4.2  # points
NEAR = 50.0  # m per inch; signs are not drawn on smaller scales
ARROWS, ARROW_POINTS = 20.0, 7.0  # m between the arrows on the route; points
HEAD = Outline([(1.0, 0.0), (-0.7, 0.75), (-0.3, 0.0), (-0.7, -0.75), (1.0, 0.0)], closed=True)
ARROW_INCHES = 0.5  # least distance between arrows
ROUTE_STEP = 0.5  # m between the points of the edges of the route


def draw_network(axes: Axes, route: Road, network: "Network", per_inch: float) -> None:
    """Draws a network and the lane of the route; a map without a route has no such lane. ``per_inch`` is the
    number of metres per inch of the picture."""
    from roadgpt.network.markings import arrows, between_crosswalks, strokes
    from roadgpt.network.paved import bays_of
    from roadgpt.network.paved import stations_of as stations_on
    from roadgpt.network.route import area_with_verges
    from roadgpt.network.surface import NetworkSurface

    surface = NetworkSurface.of(network)
    if surface.shoulder > 0:
        _fill(axes, area_with_verges(network), VERGE, 1)
    _fill(axes, network.paved, ASPHALT, 2)
    for bay in bays_of([member.road for member in network.roads_outside]):
        _fill(axes, bay, ASPHALT, 2)
    for area in surface.areas:
        for island in area.kerbed:
            _fill(axes, island, KERB, 2.1)
        for island in area.green if surface.shoulder > 0 else ():
            _fill(axes, island, GRASS, 2.1)
    for member in network.roads_outside:
        if member.profile.is_divided:
            first, last = between_crosswalks(network, member)
            s = stations_on(member.road)
            s = np.r_[first, s[(s > first) & (s < last)], last]
            _ribbon(axes, member.road, s, member.profile.edges_of(-member.profile.side, s), GRASS, 2.1)
    if route.has_way:
        _draw_route(axes, route, per_inch)
    painted = strokes(network)
    least = ((("edge", "lane"), LINE_POINTS), (("stop", "give_way"), STOP_POINTS), (("crosswalk",), 0.0))
    for kinds, width in least:
        found = [stroke for stroke in painted if stroke.kind in kinds]
        if found:
            points = max(width, found[0].width / per_inch * POINTS)
            lines = [stroke.points[:, :2] for stroke in found]
            axes.add_collection(
                LineCollection(lines, colors=PAINT, linewidths=points, zorder=3, capstyle="butt")
            )
    outlines = [each.points[:, :2] for each in arrows(network)]
    axes.add_collection(PolyCollection(outlines, facecolors=PAINT, edgecolors="none", zorder=3))
    for sign in signs_shown(network, per_inch):
        axes.plot(*sign.place[:2], **sign_style(sign.control), zorder=4)


def draw_network_from_far(axes: Axes, route: Road, network: "Network", points: float) -> None:
    """Draws the roads of a network as lines that are ``points`` wide, and the route as a darker line."""
    lines = [_middle_of(each.road, each.profile.edges) for each in network.roads]
    axes.add_collection(LineCollection(lines, colors=FAR_ROADS, linewidths=points, zorder=2))
    if route.has_way:
        assert route.profile is not None
        axes.plot(*_middle_of(route, route.profile.lane).T, color=FAR_ROUTE, lw=points, zorder=2.2)


def _middle_of(road: Road, between: Callable[[Array], Edges]) -> Array:
    """Returns the line ``(n, 2)`` in the middle between two edges beside the line of a road."""
    s = stations_of(road)
    return np.asarray(road.at(s, np.mean(between(s), axis=0))[:, :2])


def _fill(axes: Axes, area: "Area", colour: str, layer: float) -> None:
    axes.add_patch(PathPatch(path_of(area), fc=colour, ec="none", zorder=layer))


def rings_of(area: "Area") -> list[Array]:
    """Returns the outlines of an area and of the holes in it, each ``(n, 2)`` and closed."""
    import shapely

    parts = shapely.get_parts(area)
    rings = [ring for part in parts for ring in (part.exterior, *part.interiors)]
    return [np.asarray(ring.coords, float)[:, :2] for ring in rings]


def path_of(area: "Area") -> Outline:
    """Returns an area as a matplotlib path; the holes in the area stay empty."""
    import shapely

    rings, codes = rings_of(shapely.orient_polygons(area)), []
    for ring in rings:
        codes += [Outline.MOVETO, *[Outline.LINETO] * (len(ring) - 2), Outline.CLOSEPOLY]
    return Outline(np.concatenate(rings), codes)


def _draw_route(axes: Axes, route: Road, per_inch: float) -> None:
    assert route.profile is not None
    s = np.linspace(0.0, route.length, max(2, int(route.length / ROUTE_STEP)) + 1)
    left, right = route.profile.lane(s)
    ring = np.concatenate([route.at(s, left), route.at(s, right)[::-1]])[:, :2]
    pieces = [
        np.concatenate([ring[i : i + 2], ring[len(ring) - i - 2 : len(ring) - i]]) for i in range(len(s) - 1)
    ]
    axes.add_collection(PolyCollection(pieces, facecolors=TINT, edgecolors=TINT, linewidths=0.3, zorder=2.2))
    count = max(1, int(route.length / max(ARROWS, ARROW_INCHES * per_inch)))
    middle = (np.arange(count) + 0.5) * route.length / count
    places = route.at(middle, route.profile.middle(middle))[:, :2]
    for (x, y), heading in zip(places, route.heading(middle), strict=True):
        marker = MarkerStyle(HEAD).rotated(rad=float(heading))
        axes.plot(
            x, y, marker=marker, ms=ARROW_POINTS, mfc="white", mec=ARROW, mew=0.8, zorder=7.5, ls="none"
        )


def signs_shown(network: "Network", per_inch: float) -> "tuple[JunctionSign, ...]":
    """Returns the signs and lights to draw in a picture: none with more than 50 metres per inch."""
    from roadgpt.network.markings import signs

    return signs(network) if per_inch <= NEAR else ()


def sign_style(control: Control) -> dict[str, Any]:
    """Returns the keyword arguments with which matplotlib's ``plot`` draws a sign or a traffic light."""
    colour = SIGNS[control]
    return {
        "marker": SHAPES[control], "ms": SIGN_SIZE, "mfc": "white" if control == "yield" else colour,
        "mec": colour, "mew": 1.0, "ls": "none",
    }  # fmt: skip


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
        All is in metres."""
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
    """Sets limits, labels and grid of axes that show a frame to scale, at most ``most`` cells across."""
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
    """Returns points ``(n, 2)`` along a road; for a route, also along all roads of its network."""
    s = stations_of(road)
    points: Array = road.at(s[np.linspace(0, len(s) - 1, min(len(s), MOST_POINTS)).astype(int)])[:, :2]
    world = World()  # whose lanes do not matter here
    members = network_of(road, world).roads if only_road(road, world) is None else ()
    return np.concatenate([points, *(each.road.centreline(2.0)[:, :2] for each in members)])


def draw_road(axes: Axes, road: Road, world: World, per_inch: float) -> None:
    """Draws shoulders, carriageway and, where lanes are wide enough, markings; ``per_inch`` is the number
    of metres per inch of the picture. For a route, draws the whole network."""
    if only_road(road, world) is None:
        network = network_of(road, world)
        if is_far(road, world, per_inch):
            draw_network_from_far(axes, road, network, THINNEST_LANE)
        else:
            draw_network(axes, road, network, per_inch)
        return
    s, profile = stations_of(road), world.profile_of(road)
    if profile.has_shoulders:
        _ribbon(axes, road, s, profile.rims(s), VERGE, 1)
    _ribbon(axes, road, s, profile.edges(s), ASPHALT, 2)
    if profile.is_divided:
        _ribbon(axes, road, s, profile.edges_of(-profile.side, s), GRASS, 2.1)
    if is_far(road, world, per_inch):
        axes.plot(*_middle_of(road, profile.edges).T, color=FAR_ASPHALT, lw=THINNEST_LANE, zorder=2)
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
    """Returns whether lanes are so narrow at ``per_inch`` metres per inch that roads are drawn as lines."""
    return float(world.profile_of(road).width(0.0)) / per_inch * POINTS < THINNEST_LANE


def _ribbon(axes: Axes, road: Road, s: Array, edges: Edges, colour: str, layer: float) -> None:
    outline = np.concatenate([road.at(s, edges.left), road.at(s, edges.right)[::-1]])[:, :2]
    axes.add_artist(Polygon(outline, closed=True, fc=colour, ec="none", zorder=layer))


def draw_ends(axes: Axes, road: Road, world: World) -> None:
    """Draws a black bar at the start of the road and a chequered bar at the end, over the lanes in the
    direction of the drive; nothing for a map without a route."""
    if not road.has_way:
        return
    profile = world.profile_of(road)
    for s, colours in ((0.0, ("#1b1e23",)), (road.length, ("#1b1e23", "white"))):
        outer, inner = profile.edges(s), profile.centre(s)
        edges = (outer.left, inner) if profile.left_hand else (inner, outer.right)
        left, right = (float(t) for t in edges)
        count = max(4, 2 * round((left - right) / 2)) + 1  # squares of about a metre, at least four
        across = road.at(np.full(count, s), np.linspace(right, left, count))[:, :2]
        pairs = np.stack([across[:-1], across[1:]], axis=1)
        shades = [colours[i % len(colours)] for i in range(len(pairs))]
        axes.add_collection(LineCollection(list(pairs), colors=shades, linewidths=3.2, zorder=5))


SIZE, MINOR_SIZE, LINE = 10, 8.5, 0.19  # points, points, inches
Box = tuple[float, float, float, float]
"""Left, right, lower and upper border, metres."""
REACHES = (0.34, 0.5, 0.72, 1.0, 1.4)  # inches from the place to the label
FAR_REACHES = (1.9, 2.5, 3.2)  # inches, for minor labels only
COVERED = 16.0  # cost of covering another label
WAYS = 16

BORDER = "border of the map"
BORDER_SIZE, HIGH, BORDER_GAP = 8.5, 0.16, 0.05  # points; inches: of the letters, and from the border
PLACES = 9  # that are tried along a side
CLEAR = 12.0  # m from the centre line: carriageway, shoulder, and a little more


@dataclass
class Labels:
    """Places labels on axes so that they cover neither given points nor each other."""

    axes: Axes
    frame: Frame
    per_inch: float  # metres per inch of the picture
    clear_of: Array  # points ``(n, 2)`` that no label should cover
    radius: float
    """Radius in metres of the circle around each point of ``clear_of`` that no label should cover."""
    _boxes: list[Box] = field(default_factory=list)
    _leaders: list[Array] = field(default_factory=list)
    """Points on the lines that connect labels with their places, each ``(n, 2)``."""

    def name_border(self, size: float) -> None:
        """Labels the border of a square map with sides of ``size`` metres, if there is room."""
        wide = (inches(BORDER, BORDER_SIZE) + 0.1) * self.per_inch
        offers = _offers(self.frame, size, wide, HIGH * self.per_inch, BORDER_GAP * self.per_inch)
        clear = ((box, turned) for box, turned in offers if _distances(box, self.clear_of).min() > CLEAR)
        for box, turned in islice(clear, 1):
            self._boxes.append(box)
            self.axes.text(
                (box[0] + box[1]) / 2, (box[2] + box[3]) / 2, BORDER, ha="center", va="center",
                size=BORDER_SIZE, color=SOFT, rotation=90 if turned else 0, zorder=0.7,
            )  # fmt: skip

    def put(
        self,
        place: tuple[float, float],
        text: str,
        colour: str = INK,
        away: Array | None = None,
        is_minor: bool = False,
    ) -> bool:
        """Labels a place (x, y) in metres, if it is in the frame; ``away`` is the preferred direction of
        the label, of length 1. Minor labels have smaller letters and may be farther away; returns False if
        there was no room for a minor one."""
        if not self.frame.holds(*place):
            return True
        rows = text.split("\n")
        size, reaches = (MINOR_SIZE, REACHES + FAR_REACHES) if is_minor else (SIZE, REACHES)
        wide = (inches(text, size) + 0.1) * self.per_inch
        high = (len(rows) * LINE * size / SIZE + 0.04) * self.per_inch
        cost, x, y = min(self._offers(place, wide, high, away, reaches), key=lambda offer: offer[0])
        if is_minor and cost >= COVERED:
            return False
        self._boxes.append(_box(x, y, wide, high))
        self._leaders.append(_leader(place, x, y, self._boxes[-1]))
        self.axes.annotate(
            text, place, (x, y), ha="center", va="center", size=size, color=colour, zorder=12,
            path_effects=HALO, linespacing=1.15,
            arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.9, "shrinkA": 0, "shrinkB": 5},
        )  # fmt: skip
        return True

    def _offers(
        self,
        place: tuple[float, float],
        wide: float,
        high: float,
        away: Array | None,
        reaches: tuple[float, ...],
    ) -> list[tuple[float, float, float]]:
        offers = []
        for reach in reaches:
            for angle in np.arange(WAYS) * (2 * np.pi / WAYS):
                way = np.array([np.cos(angle), np.sin(angle)])
                # ``reach`` is the distance to the near side of the label, not to its middle
                x = place[0] + way[0] * (reach * self.per_inch + wide / 2)
                y = place[1] + way[1] * (reach * self.per_inch + high / 2)
                cost = reach + (0.0 if away is None else 0.6 * (1 - float(way @ away)))
                cost += self._cover(x, y, wide, high) + self._crossing(place, x, y, wide, high)
                offers.append((cost, x, y))
        return offers

    def _cover(self, x: float, y: float, wide: float, high: float) -> float:
        x0, x1, y0, y1 = box = _box(x, y, wide, high)
        is_covered = _distances(box, self.clear_of) < self.radius
        cost = 10.0 * float(is_covered.mean()) + 2.0 * bool(is_covered.any())
        cost += COVERED * sum(x0 < b and a < x1 and y0 < d and c < y1 for a, b, c, d in self._boxes)
        frame = self.frame
        return cost + 20.0 * (x0 < frame.x0 or x1 > frame.x1 or y0 < frame.y0 or y1 > frame.y1)

    def _crossing(self, place: tuple[float, float], x: float, y: float, wide: float, high: float) -> float:
        own = _box(x, y, wide, high)
        line = _leader(place, x, y, own)
        through = sum(bool(_inside(box, line).any()) for box in self._boxes)
        return 8.0 * (through + sum(bool(_inside(own, other).any()) for other in self._leaders))


def _box(x: float, y: float, wide: float, high: float) -> Box:
    return x - wide / 2, x + wide / 2, y - high / 2, y + high / 2


def _leader(place: tuple[float, float], x: float, y: float, box: Box) -> Array:
    line = np.linspace(place, (x, y), 24)
    return line[~_inside(box, line)]


def _inside(box: Box, points: Array) -> NDArray[np.bool_]:
    x0, x1, y0, y1 = box
    x, y = points.T
    return np.asarray((x > x0) & (x < x1) & (y > y0) & (y < y1))


def _offers(frame: Frame, size: float, wide: float, high: float, gap: float) -> Iterator[tuple[Box, bool]]:
    for y in (-gap - high, size + gap):
        if frame.y0 < y and y + high < frame.y1:
            for x in _along(max(frame.x0, 0.0) + wide / 2, min(frame.x1, size) - wide / 2):
                yield (x - wide / 2, x + wide / 2, y, y + high), False
    for x in (-gap - high, size + gap):
        if frame.x0 < x and x + high < frame.x1:
            for y in _along(max(frame.y0, 0.0) + wide / 2, min(frame.y1, size) - wide / 2):
                yield (x, x + high, y - wide / 2, y + wide / 2), True


def _along(low: float, high: float) -> list[float]:
    if low > high:
        return []
    middle = (low + high) / 2
    return sorted(np.linspace(low, high, PLACES).tolist(), key=lambda place: abs(place - middle))


def _distances(box: Box, points: Array) -> Array:
    x0, x1, y0, y1 = box
    dx = np.maximum(np.maximum(x0 - points[:, 0], points[:, 0] - x1), 0)
    dy = np.maximum(np.maximum(y0 - points[:, 1], points[:, 1] - y1), 0)
    return np.hypot(dx, dy)
