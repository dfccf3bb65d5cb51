"""``roadgpt film``: films one drive, two beside each other, or those of many runs."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli import options, streams
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.cli import roads
    from roadgpt_film.film import Settings

MOST = 2  # roads side by side
LONGEST = 1_000_000  # s, largest time that --seconds accepts
FILM, FILMS = Path("roadgpt-film.mp4"), Path("films")
ENDINGS = (".mp4", ".m4v")
MOUNTS = {"hood": "bonnet"}  # as ``film.write`` calls them


def _size(value: str) -> tuple[int, int]:
    if not (size := re.fullmatch(r"(\d+)x(\d+)", value, re.IGNORECASE)):
        raise click.BadParameter(f"'{value}' is no size; give width and height in pixels, such as 640x360")
    return int(size[1]), int(size[2])


def _seconds(value: str) -> tuple[float, float | None]:
    """Converts 9 or 4:13 to start and length in seconds; without a length, it is to the end of the drive."""
    first, colon, last = value.rpartition(":")
    give = "give 9, or 4:13 for the 4th to the 13th"
    try:
        begin, end = float(first or 0), None if colon and not last else float(last)
    except ValueError:
        raise click.BadParameter(f"'{value}' are no seconds; {give}") from None
    if not all(0 <= each <= LONGEST for each in (begin, end or 0)):
        raise click.BadParameter(f"'{value}' is no part of a drive; give seconds from 0 to {LONGEST:,}")
    if end is not None and end <= begin:
        raise click.BadParameter(f"'{value}' ends before it begins; {give}")
    return begin, None if end is None else end - begin


FILM_OPTIONS: list[click.Parameter] = [
    options.Argument("files...", "RUN [RUN]",
                     "Name the folder of a run, or two to see them side by side."),
    options.Option("--view", "Where the camera is: behind the car, on its hood, or both.",
                   click.Choice(["chase", "hood", "both"]), "chase"),
    options.Option("--out", f"The film, or the folder for several films. [default: {FILM}, {FILMS}]",
                   options.PATH, metavar="FILM.mp4"),
    options.Option("--fps", "Frames per second.", click.IntRange(1, 120), 25, metavar="NUMBER"),
    options.Option("--size", "Width and height of a frame, pixels.", _size, "640x360", metavar="WxH"),
    options.Option("--seconds",
                   "Film only the first N seconds, or seconds FROM to TO. [default: the whole drive]",
                   _seconds, metavar="N|FROM:TO"),
    options.Option("--all is_all",
                   "Film every road in a folder; the film of a run is saved in the run's own folder.",
                   bool),
    *options.CHOICES,
    *options.named(options.WORLD, "map_size", "ground"),
    *options.named(options.SETUP, "geometry"),
    options.QUIET,
]  # fmt: skip


@click.command(
    cls=options.GroupedCommand, params=FILM_OPTIONS, heading="Look",
    short_help="Film drives: from behind the car, from its hood, or two side by side.",
)  # fmt: skip
def film(
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
    roadgpt film CAMPAIGN --faults --out films"""
    from roadgpt.cli import roads
    from roadgpt_film.film import Settings

    begin, length = seconds or (0.0, None)
    settings = Settings(*size, fps, begin, length)
    choice, world = options.choice_of(rest), options.world_of(rest)
    if is_all or choice not in (None, "worst"):
        for each, film in _films(files, choice, view, out):
            run = roads.run_of(each, world, geometry)
            if run.road is None:
                streams.warn(f"{each.said} has no road to film")
            else:
                _make([run], film, view, settings, quiet)
        return
    out = out or FILM
    roads.check_file(out, "film", FILM, ENDINGS)
    runs = [roads.run_of(each, world, geometry) for each in roads.shown_roads(files, choice, MOST, "a film")]
    _make(runs, out, view, settings, quiet)


def _films(
    files: tuple[str, ...], choice: Any, view: str, out: Path | None
) -> Iterator[tuple["roads.NamedRoad", Path]]:
    """Yields roads with the paths of their films; in a folder of runs, only roads that have no film yet."""
    from roadgpt.cli import roads

    kind = roads.kind_of(files[0])
    is_of_runs = choice is None and kind != "campaign"
    if is_of_runs and (len(files) != 1 or out is not None):
        raise UsageError("--all takes one folder of runs, and puts each film into its run")
    if is_of_runs and kind == "road":
        raise UsageError(f"{files[0]} holds no runs; give a folder that roadgpt run made")
    place = out or FILMS
    if not is_of_runs and (place.suffix.lower() in ENDINGS or place.is_file()):
        raise UsageError(f"this makes several films; name a folder for them, such as --out {FILMS}")
    for each in roads.roads_named(files, choice, takes_all=True):
        if not is_of_runs:
            yield each, roads.made(place) / f"{each.stem}-{view}.mp4"
        elif not (film := Path(str(each.key), f"{view}.mp4")).exists():
            yield each, film


def _make(runs: list[Any], out: Path, view: str, settings: "Settings", quiet: bool) -> None:
    from roadgpt.cli import roads
    from roadgpt.network import refuse_without_route
    from roadgpt_film.film import write

    for run in runs:
        with roads.named_in_errors(run.source or run.title):
            refuse_without_route(run.road, "filmed")
    mount = MOUNTS.get(view, view)
    write(runs, out, mount, settings, lambda them, n: streams.watched(them, n, "frames", quiet))
    if not quiet:
        click.echo(str(out))
