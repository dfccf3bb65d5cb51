"""Draws the charts of a page with matplotlib: shares with intervals, heat maps, curves and histograms.

They are SVG that uses the font and the light and dark colours of the page."""

import io
import re
from collections.abc import Sequence
from functools import cache
from html import escape
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from matplotlib import rc_context, rcParamsDefault
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter, MaxNLocator
from numpy.typing import ArrayLike, NDArray

from roadgpt.report.canvas import POINTS, UNDATED, inches

CSS = Path(__file__).parent / "style.css"
SERIES = 6  # colours of the page that tell series apart
LETTERS = 12.0  # px
STEPS = (1, 2, 5, 10)  # of ticks
# what is removed from matplotlib's SVG: metadata, a style that would apply to the whole page, ids that
# nothing refers to, rotations by 0 degrees, and matplotlib's font, because the page has its own
NEEDLESS = (
    r'<metadata>.*?</metadata>|<style .*?</style>| id="[a-z0-9.]+_\d+"| transform="rotate\(-?0 [^"]*"'
    r"|font-family: [^;\"]*;? ?"
)
WIDTH, HEIGHT, MARGINS = 560.0, 260.0, {"left": 62.0, "right": 18.0, "bottom": 46.0, "top": 14.0}  # px
MOST_POINTS = 400  # of a line; more cannot be seen
FEW = 10  # a map with fewer filled cells, all with the same number, is not drawn
BLUE = "#2b8ccc"  # visible on light and on dark pages; its opacity shows the number
FAINTEST = 0.1  # opacity


@cache
def palette() -> dict[str, str]:
    """Returns the light colours of ``style.css``: a dictionary from CSS variable to ``#rrggbb``."""
    light, _, _ = CSS.read_text(encoding="utf-8").partition("}")
    return dict(re.findall(r"--([a-z0-9]+): (#[0-9a-f]{6});", light))


def series_colour(number: int) -> str:
    """Returns the colour of a series; after ``SERIES`` series, the colours repeat."""
    return palette()[f"s{number % SERIES}"]


def _style() -> dict[Any, Any]:
    colours = palette()
    plain = {name: value for name, value in rcParamsDefault.items() if name != "backend"}
    return plain | {
        "font.size": LETTERS, "text.color": colours["ink"], "text.parse_math": False,
        "axes.edgecolor": colours["soft"], "axes.labelcolor": colours["ink"], "axes.linewidth": 1.0,
        "axes.facecolor": "none", "axes.spines.top": False, "axes.spines.right": False,
        "axes.axisbelow": True, "grid.color": colours["line"], "grid.linewidth": 1.0,
        "xtick.color": colours["soft"], "ytick.color": colours["soft"],
        "xtick.labelsize": LETTERS - 0.5, "ytick.labelsize": LETTERS - 0.5,
        "figure.facecolor": "none", "legend.frameon": False, "legend.fontsize": LETTERS,
        "legend.handlelength": 0.9, "legend.handleheight": 0.9, "legend.borderaxespad": 0.0,
        "svg.fonttype": "none",
    }  # fmt: skip


in_page_style = rc_context(_style())


def new_chart(
    width: float, height: float, left: float, right: float, bottom: float, top: float
) -> tuple[Figure, Axes]:
    """Returns a figure and its axes, which have these distances from the borders; all lengths are in px."""
    figure = Figure(figsize=(width / POINTS, height / POINTS), dpi=POINTS)
    FigureCanvasSVG(figure)
    box = (left / width, bottom / height, (width - left - right) / width, (height - bottom - top) / height)
    axes: Axes = figure.add_axes(box)
    return figure, axes


def round_ticks(axis: Axis, most: int, is_count: bool = False) -> None:
    """Sets ticks at round numbers, or whole numbers for counts, with at most ``most`` intervals."""
    axis.set_major_locator(MaxNLocator(most, steps=STEPS, integer=is_count, min_n_ticks=1))
    axis.set_major_formatter(FuncFormatter(lambda value, _: tick_text(value)))


def tick_text(value: float) -> str:
    """Returns a short text for the number of a tick, with thousands separators."""
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.6g}".replace("-", "\N{MINUS SIGN}")


def columns_of(names: list[str], width: float) -> int:
    """Returns how many columns of names fit into a legend of ``width`` px; at least 1."""
    widest = max(inches(name, LETTERS) for name in names) * POINTS + 44
    return max(1, min(len(names), int(width / widest)))


def embedded(figure: Figure, label: str) -> str:
    """Returns a figure as an ``svg`` element; ``new_chart`` must have made the figure within
    ``in_page_style``. The same figure and label give the same text. Colours of ``palette`` become the page's
    CSS variables, and text uses the page's font. ``label`` says what the chart shows, for screen readers."""
    data = io.BytesIO()
    with rc_context({"svg.hashsalt": label}):  # else two charts of a page could have the same ids
        figure.savefig(data, format="svg", metadata=dict(UNDATED["svg"]))
    _, _, inside = data.getvalue().decode().partition("<svg ")
    head, _, content = inside.partition(">")
    content = re.sub(f"(?s){NEEDLESS}", "", content)
    for name, colour in palette().items():
        content = content.replace(colour, f"var(--{name})")
    wide, high = figure.get_size_inches() * POINTS
    head = re.sub(r'(width|height)="[^"]*"', "", head)
    return (
        f'<svg {" ".join(head.split())} width="{wide:g}" height="{high:g}" class="chart" role="img" '
        f'aria-label="{escape(label)}">{content.strip()}'
    )


class Share(NamedTuple):
    """A share from 0 to 1, its confidence interval, and the text that is written next to it."""

    series: int
    value: float
    lo: float
    hi: float
    text: str


@in_page_style
def forest(groups: Sequence[tuple[str, Sequence[Share]]], series: Sequence[str], label: str) -> str:
    """Returns shares from 0 to 100 % as SVG, a dot for each and a line for its interval. ``groups`` are names
    and shares from top to bottom, and ``label`` says what the chart shows, for screen readers."""
    left, right, bottom, row, head, gap = 16.0, 120.0, 26.0, 20.0, 22.0, 10.0  # px
    columns = columns_of(list(series), WIDTH - 2 * left)
    top = 12.0 + row * -(-len(series) // columns)
    high = sum(head + row * len(shares) + gap for _, shares in groups)
    figure, axes = new_chart(WIDTH, high + top + bottom, left, right, bottom, top)
    axes.set(xlim=(0, 1), ylim=(high, 0), yticks=[])
    axes.set_xticks([0, 0.25, 0.5, 0.75, 1], [f"{share} %" for share in (0, 25, 50, 75, 100)])
    axes.tick_params(length=0)
    axes.grid(axis="x")
    axes.spines[:].set_visible(False)
    y = 0.0
    for name, shares in groups:
        y += head
        axes.text(0.01, y - 5, name, weight="bold", bbox={"fc": palette()["paper"], "ec": "none", "pad": 1.5})
        for each in shares:
            hue, level = series_colour(each.series), y + row / 2
            axes.plot([each.lo, each.hi], [level, level], color=hue, lw=3, alpha=0.55, solid_capstyle="butt")
            axes.plot(each.value, level, "o", color=hue, ms=9, mew=0, clip_on=False)
            axes.text(1.03, level, each.text, va="center_baseline")
            y += row
        y += gap
    patches = [Patch(fc=series_colour(number), label=name) for number, name in enumerate(series)]
    figure.legend(
        handles=patches, loc="upper left", bbox_to_anchor=(left / WIDTH, 1), ncols=columns,
        borderaxespad=LETTERS / 24,
    )  # fmt: skip
    return embedded(figure, label)


class AxisRange(NamedTuple):
    """The name and the limits of an axis, and whether its values are counts."""

    name: str
    lo: float
    hi: float
    is_count: bool = False


def is_map(values: NDArray[np.float64]) -> bool:
    """Returns whether a map is worth drawing: its positive numbers differ, or there are some of them."""
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
    title of the colour scale, and ``label`` says what the picture shows, for screen readers."""
    side, left, bottom, top, right = 380.0, 74.0, 46.0, 12.0, 96.0  # px
    figure, axes = new_chart(left + side + right, top + side + bottom, left, right, bottom, top)
    axes.set_facecolor(palette()["wash"])
    high = max(float(values[np.isfinite(values)].max(initial=0.0)), 1e-12)
    lo, hi = (upwards.hi, upwards.lo) if downwards else (upwards.lo, upwards.hi)
    shown = np.ma.masked_where(~(values > 0), values)
    _paint(axes, shown, high, (across.lo, across.hi, lo, hi), "upper" if downwards else "lower")
    axes.set(xlabel=across.name, ylabel=upwards.name)
    round_ticks(axes.xaxis, 6, across.is_count)
    round_ticks(axes.yaxis, 6, upwards.is_count)
    bar = axes.inset_axes((1 + 22 / side, 1 - 200 / side, 14 / side, 180 / side))
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
    blue = to_rgb(BLUE)
    shades = LinearSegmentedColormap.from_list("page", [(*blue, FAINTEST), (*blue, 1.0)])
    axes.imshow(
        values, cmap=shades, vmin=0, vmax=high, extent=extent, origin=origin, aspect="auto",
        interpolation="none",
    )  # fmt: skip


@in_page_style
def lines(curves: Sequence[tuple[str, ArrayLike, ArrayLike]], across: str, upwards: str, label: str) -> str:
    """Returns a chart of curves (name, x, y) as SVG; both axes begin at 0 and show counts."""
    names = [name for name, _, _ in curves] if len(curves) > 1 else []
    columns = columns_of(names, WIDTH - MARGINS["left"] - MARGINS["right"]) if names else 1
    figure, axes = _axes(across, upwards, 19.0 * -(-len(names) // columns), is_count=True)
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
    the value ``mark``; ``label`` says what the chart shows, for screen readers."""
    at, many = np.asarray(edges, float), np.asarray(counts, float)
    figure, axes = _axes(across, upwards)
    some = many > 0
    axes.bar(at[:-1][some], many[some], np.diff(at)[some] * 0.92, align="edge", color=series_colour(0))
    axes.set(xlim=(at[0], at[-1]), ylim=(0, 1.05 * max(float(many.max(initial=0)), 1.0)))
    if mark is not None and at[0] <= mark <= at[-1]:
        axes.axvline(mark, color=palette()["soft"], lw=1, ls=(0, (4, 3)))
    return embedded(figure, label)


def _axes(across: str, upwards: str, more: float = 0.0, is_count: bool = False) -> tuple[Figure, Axes]:
    figure, axes = new_chart(WIDTH, HEIGHT + more, **{**MARGINS, "top": MARGINS["top"] + more})
    axes.set(xlabel=across, ylabel=upwards)
    axes.grid(axis="y")
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    round_ticks(axes.xaxis, 8, is_count)
    round_ticks(axes.yaxis, 5, is_count=True)
    return figure, axes
