"""Draws forest plots: groups of shares (0 to 100 %) with confidence intervals, one row for each series."""

from collections.abc import Sequence
from typing import NamedTuple

from matplotlib.patches import Patch

from roadgpt.report.page.chart import (
    LETTERS,
    columns_of,
    embedded,
    in_page_style,
    new_chart,
    palette,
    series_colour,
)

WIDTH, LEFT, RIGHT, TOP, BOTTOM = 560.0, 16.0, 120.0, 12.0, 26.0  # px
ROW, HEAD, GAP = 20.0, 22.0, 10.0  # px


class Share(NamedTuple):
    """A share from 0 to 1, its confidence interval, and the text that is written next to it."""

    series: int
    value: float
    lo: float
    hi: float
    text: str


@in_page_style
def forest(groups: Sequence[tuple[str, Sequence[Share]]], series: Sequence[str], label: str) -> str:
    """Returns a chart of shares from 0 to 100 % as SVG, with a dot for each share and a line for its
    interval. ``groups`` are names and shares from top to bottom, ``series`` the names of the series, and
    ``label`` says what the chart shows, for screen readers.
    """
    columns = columns_of(list(series), WIDTH - 2 * LEFT)
    top = TOP + ROW * -(-len(series) // columns)
    high = sum(HEAD + ROW * len(shares) + GAP for _, shares in groups)
    figure, axes = new_chart(WIDTH, high + top + BOTTOM, LEFT, RIGHT, BOTTOM, top)
    axes.set(xlim=(0, 1), ylim=(high, 0), yticks=[])
    axes.set_xticks([0, 0.25, 0.5, 0.75, 1], [f"{share} %" for share in (0, 25, 50, 75, 100)])
    axes.tick_params(length=0)
    axes.grid(axis="x")
    axes.spines[:].set_visible(False)
    y = 0.0
    for name, shares in groups:
        y += HEAD
        axes.text(0.01, y - 5, name, weight="bold", bbox={"fc": palette()["paper"], "ec": "none", "pad": 1.5})
        for each in shares:
            hue, row = series_colour(each.series), y + ROW / 2
            axes.plot([each.lo, each.hi], [row, row], color=hue, lw=3, alpha=0.55, solid_capstyle="butt")
            axes.plot(each.value, row, "o", color=hue, ms=9, mew=0, clip_on=False)
            axes.text(1.03, row, each.text, va="center_baseline")
            y += ROW
        y += GAP
    patches = [Patch(fc=series_colour(number), label=name) for number, name in enumerate(series)]
    figure.legend(
        handles=patches, loc="upper left", bbox_to_anchor=(LEFT / WIDTH, 1), ncols=columns,
        borderaxespad=LETTERS / 24,
    )  # fmt: skip
    return embedded(figure, label)
