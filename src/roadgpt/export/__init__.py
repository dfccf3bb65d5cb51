"""Exports roads to files of other tools. Main function: ``save``. A format is a plug-in under ``exporters/``.

    class Exporter:
        name = "opendrive"                                     # of the format
        suffix = ".xodr"                                       # of its file
        def save(self, road, path, world, poses=None) -> None

An exporter writes ``path``, and may write further files with the same stem beside it. The same arguments give
the same bytes: no clock, no random number, no path of the machine.
"""

import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from roadgpt import plugins
from roadgpt.errors import ExportError, UsageError
from roadgpt.export.poses import Poses
from roadgpt.road import Road, World

__all__ = ["Exporter", "Poses", "exporter_of", "save"]


@runtime_checkable
class Exporter(Protocol):
    """Writes roads in one format."""

    name: str
    """Name of the format, as it is registered."""
    suffix: str
    """Suffix of its file, including the dot."""

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes a road to a file. The folder of the file exists and is empty.

        Args:
            road: The road to export.
            path: The file. Other files may be written beside it if their names begin with its stem.
            world: Widths of lane and shoulder, friction, speed limit.
            poses: A drive along the road, for formats that can hold one.

        Raises:
            ExportError: The format cannot hold this road, or something that it needs is not installed.
        """
        ...


def exporter_of(name: str) -> Exporter:
    """Returns the exporter of a format.

    Raises:
        PartError: There is no exporter of this name.
    """
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
) -> tuple[Path, ...]:
    """Writes a road in each of these formats. Returns the files, all of one format before those of the next.

    A file is either complete or absent. An existing file of the same name is replaced.

    Args:
        road: The road to export.
        folder: The folder, which is created if it does not exist.
        formats: Names of exporters. All are looked up before any file is written.
        world: Widths of lane and shoulder, friction, speed limit.
        name: Name of the files without suffix.
        poses: A drive along the road, for formats that can hold one.

    Raises:
        PartError: A format is unknown.
        UsageError: ``name`` cannot be the name of a file.
        ExportError: A format cannot hold this road, or a file cannot be written.
    """
    parts = [exporter_of(format_) for format_ in dict.fromkeys(formats)]
    if not name or name == ".." or Path(name).name != name:
        raise UsageError(f"'{name}' cannot name a file; give a name without a folder")
    folder = Path(folder)
    written: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for part in parts:
            # in a folder of its own, so that nothing remains of an exporter that fails
            with tempfile.TemporaryDirectory(dir=folder, prefix=".export-", suffix=".part") as draft:
                part.save(road, Path(draft, name + part.suffix), world, poses)
                written += _moved(Path(draft), folder)
    except OSError as error:
        why = error.strerror or error
        raise ExportError(f"cannot write into {folder}: {why}; name another folder") from error
    return tuple(dict.fromkeys(written))


def _moved(draft: Path, folder: Path) -> list[Path]:
    """Moves everything from the draft into the folder, and returns the paths in order."""
    targets = []
    for made in sorted(draft.iterdir()):
        target = folder / made.name
        if made.is_dir() and target.is_dir():
            shutil.rmtree(target)
        made.replace(target)
        targets.append(target)
    return targets
