"""``roadgpt resume``: continues a campaign that was interrupted."""

from pathlib import Path
from typing import Any

import click

from roadgpt.cli import options
from roadgpt.cli.commands.campaign import work_to_the_end
from roadgpt.cli.commands.faults import FAULT_OPTIONS
from roadgpt.cli.option import Argument, Heading, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import PATH
from roadgpt.errors import UsageError

ADVICE = "Name the folder of a campaign, as 'roadgpt campaign' printed it."
OPTIONS = (
    *(*options.WORKERS, *named(options.CHAT, "max_tokens", "max_cost"), options.DRIVER_AGAIN),
    Option("--base-url", "Address of the server. Repeat it here if the campaign used one: for safety, your "
           "API key is not sent to an address just because a folder refers to it.", heading=Heading.MODEL),
    *FAULT_OPTIONS,
    options.JUNIT,
    options.json_option("Print one JSON object at the end.", heading=Heading.OUTPUT),
    options.QUIET,
)  # fmt: skip


@click.command(cls=GroupedCommand, params=[Argument("campaign", "CAMPAIGN", ADVICE, PATH), *OPTIONS])
def command(campaign: Path, driver: str | None, base_url: str | None, **rest: Any) -> None:
    """Continue a campaign that was interrupted, with any number of workers.

    Tests that had not finished are repeated. The table of results is the same as without the interruption.

    \b
    roadgpt resume roadgpt-runs/an-uphill-road-with-3-turns-7 -j 2
    """
    from roadgpt.campaign.lifecycle import plan_of
    from roadgpt.campaign.record import Record
    from roadgpt.chat.config import trust_server
    from roadgpt.drive.permission import check_named_driver

    with Record.opened(campaign) as record:
        plan = plan_of(record)
    check_named_driver(driver, {*plan.drivers}, campaign)
    if base_url is not None:
        trust_server(base_url, plan.chat.base_url if plan.chat else None, campaign)
    limits = {name: rest[name] for name in ("max_tokens", "max_cost") if rest[name] is not None}
    if limits and plan.chat is None:
        raise UsageError(f"--max-tokens and --max-cost limit a language model, and {campaign} asks none")
    if limits and plan.chat is not None:
        plan = plan.model_copy(update={"chat": plan.chat.model_copy(update=limits)})
    work_to_the_end(campaign, plan, rest)
