"""Finds the distinct faults in a folder from stored results; this module drives no road.

A fault is a set of failures that disappear with the same small change of the test. Failures are first grouped
by the similarity of the road around them. Once ``remedy`` has driven some failures of each group with
small changes, the groups are joined into faults. Then ``remedy`` drives further failures of each fault with
the changes, ``AT_A_TIME`` failures at a time, until ``CHECKED`` failures of the fault have disappeared. After
each time, the groups are joined again, with the new results."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from roadgpt.campaign.model import NumberedTest
from roadgpt.plural import plural
from roadgpt_search.faults.failures import LocatedFailure, Way, failures_of, groups_of, typical
from roadgpt_search.faults.remedy import REMEDIES, Removed, faults_by_remedy, has_remedies, stored_remedies

DEFINED = (
    "A fault is a set of failures of one driver in one world that the same small change of the test removes, "
    "while this change leaves the other faults as they are."
)
GROUPED = (
    "A group holds failures of one driver in one world for the same cause, to the same side, where the road "
    "bends and climbs alike from 30 m before the place to 30 m after it. Several groups may be one fault."
)
SENTENCES = {remedy.name: remedy.sentence for remedy in REMEDIES}
MOST_FIRST = 8  # of a group of n, 1 + n // 4 failures but at most so many are tested before groups are joined
CHECKED = 12  # failures of a fault, besides those tested first, that must disappear when tested
AT_A_TIME = 4  # failures of a fault that are tested before its groups are joined anew
MOST_WAYS = 3  # ways of failing that a headline names
TRIED = 3  # typical failures of a group or fault, one after the other, for repeated drives
WAYS: dict[Way, str] = {
    "wide": "ran wide of",
    "inside": "cut the inside of",
    "off": "left a straight",
    "stopped": "came to a standstill",
    "late": "ran out of time",
    "hit": "collided with somebody",
    "rule": "broke a rule of the road",
}


@dataclass(frozen=True, eq=False)
class Fault:
    """A fault, or a group of similar failures that belongs to no fault or was not tested."""

    number: int
    """Number, from 1; those with the most failures come first. 0 if other groups belong to faults."""
    members: tuple[LocatedFailure, ...]  # all failures of the fault or group, in the order of their tests
    typical: tuple[LocatedFailure, ...]
    """Up to three typical failures, that of the largest group first; see ``failures.typical``."""
    remedy: str | None = None
    """Name of the small change with which the failures disappear; None if this is a group, not a fault."""
    tested_first: tuple[LocatedFailure, ...] = ()
    """The failures of a group that are driven with small changes first, evenly spread from the most to the
    least typical one; empty for a fault."""

    @property
    def removed_by(self) -> str:
        """The small change with which the failures disappear, as text for users; empty for a group."""
        return SENTENCES[self.remedy] if self.remedy else ""

    @property
    def names(self) -> tuple[NumberedTest, ...]:
        """Names of the tests with the typical failures."""
        return tuple(each.name for each in self.typical)


@dataclass(frozen=True, eq=False)
class Faults:
    """The distinct faults of a folder, and the groups of failures that belong to none."""

    them: tuple[Fault, ...]  # the faults; if none is known, the groups of similar failures
    alone: tuple[Fault, ...]  # the groups that belong to no fault; empty if no fault is known
    is_tested: bool  # whether small changes were tried on enough failures; if not, ``them`` holds groups
    to_test: tuple[LocatedFailure, ...]
    """Failures to be driven with small changes next; empty if enough failures were tested."""
    to_come: int
    """Estimated number of failures to be driven with small changes in all, those ``to_test`` among them."""
    failures: int  # number of all failures in the folder, or in the cell that was chosen
    compared: int  # number of failures that were compared; the others belong to no group

    @property
    def distinct(self) -> int:
        """The number of distinct faults; 0 if the groups were not tested."""
        return sum(each.remedy is not None for each in self.them)

    @property
    def headline(self) -> str:
        """The sentence, and how the car failed: '3 distinct faults in 9 failures: the car ran wide of
        ...'."""
        ways = "; it ".join(self.ways[:MOST_WAYS])
        more = len(self.ways) - MOST_WAYS
        also = f"; and in {more} other way{'s' * (more > 1)}" if more > 0 else ""
        return f"{self._count}: the car {ways}{also}{self._alone}" if ways else self.sentence

    @property
    def sentence(self) -> str:
        """The number of faults or groups, and of failures, as text: '2 distinct faults in 37 failures'."""
        return f"{self._count}{self._alone}"

    @property
    def _count(self) -> str:
        if not self.failures:
            return "no road failed"
        failures = plural(self.failures, "failure")
        if not self.compared:
            return f"{failures}; their roads are not known, so it is not known how many faults they are"
        least, compared = "", ""
        if self.compared < self.failures:
            least, compared = "at least ", f" ({self.compared:,} of them compared)"
        if not self.distinct:
            groups = f"{plural(len(self.them), 'group')} of similar failures"
            none = "; no small change accounts for them" if self.is_tested else ""
            return f"{failures} in {least}{groups}{compared}{none}"
        return f"{least}{plural(self.distinct, 'distinct fault')} in {failures}{compared}"

    @property
    def _alone(self) -> str:
        if not self.alone:
            return ""
        count = sum(len(each.members) for each in self.alone)
        belong = "belong" if count > 1 else "belongs"
        return f"; {count:,} of the failures, in {plural(len(self.alone), 'group')}, {belong} to no fault"

    @property
    def ways(self) -> list[str]:
        """How the car failed, the most frequent way first: 'ran wide of right bends of radius 15 m'."""
        found: dict[tuple[Way, str | None], list[LocatedFailure]] = {}
        for fault in (*self.them, *self.alone):
            for each in fault.members:
                found.setdefault((each.manner.way, each.manner.side), []).append(each)
        ordered = sorted(found.items(), key=lambda item: -len(item[1]))
        return [_way_text(way, side, members) for (way, side), members in ordered]


def _way_text(way: Way, side: str | None, members: Sequence[LocatedFailure]) -> str:
    radii = sorted(each.manner.radius for each in members if each.manner.radius is not None)
    if side is None or not radii:
        return WAYS[way]
    if len(radii) == 1:
        return f"{WAYS[way]} a {side} bend of radius {radii[0]:.0f} m"
    low, high = f"{radii[0]:.0f}", f"{radii[-1]:.0f}"
    return f"{WAYS[way]} {side} bends of radius {low} m" + (f" to {high} m" if low != high else "")


def faults_in(folder: Path, most: int | None = None, cell: str = "") -> Faults:
    """Returns the distinct faults of a run, of a folder of runs, or of a campaign, or of one of its cells.

    At most ``most`` failures are compared, evenly spread; all of them once small changes were tried on some,
    since the results belong to groups that were formed from all."""
    known, failures = failures_of(folder, None if has_remedies(folder) else most, cell)
    groups = _grouped(known)
    stored = {each.name: stored_remedies(folder, each) for each in known}
    tested: Tested = {name: removed for name, removed in stored.items() if removed is not None}
    to_test = [each for group in groups for each in group.tested_first if each.name not in tested]
    joined: list[Fault] = []
    to_come = min(len(known) - len(tested), len(to_test) + CHECKED)
    if not to_test:
        joined = _joined(groups, tested)
        checks = [_checks(fault, groups, tested) for fault in joined if fault.remedy]
        to_come = sum(count for _, count in checks)
        to_test = [each for left, count in checks for each in _spread(left, min(count, AT_A_TIME))]
    is_tested = bool(groups) and not to_test
    found = joined if is_tested else groups
    faults = [each for each in found if each.remedy] or found
    them = tuple(replace(each, number=n) for n, each in enumerate(faults, 1))
    alone = tuple(found[len(faults) :])
    return Faults(them, alone, is_tested, tuple(to_test), to_come, failures, len(known))


def _grouped(known: Sequence[LocatedFailure]) -> list[Fault]:
    members: dict[int, list[LocatedFailure]] = {}
    for cluster, each in zip(groups_of([each.around for each in known]), known, strict=True):
        members.setdefault(cluster, []).append(each)
    found = []
    for its in members.values():
        ordered = [its[at] for at in typical([each.around for each in its])]
        first = _spread(ordered, min(1 + len(its) // 4, MOST_FIRST))
        found.append(Fault(0, tuple(its), tuple(ordered[:TRIED]), tested_first=first))
    return sorted(found, key=_order)


def _spread(them: Sequence[LocatedFailure], count: int) -> tuple[LocatedFailure, ...]:
    return tuple(them[len(them) * at // count] for at in range(count))


def _order(fault: Fault) -> tuple[bool, int, NumberedTest]:
    return fault.remedy is None, -len(fault.members), fault.members[0].name


Tested = Mapping[NumberedTest, Removed]
"""For each driven failure, by its name: which small changes make the failure disappear."""


def _checks(fault: Fault, groups: Sequence[Fault], tested: Tested) -> tuple[list[LocatedFailure], int]:
    """Returns the untested failures of a fault, and how many to test so that ``CHECKED`` disappear besides
    those tested first."""
    first = {each.name for group in groups for each in group.tested_first}
    members = {each.name for each in fault.members}
    every = [each for group in groups for each in group.members if each.name in members]
    left = [each for each in every if each.name not in tested]
    done = sum(each.name in tested and each.name not in first for each in fault.members)
    return left, max(0, min(CHECKED - done, len(left)))


def _joined(groups: Sequence[Fault], tested: Tested) -> list[Fault]:
    """Joins groups into faults; failures of different drivers, simulators or worlds are never joined."""
    systems: dict[str, list[Fault]] = {}
    for group in groups:
        systems.setdefault(group.members[0].system, []).append(group)
    found: list[Fault] = []
    for those in systems.values():
        joined: dict[str, list[Fault]] = {}
        tried = [
            (len(one.members), [tested[it.name] for it in one.members if it.name in tested]) for one in those
        ]
        remedies = faults_by_remedy(tried)
        for group, remedy in zip(those, remedies, strict=True):
            if remedy is None:
                found.append(group)
            else:
                joined.setdefault(remedy, []).append(group)
        for remedy, its in joined.items():
            found += _parted(remedy, its, tested)
    return sorted(found, key=_order)


def _parted(remedy: str, groups: Sequence[Fault], tested: Tested) -> Iterator[Fault]:
    """Yields the fault that consists of some groups, and groups of its failures that stayed when tested."""

    def stays(each: LocatedFailure) -> bool:
        return each.name in tested and not tested[each.name][remedy]

    every = sorted((each for group in groups for each in group.members), key=lambda each: each.name)
    typical_ones = [each for group in groups for each in group.typical if not stays(each)]
    members = tuple(each for each in every if not stays(each))
    yield Fault(0, members, tuple(typical_ones[:TRIED]) or members[:TRIED], remedy)
    yield from _grouped([each for each in every if stays(each)])
