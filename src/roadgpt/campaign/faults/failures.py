"""Finds the failures of a campaign or a folder of runs, with their places and Runs; nothing is driven."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from roadgpt.campaign.faults.distinct import Surroundings, surroundings
from roadgpt.campaign.faults.reason import Manner, manner_of
from roadgpt.campaign.model import Cell, Result
from roadgpt.campaign.numbered_test import NumberedTest
from roadgpt.campaign.record import STORE, Record
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.road import Road, World, build
from roadgpt.run import Run, Setup, read_run
from roadgpt.run.card import CARD, read_card
from roadgpt.run.folder import finished, is_run, run_folder
from roadgpt.verdict.verdict import Verdict

AT_ONCE = 500  # tests that a store is asked for


@dataclass(frozen=True, eq=False)
class LocatedFailure:
    """A failure, with the place where it happened."""

    name: NumberedTest
    around: Surroundings
    manner: Manner
    station: float
    """Station of the failure, metres along the road."""
    outside: float | None
    """Largest share of the car that was outside its lane at one time, 0 to 1."""
    beyond: float | None
    """Largest distance of the car's body beyond the lane marking, metres."""


@dataclass(frozen=True)
class Failures:
    """The failures in a folder: all of them, or an evenly spread sample."""

    known: tuple[LocatedFailure, ...]
    every: int
    """Number of all failures in the folder. It includes failures that are not in the sample, and failures
    whose road is not stored.
    """


def failures_of(folder: Path, most: int | None = None, cell: str = "") -> Failures:
    """Returns the failures of a run, of a folder of runs, or of a campaign, cell by cell.

    Args:
        folder: the folder of the run, the runs or the campaign.
        most: maximum number of failures to return, evenly spread over all; None: no limit.
        cell: name of a cell of a campaign; empty: all cells.

    Raises:
        UsageError: the folder holds neither runs nor a campaign, or a file cannot be read.
    """
    if (folder / STORE).is_file():
        with Record.opened(folder) as record:
            names = record.query(
                "SELECT cell, number FROM tests WHERE outcome = 'FAIL' AND (? = '' OR cell = ?) "
                "ORDER BY cell, number",
                (cell, cell),
            )
            some = [NumberedTest(*names[at]) for at in _spread(len(names), most)]
            return Failures(tuple(_of_campaign(record, some)), len(names))
    if not is_run(folder) and not finished(folder):
        raise UsageError(f"there are no roads in {folder}; give the folder of a run or of a campaign")
    runs = [run for run in _runs(folder) if run.outcome == "FAIL"]
    some_runs = [runs[at] for at in _spread(len(runs), most)]
    return Failures(tuple(map(_of_run, some_runs)), len(runs))


def drivers_of(folder: Path) -> set[str]:
    """Returns the names of the drivers of a run, a folder of runs or a campaign.

    Raises:
        UsageError: the folder holds neither runs nor a campaign, or a file cannot be read.
    """
    if is_run(folder):
        return {read_run(folder).request.setup.driver}
    if (folder / STORE).is_file() or not finished(folder):
        with Record.opened(folder) as record:
            return {cell.request.setup.driver for cell in record.cells()}
    if (folder / CARD).is_file():
        return {read_card(folder).request.setup.driver}
    return {run.request.setup.driver for run in _runs(folder)}


def _spread(count: int, most: int | None) -> Sequence[int]:
    if most is None or count <= most:
        return range(count)
    return [int(at) for at in np.linspace(0, count - 1, most)]


def _runs(folder: Path) -> Iterator[Run]:
    for each in [folder] if is_run(folder) else [run_folder(folder, index) for index in finished(folder)]:
        yield read_run(each)


def _of_run(run: Run) -> LocatedFailure:
    assert run.road is not None
    assert run.verdict is not None
    its = run.verdict
    return _site_of(NumberedTest("", run.index), run.road, run.request.world, "", its)


def _of_campaign(record: Record, some: Sequence[NumberedTest]) -> Iterator[LocatedFailure]:
    cells: dict[str, Cell] = {cell.name: cell for cell in record.cells()}
    wanted = {name: [each.number for each in some if each.cell == name] for name in cells}
    for name, cell in cells.items():
        if not wanted[name]:
            continue
        system = system_of(cell.request.world, cell.request.setup)
        for start in range(0, len(wanted[name]), AT_ONCE):
            numbers = wanted[name][start : start + AT_ONCE]
            where = f"tests.number IN ({', '.join('?' * len(numbers))})"
            for its in record.results(name, where, numbers):
                if (found := _of_result(cell, its, system)) is not None:
                    yield found


def _of_result(cell: Cell, its: Result, system: str) -> LocatedFailure | None:
    """Returns the place of a failure; None where its road cannot be built any more."""
    if its.design is None:
        return None
    try:
        road = cell.request.world.lay(build(its.design, cell.request.setup.geometry))
    except RoadGPTError:  # of another version, which built it
        return None
    name = NumberedTest(cell.name, its.number)
    return _site_of(name, road, cell.request.world, system, its)


def system_of(world: World, setup: Setup) -> str:
    """Returns a text that identifies the driver, simulator and world of a cell.

    Failures with different texts never belong to the same fault.
    """
    return f"{setup.driver} {setup.simulator} {setup.keep_driving} {world.model_dump_json()}"


def _site_of(
    name: NumberedTest, road: Road, world: World, system: str, result: Verdict | Result
) -> LocatedFailure:
    station = result.at_s or 0.0
    around = surroundings(road, world, station, f"{result.cause} {result.side} {system}")
    manner = manner_of(road, world, station, result.cause, result.side)
    return LocatedFailure(name, around, manner, station, result.max_oob, result.beyond)
