"""Requires crests and dips to cause a vertical acceleration of the car of at most 3 m/s^2.

The vertical radius R of the parabola between two grades is 1 / (change of grade per metre). At speed v, the
vertical acceleration is v^2 / R. Where the description asks for a crest or a dip, accelerations of up to 1 g
are allowed; beyond that, the wheels would lose contact with the road.

v is the speed expected at this place: the car starts from rest, respects the speed limit and slows down only
for bends (``road.speed_profile.expected_speed``). Sources: ``docs/decisions/0028-vertical-radii.md``.
"""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.check.bumps import bumps_asked
from roadgpt.check.extremes import vertical_bends
from roadgpt.check.finding import Finding, findings_at
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World
from roadgpt.road.speed_profile import GRAVITY, expected_speed

MOST = 3.0  # m/s^2
STEP = 1.0  # m between the stations at which the expected speed is computed
ROUNDING = 1e-3  # of the limit


def inspect(road: Road, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the crest or dip that exceeds its limit by the largest factor, if there is one."""
    return findings_at("too_abrupt", road, abrupt_place(road, brief, world))


def abrupt_place(road: Road, brief: Brief | None, world: World) -> tuple[float, str] | None:
    """Returns the station in metres of the crest or dip that exceeds its limit by the largest factor, and
    what is wrong there; None if no crest or dip exceeds its limit.
    """
    begin, end, bend = vertical_bends(road)
    suspects = np.flatnonzero(np.abs(bend) * world.limits.speed_limit**2 > MOST * (1 + ROUNDING))
    if not suspects.size:
        return None
    s = np.linspace(0.0, road.length, max(1, round(road.length / STEP)) + 1)
    speed = expected_speed(road.curvature(s), road.grade(s), float(s[1]), world, road.profile)
    fastest = np.array([_fastest(s, speed, begin[i], end[i]) for i in suspects])
    felt = fastest**2 * np.abs(bend[suspects])
    if felt.max() <= MOST * (1 + ROUNDING):
        return None
    middle = (begin[suspects] + end[suspects]) / 2
    most = np.where(_inside(middle, bumps_asked(road, brief)), GRAVITY, MOST)
    worst = int((felt / most).argmax())
    if felt[worst] <= most[worst] * (1 + ROUNDING):
        return None
    said = _said(float(bend[suspects[worst]]), float(fastest[worst]), float(most[worst]))
    return float(middle[worst]), said


def _fastest(s: Array, speed: Array, begin: float, end: float) -> float:
    inner = speed[(s > begin) & (s < end)]
    return float(max(np.interp([begin, end], s, speed).max(), inner.max(initial=0.0)))


def _inside(s: Array, spans: list[tuple[float, float]]) -> Array:
    out = np.zeros(s.shape, bool)
    for first, last in spans:
        out |= (s >= first) & (s <= last)
    return out


def _said(bend: float, speed: float, most: float) -> str:
    what = "crest" if bend < 0 else "dip"
    felt = f"{speed**2 * abs(bend):.1f} m/s2 at the {3.6 * speed:.0f} km/h expected there"
    return (
        f"the vertical radius of the {what} is {1 / abs(bend):.1f} m, which is {felt}; "
        f"{speed**2 / most:.0f} m would be enough for {most:.3g} m/s2"
    )
