"""Columns of tests: numbers that are computed of each test, by the names that ``results.csv`` has for them.

A plug-in ``columns`` is a ``ResultColumns``. Of its numbers those ``told`` also stand in JUnit, in lines
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
class ResultColumns:
    """Some columns of tests."""

    of: Callable[[Run], Mapping[str, float]]
    """Returns the numbers of a valid Run, which may lack a drive, by name; it leaves out what a Run lacks."""
    told: Mapping[str, Told] = field(default_factory=dict)
    """The columns that are also told, by name, in the order in which they are told."""
    bounds: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """The ranges of those that may be axes of feature maps in tables and reports; values beyond belong to the
    edge."""


class ToldNumber(NamedTuple):
    """A number of one test, as it is told."""

    part: str  # the plug-in that computes it
    key: str
    value: float
    text: str


def features_in(run: Run, told_alone: bool = False) -> dict[str, float]:
    """Returns the numbers of all columns of a valid road and its drive by name, or of those plug-ins alone
    that tell some; none of an invalid road."""
    found: dict[str, float] = {}
    is_invalid = run.road is None or (run.findings and run.drive is None)
    for name in () if is_invalid else plugins.names("columns"):
        part: ResultColumns = plugins.find("columns", name)
        try:
            own = {} if told_alone and not part.told else {**part.of(run)}
            if twice := found.keys() & own.keys():
                raise ValueError(f"another column is called {min(twice)}")
            found |= {column: float(value) for column, value in own.items()}
        except Exception as error:  # of another package, which may fail in any way
            raise PartError(
                f"the columns '{name}' cannot be computed ({type(error).__name__}: {error}); repair or "
                f"uninstall {plugins.origin('columns', name)}"
            ) from error
    return found


def told_of(features: Mapping[str, float]) -> tuple[ToldNumber, ...]:
    """Returns the numbers of a test that are told."""
    parts = {name: plugins.find("columns", name).told for name in plugins.names("columns")}
    return tuple(
        ToldNumber(name, told.key, features[column], told.text(features[column]))
        for name, its in parts.items()
        for column, told in its.items()
        if column in features
    )


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
