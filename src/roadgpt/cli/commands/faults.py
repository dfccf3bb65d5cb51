"""``roadgpt faults``: which failures are one fault, why each fails, and how often it fails again."""

from pathlib import Path

import click

from roadgpt.cli.failing import DRIVES, REPEAT, Look, analyse_failures
from roadgpt.cli.options import driver_again_option, folder, format_option, whole


@click.command()
@click.argument("place", type=folder, metavar="DIR")
@click.option(
    "--repeat", type=DRIVES, default=REPEAT, show_default=True, help="Disturbed drives of each fault."
)
@click.option("--minimise", is_flag=True, help="Also look for the simplest road that fails alike, per fault.")
@click.option(
    "-j", "workers", type=whole(1, 256, "processes"), default=1, show_default=True, help="Faults at a time."
)
@driver_again_option
@format_option
@click.option("--no-plot", is_flag=True, help="Draw no pictures.")
@click.option("--quiet", "-q", is_flag=True, help="Say nothing but errors.")
def command(
    place: Path,
    repeat: int,
    minimise: bool,
    workers: int,
    driver: str | None,
    picture_formats: tuple[str, ...],
    no_plot: bool,
    quiet: bool,
) -> None:
    """Tell the distinct faults in a folder of runs or a campaign: why, how often again, and how many tests.

    Failures whose 60 m of road around the departure are alike are one fault. The most typical failure of each
    fault is driven again and again with friction, start and the age of what the driver sees off a little.
    DIR/faults gets a picture and a sentence of each, faults.csv with one line per fault, and failures.csv
    with one per failure. What was done before is not done again, so Ctrl-C loses nothing.

    \b
    roadgpt faults roadgpt-runs/hairpins-7
    roadgpt faults roadgpt-runs/hairpins-7 --repeat 30 --minimise -j 2
    """
    from roadgpt.campaign.faults.failures import drivers_of
    from roadgpt.drive.trust import expect

    if driver is not None:
        expect(driver, drivers_of(place), place)
    analyse_failures(place, Look(repeat, minimise, workers, () if no_plot else picture_formats, quiet))
