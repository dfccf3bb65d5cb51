"""Schedules the tests of a campaign."""

import time
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple

from roadgpt.campaign.batch_scheduler import BatchScheduler
from roadgpt.campaign.budget_allocator import BudgetAllocator
from roadgpt.campaign.jobs import FinishedJob, Job, WorkerConfig
from roadgpt.campaign.model import Cell
from roadgpt.campaign.single_test import (
    Allowance,
    FinishedTest,
    OutOfAllowance,
    Task,
    error_run,
    execute,
    result_of,
)
from roadgpt.campaign.store_tables import Tables
from roadgpt.chat import ChatSettings
from roadgpt.errors import BudgetError, RoadGPTError
from roadgpt.run.lost_drives import LostDrives
from roadgpt.stopping import look

if TYPE_CHECKING:
    from roadgpt.campaign.executors import Executor

WAIT = 0.25  # s to wait for results at a time
GROUP = 128  # most results that are stored together: 10 MB of drives
PER_WORKER = 2  # tests per worker, running or queued; with fewer, the next cell is begun


@dataclass
class Progress:
    """The progress of a campaign."""

    total: int | None
    """Number of tests; None if the campaign has a time limit but no limit on tests."""
    outcomes: Counter[str] = field(default_factory=Counter)
    under_way: int = 0

    @property
    def done(self) -> int:
        """Number of tests that have ended."""
        return self.outcomes.total()


class _Out(NamedTuple):
    """A test that was handed to a worker."""

    schedule: BatchScheduler
    task: Task


class Scheduler:
    """Runs one session of a campaign: asks for tests, sends them to the workers, and stores their results."""

    def __init__(
        self,
        store: Tables,
        staff: WorkerConfig,
        kind: "type[Executor]",
        tests: int | None = None,
        chat: ChatSettings | None = None,
        run_test: Callable[..., FinishedTest | OutOfAllowance] | None = None,
    ) -> None:
        """Prepares the session.

        Args:
            store: the tables of the campaign.
            staff: the workers to request.
            kind: the executor.
            tests: number of tests of each cell; None if only time limits them.
            chat: this session's settings of the language model, whose limits hold for all tests together;
                None: the settings of each cell, without limits for the session.
            run_test: runs a test on a worker, as ``single_test.execute`` does, which None stands for.
        """
        self._store = store
        self._staff = staff
        self._names = store.names()
        self._allocator = BudgetAllocator(chat, *store.spent())
        self._chat = chat
        self._run_test = run_test or execute
        counts = store.query("SELECT outcome, count(*) FROM tests WHERE outcome IS NOT NULL GROUP BY outcome")
        total = tests and tests * len(self._names)
        self.progress = Progress(total, Counter(dict(counts)))
        self._next = 0
        self._schedules: list[BatchScheduler] = []
        self._out: dict[int, _Out] = {}
        self._keys = 0
        self._underfunded: list[_Out] = []
        self._shared: dict[str, set[int]] = {}
        self._pending: list[tuple[str, FinishedTest]] = []
        self._oldest = self._looked = time.monotonic()
        self._losses: LostDrives[_Out] = LostDrives()
        self._error: Exception | None = None
        self._may_write = True
        self._has_news = False
        self.executor = kind(staff)

    def run(self) -> Generator[Progress, None, None]:
        """Runs tests until none is left; yields the progress after every group of results. However the
        session ends, the results so far are stored and the workers are stopped."""
        try:
            yield from self._run()
        except BaseException:
            self._leave()
            raise
        finally:
            self.executor.stop()

    def _run(self) -> Iterator[Progress]:
        self._store.begin_session(self._staff.workers)
        while self._error is None:
            look()
            self._fill()
            if not self._out and not self._underfunded:
                break
            self._take(self.executor.done(WAIT))
            if self._is_due():
                self._keep()
            if self._has_news:
                self._has_news = False
                yield self.progress
        if self._error is not None:
            raise self._error
        self._keep()
        yield self.progress

    def _leave(self) -> None:
        self.executor.stop()
        if self._may_write and self._error is None:
            try:
                self._take(self.executor.done(0.0))
            except RoadGPTError:
                self._error = None  # the caller has it already
        if self._may_write:
            self._keep()
            self._store.end_session()

    # Handing out

    def _fill(self) -> None:
        if self._underfunded:
            self._retry_underfunded()
            return
        while True:
            schedule = next((schedule for schedule in self._schedules if schedule.may_ask), None)
            if schedule is not None:
                self._ask(schedule)
            elif len(self._out) >= PER_WORKER * self._staff.workers or not self._open():
                return

    def _ask(self, schedule: BatchScheduler) -> None:
        if self._pending:
            self._keep()  # what the generator is told has to be in the store
        if schedule.is_late:
            schedule.close("its time limit was reached")
        else:
            self._hand_out(schedule, schedule.ask(self.executor))
        self._drop_if_done(schedule)

    def _open(self) -> bool:
        """Begins the next cell that is not done; returns False if there is none."""
        while self._next < len(self._names):
            schedule = BatchScheduler(self._store.cell(self._names[self._next]), self._store)
            self._next += 1
            if schedule.is_done:
                continue
            self._schedules.append(schedule)
            name = schedule.cell.name
            self.executor.share(name, self._with_chat(schedule.cell))
            self._shared[name] = set()
            self._hand_out(schedule, self._store.waiting(name))
            return True
        return False

    def _with_chat(self, cell: Cell) -> Cell:
        """Returns the cell with this session's settings of the language model, whose limits may differ."""
        if self._chat is None or cell.request.setup.chat is None:
            return cell
        setup = cell.request.setup.model_copy(update={"chat": self._chat})
        return replace(cell, request=cell.request.model_copy(update={"setup": setup}))

    def _hand_out(
        self, schedule: BatchScheduler, tests: Sequence[Task], allowance: Allowance | None = None
    ) -> None:
        """Queues tests, each with the given allowance; if it is None, the tests share half of the tokens and
        money that are left, and the other half is left for later tests."""
        jobs = []
        each = allowance or self._allocator.share(2 * max(len(tests), 1))
        for test in [replace(test, allowance=each) for test in tests]:
            self._keys += 1
            self._out[self._keys] = _Out(schedule, test)
            self._allocator.give(self._keys, test.allowance)
            needs = (schedule.cell.name, *self._earlier(schedule, test))
            jobs.append(Job(self._keys, self._run_test, test, needs))
        self.executor.submit(jobs)

    def _earlier(self, schedule: BatchScheduler, test: Task) -> list[str]:
        """Returns the names of the blocks of designs that a draft has to differ from; shares those that
        workers may lack, and drops those that no later test needs."""
        if test.proposal.design is not None:
            return []
        name = schedule.cell.name
        wanted, shared = schedule.known(test.batch), self._shared[name]
        for batch in wanted:
            if batch not in shared:
                self.executor.share(f"{name}/{batch}", schedule.designs(batch))
                shared.add(batch)
        # tests of the previous batch may still need blocks that this test does not need
        oldest = schedule.known(max(test.batch - 1, 0)).start
        for batch in [batch for batch in shared if batch < oldest]:
            self.executor.forget(f"{name}/{batch}")
            shared.remove(batch)
        return [f"{name}/{batch}" for batch in wanted]

    def _retry_underfunded(self) -> None:
        """Runs the tests whose allowance was too small one after another, each with all that is left."""
        if self._out:
            return
        one = self._underfunded.pop(0)
        everything = self._allocator.share()
        if one.task.allowance == everything:
            self._error = BudgetError(self._allocator.sentence(self._store.to_resume))
            return
        self._hand_out(one.schedule, [one.task], everything)

    # Taking in

    def _take(self, ended: Sequence[FinishedJob]) -> None:
        for done in ended:
            out = self._out.pop(done.key)
            if done.error is not None:
                self._error = self._error or done.error
                continue
            value: FinishedTest | OutOfAllowance = done.value
            if done.lost:  # its workers died
                run = error_run(out.task, out.schedule.cell, done.lost)
                value = FinishedTest(result_of(run, out.task, {}))
            self._allocator.back(done.key, value.spent)
            if isinstance(value, OutOfAllowance):
                self._store.spend(value.spent)
                self._underfunded.append(out)
                continue
            if not self._pending:
                self._oldest = time.monotonic()
            self._pending.append((out.schedule.cell.name, value))
            self.progress.outcomes[value.result.outcome] += 1
            out.schedule.ended(out.task.batch)
            self._count_losses(out, value)

    def _count_losses(self, out: _Out, ended: FinishedTest) -> None:
        """Ends the session if the simulator has failed three times in a row; the tests that were lost are
        reopened for the next session."""
        if not self._losses.count(out, ended.is_lost) or self._error is not None:
            return
        self._keep()
        for lost in self._losses.lost:
            self._store.reopen(lost.schedule.cell.name, lost.task.number, lost.task.batch)
        self.progress.outcomes["ERROR"] -= len(self._losses.lost)
        reason = ended.result.description
        self._error = self._losses.given_up(reason, "fix it and continue")

    def _is_due(self) -> bool:
        waited = time.monotonic() - (self._oldest if self._pending else self._looked)
        return waited >= self._store.group_seconds or len(self._pending) >= GROUP

    def _keep(self) -> None:
        """Stores the tests that have ended: first their drives, so that every stored result has its drive."""
        now = time.monotonic()
        drives = [(cell, one.result.number, one.trace) for cell, one in self._pending if one.trace]
        self._may_write = False  # until all is written
        trace = None
        if drives:
            from roadgpt.campaign.traces import write_traces

            number = self._store.next_trace()
            trace = number, write_traces(self._store.folder, number, drives)
        taken = {schedule.cell.name: now - self._looked for schedule in self._schedules}
        self._store.keep(self._pending, trace, self._leases(), taken)
        self._may_write = True
        for schedule in self._schedules:
            schedule.seconds += now - self._looked
        self._looked = now
        self._pending = []
        self._has_news = True
        self.progress.under_way = len(self._out)
        for schedule in [*self._schedules]:
            self._drop_if_done(schedule)

    def _leases(self) -> list[tuple[str, int, str, float]]:
        due = time.time() + self._staff.patience
        doing = [(self._out[one.key], one) for one in self.executor.under_way() if one.key in self._out]
        return [
            (out.schedule.cell.name, out.task.number, one.worker, due - one.seconds) for out, one in doing
        ]

    def _drop_if_done(self, schedule: BatchScheduler) -> None:
        if not schedule.is_done or schedule not in self._schedules:
            return
        name = schedule.cell.name
        is_pending = any(cell == name for cell, _ in self._pending)
        if is_pending or any(out.schedule is schedule for out in self._underfunded):
            return
        self._schedules.remove(schedule)
        for batch in self._shared.pop(name):
            self.executor.forget(f"{name}/{batch}")
        self.executor.forget(name)
