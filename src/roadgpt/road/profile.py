"""Defines the cross-section of a road at each station: its lanes, shoulders, markings and superelevation.

        left                                right             offsets t, positive to the left
    shoulder | against | against | along | along | shoulder
             3.5 m     |         0       |       -3.5 m       t of the boundaries
                       |     centre line
                 carriageway

Lanes on the right of the centre line lead along the road, towards larger stations; lanes on the left lead
against it. If traffic drives on the left, the lanes on the left lead along the road. The default is one lane
in each direction.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import inf
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array

LINE = 0.12  # m, width of a painted line: narrow mark of rural roads (Germany, RMS-1)
DOUBLE = 2 * LINE  # m, between the middles of the two lines of a double line (Germany, RMS-1)
DASH, GAP = 4.0, 8.0  # m, of a broken line: middle line outside of towns (Germany, RMS-1)

Kind = Literal["driving", "shoulder"]
Marking = Literal["solid", "broken", "none", "double"]
"""A double line is two solid lines."""
Width = float | CubicProfile
"""A width in metres: one number, or cubics of the station."""


class Edges(NamedTuple):
    """The offsets of a left and a right edge, in metres, positive to the left of the centre line.

    Both arrays have the shape of the stations for which they were computed.
    """

    left: Array
    right: Array


class PaintedLine(NamedTuple):
    """One longitudinal road marking."""

    marking: Marking
    edges: Edges
    """The offsets of the left and the right edge of the line."""


@dataclass(frozen=True)
class Lane:
    """One lane or one shoulder."""

    kind: Kind
    width: Width
    marking: Marking = "none"
    """The marking at the outer edge of the lane."""


@dataclass(frozen=True)
class Profile:
    """The cross-section of a road. Methods take stations ``s`` in metres, of any shape.

    They return values of the same shape: widths and offsets in metres, offsets positive to the left of the
    centre line. On a road with superelevation, widths and offsets are measured along the inclined surface.

    Args:
        left: Lanes on the left, from the centre line outwards, driving lanes first.
        right: Lanes on the right in the same order.
        driven: Index in ``along`` of the lane that the tested car keeps to; ``along`` has at least one lane.
        centre_marking: The marking on the line between the directions, or on either side of a median.
        superelevation_angle: The angle in radians by which the surface is rotated about the centre line,
            positive where it falls to the right, as in OpenDRIVE; None for a level cross-section.
        offset: Offset in metres from the centre line of the road to the line between the lanes on the left
            and those on the right: the element ``laneOffset`` of OpenDRIVE.
        median: Width in metres of the median between the oncoming lanes and the line between the directions;
            0 for no median.
        left_hand: Whether traffic drives on the left: the lanes on the left then lead along the road, and
            those on the right against it.

    Raises:
        ValueError: ``driven`` is not the index of a driving lane, a shoulder is followed by a driving lane, a
            width is negative, or a width, the superelevation or the offset does not end with a constant.
    """

    left: tuple[Lane, ...]
    right: tuple[Lane, ...]
    driven: int = 0
    centre_marking: Marking = "broken"
    superelevation_angle: CubicProfile | None = None
    offset: Width = 0.0
    median: float = 0.0
    left_hand: bool = False

    def __post_init__(self) -> None:
        if not 0 <= self.driven < self.count[0]:
            own = "left" if self.left_hand else "right"
            raise ValueError(f"the driven lane must be one of the driving lanes on the {own}")
        lanes = (*self.left, *self.right)
        if sum(lane.kind == "driving" for lane in lanes) > sum(self.count):
            raise ValueError("a driving lane cannot be outside a shoulder")
        of_station = [*(lane.width for lane in lanes), self.superelevation_angle, self.offset]
        if any(any(each.coefficients[-1][1:]) for each in of_station if isinstance(each, CubicProfile)):
            raise ValueError("the last width of a lane, and the last superelevation, must be constant")
        if any(as_cubics(lane.width).beyond(0.0, inf) for lane in lanes):
            raise ValueError("a lane has a negative width")

    @classmethod
    @lru_cache(maxsize=256, typed=True)
    def of(
        cls,
        forward: int = 1,
        backward: int = 1,
        lane_width: Width = 4.0,
        shoulder: float = 3.0,
        superelevation_angle: CubicProfile | None = None,
    ) -> "Profile":
        """Returns a cross-section of equally wide lanes. The tested car drives in the rightmost lane.

        Args:
            forward: Number of lanes in the direction of the road, one or more.
            backward: Number of oncoming lanes. With 0 the road is one-way.
            lane_width: Width of every lane in metres.
            shoulder: Width of the shoulder on each side in metres; 0 for none.
            superelevation_angle: The angle in radians by which the surface is rotated about the centre line,
                positive where it falls to the right; None for a level cross-section.
        """

        def side(count: int) -> tuple[Lane, ...]:
            inner = [Lane("driving", lane_width, "broken")] * (count - 1)
            outer = [Lane("driving", lane_width, "solid")] * min(count, 1)
            return (*inner, *outer, *([Lane("shoulder", shoulder)] if shoulder else []))

        centre: Marking = "broken" if (forward, backward) == (1, 1) else "solid"
        return cls(side(backward), side(forward), forward - 1, centre, superelevation_angle)

    @cached_property
    def mirrored(self) -> "Profile":
        """The cross-section with left and right exchanged, and with traffic on the other side of the road."""
        angle = self.superelevation_angle
        return replace(
            self,
            left=self.right,
            right=self.left,
            superelevation_angle=None if angle is None else angle.negative,
            offset=self.offset.negative if isinstance(self.offset, CubicProfile) else 0.0 - self.offset,
            left_hand=not self.left_hand,
        )

    @property
    def side(self) -> Literal[1, -1]:
        """The sign in OpenDRIVE of the ids of the lanes along the road: 1 on its left, -1 on its right."""
        return 1 if self.left_hand else -1

    @property
    def along(self) -> tuple[Lane, ...]:
        """The lanes in the direction of the road and their shoulder, from the centre line outwards."""
        return self.left if self.left_hand else self.right

    @property
    def against(self) -> tuple[Lane, ...]:
        """The oncoming lanes and their shoulder, from the centre line outwards."""
        return self.right if self.left_hand else self.left

    @cached_property
    def count(self) -> tuple[int, int]:
        """The number of driving lanes in the direction of the road, and the number of oncoming lanes."""
        return len(_driving(self.along)), len(_driving(self.against))

    @property
    def along_ids(self) -> range:
        """The ids in OpenDRIVE of the driving lanes along the road, from the centre line outwards."""
        return range(self.side, self.side * (1 + self.count[0]), self.side)

    @property
    def against_ids(self) -> range:
        """The ids in OpenDRIVE of the oncoming driving lanes, from the centre line outwards.

        If there is a median, its id is ``-side``, and these ids begin after it.
        """
        first = 2 if self.median else 1
        return range(-self.side * first, -self.side * (first + self.count[1]), -self.side)

    def leads_along(self, lane: int) -> bool:
        """Returns whether the lane with this OpenDRIVE id leads along the road, and not against it."""
        return lane * self.side > 0

    @property
    def boundaries_to_left(self) -> int:
        """The number of boundaries left of the driven lane: the index of its left edge in ``boundaries``."""
        along, against = self.count
        return along - 1 - self.driven if self.left_hand else against + (self.median > 0) + self.driven

    @property
    def shoulder_width(self) -> float:
        """The width in metres of the shoulder beside the lanes along the road, at its start; 0 if there is
        none.
        """
        return float(self.shoulder(0.0))

    @property
    def has_shoulders(self) -> bool:
        """Whether there is a shoulder on at least one side."""
        return any(lane.kind == "shoulder" for lane in (*self.left, *self.right))

    @cached_property
    def paved_reach(self) -> float:
        """The largest distance in metres between the centre line and an edge of the carriageway.

        If the widths of several lanes vary, the value is an upper bound.
        """
        return self._with_offset(_driving(self.left), _driving(self.right))

    @cached_property
    def reach(self) -> float:
        """The largest distance in metres between the centre line and the edge of a lane or shoulder.

        If the widths of several lanes or shoulders vary, the value is an upper bound.
        """
        return self._with_offset(self.left, self.right)

    @property
    def offset_range(self) -> tuple[float, float]:
        """The smallest and the largest offset of the line between the lanes on the left and on the right."""
        return _extremes(self.offset)

    def _with_offset(self, left: Sequence[Lane], right: Sequence[Lane]) -> float:
        (low, high), begin = self.offset_range, self.begins
        return max(_reach(left) + begin[0] + high, _reach(right) + begin[1] - low)

    @property
    def begins(self) -> tuple[float, float]:
        """The distances in metres from the line between the directions to the first lane on the left and to
        the first on the right. The median lies on the side of the oncoming lanes.
        """
        return (0.0, self.median) if self.left_hand else (self.median, 0.0)

    def centre(self, s: ArrayLike) -> Array:
        """Returns the offset of the line between the lanes on the left and those on the right."""
        return _at(self.offset, s)

    def width(self, s: ArrayLike) -> Array:
        """Returns the width of the driven lane."""
        return _at(self.along[self.driven].width, s)

    def shoulder(self, s: ArrayLike) -> Array:
        """Returns the width of the shoulder beside the lanes along the road; 0 if there is none."""
        return _sum(self.along[len(_driving(self.along)) :], s)

    def middle(self, s: ArrayLike) -> Array:
        """Returns the offset of the middle of the driven lane."""
        return self.centre(s) + self.side * (_sum(self.along[: self.driven], s) + self.width(s) / 2)

    def lane(self, s: ArrayLike) -> Edges:
        """Returns the offsets of the edges of the driven lane."""
        inside, centre = _sum(self.along[: self.driven], s), self.centre(s)
        inner, outer = centre + self.side * inside, centre + self.side * (inside + self.width(s))
        return Edges(outer, inner) if self.left_hand else Edges(inner, outer)

    def edges(self, s: ArrayLike) -> Edges:
        """Returns the offsets of the edges of the carriageway."""
        left, right = self.sides(s)
        return Edges(left + _sum(_driving(self.left), s), right - _sum(_driving(self.right), s))

    def sides(self, s: ArrayLike) -> Edges:
        """Returns the offsets at which the lanes on the left and those on the right begin: the edges of the
        median. Without a median, both are the offset of the line between the directions.
        """
        centre, begin = self.centre(s), self.begins
        return Edges(centre + begin[0], centre - begin[1])

    def rims(self, s: ArrayLike) -> Edges:
        """Returns the offsets of the outer edges of the shoulders; without a shoulder, of the lanes."""
        left, right = self.sides(s)
        return Edges(left + _sum(self.left, s), right - _sum(self.right, s))

    def lane_edges(self, s: ArrayLike) -> tuple[list[Array], list[Array]]:
        """Returns the offsets of the outer edges of all lanes and shoulders, left and right of the centre.

        The result is a list for the left side and a list for the right side. Each list has one array per
        lane, from the centre line outwards.
        """
        begin = self.sides(s)
        left = [begin.left + _sum(self.left[: n + 1], s) for n in range(len(self.left))]
        return left, [begin.right - _sum(self.right[: n + 1], s) for n in range(len(self.right))]

    def boundaries(self, s: ArrayLike) -> list[tuple[Marking, Array]]:
        """Returns the boundaries of all driving lanes from left to right, each with its marking and offsets.

        The first and the last one are the edges of the carriageway; a median has a boundary on either side.
        """
        left, right = self.lane_edges(s)
        lanes = [*zip(self.left, left, strict=True)][: len(_driving(self.left))][::-1]
        lanes_right = [*zip(self.right, right, strict=True)][: len(_driving(self.right))]
        begin = self.sides(s)
        return [
            *((lane.marking, t) for lane, t in lanes),
            *([(self.centre_marking, begin.left)] if self.median else []),
            (self.centre_marking, begin.right),
            *((lane.marking, t) for lane, t in lanes_right),
        ]

    def markings(self, s: ArrayLike) -> list[PaintedLine]:
        """Returns the painted lines from left to right; boundaries without a marking are left out.

        A line between two lanes is painted over their boundary. A line at an edge of the carriageway is
        painted on the lane's side of this edge.
        """
        found = []
        for marking, edges in self._painted_boundaries(s):
            if marking == "double":
                found.append(PaintedLine("solid", Edges(edges.left, edges.left - LINE)))
                found.append(PaintedLine("solid", Edges(edges.right + LINE, edges.right)))
            elif marking != "none":
                found.append(PaintedLine(marking, edges))
        return found

    def _painted_boundaries(self, s: ArrayLike) -> list[tuple[Marking, Edges]]:
        """Returns the marking of each boundary and the marking's edges; both lie on the boundary if it has no
        marking.
        """
        rows = self.boundaries(s)
        sides = [1, *[0] * (len(rows) - 2), -1]
        return [
            (marking, Edges(t, t) if marking == "none" else _painted(t, side, marking == "double"))
            for (marking, t), side in zip(rows, sides, strict=True)
        ]

    def marking_limits(self, s: ArrayLike) -> Edges:
        """Returns the offsets of the outer edges of the two lane markings that bound the driven lane.

        If a boundary of the lane has no marking, the offset of the boundary is returned.
        """
        at = self.boundaries_to_left
        (_, left), (_, right) = self._painted_boundaries(s)[at : at + 2]
        return Edges(left.left, right.right)

    def superelevation(self, s: ArrayLike) -> Array:
        """Returns the superelevation in radians, positive where the surface falls to the right."""
        if self.superelevation_angle is None:
            return np.zeros(np.shape(s))
        return _at(self.superelevation_angle, s)


def as_cubics(width: Width) -> CubicProfile:
    """Returns a width as cubics from station 0 on; before its first cubic begins, the width is constant."""
    if not isinstance(width, CubicProfile):
        return CubicProfile.constant(width)
    if width.stations[0] <= 0:
        return width
    return CubicProfile.of_rows([(0.0, (width.coefficients[0][0], 0.0, 0.0, 0.0)), *width.rows])


def _driving(lanes: Sequence[Lane]) -> Sequence[Lane]:
    """Returns the driving lanes from the centre line up to the first shoulder."""
    count = next((n for n, lane in enumerate(lanes) if lane.kind != "driving"), len(lanes))
    return lanes[:count]


def _at(width: Width, s: ArrayLike) -> Array:
    if isinstance(width, CubicProfile):
        return width.height(np.maximum(s, width.stations[0]))
    return np.full(np.shape(s), width)


def _sum(lanes: Sequence[Lane], s: ArrayLike) -> Array:
    out = np.zeros(np.shape(s))
    for lane in lanes:
        out = out + _at(lane.width, s)
    return out


def _painted(t: Array, side: int, is_double: bool) -> Edges:
    """Returns the edges of a line painted over the offset ``t`` or, at an edge of the carriageway, inside it.

    ``side`` is 1 at the left edge, -1 at the right edge, and 0 between two lanes.
    """
    if not side:
        half = (LINE + DOUBLE) / 2 if is_double else LINE / 2
        return Edges(t + half, t - half)
    return Edges(t, t - LINE) if side > 0 else Edges(t + LINE, t)


def _extremes(width: Width) -> tuple[float, float]:
    """Returns the smallest and the largest width in metres."""
    if not isinstance(width, CubicProfile):
        return width, width
    return width.extremes()


def _reach(lanes: Sequence[Lane]) -> float:
    """Returns the largest distance to the last lane's outer edge; an upper bound if several widths vary."""
    return sum(_extremes(lane.width)[1] for lane in lanes)
