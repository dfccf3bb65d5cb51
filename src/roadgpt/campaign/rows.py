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

MEASURED = ("outcome", "cause", "side", "length", "margin", "max_oob", "beyond", "at_s")
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


def proposal_rows(
    cell: str, batch: int, number: int, proposal: Proposal
) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """Returns the rows of a proposed test for the tables ``tests`` and ``details``."""
    given = proposal.design is not None
    return (
        (cell, number, batch, proposal.seed, given),
        (cell, number, _plain(proposal.origin), design_text(proposal.design)),
    )


def result_values(result: Result) -> tuple[Any, ...]:
    """Returns a result's values for the columns listed in ``MEASURED``."""
    return tuple(_stored(getattr(result, name)) for name in MEASURED)


def detail_values(ended: FinishedTest) -> tuple[Any, ...]:
    """Returns the values that are written to the table ``details`` when a test has ended."""
    result = ended.result
    features = {name: float(value) for name, value in sorted(result.features.items()) if math.isfinite(value)}
    texts = (_plain(result.description), json.dumps(features), _plain(ended.error) or None)
    return (design_text(result.design), *texts)


def _plain(text: str) -> str:
    """Returns text that UTF-8 can encode; other characters, as from a broken terminal, become escapes."""
    return to_bytes(text).decode()


def _stored(value: str | float | None) -> str | float | None:
    """Returns None for NaN, which SQLite does not have, and other values unchanged."""
    if value is None or isinstance(value, str):
        return value
    return None if math.isnan(value) else float(value)


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
    """Reads features as ``detail_values`` wrote them; raises TypeError if the text holds anything else."""
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
