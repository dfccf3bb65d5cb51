"""Chooses vertical radii that suit the expected speed, and adjusts grades where the parabolas would not fit.

A parabola of radius R takes R * (change of grade) metres, half on either side of the joint. On a slope
of length L, the two parabolas at its ends need

    L   >=   (R1 * |change at its start| + R2 * |change at its end|) / 2

A comfortable radius is v^2 / (0.5 m/s^2); the smallest radius that the rule ``too_abrupt`` allows is v^2 / (3
m/s^2). Here v is the expected speed. If comfortable parabolas do not fit, neighbouring grades are first made
more similar, as far as the requirements allow. Then radii become smaller, but never smaller than the rule
allows."""

from collections.abc import Collection, Sequence
from functools import cached_property
from itertools import accumulate, groupby, pairwise
from math import floor

import numpy as np

from roadgpt.brief.design_speed import SpeedLimits
from roadgpt.brief.element import Element
from roadgpt.brief.ranges import Range
from roadgpt.check.rules.too_abrupt import MOST
from roadgpt.design.layout import bends_of
from roadgpt.geometry.curve import Array
from roadgpt.road import Design, Segment, World, build
from roadgpt.road.design import MOST_OF_SLOPE, vertical_curves_of
from roadgpt.road.speed_profile import GRAVITY, expected_speed

COMFORT = 0.5  # m/s^2
EASES = (1.0, 0.5, 0.25, 0.0)  # shares of the comfortable radius, in the order in which they are tried
STEP = 2.0  # m between the stations at which the speed is computed
SHORTEST_SLOPE = 12.0  # m: shorter straights need no slope of their own
NEAR = 20.0  # m to either side of a joint, within which the highest speed counts
SPARE, LEAST_SPARE = 1.1, 1.02  # factors on comfortable and least radii, for the rounding of grades
ROUNDS = 80  # of moving grades, at most
ROUNDING = 1e-3  # relative tolerance of a radius
TENTH = 10.0  # per metre and per percent: radii and inclines are written to the tenth


class Pace:
    """The vertical radii that the expected speeds along a plan require."""

    def __init__(
        self, knots: Array, bends: Array, length: float, world: World, speed: SpeedLimits | None = None
    ) -> None:
        """Stores a plan: its length in metres, and the curvatures ``bends`` in 1/m at the stations ``knots``
        in metres, ``(n,)``, which are linear in between and 0 after the last. ``speed`` is what the design
        speed requires."""
        self._plan = knots, bends, length
        self._world = world
        self._floor = speed.vertical_radius if speed else 0.0

    @classmethod
    def along(cls, elements: Sequence[Element], world: World, speed: SpeedLimits | None = None) -> "Pace":
        """Returns the Pace of a draft."""
        return cls(*bends_of(elements), world, speed)

    @classmethod
    def of(cls, design: Design, world: World) -> "Pace":
        """Returns the Pace of the road that is built from a design."""
        road = build(design)
        s = road.sample().s
        return cls(s, road.sample().curvature, road.length, world, None)

    @cached_property
    def _squares(self) -> tuple[float, Array]:
        knots, bends, length = self._plan
        s = np.linspace(0.0, length, max(1, round(length / STEP)) + 1)
        bend = np.interp(s, knots, bends, right=0.0)
        return float(s[1]), expected_speed(bend, 0.0, float(s[1]), self._world) ** 2

    def _square(self, s: float) -> float:
        step, squares = self._squares
        first, last = int(max(s - NEAR, 0.0) / step), int((s + NEAR) / step) + 1
        return float(squares[min(first, len(squares) - 1) : last + 1].max())

    def least(self, s: float, is_bump: bool = False) -> float:
        """Returns the least vertical radius in metres that the rule allows at station ``s`` in metres. If
        ``is_bump``, a vertical acceleration of up to 1 g is allowed, as for a requested crest or dip. It is
        never less than the design speed requires."""
        return max(self._square(s) / (GRAVITY if is_bump else MOST), self._floor)

    def eased(self, s: float, ease: float, is_bump: bool = False) -> float:
        """Returns the vertical radius to design at station ``s``, in metres: ``ease`` (0 to 1) times the
        comfortable radius, and never less than the rule allows."""
        comfort = self._square(s) / COMFORT
        return max(ease * SPARE * comfort, LEAST_SPARE * self.least(s, is_bump))


def softened(
    grades: Sequence[float], lengths: Sequence[float], radii: Sequence[float], rooms: Sequence[Range]
) -> list[float]:
    """Returns the grades, changed as little as possible within their bounds so that the parabolas fit.

    Slopes with too little room are corrected one after another by changing their grades and those of their
    neighbours. These are projections onto convex sets, which converge if a solution exists. Each slope has a
    grade and its bounds in percent and a length in metres, ``(n,)``; each joint of two slopes has a vertical
    radius in metres, ``(n - 1,)``."""
    out = [min(max(grade, room.lo), room.hi) for grade, room in zip(grades, rooms, strict=True)]
    halves = [0.0, *(radius / 200 for radius in radii), 0.0]
    for _ in range(ROUNDS):
        fits = [_made_room(out, i, halves, lengths, rooms) for i in range(len(out))]
        if all(fits):
            break
    return out


def made_to_fit(
    grades: Array,
    lengths: Sequence[float],
    inclines: Sequence[float],
    joining: Collection[int],
    bounds: Sequence[Range],
    pace: Pace,
    roomier: float = 1.0,
) -> Array:
    """Returns grades, changed so that parabolas as large as the rule ``too_abrupt`` requires fit between
    them.

    Neighbours with the same incline form one slope. A segment that only joins others, one of ``joining``,
    belongs to the slope of the neighbour with the nearer incline, because a short slope of its own would
    leave parabolas no room. Each segment has a grade, a proposed incline and bounds of the grade in percent,
    and a length in metres, ``(n,)``. ``roomier`` is a factor on the required radii, to leave more room than
    the rule requires."""
    runs = [*accumulate((a != b for a, b in pairwise(inclines)), initial=0)]
    for i in sorted(joining):
        beside = [j for j in (i - 1, i + 1) if 0 <= j < len(runs) and j not in joining]
        if beside:
            runs[i] = runs[min(beside, key=lambda j: abs(inclines[j] - inclines[i]))]
    rows = [[*row] for _, row in groupby(range(len(grades)), key=lambda i: runs[i])]
    own = [sum(lengths[i] for i in row) for row in rows]
    means = [
        sum(float(grades[i]) * lengths[i] for i in row) / size for row, size in zip(rows, own, strict=True)
    ]
    if max(means) == min(means):
        return grades
    lows = [max(bounds[i].lo for i in row) for row in rows]
    highs = [max(min(bounds[i].hi for i in row), low) for row, low in zip(rows, lows, strict=True)]
    radii = [roomier * pace.eased(s, 0.0) for s in accumulate(own[:-1])]
    found = softened(means, own, radii, [*map(Range, lows, highs)])
    return np.array([grade for row, grade in zip(rows, found, strict=True) for _ in row])


def _made_room(
    grades: list[float], i: int, halves: Sequence[float], lengths: Sequence[float], rooms: Sequence[Range]
) -> bool:
    before = grades[i] - grades[i - 1] if i else 0.0
    after = grades[i + 1] - grades[i] if i + 1 < len(grades) else 0.0
    over = halves[i] * abs(before) + halves[i + 1] * abs(after) - MOST_OF_SLOPE * lengths[i]
    if over <= 1e-6:
        return True
    first, last = np.sign(before) * halves[i], np.sign(after) * halves[i + 1]
    rates = [(j, rate) for j, rate in ((i - 1, -first), (i, first - last), (i + 1, last)) if rate]
    free = [
        (j, rate)
        for j, rate in rates
        if (grades[j] > rooms[j].lo + 1e-9 if rate > 0 else grades[j] < rooms[j].hi - 1e-9)
    ]
    total = sum(rate * rate / lengths[j] for j, rate in free)
    for j, rate in free:
        moved = grades[j] - over * rate / lengths[j] / total
        grades[j] = float(min(max(moved, rooms[j].lo), rooms[j].hi))
    return False


def joined(
    segments: Sequence[Segment], pace: Pace, ease: float = 1.0, opened: Collection[int] | None = None
) -> tuple[Segment, ...]:
    """Returns the segments with a vertical radius wherever the grade changes. Each chosen radius is the one
    that ``Pace.eased`` gives for ``ease``, or smaller if there is not enough room. ``opened`` are the indices
    of the segments for which a radius is chosen; None for all segments without a radius."""
    out, at, own = [], 0.0, set[int]()
    for i, segment in enumerate(segments):
        changes = i > 0 and segment.incline != segments[i - 1].incline
        is_open = segment.vertical_radius is None if opened is None else i in opened
        radius = segment.vertical_radius
        if changes and is_open:
            own.add(i)
            radius = pace.eased(at, ease)
        elif not changes and (is_open or opened is None):
            radius = None
        if radius != segment.vertical_radius:
            segment = segment.model_copy(update={"vertical_radius": radius})
        out.append(segment)
        at += segment.distance
    for parabola in vertical_curves_of(out):
        if parabola.number in own or opened is None:
            built = max(floor(parabola.radius * TENTH + 1e-6) / TENTH, 1 / TENTH)
            segment = out[parabola.number]
            out[parabola.number] = segment.model_copy(update={"vertical_radius": built})
    return tuple(out)


def widened(segments: Sequence[Segment], pace: Pace) -> tuple[Segment, ...]:
    """Returns the segments; each vertical radius that is smaller than the rule allows is increased. If
    neighbouring parabolas leave no room, their radii are chosen anew as well."""
    out, opened = tuple(segments), set[int]()
    while small := _too_small(out, pace):
        numbers = [parabola.number for parabola in vertical_curves_of(segments)]
        beside = {n for pair in pairwise(numbers) if small & {*pair} for n in pair}
        more = small - opened or beside - opened
        if not more:
            break
        opened |= more
        out = joined(segments, pace, 0.0, opened)
    return out


def too_abrupt(segments: Sequence[Segment], pace: Pace, bumps: bool = False) -> bool:
    """Returns whether the radius of any parabola is smaller than the rule allows; for ``bumps`` see
    ``Pace.least``."""
    return bool(_too_small(segments, pace, bumps))


def _too_small(segments: Sequence[Segment], pace: Pace, bumps: bool = False) -> set[int]:
    """Returns the numbers of the segments at whose start a parabola has too small a radius."""
    curves = vertical_curves_of(segments)
    return {each.number for each in curves if each.radius < pace.least(each.s, bumps) * (1 - ROUNDING)}
