"""Defines the style, the text and the header of all pictures, and writes pictures to files."""

import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args

from matplotlib import rc_context, rcParamsDefault
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, findfont, get_font
from matplotlib.patheffects import withStroke

from roadgpt.errors import UsageError
from roadgpt.run import Run
from roadgpt.run.atomic import write_whole
from roadgpt.verdict import SEVERITIES, Severity, graded

Format = Literal["png", "svg", "pdf"]
"""File format of a picture: PNG in pixels; SVG and PDF can be scaled."""
FORMATS: tuple[Format, ...] = get_args(Format)
PNG: tuple[Format, ...] = ("png",)
DPI = 110
# Metadata that would hold the date and matplotlib's version, and so differ from day to day.
UNDATED: Mapping[str, Mapping[str, None]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
# Without a salt the ids in an SVG are random; publishers want fonts of Type 42 in a PDF.
SAVING: dict[Any, Any] = {"svg.hashsalt": "roadgpt", "svg.fonttype": "path", "pdf.fonttype": 42}
INK, SOFT, FAINT = "#1b1e23", "#5f6670", "#d9dce1"
GRASS = "#cfdcc0"
# Okabe and Ito's colours, which colour-blind people can distinguish; a word or a symbol is always shown, too.
BLUE, ORANGE, GREEN, VERMILLION, PURPLE = "#0072b2", "#e69f00", "#009e73", "#d55e00", "#aa4499"
YELLOW, SKY = "#d0bf00", "#56b4e9"
SEVERE: dict[Severity, str] = dict(zip(SEVERITIES, (GREEN, YELLOW, ORANGE), strict=True))
"""Colours that show how far outside its lane the car was."""
OUTCOMES = {
    "PASS": GREEN,
    **{f"PASS ({name})": SEVERE[name] for name in SEVERITIES[1:]},
    "FAIL": VERMILLION,
    "UNAVOIDABLE": SKY,
    "NOT TESTED": INK,
    "INVALID": SOFT,
    "ERROR": PURPLE,
    "VALID": BLUE,
}
LETTERS = {YELLOW: INK, ORANGE: INK, SKY: INK}
"""Colour of text on each light colour; text on all other colours is white."""
DARKER = {YELLOW: "#7d7100", ORANGE: "#9a6400", SKY: "#2a76a3"}
"""Darker variants of light colours, for text on white."""
HALO = [withStroke(linewidth=2.5, foreground="white")]
MARGIN = 0.3  # inches, left and right of the header
LINE = 0.19  # inches
TITLE, TEXT, SMALL = 11, 10, 8.5  # points
BADGE = 9  # points
MOST_LINES = 2  # of the description
MOST_SAID = 8  # lines of the outcome; only a very long error message is cut
UNKNOWN = "□"  # in place of a letter that the font lacks
POINTS = 72.0  # per inch
ELLIPSIS = " …"
BREAK = re.compile(r"(?<!\d) | (?!(?:%|g|s|m|km|km/h|m/s|degrees)(?:\W|$))")


# A user's matplotlibrc would otherwise change our pictures.
in_our_style = rc_context({name: value for name, value in rcParamsDefault.items() if name != "backend"})


def new_figure(width: float, height: float) -> Figure:
    """Returns an empty white figure, ``width`` by ``height`` inches."""
    figure = Figure(figsize=(width, height), dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def add_axes(figure: Figure, left: float, bottom: float, right: float, top: float) -> Axes:
    """Adds axes with the grey frame and ticks that all pictures have to a figure; the arguments are the
    distances in inches from the borders of the figure."""
    wide, high = figure.get_size_inches()
    box = (left / wide, bottom / high, (wide - left - right) / wide, (high - bottom - top) / high)
    axes: Axes = figure.add_axes(box)
    for side in axes.spines.values():
        side.set_color("#9aa1ab")
        side.set_linewidth(0.8)
    axes.tick_params(colors=SOFT, labelsize=9, length=3, width=0.8)
    axes.xaxis.label.set(color=INK, size=10)
    axes.yaxis.label.set(color=INK, size=10)
    return axes


def inches_of(axes: Axes) -> tuple[float, float]:
    """Returns width and height of axes in inches."""
    figure, shape = axes.get_figure(root=True), axes.get_position()
    assert figure is not None
    return figure.get_figwidth() * shape.width, figure.get_figheight() * shape.height


def note(axes: Axes, place: tuple[float, float], text: str, size: float = 9.5, zorder: float = 3) -> None:
    """Writes text whose upper right corner is at ``place``, (x, y) in fractions of the axes."""
    axes.text(
        *place, text, transform=axes.transAxes, ha="right", va="top", size=size, color=SOFT,
        path_effects=HALO, zorder=zorder,
    )  # fmt: skip


@dataclass(frozen=True)
class Header:
    """The header of a picture, with description, outcome, seed, length of the road and driver."""

    run: Run
    width: float  # width of the picture, inches
    title: str
    said: str

    @classmethod
    def of(cls, run: Run, width: float) -> "Header":
        """Returns the header of a picture that is ``width`` inches wide, with line breaks where needed."""
        room = width - 2 * MARGIN
        title = fitted(run.title, room, TITLE, True, MOST_LINES)
        return cls(run, width, title, fitted(run.description, room - _badge(run), TEXT, lines=MOST_SAID))

    @property
    def height(self) -> float:
        """Height of the header, inches."""
        return self._below_title + LINE * (self.said.count("\n") + 1) + 0.42

    @property
    def _below_title(self) -> float:
        return 0.19 + LINE * (self.title.count("\n") + 1)

    def write(self, figure: Figure) -> None:
        """Writes the header at the top of a figure."""
        high, run = figure.get_figheight(), self.run

        def say(x: float, below: float, text: str, **style: Any) -> None:
            place = x / self.width, 1 - below / high
            figure.text(*place, text, va="top", linespacing=1.15, parse_math=False, **style)

        say(MARGIN, 0.12, self.title, size=TITLE, weight="bold", color=INK)
        fill = OUTCOMES[outcome_of(run)]
        badge = {"boxstyle": "round,pad=0.28", "fc": fill, "ec": "none"}
        style = {"size": BADGE, "weight": "bold", "color": LETTERS.get(fill, "white"), "bbox": badge}
        say(MARGIN + 0.05, self._below_title + 0.01, outcome_of(run), **style)
        say(MARGIN + _badge(run), self._below_title, self.said, size=TEXT, color=INK)
        say(MARGIN, self.height - 0.36, origin(run), size=SMALL, color=SOFT)


def outcome_of(run: Run) -> str:
    """Returns the outcome of a Run as a key of OUTCOMES, such as "FAIL" or "PASS (partly outside)"."""
    return graded(run.outcome, run.verdict.max_oob if run.verdict else None)


def _badge(run: Run) -> float:
    return 0.24 + inches(outcome_of(run), BADGE, bold=True)


def origin(run: Run) -> str:
    """Returns one line with seed, number and length of the road and, if it was driven, by whom."""
    seed = f"seed {run.request.seed}"
    said = [f"{seed}, road {run.index}"] if run.words else [seed] if run.drive is not None else []
    said.append("no route" if run.road and not run.road.has_way else f"{run.length:.0f} m")
    if run.drive is not None:
        said.append(f"driven by {run.drive.driver} in {run.drive.simulator}")
        said.append(f"oracle {run.world.limits.oracle}")
    return "   ·   ".join(said)


def save(figure: Figure, path: Path) -> Path:
    """Writes a picture in the format of the path's suffix; the same figure gives an identical file."""
    write_whole(path, encoded(figure, format_of(path)))
    return path


def save_all(figure: Figure, path: Path, formats: Sequence[Format] = PNG) -> list[Path]:
    """Writes a picture in each format, replacing the suffix of ``path``, and returns the paths."""
    return [save(figure, path.with_suffix(f".{name}")) for name in formats]


def format_of(path: Path) -> Format:
    """Returns the picture format that a path's suffix names."""
    for name in FORMATS:
        if path.suffix.lower() == f".{name}":
            return name
    raise UsageError(f"a picture cannot be written as {path.name}; end its name in .png, .svg or .pdf")


def encoded(figure: Figure, name: Format) -> bytes:
    """Returns the bytes of a figure's file; the same figure gives the same bytes."""
    data = io.BytesIO()
    with rc_context(SAVING):
        figure.savefig(data, format=name, dpi=DPI, metadata=dict(UNDATED[name]))
    return data.getvalue()


def plain(text: str) -> str:
    """Returns text as one line, with a box in place of each letter that the font lacks."""
    return "".join(letter if _advance(letter, False) else UNKNOWN for letter in " ".join(text.split()))


def inches(text: str, size: float, bold: bool = False) -> float:
    """Returns the width of the longest line in inches; ``size`` is the font size in points."""
    return max(sum(_advance(letter, bold) for letter in row) for row in text.split("\n")) * size / POINTS


def fitted(text: str, width: float, size: float, bold: bool = False, lines: int = 1) -> str:
    """Returns text wrapped to at most ``lines`` lines of ``width`` inches, with an ellipsis for what is cut
    off. A number and its unit stay on one line."""
    words = BREAK.split(plain(text))
    rows: list[str] = []
    while words and len(rows) < lines:
        count = 1
        while count < len(words) and inches(" ".join(words[: count + 1]), size, bold) <= width:
            count += 1
        is_last = len(rows) == lines - 1 and count < len(words)
        rows.append(_shortened(" ".join(words[:count]), width, size, bold, is_last))
        words = words[count:]
    return "\n".join(rows)


def _shortened(row: str, width: float, size: float, bold: bool, has_more: bool) -> str:
    if not has_more and inches(row, size, bold) <= width:
        return row
    while row and inches(row + ELLIPSIS, size, bold) > width:
        row = row[:-1]
    return row.rstrip() + ELLIPSIS


@cache
def _advance(letter: str, bold: bool) -> float:
    font = get_font(findfont(FontProperties(family="DejaVu Sans", weight="bold" if bold else "normal")))
    if not font.get_char_index(ord(letter)):
        return 0.0
    font.set_size(100.0, POINTS)
    return float(font.load_char(ord(letter)).linearHoriAdvance) / 65536 / 100
