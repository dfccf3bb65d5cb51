"""Computes the vertical curves of a road: the parabolas that join the grades of its segments.

Each parabola is centred on the point where two segments meet.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

CREST_RADIUS = 250.0  # m, radius of a parabola where the design gives none
MOST_OF_SEGMENT = 0.9  # share of a segment that its two parabolas may take, where no radius is given
MOST_OF_SLOPE = 0.98  # share of a slope, over all its segments, that parabolas with a given radius may take


class VerticalCurve(NamedTuple):
    """The parabola that joins the grades of two segments. Its middle is where the two segments meet."""

    number: int
    """Index of the second of the two segments, from 0."""
    s: float
    """Station in metres of the middle of the parabola."""
    half: float
    """Half of the length of the parabola in metres."""
    change: float
    """Change of grade as a ratio, positive in a dip."""

    @property
    def radius(self) -> float:
        """The vertical radius of the parabola in metres."""
        return 2 * self.half / abs(self.change)


def vertical_curves(
    distances: Sequence[float], grades: Sequence[float], radii: Sequence[float | None]
) -> list[VerticalCurve]:
    """Returns the vertical curves where grades change, in order. ``distances`` are the lengths of segments in
    metres, and ``grades`` their grades as ratios. ``radii`` are the radii in metres of the curves at the
    starts of the segments; None for a default radius.

    A curve whose radius is given has the length that this radius requires. It is shortened where it would
    overlap its neighbour or extend beyond the road.
    """
    joints: list[tuple[int, float, float]] = []
    wants: list[float] = []
    at = 0.0
    for i in range(1, len(grades)):
        at += distances[i - 1]
        change, radius = grades[i] - grades[i - 1], radii[i]
        shorter = min(distances[i - 1], distances[i])
        usual = min(CREST_RADIUS * abs(change) / 2, MOST_OF_SEGMENT * shorter / 2)
        half = usual if radius is None else radius * abs(change) / 2
        if half > 1e-6:
            joints.append((i, at, change))
            wants.append(half)
    stations = [0.0, *(s for _, s, _ in joints), at + distances[-1]]
    rooms = [MOST_OF_SLOPE * (b - a) for a, b in pairwise(stations)]
    own = [radii[i] is not None for i, _, _ in joints]
    out = []
    for n, (i, s, change) in enumerate(joints):
        half = wants[n]
        if own[n]:
            before, after = n - 1, n + 1
            half = min(half, _share(wants, own, rooms[n], n, before if n else None))
            half = min(half, _share(wants, own, rooms[n + 1], n, after if after < len(joints) else None))
        if half > 1e-6:
            out.append(VerticalCurve(i, s, half, change))
    return out


def _share(wants: Sequence[float], own: Sequence[bool], room: float, n: int, other: int | None) -> float:
    """Returns the length in metres that half of curve ``n`` may take up of the slope at one of its ends."""
    if other is None:
        return room
    if not own[other]:  # a curve without a given radius keeps its length
        return room - wants[other]
    return room * wants[n] / max(wants[n] + wants[other], 1e-9)
