"""Finds and reads the roads that a user names: files, runs, folders of runs, campaigns and tests."""

import os
import re
import webbrowser
from collections.abc import Callable, Iterator, Sequence, Set
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import count
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from roadgpt.cli.options import WORLD, choices_said, endings, typed
from roadgpt.cli.screen import Row, Screen, unreadable
from roadgpt.cli.streams import warn
from roadgpt.errors import ExportError, PartError, UsageError, explained
from roadgpt.plural import plural

if TYPE_CHECKING:
    from roadgpt.campaign.selection import Selection
    from roadgpt.network.source import RoadSource
    from roadgpt.road import Design, Geometry, Road, World
    from roadgpt.run import Run

FAILED, UNREADABLE = 1, 2  # exit statuses: a format cannot hold a road; a name or a road cannot be used
LANES = ("lanes", "lane_width", "lane_width_end", "shoulder", "bank")
"""Fields of the World that have no effect on a road with a cross-section of its own."""
ROOM = 20.0  # m kept free around a road that is moved onto the map
BORDER = 1.5  # m between a road and the border of its map, or a spline through its points may leave the map
ROUND_MAP = 50.0  # m, to which the size of a map is rounded up
BESIDE_A_ROAD = (".drive.csv", ".route.json")  # endings of files that exporters write beside a road
MOST_TOLD = 8  # names in a message


@dataclass(frozen=True)
class NamedRoad:
    """A road that the user named."""

    said: str  # road's name as a user can type it as an argument of a command
    stem: str  # first part of the names of files that are made from the road
    key: object  # a value that identifies the road; two names of the same road have equal keys
    run: "Callable[[], Run] | None"
    """A function that reads the road's Run; None for a road file, which each command reads in its own way."""


def roads_named(
    files: Sequence[str], choice: str | None, takes_all: bool = False, seen: set[object] | None = None
) -> Iterator[NamedRoad]:
    """Yields the roads that the names refer to, each road once, and none whose key is in ``seen``.

    From a folder, it yields the roads that the choice selects. Without a choice, it yields all roads if
    ``takes_all`` is true; otherwise the folder must hold exactly one road."""
    seen = set() if seen is None else seen
    for file in files:
        for each in _named(file, choice, takes_all):
            if each.key not in seen:
                seen.add(each.key)
                yield each


def kind_of(file: str) -> Literal["road", "runs", "campaign"]:
    """Returns whether a name is of a road or single run, of runs, or of tests of a campaign."""
    from roadgpt.campaign.folder_record import open_record
    from roadgpt.campaign.selection import selection_of

    place = selection_of(file)
    if place is None:
        return "road"
    with open_record(place.folder) as record:
        return "runs" if record.keeps_runs else "campaign"


def use_each(
    files: Sequence[str], choice: str | None, use: Callable[[NamedRoad], None], takes_all: bool = False
) -> int:
    """Calls ``use`` for each road that the names refer to; a name or a road that cannot be used is reported
    and skipped. Returns the exit status: 0, 1 if a format cannot hold a road, or 2 if a name or a road cannot
    be used."""
    status, seen = 0, set[object]()

    @contextmanager
    def reported() -> Iterator[None]:
        nonlocal status
        try:
            yield
        except PartError:
            raise
        except (UsageError, ExportError) as error:
            warn(error)
            status = max(status, FAILED if isinstance(error, ExportError) else UNREADABLE)

    for file in files:
        with reported():
            for each in roads_named([file], choice, takes_all, seen):
                with reported():
                    use(each)
    return status


def _named(file: str, choice: str | None, takes_all: bool) -> Iterator[NamedRoad]:
    from roadgpt.campaign.selection import chosen, selection_of

    place = selection_of(file)
    if place is None or place.number is not None:
        if choice is not None and (place is not None or Path(file).exists()):
            raise UsageError(f"--{choice} selects roads of a campaign or a folder of runs; {file} is neither")
        yield _single(file) if place is None else _test(place)
        return
    found = chosen(place, choice)
    if choice is not None and not found:
        raise UsageError(f"{'nobody drove' if choice == 'worst' else 'no road failed'} in {file}")
    if choice is None and not takes_all:
        if not found:
            raise UsageError(f"{place.said} holds no road yet")
        if len(found) > 1:
            raise UsageError(
                f"{place.said} holds {len(found):,} roads; name one, as {found[0].said}, or say "
                f"{choices_said()}"
            )
    yield from map(_test, found)


def _test(place: "Selection") -> NamedRoad:
    from roadgpt.run.folder import run_folder

    assert place.number is not None
    if not place.cell:
        return _run(run_folder(place.folder, place.number), place.said)
    return NamedRoad(place.said, place.stem, (place.folder.resolve(), place.cell, place.number), place.run)


def _run(folder: Path, said: str) -> NamedRoad:
    from roadgpt.campaign.folder_record import has_tests
    from roadgpt.run import read_run
    from roadgpt.run.folder import RUNS

    whole = Path(os.path.realpath(folder))
    campaign = whole.parent.parent
    is_one_of_many = whole.parent.name == RUNS and has_tests(campaign)
    stem = f"{campaign.name}-{whole.name}" if is_one_of_many else whole.name
    return NamedRoad(said, stem, whole, lambda: read_run(folder))


def _single(file: str) -> NamedRoad:
    from roadgpt.campaign.selection import near
    from roadgpt.run.folder import is_run, run_of_test

    path = Path(file)
    if is_run(path):
        return _run(path, file)
    stem = Path(os.path.realpath(path)).name
    for ending in endings():
        stem = stem.removesuffix(ending)
    if (folder := run_of_test(path)) is not None:
        return replace(_run(folder, file), stem=stem)
    if not path.exists() and not path.is_symlink() and (others := near(file)):
        raise UsageError(
            f"cannot read {file}: there is nothing of that name; did you mean {' or '.join(others)}?"
        )
    return NamedRoad(file, stem, Path(os.path.realpath(path)), None)


def roads_in(files: Sequence[str]) -> list[str]:
    """Returns the names, with those of its roads in place of a folder; says what else is in it."""
    from roadgpt.campaign.selection import chosen, selection_of
    from roadgpt.campaign.status import status_of

    roads = list[str]()
    for file in files:
        path, found, others = Path(file), list[str](), list[str]()
        if (place := selection_of(file)) and place.number is None:
            found = [each.said for each in chosen(place, None)]
            done = sum(cell.done for cell in status_of(place.folder).cells if place.cell in ("", cell.name))
            others = [plural(done - len(found), "test")] * (done > len(found))
        elif path.is_dir() and not (path / "road.json").is_file():
            for each in sorted(path.iterdir(), key=_in_order):
                if (each / "road.json").is_file() or each.name.lower().endswith(endings()):
                    found += [str(each)] * (not each.name.endswith(BESIDE_A_ROAD))
                else:
                    others.append(each.name)
        if found and others:
            more = ", ..." * (len(others) > MOST_TOLD)
            warn(f"{file}: left out, as without a road: {', '.join(others[:MOST_TOLD])}{more}")
        roads += found or [file]
    return roads


def _in_order(path: Path) -> list[str | int]:
    """The parts of a name, so that route-2.json comes before route-10.json."""
    parts = re.split(r"([0-9]+)", path.name)
    return [int(part) if at % 2 else part for at, part in enumerate(parts)]


def source_of(
    file: str, world: "World", told: Set[str] | None = None
) -> tuple["Design | Road", "World", tuple[str, ...]]:
    """Returns the design or the road in a file, its World, and remarks on what is taken from where. ``file``
    may be the folder of a run, or a test such as CAMPAIGN/c01/17.

    What the file states goes before ``world``, that of the options, except for options that were typed, or
    the fields that ``told`` names. If the file defines lanes, a remark names the lane options that have no
    effect."""
    from roadgpt.network.maps import is_map_file
    from roadgpt.road import Road, World
    from roadgpt.road.points import SUFFIXES

    blueprint, remarks, world_of_file, *_ = _source_in(file)
    context, stated = click.get_current_context(silent=True), dict(world_of_file)
    told = (typed(context) if context else set()) if told is None else told
    told = told | {"limit_stated"} if "speed_limit" in told else told
    scene = stated.pop("scene", "")
    if scene and not {"scene", "scenario"} & told and context and "scene" in context.params:
        remarks += (f"the scene of the run is left out; give it with --scene '{scene}'",)
    values, usual = world.values(), World().values()
    given = [each for each in WORLD if each.field in told or values.get(each.field) != usual.get(each.field)]
    own = [each.flag for each in given if each.field in LANES] if getattr(blueprint, "profile", None) else []
    for each in given:
        if each.flag not in own and each.field in stated and stated[each.field] != values[each.field]:
            of_file = f"the {stated[each.field] * each.unit:.6g} of the file"
            pair = (of_file, f"{each.flag} of the configuration")
            remarks += (" goes before ".join((each.flag, of_file) if each.field in told else pair),)
    if "scene" in told and world.scene.surfaces and "friction" in stated.keys() - told:
        remarks += (f"the surface of --scene goes before the friction {stated['friction']:g} of the file",)
        told = told | {"friction"}
    world = world.changed(**{name: value for name, value in stated.items() if name not in told})
    has_no_size = is_map_file(Path(file)) or Path(file).suffix.lower() in SUFFIXES
    if has_no_size and isinstance(blueprint, Road) and "map_size" not in told:
        _, size, _, more = on_a_map(blueprint, world, keep_place=True)
        world, remarks = world.changed(map_size=size), remarks + more
    if own:
        verb = "has" if len(own) == 1 else "have"
        remarks += (f"the road has lanes of its own; {', '.join(own)} {verb} no effect on it",)
    return blueprint, world, remarks


def _source_in(file: str) -> "RoadSource":
    from roadgpt.campaign.selection import selection_of
    from roadgpt.network.source import OF_FILE, RoadSource, read_source

    if (place := selection_of(file)) is None or place.number is None:
        if Path(file).is_dir() and not Path(file, "road.json").is_file():
            raise UsageError(f"{file} is a folder without a road; give a road file, or the folder of a run")
        return read_source(file)
    run = place.run()
    if run.road is None:
        raise UsageError(f"{file} has no road: {run.description}")
    values = run.request.world.values()
    stated = {name: values[name] for name in (*OF_FILE, "scene") if values[name] != ""}
    return RoadSource(run.road, (), stated, file)


def on_a_map(
    road: "Road", world: "World", keep_place: bool
) -> tuple["Road", float, tuple[float, float, float], tuple[str, ...]]:
    """Returns the road, or the route with its network, on a map that is as wide as the World's or wider, the
    map's width in metres, by how many metres it was moved, and remarks. Whole metres lose no digits of the
    file's coordinates."""
    import numpy as np

    from roadgpt.brief.words import LARGEST_MAP
    from roadgpt.check.extremes import lowest
    from roadgpt.check.ribbon import extent
    from roadgpt.network import network_of

    members, remarks, x, y, z = network_of(world.lay(road), world).roads, list[str](), 0.0, 0.0, 0.0
    spans = [extent(each.road.sample(), each.profile.edges(each.road.sample().s)) for each in members]
    low, high = np.min([low for low, _ in spans], axis=0), np.max([high for _, high in spans], axis=0)
    wide = float(high.max()) + BORDER if keep_place else float((high - low).max()) + 2 * ROOM
    size = max(world.site.map_size, ROUND_MAP * ceil(wide / ROUND_MAP))
    fits = (low > BORDER).all() and (high < size - BORDER).all()
    if keep_place and not (fits and size <= LARGEST_MAP):
        size = world.site.map_size
        remarks.append("its place is off the map; roadgpt import without --keep-place moves it onto one")
    elif size > LARGEST_MAP:
        size = world.site.map_size
        remarks.append(f"with its lanes it is {wide:.0f} m wide, too large for a map; its place is kept")
    elif size > world.site.map_size:
        remarks.append(f"its map is {size:g} m wide")
    if not (keep_place or fits or wide > LARGEST_MAP):
        x, y = (float(round(each)) for each in size / 2 - (low + high) / 2)
        back = f"add ({-x:.0f}, {-y:.0f}) m for its place in the file"
        remarks.append(f"it is moved by ({x:.0f}, {y:.0f}) m into the middle of the map; {back}")
    deepest = min(lowest(each.road.elevation, each.road.length)[1] for each in members)
    if deepest < world.site.z_floor and not keep_place:
        z = float(ceil(-deepest))
        remarks.append(f"it is lifted by {z:.0f} m: its lowest place was below the ground of the map")
    return road.moved(x, y, z), size, (x, y, z), tuple(remarks)


def shown_roads(files: Sequence[str], choice: str | None, most: int, what: str) -> list[NamedRoad]:
    """Returns the named roads, at most ``most``, to show them together in ``what``, such as 'a page'."""
    shows = f"{what} shows one road or two side by side"
    if len(files) > most:
        raise UsageError(f"{shows}; {len(files)} are given")
    named = [*roads_named(files, choice)]
    if len(named) > most:
        name = f"name one or two, as {named[0].said}, or say --worst"
        raise UsageError(f"{shows}; these are {len(named):,}: {name}")
    if len(named) < len(files):  # the same road twice, side by side
        named = [each for file in files for each in roads_named([file], choice)]
    return named


def run_of(named: NamedRoad, world: "World", geometry: "Geometry", quiet: bool = False) -> "Run":
    """Returns the Run of a road, or a new Run without a drive for a road file; prints remarks on it."""
    from roadgpt.run import Setup, prove

    if named.run is not None:
        return named.run()
    blueprint, world, remarks = source_of(named.said, world)
    for remark in () if quiet else remarks:
        warn(f"{named.said}: {remark}")
    with named_in_errors(named.said):
        run = prove(blueprint, world=world, setup=Setup(geometry=geometry, drives=False))
    return replace(run, source=Path(named.said).name)


@contextmanager
def named_in_errors(file: str) -> Iterator[None]:
    """Puts the name of a file before an error message that does not contain the name."""
    try:
        yield
    except PartError:
        raise
    except (UsageError, ExportError) as error:
        if str(Path(file)) in str(error):
            raise
        kind = ExportError if isinstance(error, ExportError) else UsageError
        raise kind(f"{file}: {error}") from error


def each_road(
    files: Sequence[str], screen: Screen, world: "World",
    look: "Callable[[str, Design | Road, World], tuple[Row, Run | None]]",
) -> None:  # fmt: skip
    """Calls ``look`` for every file with what ``source_of`` finds in it, and prints the remarks on it, the
    rows and a table of their outcomes. A file that cannot be used gets a row with an error, but for a single
    one."""
    with screen:
        for file in files:
            try:
                with named_in_errors(file):
                    blueprint, its_world, remarks = source_of(file, world)
                    for remark in remarks:
                        screen.say(f"{file}: {remark}")
                    seen = look(file, blueprint, its_world)
            except PartError:
                raise
            except UsageError as error:
                if len(files) == 1 and not screen.as_json:
                    raise
                seen = unreadable(file, error), None
            screen.row(*seen)
        screen.close()


def check_file(path: Path, kind: str, usual: Path, endings: Sequence[str] = ()) -> None:
    """Refuses a folder, or a path without one of the ``endings``, for a page, a film or a picture (``kind``).
    ``usual`` is an example of a name, for the message."""
    if path.is_dir():
        raise UsageError(f"{path} is a folder; give the name of a {kind}, such as {path / usual}")
    if endings and path.suffix.lower() not in endings:
        raise UsageError(f"{path} does not end in {endings[0]}; give the {kind} such a name")


def open_page(page: Path) -> None:
    """Opens a page in the browser, or says that no browser could be started."""
    if not webbrowser.open(page.resolve().as_uri()):
        warn(f"no browser could be started; open {page} in one")


def numbered(name: str, ending: str = "") -> Iterator[str]:
    """Yields names for a file or folder; for 'road' and '.json': road.json, road-2.json, road-3.json, ..."""
    yield name + ending
    yield from (f"{name}-{number}{ending}" for number in count(2))


def free(stem: str | Path, ending: str = "") -> Path:
    """Returns the first path of ``numbered`` at which there is nothing yet."""
    return next(path for path in map(Path, numbered(str(stem), ending)) if not path.exists())


def made(folder: Path) -> Path:
    """Makes a folder, if it does not exist, and returns it."""
    with explained(UsageError, f"cannot make {folder}", "name another folder with --out"):
        folder.mkdir(parents=True, exist_ok=True)
    return folder
