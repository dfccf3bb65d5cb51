"""Schedules the tests of a campaign: when the next batch of a cell is requested from its generator, what each
test may spend, which tests the workers get, and what is stored."""

import time
from bisect import bisect
from collections import Counter
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, wait
from contextlib import suppress
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar

from roadgpt import plugins
from roadgpt.campaign.model import Cell, GivenRoad, Pool, Result
from roadgpt.campaign.model import Generator as TestGenerator
from roadgpt.campaign.record import Batch, Store
from roadgpt.campaign.single_test import (
    CONCERNS_ALL,
    Allowance,
    FinishedTest,
    OutOfAllowance,
    Task,
    draft,
    error_run,
)
from roadgpt.campaign.workers import InProcess, LostWorkerError, Shared, WorkerConfig
from roadgpt.chat import ChatSettings, Meter
from roadgpt.errors import BudgetError, RoadGPTError
from roadgpt.road import Design
from roadgpt.run import Run
from roadgpt.run.model import MOST, given_up
from roadgpt.stopping import look

REMEMBERED = 2048  # latest designs that a draft must differ from, 50 MB per worker; older ones are left out
STRIDE = 512  # designs that are dropped at a time, so that designers' caches of the others stay valid
LAG = 2  # batches: batch k is requested with the results of batches up to k - 2
GIVE_UP = 3  # tests without a road, after which a cell is closed if it has no road yet


class BatchScheduler:
    """Requests batches of tests from the generator of one cell.

    Batch k is requested once all tests of batch k - 2 have ended; by then the generator was told the results
    of batches 0 to k - 2, and no others. Of a cell that keeps runs, each test is a batch of its own: its road
    is drafted here, so that it differs from all earlier ones, and only driven on workers."""

    def __init__(self, cell: Cell, store: Store) -> None:
        self.cell, self.shared, self.store = cell, Shared(cell), store
        self.batches: list[Batch] = store.batches(cell.name)
        ((self.seconds, self.closed),) = store.query(
            "SELECT seconds, closed FROM cells WHERE name = ?", (cell.name,)
        )
        self._generator: TestGenerator | None = None
        self._unfinished = {batch.number for batch in self.batches if batch.left}
        self._batches_told = self._tests_told = 0
        self._has_road = False
        self._blocks: dict[int, Shared[tuple[Design, ...]]] = {}
        self._drafts: dict[int, Design] = {}
        for result in store.results(cell.name) if cell.keeps_runs else ():
            self._note(result.number, result)

    @property
    def asked(self) -> int:
        """Number of tests that the generator has proposed so far."""
        return self.batches[-1].first + self.batches[-1].n - 1 if self.batches else 0

    @property
    def is_closed(self) -> bool:
        """True if the generator will not be asked for further tests."""
        return self.closed is not None or self.asked >= self.cell.budget.most

    @property
    def is_done(self) -> bool:
        """True if all tests of the cell have ended and no further ones will be requested."""
        return self.is_closed and not self._unfinished

    @property
    def may_ask(self) -> bool:
        """True if the next batch may be requested now."""
        last = -1 if self.cell.keeps_runs else len(self.batches) - LAG
        return not self.is_closed and not any(number <= last for number in self._unfinished)

    @property
    def is_late(self) -> bool:
        """True if the cell's time limit has been reached."""
        limit = self.cell.budget.seconds
        return limit is not None and self.seconds >= limit

    def ended(self, batch: int) -> None:
        """Counts one more test of the given batch as ended."""
        self.batches[batch].left -= 1
        if not self.batches[batch].left:
            self._unfinished.remove(batch)

    def close(self, why: str) -> None:
        """Closes the cell and stores the reason: no further batch is requested."""
        self.store.close_cell(self.cell.name, why)
        self.closed = why

    def ask(self, pool: Pool) -> list[Task]:
        """Requests the next batch, stores it, and returns its tests; closes the cell and returns nothing if
        the generator has nothing left, or if three tests or more have ended and none has a road."""
        batch, first = len(self.batches), self.asked + 1
        generator = self._taught(-1 if self.cell.keeps_runs else batch - LAG)
        if self._tests_told >= GIVE_UP and not (self._has_road or "scenario" in self.cell.settings):
            self.close(f"no road could be designed: {self._last.description}")
            return []
        most = 1 if self.cell.keeps_runs else generator.batch_size
        n = min(most, self.cell.budget.most - self.asked)
        proposals = generator.ask(batch, first, n, pool)
        if len(proposals) > n:
            raise RoadGPTError(
                f"the generator '{self.cell.generator}' proposed {len(proposals)} tests, "
                f"although {n} were asked for"
            )
        if self.cell.brief is None and any(proposal.design is None for proposal in proposals):
            raise RoadGPTError(
                f"the generator '{self.cell.generator}' drafts roads from a description, and there is none; "
                "give a description"
            )
        if not proposals:
            self.close("the generator had nothing left to propose")
            return []
        self.store.add_batch(self.cell.name, batch, first, proposals)
        self.batches.append(Batch(batch, first, len(proposals), len(proposals)))
        self._unfinished.add(batch)
        return [Task(number, batch, made) for number, made in enumerate(proposals, first)]

    def _taught(self, last: int) -> TestGenerator:
        """Returns the generator after passing it the results of all batches up to number ``last``."""
        if self._generator is None:
            self._generator = plugins.find("generators", self.cell.generator)(self.cell)
        generator: TestGenerator = self._generator
        while self._batches_told <= last:
            results = self._results(self.batches[self._batches_told])
            for result in results:
                self._note(result.number, result)
            generator.tell(results)
            self._batches_told += 1
        return generator

    def _note(self, number: int, made: Result | Run) -> None:
        self._has_road = self._has_road or made.design is not None
        self._last, self._tests_told = made, self._tests_told + 1
        if self.cell.keeps_runs and made.plain_design is not None:
            self._drafts[number] = made.plain_design

    def draft(self, test: Task, meter: Meter) -> Run:
        """Returns the Run of a test whose cell keeps runs, before its drive."""
        earlier = [design for number, design in sorted(self._drafts.items()) if number < test.number]
        run = draft(test, self.cell, earlier, meter)
        self._note(test.number, run)
        return run

    def _results(self, batch: Batch) -> list[Result]:
        between = "tests.number BETWEEN ? AND ?"
        return [*self.store.results(self.cell.name, between, (batch.first, batch.first + batch.n - 1))]

    def earlier(self, test: Task) -> list[Shared[tuple[Design, ...]]]:
        """Returns the designs from which a draft must differ: one tuple for each earlier batch."""
        if test.proposal.design is not None or test.drafted is not None:
            return []
        known = self._known(test.batch)
        self._blocks = {batch: self._blocks.get(batch) or Shared(self._designs(batch)) for batch in known}
        return [*self._blocks.values()]

    def _known(self, batch: int) -> range:
        """Returns the indices of earlier batches from whose roads every draft in ``batch`` must differ."""
        last = batch - LAG
        if last < 0:
            return range(0)
        last_known = self.batches[last].first + self.batches[last].n - 1
        oldest = max(0, -(-(last_known - REMEMBERED) // STRIDE) * STRIDE)
        begin = bisect(self.batches, oldest, key=lambda one: one.first + one.n - 1)
        return range(begin, last + 1)

    def _designs(self, batch: int) -> tuple[Design, ...]:
        designs = (result.plain_design for result in self._results(self.batches[batch]))
        return tuple(design for design in designs if design is not None)


T = TypeVar("T")
U = TypeVar("U")

WAIT = 0.25  # s to wait for results at a time
GROUP = 128  # most results that are stored together: 10 MB of drives
PER_WORKER = 2  # tests per worker, running or queued; with fewer, the next cell is begun
OUTCOMES = "SELECT outcome, count(*) FROM tests WHERE outcome IS NOT NULL GROUP BY outcome"
PARTS = 4  # per worker, of the items of a generator: few messages, no long wait for the last


class _Out(NamedTuple):
    schedule: BatchScheduler
    task: Task


class Scheduler:
    """Runs one session of a campaign: asks for tests, sends them to the workers, and stores their results."""

    def __init__(
        self,
        stores: Sequence[Store],
        staff: WorkerConfig,
        kind: Callable[[WorkerConfig], Executor],
        chat: ChatSettings | None = None,
        meter: Meter | None = None,
    ) -> None:
        """Prepares the session, with executors of a ``kind``. The limits of ``chat`` hold for all tests
        together; None stands for the settings of each cell. ``meter`` counts, and limits, the use of language
        models in drafts of cells that keep runs."""
        self._stores, self._staff, self._chat, self._meter = stores, staff, chat, meter or Meter()
        self._places = {(store.path, name): at for at, (store, name) in enumerate(_cells(stores))}
        spent = [store.spent() for store in stores]
        self._tokens, self._cost = sum(each[0] for each in spent), sum(each[1] for each in spent)
        self.outcomes = Counter[str]()
        """The number of tests with each outcome, of all sessions."""
        for store in stores:
            self.outcomes += Counter(dict(store.query(OUTCOMES)))
        self._unopened = _cells(stores)
        self._schedules: list[BatchScheduler] = []
        self._out: dict[Future[FinishedTest | OutOfAllowance], _Out] = {}
        self._underfunded: list[_Out] = []
        self._pending: list[tuple[BatchScheduler, FinishedTest]] = []
        self._news: list[tuple[Store, FinishedTest]] = []
        self._group_seconds = min((store.group_seconds for store in stores), default=0.0)
        self._looked = time.monotonic()  # when results were last stored
        self._lost: dict[tuple[int, int], tuple[_Out, str]] = {}  # by place of cell and number of test
        self._error: Exception | None = None
        self._may_write = True
        self._has_news = False
        self.executor = kind(staff)
        self._most_out = 1 if kind is InProcess else PER_WORKER * staff.workers

    def run(self) -> Generator[list[tuple[Store, FinishedTest]], None, None]:
        """Runs tests until none is left; yields each group of tests that have ended, with their stores, once
        they are stored. However the session ends, the results so far are stored and the workers are
        stopped."""
        try:
            yield from self._run()
        except BaseException:
            self.executor.shutdown(cancel_futures=True)
            if self._may_write:
                with suppress(RoadGPTError):  # the caller has an error already
                    if self._error is None:
                        self._take()
                self._keep()
                for store in self._stores:
                    store.end_session()
            raise
        finally:
            self.executor.shutdown(cancel_futures=True)

    def _run(self) -> Iterator[list[tuple[Store, FinishedTest]]]:
        for store in self._stores:
            store.begin_session(self._staff.workers)
        while self._error is None:
            look()
            self._fill()
            if not self._out and not self._underfunded:
                break
            wait(self._out, WAIT, FIRST_COMPLETED)
            self._take()
            if time.monotonic() >= self._looked + self._group_seconds or len(self._pending) >= GROUP:
                self._keep()
            if self._has_news:
                yield self._told()
        if self._error is not None:
            raise self._error
        self._keep()
        yield self._told()

    def _told(self) -> list[tuple[Store, FinishedTest]]:
        self._has_news, news, self._news = False, self._news, []
        return news

    # Handing out

    def _fill(self) -> None:
        if self._underfunded:
            self._retry_underfunded()
            return
        while True:
            is_full = self._error is not None or len(self._out) >= self._most_out
            ready = (one for one in self._schedules if one.may_ask and not (is_full and one.cell.keeps_runs))
            schedule = next(ready, None)
            if schedule is not None:
                self._ask(schedule)
            elif is_full or not self._open():
                return

    def _ask(self, schedule: BatchScheduler) -> None:
        if self._pending:
            self._keep()  # what the generator is told has to be in the store
        if schedule.is_late:
            schedule.close("its time limit was reached")
        else:
            self._hand_out(schedule, schedule.ask(self))
        if schedule.is_done:
            self._schedules.remove(schedule)

    def _open(self) -> bool:
        for store, name in self._unopened:
            schedule = BatchScheduler(self._with_chat(store.cell(name)), store)
            if not schedule.is_done:
                self._schedules.append(schedule)
                self._hand_out(schedule, store.waiting(name))
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
        each = allowance or self._share(2 * max(len(tests), 1))
        for test in tests:
            road = test.proposal.design
            file = b""
            if isinstance(road, GivenRoad):
                from roadgpt.campaign.given import content_of

                file = content_of(road, schedule.store.folder)
            test = replace(test, allowance=each, road=file)
            if schedule.cell.keeps_runs:
                try:
                    test = replace(test, drafted=schedule.draft(test, self._meter))
                except CONCERNS_ALL as error:  # those that are driven now may end, for their drafts were paid
                    while not all(future.done() for future in self._out):
                        look()
                        wait(self._out, WAIT, FIRST_COMPLETED)
                    self._take()
                    self._error = self._error or error
                    return
            shared: list[Shared[Any]] = [schedule.shared, *schedule.earlier(test)]
            future = self.executor.submit(_run_with, schedule.store.run_test, test, *shared)
            self._out[future] = _Out(schedule, test)

    def _share(self, parts: int = 1) -> Allowance:
        """Divides the tokens and money that are left into equal parts, and returns one. The campaign stays
        within its limits even if every test that is under way spends its whole allowance."""
        given = [out.task.allowance for out in self._out.values()]
        tokens, cost = (self._chat.max_tokens, self._chat.max_cost) if self._chat else (None, None)
        if tokens is not None:
            tokens -= self._tokens + sum(each.tokens or 0 for each in given)
            tokens = int(max(tokens, 0) / parts)
        if cost is not None:
            cost -= self._cost + sum(each.cost or 0.0 for each in given)
            cost = max(cost, 0.0) / parts
        return Allowance(tokens, cost)

    def map(self, function: Callable[[T], U], items: Sequence[T]) -> list[U]:
        """Returns the results of ``function`` for all items, in order, for generators: see ``model.Pool``."""
        size = max(1, -(-len(items) // (PARTS * self._staff.workers)))
        return [*self.executor.map(function, items, chunksize=size)]

    def _retry_underfunded(self) -> None:
        """Runs the tests whose allowance was too small one after another, each with all that is left."""
        if self._out:
            return
        one = self._underfunded.pop(0)
        everything = self._share()
        if one.task.allowance == everything:
            self._error = self._no_room(everything)
            return
        self._hand_out(one.schedule, [one.task], everything)

    def _no_room(self, left: Allowance) -> BudgetError:
        """Returns the error that says which limit was reached, and how to go on with twice this limit."""
        assert self._chat is not None, "only limits leave no room"
        tokens, cost = self._chat.max_tokens, self._chat.max_cost
        is_cost = tokens is None or (cost is not None and left.cost == 0)
        limit = f"{cost:g} USD" if is_cost else f"{tokens:,} tokens"
        more = ("--max-cost", f"{2 * (cost or 0):g}") if is_cost else ("--max-tokens", 2 * (tokens or 0))
        return BudgetError(
            f"the limit of {limit} leaves no room for the next question ({self._tokens:,.0f} tokens and "
            f"{self._cost:.4f} USD are spent); continue with a higher one, such as: "
            f"{self._stores[0].to_resume(*more)}"
        )

    # Taking in

    def _take(self) -> None:
        """Takes in the tests that have ended, in the order in which they were handed out."""
        for future in [future for future in self._out if future.done()]:
            out = self._out.pop(future)
            try:
                value = future.result()
            except CancelledError:  # the executor was shut down meanwhile
                continue
            except LostWorkerError as lost:
                value = FinishedTest.of(error_run(out.task, out.schedule.cell, str(lost)), out.task)
            except Exception as error:  # it would occur in every other test as well
                self._error = self._error or error
                continue
            if value.spent is not None:
                self._tokens += value.spent.usage.total
                self._cost += value.spent.cost or 0.0
            if isinstance(value, OutOfAllowance):
                out.schedule.store.spend(value.spent)
                self._underfunded.append(out)
                continue
            self._pending.append((out.schedule, value))
            self.outcomes[value.result.outcome] += 1
            out.schedule.ended(out.task.batch)
            if value.is_lost:
                self._lost[self._place(out)] = out, value.result.description
        self._give_up_if_lost()

    def _give_up_if_lost(self) -> None:
        """Ends the session if the simulator has failed in three successive tests, whichever ended first. They
        and the lost ones after them are reopened for the next session, as if they had not been begun; so are
        those before them that only tests without a result yet keep apart from them."""
        row: list[tuple[int, int]] = []
        for place in sorted(self._lost):
            row = [*row, place] if row and self._is_next(row[-1], place) else [place]
            if len(row) == MOST and self._error is None:
                break
        else:
            return
        self._keep()
        first, open_ = row[0], {self._place(out) for out in self._out.values()}
        while (before := (first[0], first[1] - 1)) in self._lost or before in open_:
            first = before
        again = [out for place, (out, _) in self._lost.items() if place >= first]
        for out in again:
            out.schedule.store.reopen(out.schedule.cell.name, out.task.number, out.task.batch)
        self.outcomes["ERROR"] -= len(again)
        self._error = given_up(self._lost[row[-1]][1], "fix it and continue")

    def _place(self, out: _Out) -> tuple[int, int]:
        return self._places[out.schedule.store.path, out.schedule.cell.name], out.task.number

    def _is_next(self, place: tuple[int, int], other: tuple[int, int]) -> bool:
        """Returns whether ``other`` is the next test after ``place``, perhaps the first of the next cell."""
        cell, number = place
        schedule = self._lost[place][0].schedule
        is_last = schedule.is_closed and number == schedule.asked
        return other == ((cell + 1, 1) if is_last else (cell, number + 1))

    def _keep(self) -> None:
        """Stores the tests that have ended: first their drives, so that every stored result has its drive."""
        now = time.monotonic()
        self._may_write = False  # until all is written
        for store in self._stores:
            ended = [(schedule.cell.name, one) for schedule, one in self._pending if schedule.store is store]
            own = [schedule for schedule in self._schedules if schedule.store is store]
            if ended or own:
                self._keep_in(store, ended, {schedule.cell.name: now - self._looked for schedule in own})
                self._news += [(store, one) for _, one in ended]
        self._may_write = True
        for schedule in self._schedules:
            schedule.seconds += now - self._looked
        self._looked = now
        self._pending = []
        self._has_news = True
        self._schedules = [schedule for schedule in self._schedules if not schedule.is_done]

    @staticmethod
    def _keep_in(store: Store, ended: list[tuple[str, FinishedTest]], taken: dict[str, float]) -> None:
        trace, drives = None, [(cell, one.result.number, one.trace) for cell, one in ended if one.trace]
        if drives:
            from roadgpt.campaign.traces import write_traces

            number = store.next_trace()
            trace = number, write_traces(store.folder, number, drives)
        store.keep(ended, trace, taken)


def _cells(stores: Sequence[Store]) -> Iterator[tuple[Store, str]]:
    return ((store, name) for store in stores for name in store.names())


def _run_with(function: Callable[..., T], task: Task, *shared: Shared[Any]) -> T:
    return function(task, *(each.value for each in shared))
