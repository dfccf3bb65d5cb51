"""Writes a folder of results with the competition's files, fields and columns, in the competition's order.

results/MODULE_CLASS_STAMP/
  test.NNNN.json  generation_stats.csv  oob_stats.csv  experiment_description.csv    the competition's
  campaign.json  runs/NNNN/  overview.png  generator.log                             RoadGPT's
"""

import csv
import io
import os
import time
from pathlib import Path
from typing import Any

from roadgpt.errors import UsageError
from roadgpt.run import Run
from roadgpt.run.atomic import json_text, missing, take_away, write_whole
from roadgpt.run.card import CARD, Card
from roadgpt.run.features import features_of
from roadgpt.run.folder import RUNS, Draw, write_run
from roadgpt.run.model import Request
from roadgpt.run.tables import DESCRIPTION, TABLES, Tally
from roadgpt.sbft.experiment import Experiment
from roadgpt.sbft.single_test import interpolated_points, records_at_their_height, sbft_description

HOME = Path("results")
LOG = "generator.log"


def new_folder(experiment: Experiment, out: Path | None = None) -> tuple[Path, tuple[Path, ...]]:
    """Makes the folder for results, by default under the competition's name for it.

    Returns:
        The folder, and all folders that were created for it, the innermost first.

    Raises:
        UsageError: the folder is not empty, or cannot be created.
    """
    stamp = time.time_ns() // 1_000_000
    name = f"{experiment.module_name}_{experiment.class_name}_{stamp}".replace("/", "-").replace("\\", "-")
    folder = HOME / name if out is None else out
    try:
        made = missing(folder)
        folder.mkdir(parents=True, exist_ok=True)
        is_used = any(folder.iterdir())
        (folder / RUNS).mkdir(exist_ok=True)
    except OSError as error:
        raise UsageError(f"cannot use {folder}: {error.strerror}; name another folder with --out") from error
    if is_used:
        raise UsageError(f"{folder} is not empty; name another folder with --out")
    return folder, made


class Results:
    """Writes the results after each test; the files are complete at any time."""

    def __init__(
        self, folder: Path, request: Request, draw: Draw | None = None, made: tuple[Path, ...] = ()
    ) -> None:
        """Uses an empty folder; ``made`` are the folders that were made for it, the innermost first."""
        self.folder = folder
        self._made = made
        self._request = request
        self._draw = draw
        self._tally = Tally()
        self._numbers: set[int] = set()

    def add(self, run: Run) -> dict[str, Any]:
        """Writes the files of a test; returns the content of its ``test.NNNN.json``."""
        test = test_of(run)
        write_run(run, self.folder, self._draw, json_text(test, indent=None))
        self._tally.add(run)
        self._numbers.add(run.index)
        self._tally.write(self.folder)
        return test

    @property
    def last(self) -> int:
        """The largest number of a test so far."""
        return max(self._numbers, default=0)

    def has(self, number: int) -> bool:
        """Returns whether a test with this number exists."""
        return number in self._numbers

    def describe(self, experiment: Experiment) -> None:
        """Writes ``experiment_description.csv``."""
        self._tally.write(self.folder)
        self._write_card(is_finished=False)
        row = described(experiment, self._request)
        text = io.StringIO()
        writer = csv.DictWriter(text, fieldnames=list(row), lineterminator="\n")
        writer.writeheader()
        writer.writerow(row)
        write_whole(self.folder / DESCRIPTION, text.getvalue())

    def close(self) -> None:
        """Marks the results as complete."""
        self._write_card(is_finished=True)

    def discard(self) -> None:
        """Removes all files that were written, for a generator that did not start."""
        names = (CARD, DESCRIPTION, *TABLES, LOG)
        take_away((self.folder / name for name in names), (self.folder / RUNS, *self._made))

    def _write_card(self, is_finished: bool) -> None:
        card = Card(request=self._request, roads=max(len(self._numbers), 1), is_finished=is_finished)
        write_whole(self.folder / CARD, json_text(card.model_dump(mode="json")))


def test_of(run: Run) -> dict[str, Any]:
    """Returns a test as the competition writes it; an invalid test has only the first five fields."""
    plan = interpolated_points(run)
    test: dict[str, Any] = {
        "is_valid": run.is_valid,
        "validation_message": run.validation_message,
        "road_points": [] if run.road is None else run.road.control_points().tolist(),
        "interpolated_points": plan.tolist(),
        "id": run.index,
    }
    if not run.is_valid:
        return test
    records = records_at_their_height(run)
    return test | {
        "execution_data": records,
        "test_outcome": run.outcome,
        "description": sbft_description(run),
        "features": features_of(plan, records),
    }


def described(experiment: Experiment, request: Request) -> dict[str, Any]:
    """Returns the columns of experiment_description.csv: the competition's in their order, then RoadGPT's."""
    setup, world = request.setup, request.world
    is_beamng = setup.simulator == "beamng"
    theirs = {
        "executor": setup.simulator,
        "dave2_model": "",
        "beamng_home": os.environ.get("ROADGPT_BEAMNG_HOME", "") if is_beamng else "",
        "beamng_user": os.environ.get("ROADGPT_BEAMNG_USER", "") if is_beamng else "",
        "time_budget": experiment.time_budget,
        "map_size": world.map_size,
        "oob_tolerance": world.oob_tolerance,
        "speed_limit": round(world.speed_limit * 3.6, 6),
        "module_name": experiment.module_name,
        "module_path": experiment.module_path,
        "class_name": experiment.class_name,
        "visualize_tests": "",
        "log_to": LOG,
        "debug": experiment.debug,
    }
    ours = {name: value for name, value in experiment.model_dump().items() if name not in theirs}
    driven = {"driver": setup.driver, "seed": request.seed}
    rest = {name: value for name, value in world.model_dump().items() if name not in theirs}
    return theirs | ours | driven | rest
