"""Reads plans of campaigns from TOML files; an error message names the wrong key and explains how to correct
it.
"""

import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    AliasChoices,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
)

from roadgpt.brief.words import LARGEST_MAP, SMALLEST_MAP, USUAL_MAP
from roadgpt.campaign.model import MOST_TESTS, PATIENCE, WITH_GOAL, WITHOUT_GOAL, CellBudget, Goal
from roadgpt.campaign.plan import Plan, Seed
from roadgpt.chat import ChatSettings
from roadgpt.drive.loading import absolute_spec
from roadgpt.errors import UsageError
from roadgpt.reading import read_text
from roadgpt.road import Geometry, World
from roadgpt.road.world import STEEPEST, Lanes, NotNegative, Positive, bank_in

LARGEST = 4_000_000  # bytes of a file
FOLDERS = ("record", "replay")  # keys of [chat] that name a folder

ADVICE = {
    "greater_than_equal": "give {ge:g} or more",
    "greater_than": "give more than {gt:g}",
    "less_than_equal": "give {le:g} or less",
    "less_than": "give less than {lt:g}",
    "literal_error": "give {expected}",
    "int_type": "give a whole number",
    "float_type": "give a number",
    "string_type": "give a text in quotes",
    "string_too_short": "give a text that is not empty",
    "bool_type": "give true or false",
    "too_short": "give at least one",
    "model_type": "give a table",
    "dict_type": "give a table",
}
"""Advice to the user on each kind of mistake, by pydantic's name for it."""


def _listed(value: Any) -> Any:
    """Returns a list as a tuple, and any other value as a tuple of this one value."""
    return tuple(value) if isinstance(value, list) else (value,)


Words = Annotated[str, Field(min_length=1)]
Texts = Annotated[tuple[Words, ...], BeforeValidator(_listed), Field(min_length=1)]
Seeds = Annotated[tuple[Seed, ...], BeforeValidator(_listed), Field(min_length=1)]


Percentage = Annotated[
    str | float, AfterValidator(partial(bank_in, most=100 * STEEPEST, unit="a percentage"))
]


class _Strict(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class WorldTable(_Strict):
    """The table ``[world]`` of a plan file, in the units of the command line."""

    map_size: Annotated[float, Field(ge=SMALLEST_MAP, le=LARGEST_MAP)] = USUAL_MAP
    lanes: Lanes = "1+1"
    lane_width: Annotated[float, Field(ge=2, le=10)] = 4.0
    lane_width_end: Annotated[float, Field(ge=2, le=10)] | None = None
    bank: Percentage = "none"
    """Superelevation of bends: ``"none"``, ``"auto"`` for the values of CD 109, or a number in percent."""
    shoulder: Annotated[NotNegative, Field(validation_alias=AliasChoices("shoulder", "verge"))] = 3.0
    """Width of the shoulder; ``verge`` is its earlier name."""
    friction: Annotated[float, Field(gt=0, le=2)] = 1.0
    speed_limit_kmh: Annotated[float, Field(ge=5, le=300)] = 70.0
    oracle: Annotated[str, BeforeValidator(str)] | None = None
    oob_tolerance: Annotated[float, Field(gt=0, le=1)] | None = None
    lane_departure: bool | None = None
    min_radius: Positive = 14.326
    max_grade: Annotated[float, Field(gt=0, le=1)] = 0.15

    def world(self) -> World:
        """Returns the World with these values; lanes, friction and map size stay unset if the file does not
        give them, so that prompts can set them.
        """
        open_ = {"lanes", "friction", "map_size"} - self.model_fields_set
        values = self.model_dump(exclude={"speed_limit_kmh", *open_}, exclude_none=True)
        bank = self.bank / 100 if isinstance(self.bank, float) else self.bank
        return World().changed(**values | {"speed_limit": self.speed_limit_kmh / 3.6, "bank": bank})


class PlanTable(_Strict):
    """The keys of a plan file at its top level."""

    prompts: Texts = ()
    designers: Texts = ("planner",)
    drivers: Texts = ("lane_centring",)
    simulators: Texts = ("mujoco",)
    generators: Texts = ()
    seeds: Seeds = (0,)
    goal: Goal | None = None
    tests: Annotated[int, Field(ge=1, le=MOST_TESTS)] | None = None
    seconds: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    test_seconds: Annotated[float, Field(gt=0, allow_inf_nan=False)] = PATIENCE
    reader: Words = "model"
    rules: Literal["strict", "sbft"] = "strict"
    geometry: Geometry = "arcs"
    keep_driving: bool = False
    drive: bool = True
    paired: bool = False
    world: WorldTable = WorldTable()
    chat: dict[str, Any] = {}
    settings: dict[str, Any] = {}


class PlanFile(BaseModel):
    """The content of a plan file: the plan, and the settings of the language models."""

    plan: Plan
    chat: dict[str, Any]


def read_plan(path: Path) -> PlanFile:
    """Reads the plan in a file.

    Raises:
        UsageError: the file is not TOML, or one of its keys or values cannot be used.
    """
    try:
        data = tomllib.loads(read_text(path, LARGEST, "a plan of a campaign", "utf-8-sig"))
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror}; check the path") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise UsageError(f"{path} is not TOML: {error}; correct it") from error
    try:
        table = PlanTable.model_validate(data)
        ChatSettings.model_validate(table.chat).came_with(path)
        table.world.world()
    except UsageError as error:
        raise UsageError(f"{path}: {error}") from error
    except ValidationError as error:
        within = ("chat",) if error.title == ChatSettings.__name__ else ()
        raise UsageError(f"{path}: {_sentence(error, within)}") from error
    folder = path.parent.absolute()
    chat = {name: str(folder / value) if name in FOLDERS else value for name, value in table.chat.items()}
    return PlanFile(plan=_plan(table, folder).came_with(path), chat=chat)


def _plan(table: PlanTable, folder: Path) -> Plan:
    """Returns the plan of a file; relative paths in the file start from ``folder``."""
    reader, colon, weights = table.reader.partition(":")
    named_alike = {name: getattr(table, name) for name in PlanTable.model_fields if name in Plan.model_fields}
    read = {
        "prompts": table.prompts or ("",),
        "drivers": tuple(absolute_spec(driver, folder) for driver in table.drivers),
        "generators": table.generators or (WITH_GOAL if table.goal else WITHOUT_GOAL,),
        "budget": CellBudget(tests=table.tests, seconds=table.seconds),
        "reader": f"{reader}:{folder / weights}" if colon else reader,
        "drives": table.drive,
        "world": table.world.world(),
        "patience": table.test_seconds,
        "chat": None,
    }
    return Plan(**named_alike | read)


def _sentence(error: ValidationError, within: tuple[str, ...]) -> str:
    """Describes the first mistake: where it is, what it is, and what to do."""
    mistake = error.errors()[0]
    place = (*within, *mistake["loc"])
    key = ".".join(str(part + 1 if isinstance(part, int) else part) for part in place)
    if mistake["type"] == "extra_forbidden":
        known = _keys(place[:-1])
        near = get_close_matches(str(place[-1]).lower(), known, 1, 0.5)
        advice = f"did you mean '{near[0]}'?" if near else f"keys are {', '.join(known)}"
        return f"'{key}' is not a key of a campaign; {advice}"
    advice = ADVICE.get(mistake["type"], "").format(**mistake.get("ctx", {}))
    message = str(mistake["msg"]).removeprefix("Value error, ")
    return f"{key}: {_short(mistake['input'])} is not possible; {advice or message[:1].lower() + message[1:]}"


def _keys(place: tuple[Any, ...]) -> list[str]:
    models: Mapping[str, type[BaseModel]] = {"world": WorldTable, "chat": ChatSettings}
    model = models.get(str(place[0]), PlanTable) if place else PlanTable
    return [*model.model_fields]


def _short(value: Any) -> str:
    text = repr(value)
    return f"{text[:40]}..." if len(text) > 43 else text
