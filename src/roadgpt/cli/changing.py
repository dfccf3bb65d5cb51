"""Working off one change request: ``roadgpt edit`` does it once, the conversation as often as it is asked."""

import json
import sys
from contextlib import redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from roadgpt.cli.rows import row_of, spending
from roadgpt.cli.screen import Screen

if TYPE_CHECKING:
    from roadgpt.chat import ChatSettings
    from roadgpt.design.edit import Edited
    from roadgpt.report import Format
    from roadgpt.road import World
    from roadgpt.run.editing import Original
    from roadgpt.run.folder import Draw


@dataclass(frozen=True)
class Wish:
    """One change request and how it is to be worked off."""

    road: str
    """Path of a run's folder, or of a road file."""
    words: str
    out: Path | None
    designer: str
    world: "World"
    """Of a design that no run belongs to."""
    chat: "ChatSettings | None" = None
    driver: str | None = None
    """Of the run, where the user names it again."""
    drives: bool = True
    pictures: "tuple[Format, ...]" = ("png",)
    """Formats of the pictures; empty: none are drawn."""


def change(wish: Wish, screen: Screen) -> Path:
    """Read, change, check, drive, write and tell; gives back the folder of the new run.

    Raises:
        RoadGPTError: the words or the road cannot be used; then nothing is written.
    """
    from roadgpt.drive.permission import check_named_driver, require_permission
    from roadgpt.run import Setup, prove
    from roadgpt.run.editing import folder_for, original, reject_used, write_edit
    from roadgpt.run.sbft_json import test_name

    if wish.out is not None:
        reject_used(wish.out)
    before = _of_test(wish.road) or original(wish.road, wish.world, Setup())
    for remark in before.remarks:
        screen.say(f"{wish.road}: {remark}")
    check_named_driver(wish.driver, {before.setup.driver}, wish.road)
    if wish.drives and before.setup.drives:
        require_permission(before.setup.driver)
    made = _edited(before, wish, screen)
    drives = wish.drives and before.setup.drives
    setup = before.setup.model_copy(update={"designer": wish.designer, "chat": wish.chat, "drives": drives})
    old = prove(before.design, before.seed, before.world, setup.model_copy(update={"drives": False}))
    with redirect_stdout(sys.stderr):  # a user's driver may print
        run = prove(made.design, before.seed, before.world, setup)
    folder = folder_for(wish.words, before.seed, wish.out)
    place = write_edit(run, old, wish.words, made.changes, before.path, folder, _drawing(wish))
    row = row_of(run, str(folder / test_name(1)), test_name(1))
    if screen.as_json:
        told = {"request": wish.words, "of": before.path, "changes": made.changes, "unused": made.unused}
        print(json.dumps({**told, **json.loads(row.to_json())}, ensure_ascii=False))
        return place
    for sentence in made.changes:
        screen.say(sentence)
    if made.unused:
        screen.say("not understood: " + ", ".join(f"'{word}'" for word in made.unused))
    with screen:
        screen.row(row)
    screen.say(f"changed road: {place}")
    if wish.pictures:
        kind = wish.pictures[0]
        screen.say(f"pictures: {place}/*.{kind}, and of the road as it was: {place}/before/*.{kind}")
    return place


def _of_test(road: str) -> "Original | None":
    """The design of a campaign's test, or of a run by its number; None: something else is named."""
    from roadgpt.campaign.selection import selection_of
    from roadgpt.run.editing import original_of

    place = selection_of(road)
    return None if place is None or place.number is None else original_of(place.run(), place.said)


def _edited(before: "Original", wish: Wish, screen: Screen) -> "Edited":
    """The changed design; what a language model has cost is told, also where nothing came of it."""
    from roadgpt.chat import Meter, counting
    from roadgpt.design.edit import edit

    meter = Meter.of(wish.chat)
    try:
        with counting(meter, "edit"):
            return edit(
                before.design, wish.words, before.world, before.setup.geometry, wish.designer, wish.chat
            )
    finally:
        if meter.spent.calls:
            screen.say(f"language model: {spending(meter.spent)}")


def _drawing(wish: Wish) -> "Draw | None":
    if not wish.pictures:
        return None
    from roadgpt.report import drawing

    return drawing(formats=wish.pictures)
