"""Tries small changes of the road around a failure, and finds which of them make the failure disappear.

Failures that disappear with the same small change have the same cause, whatever their roads look like
elsewhere. A failure has disappeared if the car passes the test, or fails more than 30 m after the place of
the departure.
"""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from roadgpt.campaign.faults.alignment import Alignment, Bend
from roadgpt.campaign.faults.distinct import AROUND
from roadgpt.campaign.faults.reason import bend_at
from roadgpt.road import Road, World
from roadgpt.run import Run, prove
from roadgpt.run.lost_drives import LostDrives

NEAR = 40.0  # m; a bend farther from the failing one, or from the departure, is not changed
HILLY = 0.01  # as a ratio; a road whose steepest grade is above this is not level


class FailurePlace(NamedTuple):
    """The alignment of a road, and the bends around the place where the car left its lane."""

    alignment: Alignment
    departure: int
    """Index of the sample at the departure."""
    bend: Bend | None
    """The bend at the departure; None if the road is straight there."""
    before: Bend | None
    """The bend before ``bend``, or before the departure if ``bend`` is None; None if none ends within 40 m
    before that.
    """
    after: Bend | None
    """The bend after ``bend``; None if none begins within 40 m after the departure."""


@dataclass(frozen=True)
class Remedy:
    """One small change of a road, or of the speed limit."""

    name: str
    """Kind and size, such as 'wider 15'."""
    sentence: str
    """The change as text for users, which completes 'it disappears with ...'."""
    change: Callable[[FailurePlace], Alignment | None]
    """Returns the changed alignment; None if the change does not apply."""
    limit: float = 1.0
    """Factor of the speed limit."""

    @property
    def kind(self) -> str:
        """The kind of the change, such as 'wider'."""
        return self.name.split()[0]


def _remedies(percent: int, metres: int, flatter: float, grades: str) -> Iterator[Remedy]:
    """Yields a change of each kind.

    Args:
        percent: by how much a radius becomes larger, a bend shorter, and a speed limit lower.
        metres: length of a straight that is inserted, and over which curvature is averaged.
        flatter: factor of the grades.
        grades: the size of the changed grades, as text: 'half' or 'no'.
    """
    more, less = 1 + percent / 100, 1 - percent / 100

    def wider(bend: Bend | None, alignment: Alignment) -> Alignment | None:
        return alignment.widened(bend, more) if bend else None

    def is_hilly(place: FailurePlace) -> bool:
        return bool(np.abs(place.alignment.grade).max() > HILLY)

    yield Remedy(
        f"wider {percent}",
        f"a {percent} % larger radius of the bend",
        lambda its: wider(its.bend, its.alignment),
    )
    yield Remedy(
        f"shorter {percent}",
        f"a bend that turns {percent} % less",
        lambda its: its.alignment.shortened(its.bend, less) if its.bend else None,
    )
    yield Remedy(
        f"eased {metres}",
        f"curvature that changes over {metres} m more",
        lambda its: its.alignment.eased(its.bend, metres) if its.bend else None,
    )
    yield Remedy(
        f"apart {metres}",
        f"{metres} m of straight between the bend and the one before",
        lambda its: its.alignment.with_straight(its.bend, metres) if its.bend and its.before else None,
    )
    yield Remedy(
        f"before {percent}",
        f"a {percent} % larger radius of the bend before",
        lambda its: wider(its.before, its.alignment),
    )
    yield Remedy(
        f"after {percent}",
        f"a {percent} % larger radius of the bend after",
        lambda its: wider(its.after, its.alignment),
    )
    yield Remedy(
        f"flatter {grades}",
        f"{grades} grades",
        lambda its: its.alignment.levelled(flatter) if is_hilly(its) else None,
    )
    yield Remedy(f"slower {percent}", f"a speed limit {percent} % lower", lambda its: its.alignment, less)


Removed = Mapping[str, bool | None]
"""By name of the change: whether a failure disappears with it; None if the change does not apply."""
REMEDIES = (*_remedies(15, 10, 0.5, "half"), *_remedies(30, 20, 0.0, "no"))
"""All changes that are tried, the small ones of all kinds before the larger ones."""
KINDS = frozenset(remedy.kind for remedy in REMEDIES)


def remedies_of(run: Run, kinds: Collection[str] = KINDS) -> Removed:
    """Drives a failing Run's road with each change, and returns which changes make the failure disappear.

    If a small change removes the failure, the larger change of the same kind is not driven and counts as
    removing the failure, too. No change applies to a road that has its own cross-section but no Design,
    because the cross-section is given by station.

    Args:
        run: the Run of the failing test.
        kinds: kinds of changes to try.

    Returns:
        For each change, by its name, whether it removes the failure; None if the change does not apply, for
        example because there is no bend before the failure.

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
