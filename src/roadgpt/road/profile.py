"""Defines the cross-section of a road at each station: its lanes, shoulders, markings and superelevation.

        left                                right             offsets t, positive to the left
    shoulder | against | against | along | along | shoulder
             3.5 m     |         0       |       -3.5 m       t of the boundaries
                       |     centre line
                 carriageway

Lanes on the right of the centre line lead along the road, towards larger stations; lanes on the left lead
against it. If traffic drives on the left, the lanes on the left lead along the road. The default is one lane
in each direction.

The superelevation of bends follows from their radii and the speed limit.

Source: National Highways, CD 109 Highway link design (earlier TD 9/93), section 3: at a design speed of V
km/h, a bend of radius R metres has a superelevation of V^2 / (2.828 R) percent, and at most 7 % outside
towns. The superelevation is built up over a run-in, which is usually the transition curve. If this curve
is so short that the edge of the carriageway would climb or fall by more than 1 % relative to the centre
line, the run-in begins earlier and ends later. It never extends beyond the middle of the adjoining
straight or arc."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from math import inf
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, PieceCurve
from roadgpt.geometry.curve import Array, PlanCurve

LINE = 0.12  # m, width of a painted line: narrow mark of rural roads (Germany, RMS-1)
DOUBLE = 2 * LINE  # m, between the middles of the two lines of a double line (Germany, RMS-1)
DASH, GAP = 4.0, 8.0  # m, of a broken line: middle line outside of towns (Germany, RMS-1)

Kind = Literal[
    "driving", "shoulder", "border", "parking", "biking", "sidewalk", "median", "curb", "restricted", "rail",
    "none",
]  # fmt: skip
"""What a lane is for: the names of OpenDRIVE, of which "driving" stands for all lanes that cars may use."""
Marking = Literal["solid", "broken", "none", "double"]
"""A double line is two solid lines."""
Width = float | CubicProfile
"""A width in metres: one number, or cubics of the station."""
KNOWN = {"left", "right", "driven", "centre_marking", "superelevation", "offset", "left_hand"}
MEDIAN = "median"
"""A field of older files: the width in metres of a median on the side of the oncoming lanes."""
OF_LANES = ("speed_limit", "friction")
FASTEST = 200.0  # m/s, of a speed limit
ONLY_NETWORKS = "traffic drives on the left on the roads of networks only"
MOST_LANES = 20  # on one side
MOST_ROWS = 20_000
WIDEST = 100.0  # m, of a lane or shoulder
LARGEST = 1e12  # greatest absolute value of a station or a coefficient
STEEPEST = 0.35  # rad, of superelevation


class Edges(NamedTuple):
    """The offsets of a left and a right edge, in metres, positive to the left of the centre line. Both arrays
    have the shape of the stations for which they were computed."""

    left: Array
    right: Array


@dataclass(frozen=True)
class LaneStrip:
    """One lane, or a strip beside the lanes."""

    kind: Kind
    width: Width
    marking: Marking = "none"  # the marking at the outer edge of the lane
    speed_limit: float | None = None  # m/s; None for that of the World
    friction: float | None = None  # None for that of the World


@dataclass(frozen=True)
class Profile:
    """The cross-section of a road. Methods take stations ``s`` in metres, of any shape.

    They return values of the same shape: widths and offsets in metres, offsets positive to the left of the
    centre line. On a road with superelevation, widths and offsets are measured along the inclined surface.

    Args:
        left: Lanes on the left, from the centre line outwards. A median between the directions is the first
            one on the side of the oncoming lanes.
        right: Lanes on the right in the same order.
        driven: Index in ``along`` of the lane that the tested car keeps to; 0 if no lane leads along the
            road, as may be in a network.
        centre_marking: The marking on the line between the directions.
        superelevation_angle: The angle in radians by which the surface is rotated about the centre line,
            positive where it falls to the right, as in OpenDRIVE; None for a level cross-section.
        offset: Offset in metres from the centre line of the road to the line between the lanes on the left
            and those on the right: the element ``laneOffset`` of OpenDRIVE.
        left_hand: Whether traffic drives on the left: the lanes on the left then lead along the road, and
            those on the right against it.
        aside: Where the tested car is to keep, in metres to the left of its lane, after it was made to change
            lanes or to pass somebody (``moved``); its lane moves with it.

    Raises:
        ValueError: ``driven`` is not the index of a driving lane, a width is negative, or a width, the
            superelevation or the offset does not end with a constant."""

    left: tuple[LaneStrip, ...]
    right: tuple[LaneStrip, ...]
    driven: int = 0
    centre_marking: Marking = "broken"
    superelevation_angle: CubicProfile | None = None
    offset: Width = 0.0
    left_hand: bool = False
    aside: Width = 0.0

    def __post_init__(self) -> None:
        if self.side * (1 + self.driven) not in (self.along_ids or (self.side,)):
            own = "left" if self.left_hand else "right"
            raise ValueError(f"the driven lane must be one of the driving lanes on the {own}")
        lanes = (*self.left, *self.right)
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
        """Returns a cross-section of equally wide lanes; the tested car drives in the rightmost one. The
        numbers of lanes are those along the road, one or more, and against it. The width of every lane, and
        of the shoulder on each side, is in metres. For ``superelevation_angle`` see ``Profile``."""

        def side(count: int) -> tuple[LaneStrip, ...]:
            inner = [LaneStrip("driving", lane_width, "broken")] * (count - 1)
            outer = [LaneStrip("driving", lane_width, "solid")] * min(count, 1)
            return (*inner, *outer, *([LaneStrip("shoulder", shoulder)] if shoulder else []))

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
    def along(self) -> tuple[LaneStrip, ...]:
        """The lanes in the direction of the road and their shoulder, from the centre line outwards."""
        return self.left if self.left_hand else self.right

    @property
    def against(self) -> tuple[LaneStrip, ...]:
        """The oncoming lanes and their shoulder, from the centre line outwards."""
        return self.right if self.left_hand else self.left

    @cached_property
    def lanes(self) -> dict[int, LaneStrip]:
        """All lanes from left to right, by their ids in OpenDRIVE: positive on the left, negative on the
        right, and 1 or -1 beside the centre line."""
        left = list(enumerate(self.left, 1))[::-1]
        return dict(left) | {-number: lane for number, lane in enumerate(self.right, 1)}

    @property
    def count(self) -> tuple[int, int]:
        """The number of driving lanes in the direction of the road, and the number of oncoming lanes."""
        return len(self.along_ids), len(self.against_ids)

    @cached_property
    def along_ids(self) -> tuple[int, ...]:
        """The ids in OpenDRIVE of the driving lanes along the road, from the centre line outwards."""
        return _driving(self.along, self.side)

    @cached_property
    def against_ids(self) -> tuple[int, ...]:
        """The ids in OpenDRIVE of the oncoming driving lanes, from the centre line outwards."""
        return _driving(self.against, -self.side)

    @cached_property
    def carriageway(self) -> tuple[int, int]:
        """The numbers of lanes on the left and on the right, counted from the centre line, that lie between
        the outermost driving lanes. If all of these lie on one side, the number of the other side is minus
        the number of lanes between the centre line and the innermost of them; both are 0 without any."""
        left, right = (_driving(lanes, 1) for lanes in (self.left, self.right))
        return (
            left[-1] if left else 1 - right[0] if right else 0,
            right[-1] if right else 1 - left[0] if left else 0,
        )

    @property
    def is_divided(self) -> bool:
        """Whether a median separates the directions."""
        return bool(self.along_ids and self.against_ids) and "median" in (
            lane.kind for lane in (*self.left[: self.carriageway[0]], *self.right[: self.carriageway[1]])
        )

    def leads_along(self, lane: int) -> bool:
        """Returns whether the lane with this OpenDRIVE id leads along the road, and not against it."""
        return lane * self.side > 0

    @property
    def driven_id(self) -> int:
        """The id in OpenDRIVE of the driven lane. Where no lane leads along the road, as may be in a network,
        it is the outermost of the oncoming ones."""
        return self.side * (1 + self.driven) if self.along_ids else self.against_ids[-1]

    @property
    def boundaries_to_left(self) -> int:
        """The number of boundaries left of the driven lane: the index of its left edge in ``boundaries``."""
        left, number = self.carriageway[0], self.driven_id
        return left - number if number > 0 else left - 1 - number

    @property
    def shoulder_width(self) -> float:
        """The width in metres of the shoulder beside the lanes along the road, at its start; 0 for none."""
        return float(self.shoulder(0.0))

    @property
    def has_shoulders(self) -> bool:
        """Whether there is a shoulder, or another strip beside the carriageway, on at least one side."""
        left, right = self.carriageway
        return len(self.left) > max(left, 0) or len(self.right) > max(right, 0)

    @cached_property
    def paved_reach(self) -> float:
        """The largest distance in metres between the centre line and an edge of the carriageway. If the
        widths of several lanes vary, the value is an upper bound."""
        left, right = self.carriageway
        return self._with_offset(self.left[: max(left, 0)], self.right[: max(right, 0)])

    @cached_property
    def reach(self) -> float:
        """The largest distance in metres between the centre line and the edge of a lane or shoulder. If the
        widths of several lanes or shoulders vary, the value is an upper bound."""
        return self._with_offset(self.left, self.right)

    @property
    def offset_range(self) -> tuple[float, float]:
        """The smallest and the largest offset of the line between the lanes on the left and on the right."""
        return _extremes(self.offset)

    def _with_offset(self, left: Sequence[LaneStrip], right: Sequence[LaneStrip]) -> float:
        low, high = self.offset_range
        return max(_reach(left) + high, _reach(right) - low)

    def centre(self, s: ArrayLike) -> Array:
        """Returns the offset of the line between the lanes on the left and those on the right."""
        return _at(self.offset, s)

    def width(self, s: ArrayLike) -> Array:
        """Returns the width of the driven lane."""
        return _at(self.lanes[self.driven_id].width, s)

    def shoulder(self, s: ArrayLike) -> Array:
        """Returns the width of the shoulder beside the lanes along the road; 0 if there is none."""
        return _sum(self.along[max(self.carriageway[0 if self.left_hand else 1], 0) :], s)

    def middle(self, s: ArrayLike) -> Array:
        """Returns the offset of the middle of the driven lane."""
        number = self.driven_id
        inside = self.left[: number - 1] if number > 0 else self.right[: -1 - number]
        inner = (1 if number > 0 else -1) * (_sum(inside, s) + self.width(s) / 2)
        return self.centre(s) + inner + _at(self.aside, s)

    def lane(self, s: ArrayLike) -> Edges:
        """Returns the offsets of the edges of the driven lane."""
        return self._beside(self.edges_of(self.driven_id, s), s)

    def _beside(self, edges: Edges, s: ArrayLike) -> Edges:
        return Edges(*(each + _at(self.aside, s) for each in edges))

    def aside_at(self, s: float) -> float:
        """Returns where the tested car is to keep at a station, in metres to the left of its lane."""
        return float(_at(self.aside, s))

    def moved(self, start: float, end: float, by: float) -> "Profile":
        """Returns the same with the driven lane moved sideways between two stations, by metres to the left,
        and so far from there on. The slope is 0 at both ends."""
        base, long = self.aside_at(start), end - start
        rows = [row for row in as_cubics(self.aside).rows if row[0] < start]
        rows.append((start, (base, 0.0, 3 * by / long**2, -2 * by / long**3)))
        return replace(self, aside=CubicProfile.of_rows([*rows, (end, (base + by, 0.0, 0.0, 0.0))]))

    def edges(self, s: ArrayLike) -> Edges:
        """Returns the offsets of the edges of the carriageway, from the outermost driving lane on the left to
        that on the right. Without driving lanes, both are those of the line between the directions."""
        left, right = self.carriageway
        return Edges(self._boundary(left, s), self._boundary(-right, s))

    def _boundary(self, number: int, s: ArrayLike) -> Array:
        """Returns the offset of a boundary: 0 is the line between the directions, a positive number the outer
        edge of the lane with this id on the left, and a negative one that of the lane on the right."""
        centre = self.centre(s)
        return centre + _sum(self.left[:number], s) if number > 0 else centre - _sum(self.right[:-number], s)

    def edges_of(self, lane: int, s: ArrayLike) -> Edges:
        """Returns the offsets of the edges of the lane with this id."""
        inner, outer = self._boundary(lane - 1 if lane > 0 else lane + 1, s), self._boundary(lane, s)
        return Edges(outer, inner) if lane > 0 else Edges(inner, outer)

    def rims(self, s: ArrayLike) -> Edges:
        """Returns the offsets of the outer edges of the shoulders; without a shoulder, of the lanes."""
        return Edges(self._boundary(len(self.left), s), self._boundary(-len(self.right), s))

    def lane_edges(self, s: ArrayLike) -> tuple[list[Array], list[Array]]:
        """Returns the offsets of the outer edges of all lanes and shoulders: a list for the left side and one
        for the right, each with one array per lane, from the centre line outwards."""
        left = [self._boundary(n, s) for n in range(1, 1 + len(self.left))]
        return left, [self._boundary(-n, s) for n in range(1, 1 + len(self.right))]

    def boundaries(self, s: ArrayLike) -> list[tuple[Marking, Array]]:
        """Returns the boundaries of the lanes of the carriageway from left to right, each with its marking
        and offsets. The first and the last one are the edges of the carriageway."""
        left, right = self.carriageway
        return [(self._marking(n), self._boundary(n, s)) for n in range(left, -right - 1, -1)]

    def _marking(self, number: int) -> Marking:
        side = self.left if number > 0 else self.right
        return side[abs(number) - 1].marking if number else self.centre_marking

    def markings(self, s: ArrayLike) -> list[tuple[Marking, Edges]]:
        """Returns the painted lines from left to right, each with the offsets of its own left and right edge;
        boundaries without a marking are left out. A line
        between two lanes is painted over their boundary. A line at an edge of the carriageway is painted on
        the lane's side of this edge."""
        found: list[tuple[Marking, Edges]] = []
        for marking, edges in self._painted_boundaries(s):
            if marking == "double":
                found.append(("solid", Edges(edges.left, edges.left - LINE)))
                found.append(("solid", Edges(edges.right + LINE, edges.right)))
            elif marking != "none":
                found.append((marking, edges))
        return found

    def _painted_boundaries(self, s: ArrayLike) -> list[tuple[Marking, Edges]]:
        rows = self.boundaries(s)
        sides = [1, *[0] * (len(rows) - 2), -1]
        return [
            (marking, Edges(t, t) if marking == "none" else _painted(t, side, marking == "double"))
            for (marking, t), side in zip(rows, sides, strict=True)
        ]

    def marking_limits(self, s: ArrayLike) -> Edges:
        """Returns the offsets of the outer edges of the two lane markings that bound the driven lane. If a
        boundary of the lane has no marking, the offset of the boundary is returned."""
        at = self.boundaries_to_left
        (_, left), (_, right) = self._painted_boundaries(s)[at : at + 2]
        return self._beside(Edges(left.left, right.right), s)

    def superelevation(self, s: ArrayLike) -> Array:
        """Returns the superelevation in radians, positive where the surface falls to the right."""
        if self.superelevation_angle is None:
            return np.zeros(np.shape(s))
        return _at(self.superelevation_angle, s)


def width_at(width: Width, s: float) -> float:
    """Returns the value in metres, at station ``s``, of a width that is constant or varies along a road."""
    return float(width.cubic(max(s, width.stations[0]))[0]) if isinstance(width, CubicProfile) else width


def as_cubics(width: Width) -> CubicProfile:
    """Returns a width as cubics from station 0 on; before its first cubic begins, the width is constant."""
    if not isinstance(width, CubicProfile):
        return CubicProfile.constant(width)
    if width.stations[0] <= 0:
        return width
    return CubicProfile.of_rows([(0.0, (width.coefficients[0][0], 0.0, 0.0, 0.0)), *width.rows])


def _driving(lanes: Sequence[LaneStrip], side: int) -> tuple[int, ...]:
    return tuple(side * number for number, lane in enumerate(lanes, 1) if lane.kind == "driving")


def _at(width: Width, s: ArrayLike) -> Array:
    if isinstance(width, CubicProfile):
        return width.height(np.maximum(s, width.stations[0]))
    return np.full(np.shape(s), width)


def _sum(lanes: Sequence[LaneStrip], s: ArrayLike) -> Array:
    out = np.zeros(np.shape(s))
    for lane in lanes:
        out = out + _at(lane.width, s)
    return out


def _painted(t: Array, side: int, is_double: bool) -> Edges:
    """Returns the edges of a line painted over the offset ``t`` or, at an edge of the carriageway, inside it.
    ``side`` is 1 at the left edge, -1 at the right edge, and 0 between two lanes."""
    if not side:
        half = (LINE + DOUBLE) / 2 if is_double else LINE / 2
        return Edges(t + half, t - half)
    return Edges(t, t - LINE) if side > 0 else Edges(t + LINE, t)


def _extremes(width: Width) -> tuple[float, float]:
    if not isinstance(width, CubicProfile):
        return width, width
    return width.extremes()


def _reach(lanes: Sequence[LaneStrip]) -> float:
    return sum(_extremes(lane.width)[1] for lane in lanes)


def profile_to_json(profile: Profile) -> dict[str, Any]:
    """Returns the cross-section as the field ``profile`` of a road file. A width is a number, or rows ``[s,
    a, b, c, d]``: at a distance ``u`` in metres after station ``s``, it is ``a + b u + c u^2 + d u^3``
    metres. The superelevation is always written as rows, in radians."""
    out = {
        "left": [_lane_to_json(lane) for lane in profile.left],
        "right": [_lane_to_json(lane) for lane in profile.right],
        "driven": profile.driven,
        "centre_marking": profile.centre_marking,
    }
    if profile.offset != 0:
        out["offset"] = _written(profile.offset)
    if profile.left_hand:
        out["left_hand"] = True
    angle = profile.superelevation_angle
    return out if angle is None else {**out, "superelevation": _rows(angle)}


def profile_from_json(data: Any) -> Profile:
    """Restores a cross-section; raises UsageError if a field is missing, unknown, wrong or out of range."""
    try:
        _only(data, KNOWN | {MEDIAN})
        angle = data.get("superelevation")
        driven = data["driven"]
        if not isinstance(driven, int) or isinstance(driven, bool):
            raise ValueError("driven is the index of a lane along the road")
        if not isinstance(left_hand := data.get("left_hand", False), bool):
            raise ValueError("left_hand is true or false")
        left, right, centre = (
            _lanes(data["left"]),
            _lanes(data["right"]),
            _one_of(data["centre_marking"], Marking),
        )
        if MEDIAN in data:
            median = LaneStrip("median", _width(data[MEDIAN]), centre)
            left, right = (left, (median, *right)) if left_hand else ((median, *left), right)
        return Profile(
            left,
            right,
            driven,
            centre,
            None if angle is None else _cubics(angle, STEEPEST),
            _width(data.get("offset", 0.0), -WIDEST),
            left_hand,
        )
    except KeyError as error:
        raise UsageError(f"the profile of the road cannot be read: {error} is missing; add it") from error
    except (TypeError, ValueError, OverflowError) as error:
        raise UsageError(f"the profile of the road cannot be read: {error}; correct the file") from error


def _lane_to_json(lane: LaneStrip) -> dict[str, Any]:
    told = {name: value for name in OF_LANES if (value := getattr(lane, name)) is not None}
    return {"kind": lane.kind, "width": _written(lane.width), "marking": lane.marking, **told}


def _written(width: Width) -> float | list[list[float]]:
    return _rows(width) if isinstance(width, CubicProfile) else width


def _rows(cubics: CubicProfile) -> list[list[float]]:
    return [[s, *row] for s, row in cubics.rows]


def _lanes(rows: Any) -> tuple[LaneStrip, ...]:
    if not isinstance(rows, list) or len(rows) > MOST_LANES:
        raise ValueError(f"lanes are a list of up to {MOST_LANES} objects with kind, width and marking")
    for row in rows:
        _only(row, {"kind", "width", "marking", *OF_LANES})
    return tuple(
        LaneStrip(
            _one_of(row["kind"], Kind),
            _width(row["width"]),
            _one_of(row["marking"], Marking),
            *(None if (value := row.get(name)) is None else _number(value) for name in OF_LANES),
        )
        for row in rows
    )


def _number(data: Any) -> float:
    if isinstance(data, bool) or not isinstance(data, (int, float)) or not 0 < data <= FASTEST:
        raise ValueError(f"a speed limit, and a friction, is a number above 0, up to {FASTEST:g}")
    return float(data)


def _width(data: Any, least: float = 0.0) -> Width:
    if isinstance(data, list):
        return _cubics(data, WIDEST)
    if isinstance(data, bool) or not isinstance(data, (int, float)) or not least <= data <= WIDEST:
        raise ValueError(f"a width is a number from {least:g} to {WIDEST:g}, or rows [s, a, b, c, d]")
    return float(data)


def _cubics(rows: Any, most: float) -> CubicProfile:
    if not isinstance(rows, list) or not 0 < len(rows) <= MOST_ROWS:
        raise ValueError(f"1 to {MOST_ROWS:,} rows [s, a, b, c, d] are needed")
    if any(
        not isinstance(row, list) or len(row) != 5 or any(isinstance(v, bool) for v in row) for row in rows
    ):
        raise ValueError("a row has five numbers [s, a, b, c, d]")
    numbers = [tuple(float(v) for v in row) for row in rows]
    if not all(abs(v) <= LARGEST for row in numbers for v in row):
        raise ValueError(f"a number is not finite, or beyond {LARGEST:g}")
    cubics = CubicProfile(tuple(row[0] for row in numbers), tuple((a, b, c, d) for _, a, b, c, d in numbers))
    if found := cubics.beyond(-most, most):
        raise ValueError(f"a value is {found[1]:g} at s = {found[0]:g} m, beyond {most:g}")
    return cubics


def _only(data: Any, known: set[str]) -> None:
    if not isinstance(data, Mapping):
        raise ValueError("a profile and each of its lanes is a JSON object")
    unknown = sorted(set(map(str, data)) - known)
    if unknown:
        raise ValueError(
            f"the field '{unknown[0][:40]}' is unknown; the fields are {', '.join(sorted(known))}"
        )


def _one_of(value: Any, choices: Any) -> Any:
    names: Sequence[str] = get_args(choices)
    if value not in names:
        raise ValueError(f"'{str(value)[:40]}' is unknown; give {' or '.join(names)}")
    return value


SHARE = 2.828  # CD 109; the superelevation then balances 45 % of the lateral acceleration: 127 / 2.828 = 45
MOST = 0.07  # ratio, CD 109
EDGE = 0.01  # ratio, CD 109: grade of an edge of the carriageway against the centre line
STRAIGHT = 1 / 2000  # 1/m; flatter curves count as straight where one superelevation is set for all bends
EQUAL = 1e-9  # rad
SHORTEST = 1e-6  # m; shorter pieces of the plan are skipped
STEP = 4.0  # m between the stations at which the superelevation of a spline is computed
RUN_IN = 24.0  # m over which the superelevation of a spline is averaged

Knots = list[tuple[float, float]]
"""Stations in metres, each with an angle in radians; between two stations the angle changes smoothly."""


def superelevation(plan: PlanCurve, reach: float, speed: float, ratio: float | None = None) -> CubicProfile:
    """Returns the superelevation in radians as a function of the station: negative in left bends, because the
    surface falls to the inside.

    ``reach`` is the distance in metres from the centre line to the farther edge of the carriageway. ``speed``
    is the design speed in m/s. ``ratio`` is the superelevation of every bend as a ratio; with None, each bend
    has the value that CD 109 gives for its radius."""
    if isinstance(plan, PieceCurve):
        knots = _of_pieces(plan, reach, speed, ratio)
    else:
        s = np.linspace(0.0, plan.length, max(2, round(plan.length / STEP) + 1))
        knots = list(zip(s.tolist(), _smoothed(plan, s, speed, ratio).tolist(), strict=True))
    return CubicProfile.smooth(knots)


def _of_pieces(plan: PieceCurve, reach: float, speed: float, ratio: float | None) -> Knots:
    pieces = [piece for piece in plan.pieces if piece.length > SHORTEST]
    s = np.r_[0.0, np.cumsum([piece.length for piece in pieces])].tolist()
    starts = superelevation_for(np.array([piece.k0 for piece in pieces]), speed, ratio).tolist()
    ends = superelevation_for(np.array([piece.k1 for piece in pieces]), speed, ratio).tolist()
    level = [abs(b - a) < EQUAL for a, b in zip(starts, ends, strict=True)]
    spare = [(s[i + 1] - s[i]) / 2 if level[i] else 0.0 for i in range(len(pieces))]
    knots: Knots = [(0.0, starts[0])]
    for i in range(len(pieces)):
        if i and abs(starts[i] - ends[i - 1]) >= EQUAL:  # no transition curve between two pieces
            knots += _run_in((s[i], ends[i - 1]), (s[i], starts[i]), reach, (spare[i - 1], spare[i]))
        if not level[i]:
            beside = (spare[i - 1] if i else 0.0, spare[i + 1] if i + 1 < len(pieces) else 0.0)
            knots += _run_in((s[i], starts[i]), (s[i + 1], ends[i]), reach, beside)
    knots.append((s[-1], ends[-1]))
    return [knots[0], *(b for a, b in pairwise(knots) if b[0] - a[0] > SHORTEST)]


def _run_in(
    first: tuple[float, float], last: tuple[float, float], reach: float, spare: tuple[float, float]
) -> Knots:
    (s0, start), (s1, end) = first, last
    lacking = max(abs(end - start) * reach / EDGE - (s1 - s0), 0.0) / 2
    return [(s0 - min(lacking, spare[0]), start), (s1 + min(lacking, spare[1]), end)]


def superelevation_for(curvature: Array, speed: float, ratio: float | None = None) -> Array:
    """Returns the superelevation in radians for curvatures in 1/m (positive to the left), without a run-in;
    for ``speed`` and ``ratio`` see ``superelevation``."""
    bend = np.abs(curvature)
    if ratio is None:
        sizes = np.minimum((speed * 3.6) ** 2 * bend / (100 * SHARE), MOST)
    else:
        sizes = np.where(bend > STRAIGHT, ratio, 0.0)
    return -np.copysign(np.arctan(sizes), curvature) + 0.0


def _smoothed(plan: PlanCurve, s: Array, speed: float, ratio: float | None) -> Array:
    fine = np.linspace(0.0, plan.length, max(2, math.ceil(plan.length)) + 1)
    angle = superelevation_for(plan.curvature(fine), speed, ratio)
    total = np.r_[0.0, np.cumsum(np.diff(fine) * ((angle[1:] + angle[:-1]) / 2))]
    low, high = np.clip(s - RUN_IN / 2, 0.0, plan.length), np.clip(s + RUN_IN / 2, 0.0, plan.length)
    return np.asarray((np.interp(high, fine, total) - np.interp(low, fine, total)) / (high - low))
