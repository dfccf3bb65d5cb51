"""A matrix or a map of cells: the stronger the colour the larger the number."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.report.page.svg import chart, line, number, tag, tick_text, ticks, words

SHADES = 16
FEW = 10  # cells, below which a map shows nothing where all hold the same number
SIDE, LEFT, BOTTOM, TOP, BAR = 380.0, 74.0, 46.0, 12.0, 96.0


class Axis(NamedTuple):
    """What an axis shows, from where to where, and how far apart its ticks are at least."""

    name: str
    lo: float
    hi: float
    apart: float = 0.0


def is_map(values: NDArray[np.float64]) -> bool:
    """Do the numbers tell anything? Not where there is one at most, or a few that are all the same."""
    filled = values[np.isfinite(values) & (values > 0)]
    return len(np.unique(filled)) > 1 or len(filled) >= FEW


def heat(
    values: NDArray[np.float64],
    across: Axis,
    upwards: Axis,
    meaning: str,
    label: str,
    downwards: bool = False,
) -> str:
    """A picture of a matrix ``(rows, columns)``; what is NaN or 0 is left empty.

    Args:
        values: row 0 is the lowest, or the topmost where ``downwards``.
        across, upwards: the axes.
        meaning: of the colour.
        label: for those who cannot see it.
        downwards: rows are counted from the top, as of a distance matrix.
    """
    rows, columns = values.shape
    known = values[np.isfinite(values)]
    high = max(float(known.max(initial=0.0)), 1e-12)
    with np.errstate(invalid="ignore"):
        shade = np.ceil(np.where(np.isfinite(values) & (values > 0), values / high, 0) * SHADES).astype(int)
    shown = shade if downwards else shade[::-1]
    scale = f"translate({number(LEFT)} {number(TOP)}) scale({SIDE / columns:.6g} {SIDE / rows:.6g})"
    cells = "".join(_cells(shown, level) for level in range(1, SHADES + 1))
    out = [
        tag("rect", x=LEFT, y=TOP, width=SIDE, height=SIDE, fill="var(--wash)"),
        tag("g", cells, transform=scale, fill="var(--heat)"),
        _across(across),
        _upwards(upwards, downwards),
        _bar(0.0, high, meaning),
    ]
    return chart(LEFT + SIDE + BAR, TOP + SIDE + BOTTOM, "".join(out), label)


def _cells(shades: NDArray[np.intp], level: int) -> str:
    """All cells of one shade as one path in units of cells; neighbours in a row are one piece."""
    pieces = []
    for row, line_ in enumerate(shades == level):
        edges = np.flatnonzero(np.diff(np.r_[False, line_, False]))
        for first, last in edges.reshape(-1, 2):
            wide = last - first
            pieces.append(f"M{first} {row}h{wide}v1h-{wide}z")
    return tag("path", d="".join(pieces), fill_opacity=_opacity(level / SHADES)) if pieces else ""


def _opacity(share: float) -> float:
    return round(0.1 + 0.9 * share, 3)


def _across(axis: Axis) -> str:
    y = TOP + SIDE
    out = [line(LEFT, y, LEFT + SIDE, y, "axis")]
    for tick in ticks(axis.lo, axis.hi, least=axis.apart):
        x = LEFT + SIDE * (tick - axis.lo) / max(axis.hi - axis.lo, 1e-12)
        out += [line(x, y, x, y + 4, "axis"), words(x, y + 17, tick_text(tick), 11.5, "middle", is_soft=True)]
    return "".join(out) + words(LEFT + SIDE / 2, y + 36, axis.name, 12, "middle")


def _upwards(axis: Axis, downwards: bool) -> str:
    out = [line(LEFT, TOP, LEFT, TOP + SIDE, "axis")]
    for tick in ticks(axis.lo, axis.hi, least=axis.apart):
        share = (tick - axis.lo) / max(axis.hi - axis.lo, 1e-12)
        y = TOP + SIDE * (share if downwards else 1 - share)
        out += [
            line(LEFT - 4, y, LEFT, y, "axis"),
            words(LEFT - 8, y + 4, tick_text(tick), 11.5, "end", is_soft=True),
        ]
    middle = TOP + SIDE / 2
    name = words(18, middle, axis.name, 12, "middle")
    return "".join(out) + tag("g", name, transform=f"rotate(-90 18 {number(middle)})")


def _bar(low: float, high: float, meaning: str) -> str:
    """What the colours mean."""
    x, y, tall, steps = LEFT + SIDE + 22, TOP + 20, 180.0, 24
    out = [words(x - 4, TOP + 8, meaning, 12)]
    for step in range(steps):
        share = 1 - (step + 0.5) / steps
        out.append(
            tag(
                "rect",
                x=x,
                y=y + tall * step / steps,
                width=14,
                height=tall / steps + 0.2,
                fill="var(--heat)",
                fill_opacity=_opacity(share),
            )
        )
    for share, value in ((0.0, high), (1.0, low)):
        out.append(words(x + 20, y + tall * share + 4, tick_text(float(f"{value:.3g}")), 11.5, is_soft=True))
    return "".join(out)
