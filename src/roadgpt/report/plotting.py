"""Draws one road on the user's own axes (``roadgpt.plot``)."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from roadgpt.campaign import Campaign
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.network import made_from
from roadgpt.report.birds_eye import birds_eye, driven_path, mark, places_of
from roadgpt.report.canvas import encoded, in_our_style, inches_of
from roadgpt.report.overview import pages
from roadgpt.report.plan_view import draw_ends, draw_road, plan_points, stations_of
from roadgpt.road import Design, Road, World
from roadgpt.run import Run

MARGIN = 0.05  # of the road's extent, left free around it
SIDE = 5.0  # inches


def plot(what: Road | Design | Run, ax: Axes | None = None, world: World | None = None) -> Axes:
    """Draws a road from above, to scale, on matplotlib axes, and returns the axes.

    For a Run, also draws the drive, coloured by speed, and marks where the car failed, where the largest
    share of the car was outside its lane, or where the road breaks a rule.
    Several roads may be drawn on the same axes. Style, title and size of the figure are left to the caller.

    Args:
        what: a Road, a Design, or a Run that has a road.
        ax: the axes to draw on; None uses matplotlib's current axes.
        world: the World with the widths of lanes and shoulders; None uses the Run's World, or the default
            World."""
    road, world = _road_of(what, world)
    if ax is None:
        from matplotlib import pyplot

        ax = pyplot.gca()
    ax.set_aspect("equal", adjustable="datalim")
    s = stations_of(road)
    edges = np.concatenate([road.at(s, t) for t in world.profile_of(road).edges(s)])[:, :2]
    ax.update_datalim(np.concatenate([edges, plan_points(road)]))
    ax.margins(MARGIN)
    ax.autoscale_view()
    low, high = ax.get_xlim()
    draw_road(ax, road, world, (high - low) / inches_of(ax)[0])
    draw_ends(ax, road, world)
    if isinstance(what, Run):
        if what.drive is not None:
            driven_path(ax, what.drive)
        for place in places_of(what):
            mark(ax, what, place)
    if not ax.get_xlabel():
        ax.set(xlabel="x, metres east", ylabel="y, metres north")
    return ax


def _road_of(what: Any, world: World | None) -> tuple[Road, World]:
    if isinstance(what, Run):
        if what.road is None:
            raise UsageError(f"run {what.index} has no road to plot: {what.description}")
        return what.road, world or what.world
    if isinstance(what, Road | Design):
        world = world or World()
        return made_from(what, world), world
    raise UsageError(f"a {type(what).__name__} cannot be plotted; give a Road, a Design or a Run")


@in_our_style
def png_of(value: Any) -> bytes | None:
    """Returns the bytes of a PNG file with a picture of a Road, a Design, a Run or a Campaign; None if there
    is nothing to show. The picture of a Campaign is the first page of ``overview``."""
    figure = _figure(value)
    return None if figure is None else encoded(figure, "png")


def _figure(value: Any) -> Figure | None:
    if isinstance(value, Run):
        return None if value.road is None else birds_eye(value)
    if isinstance(value, Road | Design):
        figure = Figure(figsize=(SIDE, SIDE), facecolor="white", layout="constrained")
        plot(value, figure.add_subplot())
        return figure
    if isinstance(value, Campaign):
        try:
            return next(iter(pages(value.folder)), None)
        except RoadGPTError:  # of a campaign that has not begun, its one line is enough
            return None
    return None
