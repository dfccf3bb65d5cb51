"""``roadgpt doctor beamng``: tests whether an installed BeamNG behaves as RoadGPT expects."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli.option import Option
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import folder, whole
from roadgpt.cli.options import BEAMNG_OPTIONS
from roadgpt.errors import RoadGPTError

if TYPE_CHECKING:
    from roadgpt.drive.simulators.beamng.selftest import Check


OPTIONS = (
    Option("--out", "Folder for the report and pictures.", folder, Path(), show_default="this folder"),
    Option("--repeats", "Runs of the same road, to measure how much they differ.",
           whole(2, 1000, "a number of runs"), 5),
    *BEAMNG_OPTIONS,
)  # fmt: skip


@click.command("beamng", cls=GroupedCommand, params=[*OPTIONS])
def beamng_command(out: Path, repeats: int) -> None:
    """Test RoadGPT with an installed BeamNG.tech, and write a report.

    The test covers the connection, the level, BeamNG's AI on flat, floating and steep roads, how much
    repeated runs differ, one of RoadGPT's drivers, a picture of the road, and a level folder. It takes some
    minutes. The exit status is 0 if no check finds a problem.

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
