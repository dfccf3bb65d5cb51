"""Makes the roads of a study: one description after another, or several at once in processes.

Every part draws its own seeds, so the files are the same for any number of processes. If a process is killed,
its part can be resumed where it stopped.
"""

import multiprocessing
import time
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from pathlib import Path
from typing import NamedTuple

from roadgpt.campaign import campaign
from roadgpt.chat import ChatError, Meter, ReplyError
from roadgpt.errors import BriefError, DesignError, GivenUpError, RoadGPTError
from roadgpt.run.folder import Draw, finished
from roadgpt.stopping import look, shielded
from roadgpt.study.plan import StudyPart, StudyPlan

LOOK = 0.3  # s between two looks at how far processes are
KILLED = "its process ended before its work was done; the same command goes on"

Tell = Callable[[str, int], None]
"""Called with the name of the part at work and the number of finished roads of the study."""


class Problem(NamedTuple):
    """Why a part has no roads, or not all."""

    part: str
    """Name of the part's folder."""
    sentence: str
    is_of_chat: bool = False
    """Whether a language model could not be asked."""


def work(
    plan: StudyPlan, folder: Path, workers: int = 1, draw: Draw | None = None, tell: Tell | None = None
) -> list[Problem]:
    """Makes all roads of a study, or those that are missing.

    Args:
        plan: the study.
        folder: the study's folder.
        workers: number of processes. With more than one, the calling program must be importable, as for
            ``multiprocessing``. Designers that ask a language model work in this process, one after another.
        draw: draws pictures into the folders of runs.
        tell: called with the progress.

    Returns:
        Why roads are missing; empty if all were made.

    Raises:
        RoadGPTError: a plug-in is not installed, or the folder cannot be used.
    """
    watch = _Watch(plan, folder, tell)
    alone = [part for part in plan.parts() if workers == 1 or plan.setup_of(part.designer).chat is not None]
    apart = [part for part in plan.parts() if part not in alone]
    problems = _in_processes(plan, apart, folder, workers, draw, watch)
    return problems + _in_turn(plan, alone, folder, draw, watch)


class _Watch:
    """Counts the finished roads."""

    def __init__(self, plan: StudyPlan, folder: Path, tell: Tell | None) -> None:
        self._folders = [folder / part.name for part in plan.parts()]
        self._done = {place: len(finished(place)) for place in self._folders}
        self._tell = tell

    def look(self, at: str) -> None:
        """Counts again and reports the progress."""
        if self._tell is None:
            return
        for place in self._folders:
            if place.is_dir():
                self._done[place] = len(list(place.glob("test.*.json")))
        self._tell(at, sum(self._done.values()))


def _in_turn(
    plan: StudyPlan, parts: Sequence[StudyPart], folder: Path, draw: Draw | None, watch: _Watch
) -> list[Problem]:
    """Makes the parts one after another in this process, with one meter for all language models."""
    problems: list[Problem] = []
    meter = Meter.of(plan.setup.chat)
    silent: dict[str, Problem] = {}
    for part in parts:
        if part.designer in silent:  # whom nobody answered once is not asked again
            problems.append(silent[part.designer]._replace(part=part.name))
            continue
        try:
            make(plan, part, folder, draw, meter, watch)
        except ChatError as error:
            problems.append(Problem(part.name, str(error), is_of_chat=True))
            if not isinstance(error, ReplyError):
                silent[part.designer] = problems[-1]
        except (BriefError, DesignError) as error:
            problems.append(Problem(part.name, str(error)))
    return problems


def make(
    plan: StudyPlan,
    part: StudyPart,
    folder: Path,
    draw: Draw | None,
    meter: Meter | None = None,
    watch: _Watch | None = None,
) -> None:
    """Makes the roads of one part.

    Raises:
        RoadGPTError: as ``run.campaign`` raises it.
    """
    place = folder / part.name
    place.parent.mkdir(parents=True, exist_ok=True)
    setup = plan.setup_of(part.designer)
    made = campaign(part.prompt.prompt, plan.roads, plan.seed, plan.world, setup, place, draw, meter)
    try:
        for _ in made:
            if watch is not None:
                watch.look(part.prompt.prompt)
    except GivenUpError as error:
        raise GivenUpError(error.why, "see to it, and the same command goes on") from error


def _in_processes(
    plan: StudyPlan, parts: Sequence[StudyPart], folder: Path, workers: int, draw: Draw | None, watch: _Watch
) -> list[Problem]:
    """Makes the parts in processes, up to ``workers`` at a time, each in a new process."""
    context = multiprocessing.get_context("spawn")
    waiting, problems = list(parts), list[Problem]()
    at_work: dict[StudyPart, tuple[SpawnProcess, Connection]] = {}
    try:
        while waiting or at_work:
            while waiting and len(at_work) < workers:
                part = waiting.pop(0)
                ours, theirs = context.Pipe(duplex=False)
                process = context.Process(target=_child, args=(plan, part, folder, draw, theirs), daemon=True)
                with shielded():
                    process.start()
                theirs.close()
                at_work[part] = process, ours
            time.sleep(LOOK)
            look()
            for part in [part for part, (process, _) in at_work.items() if not process.is_alive()]:
                problems += _ended(part, *at_work.pop(part))
            watch.look(", ".join(part.prompt.prompt for part in at_work))
    finally:
        for process, _ in at_work.values():
            process.terminate()
            process.join()
    order = [part.name for part in parts]
    return sorted(problems, key=lambda problem: order.index(problem.part))


def _child(plan: StudyPlan, part: StudyPart, folder: Path, draw: Draw | None, end: Connection) -> None:
    """Makes one part in a process; sends errors, which the parent raises again if they end the study."""
    try:
        make(plan, part, folder, draw)
    except KeyboardInterrupt:
        return
    except RoadGPTError as error:
        end.send(error)
    else:
        end.send(None)


def _ended(part: StudyPart, process: SpawnProcess, end: Connection) -> list[Problem]:
    process.join()
    try:
        error = end.recv() if end.poll() else RoadGPTError(f"{part.prompt.prompt}: {KILLED}")
    except EOFError:
        error = RoadGPTError(f"{part.prompt.prompt}: {KILLED}")
    end.close()
    if error is None:
        return []
    if isinstance(error, (BriefError, DesignError)):
        return [Problem(part.name, str(error))]
    raise error


__all__ = ["Problem", "Tell", "make", "work"]
