"""Repairs a proposed Design by the smallest change that makes it valid and meets its Brief.

    none   nothing is changed
    place  the road is moved, rotated only if that is not enough, and raised above the ground
    full   then lengths, angles, radii and grades are changed as little as necessary; the number of turns,
           their sides, and whether they go up, down or level stay as proposed

A road that cannot be repaired is at least placed on the map if possible; ``check.inspect`` says what is still
wrong with it. Main function: ``repair``.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations, islice, pairwise
from typing import Literal, NamedTuple

import numpy as np

from roadgpt.brief.model import OTHER_SIDE, Brief
from roadgpt.brief.outline import Feature, Group, Outline
from roadgpt.brief.words import Range
from roadgpt.check.rules.promises import promises_of
from roadgpt.design.fit import Look, Requirements, fit, look
from roadgpt.design.road_elements import RoadElement, RoadElements, elements_as_proposed
from roadgpt.design.sequence import both
from roadgpt.errors import UsageError
from roadgpt.road import Design, Segment, World

How = Literal["none", "place", "full"]
MOST_WAYS = 2000  # of letting straights answer wishes that are looked at
FREE_TURN = Feature("turn", "turn")
ALL_LISTED = 60  # changed segments; of more, only the number is given


class Repaired(NamedTuple):
    """A repaired Design, and sentences that say what was changed."""

    design: Design
    changes: tuple[str, ...]


def repair(design: Design, brief: Brief | None, world: World, how: How = "none") -> Repaired:
    """Returns the proposed design, made valid as far as ``how`` allows.

    Args:
        design: The design as proposed.
        brief: The requirements; None if there are none.
        world: Size of the map, and limits that the rules check, such as the steepest grade.
        how: "none", "place" or "full", as described at the top of this module.
    """
    if how == "none":
        return Repaired(design, ())
    elements = elements_as_proposed(design.segments)
    valid = Requirements(world)
    try:
        after = _fitted(design, elements, brief, valid) if how == "full" else look(design, elements, valid)
    except (UsageError, ValueError, np.linalg.LinAlgError):  # no road can be built of such geometry
        return Repaired(design, ())
    return Repaired(after.design, changes_between(design, after.design))


def _fitted(design: Design, elements: RoadElements, brief: Brief | None, valid: Requirements) -> Look:
    """The road that meets its Brief; one that is only valid where it cannot, or has other turns."""
    if brief:
        outline = promises_of(brief, valid.world)
        asked = with_wishes(elements, outline)
        if asked:
            found = fit(design, asked, valid._replace(outline=outline, brief=brief))
            if found.keeps_all_but_slopes:
                return found
    return fit(design, elements, valid)


def changes_between(before: Design, after: Design) -> tuple[str, ...]:
    """Returns one sentence each for a changed start, a changed heading and each changed segment.

    Both designs must have the same number of segments. If more than 60 segments changed, one sentence gives
    their number.
    """
    out = list(_placing(before, after))
    pairs = zip(before.segments, after.segments, strict=True)
    told = [said for number, (one, other) in enumerate(pairs, 1) if (said := _segment(number, one, other))]
    if len(told) > ALL_LISTED:
        return (*out, f"{len(told)} segments changed")
    return (*out, *told)


def _placing(before: Design, after: Design) -> Iterator[str]:
    (x, y, z), (x1, y1, z1) = before.starting_point, after.starting_point
    if (x, y) != (x1, y1):
        yield f"start moved from ({x:g}, {y:g}) to ({x1:g}, {y1:g})"
    if z != z1:
        yield f"start raised from {z:g} to {z1:g} m" if z1 > z else f"start lowered from {z:g} to {z1:g} m"
    turned = (after.theta - before.theta + 180) % 360 - 180
    if abs(turned) > 1e-9:
        yield f"turned by {turned:+.4g} degrees, theta {before.theta:g} -> {after.theta:g}"


def _segment(number: int, before: Segment, after: Segment) -> str:
    said = []
    if after.distance != before.distance:
        said.append(f"distance {before.distance:g} -> {after.distance:g} m")
    if after.turn_degrees != before.turn_degrees:
        said.append(f"turn {before.turn_degrees:g} -> {after.turn_degrees:g} degrees")
    if after.incline != before.incline:
        said.append(f"grade {before.incline:g} -> {after.incline:g} %")
    for name in ("radius", "transition", "vertical_radius"):
        one, other = getattr(before, name), getattr(after, name)
        if one != other:
            said.append(f"{name.replace('_', ' ')} {_metres(one)} -> {_metres(other)}")
    return f"segment {number}: {', '.join(said)}" if said else ""


def _metres(value: float | None) -> str:
    return "open" if value is None else f"{value:g} m"


def with_wishes(elements: Sequence[RoadElement], outline: Outline) -> RoadElements | None:
    """Returns the elements of a proposal, each with the requirement of the Outline that it has to meet.

    Returns None if the number of turns, or of turns to one side, is not what the Outline requires.
    """
    turns = [i for i, element in enumerate(elements) if element.is_turn]
    left = sum(elements[i].side == "left" for i in turns)
    if len(turns) not in outline.turns or left not in outline.left or len(turns) - left not in outline.right:
        return None
    for rows in _shared_out(outline, len(turns)):
        out = _matched(elements, turns, rows, outline)
        if out is not None:
            return tuple(replace(element, asked=wish) for element, wish in zip(elements, out, strict=True))
    return None


Row = tuple[list[Feature], list[list[Feature]]]
"""Features of the turns, and the straights wanted before each of them and after the last."""


def _shared_out(outline: Outline, count: int) -> Iterator[Row]:
    """The ways in which so many turns can answer the groups."""
    if outline.names_all_turns:
        yield from _in_order(outline.groups, count, [], [[]])
        return
    straights = [group.feature for group in outline.groups for _ in range(group.lo)]
    for before in range(count + 1):  # all of them in one place, or one after the other from there on
        gaps: list[list[Feature]] = [[] for _ in range(count + 1)]
        for number, straight in enumerate(straights):
            gaps[min(before + number, count)].append(straight)
        yield [FREE_TURN] * count, gaps


def _in_order(
    groups: Sequence[Group], count: int, turns: list[Feature], gaps: list[list[Feature]]
) -> Iterator[Row]:
    if not groups:
        if len(turns) == count:
            yield turns, gaps
        return
    group, rest = groups[0], groups[1:]
    if group.feature.kind == "straight":
        yield from _in_order(rest, count, turns, [*gaps[:-1], gaps[-1] + [group.feature] * group.lo])
        return
    room = count - len(turns)
    for many in range(group.lo, min(room, room if group.hi is None else group.hi) + 1):
        own = [group.feature] * many
        if group.alternating and group.feature.side:
            sides = [group.feature.side, OTHER_SIDE[group.feature.side]]
            own = [_sided(group.feature, sides[i % 2]) for i in range(many)]
        yield from _in_order(rest, count, turns + own, gaps + [[] for _ in range(many)])


def _sided(feature: Feature, side: str) -> Feature:
    return both(Feature("turn", feature.name, side="left" if side == "left" else "right"), feature)


def _answering(
    elements: Sequence[RoadElement], straights: Sequence[int], wanted: Sequence[Feature]
) -> Sequence[int]:
    """Which straights answer the wishes, in order: those whose slopes are nearest to what was asked."""
    if len(wanted) >= len(straights):
        return [straights[min(i, len(straights) - 1)] for i in range(len(wanted))]
    ways = combinations(straights, len(wanted))

    def away(way: Sequence[int]) -> tuple[float, int]:
        slopes = [_beyond(elements[i].incline, wish.grade) for i, wish in zip(way, wanted, strict=True)]
        return sum(slopes), -sum(len(elements[i].segments) for i in way)

    return min(islice(ways, MOST_WAYS), key=away)


def _beyond(incline: float, asked: Range | None) -> float:
    return max(asked.lo - incline, incline - asked.hi, 0.0) if asked else 0.0


def _matched(
    elements: Sequence[RoadElement], turns: Sequence[int], row: Row, outline: Outline
) -> tuple[Feature | None, ...] | None:
    features, gaps = row
    out: list[Feature | None] = [None] * len(elements)
    for index, feature in zip(turns, features, strict=True):
        if feature.side not in (None, elements[index].side):
            return None
        out[index] = both(feature, outline.each_turn)
    marks = [-1, *turns, len(elements)]
    for (a, b), wanted in zip(pairwise(marks), gaps, strict=True):
        straights = [i for i in range(a + 1, b) if not elements[i].degrees]
        if wanted and not straights:
            return None
        for index, wish in zip(_answering(elements, straights, wanted), wanted, strict=False):
            before = out[index]
            out[index] = both(before, wish) if before else wish
    return tuple(out) if _with_ends(elements, turns, outline, out) else None


def _with_ends(
    elements: Sequence[RoadElement], turns: Sequence[int], outline: Outline, out: list[Feature | None]
) -> bool:
    """Adds what the road must start and end with; False where the proposal does otherwise."""
    for wish, end in ((outline.starts, 0), (outline.ends, -1)):
        if wish is None:
            continue
        among = turns if wish.kind == "turn" else range(len(elements))
        if not among:
            return False
        element, before = elements[among[end]], out[among[end]]
        if bool(element.degrees) != (wish.kind == "turn") or wish.side not in (None, element.side):
            return False
        out[among[end]] = both(before, wish) if before else wish
    return True
