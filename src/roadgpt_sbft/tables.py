"""Writes the tables of a folder of runs, with the columns of the SBFT competition.

generation_stats.csv         counts, and wall-clock seconds
oob_stats.csv                failures to the left and to the right, and the sparseness of failures
experiment_description.csv   the settings: the competition's columns first, then RoadGPT's
"""

import math
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from roadgpt.run import Request, Run, Seconds, atomic, execution

if TYPE_CHECKING:
    from roadgpt_sbft.sparseness import Departure, Sparseness  # only failures need it

TABLES = ("generation_stats.csv", "oob_stats.csv")
DESCRIPTION = "experiment_description.csv"
SETTINGS = (
    *("executor", "dave2_model", "beamng_home", "beamng_user", "time_budget", "map_size", "oob_tolerance"),
    *("speed_limit", "module_name", "module_path", "class_name", "visualize_tests", "log_to", "debug"),
)
"""The competition's columns of experiment_description.csv, in their order."""
ELSEWHERE = ("simulator", "designer", "chat")  # written in other columns; ``chat`` only if it is set


class TallyEntry(NamedTuple):
    """The values of one Run that are counted."""

    number: int  # number of the road, from 1
    outcome: str
    is_valid: bool
    seconds: Seconds
    simulated: float  # duration of the drive, seconds of simulated time; 0 if the road was not driven
    departure: "Departure | None"
    """Where the car left its lane; None if it stayed in its lane or if the test did not fail."""

    @classmethod
    def of(cls, run: Run) -> "TallyEntry":
        """Returns the values of a Run that the tables count."""
        found = None
        if run.outcome == "FAIL" and run.road is not None and run.drive is not None:
            from roadgpt_sbft.sparseness import departure

            found = departure(run.road.control_points(), execution.records_of(run.road, run.drive, run.world))
        simulated = run.drive.duration if run.drive is not None else 0.0
        return cls(run.index, run.outcome, run.is_valid, run.seconds, simulated, found)


class Tally:
    """Counts the Runs of a folder for the tables of the SBFT competition, and describes its settings."""

    files = (*TABLES, DESCRIPTION)
    entry = TallyEntry.of

    def __init__(self) -> None:
        self.outcomes: Counter[str] = Counter()
        self.sides: Counter[str] = Counter()
        self.valid = 0
        self.designing = self.driving = self.simulated = 0.0
        self.spread: Sparseness | None = None

    def add(self, entry: TallyEntry) -> None:
        """Adds a Run to the counts."""
        self.outcomes[entry.outcome] += 1
        self.valid += entry.is_valid
        self.designing += entry.seconds.design
        self.driving += entry.seconds.drive
        self.simulated += entry.simulated
        if entry.departure is not None:
            self.sides[entry.departure.side] += 1
            if entry.departure.segment is not None:
                from roadgpt_sbft.sparseness import Sparseness

                self.spread = self.spread or Sparseness()
                self.spread.add(entry.number, entry.departure.segment)

    def write(self, folder: Path) -> None:
        """Writes the two tables that change with each road: generation_stats.csv and oob_stats.csv."""
        generated = self.outcomes.total()
        generation: dict[str, object] = {
            "test_generated": generated,
            "test_valid": self.valid,
            "test_invalid": generated - self.valid,
            "test_passed": self.outcomes["PASS"],
            "test_failed": self.outcomes["FAIL"],
            "test_in_error": self.outcomes["ERROR"],
            "real_time_generation": round(self.designing, 4),
            "real_time_execution": round(self.driving, 4),
            "simulated_time_execution": round(self.simulated, 4),
        }
        departures: dict[str, object] = {
            "total_oob": self.sides.total(),
            "left_oob": self.sides["left"],
            "right_oob": self.sides["right"],
            "avg_sparseness": f"{self.spread.mean if self.spread else math.nan:.3f}",
            "stdev_sparseness": f"{self.spread.deviation if self.spread else math.nan:3.0f}",
        }
        for name, row in zip(TABLES, (generation, departures), strict=True):
            atomic.write_whole(folder / name, atomic.csv_text(row, [row.values()]))

    @staticmethod
    def describe(request: Request, roads: int, folder: Path) -> None:
        """Writes experiment_description.csv."""
        setup = request.setup
        asked = {} if setup.chat is None else {"chat": setup.chat.model_dump_json(exclude_defaults=True)}
        named = {key: value for key, value in setup.model_dump().items() if key not in ELSEWHERE}
        named["oracle"] = request.world.limits.oracle
        ours = {"description": request.words, "roads": roads, "seed": request.seed, **named, **asked}
        write_settings(request, {"module_name": "roadgpt", "class_name": setup.designer}, ours, folder)


def write_settings(
    request: Request, theirs: Mapping[str, object], ours: Mapping[str, object], folder: Path
) -> None:
    """Writes experiment_description.csv: ``theirs``, values for the competition's columns in their order,
    where missing ones come from the Request or stay empty; then ``ours``; then the fields of the world."""
    world = request.world
    known = {
        "executor": request.setup.simulator,
        "map_size": world.site.map_size,
        "oob_tolerance": world.limits.oob_tolerance,
        "speed_limit": round(world.limits.speed_limit * 3.6, 6),
    }
    row: dict[str, object] = dict.fromkeys(SETTINGS, "") | known | dict(theirs)
    rest = {name: value for name, value in world.model_dump().items() if name not in row}
    row |= dict(ours) | rest
    atomic.write_whole(folder / DESCRIPTION, atomic.csv_text(row, [row.values()]))
