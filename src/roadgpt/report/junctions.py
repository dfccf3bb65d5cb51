"""Finds the stretches of a route that lie inside junctions, and names them in pictures."""

from typing import Literal, NamedTuple

from matplotlib.axes import Axes

from roadgpt.brief.junctions import NAMES
from roadgpt.network import is_route
from roadgpt.report.canvas import HALO, SOFT
from roadgpt.report.text_width import inches
from roadgpt.road import Road

SHADE = "#e4e8ee"
SIZE, LINE = 8.5, 0.16  # points; inches from one line of names to the next
LINES = 3  # of names, where they stand close together


class JunctionStretch(NamedTuple):
    """The part of a route inside one junction or one roundabout."""

    start: float
    """Station in metres at which the route enters the junction."""
    end: float
    """Station in metres at which the route leaves the junction."""
    name: str
    """Name of the kind of junction, as pictures show it."""


def junction_stretches(road: Road) -> tuple[JunctionStretch, ...]:
    """Returns the junctions that a route passes, in driving order; none for a road without junctions."""
    if not is_route(road):
        return ()
    return tuple(JunctionStretch(each.start, each.end, NAMES[each.entered.kind][0]) for each in road.passages)


def shade_junctions(axes: Axes, road: Road, names: Literal["top", "foot"] | None = "top") -> None:
    """Shades the stretches inside junctions on axes whose x is the distance along the road.

    Args:
        axes: The axes; the limits of x must be set already.
        road: The road; if it has no junctions, nothing is drawn.
        names: Where to write the names of the junctions, at the top or at the foot of the axes; None writes
            no names.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    shape = axes.get_position()
    wide, high = figure.get_size_inches() * (shape.width, shape.height)
    low, top = axes.get_xlim()
    per_inch = (top - low) / wide
    ends = [low] * LINES
    for stretch in junction_stretches(road):
        axes.axvspan(stretch.start, stretch.end, fc=SHADE, ec="none", zorder=0.4)
        if names is None:
            continue
        half = (inches(stretch.name, SIZE) / 2 + 0.05) * per_inch
        middle = min(max((stretch.start + stretch.end) / 2, low + half), top - half)
        row = next((n for n, end in enumerate(ends) if middle - half >= end), 0)
        ends[row] = middle + half
        away = (0.05 + LINE * row) / high
        axes.text(
            middle, 1 - away if names == "top" else away, stretch.name,
            transform=axes.get_xaxis_transform(), size=SIZE, color=SOFT, ha="center",
            va="top" if names == "top" else "bottom", path_effects=HALO, zorder=7,
        )  # fmt: skip
