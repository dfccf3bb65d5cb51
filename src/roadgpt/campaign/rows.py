"""Converts results and cells to rows of the store and back, without loss."""

import json
import math
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

from pydantic import TypeAdapter, ValidationError

from roadgpt.campaign.model import Cell, Proposal, Result
from roadgpt.campaign.single_test import FinishedTest
from roadgpt.reading import json_of
from roadgpt.road import Design
from roadgpt.run.atomic import to_bytes

if TYPE_CHECKING:
    from roadgpt.network import AnyDesign

MEASURED = (
    "outcome", "cause", "side", "length", "margin", "max_oob", "beyond", "at_s", "own_share", "handed_to",
)  # fmt: skip
"""The columns of the table ``tests`` that hold the fields of a Result with the same names."""
SPENT = ("ended", "design_s", "drive_s", "tokens", "cost", "trace")
"""The columns of the table ``tests`` that depend on the clock or on the session."""
RESULT = ", ".join(("tests.number, batch, seed, given", *MEASURED, "origin, design, description, features"))
"""The columns of a result in the joined tables ``tests`` and ``details``."""


def design_text(design: "AnyDesign | None") -> str | None:
    """Returns a design as JSON; ``design_of`` restores the same design."""
    return None if design is None else design.model_dump_json(exclude_none=True)


def design_of(text: str | None) -> "AnyDesign | None":
    """Restores a design from JSON text as returned by ``design_text``."""
    if text is None:
        return None
    try:
        return Design.model_validate_json(text)
    except ValidationError:  # it has junctions or is a map, or is nothing at all
        return _designs().validate_json(text)


@cache
def _designs() -> "TypeAdapter[AnyDesign]":
    from roadgpt.network import AnyDesign

    return TypeAdapter(AnyDesign)


def values_of_test(ended: FinishedTest, now: float, trace: int | None) -> tuple[Any, ...]:
    """Returns the values for the columns ``MEASURED`` and ``SPENT`` of a test that has ended at ``now``.
    ``trace`` is the number of the file that holds the test's drive."""
    spent = ended.spent
    return (
        *(getattr(ended.result, name) for name in MEASURED),  # SQLite stores NaN as NULL
        now,
        round(ended.seconds.design, 4),
        round(ended.seconds.drive, 4),
        spent and spent.usage.total,
        spent and spent.cost,
        None if ended.trace is None else trace,
    )


def detail_values(ended: FinishedTest) -> tuple[Any, ...]:
    """Returns the values for the table ``details`` when a test has ended."""
    result = ended.result
    features = {name: float(value) for name, value in sorted(result.features.items()) if math.isfinite(value)}
    texts = (plain(result.description), json.dumps(features), plain(ended.error) or None)
    return (design_text(result.design), *texts)


def plain(text: str) -> str:
    """Returns text that UTF-8 can encode; other characters, as from a broken terminal, become escapes."""
    return to_bytes(text).decode()


def result_of_row(row: tuple[Any, ...]) -> Result:
    """Converts a row with the columns ``RESULT`` to a result."""
    number, batch, seed, given, *measured, origin, text, description, features = row
    values = _features_of(features)
    if not (isinstance(description, str) and isinstance(origin, str)):
        raise TypeError("a description is a text")
    design = design_of(text)
    proposal = Proposal(design if given else None, seed, origin)
    named = dict(zip(MEASURED, measured, strict=True))
    return Result(number, batch, proposal, description=description, design=design, features=values, **named)


def _features_of(text: str) -> dict[str, float]:
    """Reads features as ``detail_values`` wrote them; raises TypeError if there is anything else."""
    values = json_of(text)
    if not isinstance(values, dict) or not all(
        isinstance(value, (int, float)) and math.isfinite(value) for value in values.values()
    ):
        raise TypeError("features are finite numbers by name")
    return values


@cache
def _cells() -> TypeAdapter[Cell]:
    return TypeAdapter(Cell)


def cell_text(cell: Cell) -> str:
    """Returns a cell as JSON."""
    return _cells().dump_json(cell).decode()


def cell_of_text(text: str, file: object) -> Cell:
    """Restores a cell from JSON text as returned by ``cell_text``."""
    cell = _cells().validate_python(json_of(text))
    return replace(cell, request=cell.request.came_with(file))
