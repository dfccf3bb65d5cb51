"""Draws bar charts of ratings, and of the answers to questions about the raters, for the report and for
papers.

A bar of ratings shows all answers about one road, or one pair of roads, for one criterion. The middle of the
third answer is at 0. The part of the bar to the right of 0 therefore shows favourable answers: the road
matches the description, or the two roads are similar.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Drawing
from matplotlib.patches import Patch

from roadgpt.report.canvas import BLUE, VERMILLION, add_axes, fitted, in_our_style, new_figure, save, save_all
from roadgpt.report.page.charts import embedded, palette
from roadgpt.report.page.model import Figure
from roadgpt_study.survey.answers import Counts, RatingTally, Unit

# from orange to blue, which colour-blind people can distinguish; every piece contains its number
SHADES = ("#c2510a", "#efb184", "#c9ccd1", "#8fc1e3", "#0a69a8")
ON_SHADES = ("#fefefe", "#101216", "#101216", "#101216", "#fefefe")  # the same on light and dark pages
WIDE, LEFT, RIGHT = 9.6, 3.1, 0.75  # inches
ROW, GAP, HEAD = 0.33, 0.22, 0.34  # inches: of a bar, before an item, of its description
TOP, BOTTOM = 0.95, 0.62  # inches
SMALLEST = 4.0  # percent of a bar that has room for its number
INK, SOFT, FAINT = (palette()[name] for name in ("ink", "soft", "line"))
GAPS = 5 * "\N{NO-BREAK SPACE}"  # pages draw several usual spaces as one
IN_PAGE = "width: 58rem; min-width: 38rem"  # on a phone it is scrolled and not shrunk
MADE_UP = "SYNTHETIC: made-up raters, no data of people"


@in_our_style
def rating_bars(found: RatingTally, folder: Path, is_synthetic: bool) -> Figure:
    """Draws all ratings in one part of the survey, one bar for each criterion of each item (a road or a pair
    of roads), and writes the figure into a folder as PNG, PDF and SVG. If the raters are simulated, the
    figure says so."""
    items = list(dict.fromkeys(unit.item.id for unit in found.units))
    high = TOP + BOTTOM + len(items) * (HEAD + GAP) + len(found.units) * ROW
    figure = new_figure(WIDE, high)
    figure.patch.set_alpha(0)
    axes = add_axes(figure, LEFT, BOTTOM, RIGHT, TOP)
    axes.patch.set_alpha(0)
    axes.set(xlim=(-100, 100), ylim=(high - TOP - BOTTOM, 0))
    axes.set_yticks([])
    ticks = range(-100, 101, 50)
    axes.set_xticks(ticks, [f"{abs(tick)} %" for tick in ticks])
    axes.grid(axis="x", color=FAINT, lw=0.8)
    axes.tick_params(colors=SOFT)
    axes.axvline(0, color=SOFT, lw=0.9)
    axes.set_axisbelow(True)
    for side in ("left", "right", "top"):
        axes.spines[side].set_visible(False)
    says = ("does not match", "matches") if found.part == "alignment" else ("different", "similar")
    axes.set_xlabel(f"← {says[0]}{GAPS}share of raters{GAPS}{says[1]} →")
    y = 0.0
    for item in items:
        own = [unit for unit in found.units if unit.item.id == item]
        y += GAP
        title = fitted(f"“{own[0].item.prompt}”", WIDE - LEFT - 0.1 + LEFT - 0.2, 10, True)
        axes.text(
            (0.12 - LEFT) / (WIDE - LEFT - RIGHT), y + HEAD / 2, title, size=10, weight="bold", color=INK,
            va="center", transform=axes.get_yaxis_transform(), parse_math=False,
        )  # fmt: skip
        y += HEAD
        for unit in own:
            _bar(axes, unit, y + ROW / 2)
            y += ROW
    _legend(figure, found.units[0].question.answers, high)
    label = f"ratings of {'roads and descriptions' if found.part == 'alignment' else 'two roads'}"
    caption = "All answers; the middle answer is centred on zero, and the numbers count raters."
    return _finished(figure, found.part, label, caption, folder, is_synthetic)


def _bar(axes: Axes, unit: Unit, y: float) -> None:
    counts = unit.counts
    label = "in general" if unit.criterion == "overall" else unit.criterion
    across = axes.get_yaxis_transform()
    style: dict[str, Any] = {"size": 9.5, "va": "center", "transform": across, "parse_math": False}
    axes.text(-0.015, y, fitted(label, LEFT - 0.3, 9.5), color=INK, ha="right", **style)
    axes.text(1.015, y, f"n = {unit.number}", color=SOFT, ha="left", **style)
    if not unit.number:
        return
    shares = [100 * count / unit.number for count in counts]
    at = -(shares[0] + shares[1] + shares[2] / 2)
    for share, count, shade, on in zip(shares, counts, SHADES, ON_SHADES, strict=True):
        axes.barh(y, share, ROW * 0.78, left=at, color=shade, lw=0)
        if share >= SMALLEST:
            axes.text(at + share / 2, y, str(count), size=9, color=on, ha="center", va="center")
        at += share


def _legend(figure: Drawing, answers: Sequence[str], high: float) -> None:
    patches = [Patch(fc=shade, label=answer) for shade, answer in zip(SHADES, answers, strict=True)]
    legend = figure.legend(
        handles=patches, loc="upper left", bbox_to_anchor=(0.005, 1 - 0.28 / high), ncols=3, fontsize=8.5,
        frameon=False, handlelength=1.1, handleheight=1.1, columnspacing=1.4, labelcolor=INK,
    )  # fmt: skip
    legend.set_in_layout(False)


@in_our_style
def about_bars(counts: Counts, folder: Path, is_synthetic: bool) -> Figure:
    """Draws how often each answer was given to each question about the raters; ``folder`` and
    ``is_synthetic`` are as for ``rating_bars``."""
    rows = -(-len(counts) // 2)
    heights = [
        max(len(each[1]) for each in counts[2 * row : 2 * row + 2]) * 0.25 + 0.62 for row in range(rows)
    ]
    high = sum(heights) + 0.4
    figure = new_figure(WIDE, high)
    figure.patch.set_alpha(0)
    most = max(1, *(count for _, answers in counts for _, count in answers))
    top = high - 0.35
    for number, (text, answers) in enumerate(counts):
        row, column = divmod(number, 2)
        tall = len(answers) * 0.25
        left = 1.75 + column * WIDE / 2
        upper = top - sum(heights[:row]) - 0.38
        axes: Axes = figure.add_axes((left / WIDE, (upper - tall) / high, 2.6 / WIDE, tall / high))
        axes.patch.set_alpha(0)
        axes.set(xlim=(0, most * 1.12), ylim=(len(answers) - 0.5, -0.5))
        axes.axis("off")
        style: dict[str, Any] = {"size": 9.5, "va": "center", "color": INK, "parse_math": False}
        for y, (answer, count) in enumerate(answers):
            axes.barh(y, count, 0.7, color=BLUE if count else "none", lw=0)
            axes.text(-0.02 * most, y, fitted(answer, 1.6, 9.5), ha="right", **style)
            axes.text(count + 0.02 * most, y, str(count), ha="left", **style)
        title = fitted(text, WIDE / 2 - 0.3, 10, True)
        figure.text((left - 1.6) / WIDE, (upper + 0.16) / high, title, size=10, weight="bold", color=INK)
    label, caption = "answers of raters about themselves", "Who answered: how many raters gave each answer."
    return _finished(figure, "raters", label, caption, folder, is_synthetic)


def _finished(
    figure: Drawing, name: str, label: str, caption: str, folder: Path, is_synthetic: bool
) -> Figure:
    """Writes a figure as PNG, PDF and SVG, and returns it as SVG whose text has the colours of the page."""
    if is_synthetic:
        figure.text(0.995, 0.995, MADE_UP, size=10, weight="bold", color=VERMILLION, ha="right", va="top")
        figure.text(
            0.62, 0.5, "SYNTHETIC", size=54, weight="bold", color=VERMILLION, alpha=0.16, ha="center",
            va="center", rotation=18, zorder=50,
        )  # fmt: skip
    save(figure, folder / f"{name}.svg")
    with rc_context({"svg.fonttype": "none"}):
        svg = embedded(figure, label).replace("<svg ", f'<svg style="{IN_PAGE}" ', 1)
    figure.patch.set_alpha(1)
    save_all(figure, folder / f"{name}.png", ("pdf", "png"))
    return Figure(name, caption, svg)
