"""Runs one test of a cell on a worker: from its proposal to its result."""

import traceback
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from roadgpt.campaign.model import GIVEN, Cell, GivenRoad, Proposal, Result
from roadgpt.chat import ChatError, Meter, ReplyError, Spent
from roadgpt.errors import BudgetError, DesignError, PartError, RoadGPTError, UsageError
from roadgpt.plural import plural
from roadgpt.provenance import NameOrigins, join, known
from roadgpt.road import Design
from roadgpt.run import REFUSED, Run, Seconds, Setup, check_parts, drafted, driven, prove, seed_of

if TYPE_CHECKING:
    from roadgpt.campaign.traces import Trace
    from roadgpt.network.source import RoadSource

CONCERNS_ALL = (PartError, UsageError, ChatError)  # errors that are not due to one test


class Allowance(NamedTuple):
    """The tokens and the USD that one test may spend on language models; a field of None sets no limit."""

    tokens: int | None = None
    cost: float | None = None


BOUNDLESS = Allowance()
NO_TIME = Seconds()
OF_VERDICT = ("margin", "max_oob", "beyond", "at_s", "side", "cause", "own_share", "handed_to")
"""The fields that a Result takes over from a Verdict."""


@dataclass(frozen=True)
class Task:
    """A test to be run by a worker."""

    number: int
    batch: int
    proposal: Proposal
    allowance: Allowance = BOUNDLESS
    road: bytes = b""  # the file of a road that was given
    drafted: Run | None = None  # of a folder of runs: what is to be driven


@dataclass(frozen=True)
class FinishedTest:
    """A test that has ended: its result, and data that may differ when it is repeated, such as times."""

    result: Result
    trace: "Trace | None" = None
    seconds: Seconds = NO_TIME
    spent: Spent | None = None
    error: str = ""  # the traceback if the test raised an error; else empty
    is_lost: bool = False  # true if the simulator itself failed, so that the test says nothing about the road
    driver_files: Mapping[str, str] = field(default_factory=dict)  # as in the Run
    test_file: str = ""  # of a folder of runs: text for ``test.NNNN.json``
    has_road: bool = True
    entries: Mapping[str, Any] = field(default_factory=dict)
    """Of a folder of runs: what each plug-in ``tables`` counts."""
    run: Run | None = None  # of a folder of runs; None if a worker ran the test

    @classmethod
    def of(
        cls, run: Run, task: Task, features: Mapping[str, float] | None = None, /, **rest: Any
    ) -> "FinishedTest":
        """Returns the test that ended with a Run; ``rest`` has fields that the Run does not have."""
        rest |= {name: getattr(run, name) for name in ("seconds", "spent", "is_lost", "driver_files")}
        has_road = run.road is not None
        return cls(result_of(run, task, features or {}), error=run.trace, has_road=has_road, **rest)


@dataclass(frozen=True)
class OutOfAllowance:
    """A test that did not finish because its allowance was too small; it has to be run again."""

    spent: Spent


@dataclass(frozen=True)
class WorkerSetup:
    """Prepares a worker process: imports and compiles what the drivers and simulators of a campaign need."""

    setups: tuple[Setup, ...]
    known: tuple[NameOrigins, NameOrigins] = field(default_factory=known)
    """The drivers and servers that the user has named."""

    def __call__(self) -> None:
        """Loads all plug-ins, after telling this process which drivers and servers the user has named."""
        join(self.known)
        for setup in self.setups:
            check_parts(setup)


def execute(task: Task, cell: Cell, *earlier: tuple[Design, ...]) -> FinishedTest | OutOfAllowance:
    """Runs one test of a campaign whose results go into a store. A drafted road must differ from all of the
    ``earlier`` designs."""
    from roadgpt.campaign.columns import features_in
    from roadgpt.campaign.traces import trace_of

    meter = Meter(task.allowance.tokens, task.allowance.cost)
    try:
        run = run_test(task, cell, earlier, meter)
    except BudgetError:
        return OutOfAllowance(meter.spent)
    except CONCERNS_ALL:
        raise
    except Exception as error:  # whatever a part raises costs this test, not the campaign
        sentence = str(error) if isinstance(error, RoadGPTError) else f"the test failed: {error!r}"
        run = error_run(task, cell, sentence, traceback.format_exc())
    trace = trace_of(run.drive) if run.drive is not None else None
    return FinishedTest.of(run, task, features_in(run), trace=trace)


def run_test(task: Task, cell: Cell, earlier: tuple[tuple[Design, ...], ...], meter: Meter) -> Run:
    """Returns the Run of a test, also if no road can be designed, or the language model gives no usable
    reply."""
    if task.drafted is not None:
        return task.drafted if task.drafted.road is None else driven(task.drafted)
    proposal = task.proposal
    try:
        cell = cell.of_test(proposal)
        world, setup = cell.request.world, cell.request.setup
        if isinstance(proposal.design, GivenRoad):
            from roadgpt.campaign.given import source_of

            return _run_of_given(source_of(proposal.design, task.road), task, cell)
        if proposal.design is not None:
            return prove(proposal.design, proposal.seed, world, setup, task.number, cell.brief)
        run = draft(task, cell, [design for block in earlier for design in block], meter)
        return run if run.road is None else driven(run)
    except DesignError as error:
        return error_run(task, cell, str(error))
    except PartError:
        raise
    except UsageError as error:
        if "scenario" not in cell.settings:
            raise
        return replace(error_run(task, cell, f"{REFUSED}{error}"), outcome="INVALID")


def draft(task: Task, cell: Cell, earlier: Sequence[Design], meter: Meter) -> Run:
    """Returns the Run of a test before its drive, also if no road can be designed, or the language model
    gives no usable reply."""
    assert cell.brief is not None, "only a cell with words lets its tests be drafted"
    before, request = meter.spent, cell.request
    unlike = () if request.setup.scenario else earlier
    try:
        return drafted(
            cell.brief, task.proposal.seed, request.world, request.setup, task.number, unlike, meter
        )
    except (DesignError, ReplyError) as error:
        spent = meter.spent.since(before)
        return replace(error_run(task, cell, str(error)), spent=spent if spent.calls else None)


def _run_of_given(source: "RoadSource", task: Task, cell: Cell) -> Run:
    """Returns the Run of a road that was given. As roads of real maps break many rules, it is driven despite
    them, and the description names them."""
    world, setup = cell.request.world.changed(**source.world), cell.request.setup
    despite, seed = setup.drives and setup.rules == "strict", task.proposal.seed
    run = prove(source.blueprint, seed, world, setup, task.number, despite_findings=despite)
    if run.drive is None or not run.findings:
        return run
    found, first = plural(len(run.findings), "finding"), run.findings[0].sentence
    return replace(run, description=f"{run.description}; driven despite {found} of the rules: {first}")


def error_run(task: Task, cell: Cell, sentence: str, trace: str = "") -> Run:
    """Returns the Run of a test that ended without a road or a drive; ``sentence`` states the reason."""
    number, proposal = task.number, task.proposal
    seed = seed_of_driver(number, proposal)
    design = proposal.design if isinstance(proposal.design, Design) else None
    return Run(cell.request, number, seed, "ERROR", sentence, design=design, trace=trace)


def seed_of_driver(number: int, proposal: Proposal) -> int:
    """Returns the driver's seed in test ``number``; a road that the worker designs has the same seed."""
    return seed_of(proposal.seed, number) if proposal.design is None else proposal.seed


def finished_run(run: Run) -> FinishedTest:
    """Converts the Run of an earlier session to a FinishedTest."""
    from roadgpt.campaign.columns import features_in

    proposal = Proposal(run.design, run.seed, "draft" if run.words or run.brief else GIVEN)
    return FinishedTest.of(run, Task(run.index, run.index - 1, proposal), features_in(run, told_alone=True))


def result_of(run: Run, task: Task, features: Mapping[str, float]) -> Result:
    """Returns the part of a Run that a campaign stores as the test's result."""
    measured = {name: getattr(run.verdict, name) for name in OF_VERDICT} if run.verdict else {}
    return Result(
        number=task.number,
        batch=task.batch,
        proposal=task.proposal,
        outcome=run.outcome,
        description=run.description,
        design=given if isinstance(given := task.proposal.design, GivenRoad) else run.design,
        length=run.length,
        features=features,
        **measured,
    )
