"""Places labels so that they cover neither the road nor each other."""

from dataclasses import dataclass, field

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from roadgpt.report.canvas import HALO, INK
from roadgpt.report.plan_view import Frame
from roadgpt.report.text_width import inches

Array = NDArray[np.float64]

SIZE, LINE = 10, 0.19  # points; inches
Box = tuple[float, float, float, float]
"""Left, right, lower and upper border, metres."""
REACHES = (0.34, 0.5, 0.72, 1.0, 1.4)  # inches from the place to the label
WAYS = 16


@dataclass
class Labels:
    """Places labels on axes so that they cover neither given points nor each other."""

    axes: Axes
    frame: Frame
    per_inch: float
    """Metres per inch of the picture."""
    clear_of: Array
    """Points ``(n, 2)`` that no label should cover."""
    radius: float
    """Metres around each of these points."""
    _boxes: list[Box] = field(default_factory=list)
    _leaders: list[Array] = field(default_factory=list)
    """Points on the lines from labels to their places, each ``(n, 2)``."""

    def keep_clear_of(self, box: Box) -> None:
        """Marks a box as taken; later labels avoid it."""
        self._boxes.append(box)

    def put(
        self, place: tuple[float, float], text: str, colour: str = INK, away: Array | None = None
    ) -> None:
        """Labels a place.

        Args:
            place: x and y, metres; a place outside the frame gets no label.
            text: the label, of one line or several.
            colour: of the text.
            away: preferred direction ``(2,)`` from the place to the label, of length 1.
        """
        if not self.frame.holds(*place):
            return
        rows = text.split("\n")
        wide = (inches(text, SIZE) + 0.1) * self.per_inch
        high = (len(rows) * LINE + 0.04) * self.per_inch
        best = min(self._offers(place, wide, high, away), key=lambda offer: offer[0])
        _, x, y = best
        self._boxes.append(_box(x, y, wide, high))
        self._leaders.append(_leader(place, x, y, self._boxes[-1]))
        self.axes.annotate(
            text, place, (x, y), ha="center", va="center", size=SIZE, color=colour, zorder=12,
            path_effects=HALO, linespacing=1.15,
            arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.9, "shrinkA": 0, "shrinkB": 5},
        )  # fmt: skip

    def _offers(
        self, place: tuple[float, float], wide: float, high: float, away: Array | None
    ) -> list[tuple[float, float, float]]:
        """Returns cost and centre of every place that a label could take."""
        offers = []
        for reach in REACHES:
            for angle in np.arange(WAYS) * (2 * np.pi / WAYS):
                way = np.array([np.cos(angle), np.sin(angle)])
                # the label's near side, not its middle, lies so far away
                x = place[0] + way[0] * (reach * self.per_inch + wide / 2)
                y = place[1] + way[1] * (reach * self.per_inch + high / 2)
                cost = reach + (0.0 if away is None else 0.6 * (1 - float(way @ away)))
                cost += self._cover(x, y, wide, high) + self._crossing(place, x, y, wide, high)
                offers.append((cost, x, y))
        return offers

    def _cover(self, x: float, y: float, wide: float, high: float) -> float:
        """Returns the cost of covering what lies under a box: road, labels, or the border of the frame."""
        x0, x1, y0, y1 = _box(x, y, wide, high)
        dx = np.maximum(np.abs(self.clear_of[:, 0] - x) - wide / 2, 0)
        dy = np.maximum(np.abs(self.clear_of[:, 1] - y) - high / 2, 0)
        cost = 10.0 * float((np.hypot(dx, dy) < self.radius).mean())
        cost += 2.0 * bool((np.hypot(dx, dy) < self.radius).any())
        cost += 8.0 * sum(x0 < b and a < x1 and y0 < d and c < y1 for a, b, c, d in self._boxes)
        frame = self.frame
        return cost + 20.0 * (x0 < frame.x0 or x1 > frame.x1 or y0 < frame.y0 or y1 > frame.y1)

    def _crossing(self, place: tuple[float, float], x: float, y: float, wide: float, high: float) -> float:
        """Returns the cost of lines that run from a place to a label through another label."""
        own = _box(x, y, wide, high)
        line = _leader(place, x, y, own)
        through = sum(_holds(box, line) for box in self._boxes)
        return 8.0 * (through + sum(_holds(own, other) for other in self._leaders))


def _box(x: float, y: float, wide: float, high: float) -> Box:
    return x - wide / 2, x + wide / 2, y - high / 2, y + high / 2


def _leader(place: tuple[float, float], x: float, y: float, box: Box) -> Array:
    """Returns points on the line from a place to the box of a label."""
    line = np.linspace(place, (x, y), 24)
    x0, x1, y0, y1 = box
    return line[~((line[:, 0] > x0) & (line[:, 0] < x1) & (line[:, 1] > y0) & (line[:, 1] < y1))]


def _holds(box: Box, points: Array) -> bool:
    """Returns whether one of the points lies in the box."""
    x0, x1, y0, y1 = box
    x, y = points.T
    return bool(((x > x0) & (x < x1) & (y > y0) & (y < y1)).any())
