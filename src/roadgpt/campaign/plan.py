"""The Plan of a campaign: every combination of prompts, designers, drivers, simulators, generators and seeds.

Each combination is a cell with a budget of its own; all other values of the plan are the same for all cells.
"""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import product
from typing import Annotated, Any, Literal

from pydantic import Field

from roadgpt import plugins
from roadgpt.brief.model import Brief, Frozen
from roadgpt.campaign.model import PATIENCE, UNLIMITED, WITH_GOAL, WITHOUT_GOAL, Cell, CellBudget, Goal
from roadgpt.chat import ChatSettings, asks_a_model
from roadgpt.design.room import world_for
from roadgpt.drive import permission
from roadgpt.errors import UsageError
from roadgpt.road import Geometry, World
from roadgpt.run.model import Request, Setup

MOST_CELLS = 100_000

Names = Annotated[tuple[str, ...], Field(min_length=1)]
Seed = Annotated[int, Field(ge=0, lt=2**63)]


class Plan(Frozen):
    """The settings of a campaign."""

    prompts: Names = ("",)
    """Descriptions of roads; an empty text if the generator needs no description."""
    designers: Names = ("planner",)
    drivers: Names = ("lane_centring",)
    """Names of installed drivers, or ``FILE.py:CLASS``."""
    simulators: Names = ("mujoco",)
    generators: Names = (WITHOUT_GOAL,)
    seeds: Annotated[tuple[Seed, ...], Field(min_length=1)] = (0,)
    goal: Goal | None = None
    settings: Mapping[str, Any] = Field(default_factory=dict)
    """Settings of the generators: the value of each setting, by its name."""
    budget: CellBudget = UNLIMITED
    """The limits of each cell."""
    reader: str = "model"
    rules: Literal["strict", "sbft"] = "strict"
    geometry: Geometry = "arcs"
    keep_driving: bool = False
    drives: bool = True
    paired: bool = False
    """Whether the drivers are compared on the same roads at the end."""
    world: World = World()
    chat: ChatSettings | None = None
    patience: Annotated[float, Field(gt=0, allow_inf_nan=False)] = PATIENCE
    """Longest time for one test, seconds; a test that takes longer is treated as hanging."""

    def essence(self) -> "Plan":
        """Returns the Plan without the settings that may change when the campaign is resumed."""
        chat = self.chat and self.chat.essence()
        return self.model_copy(update={"chat": chat, "patience": PATIENCE, "paired": False})

    def came_with(self, file: object) -> "Plan":
        """Returns the Plan read from ``file``, and records that another person may have written this file.

        If only this file names a driver's file, RoadGPT asks the user before running the driver. If only this
        file names a server, the user's API key is not sent there.
        """
        chat = self.chat and self.chat.came_with(file)
        drivers = tuple(permission.driver_from_file(driver, file) for driver in self.drivers)
        return self.model_copy(update={"chat": chat, "drivers": drivers})

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
        """Checks the plan without running a test.

        Raises:
            UsageError: a plug-in is not installed, there are too many cells, a value is listed twice, no
                limit is set, the plan has a goal but drives no roads, no generator supports the goal, the
                generator ``words`` has no description, or ``paired`` drivers do not get the same roads.
        """
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
            if name == WITHOUT_GOAL and not all(words.strip() for words in self.prompts):
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
        """Returns all cells; ``briefs`` maps each prompt to the Brief read from it.

        If the plan's World gives no friction, a surface that a Brief names, such as a wet road, determines
        the friction in the cells of this Brief.
        """
        made = [(request, generator, briefs.get(request.words)) for request, generator in self.requests()]
        wide = max(2, len(str(len(made))))
        return [
            Cell(
                name=f"c{number:0{wide}d}",
                request=request.model_copy(update={"world": world_for(brief, request.world)}),
                brief=brief,
                generator=generator,
                goal=self.goal if self._searches(generator) else None,
                settings=self.settings,
                budget=self.budget,
            )
            for number, (request, generator, brief) in enumerate(made, 1)
        ]
