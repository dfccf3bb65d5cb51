"""Draws histograms and line charts, such as the number of failures against the number of tests."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from roadgpt.report.page.chart import (
    columns_of,
    embedded,
    in_page_style,
    new_chart,
    palette,
    round_ticks,
    series_colour,
)

WIDTH, HEIGHT, LEFT, RIGHT, BOTTOM, TOP, ROW = 560.0, 260.0, 62.0, 18.0, 46.0, 14.0, 19.0  # px
MOST_POINTS = 400  # of a line; more cannot be seen


@in_page_style
def lines(curves: Sequence[tuple[str, ArrayLike, ArrayLike]], across: str, upwards: str, label: str) -> str:
    """Returns a chart of curves (name, x, y) as SVG; both axes begin at 0 and show counts."""
    names = [name for name, _, _ in curves] if len(curves) > 1 else []
    columns = columns_of(names, WIDTH - LEFT - RIGHT) if names else 1
    figure, axes = _axes(across, upwards, ROW * -(-len(names) // columns), is_count=True)
    for series, (name, x, y) in enumerate(curves):
        at, high = np.asarray(x, float), np.asarray(y, float)
        if at.size:
            some = np.unique(np.linspace(0, len(at) - 1, min(len(at), MOST_POINTS)).astype(int))
            axes.plot(at[some], high[some], color=series_colour(series), lw=2, label=name)
    far = [np.asarray(curve, float).max(initial=0.0) for _, *both in curves for curve in both]
    axes.set(xlim=(0, max(far[0::2], default=0) or 1), ylim=(0, 1.05 * (max(far[1::2], default=0) or 1)))
    if names:
        axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=columns)
    return embedded(figure, label)


@in_page_style
def bars(
    edges: ArrayLike, counts: ArrayLike, across: str, upwards: str, label: str, mark: float | None = None
) -> str:
    """Returns a histogram as SVG, of ``counts`` (n,) between ascending ``edges`` (n + 1,). A line is drawn at
    the value ``mark``; ``label`` says what the chart shows, for screen readers.
    """
    at, many = np.asarray(edges, float), np.asarray(counts, float)
    figure, axes = _axes(across, upwards)
    some = many > 0
    axes.bar(at[:-1][some], many[some], np.diff(at)[some] * 0.92, align="edge", color=series_colour(0))
    axes.set(xlim=(at[0], at[-1]), ylim=(0, 1.05 * max(float(many.max(initial=0)), 1.0)))
    if mark is not None and at[0] <= mark <= at[-1]:
        axes.axvline(mark, color=palette()["soft"], lw=1, ls=(0, (4, 3)))
    return embedded(figure, label)


def _axes(across: str, upwards: str, more: float = 0.0, is_count: bool = False) -> tuple[Figure, Axes]:
    """Returns a figure and its axes, with ``more`` px of room above them."""
    figure, axes = new_chart(WIDTH, HEIGHT + more, LEFT, RIGHT, BOTTOM, TOP + more)
    axes.set(xlabel=across, ylabel=upwards)
    axes.grid(axis="y")
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    round_ticks(axes.xaxis, 8, is_count)
    round_ticks(axes.yaxis, 5, is_count=True)
    return figure, axes
