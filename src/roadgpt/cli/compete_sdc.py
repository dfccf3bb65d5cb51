"""``roadgpt compete sdc``: serves the SDC testing competition."""

import logging

import click

from roadgpt.cli.option import Option
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import whole
from roadgpt.cli.options import QUIET
from roadgpt.errors import UsageError

EXTRA = "this needs more libraries: python -m pip install 'roadgpt[sdc]'"


OPTIONS = (
    Option("--port", "Port of the service; 0: a free one.", whole(0, 65_535, "a port"), 4545),
    Option(
        "--host", "Who can connect: 127.0.0.1, this machine; 0.0.0.0, all (in a container).", str, "127.0.0.1"
    ),
    QUIET,
)


@click.command("sdc", cls=GroupedCommand, params=[*OPTIONS])
def sdc_command(port: int, host: str, quiet: bool) -> None:
    """Serve test selection and prioritisation over gRPC, ranked by how likely the car is to leave its lane.

    The likelihood is estimated from how far the driver's planned line leaves the lane, and from how the road
    bends; nothing is driven. The estimate learns from outcomes that the evaluator sends. Ctrl-C ends the
    service.

    \b
    roadgpt compete sdc --port 4545
    roadgpt compete sdc --host 0.0.0.0
    """
    try:
        from roadgpt.sbft.sdc.service import serve as serve_on
    except ImportError as error:
        raise UsageError(f"{EXTRA} ({error})") from error
    logging.basicConfig(level=logging.WARNING if quiet else logging.INFO, format="%(asctime)s %(message)s")
    server, got = serve_on(host, port)
    if not quiet:
        click.echo(f"listening on {host}:{got}")
    try:
        server.wait_for_termination()
    finally:
        server.stop(grace=0)
