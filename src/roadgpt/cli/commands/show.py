"""``roadgpt show``: what is in a run, a folder of runs or a campaign."""

import click


@click.command()
@click.argument("folders", nargs=-1, required=True, metavar="RUN...")
def command(folders: tuple[str, ...]) -> None:
    """Tell what is in a run, a folder of runs or a campaign, and how to make it again.

    RUN is a folder like DIR/runs/0001, the file DIR/test.0001.json, or the folder DIR that holds them.
    """
    from roadgpt.cli.summary import show

    for folder in folders:
        click.echo(show(folder))
