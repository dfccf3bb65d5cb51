"""``roadgpt film``: films a drive from behind the car or from its hood, or two drives side by side."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options
from roadgpt.cli.option import Argument, Option, named
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.cli.option_types import PATH
from roadgpt.cli.progress import watched
from roadgpt.cli.roads import NamedRoad, check_file, made, named_in_errors, roads_named, run_of, shown_roads
from roadgpt.cli.streams import warn
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.campaign.selection import Choice
    from roadgpt.report.film import Settings

MOST = 2  # roads in one picture
LONGEST = 1_000_000  # s, largest time that --seconds accepts
FILM, FILMS = Path("roadgpt-film.mp4"), Path("films")
ENDINGS = (".mp4", ".m4v")
VIEWS = ("chase", "hood", "both")
MOUNTS = {"hood": "bonnet"}  # as roadgpt.report.film calls them


def _view(value: str) -> str:
    """Checks the value of --view. The earlier value ``bonnet`` is accepted and kept, because names of films
    contain it."""
    if value == "bonnet":
        warn("'--view bonnet' is now '--view hood'")
    elif value not in VIEWS:
        raise click.BadParameter(f"'{value}' is not a view; give {', '.join(VIEWS[:-1])} or {VIEWS[-1]}")
    return value


def _size(value: str) -> tuple[int, int]:
    """Converts a size such as 640x360 to width and height in pixels."""
    wide, cross, high = value.lower().partition("x")
    if not (cross and wide.isdecimal() and high.isdecimal()):
        raise click.BadParameter(f"'{value}' is no size; give width and height in pixels, such as 640x360")
    return int(wide), int(high)


def _seconds(value: str) -> tuple[float, float | None]:
    """Converts a text such as 9 or 4:13 to the start and the length in seconds of a part of a drive. The
    length is None if the part reaches to the end of the drive."""
    first, colon, last = value.partition(":")
    try:
        begin = float(first or 0) if colon else 0.0
        end = float(last) if colon and last else None if colon else float(first)
    except ValueError:
        raise click.BadParameter(
            f"'{value}' are no seconds; give 9, or 4:13 for the 4th to the 13th"
        ) from None
    if not 0 <= begin <= LONGEST or (end is not None and not 0 <= end <= LONGEST):
        raise click.BadParameter(f"'{value}' is no part of a drive; give seconds from 0 to {LONGEST:,}")
    if end is not None and end <= begin:
        raise click.BadParameter(f"'{value}' ends before it begins; give 9, or 4:13 for the 4th to the 13th")
    return begin, None if end is None else end - begin


# fmt: off
PARAMETERS = (
    Argument("files...", "RUN [RUN]", "Name the folder of a run, or two to see them side by side."),
    Option("--view", "Where the camera is: behind the car, on its hood, or both.", _view, "chase",
           metavar=f"[{'|'.join(VIEWS)}]"),
    Option("--out", f"The film, or the folder for several films. [default: {FILM}, {FILMS}]", PATH,
           metavar="FILM.mp4"),
    Option("--fps", "Frames per second.", click.IntRange(1, 120), 25, metavar="NUMBER"),
    Option("--size", "Width and height of a frame, pixels.", _size, "640x360", metavar="WxH"),
    Option("--seconds",
           "Film only the first N seconds, or seconds FROM to TO. [default: the whole drive]",
           _seconds, metavar="N|FROM:TO"),
    Option("--all is_all", "Film every road in a folder; the film of a run is saved in the run's own folder.",
           bool),
    *options.CHOICES,
    *named(options.WORLD, "map_size"),
    *named(options.SETUP, "geometry"),
    options.QUIET,
)
# fmt: on


@click.command(cls=GroupedCommand, params=[*PARAMETERS])
def command(
    files: tuple[str, ...], view: str, out: Path | None, fps: int, size: tuple[int, int],
    seconds: tuple[float, float | None] | None, is_all: bool, geometry: Any, quiet: bool, **rest: Any,
) -> None:  # fmt: skip
    """Film a drive as an MP4: from behind the car, from its hood, or both; or two drives side by side.

    RUN is a run, such as DIR/runs/0001 or DIR/test.0001.json; a test of a campaign, such as CAMPAIGN/c01/17;
    or a road file, along which the camera moves without a car. The film shows the description, the speed, the
    position along the road and the margin, and at the end the outcome. An existing film of the same name is
    replaced. Filming needs PyAV, in a checkout: pip install -e '.[film]'.

    \b
    roadgpt film roadgpt-runs/hairpins-7/runs/0001 --view both
    roadgpt film DIR/runs/0001 DIR/runs/0002 --view hood --out compared.mp4
    roadgpt film roadgpt-runs/hairpins-7 --all
    roadgpt film CAMPAIGN --faults --out films
    """
    from roadgpt.report.film import Settings

    begin, length = seconds or (0.0, None)
    settings = Settings(*size, fps, begin, length)
    choice = options.choice_of(rest)
    world = options.world_of(rest)
    if is_all or choice in ("failures", "faults"):
        for each, film in _films(files, choice, view, out):
            run = run_of(each, world, geometry)
            if run.road is None:
                warn(f"{each.said} has no road to film")
            else:
                _make([run], film, view, settings, quiet)
        return
    out = out or FILM
    check_file(out, "film", FILM, ENDINGS)
    runs = [run_of(each, world, geometry) for each in shown_roads(files, choice, MOST, "a film")]
    _make(runs, out, view, settings, quiet)


def _films(
    files: tuple[str, ...], choice: "Choice | None", view: str, out: Path | None
) -> Iterator[tuple[NamedRoad, Path]]:
    """Yields the roads to film, each with the path of its film. In a folder of runs, roads that already have
    a film are left out."""
    from roadgpt.campaign.folder_record import is_store
    from roadgpt.campaign.selection import selection_of

    first = selection_of(files[0])
    is_of_runs = choice is None and (first is None or not is_store(first.folder))
    if is_of_runs and (len(files) != 1 or out is not None):
        raise UsageError("--all takes one folder of runs, and puts each film into its run")
    if is_of_runs and first is None:
        raise UsageError(f"{files[0]} holds no runs; give a folder that roadgpt run made")
    place = out or FILMS
    if not is_of_runs and (place.suffix.lower() in ENDINGS or place.is_file()):
        raise UsageError(f"this makes several films; name a folder for them, such as --out {FILMS}")
    for each in roads_named(files, choice, takes_all=True):
        if not is_of_runs:
            yield each, made(place) / f"{each.stem}-{view}.mp4"
        elif not (film := Path(str(each.key), f"{view}.mp4")).exists():
            yield each, film


def _make(runs: list[Any], out: Path, view: str, settings: "Settings", quiet: bool) -> None:
    from roadgpt.network import refuse_without_route
    from roadgpt.report.film import write

    for run in runs:
        with named_in_errors(run.source or run.title):
            refuse_without_route(run.road, "filmed")
    write(runs, out, MOUNTS.get(view, view), settings, lambda them, n: watched(them, n, "frames", quiet))
    if not quiet:
        click.echo(str(out))
