"""``roadgpt compete``: the tool competitions, SBFT for test generators and SDC for choosing tests."""

import click

from roadgpt.cli.compete_sbft import sbft_command
from roadgpt.cli.compete_sdc import sdc_command
from roadgpt.cli.option_groups import CommandGroup


@click.group(cls=CommandGroup)
def command() -> None:
    """Run a test generator of the SBFT competition, or serve the SDC testing competition."""


command.add_command(sbft_command)
command.add_command(sdc_command)
