"""One road on axes of the user's own: ``roadgpt.plot``."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from roadgpt.errors import UsageError
from roadgpt.report.birds_eye import driven_path, mark
from roadgpt.report.places import places_of
from roadgpt.report.scenery import draw_ends, draw_road, stations_of
from roadgpt.road import Design, Road, World, build
from roadgpt.run import Run

MARGIN = 0.05  # of the road's extent, left free around it


def plot(what: Road | Design | Run, ax: Axes | None = None, world: World | None = None) -> Axes:
    """Draw a road from above, metres as metres, on matplotlib's axes; gives back the axes.

    A Run shows its drive, coloured by speed, and the places where the car failed or a rule objects. Several
    roads may be drawn on the same axes; style, title and size of the figure are the user's own.

    Args:
        what: a Road, a Design, or a Run that has a road.
        ax: the axes to draw on; None takes matplotlib's current ones.
        world: width of lanes and shoulders; None takes the Run's own, or the usual ones.

    Raises:
        UsageError: there is no road in it.
    """
    road, world = _road_of(what, world)
    if ax is None:
        from matplotlib import pyplot

        ax = pyplot.gca()
    ax.set_aspect("equal", adjustable="datalim")
    s = stations_of(road)
    edges = np.concatenate([road.at(s, world.lane_width), road.at(s, -world.lane_width)])[:, :2]
    ax.update_datalim(edges)
    ax.margins(MARGIN)
    ax.autoscale_view()
    draw_road(ax, road, world, _metres_per_inch(ax))
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
    """The road in a value, and the world that it lies in."""
    if isinstance(what, Run):
        if what.road is None:
            raise UsageError(f"run {what.index} has no road to plot: {what.description}")
        return what.road, world or what.world
    if isinstance(what, Design):
        return build(what), world or World()
    if isinstance(what, Road):
        return what, world or World()
    raise UsageError(f"a {type(what).__name__} cannot be plotted; give a Road, a Design or a Run")


def _metres_per_inch(ax: Axes) -> float:
    figure = ax.get_figure(root=True)
    assert figure is not None
    low, high = ax.get_xlim()
    return float((high - low) / (ax.get_position().width * figure.get_figwidth()))
