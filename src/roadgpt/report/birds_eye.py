"""The bird's-eye view: north is up, metres are metres."""

from typing import Any, Literal

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from matplotlib.ticker import MultipleLocator

from roadgpt.report.canvas import HEADER, INK, SOFT, VERMILLION, add_axes, header, new_figure
from roadgpt.report.labels import Labels
from roadgpt.report.places import Place, places_of
from roadgpt.report.scenery import GROUND, Array, Frame, draw_ends, draw_road, stations_of
from roadgpt.run import Run

Scale = Literal["equal", "thesis"]
"""Axes that fit the road, or those of RoadGPT's plots: x and y from 0 to 220 m."""

THESIS = Frame(0.0, 220.0, 0.0, 220.0)
SIDE = 6.6  # inches, of the square that shows the road
LEFT, BOTTOM, BAR = 0.75, 0.62, 1.15  # inches
MARGIN, LEAST = 16.0, 60.0  # m, around the road and across the picture
SLOWEST = 10.0  # km/h; the colours span at least so much

# plasma without its lightest end, which asphalt would swallow
SPEEDS = LinearSegmentedColormap.from_list("speeds", colormaps["plasma"](np.linspace(0.0, 0.86, 64)))


def birds_eye(run: Run, scale: Scale = "equal") -> Figure:
    """The road from above, the driven path coloured by speed, and the place of a departure or a finding."""
    road, world = run.road, run.world
    assert road is not None
    right = BAR if run.drive is not None else 0.3
    figure = new_figure(LEFT + SIDE + right, BOTTOM + SIDE + HEADER)
    axes = add_axes(figure, LEFT, BOTTOM, right, HEADER)
    header(figure, run)
    centre = road.at(stations_of(road))[:, :2]
    frame = THESIS if scale == "thesis" else _frame(run, centre)
    _ground(axes, frame, world.map_size)
    draw_road(axes, road, world)
    draw_ends(axes, road, world)
    if run.drive is not None:
        _path(figure, axes, run)
    labels = Labels(axes, frame, frame.width / SIDE, centre, world.lane_width + 1.0)
    places = places_of(run)
    for place in places:
        _mark(axes, run, place)
        labels.put((place.x, place.y), place.text, VERMILLION)
    for s, text, sign in ((0.0, "start", -1.0), (road.length, "end", 1.0)):
        heading = float(road.heading(s))
        x, y, _ = road.at(s)
        labels.put((x, y), text, INK, sign * np.array([np.cos(heading), np.sin(heading)]))
    return figure


def _frame(run: Run, centre: Array) -> Frame:
    """All of the road, and all of the driven path."""
    shown = centre
    if run.drive is not None:
        shown = np.concatenate([centre, np.stack([run.drive["x"], run.drive["y"]], axis=-1)])
    return Frame.around(shown, MARGIN, 1.0, LEAST)


def _ground(axes: Axes, frame: Frame, size: float) -> None:
    """Ground, grid, the border of the map, and what lies beyond it."""
    axes.set(xlim=(frame.x0, frame.x1), ylim=(frame.y0, frame.y1), aspect="equal")
    axes.set_xlabel("x, metres east")
    axes.set_ylabel("y, metres north")
    axes.set_facecolor("#d5d8dc")
    axes.add_patch(Rectangle((0, 0), size, size, fc=GROUND, ec="none", zorder=0))
    border = Rectangle((0, 0), size, size, fc="none", ec=SOFT, lw=1.4, ls=(0, (6, 3)), zorder=0.6)
    axes.add_patch(border)
    step = next(step for step in (10, 20, 25, 50, 100, 200, 500, 1000, 1e6) if frame.width / step <= 8)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MultipleLocator(step))
    axes.grid(color="white", lw=0.8, zorder=0.5)
    axes.set_axisbelow(True)
    _name_border(axes, frame, size)


def _name_border(axes: Axes, frame: Frame, size: float) -> None:
    """Say 'border of the map' along a border that is in view."""
    inset = frame.width * 0.012
    middle_x, middle_y = (frame.x0 + frame.x1) / 2, (frame.y0 + frame.y1) / 2
    style: dict[str, Any] = {"size": 8.5, "color": SOFT, "zorder": 0.7}
    for y, va in ((0.0, "top"), (size, "bottom")):
        if frame.y0 < y < frame.y1:
            shift = -inset if va == "top" else inset
            axes.text(middle_x, y + shift, "border of the map", ha="center", va=va, **style)
            return
    for x, ha in ((0.0, "right"), (size, "left")):
        if frame.x0 < x < frame.x1:
            shift = -inset if ha == "right" else inset
            axes.text(x + shift, middle_y, "border of the map", ha=ha, va="center", rotation=90, **style)
            return


def _path(figure: Figure, axes: Axes, run: Run) -> None:
    """The way of the car's centre, coloured by its speed, with a bar that says which."""
    assert run.drive is not None
    track = np.stack([run.drive["x"], run.drive["y"]], axis=-1)
    speed = run.drive["speed"] * 3.6
    every = max(1, len(track) // 600)
    track = np.concatenate([track[::every], track[-1:]])
    speed = np.r_[speed[::every], speed[-1]]
    norm = Normalize(0.0, max(SLOWEST, float(speed.max())))
    axes.plot(track[:, 0], track[:, 1], color="white", lw=4.2, zorder=6, solid_capstyle="round")
    pieces = np.stack([track[:-1], track[1:]], axis=1)
    line = LineCollection(list(pieces), cmap=SPEEDS, norm=norm, linewidths=2.6, zorder=7, capstyle="round")
    line.set_array((speed[:-1] + speed[1:]) / 2)
    axes.add_collection(line)
    wide, high = figure.get_size_inches()
    box = ((LEFT + SIDE + 0.18) / wide, (BOTTOM + 0.6) / high, 0.16 / wide, (SIDE - 1.2) / high)
    bar = figure.colorbar(line, cax=figure.add_axes(box))
    bar.set_label("speed, km/h", size=10, color=INK)
    bar.ax.tick_params(labelsize=9, colors=SOFT, length=3)
    bar.outline.set_visible(False)


def _mark(axes: Axes, run: Run, place: Place) -> None:
    """A cross on the place, and the car's outline as it stood there."""
    if place.step is not None and run.drive is not None:
        car = Polygon(run.drive.corners(place.step), closed=True, fc="none", ec=VERMILLION, lw=1.6, zorder=9)
        axes.add_patch(car)
    axes.plot(place.x, place.y, "X", ms=12, mfc=VERMILLION, mec="white", mew=1.4, zorder=10)
