"""Makes the roads of a study: each study part is a folder of runs, filled by the campaign engine.

Every part has its own sequence of seeds, so the files do not depend on the number of worker processes. After
an interruption, ``work`` makes the roads that are missing.
"""

from collections.abc import Callable, Iterable
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

from roadgpt.campaign.run_folder import Campaign, work_in
from roadgpt.chat import ChatError, Meter, ReplyError
from roadgpt.design.room import world_for, world_remarks
from roadgpt.errors import BriefError
from roadgpt.run import Request, brief_of, check_parts
from roadgpt.run.atomic import alone_in
from roadgpt.run.folder import Draw, finished
from roadgpt_study.plan import StudyPart, StudyPlan

AT_ONCE = 100  # parts whose folders are locked together: macOS lets a process open 256 files

Tell = Callable[[int], object]
"""A function that is called with the number of finished roads of the study."""
Note = Callable[[str], object]
"""A function that is called with a sentence on the friction or the map size of a part."""


class Problem(NamedTuple):
    """The reason why roads of one study part are missing."""

    part: str
    """Name of the folder of the study part."""
    sentence: str
    is_of_chat: bool = False
    """True if the reason is a failed request to a language model."""


def work(
    plan: StudyPlan,
    folder: Path,
    workers: int = 1,
    draw: Draw | None = None,
    tell: Tell = lambda _: None,
    note: Note = lambda _: None,
) -> list[Problem]:
    """Makes all roads of a study that do not exist yet, and returns one Problem for each study part that
    lacks roads. This process makes the parts whose designer or reader asks a language model, one after
    another; ``workers`` processes make all others, or this one if there is one. ``tell`` and ``note`` are
    told how many roads are finished, and which descriptions name a surface or need a larger map."""
    session = _Session(plan, folder, draw, tell, note)
    asking = {name for name in plan.designers if plan.setup_of(name).chat is not None}
    with alone_in(folder):
        others = [part for part in plan.parts() if part.designer not in asking]
        for first in range(0, len(others), AT_ONCE):
            session.make(others[first : first + AT_ONCE], workers)
        session.make_in_turn(part for part in plan.parts() if part.designer in asking)
    return [session.problems[part.name] for part in plan.parts() if part.name in session.problems]


class _Session:
    """Makes the roads of parts, counts them, and records why roads are missing."""

    def __init__(self, plan: StudyPlan, folder: Path, draw: Draw | None, tell: Tell, note: Note) -> None:
        self.plan, self.folder, self.draw, self.tell, self.note = plan, folder, draw, tell, note
        self.done = {part.name: len(finished(folder / part.name)) for part in plan.parts()}
        self.problems: dict[str, Problem] = {}

    def make(self, parts: Iterable[StudyPart], workers: int, meter: Meter | None = None) -> None:
        """Makes the roads of all parts together; raises ChatError if a language model cannot be asked."""
        plan, folders = self.plan, dict[str, Campaign]()
        for part in parts:
            setup = plan.setup_of(part.designer)
            try:
                brief = brief_of(part.prompt.prompt, plan.world, setup, meter)
            except BriefError as error:
                self.problems[part.name] = Problem(part.name, str(error))
                continue
            world = world_for(brief, plan.world)
            check_parts(setup, world)
            for said in world_remarks(brief, plan.world, world):
                self.note(f"{part.name}: {said}")
            request = Request(words=brief.words, seed=plan.seed, world=world, setup=setup)
            place = self.folder / part.name
            place.parent.mkdir(parents=True, exist_ok=True)
            folders[part.name] = runs = Campaign.opened(
                request, brief, plan.roads, place, draw=self.draw, meter=meter
            )
        with closing(work_in(self.folder, folders, workers, meter=meter)) as tests:
            for name, _, _ in tests:
                self.done[name] += 1
                self.tell(sum(self.done.values()))
        for name, runs in folders.items():
            if runs.failure:
                self.problems[name] = Problem(name, runs.failure)

    def make_in_turn(self, parts: Iterable[StudyPart]) -> None:
        meter, silent = Meter.of(self.plan.setup.chat), dict[str, Problem]()
        for part in parts:
            if part.designer in silent:  # a designer whose server did not answer is not asked again
                self.problems[part.name] = silent[part.designer]._replace(part=part.name)
                continue
            try:
                self.make([part], 1, meter)
            except ChatError as error:
                self.problems[part.name] = problem = Problem(part.name, str(error), is_of_chat=True)
                if not isinstance(error, ReplyError):
                    silent[part.designer] = problem
