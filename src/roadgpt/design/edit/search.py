"""Makes all changes of a stage at once. Main function: ``made``.

Each change has one or more candidates. Combinations of one candidate per change are tried; combinations of
preferred candidates come first. The steps of the candidates are applied to the elements of the road. Then
``design.fit`` changes the elements that the request names until the road is valid and its measurements are as
requested; all other elements are frozen. If that fails and the geometry is ``arcs``, the other elements may
change as well. The start moves if the road is reversed or mirrored, or if elements are added in front of it.
If the road would leave the map, the road is shifted or rotated. If that is not enough, a map of the usual
size grows; on any other map, elements that the request does not name change."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice, pairwise, product, takewhile
from math import atan2, cos, degrees, hypot, pi, radians, sin

from roadgpt.brief.change.clashes import clash
from roadgpt.brief.change.request import NUMBERING
from roadgpt.brief.map_fit import ROUND_MAP
from roadgpt.brief.model import Side
from roadgpt.brief.outline import Feature
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import LEAST_STRAIGHT
from roadgpt.design.edit.candidates import ChangeCandidates, Reverse
from roadgpt.design.edit.insertion import without_spare_tail
from roadgpt.design.edit.places import is_beyond
from roadgpt.design.edit.slopes import SlopeOfAll
from roadgpt.design.edit.steps import SEPARATE, EditStep, Mirror, RoadLength
from roadgpt.design.fit import Look, Requirements, fit
from roadgpt.design.fit.grades import graded
from roadgpt.design.layout import moved_onto_map
from roadgpt.design.road_elements import (
    RoadElement,
    RoadElements,
    elements_on_road,
    gap,
    joined,
    numbered,
)
from roadgpt.errors import EditError, IdleEditError, UsageError
from roadgpt.road import Design, Geometry, World, build
from roadgpt.road.design import MAX_SEGMENTS

MOST_TRIALS = 40
FITTED_WHOLE = 2  # trials that are fitted again with all elements free, if none is valid otherwise
INSIDE_MAP = "inside_map"
MOST_GROWTH = 20  # steps by which a map may grow for a changed road
LARGEST = 12  # candidates of one change that are combined with others
SLACK = 0.03  # share by which a measured value may miss a limit
SEEN_STRAIGHT = Feature("straight", "straight", length=Range(LEAST_STRAIGHT + 0.3))
HUNDREDTH = 100.0  # per degree
DECIMALS = 6  # of the start of a reversed road and its direction


def made(
    design: Design,
    elements: RoadElements,
    changes: Sequence[ChangeCandidates],
    world: World,
    geometry: Geometry,
    may_grow: bool,
) -> tuple[Look, Design]:
    """Returns the road with all changes, and a design in which only the elements named in them changed. A
    change without candidates is not needed; ``elements`` are those of the road before the stage, and
    ``may_grow`` says whether the map may become larger. Raises EditError if the road already is as requested,
    or no valid road has the requested changes."""
    needed = [each for each in changes if each.ways]
    idle = [each for each in changes if not each.ways]
    if not needed:
        raise IdleEditError(f"nothing is to be changed: '{idle[0].change.words}' is so already")
    road, draft = _fitted(design, elements, needed, world, geometry, may_grow)
    if idle and not any(each.change.what in NUMBERING for each in needed):
        _refuse_broken_limits(idle, needed, road, geometry)
    is_of_road = any(each.change.what in ("mirror", "reverse") for each in needed)
    if road.design.segments == design.segments and not is_of_road:
        raise IdleEditError(f"nothing is to be changed: '{needed[0].change.words}' is so already")
    return road, draft


def _refuse_broken_limits(
    idle: Sequence[ChangeCandidates], needed: Sequence[ChangeCandidates], road: Look, geometry: Geometry
) -> None:
    """Raises EditError if a change breaks a limit that the road kept before the edit."""
    for limit in idle:
        own = {element.name for element in limit.placed.elements}
        for other in needed:
            is_same = limit.change.bound and other.change.what == limit.change.what
            if not is_same or own.isdisjoint(element.name for element in other.placed.elements):
                continue
            after, _ = elements_on_road(road.design, geometry)
            slack = replace(limit.change, to=(limit.change.to or 0) * (1 - SLACK * limit.change.bound))
            if any(is_beyond(slack, element) for element in after if element.name in own):
                raise clash(other.change, limit.change)


def _fitted(
    design: Design,
    elements: RoadElements,
    changes: Sequence[ChangeCandidates],
    world: World,
    geometry: Geometry,
    may_grow: bool,
) -> tuple[Look, Design]:
    """Returns the road with all changes, and its design before other elements had to change. If the map has
    no room for it, the map grows if it may; only otherwise do other elements change."""
    drafts, objection = _drafts(design, elements, changes, world, geometry)
    if may_grow and drafts and drafts[-1].objection:
        drafts += _on_larger_map(drafts, world)
    if drafts and not drafts[-1].objection:
        return drafts[-1], drafts[-1].design
    for draft in drafts[:FITTED_WHOLE] if geometry == "arcs" else ():
        whole = fit(draft.design, _staying(draft.elements), draft.requirements._replace(before=None))
        if not whole.objection:
            return whole, draft.design
    said = " and ".join(dict.fromkeys(f"'{each.change.words}'" for each in changes))
    raise EditError(f"{said} cannot be done on this road: {objection}; ask for less, or elsewhere")


def _drafts(
    design: Design,
    elements: RoadElements,
    changes: Sequence[ChangeCandidates],
    world: World,
    geometry: Geometry,
) -> tuple[list[Look], str]:
    """Returns the roads of combinations of candidates, up to the first one that is valid and as requested,
    and what was wrong with the first one tried; elements that the request does not name are frozen."""
    objection, drafts = "", list[Look]()
    for steps in islice(_combined(changes), MOST_TRIALS):
        try:
            length = next((step.room for step in reversed(steps) if isinstance(step, RoadLength)), None)
            needs = Requirements(world, before=design, geometry=geometry)
            needs = needs._replace(outline=replace(needs.outline, length=length))
            after = _applied(elements, steps, world)
            begun = _started(design, after, elements, world, steps)
            begun = graded(begun, after, needs.outline, world, design)
            drafts.append(fit(begun, after, needs, _frozen(after)))
        except UsageError as error:
            objection = objection or str(error)
            continue
        objection = objection or drafts[-1].objection
        if not drafts[-1].objection:
            break
    return drafts, objection


def _frozen(elements: RoadElements) -> set[str]:
    return {element.name for element in elements if not element.may_bend}


def _on_larger_map(drafts: Sequence[Look], world: World) -> list[Look]:
    """Returns the first of the drafts that is valid on a larger map, in a list; an empty list if none is."""
    for draft in drafts:
        if not any(finding.rule == INSIDE_MAP for finding in draft.findings):
            continue
        for steps in range(1, MOST_GROWTH + 1):
            larger = world.changed(map_size=world.site.map_size + steps * ROUND_MAP)
            if moved_onto_map(draft.design, larger) is not None:
                needs = draft.requirements._replace(world=larger)
                found = fit(draft.design, draft.elements, needs, _frozen(draft.elements))
                if not found.objection:
                    return [found]
                break
    return []


def _staying(elements: RoadElements) -> RoadElements:
    """Returns the elements; a straight that was measured between two turns must be measured again."""
    own = [element for element in elements if element.segments]
    turns = [True, *(element.is_turn for element in own), True]
    between = {
        element.name
        for element, *beside in zip(own, turns[:-2], turns[2:], strict=True)
        if not element.is_turn and all(beside)
    }
    return tuple(
        replace(element, asked=element.asked or SEEN_STRAIGHT)
        if element.seen and element.name in between
        else element
        for element in elements
    )


def _combined(changes: Sequence[ChangeCandidates]) -> Iterator[tuple[EditStep, ...]]:
    """Yields combinations of one candidate of each change, the most preferred combinations first."""
    some = [each.ways[: LARGEST if len(changes) > 1 else None] for each in changes]
    rows = product(*(range(len(ways)) for ways in some))
    for row in sorted(rows, key=lambda r: (sum(r), max(r, default=0), r)):
        yield tuple(step for ways, index in zip(some, row, strict=True) for step in ways[index])


def _applied(elements: RoadElements, steps: Sequence[EditStep], world: World) -> RoadElements:
    after = elements
    for step in sorted(steps, key=_rank):
        after = step.apply(after, world)
    after = without_spare_tail(after)
    after = _with_room(after, Reverse().apply(elements, world) if Reverse() in steps else elements)
    after = numbered(after)
    count = len(joined(after))
    if not 1 <= count <= MAX_SEGMENTS:
        raise UsageError(f"the road would have {count} segments")
    return after


def _rank(step: EditStep) -> tuple[int, float]:
    """Returns the order of a step: what changes more of the road comes first, so that a part keeps its own.
    Stations are those of the road before the edit, so steps that have any come before changes of length."""
    if not isinstance(step, SlopeOfAll):
        return 2, 0.0
    if step.stretch is None:
        return 0, -len(step.names)
    return 1, step.stretch.start - step.stretch.end


def _with_room(elements: RoadElements, before: RoadElements) -> RoadElements:
    """Returns the elements, with straights inserted between turns to the same side that are too close, unless
    the two already followed each other, to the same sides, before the edit."""
    known = {_pair(one, other) for one, other in pairwise(b for b in before if b.is_turn)}
    out: list[RoadElement] = []
    last: RoadElement | None = None
    metres = 0.0
    for element in elements:
        if element.is_turn:
            is_new = last is not None and last.side == element.side and _pair(last, element) not in known
            if is_new and metres < SEPARATE - 2:
                out.append(gap(f"room before {element.name}", round(SEPARATE - metres, 1), element.incline))
            last, metres = element, 0.0
        else:
            metres += element.length
        out.append(element)
    return tuple(out)


def _pair(one: RoadElement, other: RoadElement) -> tuple[str, Side | None, str, Side | None]:
    return one.name, one.side, other.name, other.side


def _started(
    design: Design, after: RoadElements, before: RoadElements, world: World, steps: Sequence[EditStep]
) -> Design:
    """Returns the design with the segments of the elements after the steps. A reversed road starts where the
    road ended, and heads the opposite way. If elements were added at the start, the start moves so that the
    rest of the road stays where it was."""
    segments = joined(after)
    if Reverse() in steps:
        road = build(design)
        x, y, z = (round(float(value), DECIMALS) for value in road.at(road.length))
        theta = degrees(float(road.heading(road.length)) + pi) % 360
        return Design(starting_point=(x, y, z), theta=round(theta, DECIMALS) % 360, segments=segments)
    x, y, z = design.starting_point
    if Mirror() in steps:
        start = world.site.map_size - x, y, z
        theta = (180 - design.theta) % 360
        return Design(starting_point=start, theta=round(theta, DECIMALS), segments=segments)
    old = {element.name for element in before}
    front = joined([*takewhile(lambda element: element.name not in old, after)])
    if not front:
        return design.model_copy(update={"segments": segments})
    lead = build(Design(starting_point=(0.0, 0.0, 0.0), theta=0.0, segments=front))
    end, turned = lead.at(lead.length), float(lead.heading(lead.length))
    heading = radians(design.theta) - turned
    far, way = hypot(end[0], end[1]), atan2(end[1], end[0]) + heading
    start = x - far * cos(way), y - far * sin(way), z - float(end[2])
    return Design(
        starting_point=(round(start[0], 2), round(start[1], 2), round(start[2], 2)),
        theta=round(degrees(heading) * HUNDREDTH) / HUNDREDTH % 360,
        segments=segments,
    )
