"""Decides when to request the next batch of tests from a cell's generator, and tells it the results."""

from bisect import bisect

from roadgpt import plugins
from roadgpt.campaign.model import Cell, Generator, Pool, Result
from roadgpt.campaign.single_test import Task
from roadgpt.campaign.store_tables import Batch, Tables
from roadgpt.errors import RoadGPTError
from roadgpt.road import Design

REMEMBERED = 2048  # latest designs that a draft must differ from, 50 MB per worker; older ones are left out
STRIDE = 512  # designs that are dropped at a time, so that designers' caches of the others stay valid
LAG = 2  # batches: batch k is requested with the results of batches up to k - 2
GIVE_UP = 3  # tests without a road, after which a cell is closed if it has no road yet


class BatchScheduler:
    """Requests batches of tests from the generator of one cell.

    Batch k is requested once all tests of batch k - 2 have ended. By then the generator has received the
    results of batches 0 to k - 2, and no others. If the tests of the cell run one after another, each batch
    consists of one test and is requested once all earlier tests have ended.
    """

    def __init__(self, cell: Cell, store: Tables) -> None:
        self.cell = cell
        self._store = store
        self.batches: list[Batch] = store.batches(cell.name)
        ((self.seconds, self.closed),) = store.query(
            "SELECT seconds, closed FROM cells WHERE name = ?", (cell.name,)
        )
        self._generator: Generator | None = None
        self._lag = 1 if cell.in_sequence else LAG
        self._unfinished = {batch.number for batch in self.batches if batch.left}
        self._batches_told = self._tests_told = 0
        self._has_road = False

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
        last = len(self.batches) - self._lag
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
        self._store.close_cell(self.cell.name, why)
        self.closed = why

    def ask(self, pool: Pool) -> list[Task]:
        """Requests the next batch, stores it, and returns its tests.

        Closes the cell and returns nothing if the generator has nothing left to propose, or if at least three
        tests have ended and none of them has a road.

        Raises:
            RoadGPTError: the generator proposes more tests than were requested, or asks for a draft in a cell
                without a description.
        """
        batch, first = len(self.batches), self.asked + 1
        generator = self._taught(batch - self._lag)
        if self._tests_told >= GIVE_UP and not self._has_road:
            self.close(f"no road could be designed: {self._last.description}")
            return []
        most = 1 if self.cell.in_sequence else generator.batch_size
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
        self._store.add_batch(self.cell.name, batch, first, proposals)
        self.batches.append(Batch(batch, first, len(proposals), len(proposals)))
        self._unfinished.add(batch)
        return [Task(number, batch, made) for number, made in enumerate(proposals, first)]

    def _taught(self, last: int) -> Generator:
        """Returns the generator after passing it the results of all batches up to number ``last``."""
        if self._generator is None:
            self._generator = plugins.find("generators", self.cell.generator)(self.cell)
        generator: Generator = self._generator
        while self._batches_told <= last:
            results = self._results(self.batches[self._batches_told])
            self._has_road = self._has_road or any(result.design for result in results)
            self._last = results[-1]
            generator.tell(results)
            self._batches_told += 1
            self._tests_told += len(results)
        return generator

    def _results(self, batch: Batch) -> list[Result]:
        between = "tests.number BETWEEN ? AND ?"
        return [*self._store.results(self.cell.name, between, (batch.first, batch.first + batch.n - 1))]

    def known(self, batch: int) -> range:
        """Returns the indices of earlier batches from whose roads every draft in ``batch`` must differ."""
        last = batch - self._lag
        if last < 0 or self.cell.in_sequence:
            return range(last + 1)
        last_known = self.batches[last].first + self.batches[last].n - 1
        oldest = max(0, -(-(last_known - REMEMBERED) // STRIDE) * STRIDE)
        begin = bisect(self.batches, oldest, key=lambda one: one.first + one.n - 1)
        return range(begin, last + 1)

    def designs(self, batch: int) -> tuple[Design, ...]:
        """Returns the designs of the tests in a batch, except those with junctions; all tests of the batch
        must have ended.
        """
        designs = (result.plain_design for result in self._results(self.batches[batch]))
        return tuple(design for design in designs if design is not None)
