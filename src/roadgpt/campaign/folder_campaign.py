"""Campaigns that write their tests into folders of runs, such as those of ``roadgpt run`` and of studies."""

from collections.abc import Generator, Iterator, Mapping
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from roadgpt import plugins
from roadgpt.brief.model import Brief
from roadgpt.campaign.folder_store import FolderStore
from roadgpt.campaign.jobs import WorkerConfig
from roadgpt.campaign.model import PATIENCE
from roadgpt.campaign.run_folder import FinishedRun, RunFolder, RunWriter
from roadgpt.campaign.scheduler import Scheduler
from roadgpt.campaign.single_test import WorkerSetup
from roadgpt.campaign.workers.in_process import InProcess
from roadgpt.campaign.workers.worker_log import LOG
from roadgpt.chat import ChatError, Meter
from roadgpt.design import designer_of
from roadgpt.design.room import world_for
from roadgpt.errors import DesignError
from roadgpt.road import World
from roadgpt.run import PLAIN, USUAL, Draw, Request, Run, Setup, brief_of, check_parts, read_run
from roadgpt.run.atomic import alone_in, refuse_links
from roadgpt.run.folder import run_folder

if TYPE_CHECKING:
    from roadgpt.campaign.executors import Executor


def work_in(
    home: Path,
    folders: Mapping[str, RunFolder],
    draw: Draw | None = None,
    meter: Meter | None = None,
    workers: int = 0,
    with_earlier: bool = False,
) -> Generator[tuple[str, FinishedRun], None, None]:
    """Runs the remaining tests of folders of runs, lazily: each test runs while the caller iterates. Yields
    the name of the folder and the test, as soon as the files of the test are complete.

    If no road can be designed for a folder, ``RunFolder.failure`` gives the reason, and the folder stays
    without tests.

    Args:
        home: the folder that messages refer to, and in which workers write their log.
        folders: the folders, by name.
        draw: draws pictures and saves them in the folders; None: no pictures.
        meter: counts the use of language models, if the tests run in this process; None: a new one.
        workers: number of worker processes, on which no file depends; 0: the tests run in this process.
        with_earlier: whether the tests of earlier sessions are yielded first.

    Raises:
        ChatError: a language model cannot be reached, or a token or cost limit is reached; finished
            tests are kept.
        GivenUpError: the simulator failed three times in a row; these three tests have to be run again.
        UsageError: a plug-in is not installed, or another process works in one of the folders.
        RoadGPTError: a file cannot be written, or there are no workers.
    """
    with ExitStack() as stack:
        for folder in folders.values():
            stack.enter_context(alone_in(folder.folder))
        left = {name: folder for name, folder in folders.items() if not folder.begin()}
        if with_earlier:
            for name, folder in folders.items():
                for number in sorted(folder.tests):
                    run = read_run(run_folder(folder.folder, number))
                    yield name, replace(folder.tests[number], run=run)
        if left:
            yield from _worked(home, left, draw, meter, workers)


def _worked(
    home: Path, left: dict[str, RunFolder], draw: Draw | None, meter: Meter | None, workers: int
) -> Iterator[tuple[str, FinishedRun]]:
    """Runs the tests of folders that ``RunFolder.begin`` has prepared; drops finished ones from ``left``."""
    cells = [each.cell(name) for name, each in left.items()]
    setups = tuple(dict.fromkeys(cell.request.setup for cell in cells))
    refuse_links(home / LOG)
    staff = WorkerConfig(max(workers, 1), WorkerSetup(setups), PATIENCE, home / LOG)
    kind: type[Executor] = plugins.find("executors", "processes") if workers else InProcess
    writer = RunWriter(
        {name: each.folder for name, each in left.items()}, draw, None if workers else meter or Meter()
    )
    try:
        with (
            FolderStore(home, dict(left), cells) as store,
            closing(Scheduler(store, staff, kind, run_test=writer).run()) as steps,
        ):
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
        # however the session ends, the tables must count every finished road
        for folder in left.values():
            folder.write_tables()
        raise
    for folder in left.values():
        folder.drop_held_back()


@dataclass(repr=False, eq=False)
class Campaign(RunFolder):
    """The Runs of one description. Iterating over the Campaign makes the missing Runs; each Run is on disk
    when it is yielded.
    """

    draw: Draw | None = None
    """Draws pictures into the folders of Runs; None: no pictures."""
    meter: Meter = field(default_factory=Meter)
    """Counts the tokens and cost of language models, including those of earlier sessions in the folder."""

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
            RoadGPTError: a file cannot be written.
        """
        return self._runs(with_earlier=True)

    def _runs(self, with_earlier: bool) -> Iterator[Run]:
        tests = work_in(self.folder, {"": self}, self.draw, self.meter, with_earlier=with_earlier)
        with closing(tests):
            for _, ended in tests:
                assert ended.run is not None
                yield ended.run
        if self.failure:
            raise DesignError(self.failure)


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
        draw: writes pictures into the folders, as ``report.drawing()`` does; None: no pictures.
        meter: as for ``perform``; the cost of earlier roads in the folder is added to it.
        again: whether all roads are made anew; earlier results move into the subfolder ``before-1``.

    Raises:
        BriefError: the words cannot be read.
        UsageError: the folder contains something other than this campaign, something that decides results has
            changed since its first road was made, or a plug-in is not installed.
    """
    meter = meter or Meter.of(setup.chat)
    brief = words if isinstance(words, Brief) else brief_of(words, world, setup, meter)
    request = Request(words=brief.words, seed=seed, world=world_for(brief, world), setup=setup)
    designer_of(setup.designer, setup.chat)
    check_parts(setup, request.world)
    made = Campaign.opened(request, brief, n, out, again)
    made.draw, made.meter = draw, meter
    meter.add(made.spent)
    return made
