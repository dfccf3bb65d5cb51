"""Campaigns whose tests cost nothing: a search that depends on all it is told, and results made of numbers.

As a program: works off such a campaign in a process of its own, so that a test may kill it:
FOLDER TESTS WORKERS [SECONDS of one test]. It prints a line whenever results were kept.
"""

import sys
import time
from collections.abc import Callable, Collection, Iterator, Sequence
from concurrent.futures import Executor, Future, wait
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt import plugins
from roadgpt.campaign import lifecycle, scheduler
from roadgpt.campaign.executors import WorkerConfig
from roadgpt.campaign.model import Cell, CellBudget, Pool, Proposal, Result
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import STORE, Store
from roadgpt.campaign.single_test import FinishedTest, Task
from roadgpt.road import Design, Road, Segment, World
from roadgpt_search.surrogate import RoadSamples, features_of_samples

OUTCOMES = ("PASS", "FAIL", "INVALID", "ERROR", "VALID")


def a_design(number: int) -> Design:
    """A design that tells one number."""
    return Design(
        starting_point=(0, 0, 0),
        theta=number % 360,
        segments=(Segment(distance=50 + number / 7, direction="straight"),),
    )


def features_of_road(road: Road, world: World) -> Any:
    """What a surrogate sees of a road that is built."""
    found = road.sample()
    middle = world.profile_of(road).middle(found.s)
    return features_of_samples(RoadSamples(found.s, found.curvature, found.grade, middle), world)


def made(task: Task, cell: Cell, *earlier: tuple[Design, ...]) -> FinishedTest:
    """A result that depends on everything that a result may depend on."""
    proposal = task.proposal
    known = [design.theta for block in earlier for design in block]
    design = proposal.design or a_design(proposal.seed + task.number + round(sum(known)))
    rng = np.random.default_rng(
        [proposal.seed, task.number, len(known), round(sum(known)), round(design.theta)]
    )
    result = Result(
        number=task.number,
        batch=task.batch,
        proposal=proposal,
        outcome=OUTCOMES[rng.integers(5)],
        description=f"knew {len(known)} designs, 'quoted', \"twice\"\nand ünïcode",
        design=design,
        length=float(rng.random() * 300),
        margin=float(rng.normal()) if rng.random() < 0.9 else None,
        features={"A": float(rng.random()), f"B_{rng.integers(3)}": float(rng.integers(9))},
    )
    return FinishedTest(result)


def slowly(task: Task, cell: Cell, *earlier: tuple[Design, ...]) -> FinishedTest:
    """The same, in as many seconds as the cell's settings say."""
    time.sleep(cell.settings["seconds"])
    return made(task, cell, *earlier)


def nothing() -> None:
    """Prepares nobody."""


class Search:
    """Asks for what follows from everything it was told, in that order; every third test is drafted."""

    batch_size = 5
    told: list[tuple[str, int, list[int]]] = []  # noqa: RUF012 - of all that were made, for tests to look at

    def __init__(self, cell: Cell) -> None:
        self.cell = cell
        self.sum = 0.0

    def ask(self, batch: int, first: int, n: int, pool: Pool) -> list[Proposal]:
        Search.told.append(("ask", batch, []))
        rng = np.random.default_rng([self.cell.request.seed, batch])
        drawn = pool.map(abs, [int(rng.integers(1000)) + round(1000 * self.sum) for _ in range(n)])
        return [
            Proposal(None if number % 3 == 0 else a_design(number), number, f"vary {number}")
            for number in drawn
        ]

    def tell(self, results: Sequence[Result]) -> None:
        Search.told.append(("tell", results[0].batch, [result.number for result in results]))
        for result in results:
            self.sum = (self.sum * 1.25 + (result.margin or 0.5) + sum(result.features.values())) % 7


class InlineJob(Future[Any]):
    """A job of the executor below."""

    def __init__(self, executor: "Inline", number: int, call: Callable[[], Any]) -> None:
        super().__init__()
        self.executor, self.number, self.call = executor, number, call


class Inline(Executor):
    """An executor without workers: jobs end a few at a time while somebody waits, in an order drawn by
    ``rng``."""

    rng = np.random.default_rng(0)

    def __init__(self, staff: WorkerConfig) -> None:
        self.staff = staff
        self.jobs: list[InlineJob] = []
        self.submitted = 0

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> InlineJob:
        self.submitted += 1
        job = InlineJob(self, self.submitted, partial(fn, *args, **kwargs))
        self.jobs.append(job)
        return job

    def map(self, fn: Callable[..., Any], *iterables: Any, **_: Any) -> Iterator[Any]:
        return map(fn, *iterables)

    def some(self) -> None:
        """A few jobs end."""
        for _ in range(min(len(self.jobs), int(self.rng.integers(1, 4)))):
            near = min(len(self.jobs), 3 * self.staff.workers)
            self.end(self.jobs.pop(int(self.rng.integers(near))))

    def end(self, job: InlineJob) -> None:
        """One of them."""
        job.set_result(job.call())


def awaited(jobs: Collection[Future[Any]], *rest: Any) -> None:
    """In place of ``concurrent.futures.wait``."""
    first = next(iter(jobs), None)
    if isinstance(first, InlineJob):
        first.executor.some()
    else:
        wait(jobs, *rest)


def plan(tests: int, cells: int = 1, seconds: float = 0.0, **rest: Any) -> Plan:
    """A plan of quick tests."""
    return Plan(
        prompts=("hairpin x2",),
        reader="plan",
        generators=("search",),
        seeds=tuple(range(cells)),
        budget=CellBudget(tests=tests),
        settings={"seconds": seconds},
        drives=False,
        **rest,
    )


def put_on_shelves(patch: Any, seconds: float = 0.0) -> None:
    """Let the parts above be found; ``patch(object, name, value)`` sets an attribute."""
    installed = plugins.find
    parts = {"search": Search, "inline": Inline}
    patch(plugins, "find", lambda shelf, name: parts.get(name) or installed(shelf, name))
    patch(scheduler, "wait", awaited)
    patch(Store, "run_test", staticmethod(slowly if seconds else made))
    patch(lifecycle, "WorkerSetup", lambda setups: nothing)


def main() -> None:
    """Work until everything is done."""
    folder, tests, workers = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    seconds = float(sys.argv[4]) if len(sys.argv) > 4 else 0.0
    put_on_shelves(setattr, seconds)
    Store.group_seconds = 0.05  # so that kills fall into the keeping of results, too
    if not (folder / STORE).exists():
        lifecycle.begin(plan(tests, seconds=seconds), folder)
    for progress in lifecycle.work(folder, workers):
        print(progress.total(), flush=True)


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
    import campaign.quick

    campaign.quick.main()  # under its own name, so that workers find its functions
