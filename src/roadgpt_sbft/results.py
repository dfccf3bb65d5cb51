"""Writes a folder of results with the competition's files, fields and columns, in the competition's order.

results/MODULE_CLASS_STAMP/
  test.NNNN.json  generation_stats.csv  oob_stats.csv  experiment_description.csv    the competition's
  runs/NNNN/  generator.log                             RoadGPT's
"""

import os
import time
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from roadgpt.brief.model import Frozen
from roadgpt.campaign.run_folder import Tables, entries_of, writing
from roadgpt.errors import UsageError, explained
from roadgpt.geometry import interpolate
from roadgpt.run import Draw, Request, Run, atomic, execution
from roadgpt.run.folder import RUNS, write_run_folder
from roadgpt_sbft.tables import SETTINGS, write_settings

HOME = Path("results")
LOG = "generator.log"
SUCCESS = "Successful test"
HEIGHT = -28.0  # m, of the ground of the competition's level

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class Experiment(Frozen):
    """One generator and its budget."""

    module_name: str
    """Name under which Python imports the generator's module."""
    class_name: str
    module_path: str | None = None
    """An additional folder in which Python searches for modules."""
    python: str | None = None
    """The Python interpreter in which the generator runs; None: the interpreter that runs RoadGPT."""
    time_budget: Positive | None = None
    """Seconds of wall time for generating and driving."""
    test_budget: Annotated[int, Field(ge=1)] | None = None
    """Number of tests, including invalid ones. Unlike time, it does not depend on the speed of the
    machine."""
    patience: Positive = 600.0
    """Seconds of wall time within which the generator must submit its next test."""
    grace: Positive = 30.0
    """Seconds of wall time within which the generator must stop after its budget is used up."""
    debug: bool = False
    """Whether the generator writes a more detailed log."""


def new_folder(experiment: Experiment, out: Path | None = None) -> tuple[Path, tuple[Path, ...]]:
    """Creates the folder for results; if ``out`` is None, in ``results`` under the competition's name.
    Returns the folder, and all folders that were created on its path, the innermost first."""
    stamp = time.time_ns() // 1_000_000
    name = f"{experiment.module_name}_{experiment.class_name}_{stamp}".replace("/", "-").replace("\\", "-")
    folder = HOME / name if out is None else out
    with explained(UsageError, f"cannot use {folder}", "name another folder with --out"):
        made = atomic.missing(folder)
        folder.mkdir(parents=True, exist_ok=True)
        is_used = any(folder.iterdir())
        (folder / RUNS).mkdir(exist_ok=True)
    if is_used:
        raise UsageError(f"{folder} is not empty; name another folder with --out")
    return folder, made


class Results:
    """Writes the result files after each test, so that they are complete at any time."""

    def __init__(self, folder: Path, request: Request, made: tuple[Path, ...], draw: Draw | None) -> None:
        self.folder, self.request, self._made, self._draw = folder, request, made, draw
        self.numbers: set[int] = set()
        """The numbers of the tests that are written."""
        self._tables = Tables(folder)

    def write(self, run: Run) -> dict[str, Any]:
        """Writes the files of a test; returns the content of its ``test.NNNN.json``."""
        test = test_of(run)
        with writing(self.folder):
            write_run_folder(run, self.folder, self._draw)
            atomic.write_whole(
                self.folder / execution.test_name(run.index), atomic.json_text(test, indent=None)
            )
            self.numbers.add(run.index)
            self._tables.add(entries_of(run))
            self._tables.write()
        return test

    def describe(self, experiment: Experiment) -> None:
        """Writes the settings, and result tables with all counts at 0; called before the first test."""
        setup, told = self.request.setup, experiment.model_dump()
        is_beamng = setup.simulator == "beamng"
        homes = {
            f"beamng_{name}": os.environ.get(f"ROADGPT_BEAMNG_{name.upper()}", "") if is_beamng else ""
            for name in ("home", "user")
        }
        theirs = {name: value for name, value in told.items() if name in SETTINGS} | homes | {"log_to": LOG}
        ours = {name: value for name, value in told.items() if name not in SETTINGS}
        driven = {"driver": setup.driver, "seed": self.request.seed}
        with writing(self.folder):
            self._tables.write()
            write_settings(self.request, theirs, ours | driven, self.folder)

    def take_away(self, *names: str) -> None:
        """Removes the tables and the files in ``names``; then the folders that were created for them, if they
        are empty."""
        every = (*self._tables.files, *names)
        atomic.take_away((self.folder / name for name in every), (self.folder / RUNS, *self._made))


def test_of(run: Run) -> dict[str, Any]:
    """Returns the fields of the competition's file for a test, in which the ground is at -28 m; an invalid
    test has only the fields up to ``id``."""
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
    drive = run.drive
    records = [] if run.road is None or drive is None else execution.records_of(run.road, drive, run.world)
    lowered = [one._replace(pos=[*one.pos[:2], round(one.pos[2] + HEIGHT, 4)]) for one in records]
    said = run.description if run.verdict is None else run.verdict.sbft_description
    if run.verdict is not None and said != SUCCESS:
        said += f" {run.request.setup.simulator}/{run.index:04d}"
    return test | {
        "execution_data": lowered,
        "test_outcome": run.outcome,
        "description": said,
        "features": execution.features_of(nodes, lowered),
    }
