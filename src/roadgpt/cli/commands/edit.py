"""``roadgpt edit``: changes a road according to a request in plain words."""

import json
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.option import Argument, Heading, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.result_row import Row, row_of, spending
from roadgpt.cli.roads import roads_named
from roadgpt.cli.screen import Screen
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.chat import ChatSettings
    from roadgpt.design.edit import Edited, EditRequest
    from roadgpt.report import Format
    from roadgpt.road import World

PARAMETERS = (
    Argument("run", "RUN", "Name the folder of a run, or the file of a design."),
    Argument("words...", "CHANGE", 'Say what to change, such as "make the second turn sharper".'),
    options.out("Folder for the changed road. [default: a new one]"),
    Option("--plan is_plan", "CHANGE is a plan, such as 'turn 2: radius x0.75'.", bool),
    Option(
        "--reader",
        "What reads CHANGE: model (neural networks) or chat (a language model).",
        click.Choice(["model", "chat"]),
        "model",
    ),
    *options.CHAT,
    *named(options.WORLD, "map_size"),
    *(options.DRIVER_AGAIN, options.NO_DRIVE, options.NO_PLOT, options.FORMAT),
    *(options.json_option("Print one JSON line.", heading=Heading.OUTPUT), options.QUIET),
)


@click.command(cls=GroupedCommand, params=[*PARAMETERS])
def command(run: str, words: tuple[str, ...], as_json: bool, quiet: bool, **rest: Any) -> None:
    """Change a road with a request in plain words.

    RUN is a run, a folder that holds one run, or a file with a RoadGPT design. The changed road is written
    into a new folder. Everything that the request does not refer to stays the same. World, driver and rules
    are those of the run, but a map of the usual 250 m grows if the changed road needs it; --map-size applies
    only to a design from a file.

    \b
    roadgpt edit my-roads/runs/0001 "make the second turn sharper and the end downhill"
    roadgpt edit design.json "add a hairpin after the first turn, then remove the last straight"
    roadgpt edit design.json --plan "turn 2: radius x0.75; end: slope down"

    The exit status is 2 if the words cannot be read, refer to something that is not on the road, or ask for
    a road that cannot be valid. In these cases nothing is written.
    """
    edit_road(
        Screen(1, as_json, quiet),
        run,
        " ".join(words),
        options.world_of(rest),
        chat=options.chat_of(rest, rest["reader"]),
        pictures=options.pictures_of(rest),
        drives=not rest.pop("no_drive"),
        **rest,
    )


def edit_road(
    screen: Screen, road: str, words: str, world: "World", out: Path | None = None, reader: str = "model",
    chat: "ChatSettings | None" = None, driver: tuple[str, ...] = (), drives: bool = True,
    pictures: "tuple[Format, ...]" = ("png",), is_plan: bool = False,
) -> Path:  # fmt: skip
    """Changes a road as requested, checks and drives it, writes and prints its run, and returns its folder.

    ``road`` is a run, a test of a campaign, or a file with a design; ``world`` is used only for a file.
    ``driver`` comes from ``--driver``. Nothing is driven if ``drives`` is False or the run was not driven.

    Raises:
        RoadGPTError: The request or the road cannot be used; nothing is written.
    """
    from roadgpt.brief import SURE
    from roadgpt.brief.change.plan import read_change_plan
    from roadgpt.chat import Meter, counting
    from roadgpt.design.edit import edit
    from roadgpt.drive.permission import check_named_drivers, require_permission
    from roadgpt.run import prove
    from roadgpt.run.editing import folder_for, original_of, reject_used, write_edit
    from roadgpt.run.sbft_json import test_name

    if out is not None:
        reject_used(out)
    (named,) = roads_named([road], None)
    before, design, remarks = original_of(road, named.run() if named.run else None, world)
    for remark in remarks:
        screen.say(f"{road}: {remark}")
    setup = before.request.setup
    check_named_drivers(driver, {setup.driver}, road)
    drives = drives and setup.drives
    if drives:
        require_permission(setup.driver)
    request: str | EditRequest = words
    if is_plan:
        if chat is not None:
            raise UsageError(f"--plan needs no language model; leave out --reader {reader}")
        request = read_change_plan(words)
    meter = Meter.of(chat)
    try:
        with counting(meter, "edit"):
            made = edit(design, request, before.world, setup.geometry, chat)
    finally:  # a language model costs money even if the change failed
        if meter.spent.calls:
            screen.say(f"language model: {spending(meter.spent)}")
    setup = setup.model_copy(update={"designer": "planner", "reader": reader, "chat": chat, "drives": drives})
    old = prove(design, before.seed, before.world, setup.model_copy(update={"drives": False}))
    with redirect_stdout(sys.stderr):  # a user's driver may print
        run = prove(made.design, before.seed, made.world, setup)
    folder = folder_for(words, before.seed, out)
    place = write_edit(run, old, words, made.changes, road, folder, options.drawing_of(pictures))
    row = row_of(run, str(folder / test_name(1)), test_name(1))
    if screen.as_json:
        told = {"request": words, "of": road, "changes": made.changes, "unused": made.unused}
        sure = {"confidence": made.confidence, "is_sure": made.confidence >= SURE, "other": made.other}
        print(json.dumps({**told, **sure, **json.loads(row.to_json())}, ensure_ascii=False))
    else:
        _print_edit(screen, made, row, place, pictures)
    return place


def _print_edit(
    screen: Screen, made: "Edited", row: Row, place: Path, pictures: "tuple[Format, ...]"
) -> None:
    """Prints what was changed, the row of the run, and where the run and its pictures are."""
    from roadgpt.brief import SURE

    for sentence in made.changes:
        screen.say(sentence)
    if made.confidence < SURE:
        sure = f"{100 * made.confidence:.0f} % sure"
        screen.say(f"perhaps not understood as meant ({sure}), so check it or say it in other words")
        if made.other:
            screen.say(f'it could also mean: --plan "{made.other}"')
    if made.unused:
        screen.say("not understood: " + ", ".join(f"'{word}'" for word in made.unused))
    with screen:
        screen.row(row)
    screen.say(f"changed road: {place}")
    if pictures:
        kind = pictures[0]
        screen.say(f"pictures: {place}/*.{kind}, and of the road as it was: {place}/before/*.{kind}")
