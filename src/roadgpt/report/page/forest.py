"""Shares with their intervals: groups below each other, in each a row for every series."""

from collections.abc import Sequence
from typing import NamedTuple

from roadgpt.report.page.svg import chart, colour, legend, line, tag, words

WIDTH, LEFT, RIGHT, TOP = 560.0, 16.0, 120.0, 34.0
ROW, HEAD, GAP = 20.0, 22.0, 10.0


class Share(NamedTuple):
    """A share of 0 to 1 with its interval, and what it says in letters."""

    series: int
    value: float
    lo: float
    hi: float
    text: str


def forest(groups: Sequence[tuple[str, Sequence[Share]]], series: Sequence[str], label: str) -> str:
    """A chart of shares from 0 to 100 %: a dot for each and a line for its interval.

    Args:
        groups: name of each group and its shares, in the order in which they stand below each other.
        series: names of the series.
        label: for those who cannot see it.
    """
    told, below = legend(series, LEFT, 18.0, WIDTH - 2 * LEFT)
    top = below + TOP - 18.0
    high = top + sum(HEAD + ROW * len(shares) + GAP for _, shares in groups) + 26
    right = WIDTH - RIGHT
    out = [told]
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        x = LEFT + share * (right - LEFT)
        out += [
            line(x, top, x, high - 24),
            words(x, high - 8, f"{100 * share:.0f} %", 11.5, "middle", is_soft=True),
        ]
    y = top
    for name, shares in groups:
        y += HEAD
        out.append(_backed(LEFT + 4, y - 5, name))
        for each in shares:
            out.append(_row(each, y + ROW / 2, right))
            y += ROW
        y += GAP
    return chart(WIDTH, high, "".join(out), label)


def _backed(x: float, y: float, name: str) -> str:
    """A group's name, over the grid."""
    return words(x, y, name, 12.5, is_bold=True, has_halo=True)


def _row(share: Share, y: float, right: float) -> str:
    def at(value: float) -> float:
        return LEFT + value * (right - LEFT)

    hue = colour(share.series)
    return (
        tag("line", x1=at(share.lo), y1=y, x2=at(share.hi), y2=y, stroke=hue, stroke_width=3, opacity=0.55)
        + tag("circle", cx=at(share.value), cy=y, r=4.5, fill=hue)
        + words(right + 12, y + 4, share.text, 12)
    )
