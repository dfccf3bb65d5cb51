"""The course of one cell: which batch is asked for next, and what its generator has been told by then."""

from bisect import bisect
from collections.abc import Iterable

from roadgpt import plugins
from roadgpt.campaign.model import Cell, Generator, Pool, Proposal, Result
from roadgpt.campaign.record import Batch
from roadgpt.campaign.store import Store
from roadgpt.errors import RoadGPTError
from roadgpt.road import Design

REMEMBERED = 2048  # designs that a draft is not to repeat, 50 MB in each worker; older ones are forgotten
STRIDE = 512  # of them at a time, so that what designers remember of the others stays of use
LAG = 2  # batches: number k knows results up to k - 2


class BatchScheduler:
    """A cell at work. Batch k is asked for when all of batch k - 2 have ended, and knows no later one."""

    def __init__(self, cell: Cell, store: Store) -> None:
        self.cell = cell
        self._store = store
        self.batches: list[Batch] = store.batches(cell.name)
        ((self.seconds, self.closed),) = store.query(
            "SELECT seconds, closed FROM cells WHERE name = ?", (cell.name,)
        )
        self._generator: Generator | None = None
        self._told = 0
        self._has_road = False

    @property
    def asked(self) -> int:
        """Tests, so far."""
        return sum(batch.n for batch in self.batches[-1:]) + (
            self.batches[-1].first - 1 if self.batches else 0
        )

    @property
    def is_closed(self) -> bool:
        """Is nothing more asked for?"""
        return self.closed is not None or self.asked >= self.cell.budget.most

    @property
    def is_done(self) -> bool:
        """Have all tests ended, and will there be no more?"""
        return self.is_closed and not any(batch.left for batch in self.batches[-LAG:])

    @property
    def may_ask(self) -> bool:
        """Is it time for the next batch?"""
        return not self.is_closed and not any(batch.left for batch in self.batches[: 1 - LAG][-1:])

    @property
    def is_late(self) -> bool:
        """Is the time up?"""
        limit = self.cell.budget.seconds
        return limit is not None and self.seconds >= limit

    def ended(self, batch: int) -> None:
        """A test of a batch has ended."""
        self.batches[batch].left -= 1

    def close(self, why: str) -> None:
        """Ask for nothing more."""
        self._store.close_cell(self.cell.name, why)
        self.closed = why

    def ask(self, pool: Pool) -> list[tuple[int, Proposal]]:
        """The next batch, with the numbers of its tests; it is in the store when this returns.

        Empty where there is nothing left to ask for, or no road can be designed: then the course is closed.

        Raises:
            RoadGPTError: the generator asks for what cannot be.
        """
        batch, first = len(self.batches), self.asked + 1
        generator = self._taught(batch - LAG)
        if batch >= LAG and not self._has_road:
            self.close(f"no road could be designed: {self._last.description}")
            return []
        n = min(generator.batch_size, self.cell.budget.most - self.asked)
        proposals = generator.ask(batch, first, n, pool)
        if len(proposals) > n:
            raise RoadGPTError(
                f"the generator '{self.cell.generator}' asks for {len(proposals)} tests where {n} were wanted"
            )
        if self.cell.brief is None and any(proposal.design is None for proposal in proposals):
            raise RoadGPTError(
                f"the generator '{self.cell.generator}' wants roads drafted, and there are no words to draft "
                "them from; give a description"
            )
        if not proposals:
            self.close("there is nothing left to ask for")
            return []
        self._store.add_batch(self.cell.name, batch, first, proposals)
        self.batches.append(Batch(batch, first, len(proposals), len(proposals)))
        return [*enumerate(proposals, first)]

    def _taught(self, last: int) -> Generator:
        """The generator, told of all batches up to this one."""
        if self._generator is None:
            self._generator = plugins.find("generators", self.cell.generator)(self.cell)
        generator: Generator = self._generator
        while self._told <= last:
            results = self._results(self.batches[self._told])
            self._has_road = self._has_road or any(result.design for result in results)
            self._last = results[-1]
            generator.tell(results)
            self._told += 1
        return generator

    def _results(self, batch: Batch) -> list[Result]:
        between = "tests.number BETWEEN ? AND ?"
        return [*self._store.results(self.cell.name, between, (batch.first, batch.first + batch.n - 1))]

    def known(self, batch: int) -> range:
        """Batches whose designs a draft of this batch is not to repeat."""
        last = batch - LAG
        if last < 0:
            return range(0)
        told = self.batches[last].first + self.batches[last].n - 1
        oldest = max(0, -(-(told - REMEMBERED) // STRIDE) * STRIDE)
        begin = bisect(self.batches, oldest, key=lambda one: one.first + one.n - 1)
        return range(begin, last + 1)

    def designs(self, batch: int) -> tuple[Design, ...]:
        """Of a batch that has ended."""
        return tuple(designs_of(self._results(self.batches[batch])))


def designs_of(results: Iterable[Result]) -> list[Design]:
    """Designs of results, where there are any."""
    return [result.design for result in results if result.design is not None]
