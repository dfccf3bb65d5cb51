"""``roadgpt resume``: continues a campaign or a run that was interrupted."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.commands.campaign import work_to_the_end
from roadgpt.cli.commands.faults import FAULT_OPTIONS
from roadgpt.cli.commands.run import beside
from roadgpt.cli.option import Argument, Heading, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import PATH
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.report import Scale
    from roadgpt.run import Draw

ADVICE = "Name the folder of a campaign or of runs, as 'roadgpt campaign' or 'roadgpt run' printed it."
OPTIONS = (
    *(*options.WORKERS, *named(options.CHAT, "max_tokens", "max_cost"), options.DRIVER_AGAIN),
    Option("--base-url", "Address of the server. Repeat it here if the campaign used one: for safety, your "
           "API key is not sent to an address just because a folder refers to it.", heading=Heading.MODEL),
    *(*options.BEAMNG, *FAULT_OPTIONS, *options.GATE),
    options.AGAIN,
    options.AXES,
    options.JUNIT,
    options.json_option("Print one JSON object at the end.", heading=Heading.OUTPUT),
    options.QUIET,
)  # fmt: skip


@click.command(cls=GroupedCommand, params=[Argument("folder", "DIR", ADVICE, PATH), *OPTIONS])
def command(folder: Path, driver: tuple[str, ...], base_url: str | None, axes: "Scale", **rest: Any) -> None:
    """Continue a campaign or a run that was interrupted.

    DIR is a folder that 'roadgpt campaign' or 'roadgpt run' wrote. Tests that had not finished are repeated.
    The tests and tables are the same as without the interruption, whatever the number of workers. If DIR
    was written by 'roadgpt run', the remaining roads are made one at a time, with the same kinds of pictures
    and road files as the finished ones.

    \b
    roadgpt resume roadgpt-runs/an-uphill-road-with-3-turns-7 -j 2
    """
    from roadgpt.campaign.folder_record import open_record
    from roadgpt.campaign.gate import Gate
    from roadgpt.chat.config import trust_server
    from roadgpt.drive.permission import check_named_drivers

    rest["gate"] = Gate(folder, *(rest.pop(each.field) for each in options.GATE))
    with open_record(folder) as record:
        cells = record.cells()
    chat = next((cell.request.setup.chat for cell in cells if cell.request.setup.chat), None)
    check_named_drivers(driver, {cell.request.setup.driver for cell in cells}, folder)
    if base_url is not None:
        trust_server(base_url, chat.base_url if chat else None, folder)
    limits = {name: rest[name] for name in ("max_tokens", "max_cost") if rest[name] is not None}
    if limits and chat is None:
        raise UsageError(f"--max-tokens and --max-cost limit a language model, and {folder} asks none")
    changed = chat.model_copy(update=limits) if limits and chat else None
    work_to_the_end(folder, rest, changed, _as_before(folder, axes) if cells[0].in_sequence else None)


def _as_before(folder: Path, axes: "Scale") -> "Draw | None":
    """Returns a function that gives a run the same kinds of pictures and road files as the finished runs of a
    folder have."""
    from roadgpt import plugins
    from roadgpt.report import FORMATS
    from roadgpt.run.exporting import NAME
    from roadgpt.run.folder import RUNS

    names = {path.name for path in folder.glob(f"{RUNS}/*/*")}
    if "road.json" not in names:
        return beside(("png",), axes, ())
    pictures = tuple(kind for kind in FORMATS if f"birds_eye.{kind}" in names)
    formats: tuple[str, ...] = ()
    if any(name.startswith(NAME) and name != "road.json" for name in names):
        every = plugins.names("exporters")
        formats = tuple(each for each in every if NAME + plugins.find("exporters", each).suffix in names)
    return beside(pictures, axes, formats)
