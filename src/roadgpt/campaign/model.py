"""The values of a campaign: what is asked for, the results of tests, and what the tests of a cell share."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, Protocol, TypeVar, get_args

from pydantic import Field

from roadgpt.brief.model import Brief, Frozen
from roadgpt.road import Design
from roadgpt.run.model import Outcome, Request
from roadgpt.verdict.verdict import Cause, Side

Goal = Literal["failures", "coverage", "hardest", "boundary"]
"""The goal of a search; a cell without a goal makes a number of roads and does not search."""
GOALS: tuple[Goal, ...] = get_args(Goal)

MOST_TESTS = 10_000_000  # of one cell; numbers of tests have seven digits

T = TypeVar("T")
U = TypeVar("U")


class Budget(Frozen):
    """The limits of a cell, which is done when it reaches the first of them."""

    tests: Annotated[int, Field(ge=1, le=MOST_TESTS)] | None = None
    seconds: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    """Seconds on the clock, over all sessions; once they have passed, no further batch is begun."""

    @property
    def most(self) -> int:
        """The largest number of tests."""
        return self.tests or MOST_TESTS


UNLIMITED = Budget()


@dataclass(frozen=True)
class Proposal:
    """A test that a generator asks for."""

    design: Design | None
    """The road; None: a worker drafts it from the cell's Brief, as road ``number`` of a campaign with this
    seed, and
    so that it differs from the designs of the batches that the generator was told of."""
    seed: int
    """The seed of the draft; where a design is given, the driver's own seed."""
    origin: str
    """Where the road comes from, as tables show it: 'draft', 'vary 17', 'cross 3+9', 'walk'."""


@dataclass(frozen=True)
class Result:
    """The result of one test.

    It holds only what does not depend on the day, the load of the machine or the number of workers.
    """

    number: int
    """Number of the test in its cell, from 1."""
    batch: int
    """Number of its batch, from 0."""
    proposal: Proposal
    outcome: Outcome
    description: str
    """The outcome in a sentence."""
    design: Design | None = None
    """The road that was driven; None where no road could be designed."""
    length: float = 0.0
    """Length of the road in plan, metres; 0 where there is no road."""
    margin: float | None = None
    """Metres, see ``roadgpt.verdict.margin``; None where the road was not driven."""
    max_oob: float | None = None
    """Largest share of the car outside its lane, 0 to 1."""
    beyond: float | None = None
    """Largest distance of the car's body beyond the marking, metres; None also in stores of earlier versions.
    """
    at_s: float | None = None
    """Station of the failure, metres along the road."""
    side: Side | None = None
    cause: Cause | None = None
    features: Mapping[str, float] = field(default_factory=dict)
    """Features of road and drive: ``run.features.features_of`` and ``campaign.behaviour.behaviour_of``."""

    @property
    def failed(self) -> bool:
        """True if the car failed on a road that the rules allow."""
        return self.outcome == "FAIL"


@dataclass(frozen=True)
class Cell:
    """One combination of a plan, and what all its tests share."""

    name: str
    """'c01', 'c02', ..., in the order of the plan."""
    request: Request
    """Description, seed, world and setup, as for ``roadgpt run``."""
    brief: Brief | None
    """The requirements that were read from the description, once; None where there is no description."""
    generator: str
    goal: Goal | None
    settings: Mapping[str, Any] = field(default_factory=dict)
    """The generator's settings, which its own documentation describes."""
    budget: Budget = UNLIMITED


class Pool(Protocol):
    """The workers of a campaign, for the pure work of a generator: candidates, features, predictions."""

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:
        """Returns ``function`` of every item, in the order of the items.

        The function has to stand at the top level of a module. An error that it raises is raised here again.
        """
        ...


class Generator(Protocol):
    """Proposes tests, batch by batch; it is made with a Cell.

    Before it is asked for batch k, it has been told all results of batches 0 to k - 2, in order of their
    numbers,
    and no others. Its state may depend only on its cell and on these results, and its random numbers in a
    batch
    come from ``np.random.default_rng([cell.request.seed, k])``. Therefore a campaign has the same table for
    any
    number of workers, and however often it is interrupted.

    A generator that searches names in ``goals`` what it can search for. One without ``goals`` does not
    search,
    and its cells have no goal.
    """

    batch_size: int
    """Tests in one batch, about 10 to 20; up to two batches are running at a time."""

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """Returns the next n tests, or fewer where there is nothing left to propose.

        Args:
            batch: number of the batch, from 0.
            first: number of its first test, from 1.
            n: number of tests, at most ``batch_size``.
            pool: the workers of the campaign, for work that takes long.
        """
        ...

    def tell(self, results: Sequence[Result]) -> None:
        """Receives the results of one batch, in order of their numbers; takes less than 1 ms for each."""
        ...
