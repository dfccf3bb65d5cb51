"""``roadgpt doctor beamng``: tests RoadGPT with an installed BeamNG.tech."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from roadgpt.cli.options import GroupedCommand, Option, folder, whole
from roadgpt.errors import RoadGPTError

if TYPE_CHECKING:
    from roadgpt_beamng.selftest import Check

OPTIONS = (
    Option("--out", "Folder for the report and pictures.", folder, Path(), show_default="this folder"),
    Option("--repeats", "Runs of the same road, to measure how much they differ.",
           whole(2, 1000, "a number of runs"), 5),
)  # fmt: skip


@click.command("beamng", cls=GroupedCommand, has_simulators=True, params=[*OPTIONS])
def command(out: Path, repeats: int) -> None:
    """Test RoadGPT with an installed BeamNG.tech, and write a report.

    The test covers the connection, the level, BeamNG's AI on steep roads and on roads above the ground, the
    differences between repeated runs, one of RoadGPT's drivers, a camera image, and a road exported as a
    level. It takes some minutes. The exit status is 0 if no check finds a problem.

    \b
    roadgpt doctor beamng --beamng-home C:\\BeamNG.tech.v0.39 --beamng-user C:\\BeamNG.user
    """
    from roadgpt_beamng.selftest import REPORT, run
    from roadgpt_beamng.settings import BeamngSettings

    out.mkdir(parents=True, exist_ok=True)
    checks = run(BeamngSettings.of(), out, repeats, _tell)
    click.echo(f"report: {out / f'{REPORT}.md'} and .json; please send it to RoadGPT's makers")
    problems = sum(not check.is_fine for check in checks)
    if problems:
        raise RoadGPTError(f"{problems} of {len(checks)} checks found a problem; see the report")


def _tell(check: "Check") -> None:
    mark = click.style("ok     ", fg="green") if check.is_fine else click.style("PROBLEM", fg="red")
    click.echo(f"{mark}  {check.about}: {check.said}")
