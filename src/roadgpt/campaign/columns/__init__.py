"""Columns of tests: numbers that are computed of each test, by the names that ``results.csv`` has for them.

A plug-in ``columns`` is a ``Columns``. Those of its numbers that are ``told`` also stand in JUnit, in lines
of JSON, in what ``run`` and ``show`` print, and in the report's table of failures."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from roadgpt import plugins
from roadgpt.errors import PartError
from roadgpt.run import Run


class Told(NamedTuple):
    """How a column is told."""

    key: str  # its name in JUnit, JSON and the report, with the unit: "gap_m"
    text: Callable[[float], str]  # as commands print it: ``"gap {:.1f} m".format``; nothing, if it is empty


@dataclass(frozen=True)
class Columns:
    """Some columns of tests."""

    of: Callable[[Run], Mapping[str, float]]
    """Returns the numbers of a valid Run, which may lack a drive, by name; it leaves out what a Run lacks."""
    told: Mapping[str, Told] = field(default_factory=dict)
    """The columns that are also told, by name, in the order in which they are told."""
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """The ranges of the columns that may be axes of a feature map; values beyond belong to its edge."""


class ToldNumber(NamedTuple):
    """A number of one test, as it is told."""

    part: str  # the plug-in that computes it
    key: str
    value: float
    text: str


def features_in(run: Run) -> dict[str, float]:
    """Returns the numbers of all columns of a valid road and its drive by name; none of an invalid road."""
    found: dict[str, float] = {}
    for name in plugins.names("columns"):
        own = _computed(name, run)
        if twice := found.keys() & own.keys():
            origin = plugins.origin("columns", name)
            raise PartError(f"several columns are called {min(twice)}, one of them of {origin}; rename it")
        found |= own
    return found


def _computed(name: str, run: Run) -> dict[str, float]:
    if run.road is None or (run.findings and run.drive is None):
        return {}
    part: Columns = plugins.find("columns", name)
    try:
        return {column: float(value) for column, value in part.of(run).items()}
    except Exception as error:  # of another package, which may fail in any way
        raise PartError(
            f"the columns '{name}' cannot be computed ({type(error).__name__}: {error}); repair or uninstall "
            f"{plugins.origin('columns', name)}"
        ) from error


def told_of(test: Run | Mapping[str, float]) -> tuple[ToldNumber, ...]:
    """Returns those numbers of a Run, or among the features of a stored result, that are told."""
    found = list[ToldNumber]()
    for name in plugins.names("columns"):
        part: Columns = plugins.find("columns", name)
        numbers = test if not isinstance(test, Run) else _computed(name, test) if part.told else {}
        found += [
            ToldNumber(name, told.key, numbers[column], told.text(numbers[column]))
            for column, told in part.told.items()
            if column in numbers
        ]
    return tuple(found)


def bounds_of_columns() -> dict[str, tuple[float, float]]:
    """Returns the range of each column that may be an axis of a feature map."""
    parts = (plugins.find("columns", name) for name in plugins.names("columns"))
    return {axis: bounds for part in parts for axis, bounds in part.bounds.items()}


def cell_of(
    features: Mapping[str, float], axes: Sequence[str], cells: int, bounds: Mapping[str, tuple[float, float]]
) -> tuple[int, ...] | None:
    """Returns the cell of the feature map to which a test belongs, as one index per axis; None if
    ``features`` lacks one of the axes. ``cells`` is the number of cells along each axis."""
    if any(axis not in features for axis in axes):
        return None
    place = []
    for axis in axes:
        low, high = bounds[axis]
        share = (features[axis] - low) / (high - low)
        place.append(int(min(max(share * cells, 0), cells - 1)))
    return tuple(place)
