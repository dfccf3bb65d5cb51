"""Explains in one sentence why a car left its lane: the bend, the speed and the slope where it happened.

The friction coefficient that a bend requires is v^2 k / (g cos(grade) + v^2 c), with the speed v, the
curvature k, and the vertical curvature c (negative on a crest); source: R. Rajamani, Vehicle Dynamics and
Control, 2nd ed., 2.6. Superelevation changes numerator and denominator, see ``road.speed_profile``. k is the
curvature of the middle of the driven lane, not of the centre line.
"""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from roadgpt.drive import Drive
from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World
from roadgpt.run import Run
from roadgpt.verdict.verdict import Cause

Way = Literal["wide", "inside", "off", "stopped", "late"]
"""The car ran wide of a bend, cut its inside, left a straight, came to a standstill, or ran out of time."""

STRAIGHT = 1 / 250  # 1/m; a road that bends less is called straight
GRAVITY = 9.81  # m/s^2
BEFORE, AFTER = 25.0, 5.0  # m before and after the departure, where the bend is looked for
ENTRY = 0.5  # share of a bend's curvature at which it begins
JUST_BEFORE = 25.0  # m; if a bend to the other side was this near, a sentence names both
HILL = 0.02  # fraction of g that a crest takes or a dip adds; crests and dips below it are not mentioned
SLOPE = 0.03  # grade as a ratio; grades below it are not mentioned


class Manner(NamedTuple):
    """The way in which a car failed, and the bend at which it failed."""

    way: Way
    side: Literal["left", "right"] | None
    """The side to which the road bends; None if the road is straight there, or if the car stopped or was too
    late.
    """
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
    stopped or was too late: the last speed of the drive.
    """
    needed: float
    """Largest friction coefficient required to follow the middle of the lane at the speeds driven; 0 if the
    car stopped or was too late. On level ground, 0.93 means a lateral acceleration of 0.93 g.
    """
    friction: float  # friction coefficient of the road
    grade: float  # grade of the road at the bend, as a ratio
    hill: float
    """Vertical acceleration from a crest (negative) or a dip (positive) at the speed driven, as a fraction
    of g.
    """


def reason_of(run: Run) -> FailureReason:
    """Returns the reason why a Run failed."""
    if run.verdict is None or run.drive is None or run.road is None or run.verdict.kept:
        raise UsageError(f"road {run.index} did not fail; only failures have a reason")
    road, drive, verdict, world = run.road, run.drive, run.verdict, run.world
    station, friction = float(verdict.at_s or 0.0), world.site.friction
    how = manner_of(road, world, station, verdict.cause, verdict.side)
    if how.way in ("stopped", "late"):
        grade, speed = float(road.grade(station)), float(drive["speed"][-1])
        what = "came to a standstill" if how.way == "stopped" else "was too slow to arrive in time"
        sentence = f"{what} after {station:.0f} m{_slope_text(grade, 0.0)}"
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
        sentence = (
            f"entered a {how.side} bend of radius {how.radius:.0f} m at {entered * 3.6:.0f} km/h{before}"
            f"{slope} {did} after {station:.0f} m; at that speed, the middle of the lane needs a friction "
            f"coefficient of {needed:.2f}, and the road has {friction:.2f}"
        )
    return FailureReason(
        how.way, sentence, station, how.radius, how.side, entered, needed, friction, grade, hill
    )


def lane_curvature(road: Road, world: World, stations: Array) -> Array:
    """Returns the curvature, 1/m, of the middle of the driven lane at stations of the centre line."""
    bend = road.curvature(stations)
    middle = world.profile_of(road).middle(stations)
    return np.asarray(bend / np.maximum(1 - bend * middle, 0.2))


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
