"""``roadgpt doctor``: checks this installation, or an installed BeamNG, and says how to solve problems."""

import json
import platform
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt import __version__
from roadgpt.cli import options
from roadgpt.cli.option import Option
from roadgpt.cli.option_groups import CommandGroup, GroupedCommand
from roadgpt.cli.option_types import folder, whole
from roadgpt.errors import RoadGPTError

if TYPE_CHECKING:
    from roadgpt.drive.simulators.beamng.selftest import Check

OPTIONS = (
    Option("--out", "Folder for the report and pictures.", folder, Path(), show_default="this folder"),
    Option("--repeats", "Runs of the same road, to measure how much they differ.",
           whole(2, 1000, "a number of runs"), 5),
    *options.BEAMNG,
)  # fmt: skip


@click.command("beamng", cls=GroupedCommand, params=[*OPTIONS])
def beamng_command(out: Path, repeats: int) -> None:
    """Test RoadGPT with an installed BeamNG.tech, and write a report.

    The test covers the connection, the level, BeamNG's AI on steep roads and on roads above the ground, the
    differences between repeated runs, one of RoadGPT's drivers, a camera image, and a road exported as a
    level. It takes some minutes. The exit status is 0 if no check finds a problem.

    \b
    roadgpt doctor beamng --beamng-home C:\\BeamNG.tech.v0.39 --beamng-user C:\\BeamNG.user
    """
    from roadgpt.drive.simulators.beamng import BeamngSettings
    from roadgpt.drive.simulators.beamng.selftest import REPORT, run

    out.mkdir(parents=True, exist_ok=True)
    checks = run(BeamngSettings.of(), out, repeats, _tell)
    click.echo(f"report: {out / f'{REPORT}.md'} and .json; please send it to RoadGPT's makers")
    problems = sum(not check.is_fine for check in checks)
    if problems:
        raise RoadGPTError(f"{problems} of {len(checks)} checks found a problem; see the report")


def _tell(check: "Check") -> None:
    mark = click.style("ok     ", fg="green") if check.is_fine else click.style("PROBLEM", fg="red")
    click.echo(f"{mark}  {check.about}: {check.said}")


LIBRARIES = ("numpy", "scipy", "numba", "mujoco-core", "matplotlib", "shapely", "pydantic", "click", "rich")
TEST_ROAD = [[40.0, 100.0], [60.0, 100.0], [80.0, 100.0]]  # m; a straight, driven in a few seconds


@dataclass(frozen=True)
class CheckResult:
    """The result of one check of the installation."""

    about: str
    is_fine: bool
    sentence: str


def examined() -> Iterator[CheckResult]:
    """Runs all checks and yields the result of each; a failed check is a result, not an exception."""
    yield CheckResult("roadgpt", True, f"{__version__} in {Path(__file__).resolve().parents[2]}")
    fits = sys.version_info >= (3, 11)
    yield CheckResult("Python", fits, f"{platform.python_version()} on {platform.platform()}")
    for name in LIBRARIES:
        yield _library(name)
    yield from _shelves()
    yield _tried("model", _model)
    yield _tried("numba", _numba)
    yield _tried("test drive", _drive)
    for place in (Path.cwd(), Path(tempfile.gettempdir())):
        yield _tried(f"folder {place}", partial(_writable, place))


def _library(name: str) -> CheckResult:
    try:
        return CheckResult(name, True, version(name))
    except PackageNotFoundError:
        return CheckResult(name, False, f"is missing: python -m pip install {name}")


def _shelves() -> Iterator[CheckResult]:
    from roadgpt.cli.commands.config import installed

    try:
        parts = installed()
    except RoadGPTError as error:
        yield CheckResult("plug-ins", False, str(error))
        return
    for part in parts:
        if not part.works:
            yield CheckResult(f"{part.shelf}: {part.name}", False, part.about)
    working = sum(part.works for part in parts)
    yield CheckResult(
        "parts", working == len(parts), f"{working} of {len(parts)} can be used (roadgpt config plugins)"
    )


def _model() -> str:
    """Checks that the configured language model can be used; the check also passes if none is configured."""
    from roadgpt.chat.client import diagnose

    return diagnose()


def _tried(about: str, look: Callable[[], str]) -> CheckResult:
    """Returns the result of a check; whatever the check raises becomes its result."""
    try:
        return CheckResult(about, True, look())
    except RoadGPTError as error:
        return CheckResult(about, False, str(error))
    except Exception as error:
        return CheckResult(about, False, f"{type(error).__name__}: {error}")


def _numba() -> str:
    from roadgpt.drive.compiled import COMPILES, WHY_NOT

    return "compiles the inner loop" if COMPILES else f"is not used ({WHY_NOT}): drives work, but far slower"


def _drive() -> str:
    from roadgpt.drive import simulate
    from roadgpt.road import Road, World
    from roadgpt.verdict import judge

    road, world = Road.through(TEST_ROAD), World()
    simulate(road, world, "reference")  # compiles
    begun = time.perf_counter()
    drive = simulate(road, world, "reference")
    took = time.perf_counter() - begun
    verdict = judge(road, drive, world)
    if not verdict.kept:
        raise RoadGPTError(f"the car left a straight road ({verdict.description}); please report this")
    return f"{drive.duration:.1f} s simulated in {took:.2f} s, {drive.duration / took:.0f} times real time"


def _writable(folder: Path) -> str:
    with tempfile.TemporaryFile(dir=folder):
        return "can be written to"


@click.group(
    cls=CommandGroup, invoke_without_command=True, params=[options.json_option("Print one JSON list.")]
)
@click.pass_context
def command(ctx: click.Context, /, as_json: bool) -> None:
    """Check this installation: versions, plug-ins, compiler, a test drive, folders.

    The exit status is 0 if no check finds a problem.
    """
    if ctx.invoked_subcommand is not None:
        return
    answers = []
    for answer in examined():
        answers.append(answer)
        if not as_json:
            mark = click.style("ok     ", fg="green") if answer.is_fine else click.style("PROBLEM", fg="red")
            click.echo(f"{mark}  {answer.about:<14} {answer.sentence}")
    if as_json:
        click.echo(json.dumps([asdict(answer) for answer in answers], indent=2))
    problems = sum(not answer.is_fine for answer in answers)
    if problems:
        raise RoadGPTError(f"{problems} of {len(answers)} checks found a problem; see those marked above")
    if not as_json:
        click.echo("all is well")


command.add_command(beamng_command)
