"""Exports roads to the file formats of other tools. Main function: ``save``.

Each format is a plug-in, for example:

    class Exporter:
        name = "opendrive"                                     # name of the format
        suffix = ".xodr"                                       # suffix of the exported file
        holds_junctions = True                                 # optional: the format can hold networks
        needs_route = True                                     # optional: a map without a route is refused
        holds_others = True                                    # optional: it holds the others on the road
        draws_edges = False                                    # optional: it holds no edges of lanes
        def save(self, road, path, world, poses=None) -> None

An exporter writes ``path``, and may write further files with the same stem to the same folder. The same
arguments must always give identical files, so files contain no dates, random numbers or absolute paths."""

import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np

from roadgpt import plugins
from roadgpt.errors import ExportError, UsageError
from roadgpt.export.ego import Poses, Trajectories
from roadgpt.geometry import CubicProfile
from roadgpt.network import network_of, only_road
from roadgpt.road import Road, World
from roadgpt.road.edges import fold

__all__ = ["Exporter", "Poses", "Trajectories", "doubts", "exporter_of", "save"]

OTHERS = "others on the road"


@runtime_checkable
class Exporter(Protocol):
    """Writes roads in one format.

    An exporter whose attribute ``holds_junctions`` is True also gets routes through junctions
    (``roadgpt.network.Route``). An exporter without this attribute gets single roads only. An exporter whose
    attribute ``needs_route`` is also True gets no maps without a route (``road.has_way`` is False). An
    exporter whose attribute ``holds_others`` is True has one more argument, ``placed``: the others on a road
    where they begin, if nobody has driven it. Of all others it is said that they leave them out. For an
    exporter whose attribute ``draws_edges`` is False, folds of the edges of lanes do not matter."""

    name: str
    """Name under which the format is registered as a plug-in."""
    suffix: str
    """Suffix of the exported file, including the dot."""

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes a road to a file. The caller ensures that the folder of the file exists and is empty.

        Args:
            road: The road to export.
            path: The file to write. Further files must be in the same folder, and their names must
                begin with the stem of ``path``.
            world: Defines friction, speed limit, and the lanes of a road without its own cross-section.
            poses: The motion of the car in a drive along the road; None if there is no drive. Formats that
                cannot store a drive ignore it.

        Raises:
            ExportError: The format cannot hold this road, or a program that the exporter needs is missing or
                fails."""
        ...


def exporter_of(name: str) -> Exporter:
    """Returns the exporter of a format, or raises PartError."""
    found: Any = plugins.find("exporters", name)
    part: Exporter = found() if isinstance(found, type) else found
    return part


def save(
    road: Road,
    folder: Path | str,
    formats: Sequence[str],
    world: World,
    name: str = "road",
    poses: Poses | None = None,
    placed: Trajectories | None = None,
) -> tuple[Path, ...]:
    """Writes a road in the given formats. Returns the paths of all files, in the order of the formats.

    No incomplete file is left behind if writing fails. Existing files of the same names are replaced.

    Args:
        road: The road to export.
        folder: The folder, which is created if it does not exist.
        formats: Names of exporters, such as "opendrive". All are looked up before any file is written.
        world: Defines friction, speed limit, and the lanes of a road without its own cross-section.
        name: Name of the files without suffix.
        poses: The motion of the car in a drive along the road, for formats that can hold a drive.
        placed: The others on the road as they begin, a single sample, for formats that can hold them.

    Raises:
        PartError: A format is unknown.
        UsageError: ``name`` cannot be the name of a file.
        ExportError: A format cannot hold this road, a program that an exporter needs is missing or fails, or
            a file cannot be written. No file is written if a format cannot hold the junctions of a Route,
            or needs a route through a map that has none."""
    parts = [exporter_of(format_) for format_ in dict.fromkeys(formats)]
    if not name or name == ".." or Path(name).name != name:
        raise UsageError(f"'{name}' cannot name a file; give a name without a folder")
    road, folder = world.lay(road), Path(folder)
    for part in parts:
        _check_holds(road, part, world)
    written: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for part in parts:
            # each exporter writes into a folder of its own, so that nothing remains if it fails
            with tempfile.TemporaryDirectory(dir=folder, prefix=".export-", suffix=".part") as draft:
                more: tuple[Any, ...] = (placed,) if getattr(part, "holds_others", False) else ()
                part.save(road, Path(draft, name + part.suffix), world, poses, *more)
                written += _moved(Path(draft), folder)
    except OSError as error:
        why = error.strerror or error
        raise ExportError(f"cannot write into {folder}: {why}; name another folder") from error
    return tuple(dict.fromkeys(written))


def doubts(road: Road, formats: Sequence[str], world: World, poses: Poses | None = None) -> tuple[str, ...]:
    """Returns a sentence for each place of a road, and each property, that some of the formats cannot show
    rightly. An exporter may have ``lacks``, names of such properties, and a method ``doubts(road, world)``.
    """
    road, profile = world.lay(road), world.profile_of(road)
    is_only = only_road(road, world) is not None
    roads = {"" if is_only else f"road {each.id}: ": each for each in network_of(road, world).roads}
    folds = {name: fold(each.road, each.profile) for name, each in roads.items()}
    parts = [*map(exporter_of, formats)]
    shown = ", ".join(part.name for part in parts if getattr(part, "draws_edges", True))
    said = [f"{shown}: {name}{each}" for name, each in folds.items() if each and shown]
    widths = [lane.width for lane in (*profile.left, *profile.right)]
    there = {
        "heights": bool(np.any(road.sample().grade)),
        "superelevation": profile.superelevation_angle is not None,
        "changes of width": any(isinstance(width, CubicProfile) for width in widths),
        "the land around": world.has_ground,
        OTHERS: world.scene.has_others or (poses is not None and poses.others is not None),
    }
    for part in parts:
        lacks = (*getattr(part, "lacks", ()), *(() if getattr(part, "holds_others", False) else (OTHERS,)))
        said += [f"{part.name}: {what} left out" for what in lacks if there[what]]
        said += [f"{part.name}: {each}" for each in getattr(part, "doubts", lambda *_: ())(road, world)]
    return tuple(said)


def _check_holds(road: Road, part: Exporter, world: World) -> None:
    if not getattr(part, "holds_junctions", False) and only_road(road, world) is None:
        # nor can such a format hold what a Route without junctions has: traffic on the left, merged lanes
        instead = getattr(part, "for_junctions", "opendrive can")
        raise ExportError(f"{part.name} cannot hold junctions yet; {instead}")
    if not road.has_way and getattr(part, "needs_route", False):
        raise ExportError(
            f'{part.name} holds a way to drive, and this map has no route; give it one, such as "route": '
            "[1, 2, 4], or write opendrive"
        )


def _moved(draft: Path, folder: Path) -> list[Path]:
    targets = []
    for made in sorted(draft.iterdir()):
        target = folder / made.name
        if made.is_dir() and target.is_dir():
            shutil.rmtree(target)
        made.replace(target)
        targets.append(target)
    return targets
