"""Finds the stored failures of a campaign or of runs, and where each failure occurred; no road is driven."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from roadgpt.campaign.faults.distinct import Surroundings, surroundings
from roadgpt.campaign.faults.reason import Manner, manner_of
from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.model import Cell
from roadgpt.campaign.numbered_test import NumberedTest
from roadgpt.campaign.record import Record
from roadgpt.errors import RoadGPTError
from roadgpt.road import World
from roadgpt.run import Setup

AT_ONCE = 500  # tests that are read from a store with one query


@dataclass(frozen=True, eq=False)
class LocatedFailure:
    """A failure, and where on the road it occurred."""

    name: NumberedTest
    around: Surroundings
    system: str
    """Text that identifies driver, simulator and world; see ``system_of``."""
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
    """Number of all failures in the folder, or in the cell that was chosen. It includes failures that are not
    in the sample, and failures whose road is not stored.
    """


def failures_of(folder: Path, most: int | None = None, cell: str = "") -> Failures:
    """Returns the failures of a run, of a folder of runs, or of a campaign, cell by cell.

    Failures whose road is not stored, or cannot be built, are counted but not returned.

    Args:
        folder: the folder of the run, the runs or the campaign.
        most: maximum number of failures to return, evenly spread over all; None: no limit.
        cell: name of a cell of a campaign; empty: all cells.

    Raises:
        UsageError: the folder holds neither runs nor a campaign, or a file cannot be read.
    """
    with open_record(folder) as record:
        names = record.query(
            "SELECT cell, number FROM tests WHERE outcome = 'FAIL' AND (? = '' OR cell = ?) "
            "ORDER BY cell, number",
            (cell, cell),
        )
        some = [NumberedTest(*names[at]) for at in _spread(len(names), most)]
        return Failures(tuple(_located(record, some)), len(names))


def drivers_of(folder: Path) -> set[str]:
    """Returns the names of the drivers of a run, a folder of runs or a campaign.

    Raises:
        UsageError: the folder holds neither runs nor a campaign, or a file cannot be read.
    """
    with open_record(folder) as record:
        return {cell.request.setup.driver for cell in record.cells()}


def _spread(count: int, most: int | None) -> Sequence[int]:
    if most is None or count <= most:
        return range(count)
    return [int(at) for at in np.linspace(0, count - 1, most)]


def _located(record: Record, some: Sequence[NumberedTest]) -> Iterator[LocatedFailure]:
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
                try:
                    road = record.road(cell, its)
                except RoadGPTError:  # the version that made the road could build it; this one cannot
                    continue
                if road is None:
                    continue
                world, station = cell.request.world, its.at_s or 0.0
                around = surroundings(road, world, station, f"{its.cause} {its.side} {system}")
                manner = manner_of(road, world, station, its.cause, its.side)
                test = NumberedTest(name, its.number)
                yield LocatedFailure(test, around, system, manner, station, its.max_oob, its.beyond)


def system_of(world: World, setup: Setup) -> str:
    """Returns a text that identifies the driver, simulator and world of a cell.

    Failures with different texts never belong to the same group or fault.
    """
    return f"{setup.driver} {setup.simulator} {setup.keep_driving} {world.model_dump_json()}"
