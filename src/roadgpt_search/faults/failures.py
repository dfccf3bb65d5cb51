"""Failures: why a car left its lane, in one sentence, and which failures are alike. No road is driven.

The friction coefficient that a bend requires is v^2 k / (g cos(grade) + v^2 c), with the speed v, the
curvature k, and the vertical curvature c (negative on a crest); source: R. Rajamani, Vehicle Dynamics and
Control, 2nd ed., 2.6. Superelevation changes numerator and denominator, see ``road.speed_profile``. k is the
curvature of the middle of the driven lane, not of the centre line.

Two failures are alike if their lanes have similar curvature and grade from 30 m before the departure to 30 m
after it. The lanes are aligned at the departures; the comparison allows a shift of up to 8 m. Clusters grow
by complete linkage, so any two failures of one cluster are alike; ``groups_of`` describes an exception for
more than 1000 failures. Each cluster is a group of similar failures; several groups may be one fault, see
``remedy``."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial.distance import cdist, squareform

from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.model import NumberedTest
from roadgpt.campaign.record import Record
from roadgpt.drive import Drive
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World
from roadgpt.run import Run
from roadgpt.verdict.verdict import Cause
from roadgpt_search.behaviour import curvature_of_lane

Way = Literal["wide", "inside", "off", "stopped", "late", "hit", "rule"]
"""The car ran wide of a bend, cut its inside, left a straight, came to a standstill, ran out of time, hit
somebody, or passed a stop sign, a red light or somebody who had priority."""

STRAIGHT = 1 / 250  # 1/m; a road that bends less is called straight
GRAVITY = 9.81  # m/s^2
BEFORE, AFTER = 25.0, 5.0  # m before and after the departure, where the bend is looked for
ENTRY = 0.5  # share of a bend's curvature at which it begins
JUST_BEFORE = 25.0  # m; if a bend to the other side was this near, a sentence names both
HILL = 0.02  # fraction of g that a crest takes or a dip adds; crests and dips below it are not mentioned
SET_OFF = 2.0  # m/s; a car that is slower where a bend begins has set off in it
SLOPE = 0.03  # grade as a ratio; grades below it are not mentioned


class Manner(NamedTuple):
    """The way in which a car failed, and the bend at which it failed."""

    way: Way
    side: Literal["left", "right"] | None
    """The side to which the road bends; None if the road is straight there, or if the car stopped or was too
    late."""
    radius: float | None  # smallest radius of the bend's centre line, metres; None if ``side`` is None


@dataclass(frozen=True)
class FailureReason:
    """The reason for a failure; lengths in metres, speeds in m/s."""

    way: Way
    sentence: str
    station: float
    radius: float | None
    side: Literal["left", "right"] | None  # radius and side of the bend, as in ``Manner``
    entered: float
    """Speed, m/s, at the beginning of the bend or at the lane departure, whichever came first. If the car
    stopped or was too late: the last speed of the drive."""
    needed: float
    """Largest friction coefficient required to follow the middle of the lane at the speeds driven; 0 if the
    car stopped or was too late. On level ground, 0.93 means a lateral acceleration of 0.93 g."""
    friction: float  # friction coefficient of the road
    grade: float  # grade of the road at the bend, as a ratio
    hill: float
    """Vertical acceleration from a crest (negative) or a dip (positive) at the speed driven, as a fraction
    of g."""


def reason_of(run: Run) -> FailureReason:
    """Returns the reason why a Run failed."""
    if run.verdict is None or run.drive is None or run.road is None or not run.verdict.failed:
        raise UsageError(f"road {run.index} did not fail; only failures have a reason")
    road, drive, verdict, world = run.road, run.drive, run.verdict, run.world
    station, friction = float(verdict.at_s or 0.0), world.site.friction
    how = manner_of(road, world, station, verdict.cause, verdict.side)
    if how.way in ("stopped", "late", "hit", "rule"):
        grade, speed, sentence = float(road.grade(station)), float(drive["speed"][-1]), verdict.description
        if how.way in ("stopped", "late"):
            what = "came to a standstill" if how.way == "stopped" else "was too slow to arrive in time"
            sentence = f"{what} after {station:.0f} m{_slope_text(grade, 0.0)}"
        elif verdict.first_contact:
            speed = verdict.first_contact.speed
        return FailureReason(how.way, sentence, station, None, None, speed, 0.0, friction, grade, 0.0)
    near, bend, place = bend_at(road, world, station)
    begin = _entry(road, world, place, bend)
    entered, speed = _speed_at(drive, min(begin, station)), _speed_at(drive, min(place, station))
    grade = float(road.grade(place))
    hill = speed**2 * float(np.mean(road.vertical_curvature(near))) / GRAVITY
    needed = _needed(road, drive, world, begin, station)
    slope = _slope_text(grade, hill)
    if how.radius is None:
        left = f"left a straight to the {verdict.side}"
        sentence = f"{left} at {speed * 3.6:.0f} km/h after {station:.0f} m{slope}"
    else:
        before = _after(road, begin, bend)
        did = "and ran wide" if how.way == "wide" else "and cut its inside"
        curve = f"a {how.side} bend of radius {how.radius:.0f} m"
        came, then = f"entered {curve} at {entered * 3.6:.0f} km/h{before}", "that speed"
        if entered < SET_OFF:
            came, then = f"set off in {curve}", "the speeds there"
        sentence = (
            f"{came}{slope} {did} after {station:.0f} m; at {then}, the middle of the lane needs a friction "
            f"coefficient of {needed:.2f}, and the road has {friction:.2f}"
        )
    return FailureReason(
        how.way, sentence, station, how.radius, how.side, entered, needed, friction, grade, hill
    )


def lane_curvature(road: Road, world: World, stations: Array) -> Array:
    """Returns the curvature, 1/m, of the middle of the driven lane at stations of the centre line."""
    return curvature_of_lane(road.curvature(stations), world.profile_of(road).middle(stations))


def bend_at(road: Road, world: World, station: float) -> tuple[Array, float, float]:
    """Returns where the lane bends most, from 25 m before to 5 m after a departure at ``station``: the
    stations searched, 0.5 m apart; the largest curvature of the lane, 1/m, positive to the left; and its
    station."""
    near = np.arange(max(0.0, station - BEFORE), min(road.length, station + AFTER) + 0.5, 0.5)
    bends = lane_curvature(road, world, near)
    tightest = int(np.argmax(np.abs(bends)))
    return near, float(bends[tightest]), float(near[tightest])


def manner_of(
    road: Road, world: World, station: float, cause: Cause | None, left_to: Literal["left", "right"] | None
) -> Manner:
    """Derives how a car failed from the road, the station of the departure in metres, the cause, and the side
    to which the car left its lane. The recorded drive is not needed."""
    if cause in ("stuck", "timeout"):
        return Manner("stopped" if cause == "stuck" else "late", None, None)
    if cause in ("collision", "stop line", "red light", "failure to yield"):
        return Manner("hit" if cause == "collision" else "rule", None, None)
    _, bend, place = bend_at(road, world, station)
    if abs(bend) < STRAIGHT:
        return Manner("off", None, None)
    side: Literal["left", "right"] = "left" if bend > 0 else "right"
    return Manner("inside" if left_to == side else "wide", side, 1 / float(np.abs(road.curvature(place))))


def _needed(road: Road, drive: Drive, world: World, begin: float, station: float) -> float:
    """Returns the largest friction coefficient that the middle of the lane requires up to the departure."""
    on = (drive["s"] >= min(begin, station)) & (drive["s"] <= station)
    if not on.any():
        on[-1] = True
    s, squared = drive["s"][on], drive["speed"][on] ** 2
    steep, bend = np.cos(np.arctan(road.grade(s))), lane_curvature(road, world, s)
    inwards = -np.copysign(1.0, bend) * world.profile_of(road).superelevation(np.clip(s, 0.0, road.length))
    cos, sin, bend = np.cos(inwards), np.sin(inwards), squared * np.abs(bend) / GRAVITY
    pressed = steep * cos + bend * sin + squared * road.vertical_curvature(s) / GRAVITY
    asked = np.abs(bend * cos - steep * sin) / np.maximum(pressed, 0.05)
    return float(asked.max())


def _entry(road: Road, world: World, place: float, bend: float) -> float:
    """Returns the station where the bend around a place begins: there, its curvature falls below half of
    ``bend``. The search goes back 60 m at most."""
    back = np.arange(place, max(0.0, place - 60.0) - 0.5, -0.5)
    before = lane_curvature(road, world, np.maximum(back, 0.0)) * math.copysign(1.0, bend)
    softer = np.flatnonzero(before < ENTRY * abs(bend))
    return float(max(back[softer[0]] if len(softer) else back[-1], 0.0))


def _after(road: Road, begin: float, bend: float) -> str:
    """Describes a bend to the other side within 25 m before ``begin``; returns '' if there is none."""
    back = np.arange(max(0.0, begin - JUST_BEFORE), begin, 0.5)
    if not len(back):
        return ""
    against = -road.curvature(back) * math.copysign(1.0, bend)
    most = float(against.max())
    if most < max(STRAIGHT, abs(bend) / 4):
        return ""
    return f" just after a {'right' if bend > 0 else 'left'} bend of radius {1 / most:.0f} m"


def _slope_text(grade: float, hill: float) -> str:
    if abs(hill) >= HILL:
        return " on a crest" if hill < 0 else " in a dip"
    if abs(grade) >= SLOPE:
        return f" {'uphill' if grade > 0 else 'downhill'} at {abs(grade) * 100:.0f} %"
    return ""


def _speed_at(drive: Drive, station: float) -> float:
    reached = np.flatnonzero(drive["s"] >= station)
    return float(drive["speed"][reached[0] if len(reached) else -1])


AROUND = 30.0  # m, the competition's, before and after the departure
STEP = 1.0  # m
SHIFT = 8  # steps that two profiles may be moved against each other
SMOOTHING = 5  # steps, half-width of the Hann window that smooths profiles: about the length of a car
ALIKE = 1.0  # distance up to which two failures belong to one group
BEND = 0.012  # 1/m, RMS difference in curvature that counts 1 (R 15 m against R 18 m all along)
GRADE = 0.04  # RMS difference in grade, as a ratio, that counts 1
COUNT = round(AROUND / STEP)
MOST = 1000  # failures clustered at a time; comparing all pairs takes 1 s and memory for a million numbers


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The lane around a departure, sampled every metre."""

    bends: Array
    """Smoothed curvature of the lane, 1/m; NaN beyond the ends of the road. The array extends ``SHIFT``
    values beyond the compared part at either end."""
    grades: Array  # smoothed grade as a ratio, at the same stations; NaN beyond the ends of the road
    kind: str  # cause and side of the failure, driver, simulator and world as text; a group has one kind


def surroundings(road: Road, world: World, station: float, kind: str) -> Surroundings:
    """Returns the lane around a departure at ``station``, metres along the road."""
    reach = COUNT + SHIFT + SMOOTHING
    s = station + STEP * np.arange(-reach, reach + 1)
    on = (s >= 0) & (s <= road.length)
    held = np.clip(s, 0.0, road.length)
    bends, grades = np.where(on, lane_curvature(road, world, held), 0.0), road.grade(held)
    inner = on[SMOOTHING:-SMOOTHING]
    return Surroundings(
        np.where(inner, _smoothed(bends), np.nan), np.where(inner, _smoothed(grades), np.nan), kind
    )


def _smoothed(values: Array) -> Array:
    window = np.hanning(2 * SMOOTHING + 3)[1:-1]
    return np.convolve(values, window / window.sum(), mode="valid")


def between(some: Sequence[Surroundings], others: Sequence[Surroundings]) -> Array:
    """Returns the distances ``(len(some), len(others))`` between the failures of two lists: the root of the
    sum of the squared RMS differences in curvature, in units of ``BEND``, and in grade, in units of
    ``GRADE``. Beyond its ends, a road counts as straight and level; failures of different ``kind`` are
    infinitely apart."""
    least = np.full((len(some), len(others)), np.inf)
    if not least.size:
        return least
    one, other = _stacked(some), _stacked(others)
    count = one.shape[-1] - 2 * SHIFT
    for shift in range(-SHIFT, SHIFT + 1):
        # each profile is moved by half of the shift, so that distances are symmetric
        starts = SHIFT + shift // 2, SHIFT + shift // 2 - shift
        (bends, grades, beyond), (bends_, grades_, beyond_) = (
            each[..., start : start + count] for each, start in zip((one, other), starts, strict=True)
        )
        apart = (
            cdist(bends, bends_, "sqeuclidean") / BEND**2 + cdist(grades, grades_, "sqeuclidean") / GRADE**2
        )
        # averaged over the stations at which at least one of the two roads exists
        np.minimum(least, apart / (count - beyond @ beyond_.T), out=least)
    kinds, their_kinds = (np.array([each.kind for each in them], object) for them in (some, others))
    alike = np.equal.outer(kinds, their_kinds)
    return np.where(alike, np.sqrt(least), np.inf)


def _stacked(them: Sequence[Surroundings]) -> Array:
    """Returns an array ``(3, n, stations)``: the bends and the grades, both 0 beyond the ends of a road, and
    1 where there is no road."""
    bends, grades = (np.stack([getattr(each, name) for each in them]) for name in ("bends", "grades"))
    return np.stack([np.nan_to_num(bends), np.nan_to_num(grades), np.isnan(bends)])


def groups_of(failures: Sequence[Surroundings], alike: float = ALIKE, most: int = MOST) -> list[int]:
    """Returns for each failure the number of its group; groups are numbered from 0 by their first failure.

    Two failures of a group are at most ``alike`` apart. At most ``most`` are clustered at a time; each later
    one joins the group whose most typical failure is nearest and alike, and those that join none are
    clustered next."""
    found, left, count = np.full(len(failures), -1), np.arange(len(failures)), 0
    while len(left):
        now, left = left[:most], left[most:]
        some = [failures[i] for i in now]
        grown = _grown(some, alike)
        found[now] = grown + count
        middles = []
        for cluster in range(grown.max() + 1) if len(left) else ():
            members = [each for each, own in zip(some, grown, strict=True) if own == cluster]
            middles.append(members[typical(members)[0]])
        for start in range(0, len(left), most):
            block = left[start : start + most]
            apart = between([failures[i] for i in block], middles)
            near = apart.min(axis=1) <= alike
            found[block[near]] = apart.argmin(axis=1)[near] + count
        left = left[found[left] < 0]
        count += int(grown.max()) + 1
    numbers: dict[int, int] = {}
    return [numbers.setdefault(int(cluster), len(numbers)) for cluster in found]


def _grown(some: Sequence[Surroundings], alike: float) -> NDArray[np.intp]:
    if len(some) < 2:
        return np.zeros(len(some), int)
    far = 1e6  # stands for infinity, which linkage does not take
    apart = np.minimum(between(some, some), far)
    apart = (apart + apart.T) / 2
    np.fill_diagonal(apart, 0.0)
    return np.asarray(fcluster(linkage(squareform(apart), "complete"), alike, "distance"), np.intp) - 1


def typical(members: Sequence[Surroundings]) -> list[int]:
    """Returns the indices of the failures of one group by their sum of squared distances to the others, the
    smallest first. Of more than 1000 failures, only the first 1000 are compared and returned."""
    some = members[:MOST]
    squares = between(some, some) ** 2
    return [int(i) for i in np.argsort(np.round(squares.sum(axis=1), 9), kind="stable")]


AT_ONCE = 500  # tests that are read from a store with one query


@dataclass(frozen=True, eq=False)
class LocatedFailure:
    """A failure, and where on the road it occurred."""

    name: NumberedTest
    around: Surroundings
    system: str
    """Text that identifies driver, simulator and world; failures with different texts are never joined."""
    manner: Manner
    station: float  # station of the failure, metres along the road
    outside: float | None  # largest share of the car that was outside its lane at one time, 0 to 1
    beyond: float | None  # largest distance of the car's body beyond the lane marking, metres


def failures_of(folder: Path, most: int | None = None, cell: str = "") -> tuple[list[LocatedFailure], int]:
    """Returns the failures of a run, a folder of runs, or a campaign, cell by cell: at most ``most``, evenly
    spread. The number beside them also counts those left out, and those whose road cannot be built."""
    with open_record(folder) as record:
        names = record.query(
            "SELECT cell, number FROM tests WHERE outcome = 'FAIL' AND (? = '' OR cell = ?) "
            "ORDER BY cell, number",
            (cell, cell),
        )
        count = len(names) if most is None else min(most, len(names))
        some = [NumberedTest(*names[int(at)]) for at in np.linspace(0, len(names) - 1, count)]
        return [*_located(record, some)], len(names)


def _located(record: Record, some: Sequence[NumberedTest]) -> Iterator[LocatedFailure]:
    """Yields those of the failures, which are sorted by cell, whose road can be built."""
    cells = {cell.name: cell for cell in record.cells()}
    for name, tests in groupby(some, key=lambda each: each.cell):
        cell, every = cells[name], [each.number for each in tests]
        asked, setup = cell.request.world, cell.request.setup
        system = f"{setup.driver} {setup.simulator} {setup.keep_driving} {asked.model_dump_json()}"
        for start in range(0, len(every), AT_ONCE):
            numbers = every[start : start + AT_ONCE]
            where = f"tests.number IN ({', '.join('?' * len(numbers))})"
            for its in record.results(name, where, numbers):
                try:
                    found = record.road(cell, its)
                except RoadGPTError:  # the version that made the road could build it; this one cannot
                    continue
                if found is None:
                    continue
                road, world, station = found[0], found[1].world, its.at_s or 0.0
                whose = f"{system} {its.handed_to or ''}"
                around = surroundings(road, world, station, f"{its.cause} {its.side} {whose}")
                manner = manner_of(road, world, station, its.cause, its.side)
                test = NumberedTest(name, its.number)
                yield LocatedFailure(test, around, whose, manner, station, its.max_oob, its.beyond)
