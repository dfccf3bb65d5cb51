"""Labels the map's border where it is in view and the road does not cover the label."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes

from roadgpt.report.canvas import SOFT
from roadgpt.report.labels import Box
from roadgpt.report.plan_view import Array, Frame
from roadgpt.report.text_width import inches

BORDER = "border of the map"
SIZE, HIGH, GAP = 8.5, 0.16, 0.05  # points; inches: of the letters, and from the border
PLACES = 9  # that are tried along a side
CLEAR = 12.0  # m from the centre line: carriageway, verge, and a little more


def name_border(axes: Axes, frame: Frame, size: float, centre: Array, per_inch: float) -> Box | None:
    """Writes the label beside a border that is in view; returns its box, or None where there is no room.

    Args:
        axes: the axes to write on.
        frame: what the axes show, in metres.
        size: side of the map, metres.
        centre: points on the centre line of the road, ``(n, 2)``, metres.
        per_inch: metres per inch of the picture.
    """
    offers = list(
        _offers(frame, size, (inches(BORDER, SIZE) + 0.1) * per_inch, HIGH * per_inch, GAP * per_inch)
    )
    clear = [(box, turned) for box, turned in offers if _away(box, centre) > CLEAR]
    if not clear:
        return None
    box, turned = clear[0]
    axes.text(
        (box[0] + box[1]) / 2, (box[2] + box[3]) / 2, BORDER, ha="center", va="center", size=SIZE, color=SOFT,
        rotation=90 if turned else 0, zorder=0.7,
    )  # fmt: skip
    return box


def _offers(frame: Frame, size: float, wide: float, high: float, gap: float) -> Iterator[tuple[Box, bool]]:
    """Yields boxes beside borders in view, from their middle outwards, and whether the text is vertical."""
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


def _away(box: Box, points: Array) -> float:
    """Returns the distance from a box to the nearest point, metres."""
    x0, x1, y0, y1 = box
    dx = np.maximum(np.maximum(x0 - points[:, 0], points[:, 0] - x1), 0)
    dy = np.maximum(np.maximum(y0 - points[:, 1], points[:, 1] - y1), 0)
    return float(np.hypot(dx, dy).min())
