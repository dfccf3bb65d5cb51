"""``roadgpt study``: evaluates roads as the thesis did, by measurements and by a survey of people."""

import click

from roadgpt.cli import study_commands
from roadgpt.cli.commands import survey_
from roadgpt.cli.option_groups import CommandGroup


@click.group(cls=CommandGroup)
def command() -> None:
    """Evaluate many roads, by measurements or by people who rate them."""


command.add_command(study_commands.thesis)
command.add_command(study_commands.alignment)
command.add_command(survey_.command)
