"""``roadgpt compete sdc``: serves the SDC testing competition."""

import logging

import click

from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.options import quiet_option, whole
from roadgpt.errors import UsageError

EXTRA = "this needs more libraries: python -m pip install 'roadgpt[sdc]'"


@click.command("sdc", cls=GroupedCommand)
@click.option(
    "--port",
    type=whole(0, 65_535, "a port"),
    default=4545,
    show_default=True,
    help="Port of the service; 0: a free one.",
)
@click.option(
    "--host",
    default="127.0.0.1",
    show_default=True,
    help="Who can connect: 127.0.0.1, this machine; 0.0.0.0, all (in a container).",
)
@quiet_option
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
