"""``roadgpt compete``: runs a test generator of the SBFT competition, or the server of the SDC
competition.
"""

import logging
import sys
from pathlib import Path
from typing import Any

import click

from roadgpt.cli import options
from roadgpt.cli.screen import Screen
from roadgpt.cli.streams import crashes_go_to
from roadgpt.errors import UsageError, explained, to_install

FAILED = 1  # exit status: the generator crashed, hung or left; its results are complete
KMH = 3.6
CLIENT = "roadgpt_client.py"
option, measure, whole, DRIVE = options.Option, options.measure, options.whole, options.Heading.DRIVE


def _write_client(ctx: click.Context, param: click.Parameter, path: Path | None) -> None:
    del param
    if path is None:
        return
    from roadgpt.run import atomic
    from roadgpt_sbft.generator_process import NAMES

    if path.exists():
        raise UsageError(f"{path} is there already; give another name")
    with explained(UsageError, f"cannot write {path}", "give another name"):
        atomic.write_whole(path, (NAMES / CLIENT).read_text(encoding="utf-8"))
    click.echo(f"{path}; before it is used, set ROADGPT_PYTHON to {sys.executable}")
    ctx.exit()


SBFT_OPTIONS: list[options.Option] = [
    option("--module-name", "Python module of the generator.", required=True),
    option("--class-name", "Class of the generator.", required=True),
    option("--module-path", "Additional folder in which Python looks for the module.",
           click.Path(exists=True, file_okay=False)),
    option("--python", "Interpreter for the generator, with its own libraries; Python 3.8 or later. "
           "[default: RoadGPT's]"),
    option("--time-budget", "Budget in seconds, for generating and driving.",
           measure(0, 10_000_000, "s", above=True)),
    option("--test-budget", "Budget in tests, including invalid ones.", whole(1, 10**7, "tests")),
    option("--map-size", "Side of the square map, m.", whole(100, 1000, "metres"), 200),
    # the competition's own defaults and bounds, which no configuration file changes
    option("--oob-tolerance", "Share of the car that may be outside its lane.", measure(0, 1, above=True),
           0.95, heading=DRIVE),
    option("--speed-limit", "Speed limit, km/h.", measure(10, 300, "km/h"), 70, heading=DRIVE),
    options.named(options.SETUP, "driver")[0].but(default="beamng_like"),
    *options.named(options.SETUP, "simulator"),
    options.seed("Seed for the driver.", 0),
    option("--patience", "Seconds that the generator may take for one test.",
           measure(0, 86_400, "s", above=True), 600),
    options.out("An empty folder, or a new one. [default: results/MODULE_CLASS_STAMP]"),
    option("--plot has_pictures", "Draw every test, and not only the overview.", bool),
    option("--no-plot", "Draw nothing.", bool),
    *(options.AXES, options.FORMAT),
    option("--debug", "Log more details of what the generator does.", bool),
    option("--client", "Write the Python module that lets the competition run RoadGPT, and exit.",
           click.Path(dir_okay=False, path_type=Path), is_eager=True, expose_value=False,
           callback=_write_client),
    *options.SCREEN,
]  # fmt: skip


@click.command("sbft", cls=options.GroupedCommand, has_simulators=True, params=SBFT_OPTIONS)
def sbft_command(
    map_size: int, oob_tolerance: float, speed_limit: float, driver: str, simulator: str, seed: int,
    out: Path | None, has_pictures: bool, no_plot: bool, axes: Any, picture_formats: Any,
    as_json: bool, quiet: bool, verbose: bool, **experiment: Any,
) -> int:  # fmt: skip
    """Run a test generator of the SBFT tool competition.

    The generator runs unchanged, in a process of its own, until the budget is used up: seconds, tests, or
    both. Files and tables are in the competition's format. The exit status is 1 if the generator crashed,
    hung or called sys.exit; all tests before that are saved.

    \b
    roadgpt compete sbft --module-name my_generator --class-name MyGenerator --test-budget 100
    roadgpt compete sbft --module-name src.gen --class-name Gen --module-path ~/gen --time-budget 3600
    roadgpt compete sbft --module-name old --class-name Old --python ~/old/venv/bin/python --test-budget 100
    """
    from roadgpt.road import World
    from roadgpt.run import Setup
    from roadgpt_sbft import Experiment, compete

    world = World().changed(map_size=map_size, oob_tolerance=oob_tolerance, speed_limit=speed_limit / KMH)
    setup = Setup(driver=driver, simulator=simulator, rules="sbft")
    draw = options.drawing_of(picture_formats if has_pictures and not no_plot else (), axes)
    work = compete(Experiment(**experiment), world, setup, seed, out, draw)
    crashes_go_to(work.folder)
    screen = Screen(work.experiment.test_budget or 0, as_json, quiet, verbose)
    screen.request = work.request
    screen.say(f"{work.experiment.class_name} of {work.experiment.module_name}, into {work.folder}")
    try:
        screen.runs(work, work.folder)
    finally:
        screen.close()
        if work.ending is None or work.ending.is_of_a_generator:  # else the error message tells all
            if work.ending is not None:
                screen.say(f"the generator: {work.ending.sentence}")
            if screen.rows and picture_formats and not no_plot:
                from roadgpt.report import overview

                overview(work.folder, picture_formats)
            if work.folder.is_dir():
                screen.say(f"tests and tables: {work.folder}")
    return 0 if work.ending is None or work.ending.is_fine else FAILED


OPTIONS = (
    option("--port", "Port of the service; 0: a free one.", whole(0, 65_535, "a port"), 4545),
    option(
        "--host",
        "Who can connect: 127.0.0.1 (this machine only) or 0.0.0.0 (any machine, needed in a container).",
        str,
        "127.0.0.1",
    ),
    options.QUIET,
)


@click.command("sdc", cls=options.GroupedCommand, params=[*OPTIONS])
def sdc_command(port: int, host: str, quiet: bool) -> None:
    """Start a gRPC server that selects and ranks tests by how likely the car is to leave its lane.

    The likelihood is estimated from the distance between the middle of the lane and the line that RoadGPT's
    driver beamng_like plans to drive. Nothing is driven. Once the client has sent enough outcomes, the
    estimate is fitted to them and also uses the curvature of the roads. Ctrl-C ends the service.

    \b
    roadgpt compete sdc --port 4545
    roadgpt compete sdc --host 0.0.0.0
    """
    try:
        from roadgpt_sbft.sdc.service import serve as serve_on
    except ImportError as error:
        raise UsageError(f"this needs more libraries: {to_install('sdc')} ({error})") from error
    logging.basicConfig(level=logging.WARNING if quiet else logging.INFO, format="%(asctime)s %(message)s")
    server, got = serve_on(host, port)
    if not quiet:
        click.echo(f"listening on {host}:{got}")
    try:
        server.wait_for_termination()
    finally:
        server.stop(grace=0)


@click.group(
    cls=options.CommandGroup, heading="Exchange",
    short_help="Run SBFT test generators, or the server of the SDC competition.",
)  # fmt: skip
def command() -> None:
    """Run a test generator of the SBFT competition, or the server of the SDC competition."""


command.add_command(sbft_command)
command.add_command(sdc_command)
