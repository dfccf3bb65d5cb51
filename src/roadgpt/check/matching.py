"""Matches the turns and straights of a measured road with those that an Outline requests.

Turns are matched one to one and in order. A requested straight matches either the whole straight between two
turns of the road, or a piece of it that goes up, is flat or goes down throughout. If several straights are
requested between two turns, they are matched with such pieces in order, each piece at most once. Requested
straights in a row that all go up, or all go down, with different grades may also be parts of one piece.
Finally, turns and straights that a description wants to be alike are compared with each other."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from itertools import chain, pairwise
from math import inf, isfinite
from typing import Generic, NamedTuple, TypeVar

from roadgpt.brief.model import OTHER_SIDE, Side
from roadgpt.brief.outline import Feature, Group, Outline, both
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import FEATURE
from roadgpt.check.measures import LEVEL, GradeChange, MeasuredFeature, Measures

T = TypeVar("T")
ANGLES = 6.0  # degrees by which the angles of like turns may differ
RATIO = 1.2  # of the largest radius or length of like parts to the smallest
METRES = 5.0  # by which the lengths of like straights may differ in any case
OPEN_TURN = Feature("turn", "turn")
Wanted = Sequence[Feature | None]


class Complaint(NamedTuple):
    """A requirement that the road does not meet: a sentence with the requested and the measured value.

    ``s`` is the station in metres; None if the requirement concerns the whole road."""

    sentence: str
    s: float | None = None
    on_heights: bool = False  # whether the requirement could be met by changing only the heights of the road


class Match(NamedTuple, Generic[T]):
    """A way to match the turns and straights of a road with an Outline, or with a part of it."""

    wrong: float = 0.0
    """The number of features that are not as requested; infinite if the match is impossible."""
    items: tuple[T, ...] = ()
    """The results for single features, of the type that the caller needs, such as complaints."""

    def plus(self, other: "Match[T]") -> "Match[T]":
        """Returns this match combined with the match of the following part of the road."""
        return Match(self.wrong + other.wrong, self.items + other.items)


def fits(stretch: MeasuredFeature, feature: Feature) -> bool:
    """Returns whether ``stretch``, a measured turn or straight, meets all requirements of ``feature``."""
    if stretch.kind != feature.kind or feature.side not in (None, stretch.side):
        return False
    wrong = _wrong(stretch, feature)
    return not wrong or (wrong == ["grade"] and _is_rounded_off(stretch, feature.grade))


def _wrong(stretch: MeasuredFeature, feature: Feature) -> list[str]:
    return [
        name for name in FEATURE if (asked := getattr(feature, name)) and getattr(stretch, name) not in asked
    ]


def _is_rounded_off(stretch: MeasuredFeature, asked: Range | None) -> bool:
    """Returns whether a straight is too gentle as a whole, but as steep as asked over its middle half."""
    if stretch.kind != "straight" or asked is None or stretch.inner_grade not in asked:
        return False
    least = asked.lo if asked.lo > 0 else -asked.hi if asked.hi < 0 else 0.0
    return 0 < least > abs(stretch.grade)


def turn_complaints(
    number: int, turn: MeasuredFeature, feature: Feature, side: str | None = None
) -> tuple[Complaint, ...]:
    """Returns one complaint for each requirement that a turn, counted from 1, does not meet. ``side`` is the
    required side if turns must alternate; None for the side that ``feature`` states."""
    side, out = side or feature.side, list[Complaint]()
    if side and turn.side != side:
        out.append(Complaint(f"turn {number} goes {turn.side}, asked for {side}", turn.start))
    for name in _wrong(turn, feature):
        row = FEATURE[name]
        measured, asked = row.measured.format(getattr(turn, name)), getattr(feature, name)
        text = f"turn {number} {measured}, asked for {asked}{row.unit}"
        out.append(Complaint(text, turn.start, row.on_heights))
    return tuple(out)


def best_match(
    asked: Outline,
    count: int,
    of_turns: Callable[[Group, int, int], Match[T]],
    of_gap: Callable[[int, tuple[Feature, ...]], Match[T]],
) -> Match[T]:
    """Returns the best match of a road of ``count`` turns with an Outline: the match with the fewest features
    that are not as requested.

    ``of_turns`` matches a group with turns of the road; its arguments are the group, the index of the first
    turn and the number of turns. ``of_gap`` matches requested straights with the gap before a turn; its
    arguments are the index of the turn (``count`` for the last gap) and the straights."""
    groups, turns_are_free = asked.groups, not asked.names_all_turns

    @cache
    def best(group: int, turn: int, wanted: tuple[Feature, ...]) -> Match[T]:
        """Returns the best match from this group on, with this turn next and these straights before it."""
        here = of_gap(turn, wanted)
        if group == len(groups):
            return here if turns_are_free or turn == count else Match(inf)
        ways = [here.plus(best(group, turn + 1, ()))] if turns_are_free and turn < count else []
        now = groups[group]
        if now.feature.kind == "straight":
            ways += [best(group + 1, turn, wanted + (now.feature,) * now.lo)]
            return min(ways, key=lambda match: match.wrong)
        if now.lo == 0:
            ways += [best(group + 1, turn, wanted)]
        most = count - turn if now.hi is None else min(now.hi, count - turn)
        for number in range(max(now.lo, 1), most + 1):
            own = of_turns(now, turn, number)
            ways.append(here.plus(own).plus(best(group + 1, turn + number, ())))
        return min(ways, key=lambda match: match.wrong, default=Match(inf))

    return best(0, 0, ()) if groups else Match()


def sequence_complaints(found: Measures, asked: Outline) -> tuple[Complaint, ...]:
    """Returns the Complaints about the turns and straights of an Outline, in driving order; the only one is
    about the number of turns if no match is possible."""
    turns, gaps = found.turns, found.gaps

    def of_turns(group: Group, first: int, number: int) -> Match[Complaint]:
        own = turns[first : first + number]
        sides = sides_of(group, [turn.side for turn in own])
        says = [
            turn_complaints(index, turn, group.feature, side)
            for index, (turn, side) in enumerate(zip(own, sides, strict=True), first + 1)
        ]
        return Match(sum(map(bool, says)), tuple(chain.from_iterable(says)))

    def of_gap(turn: int, wanted: tuple[Feature, ...]) -> Match[Complaint]:
        return _of_gap(found, gaps[turn], wanted, turn)

    match = best_match(asked, len(turns), of_turns, of_gap)
    if match.wrong == inf:
        return (Complaint(f"the {len(turns)} turns cannot be matched with what was asked for"),)
    return match.items


def sides_of(group: Group, sides: Sequence[Side | None]) -> list[Side | None]:
    """Returns the side that is required of each turn of a group; None if either side is allowed. ``sides``
    are the measured ones. If the turns must alternate and the group does not state the side of the first
    turn, its measured side is required."""
    first = group.feature.side or (sides[0] if sides and group.alternating else None)
    other = OTHER_SIDE[first] if first and group.alternating else first
    return [(first, other)[index % 2] for index in range(len(sides))]


def _of_gap(
    found: Measures, gap: tuple[MeasuredFeature, ...], wanted: tuple[Feature, ...], turn: int
) -> Match[Complaint]:
    if not wanted or (len(wanted) == 1 and any(fits(straight, wanted[0]) for straight in gap)):
        return Match()
    pieces = [piece for straight in gap for piece in straight.pieces]
    at, missing = 0, list[Feature]()
    for ramp in _ramps(wanted):
        whole = next((i for i in range(at, len(pieces)) if _fit(found, pieces[i], ramp)), None)
        if whole is not None:
            at = whole + 1
            continue
        for wish in ramp:
            place = next((i for i in range(at, len(pieces)) if fits(pieces[i], wish)), None)
            if place is None:
                missing.append(wish)
            else:
                at = place + 1
    where = f"after turn {turn}" if turn else "at the start"
    s = gap[0].start if gap else None
    pieces_told = (f"{each.length:.0f} m at {each.grade:.1f} %" for each in (gap[0].pieces if gap else ()))
    has = ", then ".join(pieces_told) if gap else "none"
    says = (
        Complaint(f"asked for a straight {where}{wish.limits()}, has {has}", s, wish.grade is not None)
        for wish in missing
    )
    return Match(len(missing), tuple(says))


def _ramps(wanted: tuple[Feature, ...]) -> list[list[Feature]]:
    out = [[wanted[0]]]
    for one, other in pairwise(wanted):
        if change_of_grade(one.grade, other.grade) is None:
            out.append([])
        out[-1].append(other)
    return out


def _fit(found: Measures, piece: MeasuredFeature, ramp: Sequence[Feature]) -> bool:
    if len(ramp) == 1:
        return fits(piece, ramp[0])
    changes = [change_of_grade(one.grade, other.grade) for one, other in pairwise(ramp)]
    parts = found.cut(piece, [change for change in changes if change is not None])
    return len(parts) == len(ramp) and all(map(fits, parts, ramp))


def change_of_grade(one: Range | None, other: Range | None) -> GradeChange | None:
    """Returns the change of grade between two straights in a row that both go up, or both go down, with
    different grades; None for all other straights."""
    if one is None or other is None:
        return None
    if min(one.lo, other.lo) < LEVEL and max(one.hi, other.hi) > -LEVEL:
        return None
    grade = (one.usual + other.usual) / 2
    return (
        GradeChange(grade, one.usual < other.usual) if one.usual != other.usual and isfinite(grade) else None
    )


class LikeGroup(list[int]):
    """The indices of features that must be alike; all features must meet the ranges in ``common``."""

    def __init__(self, common: Feature, place: int) -> None:
        super().__init__([place])
        self.common = common


def like_groups(features: Wanted) -> list[LikeGroup]:
    """Returns the groups of two or more features that must be alike: those that have the same name and whose
    ranges overlap. A None in ``features`` belongs to no group."""
    groups: list[LikeGroup] = []
    for place, feature in enumerate(features):
        if feature is None:
            continue
        for group in groups:
            common = _common(group.common, feature)
            if common is not None:
                group.append(place)
                group.common = common
                break
        else:
            groups.append(LikeGroup(feature, place))
    return [group for group in groups if len(group) > 1]


def _common(one: Feature, other: Feature) -> Feature | None:
    if (one.kind, one.name) != (other.kind, other.name):
        return None
    degrees, radius, length = (
        overlap(getattr(one, name), getattr(other, name)) for name in ("degrees", "radius", "length")
    )
    if any(span is not None and span.lo >= span.hi for span in (degrees, radius, length)):
        return None
    return replace(one, degrees=degrees, radius=radius, length=length)


def like_straights(gaps: Sequence[Sequence[Feature]]) -> list[LikeGroup]:
    """Groups the gaps before, between and after the turns whose straights must be equally long. Gaps with
    exactly one required straight are grouped by ``like_groups``. If no straight is required between the
    turns, all gaps between turns are one group, whose ``common`` has no length."""
    groups = like_groups([gap[0] if len(gap) == 1 else None for gap in gaps])
    inner = range(1, len(gaps) - 1)
    if len(inner) < 2 or any(gaps[place] for place in inner):
        return groups
    even = LikeGroup(Feature("straight", "straight"), inner[0])
    even.extend(inner[1:])
    return [*groups, even]


def likeness_complaints(found: Measures, asked: Outline) -> Iterator[Complaint]:
    """Yields a complaint for each group of turns or straights that should be alike and is not. If the number
    of turns is open, a road is compared only if all required turns have one name and no straight is required.
    """
    wanted = _wanted(asked, len(found.turns))
    if wanted is None:
        return
    turns, gaps = wanted
    for group in like_groups(turns):
        alike = [found.turns[place] for place in group]
        angles, radii = [turn.degrees for turn in alike], [turn.radius for turn in alike]
        if max(angles) - min(angles) > ANGLES:
            text = f"asked for turns alike, they turn {min(angles):.0f} to {max(angles):.0f} degrees"
            yield Complaint(text, alike[0].start)
        if max(radii) > RATIO * min(radii):
            text = f"asked for turns alike, their radii are {min(radii):.0f} to {max(radii):.0f} m"
            yield Complaint(text, alike[0].start)
    for group in like_straights(gaps):
        lengths = [max((straight.length for straight in found.gaps[place]), default=0.0) for place in group]
        if max(lengths) - min(lengths) > max(METRES, (RATIO - 1) * min(lengths)):
            yield Complaint(
                f"asked for straights alike, they have {min(lengths):.0f} to {max(lengths):.0f} m"
            )


def _wanted(asked: Outline, count: int) -> tuple[list[Feature], list[list[Feature]]] | None:
    """Returns the required turns, and the straights required in each gap; None if it is not known which turn
    is which."""
    turns: list[Feature] = []
    gaps: list[list[Feature]] = [[]]
    for group in asked.groups:
        for _ in range(group.lo):
            if group.feature.kind == "straight":
                gaps[-1].append(group.feature)
            else:
                turns.append(group.feature)
                gaps.append([])
    if not turns and not gaps[0]:
        turns, gaps = [OPEN_TURN] * count, [[] for _ in range(count + 1)]
    if len(turns) != count:
        kinds = {turn.name for turn in turns}
        if len(kinds) != 1 or any(gaps) or len(like_groups(turns)) > 1:
            return None
        turns, gaps = turns[:1] * count, [[] for _ in range(count + 1)]
    for end, place in ((asked.starts, 0), (asked.ends, -1)):
        if end is not None and end.kind == "turn" and turns:
            turns[place] = both(turns[place], end)
        elif end is not None and end.kind == "straight":
            gaps[place] = [both(gaps[place][0], end)] if len(gaps[place]) == 1 else [*gaps[place], end]
    return turns, gaps
