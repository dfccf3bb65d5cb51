"""Which element of a proposal answers which wish of the Brief."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations, islice, pairwise

from roadgpt.brief.model import OTHER_SIDE
from roadgpt.brief.outline import Feature, Group, Outline
from roadgpt.brief.words import Range
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.design.sequence import both

MOST_WAYS = 2000  # of letting straights answer wishes that are looked at
FREE_TURN = Feature("turn", "turn")


def with_wishes(elements: Sequence[RoadElement], outline: Outline) -> RoadElements | None:
    """Returns the elements of a proposal, each with what was asked of it.

    Returns None where the proposal has not the turns that were asked for.
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
