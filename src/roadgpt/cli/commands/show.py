"""``roadgpt show``: summarises a run, a folder of runs or a campaign, or shows a campaign's progress."""

from pathlib import Path
from typing import Any

import click

from roadgpt.cli import options
from roadgpt.cli.option import Argument, Heading, Option
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.errors import UsageError

ADVICE = "Name the folder of a run, a folder of runs, or a campaign."
OPTIONS = (
    *options.CHOICES,
    Option("--watch", "Show the progress of a campaign until it ends.", bool),
    options.json_option("Print one JSON object for each campaign or road.", heading=Heading.OUTPUT),
    Option("--progress", "As the earlier command 'status'.", bool, hidden=True),
    Option("--once", "Show the progress once.", bool, hidden=True),
)


@click.command(cls=GroupedCommand, params=[Argument("folders...", "RUN...", ADVICE), *OPTIONS])
def command(
    folders: tuple[str, ...], watch: bool, as_json: bool, progress: bool, once: bool, **rest: Any
) -> None:
    """Summarise a run, a folder of runs or a campaign, and print the command that repeats it.

    RUN is a run, such as DIR/runs/0001 or DIR/test.0001.json; the folder DIR that holds the runs; a campaign;
    a cell of a campaign, such as CAMPAIGN/c01; or a test of a campaign, such as CAMPAIGN/c01/17.

    \b
    roadgpt show roadgpt-runs/hairpins-7
    roadgpt show CAMPAIGN --failures
    roadgpt show CAMPAIGN --watch
    """
    from roadgpt.cli.campaigns import watch_campaign
    from roadgpt.cli.summary import json_lines, progress_lines, show

    choice = options.choice_of(rest)
    if (watch or progress) and choice is not None:
        raise UsageError(
            f"--{choice} selects roads, but --watch shows a whole campaign; leave one of them out"
        )
    if watch and (as_json or len(folders) > 1):
        raise UsageError("--watch shows one campaign on the screen; leave out --json and other folders")
    if watch:
        watch_campaign(Path(folders[0]), once)
        return
    for folder in folders:
        if progress:
            lines = progress_lines(Path(folder), as_json)
        else:
            lines = json_lines(folder, choice) if as_json else iter([show(folder, choice)])
        for line in lines:
            click.echo(line)
