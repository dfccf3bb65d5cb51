"""Makes the campaigns of a study: one description after another, or several at once in processes.

Every campaign draws its own seeds, so the files are the same for any number of processes. A process that is
killed leaves a campaign that goes on where it stopped.
"""

import multiprocessing
import time
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from pathlib import Path
from typing import NamedTuple

from roadgpt.chat import ChatError, Meter, ReplyError
from roadgpt.errors import BriefError, DesignError, GivenUpError, RoadGPTError
from roadgpt.run import campaign
from roadgpt.run.campaign_runs import finished
from roadgpt.run.folder import Draw
from roadgpt.stopping import look, shielded
from roadgpt.study.plan import Part, Plan

LOOK = 0.3  # s between two looks at how far processes are
KILLED = "its process ended before its work was done; the same command goes on"

Tell = Callable[[str, int], None]
"""Told of the part at work and of how many roads of the study are finished."""


class Problem(NamedTuple):
    """Why a part has no roads, or not all."""

    part: str
    """Name of its folder."""
    sentence: str
    is_of_chat: bool = False
    """A language model could not be asked."""


def work(
    plan: Plan, folder: Path, workers: int = 1, draw: Draw | None = None, tell: Tell | None = None
) -> list[Problem]:
    """Make all campaigns of a study, or what is missing of them.

    Args:
        plan: what is asked for.
        folder: of the study.
        workers: processes; with more than one, the calling program must be importable, as for
            ``multiprocessing``. Designers that ask a language model work in this process, one after another.
        draw: puts pictures into the folders of runs.
        tell: hears how far it is.

    Returns:
        What could not be made; the rest is there.

    Raises:
        RoadGPTError: a part is not installed, or the folder cannot be used.
    """
    watch = _Watch(plan, folder, tell)
    alone = [part for part in plan.parts() if workers == 1 or plan.setup_of(part.designer).chat is not None]
    apart = [part for part in plan.parts() if part not in alone]
    problems = _in_processes(plan, apart, folder, workers, draw, watch)
    return problems + _in_turn(plan, alone, folder, draw, watch)


class _Watch:
    """Counts the roads that are finished."""

    def __init__(self, plan: Plan, folder: Path, tell: Tell | None) -> None:
        self._folders = [folder / part.name for part in plan.parts()]
        self._done = {place: len(finished(place)) for place in self._folders}
        self._tell = tell

    def look(self, at: str) -> None:
        """Count anew, and tell."""
        if self._tell is None:
            return
        for place in self._folders:
            if place.is_dir():
                self._done[place] = len(list(place.glob("test.*.json")))
        self._tell(at, sum(self._done.values()))


def _in_turn(
    plan: Plan, parts: Sequence[Part], folder: Path, draw: Draw | None, watch: _Watch
) -> list[Problem]:
    """One after another, here; one meter counts what all of them ask a language model."""
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
    plan: Plan,
    part: Part,
    folder: Path,
    draw: Draw | None,
    meter: Meter | None = None,
    watch: _Watch | None = None,
) -> None:
    """Make the campaign of one part.

    Raises:
        RoadGPTError: as ``run.campaign`` and its iteration.
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
    plan: Plan, parts: Sequence[Part], folder: Path, workers: int, draw: Draw | None, watch: _Watch
) -> list[Problem]:
    """So many at a time, each in a new process."""
    context = multiprocessing.get_context("spawn")
    waiting, at_work, problems = list(parts), dict[Part, tuple[SpawnProcess, Connection]](), list[Problem]()
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


def _child(plan: Plan, part: Part, folder: Path, draw: Draw | None, end: Connection) -> None:
    """The work of a process; what goes wrong is sent, and raised again over there where it ends the study."""
    try:
        make(plan, part, folder, draw)
    except KeyboardInterrupt:
        return
    except RoadGPTError as error:
        end.send(error)
    else:
        end.send(None)


def _ended(part: Part, process: SpawnProcess, end: Connection) -> list[Problem]:
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
