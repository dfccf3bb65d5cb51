"""Chooses the sequence of a draft at random: its left and right turns, and the required straights."""

from collections.abc import Sequence
from dataclasses import replace
from math import ceil, inf
from typing import NamedTuple

import numpy as np

from roadgpt.brief.model import OTHER_SIDE, Side
from roadgpt.brief.outline import Feature, Outline, both
from roadgpt.brief.ranges import Range, overlap
from roadgpt.errors import DesignError

HAIRPINS = ("hairpin", "switchback")  # names of turns with which a road climbs or descends a slope
SEVERAL = 3  # hairpins, if their number is open
USUAL = (0.10, 0.20, 0.26, 0.20, 0.14, 0.10)  # probabilities of 1, 2, ... turns, if the number is open
MORE = (0.45, 0.30, 0.17, 0.08)  # probabilities of 0, 1, ... turns more than the least required number
SWITCH = 0.6  # probability that a turn goes to the other side than the one before, if its side is open
WIDE = 100.0  # degrees: larger turns to one side would coil up, so they mostly alternate
SWITCH_WIDE = 0.9
SMALL, LARGE = 27.0, 105.0  # degrees of usual turns, which bound their number if their sum is required
LONG = 700.0  # m: a shorter road with a few turns fits on the usual map
ROUNDS = 60  # of drawing sides until the numbers of left and right turns are right


OpenTurn = tuple[Feature, bool]
"""A turn whose side may be open, and whether it must go to the side opposite to the previous turn."""


class TurnSequence(NamedTuple):
    """The left and right turns of a road, and the straights required before, between and after them."""

    turns: tuple[Feature, ...]
    gaps: tuple[tuple[Feature, ...], ...]

    def is_leg(self, gap: int) -> bool:
        """Returns whether a gap, counted from 0, lies between two hairpins or switchbacks."""
        return 0 < gap < len(self.turns) and all(map(is_hairpin, self.turns[gap - 1 : gap + 1]))


def is_hairpin(feature: Feature) -> bool:
    """Returns whether the description calls the turn a hairpin or a switchback."""
    return feature.name in HAIRPINS


def is_long(outline: Outline) -> bool:
    """Returns whether a length of 700 m or more is required and the number of turns is left open."""
    return outline.length is not None and outline.length.lo >= LONG and may_repeat_last_turn(outline)


def may_repeat_last_turn(outline: Outline) -> bool:
    """Returns whether the road may have more turns like its last one."""
    turning = [group for group in outline.groups if group.feature.kind == "turn"]
    is_last = bool(outline.groups) and outline.groups[-1].feature.kind == "turn" and outline.ends is None
    if not turning:
        return outline.turns.hi == inf and outline.ends is None
    return len(turning) == 1 and is_last and turning[0].hi is None


def drawn_sequence(outline: Outline, rng: np.random.Generator, plain: bool) -> TurnSequence:
    """Chooses at random what the Outline leaves open: the number of turns, the side of each, and where
    straights are. If ``plain``, the road has as few turns as the requirements allow. Raises DesignError if
    the required numbers of left, right and all turns contradict each other."""
    turns, gaps = _listed(outline, rng, plain) if outline.names_all_turns else _free(outline, rng, plain)
    _with_ends(outline, turns, gaps)
    sides = _sides(turns, outline, rng)
    features = tuple(replace(turn, side=side) for (turn, _), side in zip(turns, sides, strict=True))
    return TurnSequence(features, tuple(map(tuple, gaps)))


def _listed(
    outline: Outline, rng: np.random.Generator, plain: bool
) -> tuple[list[OpenTurn], list[list[Feature]]]:
    """Returns the turns and straights of all groups, in order."""
    turns: list[OpenTurn] = []
    gaps: list[list[Feature]] = [[]]
    counts = _group_counts(outline, rng, plain)
    for group, count in zip(outline.groups, counts, strict=True):
        feature = group.feature
        if feature.kind == "straight":
            gaps[-1] += [feature] * count
            continue
        for number in range(count):
            switches = group.alternating and number > 0
            turns.append((replace(feature, side=None) if switches else feature, switches))
            gaps.append([])
    return turns, gaps


def _group_counts(outline: Outline, rng: np.random.Generator, plain: bool) -> list[int]:
    """Chooses the number of features per group at random; the turns add up to a required number."""
    groups = outline.groups
    counts = [
        SEVERAL if not plain and (group.lo, group.hi) == (2, None) and is_hairpin(group.feature) else group.lo
        for group in groups
    ]
    open_ = [i for i, g in enumerate(groups) if g.feature.kind == "turn" and g.hi != g.lo]
    total = sum(count for count, g in zip(counts, groups, strict=True) if g.feature.kind == "turn")
    missing = int(max(outline.turns.lo - total, _turned(outline).lo - total, 0))
    more = 0 if plain or not open_ else int(rng.choice(len(MORE), p=MORE))
    spare = outline.turns.hi - total
    for _ in range(int(min(max(missing, more), spare)) if open_ else 0):
        able = [i for i in open_ if (groups[i].hi is None or counts[i] < (groups[i].hi or 0))]
        if not able:
            break
        counts[able[rng.integers(len(able))]] += 1
    return counts


def _free(
    outline: Outline, rng: np.random.Generator, plain: bool
) -> tuple[list[OpenTurn], list[list[Feature]]]:
    """Returns turns without requirements, and the required straights in order at random places among them."""
    count = _turn_count(outline, rng, plain)
    turns = [(Feature("turn", "turn"), False)] * count
    gaps: list[list[Feature]] = [[] for _ in range(count + 1)]
    straights = [group.feature for group in outline.groups for _ in range(group.lo)]
    apart = len(straights) <= count + 1
    where = rng.choice(count + 1, size=len(straights), replace=not apart)
    for index, feature in zip(sorted(where), straights, strict=True):
        gaps[index].append(feature)
    return turns, gaps


def _turn_count(outline: Outline, rng: np.random.Generator, plain: bool) -> int:
    low = int(max(outline.turns.lo, outline.left.lo, 0) if outline.turns.lo > 0 else max(outline.left.lo, 0))
    low = max(low, int(max(outline.left.lo, 0) + max(outline.right.lo, 0)))
    high = min(outline.turns.hi, outline.left.hi + outline.right.hi)
    if low > high:
        sides = {"left": outline.left, "right": outline.right}
        asked = " and ".join(f"{span} to the {side}" for side, span in sides.items() if span != Range())
        raise DesignError(f"no road has turns {outline.turns} in all, {asked}; change one of these numbers")
    # a road for which only climbs and falls are required gets few turns
    only_slopes = bool(outline.groups) and all(group.feature.grade for group in outline.groups)
    enough = _turned(outline)
    low, high = max(low, int(min(enough.lo, high))), max(low, min(high, enough.hi))
    if plain or only_slopes:
        return low
    if low <= 1:
        some = 1 + int(rng.choice(len(USUAL), p=USUAL))
        return int(min(max(some, low), high))
    return int(min(low + rng.choice(len(MORE), p=MORE), high))


def _turned(outline: Outline) -> Range:
    """Returns the range of the number of turns whose usual angles can have the required sum."""
    if outline.turning is None:
        return Range(0)
    most = outline.turning.hi // SMALL if outline.turning.hi < inf else inf
    return Range(ceil(max(outline.turning.lo, 0) / LARGE), most)


def _with_ends(outline: Outline, turns: list[OpenTurn], gaps: list[list[Feature]]) -> None:
    """Adds the features with which the road must start and end."""
    for feature, index in ((outline.starts, 0), (outline.ends, -1)):
        if feature is None:
            continue
        if feature.kind == "straight":
            gap = gaps[index]
            if not gap or not _shares(gap[index], feature):
                gap.insert(0 if index == 0 else len(gap), feature)
            else:
                gap[index] = both(gap[index], feature)
        elif turns:
            one, switches = turns[index]
            turns[index] = replace(both(one, feature), side=feature.side or one.side), switches


def _shares(one: Feature, other: Feature) -> bool:
    """Returns whether one straight can meet the requirements of both."""
    return all(
        a.lo <= a.hi for a in (overlap(one.length, other.length), overlap(one.grade, other.grade)) if a
    )


def _sides(turns: Sequence[OpenTurn], outline: Outline, rng: np.random.Generator) -> list[Side]:
    left, right, n = outline.left, outline.right, len(turns)
    for _ in range(ROUNDS):
        sides = _drawn_sides(turns, outline, rng)
        if sides is not None and sides.count("left") in left and n - sides.count("left") in right:
            return sides
    raise DesignError(f"the sides asked for the {n} turns contradict each other; leave one of them open")


def _drawn_sides(turns: Sequence[OpenTurn], outline: Outline, rng: np.random.Generator) -> list[Side] | None:
    """Chooses left or right for each turn; None if a required side contradicts a required alternation."""
    sides: list[Side] = []
    for turn, switches in turns:
        if sides and (switches or outline.alternating):
            side = OTHER_SIDE[sides[-1]]
            if turn.side not in (None, side) and not switches:
                return None
        else:
            side = turn.side or _free_side(turn, sides, len(turns), outline, rng)
        sides.append(side)
    return sides


def _free_side(
    turn: Feature, sides: Sequence[Side], count: int, outline: Outline, rng: np.random.Generator
) -> Side:
    rest = count - len(sides)
    lefts, rights = sides.count("left"), len(sides) - sides.count("left")
    if lefts >= outline.left.hi or outline.right.lo - rights >= rest:
        return "right"
    if rights >= outline.right.hi or outline.left.lo - lefts >= rest:
        return "left"
    if not sides:
        return "left" if rng.random() < 0.5 else "right"
    wide = turn.degrees is not None and turn.degrees.lo >= WIDE
    return OTHER_SIDE[sides[-1]] if rng.random() < (SWITCH_WIDE if wide else SWITCH) else sides[-1]
