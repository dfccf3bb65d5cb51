"""Changed roads: where a Design comes from, and the folder of the Run that a change made of it.

folder/
  test.0001.json, runs/0001/...    the new Run, as in any campaign
  runs/0001/edit.json              the request, what it changed, and the Design that it was made from
  runs/0001/before/*.png           the road as it was
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from roadgpt.errors import UsageError
from roadgpt.road import Design, World, read_blueprint
from roadgpt.run.atomic import json_text, to_bytes
from roadgpt.run.folder import Draw, is_run, only_run, read_run, write_run
from roadgpt.run.folder_names import new_folder
from roadgpt.run.model import Run, Setup

BEFORE, CARD = "before", "edit.json"


@dataclass(frozen=True)
class Original:
    """The road that is to be changed."""

    design: Design
    world: World
    setup: Setup
    seed: int
    path: str
    remarks: tuple[str, ...] = ()
    """What had to be settled of its file."""


def original(path: Path | str, world: World, setup: Setup) -> Original:
    """The Design in a run's folder, a campaign's folder of one road, or a file.

    Args:
        path: of one of these.
        world: of a Design that no run belongs to.
        setup: of the same.

    Raises:
        UsageError: there is no Design, or there are several.
    """
    path = only_run(Path(path))
    if path.is_dir() or is_run(path.parent) or path.name.startswith("test."):
        return original_of(read_run(path), str(path))
    blueprint, remarks = read_blueprint(path)
    if not isinstance(blueprint, Design):
        raise UsageError(f"{path} holds points and no design; only a design with segments can be changed")
    return Original(blueprint, world, setup, 0, str(path), remarks)


def original_of(run: Run, path: str) -> Original:
    """The Design of a Run that lies in a path.

    Raises:
        UsageError: it has none.
    """
    if run.design is None:
        raise UsageError(f"{path} was made from points and has no design; only a design can be changed")
    return Original(run.design, run.world, run.request.setup, run.seed, path)


def reject_used(out: Path) -> None:
    """UsageError where something lies in a folder already."""
    if out.is_dir() and any(out.iterdir()):
        raise UsageError(f"{out} is not empty; a changed road goes into a new folder: name another one")


def folder_for(words: str, seed: int, out: Path | None) -> Path:
    """A folder for the changed road that holds nothing yet.

    Raises:
        UsageError: it cannot be made, or something lies there.
    """
    if out is None:
        return new_folder(words, seed)
    try:
        out.mkdir(parents=True, exist_ok=True)
        reject_used(out)
    except OSError as error:
        raise UsageError(f"cannot use {out}: {error.strerror}; name another folder") from error
    return out


@dataclass(frozen=True)
class _Beside:
    """Puts the request and the pictures of the road as it was beside those of the new one."""

    card: bytes
    before: Run
    draw: Draw | None

    def of_run(self, run: Run, folder: Path) -> None:
        """Into the new run's folder."""
        (folder / CARD).write_bytes(self.card)
        if self.draw is not None:
            self.draw.of_run(run, folder)
            (folder / BEFORE).mkdir()
            self.draw.of_run(self.before, folder / BEFORE)

    def of_campaign(self, folder: Path) -> None:
        """Nothing: one road needs no overview."""


def write_edit(
    run: Run, before: Run, words: str, changes: Sequence[str], source: str, folder: Path, draw: Draw | None
) -> Path:
    """Write a changed road; gives back the folder of its Run.

    Args:
        run: of the changed road.
        before: the road as it was, not driven.
        words: the change request.
        changes: sentences.
        source: where the road as it was lies.
        folder: an empty one.
        draw: draws the pictures, before and after; None draws none.
    """
    card = {
        "request": words,
        "of": source,
        "changes": list(changes),
        "design_before": before.design and before.design.to_json(),
    }
    beside = _Beside(to_bytes(json_text(card)), before, draw)
    return write_run(replace(run, index=1), folder, beside)


__all__ = ["Original", "folder_for", "original", "original_of", "reject_used", "write_edit"]
