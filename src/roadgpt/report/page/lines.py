"""Lines over a common axis, such as failures found over tests, and bars of a histogram."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.report.page.svg import chart, colour, legend, line, number, tag, tick_text, ticks, words

WIDTH, HEIGHT, LEFT, RIGHT, BOTTOM = 560.0, 260.0, 62.0, 18.0, 46.0
MOST_POINTS = 400  # of a line; more cannot be seen


def lines(curves: Sequence[tuple[str, ArrayLike, ArrayLike]], across: str, upwards: str, label: str) -> str:
    """Curves (name, x, y) that rise or fall, over linear axes from 0 or below; both axes count things."""
    names = [name for name, _, _ in curves]
    told, below = legend(names, LEFT, 16.0, WIDTH - LEFT - RIGHT) if len(names) > 1 else ("", 0.0)
    top = below + 14
    every = [(np.asarray(x, float), np.asarray(y, float)) for _, x, y in curves]
    x1 = max((float(x.max()) for x, _ in every if x.size), default=1.0) or 1.0
    y1 = max((float(y.max()) for _, y in every if y.size), default=1.0) or 1.0
    place = _Place((0.0, x1), (0.0, y1 * 1.05), top)
    out = [told, place.axes(across, upwards, apart=1.0)]
    for series, (x, y) in enumerate(every):
        if not x.size:
            continue
        some = np.unique(np.linspace(0, len(x) - 1, min(len(x), MOST_POINTS)).astype(int))
        points = " ".join(
            f"{number(place.x(a))},{number(place.y(b))}" for a, b in zip(x[some], y[some], strict=True)
        )
        out.append(tag("polyline", points=points, fill="none", stroke=colour(series), stroke_width=2))
    return chart(WIDTH, HEIGHT, "".join(out), label)


def bars(
    edges: ArrayLike, counts: ArrayLike, across: str, upwards: str, label: str, mark: float | None = None
) -> str:
    """A histogram: counts ``(n,)`` between edges ``(n + 1,)``; ``mark`` draws a line at a value."""
    at, many = np.asarray(edges, float), np.asarray(counts, float)
    place = _Place((float(at[0]), float(at[-1])), (0.0, max(float(many.max(initial=0)), 1.0) * 1.05), 14.0)
    out = [place.axes(across, upwards)]
    for x0, x1, count in zip(at[:-1], at[1:], many, strict=True):
        if count:
            left, top = place.x(x0), place.y(count)
            out.append(
                tag(
                    "rect",
                    x=left + 0.5,
                    y=top,
                    width=max(place.x(x1) - left - 1, 0.5),
                    height=place.y(0.0) - top,
                    fill=colour(0),
                )
            )
    if mark is not None and at[0] <= mark <= at[-1]:
        x = place.x(mark)
        out.append(line(x, 14, x, place.y(0.0), "axis", stroke_dasharray="4 3"))
    return chart(WIDTH, HEIGHT, "".join(out), label)


class _Place:
    """Where values lie on the picture."""

    def __init__(self, x: tuple[float, float], y: tuple[float, float], top: float) -> None:
        self._x, self._y, self._top = x, y, top

    def x(self, value: float) -> float:
        low, high = self._x
        return LEFT + (WIDTH - LEFT - RIGHT) * (value - low) / max(high - low, 1e-12)

    def y(self, value: float) -> float:
        low, high = self._y
        foot = HEIGHT - BOTTOM
        return foot - (foot - self._top) * (value - low) / max(high - low, 1e-12)

    def axes(self, across: str, upwards: str, apart: float = 0.0) -> str:
        """Both axes; upwards things are counted, and across ticks are at least so far apart."""
        foot, out = HEIGHT - BOTTOM, []
        for tick in ticks(*self._y, 5, least=1.0):
            y = self.y(tick)
            out += [
                line(LEFT, y, WIDTH - RIGHT, y),
                words(LEFT - 8, y + 4, tick_text(tick), 11.5, "end", is_soft=True),
            ]
        for tick in ticks(*self._x, 8, least=apart):
            x = self.x(tick)
            out += [
                line(x, foot, x, foot + 4, "axis"),
                words(x, foot + 17, tick_text(tick), 11.5, "middle", is_soft=True),
            ]
        out.append(line(LEFT, foot, WIDTH - RIGHT, foot, "axis"))
        middle = (self._top + foot) / 2
        name = words(15, middle, upwards, 12, "middle")
        out.append(tag("g", name, transform=f"rotate(-90 15 {number(middle)})"))
        return "".join(out) + words((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, across, 12, "middle")
