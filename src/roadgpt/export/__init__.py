"""Exports: makes files that other tools read. Verb: ``save``; a format is a part on the shelf ``exporters/``.

    class Exporter:
        name = "opendrive"                                     # of the format
        suffix = ".xodr"                                       # of its file
        def save(self, road, path, world, poses=None) -> None

A part writes ``path``, and may write further files of the same stem beside it. The same arguments give the
same bytes: no clock, no random number, no path of this machine.
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
    """Of the format, as on the shelf."""
    suffix: str
    """Of its file, with the dot."""

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Write a road into a file of a folder that exists and holds nothing else.

        Args:
            road: what is exported.
            path: the file; others may be written beside it whose names begin with its stem.
            world: widths of lane and verge, friction, speed limit.
            poses: a drive along the road, for formats that can hold one.

        Raises:
            ExportError: the format cannot hold this road, or what it needs is not installed.
        """
        ...


def exporter_of(name: str) -> Exporter:
    """The part that writes this format.

    Raises:
        PartError: there is none of that name.
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
    """Write a road in each of these formats; gives back the files, all of one format before the next.

    A file is there whole or not at all; one of the same name is replaced.

    Args:
        road: what is exported.
        folder: made where it does not exist.
        formats: names on the shelf ``exporters``; each is found before any file is written.
        world: widths of lane and verge, friction, speed limit.
        name: of the files, without their suffix.
        poses: a drive along the road, for formats that can hold one.

    Raises:
        PartError: a format is unknown.
        ExportError: a format cannot hold this road, or a file cannot be written.
    """
    parts = [exporter_of(format_) for format_ in dict.fromkeys(formats)]
    if not name or name == ".." or Path(name).name != name:
        raise UsageError(f"'{name}' cannot name a file; give a name without a folder")
    folder = Path(folder)
    written: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for part in parts:
            # a folder of its own: what a part wrote before it failed is not left behind
            with tempfile.TemporaryDirectory(dir=folder, prefix=".export-", suffix=".part") as draft:
                part.save(road, Path(draft, name + part.suffix), world, poses)
                written += _moved(Path(draft), folder)
    except OSError as error:
        why = error.strerror or error
        raise ExportError(f"cannot write into {folder}: {why}; name another folder") from error
    return tuple(dict.fromkeys(written))


def _moved(draft: Path, folder: Path) -> list[Path]:
    """Take everything out of the draft into the folder; the names in their order."""
    targets = []
    for made in sorted(draft.iterdir()):
        target = folder / made.name
        if made.is_dir() and target.is_dir():
            shutil.rmtree(target)
        made.replace(target)
        targets.append(target)
    return targets
