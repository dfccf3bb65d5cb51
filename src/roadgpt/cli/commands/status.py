"""``roadgpt status``: how far a campaign is."""

from pathlib import Path

import click

from roadgpt.cli.campaigns import as_line, faults_of, told


@click.command()
@click.argument("campaign", metavar="CAMPAIGN", type=click.Path(path_type=Path))
@click.option("--json", "as_json", is_flag=True, help="One JSON object on standard output.")
def command(campaign: Path, as_json: bool) -> None:
    """Say how far a campaign is, while it works or afterwards."""
    from roadgpt.campaign.status import status_of

    status = status_of(campaign)
    found = faults_of(status)
    for line in [as_line(status, found)] if as_json else told(status, found):
        click.echo(line)
