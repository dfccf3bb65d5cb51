"""Writes a folder of results with the competition's files, fields and columns, in the competition's order.

results/MODULE_CLASS_STAMP/
  test.NNNN.json  generation_stats.csv  oob_stats.csv  experiment_description.csv    the competition's
  campaign.json  runs/NNNN/  overview.png  generator.log                             RoadGPT's
"""

import os
import time
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.errors import UsageError, explained
from roadgpt.geometry import interpolate
from roadgpt.run import Run
from roadgpt.run.atomic import json_text, missing, take_away, write_whole
from roadgpt.run.card import CARD, Card
from roadgpt.run.execution import records_of
from roadgpt.run.features import features_of
from roadgpt.run.folder import RUNS, Draw, write_run
from roadgpt.run.model import Request
from roadgpt.run.tables import DESCRIPTION, SETTINGS, TABLES, Tally, TallyEntry, write_settings
from roadgpt.sbft.experiment import Experiment

HOME = Path("results")
LOG = "generator.log"
SUCCESS = "Successful test"
HEIGHT = -28.0  # m, of the ground of the competition's level


def new_folder(experiment: Experiment, out: Path | None = None) -> tuple[Path, tuple[Path, ...]]:
    """Creates the folder for results; by default, it has the name that the competition would give it.

    Returns:
        The folder, and all folders that were created for it, the innermost first.

    Raises:
        UsageError: the folder is not empty, or cannot be created.
    """
    stamp = time.time_ns() // 1_000_000
    name = f"{experiment.module_name}_{experiment.class_name}_{stamp}".replace("/", "-").replace("\\", "-")
    folder = HOME / name if out is None else out
    with explained(UsageError, f"cannot use {folder}", "name another folder with --out"):
        made = missing(folder)
        folder.mkdir(parents=True, exist_ok=True)
        is_used = any(folder.iterdir())
        (folder / RUNS).mkdir(exist_ok=True)
    if is_used:
        raise UsageError(f"{folder} is not empty; name another folder with --out")
    return folder, made


class Results:
    """Writes the result files after each test, so that they are complete at any time."""

    def __init__(
        self, folder: Path, request: Request, draw: Draw | None = None, made: tuple[Path, ...] = ()
    ) -> None:
        """Uses an empty folder; ``made`` are the folders that were made for it, the innermost first."""
        self.folder = folder
        self._made = made
        self._request = request
        self._draw = draw
        self._tally = Tally()
        self.numbers: set[int] = set()
        """Numbers of the tests so far."""

    def add(self, run: Run) -> dict[str, Any]:
        """Writes the files of a test; returns the content of its ``test.NNNN.json``."""
        test = test_of(run)
        write_run(run, self.folder, self._draw, json_text(test, indent=None))
        self._tally.add(TallyEntry.of(run))
        self.numbers.add(run.index)
        self._tally.write(self.folder)
        return test

    def describe(self, experiment: Experiment) -> None:
        """Writes the settings, and tables of results in which all counts are 0."""
        self._tally.write(self.folder)
        self._write_card(is_finished=False)
        setup, told = self._request.setup, experiment.model_dump()
        is_beamng = setup.simulator == "beamng"
        homes = {
            f"beamng_{name}": os.environ.get(f"ROADGPT_BEAMNG_{name.upper()}", "") if is_beamng else ""
            for name in ("home", "user")
        }
        theirs = {name: value for name, value in told.items() if name in SETTINGS} | homes | {"log_to": LOG}
        ours = {name: value for name, value in told.items() if name not in SETTINGS}
        driven = {"driver": setup.driver, "seed": self._request.seed}
        write_settings(self._request, theirs, ours | driven, self.folder)

    def close(self) -> None:
        """Marks the results as complete."""
        self._write_card(is_finished=True)

    def discard(self) -> None:
        """Removes all files that were written; called if the generator could not be started."""
        names = (CARD, DESCRIPTION, *TABLES, LOG)
        take_away((self.folder / name for name in names), (self.folder / RUNS, *self._made))

    def _write_card(self, is_finished: bool) -> None:
        card = Card(request=self._request, roads=max(len(self.numbers), 1), is_finished=is_finished)
        write_whole(self.folder / CARD, json_text(card.model_dump(mode="json")))


def test_of(run: Run) -> dict[str, Any]:
    """Returns the fields of the competition's file for a test. An invalid test has only the fields up to
    ``id``.

    The heights of the drive are lowered by 28 m: the ground of the competition's level is at -28 m.
    """
    control = np.empty((0, 2)) if run.road is None else run.road.control_points()
    nodes = control if run.road is None else interpolate(control)
    test: dict[str, Any] = {
        "is_valid": run.is_valid,
        "validation_message": run.validation_message,
        "road_points": control.tolist(),
        "interpolated_points": nodes.tolist(),
        "id": run.index,
    }
    if not run.is_valid:
        return test
    records = (
        records_of(run.road, run.drive, run.world) if run.road is not None and run.drive is not None else []
    )
    lowered = [one._replace(pos=[*one.pos[:2], round(one.pos[2] + HEIGHT, 4)]) for one in records]
    said = run.description if run.verdict is None else run.verdict.sbft_description
    if run.verdict is not None and said != SUCCESS:
        said += f" {run.request.setup.simulator}/{run.index:04d}"
    return test | {
        "execution_data": lowered,
        "test_outcome": run.outcome,
        "description": said,
        "features": features_of(nodes, lowered),
    }
