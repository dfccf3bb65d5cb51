"""Uses a folder of runs, as ``roadgpt run`` and each part of a study write it, as the store of one cell.

The files in the folder, which are those of the SBFT competition, are the only record of its tests. A test has
ended when its ``test.NNNN.json`` exists: this file is written last, by the process that holds the folder's
lock.
"""

from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from hashlib import sha256
from pathlib import Path
from typing import Self

from roadgpt.brief.model import Brief
from roadgpt.campaign.model import WITHOUT_GOAL, Cell, CellBudget, Proposal
from roadgpt.campaign.single_test import FinishedTest, Task, result_of, run_test
from roadgpt.chat import Meter, Spent
from roadgpt.errors import RoadGPTError, UsageError, explained
from roadgpt.road import Design
from roadgpt.run import Request, Run, atomic, read_run
from roadgpt.run.atomic import LOCK, json_text, missing, refuse_links, sweep, take_away, write_whole
from roadgpt.run.card import CARD, Card, read_card
from roadgpt.run.folder import RUNS, Draw, finished, remove_run, run_folder, write_run_folder
from roadgpt.run.folder_names import HOME, new_folder
from roadgpt.run.sbft_json import test_name, test_text
from roadgpt.run.tables import DESCRIPTION, TABLES, Tally, TallyEntry, write_description
from roadgpt.run.versions import Versions, joined, still, versions_now

GIVEN = "given"  # origin of roads that were not made from a description


@dataclass(frozen=True)
class FinishedRun(FinishedTest):
    """A test that has ended and whose Run is stored in a folder of runs."""

    test_file: str = ""
    """Text to write into ``test.NNNN.json``; empty if this file exists already."""
    entry: TallyEntry | None = None
    """The values of this test that are counted in the folder's tables."""
    run: Run | None = None
    """The Run; None if a worker process or an earlier session ran the test."""


@dataclass(frozen=True)
class RunWriter:
    """Runs tests and writes their Runs into folders."""

    folders: Mapping[str, Path]
    """The folder of each cell."""
    draw: Draw | None = None
    """Draws pictures into the folders of Runs; None: no pictures."""
    meter: Meter | None = None
    """Counts the use of language models in this process; None on workers."""

    def __call__(self, task: Task, cell: Cell, *earlier: tuple[Design, ...]) -> FinishedRun:
        """Runs one test and writes the folder of its Run, but not its ``test.NNNN.json``.

        Raises the errors of ``single_test.execute``, and RoadGPTError if a file cannot be written.
        """
        return self.written(run_test(task, cell, earlier, self.meter or Meter()), task, cell.name)

    def written(self, run: Run, task: Task, cell: str) -> FinishedRun:
        """Writes the folder of a Run, and returns its test as a FinishedRun."""
        with writing(self.folders[cell]):
            write_run_folder(run, self.folders[cell], self.draw)
        result, text, entry = result_of(run, task, {}), test_text(run), TallyEntry.of(run)
        made = FinishedRun(
            result, None, run.seconds, run.spent, run.trace, run.is_lost, run.driver_files, text, entry
        )
        return made if self.meter is None else replace(made, run=run)


def finished_run(run: Run) -> FinishedRun:
    """Converts the Run of an earlier session to a FinishedRun."""
    proposal = Proposal(run.design, run.seed, "draft" if run.words or run.brief else GIVEN)
    task = Task(run.index, run.index - 1, proposal)
    return FinishedRun(result_of(run, task, {}), None, run.seconds, run.spent, run.trace)


def writing(folder: Path) -> AbstractContextManager[None]:
    """Turns a failure to write to a folder into one clear error message."""
    advice = "make room there and continue with the same command and --out"
    return explained(RoadGPTError, f"cannot write into {folder}", advice)


@dataclass
class RunFolder:
    """A folder with the Runs of one request; it may be new or from an earlier session."""

    folder: Path
    request: Request
    brief: Brief | None
    """The requirements read from the description; None if there is none."""
    roads: int
    """Number of roads requested."""
    made: tuple[Path, ...] = ()
    """The folders (this folder or parents of it) that this session created, innermost first. They are removed
    if no road can be designed.
    """
    tests: dict[int, FinishedRun] = field(default_factory=dict)
    """The tests that have ended, by number."""
    spent: Spent = field(default_factory=Spent)
    """Tokens and money that language models used for the tests of earlier sessions."""
    failure: str = ""
    """Why no road could be designed; empty if a road was designed or none has been tried yet."""
    versions: Versions = field(default_factory=dict)
    """What decides the results of the tests besides the request."""
    _tally: Tally = field(default_factory=Tally)
    _held_back: list[FinishedRun] = field(default_factory=list)

    @classmethod
    def opened(
        cls, request: Request, brief: Brief, roads: int, out: Path | str | None, again: bool = False
    ) -> Self:
        """Opens a folder: a new one, or one that holds tests of the same request, which ``again`` sets aside.

        Raises:
            UsageError: the folder holds something other than tests of this request, what decides their
                results has changed, or the folder cannot be created.
        """
        if roads < 1:
            raise UsageError(f"{roads} roads cannot be made; ask for 1 or more")
        read = brief.model_dump_json(exclude={"confidence", "other", "unused"}, exclude_defaults=True)
        now = versions_now([(request, WITHOUT_GOAL)])[request.setup.driver]
        now["reading"] = sha256(read.encode()).hexdigest()[:16]
        if out is None:
            made = missing(HOME)
            path = new_folder(request.words, request.seed)
            return cls(path, request, brief, roads, (path, *made), versions=now)
        path = Path(out)
        with explained(UsageError, f"cannot use {path}", "name another folder"):
            made = missing(path)
            path.mkdir(parents=True, exist_ok=True)
            if again:
                atomic.set_aside(path, CARD)
            holds_tests = not atomic.is_new(path, CARD)
        folder = cls(path, request, brief, roads, made, versions=now)
        if holds_tests:
            folder.take_up()
        return folder

    @property
    def is_complete(self) -> bool:
        """True if all tests have ended."""
        return len(self.tests) >= self.roads

    def take_up(self) -> Card:
        """Reads the folder's finished tests that are not in ``tests`` yet; ignores Runs that cannot be read.
        Raises UsageError if the folder holds Runs of another request, or more than were requested, or if
        what decides their results has changed."""
        card = read_card(self.folder)
        there_was = card.request.settings()
        other = [name for name, value in self.request.settings().items() if there_was[name] != value]
        if other:
            raise UsageError(
                f"{self.folder} holds other roads (different {' and '.join(other)}); name another folder, or "
                "add --again to make all its tests anew"
            )
        there = finished(self.folder)
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
            run = read_run(run_folder(self.folder, index))
        except UsageError:
            return
        if run.index == index:
            self._count(replace(finished_run(run), entry=TallyEntry.of(run)))
            self.spent += run.spent or Spent()

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
            write_description(self.request, self.roads, self.folder)
        return False

    def add(self, ended: FinishedRun) -> list[FinishedRun]:
        """Writes the file of a test that has ended, and then the tables; returns the tests that were written.

        Tests without a road are held back until a road has been designed, so that the folder stays without
        tests if no road can satisfy the description. Raises UsageError if a file of the driver has changed
        since an earlier test.
        """
        self.versions = joined(self.versions, ended.driver_files, self.folder)
        self._held_back.append(ended)
        if not (self._tally.with_road or (ended.entry and ended.entry.has_road)):
            return []
        written, self._held_back = self._held_back, []
        with writing(self.folder):
            for one in written:
                self.keep(one)
        return written

    def keep(self, ended: FinishedRun) -> None:
        """Writes the ``test.NNNN.json`` of a test, after its Run, and the tables; raises OSError."""
        self.write_card(is_finished=False)
        write_whole(self.folder / test_name(ended.result.number), ended.test_file)
        self._count(ended)
        self._tally.write(self.folder)

    def remove(self, number: int) -> None:
        """Removes a test that has no drive, so that it is run when the campaign continues."""
        self.tests.pop(number, None)
        self._tally = Tally()
        for ended in [*self.tests.values()]:
            self._count(ended)
        with writing(self.folder):
            remove_run(number, self.folder)
            self._tally.write(self.folder)

    def write_tables(self) -> None:
        """Writes the tables, which count all tests in the folder."""
        with writing(self.folder):
            self._tally.write(self.folder)

    def close(self, draw: Draw | None = None) -> None:
        """Writes the tables, draws the picture of all roads, and marks the campaign as finished."""
        with writing(self.folder):
            self._tally.write(self.folder)
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
                self._tally.write(self.folder)
            else:
                self.take_away(LOCK)

    def take_away(self, *names: str) -> None:
        """Removes ``campaign.json``, the tables and the files in ``names``; then ``runs/`` and the folders
        that were created for this session, if they are empty."""
        every = (CARD, DESCRIPTION, *TABLES, *names)
        take_away((self.folder / name for name in every), (self.folder / RUNS, *self.made))

    def _count(self, ended: FinishedRun) -> None:
        self.tests[ended.result.number] = replace(ended, test_file="", run=None)
        if ended.entry is not None:
            self._tally.add(ended.entry)

    def write_card(self, is_finished: bool) -> None:
        """Writes ``campaign.json``; raises OSError."""
        card = Card(request=self.request, roads=self.roads, is_finished=is_finished, versions=self.versions)
        write_whole(self.folder / CARD, json_text(card.model_dump(mode="json")))
