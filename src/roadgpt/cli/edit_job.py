"""Carries out one change request, for ``roadgpt edit`` and for the interactive conversation."""

import json
import sys
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from roadgpt.cli import options
from roadgpt.cli.result_row import row_of, spending
from roadgpt.cli.screen import Screen

if TYPE_CHECKING:
    from roadgpt.chat import ChatSettings
    from roadgpt.design.edit import Edited
    from roadgpt.report import Format
    from roadgpt.road import World
    from roadgpt.run.editing import Original


@dataclass(frozen=True)
class EditJob:
    """One change request with its options."""

    road: str
    """Path of a run's folder, or of a road file."""
    words: str
    out: Path | None
    designer: str
    world: "World"
    """The World for a design that belongs to no run."""
    chat: "ChatSettings | None" = None
    driver: str | None = None
    """The run's driver as given with ``--driver``; None if it was not given."""
    drives: bool = True
    pictures: "tuple[Format, ...]" = ("png",)
    """Formats of the pictures; none are drawn if empty."""


def edit_road(job: EditJob, screen: Screen) -> Path:
    """Changes a road as requested, checks and drives it, writes and prints its run, and returns the run's
    folder.

    Raises:
        RoadGPTError: The request or the road cannot be used; nothing is written.
    """
    from roadgpt.drive.permission import check_named_driver, require_permission
    from roadgpt.run import Setup, prove
    from roadgpt.run.editing import folder_for, original, reject_used, write_edit
    from roadgpt.run.sbft_json import test_name

    if job.out is not None:
        reject_used(job.out)
    before = _of_test(job.road) or original(job.road, job.world, Setup())
    for remark in before.remarks:
        screen.say(f"{job.road}: {remark}")
    check_named_driver(job.driver, {before.setup.driver}, job.road)
    if job.drives and before.setup.drives:
        require_permission(before.setup.driver)
    made = _edited(before, job, screen)
    drives = job.drives and before.setup.drives
    setup = before.setup.model_copy(update={"designer": job.designer, "chat": job.chat, "drives": drives})
    old = prove(before.design, before.seed, before.world, setup.model_copy(update={"drives": False}))
    with redirect_stdout(sys.stderr):  # a user's driver may print
        run = prove(made.design, before.seed, before.world, setup)
    folder = folder_for(job.words, before.seed, job.out)
    draw = options.drawing_of(job.pictures)
    place = write_edit(run, old, job.words, made.changes, before.path, folder, draw)
    row = row_of(run, str(folder / test_name(1)), test_name(1))
    if screen.as_json:
        told = {"request": job.words, "of": before.path, "changes": made.changes, "unused": made.unused}
        print(json.dumps({**told, **json.loads(row.to_json())}, ensure_ascii=False))
        return place
    for sentence in made.changes:
        screen.say(sentence)
    if made.unused:
        screen.say("not understood: " + ", ".join(f"'{word}'" for word in made.unused))
    with screen:
        screen.row(row)
    screen.say(f"changed road: {place}")
    if job.pictures:
        kind = job.pictures[0]
        screen.say(f"pictures: {place}/*.{kind}, and of the road as it was: {place}/before/*.{kind}")
    return place


def _of_test(road: str) -> "Original | None":
    """Returns the design of a test or of a run by its number; None if the name is something else."""
    from roadgpt.campaign.selection import selection_of
    from roadgpt.run.editing import original_of

    place = selection_of(road)
    return None if place is None or place.number is None else original_of(place.run(), place.said)


def _edited(before: "Original", job: EditJob, screen: Screen) -> "Edited":
    """Returns the changed design, and prints what a language model has cost even if the change failed."""
    from roadgpt.chat import Meter, counting
    from roadgpt.design.edit import edit

    meter = Meter.of(job.chat)
    try:
        with counting(meter, "edit"):
            return edit(before.design, job.words, before.world, before.setup.geometry, job.designer, job.chat)
    finally:
        if meter.spent.calls:
            screen.say(f"language model: {spending(meter.spent)}")
