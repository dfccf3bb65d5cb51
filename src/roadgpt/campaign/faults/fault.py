"""Finds the distinct faults in a folder: groups of similar failures; no road is driven."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from roadgpt.campaign.faults.distinct import faults_of, typical
from roadgpt.campaign.faults.failures import LocatedFailure, failures_of
from roadgpt.campaign.faults.reason import Way
from roadgpt.campaign.numbered_test import NumberedTest

DEFINED = (
    "Two failures are one fault where the same driver, in the same world, left its lane for the same cause, "
    "to the same side, and where the road bends and climbs alike from 30 m before the place to 30 m after it."
)
MOST_WAYS = 3  # ways of failing that a headline names
TRIED = 3  # typical failures of a fault that are driven again, until one fails in half of the drives
WAYS: dict[Way, str] = {
    "wide": "ran wide of",
    "inside": "cut the inside of",
    "off": "left a straight",
    "stopped": "came to a standstill",
    "late": "ran out of time",
}


@dataclass(frozen=True, eq=False)
class Fault:
    """A group of similar failures."""

    number: int
    """Number of the fault, from 1; the fault with the most failures comes first."""
    members: tuple[LocatedFailure, ...]
    """All failures of the fault, in the order of their tests."""
    typical: tuple[LocatedFailure, ...]
    """A few typical failures of the fault, starting with the one that is nearest to all others."""

    @property
    def names(self) -> tuple[NumberedTest, ...]:
        """Names of the tests with the typical failures."""
        return tuple(each.name for each in self.typical)


@dataclass(frozen=True, eq=False)
class Faults:
    """The distinct faults of a folder."""

    them: tuple[Fault, ...]
    failures: int
    """Number of all failures in the folder, or in the cell that was chosen."""
    compared: int
    """Number of failures that were compared; the others belong to no fault."""

    @property
    def headline(self) -> str:
        """The number of faults and how the car failed: '3 distinct faults in 9 failures: the car ran wide
        of ...'.
        """
        ways = "; it ".join(self.ways[:MOST_WAYS])
        more = len(self.ways) - MOST_WAYS
        also = f"; and in {more} other way{'s' * (more > 1)}" if more > 0 else ""
        return f"{self.sentence}: the car {ways}{also}" if ways else self.sentence

    @property
    def sentence(self) -> str:
        """The number of faults and failures as text: '17 distinct faults in 170 failures'."""
        count = len(self.them)
        if not self.failures:
            return "no road failed"
        faults = f"{count:,} distinct fault{'s' * (count != 1)}"
        failures = f"{self.failures:,} failure{'s' * (self.failures != 1)}"
        if self.compared == self.failures:
            return f"{faults} in {failures}"
        if not self.compared:
            return (
                f"{failures}; their roads are not known, so the number of distinct faults is not known either"
            )
        return f"at least {faults} in {failures} ({self.compared:,} of them compared)"

    @property
    def ways(self) -> list[str]:
        """How the car failed, the most frequent way first: 'ran wide of right bends of R 15 m to 17 m'."""
        found: dict[tuple[Way, str | None], list[LocatedFailure]] = {}
        for fault in self.them:
            for each in fault.members:
                found.setdefault((each.manner.way, each.manner.side), []).append(each)
        ordered = sorted(found.items(), key=lambda item: -len(item[1]))
        return [_way_text(way, side, members) for (way, side), members in ordered]


def _way_text(way: Way, side: str | None, members: Sequence[LocatedFailure]) -> str:
    radii = sorted(each.manner.radius for each in members if each.manner.radius is not None)
    if side is None or not radii:
        return WAYS[way]
    if len(radii) == 1:
        return f"{WAYS[way]} a {side} bend of R {radii[0]:.0f} m"
    low, high = f"{radii[0]:.0f}", f"{radii[-1]:.0f}"
    return f"{WAYS[way]} {side} bends of R {low} m" + (f" to {high} m" if low != high else "")


def faults_in(folder: Path, most: int | None = None, cell: str = "") -> Faults:
    """Returns the distinct faults of a run, of a folder of runs, or of a campaign.

    Args:
        folder: the folder of the run, the runs or the campaign.
        most: maximum number of failures to compare, evenly spread over all; None: all failures.
        cell: name of a cell of a campaign; empty: all cells.

    Raises:
        UsageError: the folder holds neither runs nor a campaign, or a file cannot be read.
    """
    failures = failures_of(folder, most, cell)
    return Faults(tuple(_grouped(failures.known)), failures.every, len(failures.known))


def _grouped(known: Sequence[LocatedFailure]) -> Iterator[Fault]:
    members: dict[int, list[LocatedFailure]] = {}
    for cluster, each in zip(faults_of([each.around for each in known]), known, strict=True):
        members.setdefault(cluster, []).append(each)
    ordered = sorted(members.values(), key=lambda its: (-len(its), its[0].name))
    for number, its in enumerate(ordered, 1):
        some = typical([each.around for each in its])[:TRIED]
        yield Fault(number, tuple(its), tuple(its[at] for at in some))
