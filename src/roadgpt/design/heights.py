"""Chooses the heights of a draft at random: one incline per turn, and one or more per straight. Then corrects
what is not measured as required.

The parabola that joins the grades of two straights takes up a part of both. A level straight next to a steep
one is therefore measured shorter than designed, and the mean grade of the steep one falls. So
``corrected_draft`` corrects joints and grades of straights by the measured errors, and measures the draft
again. The lengths of consecutive straights change, too,
which moves the joints between them but not the road in plan view."""

from collections.abc import Iterator, Sequence
from itertools import accumulate, groupby, pairwise
from math import ceil, copysign, inf

import numpy as np

from roadgpt.brief.element import Element
from roadgpt.brief.outline import USUALLY_WIDEST, Outline
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import STEEPEST
from roadgpt.check.matching import Complaint, complaints
from roadgpt.check.measures import MeasuredFeature, RoadMeasures, measure, way
from roadgpt.design.compose import Windows, is_hairpin
from roadgpt.design.elements import cut, required_hills, rounded
from roadgpt.design.layout import PlanLine
from roadgpt.design.vertical import Pace, joined, softened, too_abrupt
from roadgpt.geometry.curve import Array
from roadgpt.road import Segment
from roadgpt.road.builder import elevation_of
from roadgpt.road.design import MOST_OF_SLOPE

ROUNDS = 12  # of estimating how much height the parabola on a crest takes away
FEW_ROUNDS = 3  # beside a straight of fixed length, which steeper slopes would shorten by longer parabolas
NEARLY = 0.1  # percentage points by which a grade may miss the one that gives a height
NEAR_CLIMB = 0.1  # share of the tolerance of a climb that is used
LEVEL_SHARE, SLOPE_SHARE = 0.22, 0.3  # of roads without required heights: level, of one slope; others roll
GENTLE, STEEP = 1.5, 9.0  # percent, of such roads
STEADY = 0.5  # probability that an element keeps the grade of the one before, if it may
ROLL = 60.0  # m, least distance for which a rolling road keeps its grade
HILL = 34.0  # m: the shortest climb or fall of a hilly road
LONG, SPREAD = 1500.0, 0.7  # m: hills of a longer road take this share of an equal part of it, or more
HILL_GRADES = (4.0, 8.5)  # percent
CREST = Range(2.5, 4.5)  # percent: climb of a straight before a bend of a hard road, and fall in the bend
STEADY_SHARE = Range(0.75, 1.25)  # of the mean grade, on a road with hairpins
HELD = 0.5  # percentage points by which the grade of a straight of required length and grade may be moved
LEAST_SLOPE = 1.8  # percent: the least slope that is clearly a climb or a fall
HARDLY_SLOPED = Range(-0.8, 0.8)  # percent, of parts of which no slope is asked beside those with heights
SHORT_JOIN = 30.0  # m, of a straight between two parts with heights, which takes no slope of its own
MOST_SHIFT = 40.0  # percentage points
BISECTIONS = 50
TOO_ABRUPT = "slopes that change too fast for the speed"
CORRECTIONS = 8
MOST_OFF = 0.1  # of its length, that a straight is measured longer or shorter
LONG_ENOUGH = 35.0  # m of a straight that may be measured longer or shorter
SHORTEST = 4.0  # m that a correction leaves of a straight
TENTH = 10.0  # per percent


def asks_for_heights(plan: Sequence[Element]) -> bool:
    """Returns whether a height is asked of a part; parts of which no slope is asked then stay level."""
    return any(element.required_climb for element in plan)


def has_room_for_heights(plan: Sequence[Element], limit: Range, pace: Pace, ease: float, bumps: bool) -> bool:
    """Returns whether the grades that give the heights are allowed; with shorter parabolas, which take less
    height from a crest, lower grades do."""
    if not asks_for_heights(plan):
        return True
    grades = _grades_of_climbs(plan, pace, ease, bumps)
    rooms = [overlap(limit, element.required_grade) or limit for element in plan]
    return all(
        room.lo - NEARLY <= grade <= room.hi + NEARLY
        for element, grade, room in zip(plan, grades, rooms, strict=True)
        if element.required_climb
    )


def _grades_of_climbs(plan: Sequence[Element], pace: Pace, ease: float, bumps: bool) -> list[float]:
    """Returns the grade in percent that gives each element its height; 0 if it needs none. Where the road
    rises and then falls, the parabola between the two slopes takes away height at its vertex, which both
    slopes make up for."""
    joints = list(accumulate(element.length for element in plan))[:-1]
    radii = [pace.eased(s, ease, bumps) for s in joints]
    grades = [_grade_of_climb(element, 0.0) for element in plan]
    for _ in range(FEW_ROUNDS if any(element.has_fixed_length for element in plan) else ROUNDS):
        lost = [0.0] * len(plan)
        for at, ((one, other), radius) in enumerate(zip(pairwise(grades), radii, strict=True)):
            are_asked = all(plan[i].required_climb for i in (at, at + 1))
            if (one * other < 0 and are_asked) or (not are_asked and (plan[at].half or plan[at + 1].half)):
                change = abs(one - other) / 100
                room = 2 * MOST_OF_SLOPE * min(plan[at].length, plan[at + 1].length)  # half on each side
                cut = min(radius * change, room) * change / 8
                lost[at], lost[at + 1] = lost[at] + cut, lost[at + 1] + cut
        grades = [_grade_of_climb(element, metres) for element, metres in zip(plan, lost, strict=True)]
    return grades


def _grade_of_climb(element: Element, lost: float) -> float:
    """Returns the grade in percent that gives an element its height and ``lost`` metres more; 0 if it needs
    none."""
    if element.required_climb is None:
        return 0.0
    metres = _height(element.required_climb)
    unseen = element.transition * min(element.radius / USUALLY_WIDEST, 1.0) if element.half else 0.0
    return 100 * (metres + (lost if metres > 0 else -lost)) / (element.length - unseen)


def _height(asked: Range) -> float:
    """Returns the height in metres to design: the number that was given, or one inside the range: a little
    beyond its end nearer to 0, or half of "at most" a height."""
    if asked.number is not None:
        return asked.number
    near, far = sorted((asked.lo, asked.hi), key=abs)
    return near * 1.1 if near and abs(far) > 1.2 * abs(near) else (near + far) / 2


def _with_grade(element: Element, grade: float, limit: Range) -> Element:
    asked = element.required_climb
    if asked is None:
        return element
    low, high = sorted(grade * end / _height(asked) for end in (asked.lo, asked.hi))
    found = Range(low, high, number=grade)
    for other in (limit, element.required_grade):
        both = overlap(found, other) or found
        room = both if both.lo <= both.hi else limit
        near = min(max(grade, room.lo), room.hi)  # as high as it can be, if it cannot be as high as asked
        found = Range(both.lo, both.hi, number=near) if both.lo <= both.hi else Range(near, near)
    return element._replace(required_grade=found)


def drawn_heights(
    plan: Sequence[Element],
    outline: Outline,
    windows: Windows,
    rng: np.random.Generator,
    pace: Pace,
    ease: float = 1.0,
    bumps: bool = False,
) -> list[Element]:
    """Returns the elements of a plan with random inclines, rounded to a tenth of a percent. A straight of
    several slopes becomes several elements. For ``ease`` and ``bumps``, see ``Pace.eased``."""
    if asks_for_heights(plan):
        heights = zip(plan, _grades_of_climbs(plan, pace, ease, bumps), strict=True)
        plan = [_with_grade(element, grade, windows.limit) for element, grade in heights]
    is_hilly = bool(outline.hills and outline.hills.lo > required_hills(plan))
    if is_hilly:
        assert outline.hills is not None
        drawn = _hilly(plan, outline.hills, max(HILL, windows.hill), rng)
    else:
        grades = _grades(plan, outline, windows, rng)
        drawn = [[one._replace(incline=grade)] for one, grade in zip(plan, grades, strict=True)]
    row = [element for own in drawn for element in own]
    lengths = np.array([element.length for element in row])
    rests = [False] * len(row) if is_hilly else _are_level(plan, outline, windows)
    asked = [
        e.required_grade or windows.base or (HARDLY_SLOPED if rests_level else None)
        for e, rests_level in zip(row, rests, strict=True)
    ]
    limits = [overlap(span, windows.limit) or windows.limit for span in asked]
    values = np.clip([e.incline for e in row], [r.lo for r in limits], [r.hi for r in limits])
    if outline.steepest and outline.steepest.lo > 0:
        values = _with_steepest(values, lengths, limits, outline.steepest, rng)
        limits = _steep_kept(values, lengths, limits, outline.steepest.lo)
    if ease > 0:
        limits = _held(row, values, limits)
    if is_hilly or _is_mountainous(outline):  # what climbs or falls clearly goes on to do so
        ways = [Range(LEAST_SLOPE) if value > 0 else Range(-inf, -LEAST_SLOPE) for value in values]
        limits = [
            overlap(room, way) or room if abs(value) >= LEAST_SLOPE else room
            for value, room, way in zip(values, limits, ways, strict=True)
        ]
    values = _softened(values, lengths, limits, pace, ease, bumps)
    if outline.climb:
        near = outline.climb.around(NEAR_CLIMB)
        low = near.lo if near.lo > -inf else near.hi - max(0.3 * abs(near.hi), 2.0)
        high = near.hi if near.hi < inf else near.lo + max(0.3 * abs(near.lo), 2.0)
        metres = low + (0.3 + 0.4 * float(rng.random())) * (high - low)
        values = climbing(values, lengths, limits, metres)
        values = _softened(values, lengths, limits, pace, ease, bumps)
        values = climbing(values, lengths, limits, metres)  # one shift of all leaves the joints as they are
    final = iter(rounded(values).tolist())
    drawn = [[element._replace(incline=next(final)) for element in own] for own in drawn]
    return [element for own in _joining(drawn) for element in own]


def _grades(
    plan: Sequence[Element], outline: Outline, windows: Windows, rng: np.random.Generator
) -> list[float]:
    if outline.hard and all(element.required_grade in (None, windows.base) for element in plan):
        return _crests(plan, windows, rng)
    if not windows.base and not any(element.required_grade for element in plan):
        if _is_mountainous(outline):
            return _steady_grades(plan, outline.climb, windows, rng)
        return _free_grades(plan, windows, rng)
    out: list[float] = []
    last: tuple[Range | None, float] = (None, 0.0)
    for element, is_level in zip(plan, _are_level(plan, outline, windows), strict=True):
        window = element.required_grade or (windows.base if element.turn or len(plan) == 1 else None)
        if window is None:
            out.append(0.0 if is_level else np.nan)
            continue
        near = window.around(0.0)
        keeps = last[0] is not None and last[1] in near and rng.random() < STEADY
        value = last[1] if keeps else _between(near, rng)
        out.append(value)
        last = (window, value)
    return out


def _are_level(plan: Sequence[Element], outline: Outline, windows: Windows) -> list[bool]:
    """Returns for each element whether it stays level, because heights are asked of others and no slope of
    it; a short straight between two parts with heights only joins them."""
    is_steep = outline.steepest is not None and outline.steepest.lo > 0
    if windows.base or outline.climb or outline.hills or is_steep or not asks_for_heights(plan):
        return [False] * len(plan)
    has_height = [False, *(element.required_climb is not None for element in plan), False]
    joins = [
        not element.turn and element.length < SHORT_JOIN and before and after
        for element, before, after in zip(plan, has_height, has_height[2:], strict=False)
    ]
    return [not (e.required_grade or is_join) for e, is_join in zip(plan, joins, strict=True)]


def _crests(plan: Sequence[Element], windows: Windows, rng: np.random.Generator) -> list[float]:
    if windows.base is None:
        return [(-1 if element.turn else 1) * _between(CREST, rng) for element in plan]
    middle = (windows.base.lo + windows.base.hi) / 2
    halves = Range(windows.base.lo, middle), Range(middle, windows.base.hi)
    return [_between(halves[0] if element.turn else halves[1], rng) for element in plan]


def _between(window: Range, rng: np.random.Generator) -> float:
    return window.lo + float(rng.random()) * (window.hi - window.lo)


def _free_grades(plan: Sequence[Element], windows: Windows, rng: np.random.Generator) -> list[float]:
    style, top = rng.random(), min(STEEP, windows.limit.hi)
    if style < LEVEL_SHARE:
        return [0.0] * len(plan)
    low = min(GENTLE, top)
    if style < LEVEL_SHARE + SLOPE_SHARE:
        return [float(rng.choice((-1, 1)) * (low + rng.random() * (top - low)))] * len(plan)
    out, grade, so_far = [], 0.0, inf
    for element in plan:
        if element.turn or rng.random() < 0.5:
            drawn = float(rng.choice((-1, 0, 1), p=(0.4, 0.2, 0.4)) * (low + rng.random() * (top - low)))
            if so_far >= ROLL:
                grade, so_far = drawn, 0.0
        so_far += element.length
        out.append(grade)
    return out


def _is_mountainous(outline: Outline) -> bool:
    if outline.grade or outline.hills or any(group.feature.grade for group in outline.groups):
        return False
    return sum(group.lo for group in outline.groups if is_hairpin(group.feature)) > 1


def _steady_grades(
    plan: Sequence[Element], climb: Range | None, windows: Windows, rng: np.random.Generator
) -> list[float]:
    top = min(STEEP, windows.limit.hi)
    low = min(2 * GENTLE, top)
    way = float(rng.choice((-1, 1))) * (low + rng.random() * (top - low))
    if climb and climb.lo * climb.hi > 0:
        way = copysign(way, climb.lo)
    return [way * _between(STEADY_SHARE, rng) for _ in plan]


def _hilly(
    plan: Sequence[Element], hills: Range, hill: float, rng: np.random.Generator
) -> list[list[Element]]:
    """Returns elements that alternately climb and fall; required grades stay. Long straights are cut into
    several. An element too short for a hill continues the one before."""
    out: list[list[Element]] = []
    sign, wanted, so_far = float(rng.choice((-1, 1))), 0, 0.0
    most = hills.hi if hills.hi < inf else hills.lo + 2
    whole = sum(element.length for element in plan)
    hill = max(hill, SPREAD * whole / (most + 1)) if whole > LONG else hill
    for element in plan:
        asked = element.required_grade
        parts = 1 if element.turn or asked else max(1, int(element.length / hill))
        own: list[Element] = []
        for _ in range(parts):
            length = element.length / parts
            if asked and not (asked.lo < 0 < asked.hi):
                way = float(np.sign(asked.lo + asked.hi))
                wanted, sign, so_far = wanted + (way != sign and bool(out or own)), way or sign, 0.0
            elif so_far >= hill and wanted < most:
                wanted, sign, so_far = wanted + 1, -sign, 0.0
            so_far += length
            size = abs(_between(asked.around(0.0), rng)) if asked and 0 not in asked else None
            low, high = HILL_GRADES
            incline = sign * (size or low + rng.random() * (high - low))
            own.append(element._replace(straight=element.straight / parts, incline=incline))
        out.append(own)
    return out


def _with_steepest(
    values: Array, lengths: Array, limits: Sequence[Range], steepest: Range, rng: np.random.Generator
) -> Array:
    low = steepest.lo + min(0.5, 0.3 * max(min(steepest.hi, STEEPEST) - steepest.lo, 0.0))
    if np.any((np.abs(values) >= low) & (lengths > HILL)):
        return values
    out = values.copy()
    for index in np.argsort(-lengths):
        room, side = limits[index], float(np.sign(values[index]))
        wants = [side for side in (1, -1) if room.lo <= side * low <= room.hi]
        if wants:
            side = side if side in wants else float(rng.choice(wants))
            most = room.hi if side > 0 else -room.lo
            out[index] = side * (low + rng.random() * max(min(most, low + 3) - low, 0.0))
            break
    return out


def _joining(drawn: Sequence[list[Element]]) -> list[list[Element]]:
    out = [*drawn]
    for index, own in enumerate(out):
        if not np.isnan(own[0].incline):
            continue
        before = [o[-1].incline for o in out[:index] if not np.isnan(o[-1].incline)][-1:]
        after = [o[0].incline for o in out[index + 1 :] if not np.isnan(o[0].incline)][:1]
        first, last = (before or after or [0.0])[0], (after or before or [0.0])[0]
        if first == last:
            out[index] = [own[0]._replace(incline=first)]
        elif own[0].turn:
            out[index] = [own[0]._replace(incline=float(rounded(np.array([(first + last) / 2]))[0]))]
        else:
            out[index] = [own[0]._replace(straight=own[0].straight / 2, incline=g) for g in (first, last)]
    return out


def _steep_kept(values: Array, lengths: Array, limits: Sequence[Range], least: float) -> list[Range]:
    out = [*limits]
    steep = [i for i in range(len(out)) if abs(values[i]) >= least]
    for i in sorted(steep, key=lambda i: -lengths[i])[:1]:
        room = Range(least) if values[i] > 0 else Range(-inf, -least)
        out[i] = overlap(out[i], room) or out[i]
    return out


def _held(row: Sequence[Element], values: Array, limits: Sequence[Range]) -> list[Range]:
    """Returns limits close to the chosen grades for straights of required length and grade; without such a
    straight, for parts of required height."""
    fixed = [element.has_fixed_length for element in row]
    held = fixed if any(fixed) else [element.required_climb is not None for element in row]
    return [
        overlap(room, Range(value - HELD, value + HELD)) or room
        if is_held and one.required_grade is not None and 0 not in one.required_grade
        else room
        for one, value, room, is_held in zip(row, values, limits, held, strict=True)
    ]


def _softened(
    values: Array, lengths: Array, limits: Sequence[Range], pace: Pace, ease: float, bumps: bool
) -> Array:
    known = np.flatnonzero(~np.isnan(values))
    if len(known) < 2 or np.ptp(values[known]) == 0:
        return values
    ends = np.cumsum(lengths)
    begins = ends - lengths
    joints = [float(ends[a] + begins[b]) / 2 for a, b in pairwise(known)]
    own = np.diff([0.0, *joints, float(ends[-1])])
    radii = [pace.eased(s, ease, bumps) for s in joints]
    out = values.copy()
    out[known] = softened(values[known].tolist(), own.tolist(), radii, [limits[int(i)] for i in known])
    return out


def climbing(grades: Array, lengths: Array, limits: Sequence[Range], metres: float) -> Array:
    """Returns the grades in percent, all shifted by one amount within their limits, so that the road climbs
    ``metres``. A grade that is NaN is first set to the mean of the others."""
    grades = np.where(np.isnan(grades), np.nanmean(grades) if np.isfinite(grades).any() else 0.0, grades)
    least, most = np.array([r.lo for r in limits]), np.array([r.hi for r in limits])
    down, up = -MOST_SHIFT, MOST_SHIFT
    for _ in range(BISECTIONS):
        middle = (down + up) / 2
        climbed = float(np.clip(grades + middle, least, most) @ lengths) / 100
        down, up = (middle, up) if climbed < metres else (down, middle)
    return np.asarray(np.clip(grades + down, least, most))


def corrected_draft(
    elements: Sequence[Element],
    line: PlanLine,
    outline: Outline,
    limit: Range,
    pace: Pace,
    ease: float,
    share: float,
    bumps: bool,
) -> tuple[tuple[Segment, ...], list[Complaint]]:
    """Returns the segments of a draft, corrected in up to eight rounds, and a Complaint for each requirement
    that they still violate.

    ``limit`` is the range of inclines that are allowed, in percent. ``ease`` and ``share`` are fractions of
    the comfortable vertical radius. ``ease`` is used between consecutive straights if at least one of them
    has a fixed length, and ``share`` elsewhere. For ``bumps``, see ``Pace.eased``."""
    ends = np.cumsum([element.length for element in elements])
    for n in range(CORRECTIONS):
        parts = [part for one in _with_radii(elements, pace, ease, bumps) for part in cut(one)]
        segments = joined(parts, pace, share)
        heights = elevation_of(segments, 0.0).height(line.s)
        found = measure(np.stack([line.z.real, line.z.imag, heights], axis=1), outline.widest)
        if too_abrupt(segments, pace, bumps):
            broken = [Complaint(TOO_ABRUPT, on_heights=True)]
        else:
            broken = complaints(found, outline)
        ends = _shared_ends(elements, ends, found) if n == 0 else ends
        before, elements = elements, _corrected(elements, ends, found, limit)
        if not any(complaint.on_heights for complaint in broken) or elements == before:
            break
    return segments, broken


def _with_radii(elements: Sequence[Element], pace: Pace, ease: float, bumps: bool) -> list[Element]:
    out, ends = list(elements), np.cumsum([element.length for element in elements])
    for row in _rows(elements):
        if any(elements[i].has_fixed_length for i in row):
            for i in row[1:]:
                out[i] = out[i]._replace(vertical_radius=pace.eased(float(ends[i - 1]), ease, bumps))
    return out


def _shared_ends(elements: Sequence[Element], ends: Array, found: RoadMeasures) -> Array:
    """Returns the stations at which straights of other grades should be measured to end.

    With the joint where it is required, the climb is as the words say, but the steeper straight is measured
    longer; with the joint moved until its length is right, the climb is less. So both err by half, as far as
    no straight is measured ``MOST_OFF`` longer or shorter than required. Short straights keep their lengths.
    """
    out = ends.copy()
    for row, pieces, runs in _pieces(elements, found):
        spare = [
            MOST_OFF * elements[i].length / (1 if i in (row[0], row[-1]) else 2)
            if elements[i].length >= LONG_ENOUGH
            else 0.0
            for i in row
        ]
        for run, piece in zip(runs[:-1], pieces, strict=False):
            last = run[-1]
            most = min(spare[last - row.start : last - row.start + 2])
            out[last] += np.clip((piece.end - ends[last]) / 2, -most, most)
    return out


def _pieces(
    elements: Sequence[Element], found: RoadMeasures
) -> Iterator[tuple[range, list[MeasuredFeature], list[list[int]]]]:
    """Yields the straights between two turns, as they are measured and as the draft has them: runs of the
    same direction of slope. They are left out if they do not correspond, or if no length is fixed."""
    if len(found.turns) != sum(bool(e.turn) and e.half != "second" for e in elements):
        return
    for row, gap in zip(_rows(elements), found.gaps, strict=True):
        pieces = [piece for straight in gap for piece in straight.pieces]
        runs = [[*run] for _, run in groupby(row, key=lambda i: way(elements[i].incline))]
        if len(pieces) == len(runs) and any(elements[i].has_fixed_length for i in row):
            yield row, pieces, runs


def _corrected(elements: Sequence[Element], ends: Array, found: RoadMeasures, limit: Range) -> list[Element]:
    out = list(elements)
    joints = np.cumsum([0.0, *(element.length for element in elements)])
    for row, pieces, runs in _pieces(elements, found):
        for run, piece in zip(runs, pieces, strict=True):
            last = run[-1]
            if last != row[-1] and (out[last].has_fixed_length or out[last + 1].has_fixed_length):
                joints[last + 1] += ends[last] - piece.end
            if len(run) == 1:
                out[last] = _with_measured_grade(out[last], piece, limit)
        lengths = _spread(np.diff(joints[row.start : row.stop + 1]))
        for i, length in zip(row, lengths.tolist(), strict=True):
            out[i] = out[i]._replace(straight=length)
    return out


def _rows(elements: Sequence[Element]) -> list[range]:
    marks = [-1, *(i for i, element in enumerate(elements) if element.turn), len(elements)]
    rows = [range(a + 1, b) for a, b in pairwise(marks)]
    return [row for row in rows if row.start == 0 or elements[row.start - 1].half != "first"]


def _with_measured_grade(element: Element, seen: MeasuredFeature, limit: Range) -> Element:
    asked = element.required_grade
    if not asked or not element.has_fixed_length or 0 in asked or seen.inner_grade in asked:
        return element
    missing = min(max(seen.grade, asked.lo), asked.hi) - seen.grade
    grade = element.incline + copysign(ceil(abs(missing) * TENTH) / TENTH, missing)
    grade = min(max(grade, asked.lo, limit.lo), asked.hi, limit.hi)
    return element._replace(incline=round(grade, 1))


def _spread(lengths: Array) -> Array:
    spare = np.maximum(lengths - SHORTEST, 0.0)
    room = max(float(lengths.sum()) - SHORTEST * len(lengths), 0.0)
    if not room or (lengths >= SHORTEST).all():
        return lengths
    return np.asarray(SHORTEST + spare * room / spare.sum())
