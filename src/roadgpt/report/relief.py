"""Draws land: from above with shaded hills, contour lines and water; and along the road, with what is cut and
filled, bridges and tunnels."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb

from roadgpt.geometry.curve import Array
from roadgpt.ground.ground import Ground
from roadgpt.network.landscape import crossings, ground_around
from roadgpt.report.canvas import HALO, INK, SOFT
from roadgpt.report.plan_view import Frame
from roadgpt.road import Road, World

PIXELS = 500  # along the longer side of the shaded picture
LOW, HIGH = "#d9e3c6", "#efe9d8"  # colours of the lowest and the highest land
WATER = "#a9cbe3"
SUN = np.array([-0.55, 0.55, 0.63])  # from the north-west, as maps have it
RELIEF = 0.75  # share of the shading
INTERVALS = (0.5, 1, 2, 5, 10, 20, 50, 100)  # m between contour lines
MOST_LINES, FLAT = 14, 0.2  # contour lines; m of land without any
CONTOUR = "#8d8468"
CUT, FILL = "#c9a26b", "#9db38a"
LABEL = 7  # points


def draw_land(axes: Axes, road: Road, world: World, frame: Frame) -> None:
    """Draws the land of a World that has some, inside a frame."""
    ground = ground_around(road, world)
    side = max(frame.width, frame.height) / PIXELS
    x = np.arange(frame.x0, frame.x1 + side, side)
    y = np.arange(frame.y0, frame.y1 + side, side)
    flat = tuple(each.ravel() for each in np.meshgrid(x, y))
    z = ground.beside(*flat).reshape(len(y), len(x))
    extent = (x[0] - side / 2, x[-1] + side / 2, y[0] - side / 2, y[-1] + side / 2)
    water = ground.water(*flat).reshape(z.shape)
    axes.imshow(_shaded(z, water, side), extent=extent, origin="lower", zorder=0.3, interpolation="bilinear")
    _contours(axes, x, y, z)
    draw_tunnels(axes, road, world)


def _shaded(z: Array, water: Array, side: float) -> Array:
    rise_y, rise_x = np.gradient(z, side)
    up = np.stack([-rise_x, -rise_y, np.ones_like(z)], axis=-1)
    light = (up / np.linalg.norm(up, axis=-1, keepdims=True)) @ SUN
    tone = 1.0 + RELIEF * (light - SUN[2])
    share = ((z - z.min()) / max(float(np.ptp(z)), 5.0))[..., None]
    colour = np.array(to_rgb(LOW)) * (1 - share) + np.array(to_rgb(HIGH)) * share
    wet = ~np.isnan(water)
    colour[wet] = to_rgb(WATER)
    tone[wet] = 1.0
    return np.asarray(np.clip(colour * tone[..., None], 0.0, 1.0))


def _contours(axes: Axes, x: Array, y: Array, z: Array) -> None:
    if (span := float(np.ptp(z))) < FLAT:
        return
    step = next((each for each in INTERVALS if span / each <= MOST_LINES), INTERVALS[-1])
    levels = np.arange(np.ceil(z.min() / step), z.max() / step) * step + 0.0
    if not len(levels):
        return
    drawn = axes.contour(x, y, z, levels=levels, colors=CONTOUR, linewidths=0.6, zorder=0.5, alpha=0.8)
    named = {float(level): f"{level:g} m" for level in levels}
    labels = axes.clabel(drawn, levels[::2], fontsize=LABEL, fmt=named, colors=SOFT, zorder=0.6)
    for label in labels:
        label.set(path_effects=HALO)


def draw_tunnels(axes: Axes, road: Road, world: World) -> None:
    """Names bridges and tunnels beside a road seen from above, and hides what lies in a tunnel."""
    for each in crossings(road, world):
        s = np.linspace(each.start, each.end, 40)
        left, right = world.profile_of(road).rims(s)
        rims = road.at(s, left)[:, :2], road.at(s, right)[:, :2]
        if each.kind == "tunnel":
            axes.fill(*np.concatenate([rims[0], rims[1][::-1]]).T, color=LOW, alpha=0.6, lw=0, zorder=4.5)
        for rim in rims:
            style = (0, (3, 2)) if each.kind == "tunnel" else "-"
            axes.plot(*rim.T, color=INK, lw=1.0, ls=style, zorder=4.6)
        x, y = rims[0][len(s) // 2].tolist()
        axes.text(x, y, each.kind, size=LABEL + 1, color=INK, path_effects=HALO, zorder=7, clip_on=True)


def draw_land_along(axes: Axes, road: Road, world: World, s: Array, z: Array) -> None:
    """Draws the land along a road on axes of stations and heights: what is cut and filled, and names of
    bridges and tunnels."""
    ground: Ground = ground_around(road, world)
    x, y = road.at(s)[:, :2].T
    land = ground.relief.at(x, y)
    axes.plot(s, land, color=SOFT, lw=1.1, ls=(0, (5, 2)), zorder=3.4)
    crossed = np.zeros(len(s), bool)
    for each in crossings(road, world):
        crossed |= (s >= each.start) & (s <= each.end)
        middle = float(np.interp((each.start + each.end) / 2, s, z))
        axes.annotate(
            each.kind, ((each.start + each.end) / 2, middle), (0, 12), textcoords="offset points",
            ha="center", size=8.5, color=INK, path_effects=HALO, zorder=7,
        )  # fmt: skip
    axes.fill_between(s, z, land, where=(land > z) & ~crossed, color=CUT, lw=0, zorder=3, alpha=0.8)
    axes.fill_between(s, z, land, where=(land < z) & ~crossed, color=FILL, lw=0, zorder=3, alpha=0.8)
    works = ground.earthworks
    said = f"land (dashed): cut {works.cut:,.0f} m³, fill {works.fill:,.0f} m³"
    axes.set_xlabel(f"{axes.get_xlabel()};  {said}")
