"""Draws a matrix or a feature map as coloured cells; a stronger colour means a larger number."""

from typing import Literal, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from numpy.typing import NDArray

from roadgpt.report.page.chart import (
    embedded,
    in_page_style,
    new_chart,
    palette,
    round_ticks,
    tick_text,
)

FEW = 10  # a map with fewer filled cells, all with the same number, is not drawn
SIDE, LEFT, BOTTOM, TOP, BAR = 380.0, 74.0, 46.0, 12.0, 96.0  # px
BLUE = "#2b8ccc"  # visible on light and on dark pages; its opacity shows the number
FAINTEST = 0.1  # opacity


class AxisRange(NamedTuple):
    """The name and the limits of an axis, and whether its values are counts."""

    name: str
    lo: float
    hi: float
    is_count: bool = False


def is_map(values: NDArray[np.float64]) -> bool:
    """Returns whether a map is worth drawing: its positive numbers differ, or there are at least 10 of
    them."""
    filled = values[np.isfinite(values) & (values > 0)]
    return len(np.unique(filled)) > 1 or len(filled) >= FEW


@in_page_style
def heat(
    values: NDArray[np.float64],
    across: AxisRange,
    upwards: AxisRange,
    meaning: str,
    label: str,
    downwards: bool = False,
) -> str:
    """Returns a picture of a matrix ``(rows, columns)`` as SVG; cells that are NaN or 0 are left empty. Row 0
    is at the bottom; with ``downwards``, row 0 is at the top, as in a distance matrix. ``meaning`` is the
    title of the colour scale, and ``label`` says what the picture shows, for screen readers.
    """
    figure, axes = new_chart(LEFT + SIDE + BAR, TOP + SIDE + BOTTOM, LEFT, BAR, BOTTOM, TOP)
    axes.set_facecolor(palette()["wash"])
    high = max(float(values[np.isfinite(values)].max(initial=0.0)), 1e-12)
    lo, hi = (upwards.hi, upwards.lo) if downwards else (upwards.lo, upwards.hi)
    shown = np.ma.masked_where(~(values > 0), values)
    _paint(axes, shown, high, (across.lo, across.hi, lo, hi), "upper" if downwards else "lower")
    axes.set(xlabel=across.name, ylabel=upwards.name)
    round_ticks(axes.xaxis, 6, across.is_count)
    round_ticks(axes.yaxis, 6, upwards.is_count)
    bar = axes.inset_axes((1 + 22 / SIDE, 1 - 200 / SIDE, 14 / SIDE, 180 / SIDE))
    _paint(bar, np.linspace(0, 1, 64)[:, None] * high, high, (0, 1, 0, high), "lower")
    bar.spines[:].set_visible(False)
    bar.set_xticks([])
    bar.yaxis.tick_right()
    bar.set_yticks([0, high], ["0", tick_text(float(f"{high:.3g}"))])
    bar.tick_params(length=0)
    bar.set_title(meaning, size=12, loc="left", pad=8)
    return embedded(figure, label)


def _paint(
    axes: Axes,
    values: NDArray[np.float64],
    high: float,
    extent: tuple[float, float, float, float],
    origin: Literal["upper", "lower"],
) -> None:
    """Draws one pixel per cell, in one colour whose opacity grows with the number."""
    blue = to_rgb(BLUE)
    shades = LinearSegmentedColormap.from_list("page", [(*blue, FAINTEST), (*blue, 1.0)])
    axes.imshow(
        values, cmap=shades, vmin=0, vmax=high, extent=extent, origin=origin, aspect="auto",
        interpolation="none",
    )  # fmt: skip
