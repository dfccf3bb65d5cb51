"""Whether distinct faults are distinct: failures of one fault disappear with one change, others do not.

    python benchmarks/bench_faults.py                       the quick look that `make bench` takes
    python benchmarks/bench_faults.py --whole -j 2          two drivers in four conditions, 100 tests each
    python benchmarks/bench_faults.py --whole --folder FOLDER

Each campaign searches for failures, and `roadgpt faults` joins them into faults by the small changes that
remove some failures of each group, and tests further failures of each fault. Then other failures of each
fault, drawn at random, which had no part in this, are driven with the same changes. A pair of two failures of
one fault has to disappear with the change that defines the fault; a pair of failures of two faults must not
disappear with the change of either. Groups of failures that belong to no fault are counted and not paired.
The last column has the pairs across two faults of the failures that the faults were found with.
What was found is kept in FOLDER, so an interrupted run goes on.
"""

import argparse
import itertools
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from roadgpt.campaign.executors.processes import unordered_map
from roadgpt.campaign.folder_record import kept_run
from roadgpt.campaign.model import NumberedTest
from roadgpt_search.faults.fault import Fault, faults_in
from roadgpt_search.faults.remedy import Removed, remedies_of, stored_remedies

DRIVERS = ("beamng_like", "lane_centring")
CONDITIONS: dict[str, tuple[str, ...]] = {
    "dry": ("a flat road",),
    "friction 0.6": ("a flat road", "--friction", "0.6"),
    "hills": ("a hilly road",),
    "100 km/h": ("a flat road", "--speed-limit", "100"),
}
USUAL = ("--goal", "failures", "--map-size", "200", "--oob-tolerance", "0.85", "--quiet")
OTHERS = 6  # failures of each fault that are tested besides


@dataclass(frozen=True)
class Pairs:
    """How many pairs of failures disappear with one change."""

    removed: int = 0
    all: int = 0

    def __add__(self, other: "Pairs") -> "Pairs":
        return Pairs(self.removed + other.removed, self.all + other.all)

    def __str__(self) -> str:
        return f"{self.removed} of {self.all} ({self.removed / self.all:.0%})" if self.all else "-"


@dataclass(frozen=True)
class CampaignRow:
    """What one campaign shows."""

    driver: str
    condition: str
    failures: int
    tested: int
    """Failures that were driven with changes to find the faults."""
    faults: tuple[Fault, ...]
    alone: int
    """Failures that belong to no fault."""
    within: Pairs
    across: Pairs
    across_tested: Pairs
    """Pairs across two faults of the failures that the faults were found with."""


class RemedyTrial(NamedTuple):
    """A failure that had no part in finding the faults, and the kinds of changes to try on it."""

    folder: Path
    name: NumberedTest
    kinds: frozenset[str]


def main() -> None:
    """Runs the campaigns that the options name, and prints the table."""
    options = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    options.add_argument("--whole", action="store_true", help="all conditions, 100 tests each")
    options.add_argument("--tests", type=int, help="of each campaign")
    options.add_argument("--seed", type=int, default=41)
    options.add_argument("-j", "--workers", type=int, default=1)
    options.add_argument("--folder", type=Path)
    given = options.parse_args()
    conditions, tests = (CONDITIONS, 100) if given.whole else (["dry"], 60)
    tests = given.tests or tests
    with tempfile.TemporaryDirectory() as spare:
        folder = given.folder or Path(spare)
        folder.mkdir(parents=True, exist_ok=True)
        rows = []
        for condition, driver in itertools.product(conditions, DRIVERS):
            rows.append(measured(folder, driver, condition, tests, given.seed, given.workers))
            print(f"{driver}, {condition}: done", file=sys.stderr, flush=True)
    print("\n".join(table(rows)))


def measured(folder: Path, driver: str, condition: str, tests: int, seed: int, workers: int) -> CampaignRow:
    """Searches, finds the faults, and tests further failures of each."""
    place = folder / f"{driver} {condition} {tests} {seed}".replace(" ", "-").replace("/", "")
    ready = place / "tested"
    if not ready.is_file():
        words = [*CONDITIONS[condition], *USUAL, "-n", str(tests), "--seed", str(seed), "--driver", driver]
        begun = (place / "campaign.sqlite").is_file()
        first = ["resume", str(place), "--quiet"] if begun else ["campaign", *words, "--out", str(place)]
        many = ["-j", str(workers)]
        ours(*first, *many)
        ours("faults", str(place), "--repeat", "1", "--no-plot", "--quiet", *many)
        ready.touch()
    found = faults_in(place)
    faults = tuple(each for each in found.them if each.remedy)
    known = [[stored_remedies(place, each) for each in fault.members] for fault in found.them]
    tested = [[each for each in its if each is not None] for its in known]
    alone = sum(len(each.members) for each in found.them if not each.remedy)
    within, across = pairs(faults, held_back(place, faults, seed, workers))
    _, across_tested = pairs(faults, tested[: len(faults)])
    count = sum(map(len, tested))
    return CampaignRow(driver, condition, found.failures, count, faults, alone, within, across, across_tested)


def ours(*words: str) -> None:
    """Runs a command of RoadGPT."""
    subprocess.run([sys.executable, "-m", "roadgpt", *words], check=True)


def held_back(place: Path, faults: Sequence[Fault], seed: int, workers: int) -> list[list[Removed]]:
    """Tries the changes of the faults on failures of each that had no part in finding the faults."""
    rng = np.random.default_rng(seed)
    kinds = frozenset(str(fault.remedy).split()[0] for fault in faults)
    drawn: list[list[RemedyTrial]] = []
    for fault in faults:
        others = [each for each in fault.members if stored_remedies(place, each) is None]
        some = sorted(rng.permutation(len(others))[:OTHERS])
        drawn.append([RemedyTrial(place, others[at].name, kinds) for at in some])
    tasks = [each for some in drawn for each in some]
    removed = dict(unordered_map(tried, tasks, workers, place / "workers.log"))
    return [[removed[each.name] for each in some] for some in drawn]


def tried(trial: RemedyTrial) -> tuple[NumberedTest, Removed]:
    """Drives the road of a failure with changes, unless this was done before."""
    path = trial.folder / "held_back" / f"{trial.name.cell}-{trial.name.number}.json"
    if not path.is_file():
        path.parent.mkdir(exist_ok=True)
        found = remedies_of(kept_run(trial.folder, *trial.name), trial.kinds)
        path.write_text(json.dumps(dict(found)), encoding="utf-8")
    return trial.name, json.loads(path.read_text(encoding="utf-8"))


def pairs(faults: Sequence[Fault], removed: Sequence[Sequence[Removed]]) -> tuple[Pairs, Pairs]:
    """Returns the pairs of failures of one fault, and those of two faults, that disappear with one change."""
    within, across = Pairs(), Pairs()
    for fault, some in zip(faults, removed, strict=True):
        for one, other in itertools.combinations(some, 2):
            within += Pairs(_both(one, other, fault), 1)
    both = list(zip(faults, removed, strict=True))
    for (fault, some), (second, others) in itertools.combinations(both, 2):
        for one, other in itertools.product(some, others):
            across += Pairs(_both(one, other, fault) or _both(one, other, second), 1)
    return within, across


def _both(one: Removed, other: Removed, fault: Fault) -> bool:
    name = str(fault.remedy)
    return bool(one[name]) and bool(other[name])


def table(rows: Sequence[CampaignRow]) -> Iterator[str]:
    """Yields the lines of the table."""
    yield (
        "| driver | condition | failures, tested | distinct faults: failures, what removes them | no fault | "
        "pairs within | pairs across | tested pairs across |"
    )
    yield "|---|---|---|---|---|---|---|---|"
    for row in rows:
        faults = "; ".join(f"{len(each.members)}: {each.removed_by}" for each in row.faults)
        yield (
            f"| {row.driver} | {row.condition} | {row.failures}, {row.tested} | {len(row.faults)} ({faults}) "
            f"| {row.alone} | {row.within} | {row.across} | {row.across_tested} |"
        )
    within, across, tested = (
        sum((one for one in column), Pairs())
        for column in zip(*((row.within, row.across, row.across_tested) for row in rows), strict=True)
    )
    count = sum(len(row.faults) for row in rows)
    yield (
        f"| all | | {sum(row.failures for row in rows)}, {sum(row.tested for row in rows)} | {count} | "
        f"{sum(row.alone for row in rows)} | {within} | {across} | {tested} |"
    )


if __name__ == "__main__":
    main()
