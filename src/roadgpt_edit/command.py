"""``roadgpt edit``: changes a road, checks and drives it, and writes its run."""

import json
import sys
from contextlib import redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.brief.change import EditRequest
    from roadgpt.cli.screen import Row, Screen
    from roadgpt_edit.editing import Edited


EDIT_OPTIONS: list[click.Parameter] = [
    options.Argument("run", "RUN", "Name the folder of a run, or the file of a design."),
    options.Argument("words...", "CHANGE",
                     'Say what to change, such as "make the second turn sharper".'),
    options.out("Folder for the changed road. [default: a new one]"),
    options.Option("--plan is_plan", "CHANGE is a plan, such as 'turn 2: radius x0.75'.", bool),
    options.Option("--reader", "What reads CHANGE: model (neural networks) or chat (a language model).",
                   click.Choice(["model", "chat"]), "model"),
    *options.CHAT,
    *options.named(options.WORLD, "map_size"),
    *(options.DRIVER_AGAIN, options.NO_DRIVE, options.NO_PLOT, options.FORMAT),
    *(options.json_option("Print one JSON line.", heading=options.Heading.OUTPUT), options.QUIET),
]  # fmt: skip


@click.command(
    cls=options.GroupedCommand, params=EDIT_OPTIONS, heading="Make",
    short_help="Change a road with a request in plain words.",
)  # fmt: skip
def edit(
    run: str, words: tuple[str, ...], out: Path | None, is_plan: bool, reader: str, driver: tuple[str, ...],
    no_drive: bool, as_json: bool, quiet: bool, **rest: Any,
) -> Path:  # fmt: skip
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
    a road that cannot be valid. In these cases nothing is written."""
    from roadgpt.brief import SURE
    from roadgpt.brief.change.plan import read_change_plan
    from roadgpt.chat import Meter, counting
    from roadgpt.cli.roads import made, roads_named
    from roadgpt.cli.screen import Screen, row_of
    from roadgpt.drive.loading import check_named_drivers, require_permission
    from roadgpt.run import prove
    from roadgpt.run.execution import test_name
    from roadgpt.run.folder import new_folder, reject_used
    from roadgpt_edit import editing
    from roadgpt_edit.folder import original_of, write_edit

    screen, said = Screen(1, as_json, quiet), " ".join(words)
    chat, pictures = options.chat_of(rest, reader), options.pictures_of(rest)
    world = options.world_of(rest)
    reject_used(out)
    (named,) = roads_named([run], None)
    before, design, remarks = original_of(run, named.run() if named.run else None, world)
    for remark in remarks:
        screen.say(f"{run}: {remark}")
    setup = before.request.setup
    check_named_drivers(driver, {setup.driver}, run)
    drives = setup.drives and not no_drive
    if drives:
        require_permission(setup.driver)
    request: str | EditRequest = said
    if is_plan:
        if chat is not None:
            raise UsageError(f"--plan needs no language model; leave out --reader {reader}")
        request = read_change_plan(said)
    meter = Meter.of(chat)
    try:
        with counting(meter, "edit"):
            edited = editing.edit(design, request, before.world, setup.geometry, chat)
    finally:  # a language model costs money even if the change failed
        screen.spent(meter.spent)
    setup = setup.model_copy(update={"designer": "planner", "reader": reader, "chat": chat, "drives": drives})
    old = prove(design, before.seed, before.world, setup.model_copy(update={"drives": False}))
    if setup.scenario and edited.world.scene != before.world.scene:
        screen.say(f"the scene is no longer that of {setup.scenario}")
        setup = setup.model_copy(update={"scenario": ""})
    with redirect_stdout(sys.stderr):  # a user's driver may print
        new = prove(edited.design, before.seed, edited.world, setup)
    folder = made(out) if out is not None else new_folder(said, before.seed)
    place = write_edit(new, old, said, edited.changes, run, folder, options.drawing_of(pictures))
    row = row_of(new, str(folder / test_name(1)), name=test_name(1))
    if as_json:
        told = {"request": said, "of": run, "changes": edited.changes, "unused": edited.unused}
        sure = {"confidence": edited.confidence, "is_sure": edited.confidence >= SURE, "other": edited.other}
        print(json.dumps({**told, **sure, **json.loads(row.to_json())}, ensure_ascii=False))
    else:
        _print_edit(screen, edited, row, place, pictures)
    return place


def _print_edit(
    screen: "Screen", edited: "Edited", row: "Row", place: Path, pictures: tuple[str, ...]
) -> None:
    from roadgpt.brief import SURE
    from roadgpt.cli.commands.make import UNSURE

    for change in edited.changes:
        screen.say(change)
    if edited.confidence < SURE:
        screen.say(UNSURE.format(100 * edited.confidence, ""))
        if edited.other:
            screen.say(f'it could also mean: --plan "{edited.other}"')
    if edited.unused:
        screen.say("not understood: " + ", ".join(f"'{word}'" for word in edited.unused))
    with screen:
        screen.row(row)
    screen.say(f"changed road: {place}")
    for kind in pictures[:1]:
        screen.say(f"pictures: {place}/*.{kind}, and of the road as it was: {place}/before/*.{kind}")
