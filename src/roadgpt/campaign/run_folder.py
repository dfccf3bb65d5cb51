"""Folders of runs, as ``roadgpt run`` and each part of a study write them: campaigns of one cell whose tests
have folders of files.

A worker writes the files of a Run. The process that holds the folder's lock then writes the row of its test,
from when on the test has ended, and the tables of the plug-ins ``tables``."""

from collections import defaultdict
from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Self

from roadgpt import plugins
from roadgpt.brief.model import Brief
from roadgpt.campaign.columns import features_in
from roadgpt.campaign.csv_tables import write_tables
from roadgpt.campaign.folder_record import cannot_go_on, has_tests, is_store, open_record
from roadgpt.campaign.model import PATIENCE, WITHOUT_GOAL, Cell, CellBudget
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import STORE, Record, Store
from roadgpt.campaign.scheduler import Scheduler
from roadgpt.campaign.single_test import FinishedTest, Task, WorkerSetup, error_run, finished_run, run_test
from roadgpt.campaign.workers import LOG, InProcess, WorkerConfig
from roadgpt.chat import ChatError, Meter, Spent
from roadgpt.design import designer_of
from roadgpt.design.room import world_for
from roadgpt.errors import DesignError, RoadGPTError, UsageError, explained
from roadgpt.road import World
from roadgpt.run import PLAIN, USUAL, Request, Run, Setup, brief_of, check_parts, read_run, seed_of, write_run
from roadgpt.run.atomic import (
    LOCK,
    alone_in,
    is_new,
    missing,
    refuse_links,
    set_aside,
    sweep,
    take_away,
    write_whole,
)
from roadgpt.run.execution import test_name, test_text
from roadgpt.run.folder import (
    HOME,
    RUNS,
    Draw,
    is_finished,
    keep_ground,
    new_folder,
    remove_run,
    run_folder,
    write_run_folder,
)
from roadgpt.run.versions import versions_now


@dataclass(frozen=True)
class RunWriter:
    """Runs tests and writes the folders of their Runs."""

    folder: Path
    draw: Draw | None = None  # draws pictures into the folders of Runs; None: no pictures
    returns_runs: bool = False

    def __call__(self, task: Task, cell: Cell) -> FinishedTest:
        """Runs one test and writes the folder of its Run, but not its ``test.NNNN.json``."""
        return self.written(run_test(task, cell, (), Meter()), task)

    def written(self, run: Run, task: Task) -> FinishedTest:
        """Writes the folder of a Run, and returns its test as a FinishedTest."""
        with writing(self.folder):
            own = write_run_folder(run, self.folder, self.draw)
            keep_ground(run.world, self.folder, own)
        kept = run if self.returns_runs else None
        more = {"test_file": test_text(run), "entries": entries_of(run), "run": kept}
        return FinishedTest.of(run, task, features_in(run), **more)


def writing(folder: Path) -> AbstractContextManager[None]:
    """Turns a failure to write to a folder into one clear error message."""
    advice = "make room there and continue with the same command and --out"
    return explained(RoadGPTError, f"cannot write into {folder}", advice)


def entries_of(run: Run) -> dict[str, Any]:
    """Returns what the tables of a folder of runs count of a Run, by the names of the plug-ins ``tables``."""
    return {name: plugins.find("tables", name).entry(run) for name in plugins.names("tables")}


class Tables:
    """The tables of a folder of runs, which the plug-ins ``tables`` write."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._every = {name: plugins.find("tables", name)() for name in plugins.names("tables")}
        self.files = [name for each in self._every.values() for name in each.files]

    def add(self, entries: Mapping[str, Any]) -> None:
        """Counts a Run, see ``entries_of``."""
        for name, entry in entries.items():
            self._every[name].add(entry)

    def write(self) -> None:
        """Writes the tables that change with each road; raises OSError."""
        for each in self._every.values():
            each.write(self._folder)

    def describe(self, request: Request, roads: int) -> None:
        """Writes the tables that do not change with each road; raises OSError."""
        for each in self._every.values():
            each.describe(request, roads, self._folder)


class RunStore(Store):
    """The store of a folder of runs, open for writing."""

    group_seconds = 0.0

    def begin(self, work: "Campaign", returns_runs: bool) -> None:
        """Prepares the folder for a session of a campaign."""
        self.run_test = RunWriter(self.folder, work.draw, returns_runs)
        self._tests, self.tables = work.tests, Tables(self.folder)
        for one in self._tests.values():
            self.tables.add(one.entries)
        with writing(self.folder):
            refuse_links(self.folder / RUNS)
            (self.folder / RUNS).mkdir(exist_ok=True)
            sweep(self.folder)
            sweep(self.folder / RUNS)
            self.tables.describe(work.request, work.roads)
        self.set_plan(Plan.of(work.request, work.roads).model_dump_json())
        self._own = work.cell
        self.set_cell(self._own)
        self.finish(is_finished=False)
        for batch in self.batches(""):
            if not batch.left and batch.first not in self._tests:  # its files are gone
                self.reopen("", batch.first, batch.number)

    def cell(self, name: str) -> Cell:
        """Returns the cell with the settings of language models that this session has."""
        return self._own if name == self._own.name else super().cell(name)

    def keep(self, ended: Sequence[tuple[str, FinishedTest]], *rest: Any) -> None:
        """Stores tests that have ended, and writes their ``test.NNNN.json`` before and the tables after."""
        self.join_versions(ended)
        for cell, one in ended:
            if not one.test_file:  # its workers died, perhaps while they drew pictures
                task = Task(one.result.number, one.result.batch, one.result.proposal)
                one = RunWriter(self.folder).written(
                    error_run(task, self.cell(cell), one.result.description), task
                )
            with writing(self.folder):
                write_whole(self.folder / test_name(one.result.number), one.test_file)
            self._tests[one.result.number] = replace(one, test_file="", run=None)
            self.tables.add(one.entries)
        super().keep(ended, *rest)
        if ended:
            with writing(self.folder):
                self.tables.write()

    def reopen(self, cell: str, number: int, batch: int) -> None:
        """Removes a test that ended without a drive, so that it runs again."""
        super().reopen(cell, number, batch)
        self._tests.pop(number, None)
        self.tables = Tables(self.folder)
        for one in self._tests.values():
            self.tables.add(one.entries)
        with writing(self.folder):
            remove_run(number, self.folder)
            self.tables.write()


@dataclass(repr=False, eq=False)
class Campaign:
    """A folder with the Runs of one request; it may be new or from an earlier session. Iterating over the
    Campaign makes the missing Runs; each Run is on disk when it is yielded."""

    folder: Path
    request: Request
    brief: Brief  # the requirements read from the description
    roads: int  # number of roads requested
    made: tuple[Path, ...] = ()
    """The folders (this folder or parents of it) that this session created, innermost first. They are removed
    if no road can be designed."""
    draw: Draw | None = None
    """Draws pictures into the folders of Runs; None: no pictures."""
    meter: Meter = field(default_factory=Meter)
    """Counts the tokens and cost of language models, including those of earlier sessions in the folder."""
    workers: int = 1
    """Number of processes that drive; with 1, this process drives."""
    tests: dict[int, FinishedTest] = field(default_factory=dict)
    """The tests that have ended and whose files are there, by number."""
    is_over: bool = False
    """True if all tests have ended and the tables of the folder are complete."""
    failure: str = ""
    """Why no road could be designed; empty if a road was designed or none has been tried yet."""

    @classmethod
    def opened(
        cls, request: Request, brief: Brief, roads: int, out: Path | str | None, again: bool = False,
        draw: Draw | None = None, meter: Meter | None = None, workers: int = 1,
    ) -> Self:  # fmt: skip
        """Opens a new folder, or one that holds tests of the same request, which ``again`` sets aside."""
        if roads < 1:
            raise UsageError(f"{roads} roads cannot be made; ask for 1 or more")
        seed_of(request.seed, 1)  # a wrong seed raises an error now
        versions = versions_now([(request, WITHOUT_GOAL)])
        if out is None:
            above, path = missing(HOME), new_folder(request.words, request.seed)
            made = (path, *above)
        else:
            path = Path(out)
            with explained(UsageError, f"cannot use {path}", "name another folder"):
                made = missing(path)
                path.mkdir(parents=True, exist_ok=True)
                if again:
                    set_aside(path, STORE)
                if not is_store(path) and has_tests(path):
                    raise cannot_go_on(path)
                if not is_store(path) and not is_new(path, STORE):
                    raise UsageError(
                        f"{path} is not empty and was not made by roadgpt run; name another folder"
                    )
        work = cls(path, request, brief, roads, made, draw, meter or Meter(), workers)
        if is_store(path):
            work.take_up()
            with Record.opened(path) as record:
                record.refuse_changed(versions)
        else:
            with alone_in(path):
                Store.new(path, Plan.of(request, roads).model_dump_json(), [work.cell], versions).close()
        return work

    @property
    def cell(self) -> Cell:
        """The cell whose tests this folder holds."""
        budget = CellBudget(tests=self.roads)
        return Cell("", self.request, self.brief, WITHOUT_GOAL, None, {}, budget, keeps_runs=True)

    @property
    def is_complete(self) -> bool:
        """True if all tests have ended."""
        return len(self.tests) >= self.roads

    def take_up(self) -> None:
        """Reads the folder's finished tests that are not in ``tests`` yet; ignores Runs that cannot be read.
        Raises UsageError if it holds Runs of another request, or more than asked for."""
        with Record.opened(self.folder) as record:
            if not record.keeps_runs:
                raise UsageError(f"{self.folder} holds a campaign of many tests; name another folder")
            kept, numbers = record.cell(""), [number for _, number in record.tests()]
            was_over = bool(record.meta("finished")) and kept.budget.tests == self.roads
        there_was = kept.request.settings()
        other = [name for name, value in self.request.settings().items() if there_was[name] != value]
        if not other and _asked(kept.brief) != _asked(self.brief):
            other = ["reading of the description"]
        if other:
            raise UsageError(
                f"{self.folder} holds other roads (different {' and '.join(other)}); name another folder, or "
                "add --again to make all its tests anew"
            )
        if numbers and numbers[-1] > self.roads:
            raise UsageError(
                f"{self.folder} holds road {numbers[-1]} already; ask for at least so many "
                "roads or name another folder"
            )
        for number in numbers:
            if number not in self.tests and is_finished(self.folder, number):
                self._read(number)
        self.is_over = was_over and self.is_complete

    def _read(self, number: int) -> None:
        try:
            run = read_run(run_folder(self.folder, number))
        except UsageError:
            return
        if run.index == number:
            self.tests[number] = replace(finished_run(run), entries=entries_of(run))
            self.meter.add(run.spent or Spent())

    @property
    def has_road(self) -> bool:
        """Whether a road has been designed."""
        return any(one.has_road for one in self.tests.values())

    def complete(self, store: Store) -> None:
        """If all tests have ended, writes the tables, draws the picture of all roads, and marks the campaign
        as finished."""
        if self.is_over or not (self.has_road and self.is_complete):
            return
        with writing(self.folder):
            write_tables(store, self.folder)
            if self.draw is not None:
                self.draw.of_campaign(self.folder)
            sweep(self.folder / RUNS)  # of workers that were killed
        store.finish()
        self.is_over = True

    def drop(self, store: Store) -> None:
        """If no road has been designed, removes the tests, and then the folders that this session created, if
        they are empty."""
        if self.has_road:
            return
        for number in self.kept:
            self.failure = self.tests.pop(number).result.description
            remove_run(number, self.folder)
        store.close()
        stored = (f"{STORE}{end}" for end in ("", "-wal", "-shm"))
        every = (*Tables(self.folder).files, LOG, LOCK, *stored)
        take_away((self.folder / name for name in every), (self.folder / RUNS, *self.made))

    def __repr__(self) -> str:
        done = f"{len(self.tests)} of {self.roads} roads"
        return f"Campaign({self.request.words!r}, seed {self.request.seed}, {done}, in {str(self.folder)!r})"

    @property
    def kept(self) -> tuple[int, ...]:
        """Numbers of the finished roads."""
        return tuple(sorted(self.tests))

    def __iter__(self) -> Iterator[Run]:
        """Makes the missing Runs and yields them one by one; raises the same errors as ``all_runs``."""
        return self._runs(with_earlier=False)

    def all_runs(self) -> Iterator[Run]:
        """Yields the Runs that exist, read from disk, then makes the missing ones and yields them.

        Raises:
            DesignError: no road could be designed; the folder is removed, unless it was there before.
            ChatError: a language model cannot be reached, or a token or cost limit is reached; the
                roads finished before this are saved.
            GivenUpError: the simulator failed three times in a row; the three roads have to be made again.
            UsageError: a plug-in is not installed, or another process is using the folder.
            RoadGPTError: a file cannot be written."""
        return self._runs(with_earlier=True)

    def _runs(self, with_earlier: bool) -> Iterator[Run]:
        with closing(work_in(self.folder, {"": self}, self.workers, with_earlier, self.meter)) as tests:
            for _, number, run in tests:
                yield run or read_run(run_folder(self.folder, number))
        if self.failure:
            raise DesignError(self.failure)


def seed_in(folder: Path) -> int | None:
    """Returns the seed of the runs in a folder; None if there are none."""
    if not is_store(folder):
        return None
    with Record.opened(folder) as record:
        return record.cells()[0].request.seed


def _asked(brief: Brief | None) -> dict[str, Any]:
    return {} if brief is None else brief.model_dump(exclude={"confidence", "other", "unused"})


def work_in(
    home: Path,
    folders: Mapping[str, Campaign],
    workers: int = 1,
    with_earlier: bool = False,
    meter: Meter | None = None,
) -> Generator[tuple[str, int, Run | None], None, None]:
    """Runs the remaining tests of folders of runs, lazily: each test runs while the caller iterates. Yields
    the name of the folder and the number of the test as soon as its files are complete, and its Run, if this
    process drove it.

    If no road can be designed for a folder, ``Campaign.failure`` gives the reason, and the folder stays
    without tests. Messages refer to ``home``, in which workers write their log; ``meter`` counts the use of
    language models. ``with_earlier``: the tests of earlier sessions are yielded first."""
    with ExitStack() as stack:
        stores, names = list[RunStore](), dict[Path, str]()
        for name, folder in folders.items():
            stack.enter_context(alone_in(folder.folder))
            folder.take_up()  # another process may have worked in the folder since it was opened
            yield from ((name, number, None) for number in (folder.kept if with_earlier else ()))
            if not folder.is_over:
                store = stack.enter_context(RunStore.opened(folder.folder))
                store.begin(folder, returns_runs=workers <= 1)
                stores.append(store)
                names[store.path] = name
        if not stores:
            return
        refuse_links(home / LOG)
        setups = tuple(dict.fromkeys(folders[name].request.setup for name in names.values()))
        staff = WorkerConfig(workers, WorkerSetup(setups), PATIENCE, home / LOG)
        kind = plugins.find("executors", "processes") if workers > 1 else InProcess
        held = defaultdict[str, list[tuple[str, int, Run | None]]](list)
        try:
            with closing(Scheduler(stores, staff, kind, meter=meter).run()) as steps:
                for news in steps:
                    for its, one in news:
                        held[name := names[its.path]].append((name, one.result.number, one.run))
                        if folders[name].has_road:
                            yield from held.pop(name)
                    for store in stores:
                        folders[names[store.path]].complete(store)
        except ChatError:
            for store in stores:
                folders[names[store.path]].drop(store)
            raise
        for store in stores:
            folders[names[store.path]].drop(store)


def campaign(
    words: str | Brief,
    n: int,
    seed: int = 0,
    world: World = USUAL,
    setup: Setup = PLAIN,
    out: Path | str | None = None,
    draw: Draw | None = None,
    meter: Meter | None = None,
    again: bool = False,
    workers: int = 1,
) -> Campaign:
    """Makes many Runs of one description in one folder; each Run is written as soon as it is finished.

    The roads are made while you iterate over the returned Campaign. Iterate over ``.all_runs()`` instead to
    receive the Runs of earlier sessions as well. ``.folder`` is the campaign's folder. If a driver or a
    simulator fails, only the Run in which it failed is lost.

    Args:
        words: a description, or the Brief that was read from it.
        n: number of roads.
        seed: seed of the campaign; each road's own seed is derived from this seed and the road's index.
        world: the map, the limits that the rules apply, and the friction, as for ``perform``.
        setup: the reader, designer, rules, simulator and driver.
        out: the folder. If it holds an interrupted campaign of the same request, that campaign is continued;
            a finished campaign is left unchanged. None makes a new folder under ``roadgpt-runs``.
        draw: writes pictures into the folders, as ``report.Drawing`` does; None: no pictures.
        meter: as for ``perform``; the cost of earlier roads in the folder is added to it.
        again: whether all roads are made anew; earlier results move into the subfolder ``before-1``.
        workers: number of processes that drive; with 1, this process drives. The Runs are the same.

    Raises:
        BriefError: the words cannot be read.
        UsageError: the folder contains something other than this campaign, something that decides results has
            changed since its first road was made, or a plug-in is not installed."""
    meter = meter or Meter.of(setup.chat)
    brief = words if isinstance(words, Brief) else brief_of(words, world, setup, meter)
    world = world_for(brief, setup.staged(world, brief.left_hand))
    request = Request(words=brief.words, seed=seed, world=world, setup=setup)
    designer_of(setup.designer, setup.chat)
    check_parts(setup, request.world)
    return Campaign.opened(request, brief, n, out, again, draw, meter, workers)


def write_runs(folder: Path, out: Path) -> Iterator[Path]:
    """Writes the tests of a campaign, or of a folder of runs, as files of runs with their tables into
    ``out``; of a campaign, into a folder in ``out`` for each cell. Yields the folder of each Run when it is
    written. Raises UsageError if runs are in ``out`` already."""
    with open_record(folder) as record:
        for cell in record.cells():
            place = out / cell.name
            if (place / RUNS).exists():
                raise UsageError(f"{place} holds runs already; name another folder")
            names, tables = record.tests(cell.name), Tables(place)
            with alone_in(place), writing(place):
                for _, number in names:
                    run = record.run(cell.name, number)
                    write_run(run, place)
                    tables.add(entries_of(run))
                    yield run_folder(place, number)
                tables.describe(cell.request, cell.budget.tests or len(names))
                tables.write()
