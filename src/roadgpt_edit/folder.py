"""Finds the Design to change, and writes the Run of the changed road into a folder.

folder/
  test.0001.json, runs/0001/...    the new Run, as in any campaign
  runs/0001/edit.json              the change request, the changes made, and the original Design
  runs/0001/before/*.png           pictures of the original road
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from roadgpt.errors import UsageError
from roadgpt.network import read_source
from roadgpt.road import Design, Road, World
from roadgpt.run.atomic import json_text, to_bytes
from roadgpt.run.folder import EDIT_CARD, Draw, write_run
from roadgpt.run.model import Request, Run

BEFORE = "before"


def original_of(path: str, run: Run | None, world: World) -> tuple[Run, Design, tuple[str, ...]]:
    """Returns the Run to change, its Design, and notes on adjustments made when a file was read. Without a
    ``run``, the file of a design becomes one with the usual Setup, the seed 0, and this World; a map size
    that was given to it goes before the file's."""
    remarks: tuple[str, ...] = ()
    if run is None:
        if not Path(path).exists():
            raise UsageError(f"there is no {path}; give the folder of a run, or the file of a road")
        blueprint, remarks, stated, *_ = read_source(path)
        if isinstance(blueprint, Road):
            raise UsageError(
                f"{path} holds a finished road and no design; only a design with segments can be changed"
            )
        given = world.site.model_fields_set
        world = world.changed(**{name: value for name, value in stated.items() if name not in given})
        run = Run(Request(world=world), 1, 0, design=blueprint)
    if run.design is None:
        raise UsageError(f"{path} was made from points and has no design; only a design can be changed")
    if not run.design.is_plain:
        raise UsageError(f"{path} has junctions; only a road without junctions can be changed so far")
    return run, run.design, remarks


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
    """Writes a changed road and, drawn beside it, the original without a drive, into an empty folder; returns
    the folder of its Run. ``source`` is where the original was read."""
    card = {
        "request": words,
        "of": source,
        "changes": list(changes),
        "design_before": before.design and before.design.to_json(),
    }
    was = replace(before, source=f"before: {words}")
    beside = _Beside(to_bytes(json_text(card)), was, draw)
    return write_run(replace(run, index=1, source=words), folder, beside)
