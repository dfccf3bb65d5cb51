"""A matrix or a map of cells: the stronger the colour the larger the number."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.report.page.svg import chart, line, number, tag, tick_text, ticks, words

SIDE, LEFT, BOTTOM, TOP, BAR = 380.0, 74.0, 46.0, 12.0, 96.0


class Axis(NamedTuple):
    """What an axis shows, and from where to where."""

    name: str
    lo: float
    hi: float


def heat(
    values: NDArray[np.float64],
    across: Axis,
    upwards: Axis,
    meaning: str,
    label: str,
    downwards: bool = False,
    links: Sequence[tuple[int, int, str]] = (),
) -> str:
    """A picture of a matrix ``(rows, columns)``; NaN is left empty.

    Args:
        values: row 0 is the lowest, or the topmost where ``downwards``.
        across, upwards: the axes.
        meaning: of the colour.
        label: for those who cannot see it.
        downwards: rows are counted from the top, as of a distance matrix.
        links: row, column and address of cells that lead somewhere.
    """
    rows, columns = values.shape
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 1.0)
    low = min(low, 0.0)
    wide, tall = SIDE / columns, SIDE / rows
    where = {(row, column): href for row, column, href in links}
    out = [tag("rect", x=LEFT, y=TOP, width=SIDE, height=SIDE, fill="var(--wash)")]
    for row in range(rows):
        y = TOP + (row if downwards else rows - 1 - row) * tall
        for column, value in enumerate(values[row]):
            if not np.isfinite(value) or value <= low:
                continue
            shade = round(0.12 + 0.88 * (value - low) / max(high - low, 1e-12), 2)
            box = tag(
                "rect", x=LEFT + column * wide, y=y, width=wide + 0.15, height=tall + 0.15,
                fill="var(--heat)", fill_opacity=shade,
            )  # fmt: skip
            href = where.get((row, column))
            out.append(tag("a", box, href=href) if href else box)
    out += [_across(across), _upwards(upwards, downwards), _bar(low, high, meaning)]
    return chart(LEFT + SIDE + BAR, TOP + SIDE + BOTTOM, "".join(out), label)


def _across(axis: Axis) -> str:
    y = TOP + SIDE
    out = [line(LEFT, y, LEFT + SIDE, y, "axis")]
    for tick in ticks(axis.lo, axis.hi):
        x = LEFT + SIDE * (tick - axis.lo) / max(axis.hi - axis.lo, 1e-12)
        out += [line(x, y, x, y + 4, "axis"), words(x, y + 17, tick_text(tick), 11.5, "middle", is_soft=True)]
    return "".join(out) + words(LEFT + SIDE / 2, y + 36, axis.name, 12, "middle")


def _upwards(axis: Axis, downwards: bool) -> str:
    out = [line(LEFT, TOP, LEFT, TOP + SIDE, "axis")]
    for tick in ticks(axis.lo, axis.hi):
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
                fill_opacity=round(0.12 + 0.88 * share, 2),
            )
        )
    for share, value in ((0.0, high), (1.0, low)):
        out.append(words(x + 20, y + tall * share + 4, tick_text(float(f"{value:.3g}")), 11.5, is_soft=True))
    return "".join(out)
