"""The values of a campaign: what is asked for, what comes of it, and what all tests of a cell share."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, Protocol, TypeVar, get_args

from pydantic import Field

from roadgpt.brief.model import Brief, Frozen
from roadgpt.road import Design
from roadgpt.run.model import Outcome, Request
from roadgpt.verdict.verdict import Cause, Side

Goal = Literal["failures", "coverage", "hardest", "boundary"]
"""What a search is after; a cell without a goal makes so many roads and looks for nothing."""
GOALS: tuple[Goal, ...] = get_args(Goal)

MOST_TESTS = 10_000_000  # of one cell; numbers of tests have seven digits

T = TypeVar("T")
U = TypeVar("U")


class Budget(Frozen):
    """When a cell is done: at whichever limit is reached first."""

    tests: Annotated[int, Field(ge=1, le=MOST_TESTS)] | None = None
    seconds: Annotated[float, Field(gt=0, allow_inf_nan=False)] | None = None
    """On the clock, over all sittings; then no further batch is begun."""

    @property
    def most(self) -> int:
        """Tests, at most."""
        return self.tests or MOST_TESTS


UNLIMITED = Budget()


@dataclass(frozen=True)
class Proposal:
    """A test that a generator asks for."""

    design: Design | None
    """None: a worker drafts it from the cell's Brief, as road ``number`` of a campaign with this seed; it is
    to differ from the designs of batches that were told."""
    seed: int
    """Of the draft; where a design is given, the driver's own."""
    origin: str
    """Where it comes from, as tables show it: 'draft', 'vary 17', 'cross 3+9', 'walk'."""


@dataclass(frozen=True)
class Result:
    """What came of one test; only what another day, machine load or number of workers does not change."""

    number: int
    """In its cell, from 1."""
    batch: int
    """From 0."""
    proposal: Proposal
    outcome: Outcome
    description: str
    """The outcome in a sentence."""
    design: Design | None = None
    """What was driven; None where nothing could be designed."""
    length: float = 0.0
    """Metres in plan; 0 where there is no road."""
    margin: float | None = None
    """Metres, see ``roadgpt.verdict.margin``; None where nobody drove."""
    max_oob: float | None = None
    """Largest share of the car outside its lane, 0 to 1."""
    beyond: float | None = None
    """Metres that its body reached beyond the marking, at most; None, too, in stores of older versions."""
    at_s: float | None = None
    """Metres along the road where it failed."""
    side: Side | None = None
    cause: Cause | None = None
    features: Mapping[str, float] = field(default_factory=dict)
    """Of the road and of the drive: ``run.features.features_of`` and ``campaign.behaviour.behaviour_of``."""

    @property
    def failed(self) -> bool:
        """Did the car fail on a road that the rules allow?"""
        return self.outcome == "FAIL"


@dataclass(frozen=True)
class Cell:
    """One combination of a plan: what all its tests share."""

    name: str
    """'c01', 'c02', ..., in the order of the plan."""
    request: Request
    """Words, seed, world and setup, as for ``roadgpt run``."""
    brief: Brief | None
    """Read once, by the main process; None where there are no words."""
    generator: str
    goal: Goal | None
    settings: Mapping[str, Any] = field(default_factory=dict)
    """Of the generator, as its own documentation has them."""
    budget: Budget = UNLIMITED


class Pool(Protocol):
    """The workers of a campaign, for the pure work of a generator: candidates, features, predictions."""

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:
        """``function`` of every item, in their order; the function stands at the top of a module.

        What the function raises is raised here again.
        """
        ...


class Generator(Protocol):
    """Thinks out tests, batch by batch; made with a Cell.

    Before batch k is asked for, every result of batches 0 to k - 2 has been told, in order of number, and
    nothing else. Its state follows from its cell and from what it was told; its random numbers in a batch
    come from ``np.random.default_rng([cell.request.seed, k])``. So the same campaign gives the same table
    however many workers there are and however often it is interrupted.

    A class that searches says so: ``goals`` names what it can search for. One without the name searches for
    nothing, and its cells have no goal.
    """

    batch_size: int
    """Tests in one batch, about 10 to 20: as many are always under way as two batches have."""

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        """The next n tests, or fewer where there is nothing left to ask for.

        Args:
            batch: its number, from 0.
            first: number of its first test, from 1.
            n: how many, at most ``batch_size``.
            pool: the campaign's workers, for what takes long.
        """
        ...

    def tell(self, results: Sequence[Result]) -> None:
        """Results of one batch, in order of number; takes under 1 ms each."""
        ...
