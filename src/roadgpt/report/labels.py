"""Places labels so that they cover neither the road nor each other, and labels the border of the map."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import islice

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.report.canvas import HALO, INK, SOFT
from roadgpt.report.plan_view import Frame
from roadgpt.report.text_width import inches

SIZE, MINOR_SIZE, LINE = 10, 8.5, 0.19  # points, points, inches
Box = tuple[float, float, float, float]
"""Left, right, lower and upper border, metres."""
REACHES = (0.34, 0.5, 0.72, 1.0, 1.4)  # inches from the place to the label
FAR_REACHES = (1.9, 2.5, 3.2)  # inches, for minor labels only
COVERED = 16.0  # cost of covering another label
WAYS = 16

BORDER = "border of the map"
BORDER_SIZE, HIGH, GAP = 8.5, 0.16, 0.05  # points; inches: of the letters, and from the border
PLACES = 9  # that are tried along a side
CLEAR = 12.0  # m from the centre line: carriageway, shoulder, and a little more


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
    """Radius in metres of the circle around each point of ``clear_of`` that no label should cover."""
    _boxes: list[Box] = field(default_factory=list)
    _leaders: list[Array] = field(default_factory=list)
    """Points on the lines that connect labels with their places, each ``(n, 2)``."""

    def name_border(self, size: float) -> None:
        """Labels the border of a square map with sides of ``size`` metres, if it is visible and there is
        room.
        """
        wide = (inches(BORDER, BORDER_SIZE) + 0.1) * self.per_inch
        offers = _offers(self.frame, size, wide, HIGH * self.per_inch, GAP * self.per_inch)
        clear = ((box, turned) for box, turned in offers if _distances(box, self.clear_of).min() > CLEAR)
        for box, turned in islice(clear, 1):
            self._boxes.append(box)
            self.axes.text(
                (box[0] + box[1]) / 2, (box[2] + box[3]) / 2, BORDER, ha="center", va="center",
                size=BORDER_SIZE, color=SOFT, rotation=90 if turned else 0, zorder=0.7,
            )  # fmt: skip

    def put(
        self,
        place: tuple[float, float],
        text: str,
        colour: str = INK,
        away: Array | None = None,
        is_minor: bool = False,
    ) -> bool:
        """Labels a place (x, y) in metres, if the place is in the frame. Minor labels have smaller letters
        and may be farther away. A minor label without room is left out; the result is then False, otherwise
        True.

        ``away`` is the preferred direction ``(2,)`` from the place to the label, of length 1.
        """
        if not self.frame.holds(*place):
            return True
        rows = text.split("\n")
        size, reaches = (MINOR_SIZE, REACHES + FAR_REACHES) if is_minor else (SIZE, REACHES)
        wide = (inches(text, size) + 0.1) * self.per_inch
        high = (len(rows) * LINE * size / SIZE + 0.04) * self.per_inch
        cost, x, y = min(self._offers(place, wide, high, away, reaches), key=lambda offer: offer[0])
        if is_minor and cost >= COVERED:
            return False
        self._boxes.append(_box(x, y, wide, high))
        self._leaders.append(_leader(place, x, y, self._boxes[-1]))
        self.axes.annotate(
            text, place, (x, y), ha="center", va="center", size=size, color=colour, zorder=12,
            path_effects=HALO, linespacing=1.15,
            arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.9, "shrinkA": 0, "shrinkB": 5},
        )  # fmt: skip
        return True

    def _offers(
        self,
        place: tuple[float, float],
        wide: float,
        high: float,
        away: Array | None,
        reaches: tuple[float, ...],
    ) -> list[tuple[float, float, float]]:
        """Returns cost and centre of every place that a label could take."""
        offers = []
        for reach in reaches:
            for angle in np.arange(WAYS) * (2 * np.pi / WAYS):
                way = np.array([np.cos(angle), np.sin(angle)])
                # ``reach`` is the distance to the near side of the label, not to its middle
                x = place[0] + way[0] * (reach * self.per_inch + wide / 2)
                y = place[1] + way[1] * (reach * self.per_inch + high / 2)
                cost = reach + (0.0 if away is None else 0.6 * (1 - float(way @ away)))
                cost += self._cover(x, y, wide, high) + self._crossing(place, x, y, wide, high)
                offers.append((cost, x, y))
        return offers

    def _cover(self, x: float, y: float, wide: float, high: float) -> float:
        """Returns the cost of covering what lies under a box: road, labels, or the border of the frame."""
        x0, x1, y0, y1 = box = _box(x, y, wide, high)
        is_covered = _distances(box, self.clear_of) < self.radius
        cost = 10.0 * float(is_covered.mean()) + 2.0 * bool(is_covered.any())
        cost += COVERED * sum(x0 < b and a < x1 and y0 < d and c < y1 for a, b, c, d in self._boxes)
        frame = self.frame
        return cost + 20.0 * (x0 < frame.x0 or x1 > frame.x1 or y0 < frame.y0 or y1 > frame.y1)

    def _crossing(self, place: tuple[float, float], x: float, y: float, wide: float, high: float) -> float:
        """Returns the cost if a label's line crosses other labels, or if their lines cross the label."""
        own = _box(x, y, wide, high)
        line = _leader(place, x, y, own)
        through = sum(bool(_inside(box, line).any()) for box in self._boxes)
        return 8.0 * (through + sum(bool(_inside(own, other).any()) for other in self._leaders))


def _box(x: float, y: float, wide: float, high: float) -> Box:
    return x - wide / 2, x + wide / 2, y - high / 2, y + high / 2


def _leader(place: tuple[float, float], x: float, y: float, box: Box) -> Array:
    """Returns points on the line from a place to the box of a label."""
    line = np.linspace(place, (x, y), 24)
    return line[~_inside(box, line)]


def _inside(box: Box, points: Array) -> NDArray[np.bool_]:
    """Returns which points ``(n, 2)`` lie in the box."""
    x0, x1, y0, y1 = box
    x, y = points.T
    return np.asarray((x > x0) & (x < x1) & (y > y0) & (y < y1))


def _offers(frame: Frame, size: float, wide: float, high: float, gap: float) -> Iterator[tuple[Box, bool]]:
    """Yields boxes beside each visible border, middle first, and whether their text is vertical."""
    for y in (-gap - high, size + gap):
        if frame.y0 < y and y + high < frame.y1:
            for x in _along(max(frame.x0, 0.0) + wide / 2, min(frame.x1, size) - wide / 2):
                yield (x - wide / 2, x + wide / 2, y, y + high), False
    for x in (-gap - high, size + gap):
        if frame.x0 < x and x + high < frame.x1:
            for y in _along(max(frame.y0, 0.0) + wide / 2, min(frame.y1, size) - wide / 2):
                yield (x, x + high, y - wide / 2, y + wide / 2), True


def _along(low: float, high: float) -> list[float]:
    if low > high:
        return []
    middle = (low + high) / 2
    return sorted(np.linspace(low, high, PLACES).tolist(), key=lambda place: abs(place - middle))


def _distances(box: Box, points: Array) -> Array:
    """Returns the distances of points ``(n, 2)`` from a box, metres."""
    x0, x1, y0, y1 = box
    dx = np.maximum(np.maximum(x0 - points[:, 0], points[:, 0] - x1), 0)
    dy = np.maximum(np.maximum(y0 - points[:, 1], points[:, 1] - y1), 0)
    return np.hypot(dx, dy)
