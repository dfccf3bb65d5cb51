"""Tries ways to make all changes of a request at once, until a road comes of it that the rules pass.

Every way is built and measured; what measures otherwise than it was to is corrected and measured again. The
road starts where it started, and is moved or turned only where it would leave the map.
"""

from collections.abc import Iterator, Sequence
from itertools import islice, product
from math import atan2, cos, degrees, hypot, radians, sin
from typing import NamedTuple

from roadgpt import check
from roadgpt.check.measures import MeasuredFeature, Measures, measure
from roadgpt.design.edit.candidates import EditCandidate
from roadgpt.design.edit.spacing import with_room
from roadgpt.design.edit.steps import EditStep, Goal, Mirror, Quantity
from roadgpt.design.repair import repair
from roadgpt.design.road_elements import RoadElement, RoadElements, joined, shows_turns
from roadgpt.design.vertical import EASES, Pace, changed_joints, widened
from roadgpt.design.vertical import joined as joined_slopes
from roadgpt.errors import UsageError
from roadgpt.road import Design, Geometry, Segment, World, build
from roadgpt.road.design import MAX_SEGMENTS

MOST_TRIALS = 160
CORRECTIONS = 6
REPAIRED = 2  # ways that are repaired in full where none is valid as it is
LARGEST = 12  # doses of one change that are combined with others
HUNDREDTH = 100.0
COUNTED = 25.0  # m: what is written for an element that is not seen may be measured as so much less

Aims = dict[tuple[str, Quantity], float]


class Made(NamedTuple):
    """A road with the changes, its measures, and what else had to be changed."""

    design: Design
    elements: RoadElements
    found: Measures
    besides: tuple[str, ...] = ()


class Tried(NamedTuple):
    """The result of trying one candidate: a road, or the reason why there is none."""

    made: Made | None
    objection: str
    closeness: int = 0
    """0: it does not show what was asked for; 1: it does, but the rules object."""
    draft: Made | None = None


def tried(
    design: Design,
    elements: RoadElements,
    changes: Sequence[Sequence[EditCandidate]],
    world: World,
    geometry: Geometry,
) -> Tried:
    """Returns the first candidate that makes a valid road; else the objection to the preferred one.

    Args:
        design: before the edit.
        elements: of that design.
        changes: for every change, its ways, the preferred one first.
        world: map and limits.
        geometry: what a design becomes.
    """
    first: Tried | None = None
    drafts: list[Made] = []
    for steps in islice(_combined(changes), MOST_TRIALS):
        draft: Made | None = None
        for ease, beside in _eases(steps):
            one = _one(design, elements, steps, world, geometry, ease, beside)
            if one.made:
                return one
            if first is None or one.closeness > first.closeness:
                first = one
            draft = one.draft or draft
        if draft and len(drafts) < REPAIRED:
            drafts.append(draft)
    for draft in drafts if geometry == "arcs" else ():
        steps = next(iter(_combined(changes)))
        mended = _mended(draft, steps, world)
        if mended:
            return Tried(mended, "")
    assert first is not None
    return first


def _combined(changes: Sequence[Sequence[EditCandidate]]) -> Iterator[tuple[EditStep, ...]]:
    """Ways of all changes together, those nearest to the preferred ones first."""
    some = [list(ways)[: LARGEST if len(changes) > 1 else None] for ways in changes]
    rows = product(*(range(len(ways)) for ways in some))
    for row in sorted(rows, key=lambda r: (sum(r), max(r, default=0), r)):
        yield tuple(step for ways, index in zip(some, row, strict=True) for step in ways[index])


def _eases(steps: Sequence[EditStep]) -> tuple[tuple[float, bool], ...]:
    """Shares of comfort for new changes of slope, and whether they are written into segments that stay.

    The parabola in front of a segment that nobody spoke of is left as it was, as long as that will do.
    """
    if any(goal.quantity == "grade" for step in steps for goal in step.goals):
        return tuple((ease, beside) for beside in (False, True) for ease in EASES)
    return ((1.0, False), (1.0, True))


def _one(
    design: Design,
    elements: RoadElements,
    steps: Sequence[EditStep],
    world: World,
    geometry: Geometry,
    ease: float,
    beside: bool,
) -> Tried:
    goals = [goal for step in steps for goal in step.goals]
    aims: Aims = {(goal.element, goal.quantity): goal.aim for goal in goals}
    objection, draft = "", None
    for _ in range(CORRECTIONS):
        after: RoadElements = elements
        for step in steps:
            after = step.apply(after, aims, world)
        after = with_room(after, elements)
        segments = joined(after)
        if not 1 <= len(segments) <= MAX_SEGMENTS:
            return Tried(None, f"the road would have {len(segments)} segments")
        try:
            new = _started(design, after, elements, world, Mirror() in steps)
            new = _rounded_off(new, design, world, ease, beside)
            found = measure(build(new, geometry).centreline())
        except UsageError as error:
            return Tried(None, str(error))
        objection = _unlike(after, found)
        if objection:
            return Tried(None, objection)
        missed = [
            (goal, value)
            for goal in goals
            if not goal.low <= (value := _value(goal, after, found)) <= goal.high
        ]
        if not missed:
            break
        objection = _told(*missed[0])
        for goal, value in missed:
            _correct(aims, goal, value)
    else:
        return Tried(None, objection)
    # a design that becomes a spline is placed as if it were built of arcs, which lie close by
    placed = repair(new, None, world, "place").design
    road = build(placed, geometry)
    findings = check.inspect(road, None, world)
    draft = Made(placed, after, found)
    if findings:
        return Tried(None, findings[0].sentence, 1, draft)
    return Tried(draft, "")


def _rounded_off(new: Design, before: Design, world: World, ease: float, beside: bool) -> Design:
    """The design with parabolas where slopes meet that did not meet before; all others stay."""
    opened = changed_joints(before.segments, new.segments)
    if not beside:
        opened = frozenset(i for i in opened if new.segments[i] not in before.segments)
    pace = Pace.of(new, world)
    segments = joined_slopes(new.segments, pace, ease, opened) if opened else new.segments
    return new.model_copy(update={"segments": widened(segments, pace) if beside else segments})


def _started(
    design: Design, after: RoadElements, before: RoadElements, world: World, is_mirrored: bool
) -> Design:
    """The design with other segments; where something new stands in front, the rest stays where it was."""
    segments = joined(after)
    x, y, z = design.starting_point
    if is_mirrored:
        theta = (180 - design.theta) % 360
        return Design(starting_point=(world.map_size - x, y, z), theta=round(theta, 6), segments=segments)
    old = {element.name for element in before}
    front: list[Segment] = []
    for element in after:
        if element.name in old:
            break
        front += element.segments
    if not front:
        return design.model_copy(update={"segments": segments})
    lead = build(Design(starting_point=(0.0, 0.0, 0.0), theta=0.0, segments=tuple(front)))
    end, turned = lead.at(lead.length), float(lead.heading(lead.length))
    theta = radians(design.theta) - turned
    far, way = hypot(end[0], end[1]), atan2(end[1], end[0]) + theta
    start = (x - far * cos(way), y - far * sin(way), z - float(end[2]))
    return Design(
        starting_point=(round(start[0], 2), round(start[1], 2), round(start[2], 2)),
        theta=round(degrees(theta) * HUNDREDTH) / HUNDREDTH % 360,
        segments=segments,
    )


def _unlike(elements: RoadElements, found: Measures) -> str:
    """Where the finished road does not show the turns that it should: what is wrong."""
    if shows_turns(found, elements):
        return ""
    wanted, shown = sum(element.is_turn for element in elements), len(found.turns)
    if wanted != shown:
        return f"{shown} turns would be seen and not {wanted}, as some run into each other"
    return "a turn would be seen to the wrong side"


def seen_as(name: str, elements: RoadElements, found: Measures) -> MeasuredFeature | None:
    """Returns the measured feature of an element on the road; None where it is not seen by itself."""
    turns = [element.name for element in elements if element.kind == "turn"]
    if name in turns:
        return found.turns[turns.index(name)]
    behind, alone = 0, dict[int, list[RoadElement]]()
    for element in elements:
        if element.kind == "turn":
            behind += 1
        elif element.segments:
            alone.setdefault(behind, []).append(element)
    for number, own in alone.items():
        if name in [element.name for element in own]:
            longest = max(own, key=lambda element: element.length)
            straights = [f for f in found.gaps[number] if f.kind == "straight"]
            return straights[0] if straights and longest.name == name else None
    return None


def _value(goal: Goal, elements: RoadElements, found: Measures) -> float:
    if not goal.element:
        return found.length
    seen = seen_as(goal.element, elements, found)
    if seen is None:  # hidden between others: it is as it is written
        element = next(element for element in elements if element.name == goal.element)
        return element.incline if goal.quantity == "grade" else goal.aim
    return float(getattr(seen, goal.quantity))


def _correct(aims: Aims, goal: Goal, value: float) -> None:
    key = (goal.element, goal.quantity)
    if not goal.element:
        return
    if goal.quantity in ("radius",) or (goal.quantity == "length" and goal.element.startswith("turn")):
        aims[key] *= min(max(goal.aim / max(value, 1e-6), 0.6), 1.6)
    else:
        aims[key] += goal.aim - value


def _told(goal: Goal, value: float) -> str:
    units = {"degrees": "degrees", "radius": "m of radius", "length": "m", "grade": "%"}
    what = goal.element or "the road"
    return f"{what} would have {value:.1f} {units[goal.quantity]} and not {goal.aim:.1f}"


def _mended(draft: Made, steps: Sequence[EditStep], world: World) -> Made | None:
    """The draft repaired in full, where it still shows what was asked for."""
    mended = repair(draft.design, None, world, "full")
    road = build(mended.design)
    if check.inspect(road, None, world):
        return None
    found = measure(road.centreline())
    sizes = [len(element.segments) for element in draft.elements]
    segments, at, elements = mended.design.segments, 0, list[RoadElement]()
    for element, size in zip(draft.elements, sizes, strict=True):
        elements.append(element.with_segments(segments[at : at + size]))
        at += size
    after = tuple(elements)
    if _unlike(after, found):
        return None
    for goal in (goal for step in steps for goal in step.goals):
        wide = 0.5 * (goal.high - goal.low)
        if not goal.low - wide <= _value(goal, after, found) <= goal.high + wide:
            return None
    return Made(mended.design, after, found, mended.changes)
