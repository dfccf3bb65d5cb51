import math
from typing import NamedTuple

Point = tuple[float, float, float]
"""x, y and z in metres."""
DIGITS = 9  # decimals to which y is rounded when mirrored about a line other than y = 0, against float noise


def mirrored_point(point: Point, middle: float = 0.0) -> Point:
    """Returns a point mirrored about the line y = ``middle``, in metres."""
    x, y, z = point
    return x, round(2 * middle - y, DIGITS) if middle else 0.0 - y, z


class NetworkPose(NamedTuple):
    """A point in metres and a heading in radians."""

    point: Point
    heading: float

    def ahead(self, metres: float, turn: float = 0.0) -> "NetworkPose":
        """Returns the pose ``metres`` straight ahead at the same height, with ``turn`` radians added to the
        heading.
        """
        (x, y, z), h = self.point, self.heading
        return NetworkPose((x + metres * math.cos(h), y + metres * math.sin(h), z), h + turn)
