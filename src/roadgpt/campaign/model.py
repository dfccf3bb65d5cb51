"""Budgets, cells, proposed tests and their results, and the interfaces of generators and workers."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, Protocol, TypeVar, get_args

from pydantic import Field

from roadgpt.brief.model import Brief, Frozen
from roadgpt.brief.plan import read_plan
from roadgpt.design.room import world_for
from roadgpt.road import Design, World
from roadgpt.run.model import Outcome, Request
from roadgpt.verdict.verdict import Cause, Side

if TYPE_CHECKING:
    from roadgpt.brief.scenarios import Scenario

Goal = Literal["failures", "coverage", "hardest", "boundary"]
"""The goal of a search; a cell without a goal makes the requested number of roads and does not search."""
FEWEST = 5  # passed tests; if there are fewer, it is no surprise that none failed
NO_FAILURE = "No road failed: 'roadgpt campaign --goal failures' searches for one."
GOALS: tuple[Goal, ...] = get_args(Goal)

WITHOUT_GOAL, WITH_GOAL = "words", "quality_diversity"
"""The generators that are used if none is named: for plans without a goal, and for plans with a goal."""
GIVEN = "given"  # the generator of roads that are there, and the origin of such roads in folders of runs
PATIENCE = 900.0  # s for one test; every drive ends by itself before that
MOST_TESTS = 10_000_000  # of one cell; numbers of tests have seven digits

NO_WORDS = {GIVEN: "roads that were given", WITHOUT_GOAL: "nominal roads of scenarios"}

T = TypeVar("T")
U = TypeVar("U")


class NumberedTest(NamedTuple):
    """Cell and number of a test; as text the end of a command's argument: ``c01/17`` in ``view
    hard/c01/17``."""

    cell: str  # name of the test's cell; empty for a run in a folder of runs
    number: int

    def __str__(self) -> str:
        return f"{self.cell}/{self.number}" if self.cell else f"{self.number}"


class CellBudget(Frozen):
    """The limits of a cell; the cell ends as soon as it reaches one of them."""

    tests: Annotated[int, Field(ge=1, le=MOST_TESTS)] | None = None
    seconds: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    """Wall-clock seconds, summed over all sessions, after which no further batch is started.

    None: no limit."""

    @property
    def most(self) -> int:
        """The largest number of tests; 10,000,000 if ``tests`` is None."""
        return self.tests or MOST_TESTS


UNLIMITED = CellBudget()


class GivenRoad(Frozen):
    """A road that a campaign is given; its file lies in the campaign's folder, see ``campaign.given``."""

    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    """SHA-256 of the file, in hexadecimal digits."""
    file: Annotated[str, Field(pattern="^[0-9]+[.]json$")]
    name: str
    """What the road was called where it was found, such as 'route-1.json'."""
    source: str
    """The ``reading.digest`` of what it was read from; ``ABSENT`` for a test of another campaign."""


@dataclass(frozen=True)
class Proposal:
    """A test that a generator proposes."""

    design: Design | GivenRoad | None
    """The road's design, or a road that was given. None: a worker drafts the road from the cell's Brief, with
    ``seed`` and the number of the test. The drafted road differs from at least the latest 1500 designs in the
    batches whose results the generator has received; if ``Cell.keeps_runs``, from all earlier ones."""
    seed: int
    """Seed of the driver. If ``design`` is None, one seed for both draft and driver is derived from this seed
    and the number of the test."""
    origin: str
    """Where the road comes from, as in the tables: 'draft', 'cross 3+9', 'vary 17' (test 17 mutated)."""


@dataclass(frozen=True)
class Result:
    """The result of one test: values that depend neither on the time, nor on the load or number of
    workers."""

    number: int
    """Number of the test in its cell, from 1."""
    batch: int
    """Number of the test's batch, from 0."""
    proposal: Proposal
    outcome: Outcome
    description: str
    """One sentence that describes the outcome."""
    design: Design | GivenRoad | None = None
    """The design of the road, or the road that was given; None if no road could be designed."""
    length: float = 0.0
    """Length of the road seen from above, metres; 0 if there is no road."""
    margin: float | None = None
    """Margin to out of bounds, metres, see ``roadgpt.verdict.oracle``; None if the road was not driven."""
    max_oob: float | None = None
    """Largest share of the car that was outside its lane at one time, 0 to 1."""
    beyond: float | None = None
    """Largest distance of the car's body beyond the lane marking, metres; None if it was not driven."""
    at_s: float | None = None
    """Station of the failure, metres along the road; None if the car did not fail."""
    side: Side | None = None
    cause: Cause | None = None
    own_share: float | None = None
    """Share of the way, 0 to 1, that the driver drove itself; None if it never handed over."""
    handed_to: str | None = None
    """Who drove where the car failed, if the driver had handed over; see ``Verdict.handed_to``."""
    features: Mapping[str, float] = field(default_factory=dict)
    """Features of the road and of the drive, by name: see ``campaign.columns``."""

    @property
    def plain_design(self) -> Design | None:
        """The design; None if there is none, or if it has junctions, and for a given road."""
        return self.design if isinstance(self.design, Design) and self.design.is_plain else None

    @property
    def failed(self) -> bool:
        """True if the car failed on a valid road."""
        return self.outcome == "FAIL"


@dataclass(frozen=True)
class Cell:
    """One combination of a plan's prompts, designers, drivers and so on: the settings that its tests
    share."""

    name: str
    """'c01', 'c02', ..., in the order of the plan."""
    request: Request
    """Description, seed, world and setup, as for ``roadgpt run``."""
    brief: Brief | None
    """The requirements read from the description; None if there is no description."""
    generator: str
    goal: Goal | None
    settings: Mapping[str, Any] = field(default_factory=dict)
    """The generator's settings; the documentation of each generator describes them."""
    budget: CellBudget = UNLIMITED
    keeps_runs: bool = False
    """Whether each test has a folder of files, and differs from all earlier ones, as in ``roadgpt run``."""

    @property
    def points(self) -> "tuple[tuple[Scenario, ...], int]":
        """The scenarios of its tests, with the values of their parameters, and how many points of their grids
        are left out; none if it does not test any."""
        if "scenario" not in self.settings:
            return (), 0
        grid = self.settings.get("grid", "nominal")
        from roadgpt.brief.scenarios import points_of

        return points_of(self.settings["scenario"], grid, not self.request.words)

    def scenario_of(self, origin: str) -> str:
        """Returns the scenario of a test, with its parameters, from where it comes; empty if it has none."""
        return origin if "scenario" in self.settings else self.request.setup.scenario

    def of_test(self, proposal: Proposal) -> "Cell":
        """Returns the settings of one test: where scenarios are tested, its own is that of the proposal, and
        without a description its road the nominal one."""
        if "scenario" not in self.settings:
            return self
        from roadgpt.brief.scenarios import LANE_WIDTH, scenario

        one = scenario(proposal.origin)
        brief = self.brief if self.request.words else read_plan(one.plan)
        setup = self.request.setup.model_copy(update={"scenario": str(one)})
        nominal = {} if self.request.words else {"lane_width": LANE_WIDTH}
        usual, values = World().values(), self.request.world.values().items()  # a store names all values
        world = World().changed(**nominal | {name: value for name, value in values if value != usual[name]})
        world = world_for(brief, setup.staged(world, brief is not None and brief.left_hand))
        made = {"words": self.request.words or one.plan, "world": world, "setup": setup}
        return replace(self, request=self.request.model_copy(update=made), brief=brief)


class Pool(Protocol):
    """The workers of a campaign, on which a generator can run functions without side effects."""

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:
        """Returns the results of a function at the top level of a module for all items, in their order."""
        ...


class Generator(Protocol):
    """Proposes tests, batch by batch; a generator is constructed with a Cell.

    Before batch k is requested, the generator has received the results of batches 0 to k - 2, in order of the
    test numbers, and no later results. Its state may depend only on its Cell and these results, and the
    random numbers for batch k come from ``np.random.default_rng([cell.request.seed, k])``. Therefore a
    campaign's results depend neither on the number of workers nor on interruptions.

    A generator that searches lists the goals that it supports in an attribute ``goals``; the cells of others
    have no goal."""

    batch_size: int
    """Number of tests in one batch, about 10 to 20; up to two batches run at the same time."""

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """Returns the next n tests, numbered from ``first``, or fewer if there is nothing left to propose.
        Long computations go to the ``pool``."""
        ...

    def tell(self, results: Sequence[Result]) -> None:
        """Receives the results of one batch, in order of the test numbers, in less than 1 ms per result."""
        ...


def no_failure(outcomes: Mapping[str, int]) -> list[str]:
    """Returns the sentence for tests of which none failed and five or more passed; nothing for others."""
    return [] if outcomes.get("FAIL") or outcomes.get("PASS", 0) < FEWEST else [NO_FAILURE]
