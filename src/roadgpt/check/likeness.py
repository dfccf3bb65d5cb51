"""Finds the turns and straights of a road that a description wants to be alike, and compares them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from roadgpt.brief.outline import Feature, Outline, both
from roadgpt.brief.ranges import overlap
from roadgpt.check.matching import Complaint
from roadgpt.check.measures import MeasuredFeature, Measures

ANGLES = 6.0  # degrees by which the angles of like turns may differ
RATIO = 1.2  # of the largest radius or length of like parts to the smallest
METRES = 5.0  # by which the lengths of like straights may differ in any case
OPEN_TURN = Feature("turn", "turn")
Wanted = Sequence[Feature | None]


class LikeGroup(list[int]):
    """The indices of features that must be alike; all features must meet the ranges in ``common``."""

    def __init__(self, common: Feature, place: int) -> None:
        super().__init__([place])
        self.common = common


def like_groups(features: Wanted) -> list[LikeGroup]:
    """Returns the groups of two or more features that must be alike. Features must be alike if they have the
    same name and their ranges overlap. A None in ``features`` belongs to no group.
    """
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
    """Groups the gaps before, between and after the turns whose straights must be equally long.

    Gaps with exactly one required straight are grouped by ``like_groups``. If no straight is required between
    the turns, all gaps between turns are one group; the ``common`` of this group has no length.
    """
    groups = like_groups([gap[0] if len(gap) == 1 else None for gap in gaps])
    inner = range(1, len(gaps) - 1)
    if len(inner) < 2 or any(gaps[place] for place in inner):
        return groups
    even = LikeGroup(Feature("straight", "straight"), inner[0])
    even.extend(inner[1:])
    return [*groups, even]


def likeness_complaints(found: Measures, asked: Outline) -> Iterator[Complaint]:
    """Yields a complaint for each group of turns or straights that should be alike and is not.

    If the number of turns is open, a road is compared only if all required turns have one name and no
    straight is required.
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
        lengths = [_longest(found.gaps[place]) for place in group]
        if max(lengths) - min(lengths) > max(METRES, (RATIO - 1) * min(lengths)):
            yield Complaint(
                f"asked for straights alike, they have {min(lengths):.0f} to {max(lengths):.0f} m"
            )


def _longest(gap: Sequence[MeasuredFeature]) -> float:
    return max((straight.length for straight in gap), default=0.0)


def _wanted(asked: Outline, count: int) -> tuple[list[Feature], list[list[Feature]]] | None:
    """Returns the required turns, and the straights required in each gap; None if it is not known which turn
    is which.
    """
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
