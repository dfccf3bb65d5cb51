"""Each row of data is a field and an option: both take the ends of its range, and nothing beyond."""

from math import inf
from pathlib import Path
from typing import Any, get_args

import click
import pytest
from pydantic import BaseModel, ValidationError

from roadgpt.chat import ChatSettings
from roadgpt.cli.options import Heading, of_rows
from roadgpt.road.world import CrossSection, Limits, Parts, Site, World
from roadgpt.settings import ROWS, rows_in, span
from roadgpt_beamng import settings as beamng

EVERY = {**ROWS, **rows_in(Path(beamng.__file__).with_name("options.toml"))}
MODELS: dict[str, tuple[type[BaseModel], ...]] = {
    "run": (Parts,), "world": (Site, CrossSection, Limits, World), "chat": (ChatSettings,),
    "beamng": (beamng.BeamngSettings,),
}  # fmt: skip
KEYS = (
    "help", "default", "kind", "choices", "from", "to", "above", "within", "unit", "heading", "rare", "key",
    "flag", "metavar", "open", "of_user",
)  # fmt: skip
FIELDS = [(table, name) for table, rows in EVERY.items() for name in rows if name != "oracle"]


def model_of(table: str, name: str) -> type[BaseModel]:
    (model,) = (each for each in MODELS[table] if name in each.model_fields)
    return model


@pytest.mark.parametrize(("table", "name"), FIELDS)
def test_a_row_fits_its_field(table: str, name: str) -> None:
    row, field = EVERY[table][name], model_of(table, name).model_fields[name]
    assert {*row} <= {*KEYS}
    assert row.get("heading", Heading.SITE) in [*Heading]
    literals = [one for kind in (field.annotation, *get_args(field.annotation)) for one in get_args(kind)]
    assert row.get("choices", []) == [one for one in literals if isinstance(one, str)]
    usual: dict[str, Any] = {name: field.default}
    assert getattr(model_of(table, name)(**usual), name) == field.default  # defaults are not checked


@pytest.mark.parametrize(
    ("table", "name"), [each for each in FIELDS if span(EVERY[each[0]][each[1]]) != (-inf, inf)]
)
def test_the_option_and_the_field_take_the_ends_of_the_range_and_nothing_beyond(
    table: str, name: str
) -> None:
    row, model, context = EVERY[table][name], model_of(table, name), click.Context(click.Command(None))
    (option,) = of_rows({name: row}, Heading.SITE, table)
    step = 1 if int in (type(row.get("default")), {"int": int}.get(row.get("kind", ""))) else 1e-3
    for end, outwards in zip(span(row), (-step, step), strict=True):
        if end == row.get("above"):
            outwards = 0.0
        elif abs(end) < inf:
            value: Any = option.read(option.type_cast_value(context, f"{end:.10g}"))
            assert value * option.unit == pytest.approx(end)
            assert getattr(model(**{name: value}), name) == value
        if abs(end) < inf:
            with pytest.raises(click.BadParameter):
                option.type_cast_value(context, f"{end + outwards:.10g}")
        if abs(end) < inf and "within" not in row:
            with pytest.raises(ValidationError):
                model(**{name: end + outwards})
