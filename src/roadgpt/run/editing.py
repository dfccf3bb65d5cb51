"""Finds the Design to change, and writes the Run of the changed road into a folder.

folder/
  test.0001.json, runs/0001/...    the new Run, as in any campaign
  runs/0001/edit.json              the change request, the changes made, and the original Design
  runs/0001/before/*.png           pictures of the original road
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from roadgpt.errors import UsageError, explained
from roadgpt.network import MapDesign, NetworkDesign, read_blueprint
from roadgpt.road import Design, World
from roadgpt.run.atomic import json_text, to_bytes
from roadgpt.run.folder import EDIT_CARD, Draw, write_run
from roadgpt.run.folder_names import new_folder
from roadgpt.run.model import Run, Setup

BEFORE = "before"


@dataclass(frozen=True)
class Original:
    """The Design to change, with the World, Setup and seed of its Run; the seed is 0 if there is no Run."""

    design: Design
    world: World
    setup: Setup
    seed: int
    path: str
    remarks: tuple[str, ...] = ()
    """Notes on adjustments that were made when the road's file was read."""


def original_in(path: str, world: World, setup: Setup) -> Original:
    """Reads the Design in a file, and returns it as the Original to change.

    Args:
        path: the file.
        world: the World for the Design.
        setup: the Setup for the Design.

    Raises:
        UsageError: there is no such file, or it holds points or a road with junctions instead of a Design.
    """
    if not Path(path).exists():
        raise UsageError(f"there is no {path}; give the folder of a run, or the file of a road")
    blueprint, remarks = read_blueprint(path)
    if isinstance(blueprint, (NetworkDesign, MapDesign)):
        raise UsageError(f"{path} has junctions; only a road without junctions can be changed so far")
    if not isinstance(blueprint, Design):
        raise UsageError(f"{path} holds points and no design; only a design with segments can be changed")
    return Original(blueprint, world, setup, 0, path, remarks)


def original_of(run: Run, path: str) -> Original:
    """Returns the Design of a Run as the Original to change; ``path`` is the path of the Run.

    Raises:
        UsageError: the Run has no design, or its design has junctions.
    """
    if run.design is None:
        raise UsageError(f"{path} was made from points and has no design; only a design can be changed")
    if isinstance(run.design, (NetworkDesign, MapDesign)):
        raise UsageError(f"{path} has junctions; only a road without junctions can be changed so far")
    return Original(run.design, run.world, run.request.setup, run.seed, path)


def reject_used(out: Path) -> None:
    """Raises UsageError if ``out`` is a folder that is not empty."""
    if out.is_dir() and any(out.iterdir()):
        raise UsageError(f"{out} is not empty; a changed road goes into a new folder: name another one")


def folder_for(words: str, seed: int, out: Path | None) -> Path:
    """Returns an empty folder for the changed road: ``out``, which is created if it does not exist, or, if
    ``out`` is None, a new folder named after the change request and the seed.

    Raises:
        UsageError: the folder cannot be created, or is not empty.
    """
    if out is None:
        return new_folder(words, seed)
    with explained(UsageError, f"cannot use {out}", "name another folder"):
        out.mkdir(parents=True, exist_ok=True)
        reject_used(out)
    return out


@dataclass(frozen=True)
class _Beside:
    """Writes the change request and, if pictures are drawn, pictures of the new and the original road."""

    card: bytes
    before: Run
    draw: Draw | None

    def of_run(self, run: Run, folder: Path) -> None:
        """Writes these files into the folder of the new Run."""
        (folder / EDIT_CARD).write_bytes(self.card)
        if self.draw is not None:
            self.draw.of_run(run, folder)
            (folder / BEFORE).mkdir()
            self.draw.of_run(self.before, folder / BEFORE)

    def of_campaign(self, folder: Path) -> None:
        """Writes nothing: a single road needs no picture of all roads."""


def write_edit(
    run: Run, before: Run, words: str, changes: Sequence[str], source: str, folder: Path, draw: Draw | None
) -> Path:
    """Writes a changed road; returns the folder of its Run.

    Args:
        run: the Run of the changed road.
        before: the Run of the original road; this Run has no drive.
        words: the change request in words.
        changes: sentences that describe the changes made.
        source: the path of the original road.
        folder: an empty folder.
        draw: draws pictures of the original and of the changed road; None for no pictures.
    """
    card = {
        "request": words,
        "of": source,
        "changes": list(changes),
        "design_before": before.design and before.design.to_json(),
    }
    was = replace(before, source=f"before: {words}")
    beside = _Beside(to_bytes(json_text(card)), was, draw)
    return write_run(replace(run, index=1, source=words), folder, beside)


__all__ = ["Original", "folder_for", "original_in", "original_of", "reject_used", "write_edit"]
