"""What all pictures share: colours, the header, and PNG bytes that depend on nothing but the picture."""

import io
import textwrap
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from roadgpt.run import Run
from roadgpt.run.atomic import write_whole

DPI = 110
INK, SOFT, FAINT = "#1b1e23", "#5f6670", "#d9dce1"

# Okabe and Ito's colours, which colour-blind people tell apart; every use has a word or a symbol beside it.
BLUE, ORANGE, GREEN, VERMILLION, PURPLE = "#0072b2", "#e69f00", "#009e73", "#d55e00", "#aa4499"
OUTCOMES = {"PASS": GREEN, "FAIL": VERMILLION, "INVALID": SOFT, "ERROR": PURPLE, "VALID": BLUE}

HALO = [withStroke(linewidth=2.5, foreground="white")]
MARGIN = 0.3  # inches, left and right of the header
HEADER = 0.98  # inches
WORDS_LINES = 2


def new_figure(width: float, height: float) -> Figure:
    """An empty white figure, inches."""
    figure = Figure(figsize=(width, height), dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def add_axes(figure: Figure, left: float, bottom: float, right: float, top: float, **options: Any) -> Axes:
    """Axes whose borders lie so many inches from the figure's borders, below the header."""
    wide, high = figure.get_size_inches()
    box = (
        left / wide,
        bottom / high,
        (wide - left - right) / wide,
        (high - bottom - top) / high,
    )
    axes: Axes = figure.add_axes(box, **options)
    return dress(axes)


def dress(axes: Axes) -> Axes:
    """Quiet frame and ticks."""
    for side in axes.spines.values():
        side.set_color("#9aa1ab")
        side.set_linewidth(0.8)
    axes.tick_params(colors=SOFT, labelsize=9, length=3, width=0.8)
    axes.xaxis.label.set(color=INK, size=10)
    axes.yaxis.label.set(color=INK, size=10)
    return axes


def header(figure: Figure, run: Run) -> None:
    """The description, the outcome in a sentence, the seed and what made the road."""
    wide, high = figure.get_size_inches()
    letters = int((wide - 2 * MARGIN) * 11.2)  # bold, 11 points
    title = clipped(run.words or "a road that was given", letters, WORDS_LINES)
    lines = title.count("\n") + 1
    left = MARGIN / wide
    figure.text(left, 1 - 0.12 / high, title, size=11, weight="bold", color=INK, va="top", linespacing=1.15)
    below = 0.12 + 0.19 * lines + 0.07
    badge = figure.text(
        left + 0.05 / wide, 1 - (below + 0.01) / high, run.outcome, size=9, weight="bold", color="white",
        va="top", bbox={"boxstyle": "round,pad=0.28", "fc": OUTCOMES[run.outcome], "ec": "none"},
    )  # fmt: skip
    start = MARGIN + 0.22 + 0.098 * len(badge.get_text())
    room = int((wide - start - MARGIN) * 13.2)
    said = clipped(run.description, room, 1)
    figure.text(start / wide, 1 - below / high, said, size=10, color=INK, va="top")
    figure.text(left, 1 - (below + 0.26) / high, origin(run), size=8.5, color=SOFT, va="top")


def origin(run: Run) -> str:
    """Number, seed and length of the road, and who drove it."""
    said = [f"road {run.index} of seed {run.request.seed}" if run.words else f"seed {run.request.seed}"]
    said.append(f"{run.length:.0f} m")
    if run.drive is not None:
        said.append(f"driven by {run.drive.driver} in {run.drive.simulator}")
    return "   ·   ".join(said)


def clipped(text: str, letters: int, lines: int) -> str:
    """Text in so many lines of so many letters, its end left out where it must be. ``$`` stays a dollar."""
    rows = textwrap.wrap(" ".join(text.split()), letters, max_lines=lines, placeholder=" …")
    return "\n".join(rows).replace("$", r"\$")


def save(figure: Figure, path: Path) -> Path:
    """Write a PNG whole; the same figure gives the same bytes."""
    data = io.BytesIO()
    # matplotlib's version would otherwise stand in the file
    figure.savefig(data, format="png", dpi=DPI, metadata={"Software": None})
    write_whole(path, data.getvalue())
    return path
