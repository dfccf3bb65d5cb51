"""Draws a network from above, to scale: the paved area, markings, islands, and the route as a tint."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.markers import MarkerStyle
from matplotlib.patches import PathPatch, Polygon
from matplotlib.path import Path

from roadgpt.brief.junctions import Control
from roadgpt.geometry.curve import Array
from roadgpt.network import Network, NetworkRoad, Route
from roadgpt.network.arrows import arrows
from roadgpt.network.markings import JunctionSign, between_crosswalks, signs, strokes
from roadgpt.network.paved import Area, stations_of
from roadgpt.network.route import ground_of
from roadgpt.network.surface import NetworkSurface
from roadgpt.report.canvas import GRASS, POINTS

VERGE, ASPHALT, PAINT = "#dcd9c3", "#b9bdc3", "#ffffff"
TINT, ARROW = "#8fb3d6", "#0072b2"
KERB = "#e9e6dc"
FAR_ASPHALT, FAR_ROUTE = "#a7adb5", "#4d86b8"
LINE_POINTS, STOP_POINTS = 1.1, 2.2  # points, least width of a line on paper
SIGNS = {"stop": "#c1272d", "yield": "#c1272d", "priority": "#e0a800", "lights": "#2b2f36"}
SHAPES = {"stop": "8", "yield": "v", "priority": "D", "lights": "s"}
SIGN_NAMES = {
    "stop": "stop sign", "yield": "give-way sign", "priority": "priority sign", "lights": "traffic lights",
}  # fmt: skip
SIGN_SIZE = 4.2  # points
NEAR = 50.0  # m per inch; signs are not drawn on smaller scales
ARROWS, ARROW_POINTS = 20.0, 7.0  # m between the arrows on the route; points
HEAD = Path([(1.0, 0.0), (-0.7, 0.75), (-0.3, 0.0), (-0.7, -0.75), (1.0, 0.0)], closed=True)
ARROW_INCHES = 0.5  # least distance between arrows
STEP = 0.5  # m between the points of the edges of the route


def draw_network(axes: Axes, route: Route, per_inch: float) -> None:
    """Draws a network and the lane of the route; a map without a route has no such lane. ``per_inch`` is the
    number of metres per inch of the picture."""
    network = route.network
    surface = NetworkSurface.of(network)
    if surface.shoulder > 0:
        _fill(axes, ground_of(network), VERGE, 1)
    _fill(axes, network.paved, ASPHALT, 2)
    for area in surface.areas:
        for island in area.kerbed:
            _fill(axes, island, KERB, 2.1)
        for island in area.green if surface.shoulder > 0 else ():
            _fill(axes, island, GRASS, 2.1)
    for member in network.roads_outside:
        if member.profile.median:
            axes.add_patch(Polygon(_median(network, member), fc=GRASS, ec="none", zorder=2.1))
    if route.legs:
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
    for sign in signs_shown(route, per_inch):
        axes.plot(*sign.place[:2], **sign_style(sign.control), zorder=4)


def _median(network: Network, member: NetworkRoad) -> Array:
    first, last = between_crosswalks(network, member)
    s = stations_of(member.road)
    s = np.r_[first, s[(s > first) & (s < last)], last]
    sides = member.profile.sides(s)
    return np.concatenate([member.road.at(s, sides.left), member.road.at(s, sides.right)[::-1]])[:, :2]


def draw_network_from_far(axes: Axes, route: Route, points: float) -> None:
    """Draws the roads of a network as lines that are ``points`` wide, and the route as a darker line."""
    lines = [each.road.centreline()[:, :2] for each in route.network.roads]
    axes.add_collection(LineCollection(lines, colors=FAR_ASPHALT, linewidths=points, zorder=2))
    line = route.centreline() if route.legs else np.empty((0, 3))
    axes.plot(line[:, 0], line[:, 1], color=FAR_ROUTE, lw=points, zorder=2.2)


def _fill(axes: Axes, area: Area, colour: str, layer: float) -> None:
    axes.add_patch(PathPatch(path_of(area), fc=colour, ec="none", zorder=layer))


def path_of(area: Area) -> Path:
    """Returns an area as a matplotlib path; the holes in the area stay empty."""
    import shapely
    from shapely.geometry.polygon import orient

    rings = []
    for part in shapely.get_parts(area):
        whole = orient(part)
        rings += [np.asarray(ring.coords, float)[:, :2] for ring in (whole.exterior, *whole.interiors)]
    codes = []
    for ring in rings:
        codes += [Path.MOVETO, *[Path.LINETO] * (len(ring) - 2), Path.CLOSEPOLY]
    return Path(np.concatenate(rings), codes)


def _draw_route(axes: Axes, route: Route, per_inch: float) -> None:
    assert route.profile is not None
    s = np.linspace(0.0, route.length, max(2, int(route.length / STEP)) + 1)
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


def signs_shown(route: Route, per_inch: float) -> tuple[JunctionSign, ...]:
    """Returns the signs and lights to draw in a picture: none with more than 50 metres per inch."""
    return signs(route.network) if per_inch <= NEAR else ()


def sign_style(control: Control) -> dict[str, Any]:
    """Returns the keyword arguments with which matplotlib's ``plot`` draws a sign or a traffic light."""
    colour = SIGNS[control]
    return {
        "marker": SHAPES[control], "ms": SIGN_SIZE, "mfc": "white" if control == "yield" else colour,
        "mec": colour, "mew": 1.0, "ls": "none",
    }  # fmt: skip
