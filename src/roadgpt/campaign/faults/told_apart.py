"""Joins groups of similar failures into distinct faults by the small changes that make them disappear.

A fault is a set of failures that disappear with one small change, while this change leaves the failures of
other faults as they are. So two failures of one fault disappear with the same change, and two failures of
different faults do not. Groups for which there is no such change belong to no fault.
"""

from collections import Counter
from collections.abc import Sequence
from itertools import chain, combinations
from typing import NamedTuple

import numpy as np

from roadgpt.campaign.faults.remedy import REMEDIES, Removed
from roadgpt.geometry.curve import Array

WITHIN = 0.85  # smallest share of the pairs of failures in one fault that its change removes
JOINS = 0.7  # a group joins a fault if the fault's change removes more than this share of its tested failures
ACROSS = 0.2  # largest share of the pairs of failures from two faults that the change of either removes
MOST = 4  # faults of one driver in one world
FEWEST = 2  # smallest number of failures of a fault, unless there is only one group: one failure has no pairs
SMALL = len(REMEDIES) // 2  # index of the first of the larger changes
LARGER = 0.8  # weight of a failure that needs a larger change: small changes say more about the cause
EPS = 1e-9


class TriedGroup(NamedTuple):
    """A group of similar failures, of which some were tested."""

    size: int
    """Number of failures in the group."""
    removed: tuple[Removed, ...]
    """For each tested failure: which changes make it disappear."""


def faults_by_remedy(groups: Sequence[TriedGroup]) -> list[str | None]:
    """Returns for each group the name of the change that defines its fault; None if the group belongs to no
    fault.

    Each change in a set defines one fault. A set of one to four changes is admissible if its faults satisfy
    the limits ``WITHIN``, ``ACROSS`` and ``FEWEST``. The function takes the admissible set whose faults have
    the most failures; a failure that needs a larger change counts as 0.8 failures. If several sets are
    equally good, it takes the set with the fewest and smallest changes.
    """
    shares = np.array([[_share(group, remedy.name) for remedy in REMEDIES] for group in groups])
    best: list[int | None] = [None] * len(groups)
    most = 0.0
    every = range(len(REMEDIES))
    for chosen in chain.from_iterable(combinations(every, count) for count in range(1, MOST + 1)):
        found = _assigned(shares, chosen)
        sizes = Counter[int]()
        for group, at in zip(groups, found, strict=True):
            if at is not None:
                sizes[at] += group.size
        value = sum(size * (1.0 if at < SMALL else LARGER) for at, size in sizes.items())
        is_seen_often = len(groups) == 1 or all(size >= FEWEST for size in sizes.values())
        if value > most and is_seen_often and _is_apart(groups, shares, found):
            best, most = found, value
    return [None if at is None else REMEDIES[at].name for at in best]


def _share(group: TriedGroup, name: str) -> float:
    """Returns the share of a group's tested failures that disappear with a change."""
    return sum(bool(each[name]) for each in group.removed) / len(group.removed) if group.removed else 0.0


def _assigned(shares: Array, chosen: Sequence[int]) -> list[int | None]:
    """Returns for each group the one of the chosen changes that removes most of it, more than ``JOINS``; None
    if there is none."""
    found: list[int | None] = []
    for row in shares:
        at = max(chosen, key=lambda one: (row[one], -one))
        found.append(at if row[at] > JOINS else None)
    return found


def _is_apart(groups: Sequence[TriedGroup], shares: Array, found: Sequence[int | None]) -> bool:
    """Tells whether the faults keep to ``WITHIN`` and ``ACROSS``; each group counts by its size."""
    members = {at: [i for i, own in enumerate(found) if own == at] for at in found if at is not None}
    sizes = np.array([group.size for group in groups], float)

    def removed(at: int, by: int) -> float:
        return float(np.average(shares[members[at], by], weights=sizes[members[at]]))

    if any(removed(at, at) ** 2 < WITHIN - EPS for at in members):
        return False
    # a pair disappears with the change of either fault
    return all(
        1 - (1 - removed(one, other)) * (1 - removed(other, one)) <= ACROSS + EPS
        for one, other in combinations(members, 2)
    )
