"""Finds the stored failures of a campaign or of runs, and where each failure occurred; no road is driven."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

from roadgpt.campaign.faults.distinct import Surroundings, surroundings
from roadgpt.campaign.faults.reason import Manner, manner_of
from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.model import NumberedTest
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
    """Text that identifies driver, simulator and world; failures with different texts are never joined."""
    manner: Manner
    station: float
    """Station of the failure, metres along the road."""
    outside: float | None
    """Largest share of the car that was outside its lane at one time, 0 to 1."""
    beyond: float | None
    """Largest distance of the car's body beyond the lane marking, metres."""


def failures_of(folder: Path, most: int | None = None, cell: str = "") -> tuple[list[LocatedFailure], int]:
    """Returns the failures of a run, a folder of runs, or a campaign, cell by cell, and how many there are.

    At most ``most`` failures are returned, evenly spread over all. The number also counts the failures left
    out, and those whose road is not stored or cannot be built.

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
        return [*_located(record, some)], len(names)


def _spread(count: int, most: int | None) -> Sequence[int]:
    if most is None or count <= most:
        return range(count)
    return [int(at) for at in np.linspace(0, count - 1, most)]


def _located(record: Record, some: Sequence[NumberedTest]) -> Iterator[LocatedFailure]:
    """Yields those of the failures, which are sorted by cell, whose road can be built."""
    cells = {cell.name: cell for cell in record.cells()}
    for name, tests in groupby(some, key=lambda each: each.cell):
        cell, every = cells[name], [each.number for each in tests]
        system = system_of(cell.request.world, cell.request.setup)
        for start in range(0, len(every), AT_ONCE):
            numbers = every[start : start + AT_ONCE]
            where = f"tests.number IN ({', '.join('?' * len(numbers))})"
            for its in record.results(name, where, numbers):
                try:
                    road = record.road(cell, its)
                except RoadGPTError:  # the version that made the road could build it; this one cannot
                    continue
                if road is None:
                    continue
                world, station = cell.request.world, its.at_s or 0.0
                whose = f"{system} {its.handed_to or ''}"
                around = surroundings(road, world, station, f"{its.cause} {its.side} {whose}")
                manner = manner_of(road, world, station, its.cause, its.side)
                test = NumberedTest(name, its.number)
                yield LocatedFailure(test, around, whose, manner, station, its.max_oob, its.beyond)


def system_of(world: World, setup: Setup) -> str:
    """Returns a text that identifies the driver, simulator and world of a cell."""
    return f"{setup.driver} {setup.simulator} {setup.keep_driving} {world.model_dump_json()}"
