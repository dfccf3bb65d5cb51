"""Stores which small changes remove a failure, so that no drive is repeated.

DIR/faults/remedies/c01/0017.json    for each change, whether it removes the failure; null: the change does
                                     not apply to the road

For a folder of runs, the level c01/ is left out.
"""

from pathlib import Path
from typing import NamedTuple

from roadgpt.campaign.faults.failures import LocatedFailure
from roadgpt.campaign.faults.remedy import REMEDIES, Removed, remedies_of
from roadgpt.campaign.numbered_test import NumberedTest
from roadgpt.campaign.rerun import kept_run
from roadgpt.errors import RoadGPTError, UsageError, explained
from roadgpt.reading import read_json
from roadgpt.run.atomic import json_text, refuse_links, write_whole

FOLDER = "faults"
REMEDY_FOLDER = "remedies"


class RemedyTask(NamedTuple):
    """One failure on which the small changes are tried; the task can be sent to another process."""

    folder: Path
    name: NumberedTest
    station: float
    """Station of the failure, metres along the road."""


def try_remedies(task: RemedyTask) -> NumberedTest:
    """Drives the road of a failure with each small change and stores the results, unless they are stored
    already; returns the name of the test.

    Raises:
        UsageError: the run or a stored file cannot be read, or a plug-in is not installed.
        GivenUpError: the simulator failed three times in a row.
        RoadGPTError: a file cannot be written.
    """
    if stored_remedies(task) is None:
        removed = remedies_of(kept_run(task.folder, *task.name))
        path = _page(task)
        made_folder(path.parent)
        write_whole(path, json_text({"station": task.station, "removed": dict(removed)}))
    return task.name


def stored_remedies(task: RemedyTask) -> Removed | None:
    """Returns the stored results for a failure; None if there are none, or if they belong to another road or
    other changes.

    Raises:
        UsageError: the file cannot be read.
    """
    path = _page(task)
    try:
        data = read_json(path)
        removed = {str(name): None if gone is None else bool(gone) for name, gone in data["removed"].items()}
        is_this = float(data["station"]) == task.station
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise UsageError(f"{path} cannot be read ({error}); remove it, and it is made again") from error
    return removed if is_this and removed.keys() == {remedy.name for remedy in REMEDIES} else None


def has_remedies(folder: Path) -> bool:
    """Tells whether small changes were tried on any failure of a folder."""
    return (folder / FOLDER / REMEDY_FOLDER).is_dir()


def task_of(folder: Path, failure: LocatedFailure) -> RemedyTask:
    """Returns the RemedyTask that tries the small changes on a failure."""
    return RemedyTask(folder, failure.name, failure.station)


def _page(task: RemedyTask) -> Path:
    return task.folder / FOLDER / REMEDY_FOLDER / task.name.cell / f"{task.name.number:04d}.json"


def made_folder(place: Path) -> Path:
    """Makes the folder ``place`` inside ``DIR/faults``, unless it exists, and returns ``place``.

    Raises:
        RoadGPTError: the folder cannot be made, or a part of its path from ``faults`` on is a symbolic link.
    """
    refuse_links(place, *(each for each in place.parents if FOLDER in (each.name, each.parent.name)))
    with explained(RoadGPTError, f"cannot make {place}", "make room there"):
        place.mkdir(parents=True, exist_ok=True)
    return place
