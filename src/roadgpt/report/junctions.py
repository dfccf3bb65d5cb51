"""Shades and names the stretches of a route that lie inside junctions."""

from typing import Literal

from matplotlib.axes import Axes

from roadgpt.brief.junctions import NAMES
from roadgpt.drive.outlook import passages
from roadgpt.report.canvas import HALO, SOFT, inches_of
from roadgpt.report.text_width import inches
from roadgpt.road import Road

SHADE = "#e4e8ee"
SIZE, LINE = 8.5, 0.16  # points; inches from one line of names to the next
LINES = 3  # of names, where they stand close together


def shade_junctions(axes: Axes, road: Road, names: Literal["top", "foot"] | None = "top") -> None:
    """Shades the stretches inside junctions. On the axes, x is the distance along the road; the limits of x
    must be set already. ``names`` is where the names of the junctions are written; None writes none.
    """
    wide, high = inches_of(axes)
    low, top = axes.get_xlim()
    per_inch = (top - low) / wide
    ends = [low] * LINES
    for passage in passages(road):
        axes.axvspan(passage.start, passage.end, fc=SHADE, ec="none", zorder=0.4)
        if names is None:
            continue
        name = NAMES[passage.entered.kind][0]
        half = (inches(name, SIZE) / 2 + 0.05) * per_inch
        middle = min(max((passage.start + passage.end) / 2, low + half), top - half)
        row = next((n for n, end in enumerate(ends) if middle - half >= end), 0)
        ends[row] = middle + half
        away = (0.05 + LINE * row) / high
        axes.text(
            middle, 1 - away if names == "top" else away, name,
            transform=axes.get_xaxis_transform(), size=SIZE, color=SOFT, ha="center",
            va="top" if names == "top" else "bottom", path_effects=HALO, zorder=7,
        )  # fmt: skip
