"""Repairs a proposed Design by the smallest change that makes it valid and meets its Brief.

    none   nothing is changed
    place  the road is moved, rotated only if that is not enough, and raised above the ground
    full   then lengths, angles, radii and grades are changed as little as necessary; the number of turns and
           the direction of each turn (left or right; up, down or level) stay as proposed

A road that cannot be repaired is at least placed on the map if possible; ``check.inspect`` says what is still
wrong with it. Main function: ``repair``.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations, islice
from math import inf
from typing import Literal, NamedTuple

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.brief.outline import Feature, Group, Outline, both, outline
from roadgpt.chat.model import Repair
from roadgpt.check.matching import Match, best_match, fits, sides_of
from roadgpt.check.measures import MeasuredFeature
from roadgpt.design.differences import changes_between
from roadgpt.design.fit import Requirements, fit
from roadgpt.design.road_elements import RoadElements, elements_as_proposed
from roadgpt.errors import UsageError
from roadgpt.road import Design, World

MOST_WAYS = 2000  # of assigning straights to requirements; further ways are not compared


class Repaired(NamedTuple):
    """A repaired Design, and sentences that say what was changed."""

    design: Design
    changes: tuple[str, ...]


def repair(design: Design, brief: Brief | None, world: World, how: Repair = "none") -> Repaired:
    """Returns the proposed design, made valid as far as ``how`` allows (see the top of this module)."""
    if how == "none":
        return Repaired(design, ())
    elements = elements_as_proposed(design.segments)
    ways = [(elements, Requirements(world))]
    if brief and how == "full":
        required = outline(brief, world.site.map_size)
        asked = with_requirements(elements, required)
        if asked:
            ways.insert(0, (asked, Requirements(world, required, brief)))
    frozen = {element.name for element in elements} if how == "place" else frozenset[str]()
    try:
        for own, requirements in ways:  # a road that meets the Brief, else one that is only valid
            after = fit(design, own, requirements, frozen)
            if after.keeps_all_but_slopes:
                break
    except (UsageError, ValueError, np.linalg.LinAlgError):  # no road can be built of such geometry
        return Repaired(design, ())
    return Repaired(after.design, changes_between(design, after.design))


Item = tuple[int, Feature]
"""The index of an element, and a requirement that it has to meet."""


def with_requirements(elements: RoadElements, required: Outline) -> RoadElements | None:
    """Returns the elements of a proposal, each with the requirement of the Outline that it has to meet.

    The elements are matched with the Outline so that as few of them as possible have to change. Returns None
    if the number of turns, or their sides, are not what the Outline requires.
    """
    turns = [i for i, element in enumerate(elements) if element.is_turn]
    sides = [elements[i].side for i in turns]
    left, right = sides.count("left"), sides.count("right")
    if len(turns) not in required.turns or left not in required.left or right not in required.right:
        return None
    marks = [-1, *turns, len(elements)]

    def of_turns(group: Group, first: int, number: int) -> Match[Item]:
        own = sides[first : first + number]
        musts = sides_of(group, own)
        if any(must not in (None, side) for must, side in zip(musts, own, strict=True)):
            return Match(inf)
        features = [replace(group.feature, side=must) for must in musts]
        return _matched(elements, list(zip(turns[first:], features, strict=False)))

    def of_gap(turn: int, wanted: Sequence[Feature]) -> Match[Item]:
        straights = [i for i in range(marks[turn] + 1, marks[turn + 1]) if not elements[i].degrees]
        if wanted and not straights:
            return Match(inf)
        return _matched(elements, list(zip(_answering(elements, straights, wanted), wanted, strict=True)))

    match = best_match(required, len(turns), of_turns, of_gap)
    ends = _ends(elements, turns, required)
    if match.wrong == inf or ends is None:
        return None
    asked: dict[int, Feature] = {}
    for index, feature in (*match.items, *((i, required.each_turn) for i in turns), *ends):
        asked[index] = both(asked[index], feature) if index in asked else feature
    return tuple(replace(element, asked=asked.get(i)) for i, element in enumerate(elements))


def _matched(elements: RoadElements, items: Sequence[Item]) -> Match[Item]:
    """Counts the requirements that the elements do not meet as they were proposed. The radius is not
    compared, since it often is not proposed.
    """
    wrong = len(items) - len({index for index, _ in items})
    for index, feature in items:
        one = elements[index]
        kind: Literal["turn", "straight"] = "turn" if one.is_turn else "straight"
        degrees, grade = abs(one.degrees), one.incline
        seen = MeasuredFeature(kind, 0.0, one.length, one.side, degrees, inf, grade, grade)
        wrong += not fits(seen, replace(feature, radius=None))
    return Match(wrong, tuple(items))


def _answering(elements: RoadElements, straights: Sequence[int], wanted: Sequence[Feature]) -> Sequence[int]:
    """Returns the straights that have to meet these requirements, chosen by the nearest slopes."""
    if len(wanted) >= len(straights):
        return [straights[min(i, len(straights) - 1)] for i in range(len(wanted))]
    ways = combinations(straights, len(wanted))

    def away(way: Sequence[int]) -> tuple[float, int]:
        pairs = [(elements[i].incline, feature.grade) for i, feature in zip(way, wanted, strict=True)]
        beyond = (max(grade.lo - incline, incline - grade.hi, 0.0) for incline, grade in pairs if grade)
        return sum(beyond), -sum(len(elements[i].segments) for i in way)

    return min(islice(ways, MOST_WAYS), key=away)


def _ends(elements: RoadElements, turns: Sequence[int], required: Outline) -> list[Item] | None:
    """Returns the requirements for the start and the end of the road, each with the index of its element.

    Returns None if the proposal starts or ends otherwise.
    """
    out: list[Item] = []
    for feature, end in ((required.starts, 0), (required.ends, -1)):
        if feature is None:
            continue
        among = turns if feature.kind == "turn" else range(len(elements))
        if not among:
            return None
        element = elements[among[end]]
        if bool(element.degrees) != (feature.kind == "turn") or feature.side not in (None, element.side):
            return None
        out.append((among[end], feature))
    return out
