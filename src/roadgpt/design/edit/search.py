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
from math import atan2, cos, degrees, hypot, radians, sin
from typing import NamedTuple

from roadgpt.brief.outline import Feature
from roadgpt.brief.words import LEAST_STRAIGHT, Range
from roadgpt.check.measures import Measures
from roadgpt.design.edit.candidates import alternating_candidates, change_candidates, is_beyond
from roadgpt.design.edit.combinations import NUMBERING, clash, is_hill
from roadgpt.design.edit.hills import hill_candidates
from roadgpt.design.edit.insertion import insertion_candidates, removal_candidates
from roadgpt.design.edit.placing import PlacedChange
from roadgpt.design.edit.reordering import Reverse, move_of, started_at_end, swap_of
from roadgpt.design.edit.request import Change, What
from roadgpt.design.edit.slope_of_all import SlopeOfAll
from roadgpt.design.edit.slopes import stretch_candidates
from roadgpt.design.edit.steps import Adjust, EditCandidate, EditStep, Mirror, RoadLength, with_room
from roadgpt.design.fit import Look, Requirements, fit
from roadgpt.design.road_elements import RoadElement, RoadElements, elements_on_road, joined, numbered
from roadgpt.errors import EditError, UsageError
from roadgpt.road import Design, Geometry, Segment, World, build
from roadgpt.road.design import MAX_SEGMENTS

MOST_TRIALS = 40
FITTED_WHOLE = 2  # trials that are fitted again with all elements free, if none is valid otherwise
LARGEST = 12  # candidates of one change that are combined with others
HUNDREDTH = 100.0
SLACK = 0.03  # share by which a measured value may miss a limit
SEEN_STRAIGHT = Feature("straight", "straight", length=Range(LEAST_STRAIGHT + 0.3))


class Made(NamedTuple):
    """The road with all changes of a request."""

    road: Look
    draft: Design
    """The design before any change to elements that the request does not name."""
    idle: tuple[Change, ...]
    """The changes that were not needed, because the road already was as requested."""


def made(
    design: Design,
    elements: RoadElements,
    found: Measures,
    changes: Sequence[PlacedChange],
    world: World,
    geometry: Geometry,
) -> Made:
    """Returns the road with all changes.

    Args:
        design: The road before the edit.
        elements: The elements of that road.
        found: The measurements of that road.
        changes: The changes, each with the elements that it refers to.
        world: Size of the map, and limits that the rules check, such as the steepest grade.
        geometry: The kind of geometry that roads are built with.

    Raises:
        EditError: The road already is as requested, or no valid road has the requested changes.
    """
    ways = [_ways(placed, elements, found, world, number) for number, placed in enumerate(changes, 1)]
    own = _without_what_is_so(changes, ways)
    ways = [
        its if placed is before else _ways(placed, elements, found, world, number)
        for number, (placed, before, its) in enumerate(zip(own, changes, ways, strict=True), 1)
    ]
    rows = [(placed.change, row) for placed, row in zip(changes, ways, strict=True) if row]
    limits = [placed for placed, row in zip(changes, ways, strict=True) if not row]
    idle = tuple(placed.change for placed in limits)
    if not rows:
        raise EditError(f"nothing is to be changed: '{idle[0].words}' is so already")
    road, objection, draft = _fitted(design, elements, _agreed(rows), world, geometry)
    if road is None:
        said = " and ".join(dict.fromkeys(f"'{change.words}'" for change, _ in rows))
        raise EditError(f"{said} cannot be done on this road: {objection}; ask for less, or elsewhere")
    if not any(change.what in NUMBERING for change, _ in rows):
        _refuse_broken_limits(limits, [each for each in changes if each not in limits], road, geometry)
    is_of_road = any(change.what in ("mirror", "reverse") for change, _ in rows)
    if road.design.segments == design.segments and not is_of_road:
        raise EditError(f"nothing is to be changed: '{rows[0][0].words}' is so already")
    return Made(road, draft, idle)


def _without_what_is_so(
    changes: Sequence[PlacedChange], ways: Sequence[Sequence[EditCandidate]]
) -> list[PlacedChange]:
    """Returns the changes; what already has the value that one of them asks for is left out of the others.

    "Everything uphill, the first straight level" leaves a level first straight alone.

    Raises:
        EditError: such a change names a stretch of the road by distances, or as a half.
    """
    idle = [change for change, its in zip(changes, ways, strict=True) if not its and _is_state(change.change)]
    out = []
    for change in changes:
        for other in idle if not _is_length_of_road(change.change) else ():
            if other.change.what != change.change.what or not {*other.elements} < {*change.elements}:
                continue
            if change.stretch is not None:
                raise clash(change.change, other.change)
            own = tuple(each for each in change.elements if each not in other.elements)
            change = change._replace(elements=own)
        out.append(change)
    return out


def _is_state(change: Change) -> bool:
    """Returns whether a change asks for one value or direction, and for no limit and no difference."""
    return not change.bound and not change.more and (change.to is not None or change.way is not None)


def _is_length_of_road(change: Change) -> bool:
    return change.what == "length" and change.target is not None and change.target.noun == "road"


def _refuse_broken_limits(
    idle: Sequence[PlacedChange], others: Sequence[PlacedChange], road: Look, geometry: Geometry
) -> None:
    """Checks that limits which the road kept before the edit are kept after it.

    Raises:
        EditError: another change of the request breaks such a limit.
    """
    for limit in idle:
        own = {element.name for element in limit.elements}
        for other in others:
            is_same = limit.change.bound and other.change.what == limit.change.what
            if not is_same or own.isdisjoint(element.name for element in other.elements):
                continue
            after, _ = elements_on_road(road.design, geometry)
            slack = replace(limit.change, to=(limit.change.to or 0) * (1 - SLACK * limit.change.bound))
            if any(is_beyond(slack, element) for element in after if element.name in own):
                raise clash(other.change, limit.change)


def _ways(
    placed: PlacedChange, elements: RoadElements, found: Measures, world: World, number: int
) -> tuple[EditCandidate, ...]:
    """Returns the candidates of one change, the preferred one first; none if the road already is so."""
    match placed.change.what:
        case "mirror":
            if not any(element.is_turn for element in elements):
                raise EditError("the road has no turn, so its mirror image is the same")
            return ((Mirror(),),)
        case "reverse":
            return ((Reverse(),),)
        case "swap":
            return ((swap_of(placed.elements),),)
        case "move":
            return move_of(placed, elements)
        case "count":
            return ()  # there are as many as asked for
        case "add" if is_hill(placed.change):
            return hill_candidates(placed, elements)
        case "add":
            return insertion_candidates(placed, elements, world, number)
        case "remove":
            return removal_candidates(placed.elements, elements)
        case "alternate":
            return alternating_candidates(placed.elements, world)
        case _ if placed.stretch is not None:
            return stretch_candidates(placed.change, elements, placed.stretch, world)
        case _:
            return change_candidates(placed.change, placed.elements, found, world)


def _agreed(rows: Sequence[tuple[Change, Sequence[EditCandidate]]]) -> list[Sequence[EditCandidate]]:
    """Returns the candidates of all changes.

    If one change gives the angle of a turn and another its radius, each sets only its own value.
    """
    said: dict[What, set[str]] = {"angle": set(), "radius": set()}
    for change, ways in rows:
        if change.what in said and (change.to or change.by or change.times):
            said[change.what] |= {step.element.name for step in ways[0] if isinstance(step, Adjust)}
    both = said["angle"] & said["radius"]

    def own(step: EditStep, what: What) -> EditStep:
        if not isinstance(step, Adjust) or step.element.name not in both or what not in said:
            return step
        return replace(step, radius=None) if what == "angle" else replace(step, degrees=None)

    return [[tuple(own(step, change.what) for step in way) for way in ways] for change, ways in rows]


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
            after = _applied(elements, steps, world)
            is_reversed = Reverse() in steps
            started = (
                started_at_end(design, joined(after))
                if is_reversed
                else _started(design, after, elements, world, Mirror() in steps)
            )
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


def _may_change(element: RoadElement) -> bool:
    """Returns whether the plan of an element may change: it has a requirement, and not only for its grade."""
    asked = element.asked
    return asked is not None and bool(asked.degrees or asked.radius or asked.length or not asked.grade)


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


def _started(
    design: Design, after: RoadElements, before: RoadElements, world: World, is_mirrored: bool
) -> Design:
    """Returns the design with the new segments.

    If elements were added at the start, the start moves so that the rest of the road stays where it was.
    """
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
