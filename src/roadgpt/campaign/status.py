"""Returns the state of a campaign and its cells, even while a process works on it; SQLite counts tests."""

import time
from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.model import NO_WORDS, Goal
from roadgpt.campaign.record import Record
from roadgpt.run import REFUSED
from roadgpt.verdict.verdict import MOSTLY, PARTLY

FRESH = 15.0  # s since the store was last written; a working process writes it every second
LATELY = 60.0  # s over which the current rate is averaged
ONE_SIDED = 0.05  # share of driven roads; if fewer passed, or fewer failed, there is hardly a boundary
NOTHING = (None, 0, 0, None, None)  # of a cell in which no test passed


@dataclass(frozen=True)
class CellStatus:
    """The state of one cell."""

    name: str
    words: str
    driver: str
    generator: str
    seed: int
    asked: int
    outcomes: Mapping[str, int]
    least_margin: float | None
    """Smallest margin of the passed tests, metres. Failed tests are left out; their margins are near 0."""
    partly_outside: int
    """Number of passed tests in which more than 10 % of the car, up to half, was outside its lane."""
    mostly_outside: int  # number of passed tests in which more than half of the car was outside its lane
    max_oob: float | None
    """Largest share of the car that was outside its lane at one time in any passed test, 0 to 1."""
    beyond: float | None
    """Largest distance of the car's body beyond the lane marking in any passed test, metres."""
    goal: Goal | None
    closed: str | None
    """Why the cell was closed before all its tests had been requested; None if it was not closed."""
    oracle: str = ""  # name of the test oracle: see ``roadgpt.road.ORACLES``
    handed_over: int = 0
    """Number of failed tests that are no failures of the driver: see ``Verdict.handed_to``."""
    friction: float | None = 1.0  # friction coefficient of the roads; None if it differs from road to road

    @property
    def about(self) -> str:
        """The description, or what the roads are without one."""
        return self.words or NO_WORDS.get(self.generator, "any road")

    @property
    def done(self) -> int:
        """Number of tests that have ended."""
        return sum(self.outcomes.values())

    @property
    def remark(self) -> str:
        """A warning about a search for the boundary that drove no road, or of whose drives hardly any passed
        or hardly any failed; otherwise empty."""
        kept, failed = self.outcomes.get("PASS", 0), self.outcomes.get("FAIL", 0)
        driven = kept + failed
        if self.goal != "boundary" or not self.done or (driven and min(kept, failed) >= ONE_SIDED * driven):
            return ""
        if not driven:
            return f"{self.name}: no road was driven, so nothing is known of a boundary."
        did = f"kept its lane on {kept or 'none'}" if kept < failed else f"failed on {failed or 'none'}"
        return (
            f"{self.name}: of {driven:,} driven roads the car {did}, so there is hardly a boundary to find; "
            f"make it {'easier' if kept < failed else 'harder'} for the car (friction, speed limit, driver)."
        )


@dataclass(frozen=True)
class Status:
    """The state of a campaign."""

    folder: str
    is_finished: bool
    is_running: bool
    total: int | None  # number of tests; None if the campaign has a time limit but no limit on tests
    outcomes: Mapping[str, int]
    seconds: float  # total working time of the campaign, in seconds, summed over all sessions
    rate: float  # tests per second: over the last minute while the campaign is running, else the average
    tokens: int
    cost_usd: float
    cells: tuple[CellStatus, ...]
    scenarios: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    """The number of tests with each outcome, or that were refused, of each scenario that is tested."""

    @property
    def done(self) -> int:
        """Number of tests that have ended."""
        return sum(self.outcomes.values())

    @property
    def scenario_table(self) -> list[tuple[Any, ...]]:
        """The heads of a table, and a row for each scenario: its name, and its tests with each outcome."""
        outcomes = [*dict.fromkeys(outcome for counts in self.scenarios.values() for outcome in counts)]
        rows = [(name, *(its.get(each, 0) for each in outcomes)) for name, its in self.scenarios.items()]
        return [("scenario", *map(str.lower, outcomes)), *rows]

    @property
    def seconds_left(self) -> float | None:
        """Estimated seconds until the campaign ends; None if that cannot be estimated."""
        if self.is_finished:
            return 0.0
        if self.total is None or self.rate <= 0:
            return None
        return (self.total - self.done) / self.rate

    def to_json(self) -> dict[str, Any]:
        """Returns the status as a dictionary that can be written as JSON."""
        return {
            **asdict(self),
            "remarks": [cell.remark for cell in self.cells if cell.remark],
            "done": self.done,
            "seconds_left": self.seconds_left,
        }


def cell_statuses(record: Record) -> tuple[CellStatus, ...]:
    """Returns the state of each cell, in the order of the plan."""
    counts: dict[str, dict[str, int]] = {}
    passed: dict[str, tuple[Any, ...]] = {}
    grouped = (
        "SELECT cell, outcome, count(*), min(margin), coalesce(sum(max_oob > ? AND max_oob <= ?), 0), "
        "coalesce(sum(max_oob > ?), 0), max(max_oob), max(beyond) FROM tests WHERE outcome IS NOT NULL "
        "GROUP BY 1, 2"
    )
    for cell, outcome, count, *rest in record.stream(grouped, (PARTLY, MOSTLY, MOSTLY)):
        counts.setdefault(cell, {})[outcome] = count
        if outcome == "PASS":
            passed[cell] = tuple(rest)
    others = dict(
        record.query("SELECT cell, count(handed_to) FROM tests WHERE outcome = 'FAIL' GROUP BY cell")
    )
    asked = dict(record.query("SELECT cell, sum(n) FROM batches GROUP BY cell"))
    closed = dict(record.query("SELECT name, closed FROM cells"))
    measured = ("least_margin", "partly_outside", "mostly_outside", "max_oob", "beyond")
    return tuple(
        CellStatus(
            name=cell.name,
            words=cell.request.words,
            driver=cell.request.setup.driver,
            generator=cell.generator,
            seed=cell.request.seed,
            asked=asked.get(cell.name, 0),
            outcomes=counts.get(cell.name, {}),
            goal=cell.goal,
            closed=closed[cell.name],
            oracle=cell.request.world.limits.oracle,
            handed_over=others.get(cell.name, 0),
            friction=(cell.request.world.site.friction, None)["friction" in cell.settings.get("differ", ())],
            **dict(zip(measured, passed.get(cell.name, NOTHING), strict=True)),
        )
        for cell in record.cells()
    )


def status_of(folder: Path) -> Status:
    """Returns the state of a campaign or of a folder of runs."""
    with open_record(folder) as record:
        cells = cell_statuses(record)
        outcomes = sum((Counter(cell.outcomes) for cell in cells), Counter[str]())
        ((seconds, seen),) = record.query(
            "SELECT coalesce(sum(seen - begun), 0), coalesce(max(seen * (1 - is_over)), 0) FROM sittings"
        )
        is_finished = bool(record.meta("finished"))
        is_running = not is_finished and time.time() - seen < FRESH
        has_scenarios = any("scenario" in each.settings for each in record.cells())
        tokens, cost = record.spent()
        return Status(
            folder=str(folder),
            is_finished=is_finished,
            is_running=is_running,
            total=record.total(),
            outcomes=dict(outcomes),
            seconds=round(seconds, 3),
            rate=round(_rate(record, outcomes.total(), seconds, is_running), 3),
            tokens=tokens,
            cost_usd=cost,
            cells=cells,
            scenarios=_scenarios(record) if has_scenarios else {},
        )


def _scenarios(record: Record) -> dict[str, dict[str, int]]:
    refused = f"description LIKE '{REFUSED}%'"
    counted = (
        f"SELECT origin, CASE WHEN {refused} THEN 'refused' ELSE outcome END, count(*) FROM tests "  # noqa: S608
        "JOIN details USING (cell, number) WHERE outcome IS NOT NULL GROUP BY 1, 2 ORDER BY min(number)"
    )
    found: dict[str, dict[str, int]] = {}
    for origin, outcome, count in record.stream(counted):
        its = found.setdefault(origin.partition(" ")[0], {})
        its[outcome] = its.get(outcome, 0) + count
    return found


def _rate(record: Record, done: int, seconds: float, is_running: bool) -> float:
    if not is_running:
        return done / seconds if seconds else 0.0
    ((begun,),) = record.query("SELECT max(begun) FROM sittings")
    since = max(float(begun), time.time() - LATELY)
    ((lately,),) = record.query("SELECT count(*) FROM tests WHERE ended >= ?", (since,))
    return int(lately) / max(time.time() - since, 1.0)
