"""``roadgpt show``: what is in a run, a folder of runs or a campaign."""

from typing import Any

import click

from roadgpt.cli.named import choice_of, choice_options


@click.command()
@click.argument("folders", nargs=-1, required=True, metavar="RUN...")
@choice_options
def command(folders: tuple[str, ...], **rest: Any) -> None:
    """Tell what is in a run, a folder of runs or a campaign, and how to make it again.

    RUN is a folder like DIR/runs/0001, the file DIR/test.0001.json, or the folder DIR that holds them; the
    folder of a campaign, one of its cells, as CAMPAIGN/c01, or one of its tests, as CAMPAIGN/c01/17.

    \b
    roadgpt show CAMPAIGN --failures
    """
    from roadgpt.cli.summary import show

    choice = choice_of(rest)
    for folder in folders:
        click.echo(show(folder, choice))
