"""Tries small changes of the road around a failure, stores which of them make the failure disappear, and by
them joins groups of similar failures into distinct faults.

Failures that disappear with the same small change have the same cause, whatever their roads look like
elsewhere. A failure has disappeared if the car passes the test, or fails more than 30 m after the place of
the departure. A fault is a set of failures that disappear with one small change, while this change leaves the
failures of other faults as they are. Groups for which there is no such change belong to no fault.

DIR/faults/remedies/c01/0017.json    for each change, whether it removes the failure; null: the change does
                                     not apply to the road

For a folder of runs, the level c01/ is left out. A change makes some samples of a road longer or shorter and
changes their curvature or grade; the road after them moves accordingly. The changed road is built for one
drive only, so it may leave the map or overlap itself."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, combinations, pairwise
from pathlib import Path
from typing import Any, NamedTuple, Self, TypeVar

import numpy as np

from roadgpt.campaign.folder_record import kept_run
from roadgpt.campaign.model import NumberedTest
from roadgpt.errors import RoadGPTError, SimulatorError, UsageError, explained
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.reading import read_json
from roadgpt.road import Road, World
from roadgpt.run import Run, prove
from roadgpt.run.atomic import json_text, refuse_links, write_whole
from roadgpt_search.faults.failures import AROUND, STRAIGHT, LocatedFailure, bend_at
from roadgpt_search.faults.stability import outlasted

STEP = 0.5  # m, between samples


class Bend(NamedTuple):
    """A bend: the indices of its first and last sample."""

    first: int
    last: int


@dataclass(frozen=True, eq=False)
class Alignment:
    """Curvature and grade of a road at its samples; all arrays have shape ``(n,)``."""

    steps: Array  # distance from each sample to the one before, metres; 0 for the first
    curvature: Array  # 1/m, positive to the left; it changes linearly between samples
    grade: Array  # grade as a ratio; it changes linearly between samples

    @classmethod
    def of(cls, road: Road) -> Self:
        """Samples a road about every half metre."""
        stations = np.linspace(0.0, road.length, int(np.ceil(road.length / STEP)) + 1)
        return cls(np.diff(stations, prepend=0.0), road.curvature(stations), road.grade(stations))

    @property
    def stations(self) -> Array:
        """Stations of the samples, metres."""
        return np.cumsum(self.steps)

    def bends(self) -> list[Bend]:
        """Returns the bends in driving order: longest sequences of samples that curve to one side, with a
        radius below 250 m."""
        side = np.where(np.abs(self.curvature) > STRAIGHT, np.sign(self.curvature), 0.0)
        edges = [0, *(np.flatnonzero(np.diff(side)) + 1), len(side)]
        pieces = pairwise(edges)
        return [Bend(int(first), int(end) - 1) for first, end in pieces if side[first]]

    def widened(self, bend: Bend, factor: float) -> Self:
        """Returns a copy with radius and length of a bend times ``factor``; the bend turns as many
        degrees as before."""
        curvature = self.curvature.copy()
        curvature[bend.first : bend.last + 1] /= factor
        return replace(self.shortened(bend, factor), curvature=curvature)

    def shortened(self, bend: Bend, factor: float) -> Self:
        """Returns a copy with the length of a bend times ``factor``; below 1, the bend turns less."""
        steps = self.steps.copy()
        steps[bend.first + 1 : bend.last + 1] *= factor
        return replace(self, steps=steps)

    def eased(self, around: Bend, length: float) -> Self:
        """Returns a copy in which the curvature is averaged over ``length`` metres, from so far before a bend
        to so far after it."""
        count = 2 * round(length / STEP / 2)
        padded = np.pad(self.curvature, count // 2, mode="edge")
        mean = np.convolve(padded, np.ones(count + 1) / (count + 1), "valid")
        near = slice(max(0, around.first - count), around.last + count + 1)
        curvature = self.curvature.copy()
        curvature[near] = mean[near]
        return replace(self, curvature=curvature)

    def with_straight(self, bend: Bend, length: float) -> Self:
        """Returns a copy with a straight of ``length`` metres inserted before a bend."""
        count, at = round(length / STEP), bend.first
        straight = self.curvature.copy()
        straight[at] = 0.0
        return replace(
            self,
            steps=np.insert(self.steps, at + 1, np.full(count, STEP)),
            curvature=np.insert(straight, at, np.zeros(count)),
            grade=np.insert(self.grade, at, np.full(count, self.grade[at])),
        )

    def levelled(self, factor: float) -> Self | None:
        """Returns a copy in which all grades are multiplied by ``factor``; None for a level road."""
        is_hilly = np.abs(self.grade).max() > HILLY
        return replace(self, grade=self.grade * factor) if is_hilly else None

    def road(self, like: Road) -> Road:
        """Builds the road, with the same start position, start heading and start height as ``like``."""
        x, y = like.plan.at(np.array(0.0)).tolist()
        columns = (each.tolist() for each in (self.steps[1:], self.curvature[:-1], self.curvature[1:]))
        pieces = tuple(Piece(*each) for each in zip(*columns, strict=True))
        plan = PieceCurve(x, y, float(like.plan.heading(np.array(0.0))), pieces)
        height = float(like.elevation.height(np.array(0.0)))
        return Road(plan, GradeProfile(height, tuple(self.stations), tuple(self.grade)))


NEAR = 40.0  # m; a bend farther from the failing one, or from the departure, is not changed
FOLDER, REMEDY_FOLDER = "faults", "remedies"
HILLY = 0.01  # as a ratio; a road whose steepest grade is above this is not level


class FailurePlace(NamedTuple):
    """The alignment of a road, and the bends around the place where the car left its lane."""

    alignment: Alignment
    departure: int  # index of the sample at the departure
    bend: Bend | None  # the bend at the departure; None if the road is straight there
    before: Bend | None
    """The last bend that ends less than 40 m before ``bend`` (before the departure if ``bend`` is None); None
    if there is no such bend."""
    after: Bend | None  # the bend after ``bend``; None if none begins within 40 m after the departure


T = TypeVar("T")
Change = Callable[[FailurePlace], Alignment | None]  # None if the change does not apply


@dataclass(frozen=True)
class Remedy:
    """One small change of a road, or of the speed limit."""

    name: str  # kind and size, such as 'wider 15'
    sentence: str  # the change as text for users, which completes 'it disappears with ...'
    change: Change
    limit: float = 1.0  # factor of the speed limit

    @property
    def kind(self) -> str:
        """The kind of the change, such as 'wider'."""
        return self.name.split()[0]


def _remedies(percent: int, metres: int, flatter: float, grades: str) -> tuple[Remedy, ...]:
    """Returns a change of each kind: radii and speed limits by some percent, metres of straight or of
    averaged curvature, and grades times ``flatter``, which the name of the remedy calls ``grades``."""
    more, less, larger = 1 + percent / 100, 1 - percent / 100, f"a {percent} % larger radius of the bend"
    straight = f"{metres} m of straight between the bend and the one before"
    slopes = "half as steep" if flatter else "without slopes"

    def of_bend(change: Callable[[Alignment, Bend], Alignment], which: str = "bend") -> Change:
        return lambda its: None if (bend := getattr(its, which)) is None else change(its.alignment, bend)

    def widened(alignment: Alignment, bend: Bend) -> Alignment:
        return alignment.widened(bend, more)

    def apart(its: FailurePlace) -> Alignment | None:
        return its.before and its.bend and its.alignment.with_straight(its.bend, metres)

    shorter = of_bend(lambda alignment, bend: alignment.shortened(bend, less))
    eased = of_bend(lambda alignment, bend: alignment.eased(bend, metres))
    return (
        Remedy(f"wider {percent}", larger, of_bend(widened)),
        Remedy(f"shorter {percent}", f"a bend that turns {percent} % less", shorter),
        Remedy(f"eased {metres}", f"curvature that changes over {metres} m more", eased),
        Remedy(f"apart {metres}", straight, apart),
        Remedy(f"before {percent}", f"{larger} before", of_bend(widened, "before")),
        Remedy(f"after {percent}", f"{larger} after", of_bend(widened, "after")),
        Remedy(f"flatter {grades}", f"a road {slopes}", lambda its: its.alignment.levelled(flatter)),
        Remedy(f"slower {percent}", f"a speed limit {percent} % lower", lambda its: its.alignment, less),
    )


Removed = Mapping[str, bool | None]
"""For each change, by its name: whether it makes a failure disappear; None if the change does not apply."""
REMEDIES = (*_remedies(15, 10, 0.5, "half"), *_remedies(30, 20, 0.0, "no"))
"""All changes that are tried, the small ones of all kinds before the larger ones."""


def remedies_of(run: Run) -> Removed:
    """Drives a failing Run's road with each change, and returns which changes make the failure disappear.

    If a small change does, the larger one of its kind is not driven and counts as removing it, too. No change
    applies to a road with its own cross-section but no Design, since that is given by station."""
    road, verdict = run.road, run.verdict
    assert road is not None
    assert verdict is not None
    if road.profile is not None and run.design is None:
        return {remedy.name: None for remedy in REMEDIES}
    place = _place(run, float(verdict.at_s or 0.0))
    found: dict[str, bool | None] = {}
    by_kind: dict[str, bool | None] = {}
    for remedy in REMEDIES:
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
    tried = outlasted(lambda: _driven(run, road, world))
    if tried.outcome == "ERROR":  # the driver broke down, which is no way to pass a place
        return False
    if tried.verdict is None:
        return None
    return bool(tried.verdict.kept or (tried.verdict.at_s or 0.0) > passed)


def _driven(run: Run, road: Road, world: World) -> Run:
    tried = prove(road, run.seed, world, run.request.setup, run.index, despite_findings=True)
    if tried.is_lost:
        raise SimulatorError(tried.description)
    return tried


def try_remedies(folder: Path, failure: LocatedFailure) -> None:
    """Drives the road of a failure with each small change and stores the results in ``folder``, unless they
    are there."""
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
    """Returns the result in the data of a JSON file; None if there is no such file."""
    try:
        return result_in(read_json(path))
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise UsageError(f"{path} cannot be read ({error}); remove it, and it is made again") from error


def made_folder(place: Path) -> Path:
    """Makes the folder ``place`` inside ``DIR/faults``, unless it exists, and returns ``place``."""
    refuse_links(place, *(each for each in place.parents if FOLDER in (each.name, each.parent.name)))
    with explained(RoadGPTError, f"cannot make {place}", "make room there"):
        place.mkdir(parents=True, exist_ok=True)
    return place


WITHIN = 0.85  # smallest share of the pairs of failures in one fault that its change removes
JOINS = 0.7  # a group joins a fault if the fault's change removes more than this share of its tested failures
ACROSS = 0.2  # largest share of the pairs of failures from two faults that the change of either removes
MOST = 4  # faults of one driver in one world
FEWEST = 2  # smallest number of failures of a fault, unless there is only one group: one failure has no pairs
SMALL = len(REMEDIES) // 2  # index of the first of the larger changes
LARGER = 0.8  # weight of a failure that needs a larger change: small changes say more about the cause
EPS = 1e-9


TriedGroup = tuple[int, Sequence[Removed]]
"""The number of failures in a group of similar ones, and what removes each of those that were tested."""


def faults_by_remedy(groups: Sequence[TriedGroup]) -> list[str | None]:
    """Returns for each group the name of the change that defines its fault; None if the group belongs to no
    fault.

    Each change in a set defines one fault. Of the sets of one to four changes that keep ``WITHIN``,
    ``ACROSS`` and ``FEWEST``, the one whose faults have most failures is taken, where a failure that needs a
    larger change counts 0.8; of equally good ones that with the fewest and smallest changes."""
    sizes = np.array([size for size, _ in groups], float)
    shares = np.array([[_share(removed, remedy.name) for remedy in REMEDIES] for _, removed in groups])
    best: list[int | None] = [None] * len(groups)
    most = 0.0
    every = range(len(REMEDIES))
    for chosen in chain.from_iterable(combinations(every, count) for count in range(1, MOST + 1)):
        found = _assigned(shares, chosen)
        members = {at: [i for i, own in enumerate(found) if own == at] for at in found if at is not None}
        counts = {at: sizes[its].sum() for at, its in members.items()}
        value = float(sum(size * (1.0 if at < SMALL else LARGER) for at, size in counts.items()))
        is_seen_often = len(groups) == 1 or all(size >= FEWEST for size in counts.values())
        if value > most and is_seen_often and _is_apart(members, sizes, shares):
            best, most = found, value
    return [None if at is None else REMEDIES[at].name for at in best]


def _share(removed: Sequence[Removed], name: str) -> float:
    return sum(bool(each[name]) for each in removed) / len(removed) if removed else 0.0


def _assigned(shares: Array, chosen: Sequence[int]) -> list[int | None]:
    """Returns for each group the one of the chosen changes that removes most of it, more than ``JOINS``; None
    if there is none."""
    found: list[int | None] = []
    for row in shares:
        at = max(chosen, key=lambda one: (row[one], -one))
        found.append(at if row[at] > JOINS else None)
    return found


def _is_apart(members: Mapping[int, list[int]], sizes: Array, shares: Array) -> bool:
    """Tells whether the faults keep to ``WITHIN`` and ``ACROSS``; each group counts by its size."""

    def removed(at: int, by: int) -> float:
        return float(np.average(shares[members[at], by], weights=sizes[members[at]]))

    if any(removed(at, at) ** 2 < WITHIN - EPS for at in members):
        return False
    # a pair disappears with the change of either fault
    return all(
        1 - (1 - removed(one, other)) * (1 - removed(other, one)) <= ACROSS + EPS
        for one, other in combinations(members, 2)
    )
