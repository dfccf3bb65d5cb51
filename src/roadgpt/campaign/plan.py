"""The Plan of a campaign: every combination of prompts, designers, drivers, simulators, generators and seeds.

Each combination is a cell with a budget of its own; all other values of the plan are the same for all cells.
A plan may be a TOML file; an error message names the wrong key and explains how to correct it."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from difflib import get_close_matches
from functools import partial
from itertools import product
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, Field, ValidationError

from roadgpt import plugins
from roadgpt.brief.model import Brief, Frozen
from roadgpt.brief.scene_fit import fitted
from roadgpt.brief.words import LARGEST_MAP, SMALLEST_MAP, USUAL_MAP
from roadgpt.campaign.model import (
    MOST_TESTS,
    PATIENCE,
    UNLIMITED,
    WITH_GOAL,
    WITHOUT_GOAL,
    Cell,
    CellBudget,
    Goal,
)
from roadgpt.chat import ChatSettings, asks_a_model
from roadgpt.design.room import world_for
from roadgpt.drive.loading import absolute_spec, driver_from_file
from roadgpt.errors import UsageError, advice_on
from roadgpt.reading import read_text, toml_of
from roadgpt.road import Geometry, World
from roadgpt.road.world import STEEPEST, Avoider, Lanes, NotNegative, Positive, bank_in
from roadgpt.run.model import Request, Setup

MOST_CELLS = 100_000

Names = Annotated[tuple[str, ...], Field(min_length=1)]
Seed = Annotated[int, Field(ge=0, lt=2**63)]


def _listed(value: Any) -> Any:
    return tuple(value) if isinstance(value, list | tuple) else (value,)


Words = Annotated[str, Field(min_length=1)]
Texts = Annotated[tuple[Words, ...], BeforeValidator(_listed), Field(min_length=1)]
Seeds = Annotated[tuple[Seed, ...], BeforeValidator(_listed), Field(min_length=1)]


class PlanChoices(Frozen):
    """The settings that a plan and its file have alike."""

    prompts: Names = ("",)
    """Descriptions of roads; an empty text if the generator needs no description."""
    designers: Texts = ("planner",)
    drivers: Texts = ("lane_centring",)
    """Names of installed drivers, or ``FILE.py:CLASS``."""
    simulators: Texts = ("mujoco",)
    generators: Names = (WITHOUT_GOAL,)
    seeds: Seeds = (0,)
    goal: Goal | None = None
    settings: dict[str, Any] = Field(default_factory=dict)
    """Settings of the generators: the value of each setting, by its name."""
    reader: Words = "model"
    rules: Literal["strict", "sbft"] = "strict"
    geometry: Geometry = "arcs"
    keep_driving: bool = False
    paired: bool = False
    """Whether the drivers are compared on the same roads at the end."""


class Plan(PlanChoices):
    """The settings of a campaign."""

    budget: CellBudget = UNLIMITED
    """The limits of each cell."""
    drives: bool = True
    world: World = World()
    chat: ChatSettings | None = None
    patience: Annotated[float, Field(gt=0, allow_inf_nan=False)] = PATIENCE
    """Longest time for one test, seconds; a test that takes longer is treated as hanging."""
    on: str = ""
    """Where the roads in ``settings`` were found; empty if roads are designed."""
    left_out: Mapping[str, str] = Field(default_factory=dict)
    """Why a file there is not tested, by its name."""

    @classmethod
    def of(cls, request: Request, tests: int) -> "Plan":
        """Returns the Plan of the tests of one Request."""
        setup = request.setup
        named = ("reader", "rules", "geometry", "keep_driving", "drives", "chat")
        lists = {f"{name}s": (getattr(setup, name),) for name in ("designer", "driver", "simulator")}
        alike = {name: getattr(setup, name) for name in named}
        own = {"prompts": (request.words,), "seeds": (request.seed,), "world": request.world}
        return cls(budget=CellBudget(tests=tests), **own | lists | alike)

    def essence(self) -> "Plan":
        """Returns the Plan without the settings that may change when the campaign is resumed."""
        chat = self.chat and self.chat.essence()
        return self.model_copy(
            update={"chat": chat, "patience": PATIENCE, "paired": False, "on": "", "left_out": {}}
        )

    def came_with(self, file: object) -> "Plan":
        """Returns the Plan read from a file that another person may have written: RoadGPT asks before it runs
        a driver's file, or sends the user's API key to a server, that only this file names."""
        chat = self.chat and self.chat.came_with(file)
        drivers = tuple(driver_from_file(driver, file) for driver in self.drivers)
        world = self.world.with_heights_in(Path(str(file)).parent)
        return self.model_copy(update={"chat": chat, "drivers": drivers, "world": world})

    @property
    def asks_a_model(self) -> bool:
        """True if the reader or a designer asks a language model."""
        return any(self._asks(designer) for designer in self.designers)

    def _asks(self, designer: str) -> bool:
        parts = (("readers", self.reader.partition(":")[0]), ("designers", designer))
        return any(asks_a_model(plugins.find(shelf, name)) for shelf, name in parts)

    def _searches(self, generator: str) -> bool:
        """Returns whether a generator can search for the goal; a plan may list others for comparison."""
        if self.goal is None:
            return False
        return self.goal in getattr(plugins.find("generators", generator), "goals", ())

    @property
    def _lists(self) -> tuple[tuple[Any, ...], ...]:
        return self.prompts, self.designers, self.drivers, self.simulators, self.generators, self.seeds

    def requests(self) -> Iterator[tuple[Request, str]]:
        """Yields the Request of each cell and the name of its generator, in the order of the cells."""
        for words, designer, driver, simulator, generator, seed in product(*self._lists):
            setup = Setup(
                reader=self.reader,
                designer=designer,
                rules=self.rules,
                driver=driver,
                simulator=simulator,
                # some designers need one geometry; generators that change their segments need it, too
                geometry=getattr(plugins.find("designers", designer), "geometry", None) or self.geometry,
                keep_driving=self.keep_driving,
                drives=self.drives,
                chat=self.chat if self._asks(designer) else None,
            )
            yield Request(words=words, seed=seed, world=self.world, setup=setup), generator

    def check(self) -> None:
        """Checks the plan without running a test."""
        cells = math.prod(map(len, self._lists))
        if cells > MOST_CELLS:
            raise UsageError(
                f"the plan has {cells:,} cells, more than {MOST_CELLS:,}; make several plans of it"
            )
        if self.budget == UNLIMITED:
            raise UsageError("there is no limit; give a number of tests (-n 200) or --seconds")
        if self.goal is not None and not self.drives:
            raise UsageError(
                f"a search (--goal {self.goal}) learns from drives; leave out the goal, or drive the roads"
            )
        for values in self._lists:
            twice = [value for value, count in Counter(values).items() if count > 1]
            if twice:
                raise UsageError(
                    f"{twice[0]!r} is listed twice, which would run the same tests twice; list it once"
                )
        searches = any(hasattr(plugins.find("generators", name), "goals") for name in self.generators)
        if self.paired and (searches or not self.drives or len(self.drivers) < 2):
            raise UsageError(
                "only two drivers or more that get the same roads can be compared as pairs; name them "
                "(--drivers a,b), and leave out a search and --no-drive"
            )
        for name in self.generators:
            has_words = "scenario" in self.settings or all(words.strip() for words in self.prompts)
            if name == WITHOUT_GOAL and not has_words:
                raise UsageError("the generator 'words' needs a description; give one, or another generator")
        if self.goal is not None and not any(self._searches(name) for name in self.generators):
            raise UsageError(
                f"the generator {self.generators[0]!r} does not search for {self.goal!r}; leave out the "
                f"goal, or take another generator, such as {WITH_GOAL!r}"
            )
        for shelf, names in (("designers", self.designers), ("simulators", self.simulators)):
            for name in names:
                plugins.find(shelf, name)
        plugins.find("readers", self.reader.partition(":")[0])

    def cells(self, briefs: Mapping[str, Brief]) -> list[Cell]:
        """Returns all cells, with the Briefs of the prompts. If the plan's World gives no friction, a surface
        that a Brief names, such as a wet road, determines the friction in its cells."""
        made = []
        for request, generator in self.requests():
            brief = briefs.get(request.words)
            if "scenario" in self.settings:  # each test has its own World
                brief = brief or Brief()
            else:
                request = request.model_copy(update={"world": (world := world_for(brief, request.world))})
                brief = brief and fitted(brief, world.scene, world.limits.speed_limit, world.given_map)
            made.append((request, generator, brief))
        wide = max(2, len(str(len(made))))
        return [
            Cell(
                name=f"c{number:0{wide}d}",
                request=request,
                brief=brief,
                generator=generator,
                goal=self.goal if self._searches(generator) else None,
                settings=self.settings,
                budget=self.budget,
            )
            for number, (request, generator, brief) in enumerate(made, 1)
        ]


LARGEST = 4_000_000  # bytes of a file
FOLDERS = ("record", "replay")  # keys of [chat] that name a folder
OF_DESIGN = {"prompts", "designers", "generators", "goal", "reader", "chat", "settings"}
"""Keys that mean nothing for roads that are there."""


Percentage = Annotated[
    str | float, AfterValidator(partial(bank_in, most=100 * STEEPEST, unit="a percentage"))
]


class WorldTable(Frozen, strict=True):
    """The table ``[world]`` of a plan file, in the units of the command line."""

    map_size: Annotated[float, Field(ge=SMALLEST_MAP, le=LARGEST_MAP)] = USUAL_MAP
    lanes: Lanes = "1+1"
    lane_width: Annotated[float, Field(ge=2, le=10)] = 4.0
    lane_width_end: Annotated[float, Field(ge=2, le=10)] | None = None
    bank: Percentage = "none"
    """Superelevation of bends: ``"none"``, ``"auto"`` for the values of CD 109, or a number in percent."""
    shoulder: NotNegative = 3.0
    friction: Annotated[float, Field(gt=0, le=2)] = 1.0
    scene: str = ""
    speed_limit_kmh: Annotated[float, Field(ge=5, le=300)] = 70.0
    oracle: Annotated[str, BeforeValidator(str)] | None = None
    oob_tolerance: Annotated[float, Field(gt=0, le=1)] | None = None
    lane_departure: bool | None = None
    avoidable: Avoider | None = None
    min_radius: Positive = 14.326
    max_grade: Annotated[float, Field(gt=0, le=1)] = 0.15

    def world(self) -> World:
        """Returns the World; lanes, their width, the speed limit, friction, map size and scene stay unset if
        the file does not give them: prompts may."""
        open_ = {"lanes", "lane_width", "friction", "map_size", "scene"} - self.model_fields_set
        values = self.model_dump(exclude={"speed_limit_kmh", *open_}, exclude_none=True)
        values["bank"] = self.bank / 100 if isinstance(self.bank, float) else self.bank
        if "speed_limit_kmh" in self.model_fields_set:
            values["speed_limit"] = self.speed_limit_kmh / 3.6
        return World().changed(**values)


class PlanTable(PlanChoices, strict=True):
    """The keys of a plan file at its top level."""

    prompts: Texts = ()
    generators: Texts = ()
    tests: Annotated[int, Field(ge=1, le=MOST_TESTS)] | None = None
    seconds: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    test_seconds: Annotated[float, Field(gt=0, allow_inf_nan=False)] = PATIENCE
    drive: bool = True
    on: Words | None = None
    world: WorldTable = WorldTable()
    chat: dict[str, Any] = Field(default_factory=dict)


class PlanFile(BaseModel):
    """The content of a plan file: the plan, the settings of the language models, and the keys of its
    world."""

    plan: Plan
    chat: dict[str, Any]
    world: frozenset[str]


def read_plan(path: Path) -> PlanFile:
    """Reads the plan in a file."""
    try:
        data = toml_of(read_text(path, LARGEST, "a plan of a campaign", "utf-8-sig"))
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror}; check the path") from error
    except ValueError as error:
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
    if table.on and (wrong := sorted(OF_DESIGN & table.model_fields_set)):
        raise UsageError(
            f"{path}: '{wrong[0]}' is for roads that are designed, and 'on' names roads that are "
            "there; leave one of them out"
        )
    told = frozenset(name.removesuffix("_kmh") for name in table.world.model_fields_set)
    return PlanFile(plan=_plan(table, folder).came_with(path), chat=chat, world=told)


def _plan(table: PlanTable, folder: Path) -> Plan:
    """Returns the plan of a file; relative paths in the file start from ``folder``."""
    reader, colon, weights = table.reader.partition(":")
    named_alike = {name: getattr(table, name) for name in PlanTable.model_fields if name in Plan.model_fields}
    read = {
        "prompts": table.prompts or ("",),
        "drivers": tuple(absolute_spec(driver, folder) for driver in table.drivers),
        "on": str(folder / table.on) if table.on else "",
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
    mistake = error.errors()[0]
    place = (*within, *mistake["loc"])
    key = ".".join(str(part + 1 if isinstance(part, int) else part) for part in place)
    if mistake["type"] == "extra_forbidden":
        known = _keys(place[:-1])
        near = get_close_matches(str(place[-1]).lower(), known, 1, 0.5)
        advice = f"did you mean '{near[0]}'?" if near else f"keys are {', '.join(known)}"
        return f"'{key}' is not a key of a campaign; {advice}"
    return f"{key}: {_short(mistake['input'])} is not possible; {advice_on(mistake)}"


def _keys(place: tuple[Any, ...]) -> list[str]:
    models: Mapping[str, type[BaseModel]] = {"world": WorldTable, "chat": ChatSettings}
    model = models.get(str(place[0]), PlanTable) if place else PlanTable
    return [*model.model_fields]


def _short(value: Any) -> str:
    text = repr(value)
    return f"{text[:40]}..." if len(text) > 43 else text
