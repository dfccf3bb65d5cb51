"""Matches the turns and straights of a measured road with those that an Outline requests.

Turns are matched one to one and in order. A requested straight matches either the whole straight between two
turns of the road, or a piece of that straight with a uniform class of grade (up, flat or down). If several
straights are requested between two turns, they are matched with such pieces in order, each piece at most
once.
"""

from functools import cache
from math import inf
from typing import NamedTuple

from roadgpt.brief.outline import Feature, Group, Outline
from roadgpt.brief.quantities import FEATURE
from roadgpt.brief.words import Range
from roadgpt.check.measures import MeasuredFeature, Measures


class Complaint(NamedTuple):
    """A requirement that the road does not meet: a sentence with the requested and the measured value.

    ``s`` is the station in metres; None if the requirement concerns the whole road."""

    sentence: str
    s: float | None = None
    on_heights: bool = False
    """Whether the requirement could be met by changing only the heights of the road."""


class _Cost(NamedTuple):
    """The number of wrong features of the best match of turns, and the complaints about them."""

    wrong: float
    says: tuple[Complaint, ...]

    def plus(self, other: "_Cost") -> "_Cost":
        return _Cost(self.wrong + other.wrong, self.says + other.says)


RIGHT = _Cost(0.0, ())
IMPOSSIBLE = _Cost(inf, ())


def fits(stretch: MeasuredFeature, feature: Feature) -> bool:
    """Returns whether a measured turn or straight meets all requirements for the requested one."""
    if stretch.kind != feature.kind or feature.side not in (None, stretch.side):
        return False
    wrong = _wrong(stretch, feature)
    return not wrong or (wrong == ["grade"] and _is_rounded_off(stretch, feature.grade))


def _wrong(stretch: MeasuredFeature, feature: Feature) -> list[str]:
    """Returns the names of the quantities that are outside of the required ranges."""
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
    """Returns one complaint for each requirement that a turn does not meet.

    Args:
        number: Number of the turn, from 1.
        turn: The measured turn.
        feature: The requested turn.
        side: the required side ("left" or "right") if turns must alternate; None to require the side that
            ``feature`` states.
    """
    side, out = side or feature.side, list[Complaint]()
    if side and turn.side != side:
        out.append(Complaint(f"turn {number} goes {turn.side}, asked for {side}", turn.start))
    for name in _wrong(turn, feature):
        row = FEATURE[name]
        measured, asked = row.measured.format(getattr(turn, name)), getattr(feature, name)
        text = f"turn {number} {measured}, asked for {asked}{row.unit}"
        out.append(Complaint(text, turn.start, row.on_heights))
    return tuple(out)


def sequence_complaints(found: Measures, asked: Outline) -> tuple[Complaint, ...]:
    """Returns the complaints about the turns and straights of a road, compared in driving order.

    Of all ways to match measured with requested features, the one with the fewest mismatches is used."""
    turns, gaps, groups = found.turns, found.gaps, asked.groups
    turns_are_free = not asked.names_all_turns

    @cache
    def best(group: int, turn: int, wanted: tuple[Feature, ...]) -> _Cost:
        """Returns the least cost from this group on, with this turn next and these straights before it."""
        here = _gap_cost(gaps[turn], wanted, turn)
        if group == len(groups):
            return here if turns_are_free or turn == len(turns) else IMPOSSIBLE
        ways = [here.plus(best(group, turn + 1, ()))] if turns_are_free and turn < len(turns) else []
        now = groups[group]
        if now.feature.kind == "straight":
            ways += [best(group + 1, turn, wanted + (now.feature,) * now.lo)]
            return min(ways, key=lambda cost: cost.wrong)
        if now.lo == 0:
            ways += [best(group + 1, turn, wanted)]
        most = len(turns) - turn if now.hi is None else min(now.hi, len(turns) - turn)
        for count in range(max(now.lo, 1), most + 1):
            own = _group_cost(now, turns[turn : turn + count], turn + 1)
            ways.append(here.plus(own).plus(best(group + 1, turn + count, ())))
        return min(ways, key=lambda cost: cost.wrong, default=IMPOSSIBLE)

    cost = best(0, 0, ()) if groups else RIGHT
    if cost.wrong == inf:
        return (Complaint(f"the {len(turns)} turns cannot be matched with what was asked for"),)
    return cost.says


def _group_cost(group: Group, turns: tuple[MeasuredFeature, ...], first: int) -> _Cost:
    says: list[Complaint] = []
    wrong = 0
    side: str | None = None
    for number, turn in enumerate(turns, first):
        if group.alternating:
            side = {"left": "right", "right": "left"}[side] if side else group.feature.side or turn.side
        own = turn_complaints(number, turn, group.feature, side)
        wrong += bool(own)
        says += own
    return _Cost(wrong, tuple(says))


def _gap_cost(gap: tuple[MeasuredFeature, ...], wanted: tuple[Feature, ...], turn: int) -> _Cost:
    """Returns the cost of matching the wanted straights with the pieces before a turn (counted from 0)."""
    if not wanted or (len(wanted) == 1 and any(fits(straight, wanted[0]) for straight in gap)):
        return RIGHT
    pieces = [piece for straight in gap for piece in straight.pieces]
    at, missing = 0, list[Feature]()
    for wish in wanted:
        found = next((i for i in range(at, len(pieces)) if fits(pieces[i], wish)), None)
        if found is None:
            missing.append(wish)
        else:
            at = found + 1
    where = f"after turn {turn}" if turn else "at the start"
    s = gap[0].start if gap else None
    has = _said(gap[0].pieces) if gap else "none"
    return _Cost(
        len(missing),
        tuple(
            Complaint(f"asked for a straight {where}{wish.limits()}, has {has}", s, wish.grade is not None)
            for wish in missing
        ),
    )


def _said(pieces: tuple[MeasuredFeature, ...]) -> str:
    return ", then ".join(f"{piece.length:.0f} m at {piece.grade:.1f} %" for piece in pieces)


__all__ = ["Complaint", "fits", "sequence_complaints", "turn_complaints"]
