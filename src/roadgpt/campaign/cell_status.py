"""Counts the tests of each cell of a campaign; SQLite does the counting."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from roadgpt.campaign.model import Goal
from roadgpt.campaign.record import Record
from roadgpt.verdict.severity import MOSTLY

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
    """Number of passed tests in which up to half of the car was outside its lane."""
    mostly_outside: int
    """Number of passed tests in which more than half of the car was outside its lane."""
    max_oob: float | None
    """Largest share of the car that was outside its lane at one time in any passed test, 0 to 1."""
    beyond: float | None
    """Largest distance of the car's body beyond the lane marking in any passed test, metres.

    None if an earlier version of RoadGPT wrote the store.
    """
    goal: Goal | None
    closed: str | None
    """Why the cell was closed before all its tests had been requested; None if it was not closed."""
    friction: float = 1.0
    """Friction coefficient of the road."""

    @property
    def done(self) -> int:
        """Number of tests that have ended."""
        return sum(self.outcomes.values())

    @property
    def remark(self) -> str:
        """A warning if a search for the boundary of failure drove no road, or if less than 5 % of the driven
        roads passed or less than 5 % failed; otherwise empty.
        """
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


def cell_statuses(record: Record) -> tuple[CellStatus, ...]:
    """Returns the state of each cell, in the order of the plan."""
    counts: dict[str, dict[str, int]] = {}
    passed: dict[str, tuple[Any, ...]] = {}
    grouped = (
        "SELECT cell, outcome, count(*), min(margin), coalesce(sum(max_oob > 0 AND max_oob <= ?), 0), "
        "coalesce(sum(max_oob > ?), 0), max(max_oob), max(beyond) FROM tests WHERE outcome IS NOT NULL "
        "GROUP BY 1, 2"
    )
    for cell, outcome, count, *rest in record.stream(grouped, (MOSTLY, MOSTLY)):
        counts.setdefault(cell, {})[outcome] = count
        if outcome == "PASS":
            passed[cell] = tuple(rest)
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
            friction=cell.request.world.site.friction,
            **dict(zip(measured, passed.get(cell.name, NOTHING), strict=True)),
        )
        for cell in record.cells()
    )
