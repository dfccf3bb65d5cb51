"""Moves the joints and grades of straights that meet, until each straight is measured as it was asked for.

The parabola that joins two grades belongs to both straights. A level one is measured only where the road is
level, so it loses length to a steep neighbour, and the mean grade of the steep one falls. A short and steep
straight has no room for comfortable parabolas: there they bend more, as little as it takes.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from roadgpt.brief.element import Element
from roadgpt.brief.words import Range
from roadgpt.check.measures import HALF_WINDOW, LEVEL
from roadgpt.design.vertical import ROUNDING, Pace
from roadgpt.geometry.curve import Array
from roadgpt.road.elevation import vertical_curves

ROUNDS = 8
PUSHED = 1.0  # percentage points that a grade may be written off what was drawn, so that its mean is right
SHORTEST = 4.0  # m that a move leaves of a straight
PLACES = 61  # around a joint, at which the grade over a window is looked at
STATION = 0.5  # m between the stations that a mean grade is taken from
EASES = (1.0, 0.7, 0.5, 0.35, 0.25, 0.0)  # shares of comfort that are tried; 0: what the rule allows
SLACK = 0.4  # percentage points of what was promised, which drafts keep off, that a last resort may take
EASES_OF_BUMPS = (0.12, 0.08)  # besides, before the last of these, where a crest or a dip was asked for
GENTLER = (
    0.3,
    0.45,
    0.6,
    0.75,
    0.9,
)  # shares of the way to the gentle end of a promise, tried where nothing else fits


def eased(
    drawn: Sequence[Sequence[Element]], limit: Range, pace: Pace, ease: float, bumps: bool
) -> list[Element]:
    """Returns elements with joints moved inside rows of straights, and narrow grades kept on the whole.

    Args:
        drawn: the elements of a draft in driving order; a straight of several slopes is several elements.
        limit: range of inclines that are allowed, in percent.
        pace: vertical radii that the expected speeds require.
        ease: share of the comfortable vertical radius that is tried first, from 0 to 1.
        bumps: whether crests and dips were requested; then, as a last resort, radii may be as small as the
            wheels can follow.
    """
    out = [*drawn]
    starts = np.cumsum([0.0, *(sum(element.length for element in own) for own in drawn)])
    for first, last in _rows(drawn):
        row = [own[0] for own in drawn[first:last]]
        best: _Row | None = None
        for share, gentler in _tries(ease, bumps):
            at = [float(s) for s in starts[first + 1 : last]]
            softer = [_softer(element, gentler) for element in row]
            way = _settled(row, softer, limit, [pace.eased(s, share, bumps) for s in at])
            fits = way.fits([pace.least(s, bumps and share == 0) for s in at])
            if best is None or fits:
                best = way
            if fits and way.keeps(row, softer, 0.0 if share else SLACK):
                break
        assert best is not None
        out[first:last] = [(element,) for element in best.sloped(row)]
    return [element for own in out for element in own]


def _tries(ease: float, bumps: bool) -> list[tuple[float, float]]:
    """Shares of comfort, and how far grades are drawn towards the gentle end of their promise."""
    shares = (*EASES[:-1], *(EASES_OF_BUMPS if bumps else ()), EASES[-1])
    return [(share, 0.0) for share in shares if share <= ease] + [(0.0, gentler) for gentler in GENTLER]


def _near(grade: float, wanted: Range, slack: float) -> bool:
    return wanted.lo - slack <= grade <= wanted.hi + slack


def _softer(element: Element, share: float) -> float:
    if element.required_grade is None or not element.has_fixed_length:
        return element.incline
    gentle = min(max(0.0, element.required_grade.lo), element.required_grade.hi)
    return element.incline + share * (gentle - element.incline)


@dataclass(frozen=True)
class _Row:
    """Straights that follow each other, settled."""

    joints: Array
    """Metres from the start of the row, the end of each straight."""
    grades: Array
    """Percent."""
    edges: Array
    """Metres, where each straight is measured to end."""
    radii: Sequence[float]
    """Metres, of the parabolas at the inner joints."""

    def keeps(self, row: Sequence[Element], drawn: Sequence[float], slack: float) -> bool:
        """Returns whether each straight of fixed length has the required grade and is hardly steeper."""
        means = _means(self.joints, self.grades, self.edges, self.radii)
        inner = _inner(self.joints, self.grades, self.edges, self.radii)
        if np.abs(self.grades - drawn).max() > PUSHED:
            return False
        return all(
            element.required_grade is None
            or 0 in element.required_grade
            or _near(mean, element.required_grade, slack)
            or _near(middle, element.required_grade, slack)
            for element, mean, middle in zip(row, means, inner, strict=True)
            if element.has_fixed_length
        )

    def fits(self, least: Sequence[float]) -> bool:
        """Returns whether each parabola is as large as the rule asks for."""
        halves = _halves(self.joints, self.grades, self.radii)
        return bool(np.all(halves >= np.abs(np.diff(self.grades)) * np.array(least) / 200 * (1 - ROUNDING)))

    def sloped(self, row: Sequence[Element]) -> Iterator[Element]:
        """Yields the straights with their lengths, grades, and radii from the ones before."""
        lengths = np.diff(self.joints, prepend=0.0).tolist()
        for element, length, grade, radius in zip(
            row, lengths, self.grades.tolist(), [None, *self.radii], strict=True
        ):
            yield element._replace(straight=length, incline=grade, vertical_radius=radius)


def _rows(drawn: Sequence[Sequence[Element]]) -> Iterator[tuple[int, int]]:
    """First and last + 1 of straights that follow each other, where the length of one was asked for."""
    first = 0
    for at in range(len(drawn) + 1):
        if at < len(drawn) and not drawn[at][0].turn and len(drawn[at]) == 1:
            continue
        if at - first > 1 and any(own[0].has_fixed_length for own in drawn[first:at]):
            yield first, at
        first = at + 1


def _settled(row: Sequence[Element], drawn: Sequence[float], limit: Range, radii: Sequence[float]) -> _Row:
    """Lengths and inclines by which every straight is measured as it was drawn."""
    wanted = np.cumsum([element.length for element in row])
    joints, grades = wanted.copy(), np.array(drawn, dtype=float)
    movable = np.array([one.has_fixed_length or other.has_fixed_length for one, other in pairwise(row)])
    for _ in range(ROUNDS):
        edges = joints.copy()
        edges[:-1] += _shifts(joints, grades, radii)
        means = _means(joints, grades, edges, radii)
        inner = _inner(joints, grades, edges, radii)
        for i, element in enumerate(row):
            asked = element.required_grade
            if asked and element.has_fixed_length and 0 not in asked and inner[i] not in asked:
                grades[i] += min(max(means[i], asked.lo), asked.hi) - means[i]
                grades[i] = min(max(grades[i], asked.lo), asked.hi)
        grades = np.clip(grades, limit.lo, limit.hi)
        joints[:-1] += np.where(movable, wanted[:-1] - edges[:-1], 0.0)
        joints = _spread(joints)
    grades = np.round(grades, 1)
    edges = joints.copy()
    edges[:-1] += _shifts(joints, grades, radii)
    return _Row(joints, grades, edges, radii)


def _spread(joints: Array) -> Array:
    """Joints in order, none nearer to the next than SHORTEST, if there is room at all."""
    steps = SHORTEST * np.arange(1, len(joints) + 1)
    up = np.maximum.accumulate(np.maximum(joints - steps, 0.0)) + steps
    most = joints[-1] - SHORTEST * np.arange(len(joints) - 1, -1, -1)
    return np.asarray(np.where(most > steps - SHORTEST, np.minimum(up, most), joints))


def _halves(joints: Array, grades: Array, radii: Sequence[float]) -> Array:
    """Half of what the change of grade takes at every inner joint, as the road will be built."""
    out = np.zeros(len(joints) - 1)
    lengths = np.diff(joints, prepend=0.0).tolist()
    for parabola in vertical_curves(lengths, (grades / 100).tolist(), [None, *radii]):
        out[parabola.number - 1] = parabola.half
    return out


def _shifts(joints: Array, grades: Array, radii: Sequence[float]) -> Array:
    """How far behind its joint the grade is measured to become a climb, level or a fall; else 0."""
    out = np.zeros(len(joints) - 1)
    halves = _halves(joints, grades, radii)
    classes = np.where(np.abs(grades) >= LEVEL, np.sign(grades), 0.0)
    for i, half in enumerate(halves.tolist()):
        before, after = float(grades[i]), float(grades[i + 1])
        if classes[i] == classes[i + 1]:
            continue
        edge = LEVEL * (classes[i] + classes[i + 1])  # 0 between climbing and falling
        u = np.linspace(-half - HALF_WINDOW, half + HALF_WINDOW, PLACES)
        share = (_turned(u + HALF_WINDOW, half) - _turned(u - HALF_WINDOW, half)) / (2 * HALF_WINDOW)
        out[i] = np.interp((edge - before) / (after - before), share, u)
    return out


def _turned(u: Array, half: float) -> Array:
    """Integral over the way of the share of a change of grade that is behind, at places off its joint."""
    inside = np.clip(u + half, 0.0, 2 * half) ** 2 / (4 * max(half, 1e-9))
    return np.asarray(inside + np.maximum(u - half, 0.0))


def _means(joints: Array, grades: Array, edges: Array, radii: Sequence[float]) -> Array:
    """Percent, the mean grade of each straight between the places where it is measured to begin and end."""
    return _between(joints, grades, radii, np.concatenate([[0.0], edges[:-1]]), edges)


def _inner(joints: Array, grades: Array, edges: Array, radii: Sequence[float]) -> Array:
    """Percent, the mean grade of the middle half of each straight as it is measured."""
    off = np.diff(edges, prepend=0.0) / 4
    return _between(joints, grades, radii, np.concatenate([[0.0], edges[:-1]]) + off, edges - off)


def _between(joints: Array, grades: Array, radii: Sequence[float], first: Array, last: Array) -> Array:
    """Percent, mean grades from some places to others, metres."""
    halves = _halves(joints, grades, radii)
    stations = np.sort(np.concatenate([[0.0], joints[:-1] - halves, joints[:-1] + halves, joints[-1:]]))
    values = np.repeat(grades, 2)
    s = np.arange(0.0, joints[-1] + STATION, STATION)
    heights = np.concatenate([[0.0], np.cumsum(np.interp(s[:-1] + STATION / 2, stations, values)) * STATION])
    rises = np.interp(last, s, heights) - np.interp(first, s, heights)
    return np.asarray(rises / np.maximum(last - first, STATION))
