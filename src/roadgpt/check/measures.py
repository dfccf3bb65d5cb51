"""Measures the turns, straights and grades of a finished road from the points of its centre line.

The measurement does not use any other information about the road. Angles are in degrees, lengths in metres,
and grades in percent, uphill positive. The centre line is resampled about every metre in plan:

* Curvature: change of heading per metre, averaged over 5 m.
* Turn: a part of the road that bends to one side with a curvature above a limit of 1/300 per metre. If the
  description asks for wider turns, as on a motorway, the limit is lower. Parts that bend to the same side and
  are less than 8 m apart are merged into one turn, except parts that turn by less than 4 degrees. The angle
  of a turn includes its ends, up to where the curvature falls below a tenth of the limit or changes sign. A
  bend of less than 10 degrees is not a turn.
* Straight: a part of 10 m or more between two turns, or between a turn and an end of the road. It is divided
  into pieces where its grade, over 10 m windows, changes between up (1 % or more), flat and down (-1 % or
  less). Pieces shorter than 6 m are ignored.

Source: the definitions of an independent road checker. ``tests/authorities`` compares its measurements with
those of this module."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.brief.outline import USUALLY_WIDEST
from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array

STEP = 1.0  # m between stations
FADES = 10.0  # times the widest radius: straighter parts do not belong to the angle of a turn
SMOOTHED = 5  # stations that a curvature is averaged over
JOINED = 8.0  # m: parts that bend to one side and are closer together are one turn
SLIGHT = 4.0  # degrees: a part that turns less is not joined to others
LEAST_TURN = 10.0  # degrees
LEAST_STRAIGHT = 10.0  # m
LEAST_PIECE = 6.0  # m
LEVEL = 1.0  # percent: less is flat
HALF_WINDOW = 5  # stations to either side for the grade that cuts a straight into pieces
LONG_WINDOW, SHORT_WINDOW = 20, 10  # stations: for climbing and falling, and for the steepest place

Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class MeasuredFeature:
    """A turn, a straight, or a piece of a straight, as measured on a finished road."""

    kind: Literal["turn", "straight"]
    start: float  # station in metres where the feature starts, measured in plan
    end: float
    side: Literal["left", "right"] | None
    degrees: float
    """Absolute change of heading in degrees. A turn includes its ends, where the curvature fades out; a
    straight excludes the 5 m at either end."""
    radius: float  # radius in metres at the tightest place
    grade: float  # mean grade in percent, from end to end
    inner_grade: float
    """Mean grade in percent over the middle half. It is close to the design grade even where vertical curves
    take up the ends of a short slope."""
    pieces: tuple["MeasuredFeature", ...] = ()
    """The pieces of a straight, each with one class of grade (up, flat or down); empty for a turn."""

    @property
    def length(self) -> float:
        """The length of the feature in plan, in metres."""
        return self.end - self.start

    @property
    def climb(self) -> float:
        """How many metres the feature rises from its start to its end; negative if it falls."""
        return self.grade * self.length / 100


class GradeChange(NamedTuple):
    """A change of grade between two parts of a straight that both go up, or both go down."""

    grade: float  # a grade in percent: the mean of the grades that are requested of the two parts
    rises: bool  # whether the grade of the second part is the larger one; -4 percent is larger than -8


class CentreLine(NamedTuple):
    """The resampled centre line: stations and heights in metres, heading in radians, curvature in 1/m."""

    s: Array
    z: Array
    heading: Array
    curvature: Array


@dataclass(frozen=True, slots=True)
class Measures:
    """The measured turns, straights, grades and lengths of a road."""

    features: tuple[MeasuredFeature, ...]  # turns and straights in driving order
    length: float  # length in plan in metres
    climb: float  # height difference in metres from start to end
    grade: float  # mean grade in percent, from start to end
    lowest_grade: float  # lowest grade over any 20 m in percent; negative if the road falls there
    highest_grade: float  # highest grade over any 20 m in percent; negative if the road falls everywhere
    steepest: float  # greatest absolute grade over any 10 m in percent
    hills: int  # number of changes between climbing and falling; grades are averaged over 20 m
    radius: float  # radius in metres at the tightest place of the road
    turning: float  # sum of the absolute changes of heading along the road in degrees
    line: CentreLine = field(repr=False, compare=False)  # the points that were measured

    @property
    def turns(self) -> tuple[MeasuredFeature, ...]:
        """The turns in driving order."""
        return tuple(f for f in self.features if f.kind == "turn")

    @property
    def straights(self) -> tuple[MeasuredFeature, ...]:
        """The straights in driving order."""
        return tuple(f for f in self.features if f.kind == "straight")

    @property
    def gaps(self) -> tuple[tuple[MeasuredFeature, ...], ...]:
        """The straights before the first turn, between consecutive turns, and after the last turn: with n
        turns n + 1 entries, each empty where there is no straight."""
        out: list[tuple[MeasuredFeature, ...]] = [()]
        for feature in self.features:
            if feature.kind == "turn":
                out.append(())
            else:
                out[-1] += (feature,)
        return tuple(out)

    def count(self, side: Literal["left", "right"]) -> int:
        """Returns the number of turns to the given side, left or right."""
        return sum(turn.side == side for turn in self.turns)

    def ways(self, feature: MeasuredFeature) -> set[Literal["up", "down", "flat"]]:
        """Returns in which ways a feature goes: up, down or flat, over 10 m at any of its stations."""
        first, last = np.searchsorted(self.line.s, (feature.start, feature.end)).tolist()
        return {way(grade) for grade in _local_grades(self.line, first, last)}

    def cut(self, piece: MeasuredFeature, changes: Sequence[GradeChange]) -> tuple[MeasuredFeature, ...]:
        """Cuts a piece of a straight at the given changes of its grade, over 10 m, and returns the parts.
        With n changes there are n + 1 parts, or fewer if the piece does not have all the changes in order. A
        part may be as short as one station."""
        first, last = (int(at) for at in np.searchsorted(self.line.s, (piece.start - 1e-6, piece.end - 1e-6)))
        local = _local_grades(self.line, first, last)
        cuts = [0]
        for change in changes:
            is_after = (local > change.grade) == change.rises
            before = np.flatnonzero(~is_after[cuts[-1] :])[:1] + cuts[-1]
            cuts += [int(at) for start in before for at in np.flatnonzero(is_after[start:])[:1] + start]
        marks = [first + cut for cut in cuts] + [last]
        return tuple(_feature(self.line, "straight", a, b) for a, b in pairwise(marks))


class _Bend(NamedTuple):
    sign: int
    first: int
    last: int
    degrees: float


def measure(points: ArrayLike, widest: float = USUALLY_WIDEST) -> Measures:
    """Measures a road given by points ``(n, 2)`` or ``(n, 3)`` in metres of its centre line, about 1 m apart.
    Bends wider than ``widest`` metres are not turns. Raises UsageError if there are fewer than two different
    points, or a number is not finite."""
    line = _resampled(points)
    s, z = line.s, line.z
    features = _features(line, _turns(line, widest))
    climb = float(z[-1] - z[0])
    long = _windows(line, LONG_WINDOW if len(s) > 2 * LONG_WINDOW else max(2, len(s) // 4))
    short = _windows(line, min(SHORT_WINDOW, len(s) - 1))
    ways = np.sign(long[np.abs(long) >= LEVEL])
    return Measures(
        features=features,
        length=float(s[-1]),
        climb=climb,
        grade=100 * climb / float(s[-1]),
        lowest_grade=float(long.min()),
        highest_grade=float(long.max()),
        steepest=float(np.abs(short).max()),
        hills=int(np.count_nonzero(ways[1:] != ways[:-1])),
        radius=_radius(line.curvature),
        turning=float(np.degrees(np.abs(np.diff(line.heading)).sum())),
        line=line,
    )


def way(grade: float) -> Literal["up", "down", "flat"]:
    """Returns "up" for a grade of 1 percent or more, "down" for -1 percent or less, and "flat" otherwise."""
    if grade >= LEVEL:
        return "up"
    return "down" if grade <= -LEVEL else "flat"


def ups_and_downs(heights: ArrayLike) -> str:
    """Returns how many metres a road with these heights climbs and falls in all, such as "+10.0 -2.5"."""
    steps = np.diff(heights)
    ways = (float(steps[steps > 0].sum()), float(steps[steps < 0].sum()))
    return " ".join(f"{each:+.1f}" for each in ways if abs(each) >= 0.05) or "+0.0"


def _resampled(points: ArrayLike) -> CentreLine:
    p = np.asarray(points, float)
    if p.ndim != 2 or p.shape[1] < 2 or not np.isfinite(p[:, :3]).all():
        raise UsageError("a centre line is two or more points of two or three finite numbers each")
    steps = np.hypot(np.diff(p[:, 0]), np.diff(p[:, 1]))
    fresh = np.append(True, steps > 1e-6)
    if not fresh[1:].any():
        raise UsageError(
            "the points of the centre line all lie in one place; give at least two different ones"
        )
    if not fresh.all():
        p = p[fresh]
        steps = np.hypot(np.diff(p[:, 0]), np.diff(p[:, 1]))
    along = np.append(0.0, np.cumsum(steps))
    s = np.linspace(0.0, along[-1], max(round(float(along[-1]) / STEP), 3) + 1)
    x, y = np.interp(s, along, p[:, 0]), np.interp(s, along, p[:, 1])
    z = np.interp(s, along, p[:, 2]) if p.shape[1] > 2 else np.zeros_like(s)
    heading = np.arctan2(np.gradient(y), np.gradient(x))
    heading[1:] -= np.cumsum(np.round(np.diff(heading) / (2 * np.pi))) * (2 * np.pi)
    bend = np.gradient(heading) / (s[1] - s[0])
    reach = SMOOTHED // 2
    padded = np.concatenate([np.full(reach, bend[0]), bend, np.full(reach, bend[-1])])
    return CentreLine(s, z, heading, np.convolve(padded, np.full(SMOOTHED, 1 / SMOOTHED), "valid"))


def _radius(curvature: Array) -> float:
    return float(1 / max(np.abs(curvature).max(), 1e-9))


def _windows(line: CentreLine, width: int) -> Array:
    return np.asarray(100 * (line.z[width:] - line.z[:-width]) / (line.s[width:] - line.s[:-width]))


def _stretches(values: NDArray[np.int8]) -> tuple[Indices, Indices]:
    cuts = np.flatnonzero(values[1:] != values[:-1])
    return np.concatenate([[0], cuts + 1]), np.concatenate([cuts, [len(values) - 1]])


def _signs(values: Array, least: float) -> NDArray[np.int8]:
    return (values > least).astype(np.int8) - (values < -least).astype(np.int8)


def _turns(line: CentreLine, widest: float) -> list[_Bend]:
    signs, faint = _signs(line.curvature, 1 / widest), _signs(line.curvature, 1 / (FADES * widest))
    first, last = _stretches(signs)
    curved = signs[first] != 0
    from_, to = _stretches(faint)

    def measured(bends: Sequence[_Bend]) -> list[_Bend]:
        """Returns the bends with their angles, measured out to where the curvature fades."""
        out = []
        for bend in bends:
            a = from_[np.searchsorted(from_, bend.first, "right") - 1]
            b = to[np.searchsorted(to, bend.last)]
            turned = abs(float(np.degrees(line.heading[b] - line.heading[a])))
            out.append(bend._replace(degrees=turned))
        return out

    found = [
        _Bend(int(signs[a]), int(a), int(b), 0.0) for a, b in zip(first[curved], last[curved], strict=True)
    ]
    found = measured(_joined(found, line.s))
    found = measured(_joined([bend for bend in found if bend.degrees >= SLIGHT], line.s))
    return [bend for bend in found if bend.degrees >= LEAST_TURN]


def _joined(bends: Sequence[_Bend], s: Array) -> list[_Bend]:
    out: list[_Bend] = []
    for bend in bends:
        before = out[-1] if out else None
        if before and before.sign == bend.sign and s[bend.first] - s[before.last] < JOINED:
            out[-1] = before._replace(last=bend.last)
        else:
            out.append(bend)
    return out


def _features(line: CentreLine, bends: Sequence[_Bend]) -> tuple[MeasuredFeature, ...]:
    s, out = line.s, list[MeasuredFeature]()
    marks = [0, *(index for bend in bends for index in (bend.first, bend.last)), len(s) - 1]
    gaps = list(zip(marks[::2], marks[1::2], strict=True))
    for (a, b), bend in zip(gaps, [*bends, None], strict=True):
        if s[b] - s[a] >= LEAST_STRAIGHT:
            out.append(_straight(line, a, b))
        if bend:
            side: Literal["left", "right"] = "left" if bend.sign > 0 else "right"
            out.append(_feature(line, "turn", bend.first, bend.last, side, bend.degrees))
    return tuple(out)


def _feature(
    line: CentreLine,
    kind: Literal["turn", "straight"],
    first: int,
    last: int,
    side: Literal["left", "right"] | None = None,
    degrees: float = 0.0,
) -> MeasuredFeature:
    last = min(max(last, first + 1), len(line.s) - 1)
    first = min(first, last - 1)
    if kind == "straight":
        inner = min(SMOOTHED, (last - first) // 2)
        degrees = abs(float(np.degrees(line.heading[last - inner] - line.heading[first + inner])))
    start, end = float(line.s[first]), float(line.s[last])
    grade = 100 * float(line.z[last] - line.z[first]) / (end - start)
    radius = _radius(line.curvature[first : last + 1])
    off = (last - first) // 4
    a, b = first + off, last - off
    inner_grade = 100 * float(line.z[b] - line.z[a]) / float(line.s[b] - line.s[a])
    return MeasuredFeature(kind, start, end, side, degrees, radius, grade, inner_grade)


def _straight(line: CentreLine, first: int, last: int) -> MeasuredFeature:
    """Returns a straight with its pieces; if all of them are too short to count, it is its only piece."""
    local = _local_grades(line, first, last)
    classes = (local >= LEVEL).astype(np.int8) - (local <= -LEVEL).astype(np.int8)
    whole, cuts = _feature(line, "straight", first, last), [*zip(*_stretches(classes), strict=True)]
    if len(cuts) == 1:
        return replace(whole, pieces=(whole,))
    found = (_feature(line, "straight", first + int(a), min(first + int(b) + 1, last)) for a, b in cuts)
    pieces = tuple(piece for piece in found if piece.length >= LEAST_PIECE)
    return replace(whole, pieces=pieces or (whole,))


def _local_grades(line: CentreLine, first: int, last: int) -> Array:
    """Returns the grade in percent over 10 m around each station from ``first`` to ``last``."""
    here = np.arange(first, last + 1)
    before, after = np.maximum(here - HALF_WINDOW, 0), np.minimum(here + HALF_WINDOW, len(line.s) - 1)
    return np.asarray(100 * (line.z[after] - line.z[before]) / (line.s[after] - line.s[before]))
