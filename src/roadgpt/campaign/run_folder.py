"""Folders of runs, as ``roadgpt run`` and each part of a study write them, as the stores of cells.

Each folder has a record of its tests, see ``run.store``. The process that holds the folder's lock adds a row
to it when the files of a Run are written; from then on the test has ended. Its tables are those of the
plug-ins ``tables``."""

import sqlite3
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack, closing
from dataclasses import dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from typing import Any, Self

from roadgpt import plugins
from roadgpt.brief.model import Brief
from roadgpt.campaign.columns import features_in
from roadgpt.campaign.model import GIVEN, PATIENCE, WITHOUT_GOAL, Cell, CellBudget, Proposal
from roadgpt.campaign.record import SCHEMA, Record
from roadgpt.campaign.scheduler import Scheduler
from roadgpt.campaign.single_test import FinishedTest, Task, WorkerSetup, error_run, run_test
from roadgpt.campaign.workers import LOG, InProcess, WorkerConfig
from roadgpt.chat import ChatError, Meter, Spent
from roadgpt.design import designer_of
from roadgpt.design.room import world_for
from roadgpt.errors import DesignError, RoadGPTError, UsageError, explained
from roadgpt.road import Design, World
from roadgpt.run import PLAIN, USUAL, Request, Run, Setup, atomic, brief_of, check_parts, store
from roadgpt.run.atomic import LOCK, json_text, missing, refuse_links, sweep, take_away, write_whole
from roadgpt.run.execution import test_name, test_text
from roadgpt.run.folder import (
    CARD,
    HOME,
    RUNS,
    Card,
    Draw,
    finished,
    finished_run_in,
    keep_ground,
    new_folder,
    read_card,
    remove_run,
    run_folder,
    write_again,
    write_run_folder,
)
from roadgpt.run.versions import Versions, joined, still, versions_now


@dataclass(frozen=True)
class RunWriter:
    """Runs tests and writes their Runs into folders."""

    folders: Mapping[str, Path]  # the folder of each cell
    draw: Draw | None = None  # draws pictures into the folders of Runs; None: no pictures
    meter: Meter | None = None  # counts the use of language models in this process; None on workers

    def __call__(self, task: Task, cell: Cell, *earlier: tuple[Design, ...]) -> FinishedTest:
        """Runs one test and writes the folder of its Run, but not its ``test.NNNN.json``."""
        return self.written(run_test(task, cell, earlier, self.meter or Meter()), task, cell.name)

    def written(self, run: Run, task: Task, cell: str) -> FinishedTest:
        """Writes the folder of a Run, and returns its test as a FinishedTest."""
        with writing(self.folders[cell]):
            own = write_run_folder(run, self.folders[cell], self.draw)
            keep_ground(run.world, self.folders[cell], own)
        kept = None if self.meter is None else run
        return FinishedTest.of(run, task, test_file=test_text(run), entries=_entries(run), run=kept)


def finished_run(run: Run) -> FinishedTest:
    """Converts the Run of an earlier session to a FinishedTest."""
    proposal = Proposal(run.design, run.seed, "draft" if run.words or run.brief else GIVEN)
    return FinishedTest.of(run, Task(run.index, run.index - 1, proposal), features_in(run, told_alone=True))


def counted(run: Run) -> FinishedTest:
    """Returns what ``finished_run`` does, with what the tables count."""
    return replace(finished_run(run), entries=_entries(run))


def _entries(run: Run) -> dict[str, Any]:
    return {name: plugins.find("tables", name).entry(run) for name in plugins.names("tables")}


def _tables() -> dict[str, Any]:
    return {name: plugins.find("tables", name)() for name in plugins.names("tables")}


def writing(folder: Path) -> AbstractContextManager[None]:
    """Turns a failure to write to a folder into one clear error message."""
    advice = "make room there and continue with the same command and --out"
    return explained(RoadGPTError, f"cannot write into {folder}", advice)


@dataclass(repr=False, eq=False)
class Campaign:
    """A folder with the Runs of one request; it may be new or from an earlier session. Iterating over the
    Campaign makes the missing Runs; each Run is on disk when it is yielded."""

    folder: Path
    request: Request
    brief: Brief | None  # the requirements read from the description; None if there is none
    roads: int  # number of roads requested
    made: tuple[Path, ...] = ()
    """The folders (this folder or parents of it) that this session created, innermost first. They are removed
    if no road can be designed."""
    tests: dict[int, FinishedTest] = field(default_factory=dict)  # the tests that have ended, by number
    failure: str = ""
    """Why no road could be designed; empty if a road was designed or none has been tried yet."""
    versions: Versions = field(default_factory=dict)
    """What decides the results of the tests besides the request."""
    draw: Draw | None = None
    """Draws pictures into the folders of Runs; None: no pictures."""
    meter: Meter = field(default_factory=Meter)
    """Counts the tokens and cost of language models, including those of earlier sessions in the folder."""
    _tables: dict[str, Any] = field(default_factory=_tables)
    _held_back: list[FinishedTest] = field(default_factory=list)

    @classmethod
    def opened(
        cls, request: Request, brief: Brief, roads: int, out: Path | str | None, again: bool = False,
        draw: Draw | None = None, meter: Meter | None = None,
    ) -> Self:  # fmt: skip
        """Opens a new folder, or one that holds tests of the same request, which ``again`` sets aside."""
        if roads < 1:
            raise UsageError(f"{roads} roads cannot be made; ask for 1 or more")
        read = brief.model_dump_json(exclude={"confidence", "other", "unused"}, exclude_defaults=True)
        now = versions_now([(request, WITHOUT_GOAL)])[request.setup.driver]
        now["reading"] = sha256(read.encode()).hexdigest()[:16]
        if out is None:
            made = missing(HOME)
            path = new_folder(request.words, request.seed)
            return cls(path, request, brief, roads, (path, *made), {}, "", now, draw, meter or Meter())
        path = Path(out)
        with explained(UsageError, f"cannot use {path}", "name another folder"):
            made = missing(path)
            path.mkdir(parents=True, exist_ok=True)
            if again:
                atomic.set_aside(path, CARD)
            holds_tests = not atomic.is_new(path, CARD)
        folder = cls(path, request, brief, roads, made, {}, "", now, draw, meter or Meter())
        if holds_tests:
            folder.take_up()
        return folder

    @property
    def is_complete(self) -> bool:
        """True if all tests have ended."""
        return len(self.tests) >= self.roads

    def take_up(self) -> Card:
        """Reads the folder's finished tests that are not in ``tests`` yet; ignores Runs that cannot be read.
        Raises UsageError if it holds Runs of another request, or more than asked for, or of other versions.
        """
        card = read_card(self.folder)
        there_was = card.request.settings()
        other = [name for name, value in self.request.settings().items() if there_was[name] != value]
        if other:
            raise UsageError(
                f"{self.folder} holds other roads (different {' and '.join(other)}); name another folder, or "
                "add --again to make all its tests anew"
            )
        there = finished(self.folder)
        if there and not store.is_kept(self.folder):
            raise UsageError(
                f"{self.folder} has no {store.STORE}, the record of its tests, so they are shown but not "
                "continued; name another folder, or add --again to make all its tests anew"
            )
        if there and there[-1] > self.roads:
            raise UsageError(
                f"{self.folder} holds road {there[-1]} already; ask for at least so many "
                "roads or name another folder"
            )
        if there:
            self.versions = still(card.versions, self.versions, self.request.setup.driver, self.folder)
        for index in there:
            if index not in self.tests:
                self._read(index)
        return card

    def _read(self, index: int) -> None:
        try:
            run = finished_run_in(self.folder, index)
        except UsageError:
            return
        if run.index == index:
            self.count(counted(run))
            self.meter.add(run.spent or Spent())

    def cell(self, name: str) -> Cell:
        """Returns the cell whose tests this folder holds."""
        generator = WITHOUT_GOAL if self.request.words or self.brief else GIVEN
        budget = CellBudget(tests=self.roads)
        return Cell(name, self.request, self.brief, generator, None, {}, budget, in_sequence=True)

    def begin(self) -> bool:
        """Prepares the folder for a session. If all tests have ended, changes nothing and returns True."""
        # another process may have worked in the folder since it was opened
        if (self.folder / CARD).is_file() and self.take_up().is_finished and self.is_complete:
            return True
        with writing(self.folder):
            refuse_links(self.folder / RUNS)
            sweep(self.folder)
            self.write_card(is_finished=False)
            (self.folder / RUNS).mkdir(exist_ok=True)
            sweep(self.folder / RUNS)
            for number in self.tests:  # a killed process may have left a row whose files were not written
                places = self.folder / test_name(number), run_folder(self.folder, number)
                if not all(place.exists() for place in places):
                    write_again(self.folder, number, self.folder)
            self.write_settings()
        return False

    def write_settings(self) -> None:
        """Writes the tables that do not change with each road."""
        for each in self._tables.values():
            each.describe(self.request, self.roads, self.folder)

    def add(self, ended: FinishedTest) -> list[FinishedTest]:
        """Writes the file of a test that has ended, and then the tables; returns the tests that were written.
        Tests without a road are held back until a road has been designed, so that the folder stays empty if
        none can be."""
        self.versions = joined(self.versions, ended.driver_files, self.folder)
        self._held_back.append(ended)
        if not any(one.has_road for one in (ended, *self.tests.values())):
            return []
        written, self._held_back = self._held_back, []
        with writing(self.folder):
            for one in written:
                self.keep(one)
        return written

    def keep(self, ended: FinishedTest) -> None:
        """Stores a test whose Run is written, from when on it has ended; then writes its ``test.NNNN.json``
        and the tables. Raises OSError."""
        number = ended.result.number
        self.write_card(is_finished=False)
        store.keep(self.folder, number, run_folder(self.folder, number), ended.test_file)
        write_whole(self.folder / test_name(number), ended.test_file)
        self.count(ended)
        self.write_tables()

    def remove(self, number: int) -> None:
        """Removes a test that has no drive, so that it is run when the campaign continues."""
        self.tests.pop(number, None)
        self._tables = _tables()
        for ended in [*self.tests.values()]:
            self.count(ended)
        with writing(self.folder):
            store.remove(self.folder, number)
            remove_run(number, self.folder)
            self.write_tables()

    def write_tables(self) -> None:
        """Writes the tables, which count all tests in the folder."""
        with writing(self.folder):
            for each in self._tables.values():
                each.write(self.folder)

    def close(self, draw: Draw | None = None) -> None:
        """Writes the tables, draws the picture of all roads, and marks the campaign as finished."""
        with writing(self.folder):
            self.write_tables()
            if draw is not None:
                draw.of_campaign(self.folder)
            self.write_card(is_finished=True)

    def drop_held_back(self) -> None:
        """Discards the tests that were held back because they have no road; removes the folder if it holds
        no other test."""
        with writing(self.folder):
            for one in self._held_back:
                remove_run(one.result.number, self.folder)
                self.failure = one.result.description
            self._held_back = []
            if self.tests:
                self.write_tables()
            else:
                self.take_away(LOCK)

    def take_away(self, *names: str) -> None:
        """Removes ``campaign.json``, the tables and the files in ``names``; then ``runs/`` and the folders
        that were created for this session, if they are empty."""
        tables = (name for each in self._tables.values() for name in each.files)
        every = (CARD, *tables, store.STORE, *names)
        take_away((self.folder / name for name in every), (self.folder / RUNS, *self.made))

    def count(self, ended: FinishedTest) -> None:
        """Counts a test that has ended for the tables."""
        self.tests[ended.result.number] = replace(ended, test_file="", run=None)
        for name, entry in (ended.entries or {}).items():
            self._tables[name].add(entry)

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
        tests = work_in(self.folder, {"": self}, self.draw, self.meter, with_earlier=with_earlier)
        with closing(tests):
            for _, ended in tests:
                assert ended.run is not None
                yield ended.run
        if self.failure:
            raise DesignError(self.failure)

    def write_card(self, is_finished: bool) -> None:
        """Writes ``campaign.json``; raises OSError."""
        card = Card(request=self.request, roads=self.roads, is_finished=is_finished, versions=self.versions)
        write_whole(self.folder / CARD, json_text(card.model_dump(mode="json")))


class FolderStore(Record):
    """A store whose tests lie in folders of runs, one for each cell; the tables are built from them in
    memory, so that the same code schedules, resumes and counts both kinds of campaigns."""

    group_seconds = 0.0

    def __init__(self, home: Path, folders: Mapping[str, Campaign], cells: Sequence[Cell]) -> None:
        """Builds the tables from the tests in the folder of each cell; messages name the folder ``home``."""
        super().__init__(home / CARD, sqlite3.connect(":memory:", isolation_level=None))
        self._folders = folders
        self._cells = {cell.name: cell for cell in cells}
        self.written: list[tuple[str, FinishedTest]] = []
        """Tests whose files were written, with their cells' names; code that reads this list empties it."""
        self._db.executescript(SCHEMA)
        self._db.execute("INSERT INTO meta VALUES ('finished', '')")
        self._db.executemany(
            "INSERT INTO cells(name, cell) VALUES (?, '')", [(name,) for name in self._cells]
        )
        for name, folder in folders.items():
            self._enter(name, folder.tests, range(1, max(folder.tests, default=0) + 1))

    def _enter(
        self, cell: str, ended: Mapping[int, FinishedTest], numbers: Iterable[int] | None = None
    ) -> None:
        """Enters tests into the tables; tests of ``numbers`` that have not ended are still to be run."""
        seed = self._cells[cell].request.seed
        for number in ended if numbers is None else numbers:
            made = ended[number].result.proposal if number in ended else Proposal(None, seed, "draft")
            self.add_batch(cell, number - 1, number, [made])
        super().keep([(cell, one) for one in ended.values()])

    def to_resume(self, *more: object) -> str:
        """Returns the command that continues the tests, with further options."""
        if all(each.folder == self.folder for each in self._folders.values()):
            return super().to_resume(*more)
        return " ".join(map(str, ("the same command with --out", self.folder, *more)))

    def names(self) -> list[str]:
        """Returns the names of all cells."""
        return [*self._cells]

    def cells(self) -> list[Cell]:
        """Returns all cells."""
        return [*self._cells.values()]

    def cell(self, name: str) -> Cell:
        """Returns one cell; raises UsageError if there is none of that name."""
        return self._cells[name] if name in self._cells else super().cell(name)

    def keep(self, ended: Sequence[tuple[str, FinishedTest]], *rest: Any) -> None:
        """Enters tests that have ended into the tables, and writes their files; see ``Campaign.add``."""
        super().keep(ended, *rest)
        for name, one in ended:
            if one.entries is None:  # its workers died, perhaps while they drew pictures
                task = Task(one.result.number, one.result.batch, one.result.proposal)
                run = error_run(task, self._cells[name], one.result.description)
                one = RunWriter({name: self._folders[name].folder}).written(run, task, name)
            self.written += [(name, each) for each in self._folders[name].add(one)]

    def reopen(self, cell: str, number: int, batch: int) -> None:
        """Removes a test that ended without a drive, so that it runs again."""
        super().reopen(cell, number, batch)
        self._folders[cell].remove(number)


def work_in(
    home: Path,
    folders: Mapping[str, Campaign],
    draw: Draw | None = None,
    meter: Meter | None = None,
    workers: int = 0,
    with_earlier: bool = False,
) -> Generator[tuple[str, FinishedTest], None, None]:
    """Runs the remaining tests of folders of runs, lazily: each test runs while the caller iterates. Yields
    the name of the folder and the test, as soon as the files of the test are complete.

    If no road can be designed for a folder, ``Campaign.failure`` gives the reason, and the folder stays
    without tests. Messages refer to ``home``, in which ``workers`` processes write their log; with 0, the
    tests run in this process, where ``meter`` counts the use of language models. ``with_earlier``: the tests
    of earlier sessions are yielded first."""
    with ExitStack() as stack:
        for folder in folders.values():
            stack.enter_context(atomic.alone_in(folder.folder))
        left = {name: folder for name, folder in folders.items() if not folder.begin()}
        for name, folder in folders.items() if with_earlier else ():
            for number, ended in sorted(folder.tests.items()):
                yield name, replace(ended, run=finished_run_in(folder.folder, number))
        if not left:
            return
        refuse_links(home / LOG)
        cells = [each.cell(name) for name, each in left.items()]
        setups = tuple(dict.fromkeys(cell.request.setup for cell in cells))
        staff = WorkerConfig(max(workers, 1), WorkerSetup(setups), PATIENCE, home / LOG)
        kind = plugins.find("executors", "processes") if workers else InProcess
        places = {name: each.folder for name, each in left.items()}
        writer = RunWriter(places, draw, None if workers else meter or Meter())
        store = stack.enter_context(FolderStore(home, {**left}, cells))
        try:
            with closing(Scheduler(store, staff, kind, run_test=writer).run()) as steps:
                for _ in steps:
                    written, store.written = store.written, []
                    yield from written
                    for name in [name for name, folder in left.items() if folder.is_complete]:
                        left.pop(name).close(draw)
        except BaseException as error:
            for folder in left.values():  # their tables must count every finished road
                folder.drop_held_back() if isinstance(error, ChatError) else folder.write_tables()
            raise
        for folder in left.values():
            folder.drop_held_back()


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
    return Campaign.opened(request, brief, n, out, again, draw, meter)
