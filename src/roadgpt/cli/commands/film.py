"""``roadgpt film``: drives as films, from behind the car, from its bonnet, or two in one picture."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli.options import setup_options, world_of, world_options
from roadgpt.cli.roads import shown_run
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.report.film import Settings

MOST = 2  # roads in one picture
LONGEST = 1_000_000  # s, of a part of a drive that is asked for
FILM = Path("roadgpt-film.mp4")
ENDINGS = (".mp4", ".m4v")
VIEWS = ("chase", "bonnet", "both")


def _size(value: str) -> tuple[int, int]:
    """The type of an option like 640x360."""
    wide, cross, high = value.lower().partition("x")
    if not (cross and wide.isdecimal() and high.isdecimal()):
        raise click.BadParameter(f"'{value}' is no size; give width and height in pixels, such as 640x360")
    return int(wide), int(high)


def _seconds(value: str) -> tuple[float, float | None]:
    """The type of an option like 9 or 4:13; where to begin, and how long."""
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


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="RUN [RUN]")
@click.option(
    "--view", type=click.Choice(VIEWS), default="chase", show_default=True, help="Where the camera is."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=None,
    metavar="FILM.mp4",
    help=f"The film; one of that name is replaced. [default: {FILM}]",
)
@click.option("--fps", type=click.IntRange(1, 120), default=25, show_default=True, help="Pictures a second.")
@click.option(
    "--size", type=_size, default="640x360", show_default=True, metavar="WxH", help="Pixels of each picture."
)
@click.option(
    "--seconds",
    type=_seconds,
    default=None,
    metavar="N|FROM:TO",
    help="Which seconds of the drive. [default: all, and the outcome]",
)
@click.option("--all", "is_all", is_flag=True, help="A film of each in a folder of runs, put into the run.")
@world_options("map_size")
@setup_options("geometry")
@click.option("--quiet", "-q", is_flag=True, help="Say nothing but errors.")
def command(
    files: tuple[str, ...],
    view: str,
    out: Path | None,
    fps: int,
    size: tuple[int, int],
    seconds: tuple[float, float | None] | None,
    is_all: bool,
    geometry: Any,
    quiet: bool,
    **rest: Any,
) -> None:  # fmt: skip
    """Film a drive as an MP4: from behind the car, from its bonnet, or both; two drives in a split screen.

    RUN is the folder of a run, DIR/runs/0001 or DIR/test.0001.json; along the road of a file that nobody
    drove the camera rides alone. Over the picture stand the description, the speed, the place on the road and
    the margin; at the end the outcome. Needs PyAV: python -m pip install 'roadgpt[film]'.

    \b
    roadgpt film roadgpt-runs/hairpins-7/runs/0001 --view both
    roadgpt film DIR/runs/0001 DIR/runs/0002 --view bonnet --out compared.mp4
    roadgpt film roadgpt-runs/hairpins-7 --all
    """
    from roadgpt.report.film import Settings

    begin, length = seconds or (0.0, None)
    settings = Settings(*size, fps, begin, length)
    if is_all:
        _film_all(files, view, out, settings, quiet)
        return
    if len(files) > MOST:
        raise UsageError(
            f"a film shows one road or two side by side; {len(files)} are given. All of a folder: --all"
        )
    out = out or FILM
    if out.is_dir():
        raise UsageError(f"{out} is a folder; give the name of a film, such as {out / FILM}")
    if out.suffix.lower() not in ENDINGS:
        raise UsageError(f"{out} would be a film; give it a name that ends in .mp4")
    world = world_of(rest)
    _make([shown_run(file, world, geometry) for file in files], out, view, settings, quiet)


def _film_all(files: tuple[str, ...], view: str, out: Path | None, settings: "Settings", quiet: bool) -> None:
    """One film for each in a folder of runs, but for those that are there."""
    from roadgpt.run import read_run
    from roadgpt.run.folder import RUNS, is_run

    if len(files) != 1 or out is not None:
        raise UsageError("--all takes one folder of runs, and puts each film into its run")
    folders = sorted(folder for folder in Path(files[0], RUNS).glob("*") if is_run(folder))
    if not folders:
        raise UsageError(f"{files[0]} holds no runs; give a folder that roadgpt run made")
    for folder in folders:
        film = folder / f"{view}.mp4"
        if film.exists():
            continue
        run = read_run(folder)
        if run.road is None:
            click.echo(f"roadgpt: {folder} has no road to film", err=True)
            continue
        _make([run], film, view, settings, quiet)


def _make(runs: list[Any], out: Path, view: str, settings: "Settings", quiet: bool) -> None:
    from roadgpt.report.film import write

    write(runs, out, view, settings, None if quiet or not sys.stderr.isatty() else _watched)
    if not quiet:
        click.echo(str(out))


def _watched(frames: Iterator[Any], count: int) -> Iterator[Any]:
    """A bar while frames pass."""
    with click.progressbar(frames, length=count, label="frames", file=sys.stderr) as bar:
        yield from bar
