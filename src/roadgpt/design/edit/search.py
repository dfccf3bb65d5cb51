"""Makes all changes of a request at once. Main function: ``made``.

The steps of the changes are applied to the elements of the road. Then ``design.fit`` changes the elements
that the request names until the road is valid and its measurements are as requested; all other elements are
frozen. If that fails, the other elements of a road of arcs may change as well. The start stays the same,
unless the road would leave the map: then the road is shifted or rotated.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice, pairwise, product
from math import atan2, cos, degrees, hypot, radians, sin

from roadgpt.brief.model import Side
from roadgpt.brief.outline import Feature
from roadgpt.brief.words import LEAST_STRAIGHT, Range
from roadgpt.design.edit.steps import SEPARATE, EditCandidate, EditStep, Mirror, RoadLength, gap
from roadgpt.design.fit import Look, Requirements, fit
from roadgpt.design.road_elements import RoadElement, RoadElements, joined, numbered
from roadgpt.errors import UsageError
from roadgpt.road import Design, Geometry, Segment, World, build
from roadgpt.road.design import MAX_SEGMENTS

MOST_TRIALS = 40
FITTED_WHOLE = 2  # trials of which all elements are fitted, where no trial is valid with the others frozen
LARGEST = 12  # candidates of one change that are combined with others
HUNDREDTH = 100.0
SEEN_STRAIGHT = Feature("straight", "straight", length=Range(LEAST_STRAIGHT + 0.3))


def made(
    design: Design,
    elements: RoadElements,
    changes: Sequence[Sequence[EditCandidate]],
    world: World,
    geometry: Geometry,
) -> tuple[Look | None, str, Design]:
    """Returns the road with all changes, an objection, and a design.

    If no valid road was found, the road is None, the objection says what was wrong with the first road that
    was tried, and the design is the one before the edit. Otherwise the objection is empty, and the design is
    that of the road. If elements that the request does not name had to change too, it is the design before
    these additional changes.

    Args:
        design: The road before the edit.
        elements: The elements of that road.
        changes: The candidates of every change, the preferred one first.
        world: Size of the map, and limits that the rules check, such as the steepest grade.
        geometry: The kind of geometry that roads are built with.
    """
    objection, drafts = "", list[Look]()
    for steps in islice(_combined(changes), MOST_TRIALS):
        try:
            after = _applied(elements, steps, world)
            started = _started(design, after, elements, world, Mirror() in steps)
            frozen = {element.name for element in after if not _may_change(element)}
            trial = fit(started, after, _requirements(steps, design, world, geometry), frozen)
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
    """The elements, of which straights that were seen between two turns are to be seen afterwards."""
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
    """Ways of all changes together, those nearest to the preferred ones first."""
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


def _may_change(element: RoadElement) -> bool:
    """Was the plan of an element spoken of? Then something is asked of it, and not of its grade alone."""
    asked = element.asked
    return asked is not None and bool(asked.degrees or asked.radius or asked.length or not asked.grade)


def _applied(elements: RoadElements, steps: Sequence[EditStep], world: World) -> RoadElements:
    """The elements after all steps.

    Raises:
        UsageError: There would be none left, or too many.
    """
    after = elements
    for step in steps:
        after = step.apply(after, world)
    after = numbered(_with_room(after, elements))
    count = len(joined(after))
    if not 1 <= count <= MAX_SEGMENTS:
        raise UsageError(f"the road would have {count} segments")
    return after


def _with_room(elements: RoadElements, before: RoadElements) -> RoadElements:
    """The elements with straights between new neighbours of one hand, so that two turns are seen.

    Turns that were neighbours before, on the same sides, are two already.
    """
    known = {_pair(one, other) for one, other in pairwise(b for b in before if b.kind == "turn")}
    out: list[RoadElement] = []
    last: RoadElement | None = None
    metres = 0.0
    for element in elements:
        if element.kind == "turn":
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
    design: Design, after: RoadElements, before: RoadElements, world: World, is_mirrored: bool
) -> Design:
    """The design with other segments; where something new stands in front, the rest stays where it was."""
    segments = joined(after)
    x, y, z = design.starting_point
    if is_mirrored:
        theta = (180 - design.theta) % 360
        return Design(
            starting_point=(world.site.map_size - x, y, z), theta=round(theta, 6), segments=segments
        )
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
