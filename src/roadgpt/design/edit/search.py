"""Makes all changes of a request at once. Main function: ``made``.

Each change has one or more candidates. Combinations of one candidate of each change are tried, those of
preferred candidates first. The steps of the candidates are applied to the elements of the road. Then
``design.fit`` changes the elements that the request names until the road is valid and its measurements are as
requested; all other elements are frozen. If that fails and the geometry is ``arcs``, the other elements may
change as well. The start stays the same, unless the road would leave the map: then the road is shifted or
rotated.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice, product
from typing import NamedTuple

from roadgpt.brief.change.clashes import clash
from roadgpt.brief.change.request import NUMBERING
from roadgpt.brief.outline import Feature
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import LEAST_STRAIGHT
from roadgpt.design.edit.candidates import ChangeCandidates, is_beyond
from roadgpt.design.edit.reordering import Reverse
from roadgpt.design.edit.slopes import SlopeOfAll
from roadgpt.design.edit.steps import (
    EditCandidate,
    EditStep,
    Mirror,
    RoadLength,
    started,
    with_room,
)
from roadgpt.design.fit import Look, Requirements, fit
from roadgpt.design.road_elements import RoadElements, elements_on_road, joined, numbered
from roadgpt.errors import EditError, IdleEditError, UsageError
from roadgpt.road import Design, Geometry, World
from roadgpt.road.design import MAX_SEGMENTS

MOST_TRIALS = 40
FITTED_WHOLE = 2  # trials that are fitted again with all elements free, if none is valid otherwise
LARGEST = 12  # candidates of one change that are combined with others
SLACK = 0.03  # share by which a measured value may miss a limit
SEEN_STRAIGHT = Feature("straight", "straight", length=Range(LEAST_STRAIGHT + 0.3))


class Made(NamedTuple):
    """The road with all changes of a request."""

    road: Look
    draft: Design
    """The design before any change to elements that the request does not name."""


def made(
    design: Design,
    elements: RoadElements,
    changes: Sequence[ChangeCandidates],
    world: World,
    geometry: Geometry,
) -> Made:
    """Returns the road with all changes.

    Args:
        design: The road before the edit.
        elements: The elements of that road.
        changes: The changes, each with its candidates; one without candidates is not needed.
        world: Size of the map, and limits that the rules check, such as the steepest grade.
        geometry: The kind of geometry that roads are built with.

    Raises:
        EditError: The road already is as requested, or no valid road has the requested changes.
    """
    needed = [each for each in changes if each.ways]
    idle = [each for each in changes if not each.ways]
    if not needed:
        raise IdleEditError(f"nothing is to be changed: '{idle[0].change.words}' is so already")
    road, objection, draft = _fitted(design, elements, [each.ways for each in needed], world, geometry)
    if road is None:
        said = " and ".join(dict.fromkeys(f"'{each.change.words}'" for each in needed))
        raise EditError(f"{said} cannot be done on this road: {objection}; ask for less, or elsewhere")
    if idle and not any(each.change.what in NUMBERING for each in needed):
        _refuse_broken_limits(idle, needed, road, geometry)
    is_of_road = any(each.change.what in ("mirror", "reverse") for each in needed)
    if road.design.segments == design.segments and not is_of_road:
        raise IdleEditError(f"nothing is to be changed: '{needed[0].change.words}' is so already")
    return Made(road, draft)


def _refuse_broken_limits(
    idle: Sequence[ChangeCandidates], needed: Sequence[ChangeCandidates], road: Look, geometry: Geometry
) -> None:
    """Checks that limits which the road kept before the edit are kept after it.

    Raises:
        EditError: another change of the request breaks such a limit.
    """
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
    changes: Sequence[Sequence[EditCandidate]],
    world: World,
    geometry: Geometry,
) -> tuple[Look | None, str, Design]:
    """Returns the road with all changes, an empty text, and the design before other elements had to change.

    If no valid road was found, the road is None, and the text says what was wrong with the first one tried.
    """
    objection, drafts = "", list[Look]()
    for steps in islice(_combined(changes), MOST_TRIALS):
        try:
            needs = _requirements(steps, design, world, geometry)
            after = _applied(elements, steps, world)
            begun = started(design, after, elements, world, Mirror() in steps, Reverse() in steps)
            frozen = {element.name for element in after if not element.may_bend}
            trial = fit(begun, after, needs, frozen)
        except UsageError as error:
            objection = objection or str(error)
            continue
        if not trial.objection:
            return trial, "", trial.design
        objection = objection or trial.objection
        drafts.append(trial)
    for draft in drafts[:FITTED_WHOLE] if geometry == "arcs" else ():
        whole = fit(draft.design, _staying(draft.elements), draft.requirements._replace(before=None))
        if not whole.objection:
            return whole, "", draft.design
    return None, objection, design


def _staying(elements: RoadElements) -> RoadElements:
    """Returns the elements; a straight that was measured between two turns must be measured again."""
    own = [element for element in elements if element.segments]
    kinds = ["turn", *(element.kind for element in own), "turn"]
    beside = dict(zip((element.name for element in own), zip(kinds, kinds[2:], strict=False), strict=True))
    return tuple(
        replace(element, asked=element.asked or SEEN_STRAIGHT)
        if element.seen and not element.is_turn and beside.get(element.name) == ("turn", "turn")
        else element
        for element in elements
    )


def _combined(changes: Sequence[Sequence[EditCandidate]]) -> Iterator[tuple[EditStep, ...]]:
    """Yields combinations of one candidate of each change, the most preferred combinations first."""
    some = [list(ways)[: LARGEST if len(changes) > 1 else None] for ways in changes]
    rows = product(*(range(len(ways)) for ways in some))
    for row in sorted(rows, key=lambda r: (sum(r), max(r, default=0), r)):
        yield tuple(step for ways, index in zip(some, row, strict=True) for step in ways[index])


def _requirements(
    steps: Sequence[EditStep], before: Design, world: World, geometry: Geometry
) -> Requirements:
    length = next((step.room for step in reversed(steps) if isinstance(step, RoadLength)), None)
    needs = Requirements(world, before=before, geometry=geometry)
    return needs._replace(outline=replace(needs.outline, length=length))


def _applied(elements: RoadElements, steps: Sequence[EditStep], world: World) -> RoadElements:
    """Returns the elements after all steps.

    Raises:
        UsageError: The road would have no segment, or too many.
    """
    after = elements
    for step in sorted(steps, key=_rank):
        after = step.apply(after, world)
    after = with_room(after, Reverse().apply(elements, world) if Reverse() in steps else elements)
    after = numbered(after)
    count = len(joined(after))
    if not 1 <= count <= MAX_SEGMENTS:
        raise UsageError(f"the road would have {count} segments")
    return after


def _rank(step: EditStep) -> tuple[int, float]:
    """Returns the order of a step: what changes more of the road comes first, so that a part keeps its own.

    Stations are those of the road before the edit, so steps that have any come before changes of length.
    """
    if not isinstance(step, SlopeOfAll):
        return 2, 0.0
    if step.stretch is None:
        return 0, -len(step.names)
    return 1, step.stretch.start - step.stretch.end
