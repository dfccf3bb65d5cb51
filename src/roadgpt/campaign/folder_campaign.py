"""Campaigns whose tests are written into folders of runs, as ``roadgpt run`` and studies have them."""

from collections.abc import Generator, Iterator, Mapping
from contextlib import closing
from pathlib import Path

from roadgpt import plugins
from roadgpt.brief.model import Brief
from roadgpt.campaign.executors import Executor, WorkerConfig
from roadgpt.campaign.folder_store import FolderStore
from roadgpt.campaign.model import PATIENCE, WITHOUT_GOAL, Budget, Cell
from roadgpt.campaign.run_folder import FinishedRun, RunFolder, RunWriter
from roadgpt.campaign.scheduler import Scheduler
from roadgpt.campaign.single_test import WorkerSetup
from roadgpt.campaign.workers.in_process import InProcess
from roadgpt.campaign.workers.worker_log import LOG
from roadgpt.chat import ChatError, Meter
from roadgpt.design import designer_of
from roadgpt.errors import DesignError
from roadgpt.road import World
from roadgpt.run import PLAIN, USUAL, Draw, Request, Run, Setup, brief_of, check_parts, read_run
from roadgpt.run.atomic import alone_in, refuse_links
from roadgpt.run.folder import run_folder


def work_in(
    home: Path,
    folders: Mapping[str, RunFolder],
    briefs: Mapping[str, Brief],
    draw: Draw | None = None,
    meter: Meter | None = None,
    workers: int = 0,
) -> Generator[tuple[str, FinishedRun], None, None]:
    """Runs the tests that folders of runs lack; the work happens while the caller iterates.

    The caller has prepared each folder with ``RunFolder.begin``, and holds ``alone_in`` for as long as it
    iterates. The files do not depend on the number of workers.

    Args:
        home: the folder that messages name, and where workers write their log.
        folders: the folders, by name.
        briefs: what was read from the description of each folder.
        draw: draws pictures into the folders; None: no pictures.
        meter: counts the use of language models, if the tests run in this process.
        workers: number of worker processes; 0: the tests run in this process, and their Runs are returned.

    Yields:
        The name of the folder and the test, as soon as the files of the test are complete.

    If no road could be designed for a folder, its ``failure`` gives the reason, and nothing is left in it.

    Raises:
        ChatError: a language model cannot be asked, or a limit is reached; finished tests are kept.
        GivenUpError: the simulator failed three times in a row; these three tests have to be run again.
        UsageError: a plug-in is not installed.
        RoadGPTError: a file cannot be written, or there are no workers.
    """
    cells = [
        Cell(
            name,
            folder.request,
            briefs[name],
            generator=WITHOUT_GOAL,
            goal=None,
            budget=Budget(tests=folder.roads),
            in_sequence=True,
        )
        for name, folder in folders.items()
    ]
    writer = RunWriter({name: folder.path for name, folder in folders.items()}, draw, meter)
    setups = tuple(dict.fromkeys(folder.request.setup for folder in folders.values()))
    refuse_links(home / LOG)
    staff = WorkerConfig(max(workers, 1), WorkerSetup(setups), PATIENCE, home / LOG)
    kind: type[Executor] = plugins.find("executors", "processes") if workers else InProcess
    left = dict(folders)
    try:
        with FolderStore(home, folders, cells) as store:
            scheduler = Scheduler(store, staff, kind, run_test=writer)
            with closing(scheduler.run()) as steps:
                for _ in steps:
                    written, store.written = store.written, []
                    yield from written
                    for name in [name for name, folder in left.items() if folder.is_complete]:
                        left.pop(name).close(draw)
    except ChatError:
        for folder in left.values():
            folder.drop_held_back()
        raise
    except BaseException:
        # however it ends, the tables tell of every road that is there
        for folder in left.values():
            folder.write_tables()
        raise
    for folder in left.values():
        folder.drop_held_back()


class Campaign:
    """Makes the Runs of one description; iterate over it to make them. Each Run is on disk when it is
    yielded."""

    def __init__(
        self, runs: RunFolder, brief: Brief, draw: Draw | None = None, meter: Meter | None = None
    ) -> None:
        """Takes the folder, the requirements, what draws pictures, and the meter; adds the cost of earlier
        roads to the meter."""
        self._runs, self._brief, self._draw = runs, brief, draw
        self.meter = meter or Meter()
        """Counts the use of language models, for earlier roads of the folder as well."""
        self.meter.add(runs.spent)

    def __repr__(self) -> str:
        done = f"{len(self.kept)} of {self.roads} roads"
        return f"Campaign({self.request.words!r}, seed {self.request.seed}, {done}, in {str(self.folder)!r})"

    @property
    def folder(self) -> Path:
        """The folder of the Runs."""
        return self._runs.path

    @property
    def request(self) -> Request:
        """The request that the Runs have in common."""
        return self._runs.request

    @property
    def roads(self) -> int:
        """Number of roads requested."""
        return self._runs.roads

    @property
    def kept(self) -> tuple[int, ...]:
        """Numbers of the finished roads."""
        return tuple(sorted(self._runs.tests))

    @property
    def is_complete(self) -> bool:
        """True if all roads are finished."""
        return self._runs.is_complete

    def __iter__(self) -> Iterator[Run]:
        """Yields the Runs that are still to be made, one by one; raises what ``all_runs`` raises."""
        return self._all(with_earlier=False)

    def all_runs(self) -> Iterator[Run]:
        """Yields the Runs that exist, read from disk, then makes the missing ones and yields them.

        Raises:
            DesignError: no road could be designed; the folder is removed, unless it was there before.
            ChatError: a language model cannot be asked, or a limit is reached; the roads finished before this
                are saved.
            GivenUpError: the simulator failed three times in a row; the three roads have to be made again.
            UsageError: a plug-in is not installed, or another process is using the folder.
            RoadGPTError: a file cannot be written.
        """
        return self._all(with_earlier=True)

    def earlier_runs(self) -> Iterator[Run]:
        """Yields the Runs that an earlier session made, read from disk."""
        for index in self.kept:
            yield read_run(run_folder(self.folder, index))

    def _all(self, with_earlier: bool) -> Iterator[Run]:
        runs = self._runs
        with alone_in(runs.path):
            is_finished = runs.begin()
            if with_earlier:
                yield from self.earlier_runs()
            if is_finished:
                return
            with closing(work_in(runs.path, {"": runs}, {"": self._brief}, self._draw, self.meter)) as tests:
                for _, ended in tests:
                    if ended.run is not None:
                        yield ended.run
        if runs.failure:
            raise DesignError(runs.failure)


def campaign(
    words: str | Brief,
    n: int,
    seed: int = 0,
    world: World = USUAL,
    setup: Setup = PLAIN,
    out: Path | str | None = None,
    draw: Draw | None = None,
    meter: Meter | None = None,
) -> Campaign:
    """Makes many Runs of one description, and writes each Run into one folder as soon as it is finished.

    The roads are made while you iterate over the returned Campaign. Iterate over ``.all_runs()`` instead to
    receive also the Runs that an earlier session made. ``.folder`` is the campaign's folder. If a driver or a
    simulator fails, only the Run in which it failed is lost.

    Args:
        words: a description, or the Brief that was read from it.
        n: number of roads.
        seed: seed of the campaign; each road's own seed is derived from this seed and the road's index.
        world: map, limits of the rules, surface.
        setup: the reader, designer, rules, simulator and driver.
        out: the folder. If it holds an interrupted campaign of the same request, that campaign is continued;
            a finished campaign is left unchanged. None makes a new folder under ``roadgpt-runs``.
        draw: writes pictures into the folders, as ``report.drawing()`` does; None: no pictures.
        meter: as for ``perform``; the cost of earlier roads in the folder is added to it.

    Raises:
        BriefError: the words cannot be read.
        UsageError: the folder holds something other than this campaign, or a plug-in is not installed.
    """
    meter = meter or Meter.of(setup.chat)
    brief = words if isinstance(words, Brief) else brief_of(words, world, setup, meter)
    request = Request(words=brief.words, seed=seed, world=world, setup=setup)
    designer_of(setup.designer, setup.chat)
    check_parts(setup, world)
    return Campaign(RunFolder.opened(request, n, out), brief, draw, meter)
