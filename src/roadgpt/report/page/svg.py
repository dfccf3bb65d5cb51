"""Of all charts: elements of SVG, numbers with few digits, round ticks; the same values, the same text."""

from collections.abc import Sequence
from html import escape
from math import ceil, floor, log10

SERIES = 6  # colours of the page that tell series apart
NARROW = 384.0  # px; a chart that is meant to be narrower is not widened on any screen


def tag(name: str, content: str = "", /, **attributes: object) -> str:
    """An element; ``_`` in a name stands for ``-``, and ``class_`` is ``class``."""
    told = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escape(_said(value))}"' for key, value in attributes.items()
    )
    return f"<{name}{told}>{content}</{name}>" if content else f"<{name}{told}/>"


def _said(value: object) -> str:
    return number(value) if isinstance(value, float) else str(value)


def number(value: float) -> str:
    """With at most two decimals, and no more than it needs."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def words(
    x: float,
    y: float,
    text: str,
    size: float = 12.5,
    anchor: str = "start",
    is_soft: bool = False,
    is_bold: bool = False,
    has_halo: bool = False,
) -> str:
    """Letters at a place: their left end, middle or right end."""
    style = {"class_": "soft" if is_soft else "halo"} if is_soft or has_halo else {}
    weight = {"font_weight": "600"} if is_bold else {}
    return tag("text", escape(text), x=x, y=y, font_size=size, text_anchor=anchor, **style, **weight)


def line(x0: float, y0: float, x1: float, y1: float, kind: str = "grid", **more: object) -> str:
    """A line of the class grid or axis."""
    return tag("line", x1=x0, y1=y0, x2=x1, y2=y1, class_=kind, **more)


def chart(width: float, height: float, content: str, label: str) -> str:
    """The whole picture; the label is read out to those who cannot see it."""
    return tag(
        "svg",
        content,
        xmlns="http://www.w3.org/2000/svg",
        viewBox=f"0 0 {number(width)} {number(height)}",
        width=width,
        height=height,
        class_="chart" if width >= NARROW else "chart narrow",
        role="img",
        aria_label=label,
    )


def colour(series: int) -> str:
    """Of the page, for the series of this number."""
    return f"var(--s{series % SERIES})"


def legend(names: Sequence[str], x: float, y: float, room: float) -> tuple[str, float]:
    """Names of series with their colours, row by row; and how far down they reach."""
    out, at = [], x
    for series, name in enumerate(names):
        wide = 22 + 6.8 * len(name) + 14
        if at + wide > x + room and at > x:
            at, y = x, y + 19
        out.append(tag("rect", x=at, y=y - 9, width=11, height=11, rx=2, fill=colour(series)))
        out.append(words(at + 16, y + 0.5, name, 12))
        at += wide
    return "".join(out), y


def ticks(low: float, high: float, most: int = 6, least: float = 0.0) -> list[float]:
    """Round numbers from low to high, at most so many and one more; ``least``: 1 where things are counted."""
    span = max(high - low, 1e-12)
    step = 10 ** floor(log10(span / most))
    step = max(next(step * by for by in (1, 2, 5, 10) if span / (step * by) <= most), least)
    first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
    return [n * step for n in range(first, last + 1)]


def tick_text(value: float) -> str:
    """A tick's number, short."""
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.6g}"
