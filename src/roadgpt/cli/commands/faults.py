"""``roadgpt faults``: groups failures into distinct faults, and finds why each occurs."""

from pathlib import Path
from typing import Any

import click

from roadgpt.cli.fault_analysis import DRIVES, REPEAT, AnalysisOptions, analyse_failures
from roadgpt.cli.option import Option
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import folder, whole
from roadgpt.cli.options import DRIVER_AGAIN, FORMAT, NO_PLOT, QUIET, pictures_of

# fmt: off
OPTIONS = (
    Option("--repeat", "Number of slightly disturbed drives for each fault.", DRIVES, REPEAT),
    Option("--minimise", "For each fault, also find the simplest road on which it still occurs.", bool),
    Option("-j workers", "Number of faults analysed in parallel.", whole(1, 256, "processes"), 1),
    *(DRIVER_AGAIN, FORMAT, NO_PLOT, QUIET),
)
# fmt: on


@click.command(cls=GroupedCommand, params=[click.Argument(["place"], type=folder, metavar="DIR"), *OPTIONS])
def command(
    place: Path, repeat: int, minimise: bool, workers: int, driver: str | None, quiet: bool, **rest: Any
) -> None:
    """Group the failures of a folder of runs or a campaign into distinct faults, and find why each occurs.

    Two failures belong to the same fault if the 60 m of road around the lane departure are alike. The most
    typical failure of each fault is driven again several times with slightly varied friction, start position
    and perception delay; the share of drives that fail again is reported. DIR/faults gets a picture and a
    sentence for each fault, faults.csv with a line per fault, and failures.csv with a line per failure.
    Finished work is not repeated, so Ctrl-C loses nothing.

    \b
    roadgpt faults roadgpt-runs/hairpins-7
    roadgpt faults roadgpt-runs/hairpins-7 --repeat 30 --minimise -j 2
    """
    from roadgpt.campaign.faults.failures import drivers_of
    from roadgpt.drive.permission import check_named_driver

    if driver is not None:
        check_named_driver(driver, drivers_of(place), place)
    analyse_failures(place, AnalysisOptions(repeat, minimise, workers, pictures_of(rest), quiet))
