"""Tries small changes of the road around a failure, and stores which of them make the failure disappear.

Failures that disappear with the same small change have the same cause, whatever their roads look like
elsewhere. A failure has disappeared if the car passes the test, or fails more than 30 m after the place of
the departure.

DIR/faults/remedies/c01/0017.json    for each change, whether it removes the failure; null: the change does
                                     not apply to the road

For a folder of runs, the level c01/ is left out.
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

import numpy as np

from roadgpt.campaign.faults.alignment import Alignment, Bend
from roadgpt.campaign.faults.distinct import AROUND
from roadgpt.campaign.faults.failures import LocatedFailure
from roadgpt.campaign.faults.reason import bend_at
from roadgpt.campaign.model import NumberedTest
from roadgpt.campaign.rerun import kept_run
from roadgpt.errors import RoadGPTError, UsageError, explained
from roadgpt.reading import read_json
from roadgpt.road import Road, World
from roadgpt.run import Run, prove
from roadgpt.run.atomic import json_text, refuse_links, write_whole
from roadgpt.run.lost_drives import LostDrives

NEAR = 40.0  # m; a bend farther from the failing one, or from the departure, is not changed
FOLDER, REMEDY_FOLDER = "faults", "remedies"
HILLY = 0.01  # as a ratio; a road whose steepest grade is above this is not level


class FailurePlace(NamedTuple):
    """The alignment of a road, and the bends around the place where the car left its lane."""

    alignment: Alignment
    departure: int
    """Index of the sample at the departure."""
    bend: Bend | None
    """The bend at the departure; None if the road is straight there."""
    before: Bend | None
    """The last bend that ends less than 40 m before ``bend`` (before the departure if ``bend`` is None); None
    if there is no such bend.
    """
    after: Bend | None
    """The bend after ``bend``; None if none begins within 40 m after the departure."""


T = TypeVar("T")

Change = Callable[[FailurePlace], Alignment | None]


@dataclass(frozen=True)
class Remedy:
    """One small change of a road, or of the speed limit."""

    name: str
    """Kind and size, such as 'wider 15'."""
    sentence: str
    """The change as text for users, which completes 'it disappears with ...'."""
    change: Change
    """Returns the changed alignment; None if the change does not apply."""
    limit: float = 1.0
    """Factor of the speed limit."""

    @property
    def kind(self) -> str:
        """The kind of the change, such as 'wider'."""
        return self.name.split()[0]


def _of_bend(
    bend_of: Callable[[FailurePlace], Bend | None],
    change: Callable[[Alignment, Bend, float], Alignment],
    size: float,
) -> Change:
    """Returns a change of one of the bends of a FailurePlace, which applies if there is such a bend."""

    def changed(place: FailurePlace) -> Alignment | None:
        bend = bend_of(place)
        return change(place.alignment, bend, size) if bend else None

    return changed


def _remedies(percent: int, metres: int, flatter: float, grades: str) -> Iterator[Remedy]:
    """Yields a change of each kind: radii and speed limits by some percent, metres of straight or of averaged
    curvature, and grades times ``flatter``, which the name of the remedy calls ``grades``."""
    more, less = 1 + percent / 100, 1 - percent / 100
    bigger = f"a {percent} % larger radius of the bend"

    def apart(place: FailurePlace) -> Alignment | None:
        return place.alignment.with_straight(place.bend, metres) if place.bend and place.before else None

    def flat(place: FailurePlace) -> Alignment | None:
        is_hilly = np.abs(place.alignment.grade).max() > HILLY
        return place.alignment.levelled(flatter) if is_hilly else None

    def here(change: Callable[[Alignment, Bend, float], Alignment], size: float) -> Change:
        return _of_bend(lambda place: place.bend, change, size)

    before = _of_bend(lambda place: place.before, Alignment.widened, more)
    after = _of_bend(lambda place: place.after, Alignment.widened, more)
    yield Remedy(f"wider {percent}", bigger, here(Alignment.widened, more))
    yield Remedy(
        f"shorter {percent}",
        f"a bend that turns {percent} % less",
        here(Alignment.shortened, less),
    )
    yield Remedy(
        f"eased {metres}",
        f"curvature that changes over {metres} m more",
        here(Alignment.eased, metres),
    )
    yield Remedy(f"apart {metres}", f"{metres} m of straight between the bend and the one before", apart)
    yield Remedy(f"before {percent}", f"{bigger} before", before)
    yield Remedy(f"after {percent}", f"{bigger} after", after)
    yield Remedy(f"flatter {grades}", f"a road {'half as steep' if flatter else 'without slopes'}", flat)
    yield Remedy(f"slower {percent}", f"a speed limit {percent} % lower", lambda its: its.alignment, less)


Removed = Mapping[str, bool | None]
"""For each change, by its name: whether it makes a failure disappear; None if the change does not apply."""
REMEDIES = (*_remedies(15, 10, 0.5, "half"), *_remedies(30, 20, 0.0, "no"))
"""All changes that are tried, the small ones of all kinds before the larger ones."""
KINDS = frozenset(remedy.kind for remedy in REMEDIES)


def remedies_of(run: Run, kinds: Collection[str] = KINDS) -> Removed:
    """Drives a failing Run's road with each change, and returns which changes make the failure disappear.

    If a small change removes the failure, the larger change of the same kind is not driven and counts as
    removing the failure, too. Some changes do not apply, for example if there is no bend before the failure.
    No change applies to a road with its own cross-section but no Design, because such a cross-section is
    given by station.

    Raises:
        UsageError: the driver or the simulator cannot be loaded.
        GivenUpError: the simulator failed three times in a row.
    """
    road, verdict = run.road, run.verdict
    assert road is not None
    assert verdict is not None
    remedies = [remedy for remedy in REMEDIES if remedy.kind in kinds]
    if road.profile is not None and run.design is None:
        return {remedy.name: None for remedy in remedies}
    place = _place(run, float(verdict.at_s or 0.0))
    found: dict[str, bool | None] = {}
    by_kind: dict[str, bool | None] = {}
    for remedy in remedies:
        if not by_kind.get(remedy.kind):
            by_kind[remedy.kind] = _removes(run, place, remedy)
        found[remedy.name] = by_kind[remedy.kind]
    return found


def _place(run: Run, station: float) -> FailurePlace:
    assert run.road is not None
    alignment = Alignment.of(run.road)
    stations, bends = alignment.stations, alignment.bends()
    departure = int(np.argmin(np.abs(stations - station)))
    _, _, tightest = bend_at(run.road, run.world, station)
    at = int(np.argmin(np.abs(stations - tightest)))
    here = next((bend for bend in bends if bend.first <= at <= bend.last), None)
    begin, end = (here.first, here.last) if here else (departure, departure)
    before = [each for each in bends if each.last < begin and stations[begin] - stations[each.last] < NEAR]
    after = [each for each in bends if each.first > end and stations[each.first] - station < NEAR]
    return FailurePlace(
        alignment, departure, here, before[-1] if before else None, after[0] if after else None
    )


def _removes(run: Run, place: FailurePlace, remedy: Remedy) -> bool | None:
    changed = remedy.change(place)
    if changed is None:
        return None
    assert run.road is not None
    longer = len(changed.steps) - len(place.alignment.steps)  # samples inserted before the bend
    is_behind = place.bend is not None and place.departure >= place.bend.first
    passed = changed.stations[place.departure + longer * is_behind] + AROUND
    road = changed.road(run.road)
    world = run.world.changed(speed_limit=run.world.limits.speed_limit * remedy.limit)
    tried = _driven(run, road, world)
    if tried.outcome == "ERROR":  # the driver broke down, which is no way to pass a place
        return False
    if tried.verdict is None:
        return None
    return bool(tried.verdict.kept or (tried.verdict.at_s or 0.0) > passed)


def _driven(run: Run, road: Road, world: World) -> Run:
    """Drives a changed road; drives again where the simulator itself failed."""
    losses: LostDrives[int] = LostDrives()
    while True:
        tried = prove(road, run.seed, world, run.request.setup, run.index, despite_findings=True)
        if losses.count(run.index, tried.is_lost):
            raise losses.given_up(tried.description, "fix it and run the same command again, which continues")
        if not tried.is_lost:
            return tried


def try_remedies(folder: Path, failure: LocatedFailure) -> None:
    """Drives the road of a failure with each small change and stores the results in ``folder``. Does nothing
    if the results are stored already. Raises the errors of ``remedies_of``, and RoadGPTError if a file cannot
    be written."""
    if stored_remedies(folder, failure) is None:
        removed = remedies_of(kept_run(folder, *failure.name))
        path = page_of(folder / FOLDER / REMEDY_FOLDER, failure.name)
        made_folder(path.parent)
        write_whole(path, json_text({"station": failure.station, "removed": dict(removed)}))


def stored_remedies(folder: Path, failure: LocatedFailure) -> Removed | None:
    """Returns the stored results for a failure; None if there are none, or if they belong to another road or
    other changes."""

    def removed_in(data: Any) -> Removed | None:
        removed = {str(name): None if gone is None else bool(gone) for name, gone in data["removed"].items()}
        is_this = float(data["station"]) == failure.station
        return removed if is_this and removed.keys() == {remedy.name for remedy in REMEDIES} else None

    return stored(page_of(folder / FOLDER / REMEDY_FOLDER, failure.name), removed_in)


def has_remedies(folder: Path) -> bool:
    """Tells whether small changes were tried on any failure of a folder."""
    return (folder / FOLDER / REMEDY_FOLDER).is_dir()


def page_of(place: Path, name: NumberedTest) -> Path:
    """Returns the path of the stored results for a test."""
    return place / name.cell / f"{name.number:04d}.json"


def stored(path: Path, result_in: Callable[[Any], T]) -> T | None:
    """Returns the result in the data of a JSON file; None if there is no such file.

    Raises:
        UsageError: the file cannot be read.
    """
    try:
        return result_in(read_json(path))
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise UsageError(f"{path} cannot be read ({error}); remove it, and it is made again") from error


def made_folder(place: Path) -> Path:
    """Makes the folder ``place`` inside ``DIR/faults``, unless it exists, and returns ``place``.

    Raises:
        RoadGPTError: the folder cannot be made, or a part of its path from ``faults`` on is a symbolic link.
    """
    refuse_links(place, *(each for each in place.parents if FOLDER in (each.name, each.parent.name)))
    with explained(RoadGPTError, f"cannot make {place}", "make room there"):
        place.mkdir(parents=True, exist_ok=True)
    return place
