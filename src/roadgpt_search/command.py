"""``roadgpt faults``, and the options of other commands for its analysis."""

from functools import partial
from pathlib import Path
from typing import Any

import click

from roadgpt.cli import options
from roadgpt.cli.options import Argument, GroupedCommand, Heading, Option, folder, whole

REPEAT = 10  # disturbed drives of each fault, unless the user gives another number
DRIVES = whole(1, 1000, "drives")

MINIMISE = "For each fault, also find the simplest road on which it still occurs"
DISTURB = "Number of further drives for each fault, with small disturbances"
GROUPS = (
    "Analyse each group of similar failures on its own, without finding out which groups are one fault. This "
    "saves up to 16 drives for each failure that is tried."
)
_failures = partial(Option, heading=Heading.FAILURES)
AT_END = (
    _failures("--faults", "At the end, analyse the failures as 'roadgpt faults' does.", bool),
    _failures("--minimise", f"{MINIMISE}; implies --faults.", bool),
    _failures("--repeat", f"{DISTURB}; implies --faults. [default: {REPEAT}]", DRIVES),
    _failures("--groups", f"{GROUPS} Implies --faults.", bool),
)

# fmt: off
FAULTS_OPTIONS = (
    Option("--repeat", f"{DISTURB}.", DRIVES, REPEAT),
    Option("--minimise", f"{MINIMISE}.", bool),
    Option("--groups", GROUPS, bool),
    Option("-j workers", "Number of failures analysed in parallel.", whole(1, 256, "processes"), 1),
    *(options.DRIVER_AGAIN, options.FORMAT, options.NO_PLOT, options.QUIET),
)
# fmt: on


@click.command(
    cls=GroupedCommand, has_simulators=True, params=[Argument("place", "DIR", kind=folder), *FAULTS_OPTIONS],
    heading="Search", short_help="Group failures into distinct faults, and find why each occurs.",
    choice="Use only one typical failure of each distinct fault in a folder.", at_end=AT_END,
)  # fmt: skip
def faults(place: Path, driver: tuple[str, ...], **rest: Any) -> None:
    """Group the failures of a folder of runs or a campaign into distinct faults, and find why each occurs.

    Failures form a group if the 60 m of road around the lane departures are alike. Some failures of each
    group are driven with small changes, such as a 15 % larger radius of the bend. If the failures of several
    groups disappear with the same change, these groups are one fault. Further failures of the fault are then
    driven with this change; a failure that still occurs with it no longer counts as part of the fault. The
    most typical failure of each fault is driven again several times with slightly varied friction, start
    position and perception delay; the share of drives that fail again is reported. DIR/faults gets a
    picture and a sentence for each fault, faults.csv with a line per fault, and failures.csv with a line per
    failure.
    Finished work is not repeated, so Ctrl-C loses nothing.

    \b
    roadgpt faults roadgpt-runs/hairpins-7
    roadgpt faults roadgpt-runs/hairpins-7 --repeat 30 --minimise -j 2"""
    from roadgpt.campaign.folder_record import setups_of
    from roadgpt.drive.loading import check_named_drivers
    from roadgpt_search.faults.analysing import analyse_failures

    check_named_drivers(driver, {setup.driver for setup in setups_of(place)}, place)
    analyse_failures(place, formats=options.pictures_of(rest), **rest)
