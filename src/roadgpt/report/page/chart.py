"""Converts matplotlib charts to SVG that uses the font and the light and dark colours of a page."""

import io
import re
from functools import cache
from html import escape
from pathlib import Path
from typing import Any

from matplotlib import rc_context, rcParamsDefault
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from roadgpt.report.canvas import UNDATED
from roadgpt.report.text_width import POINTS, inches

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
    """Returns a figure of ``width`` by ``height`` and its axes. The last four arguments are the distances of
    the axes from the borders of the figure; all lengths are in px.
    """
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
    CSS variables, and text uses the page's font. ``label`` says what the chart shows, for screen readers.
    """
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
