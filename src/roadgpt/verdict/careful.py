"""Four models of drivers who brake for somebody else on the road, and do nothing but brake.

- careful driver: the "competent and careful human driver" of UN Regulation No. 157, Annex 4, Appendix 3: it
  takes its foot off the accelerator when it has perceived a risk, begins to brake 0.75 s later, and reaches
  0.774 g after 0.6 s; of who is in its lane, or comes into it, it fears a time to collision of 2 s;
- Reg157: what paragraph 5.2.5.2 asks of an automated lane keeping system: 6 m/s^2 after 0.35 s, at the time
  to collision at which this is just enough, from 0.5 m beside the car on;
- RSS: the least distances of Shalev-Shwartz, Shammah and Shashua (2017), definitions 1 and 6;
- FSM: the fuzzy surrogate safety metrics of Mattas et al. (2020), "Fuzzy Surrogate Safety Metrics for
  real-time assessment of rear-end collision risk", in the form of UN Regulation No. 157, 01 series.

Parameters are those with which Mattas et al. (2022), "Driver models for the definition of safety requirements
of automated vehicles in international regulations", compared the four. A driver is asked step after step.
Its delay runs only while it sees a danger; once a danger is over, it keeps the speed that it has then. None
brakes harder, or counts on more, than the road lets it: ``Moment.grip``, and no parameter says otherwise.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from roadgpt.network.line import LEAST_GRIP
from roadgpt.road.speed_profile import GRAVITY

FULL, JERK = 0.774 * GRAVITY, 12.65  # m/s^2; m/s^3, with which it is reached in 0.6 s
DELAY, RELEASED = 0.75, 0.4  # s; m/s^2, with the foot off the accelerator
CRITICAL = 2.0  # s, of the time to collision
REACTS, SYSTEM, BESIDE = 0.35, 6.0, 0.5  # Reg157: s, m/s^2, m
GAINS, SIDEWAYS, WAVERS = 3.0, 1.0, 0.3  # RSS: m/s^2 within its delay, m/s^2 sideways, m
GENTLY, HARD, LEADER, MARGIN = 4.0, 6.0, 7.0, 2.0  # FSM: m/s^2, of the leader, m
SPARE = 0.1  # s, which Reg157 brakes earlier, and FSM wants between its passing and the other's coming


class Moment(NamedTuple):
    """What a driver sees of somebody else, along and across its own path, in metres and m/s."""

    gap: float
    """From its own front to the other's nearest part; negative beside it."""
    clearance: float
    """Sideways between the two boxes; negative if the other reaches into the strip that it needs."""
    length: float
    """The lengths of both together."""
    speed: float
    acceleration: float
    """Its own, in m/s^2."""
    its_speed: float
    """The other's speed along its path."""
    lateral: float
    """The other's speed towards the strip."""
    is_perceived: bool
    """Whether it has taken note of somebody in its lane, or on the way into it."""
    is_sudden: bool = False
    """Whether it has taken note that the other, in its lane, brakes harder than R157's threshold."""
    is_crossing: bool = False
    """Whether the path of somebody who does not follow the lane leads into its strip: all four brake."""
    grip: float = math.inf
    """The deceleration in m/s^2 that the friction circle and the grade leave it at its place and speed; below
    0 it gains speed downhill however it brakes."""

    def least(self, acceleration: float) -> float:
        """Returns an acceleration that a driver counts on, in m/s^2, or what there is of it."""
        return max(min(acceleration, self.grip), LEAST_GRIP)


class DriverModel(NamedTuple):
    """One of the four models."""

    said: str
    braking: Callable[[Moment], float]
    """Returns the deceleration in m/s^2 that it wants; 0 if it sees no danger."""
    delay: float
    released: float
    """Its deceleration within the delay."""
    jerk: float


def _is_close(moment: Moment, time: float) -> bool:
    """Whether the time to collision is at most ``time``."""
    closing = moment.speed - moment.its_speed
    return closing > 0 and moment.gap <= time * closing and moment.gap >= -moment.length / 2


def _careful(moment: Moment) -> float:
    is_braking = moment.acceleration < -moment.least(FULL) / 2  # then it does until nothing closes
    fears = math.inf if is_braking else CRITICAL
    is_close = moment.is_perceived and _is_close(moment, fears)
    return FULL if is_close or moment.is_sudden or moment.is_crossing else 0.0


def _reg157(moment: Moment) -> float:
    least = (moment.speed - moment.its_speed) / (2 * moment.least(SYSTEM)) + REACTS + SPARE
    is_close = moment.clearance <= BESIDE and _is_close(moment, least)
    return SYSTEM if is_close or moment.is_sudden or moment.is_crossing else 0.0


def _rss(moment: Moment) -> float:
    if moment.is_crossing:
        return FULL
    later, lateral = moment.speed + DELAY * moment.least(GAINS), max(moment.lateral, 0.0)
    along = (moment.speed + later) / 2 * DELAY + (later**2 - moment.its_speed**2) / (2 * moment.least(SYSTEM))
    sideways = moment.least(SIDEWAYS)
    aside = lateral + sideways * DELAY
    across = WAVERS + (lateral + aside) / 2 * DELAY + aside**2 / (2 * sideways)
    is_near = -moment.length / 2 <= moment.gap < along and moment.clearance < across
    return FULL if is_near else 0.0


def _fsm(moment: Moment) -> float:
    if moment.is_crossing:
        return FULL
    gap, closing = moment.gap, moment.speed - moment.its_speed
    gently, hard, leader = (moment.least(each) for each in (GENTLY, HARD, LEADER))
    if gap < -moment.length / 2:
        return 0.0
    if moment.clearance > 0:
        if moment.lateral <= 0 or closing <= 0:
            return 0.0
        if moment.clearance / moment.lateral > (gap + moment.length) / closing + SPARE:
            return 0.0
    critical = 0.0
    gained = max(moment.acceleration, -gently) * DELAY
    if closing > 0 and closing + gained < 0:
        critical = float(gap < closing**2 / abs(2 * moment.acceleration))
    elif closing > 0:
        way, rest = (closing + gained / 2) * DELAY, (closing + gained) ** 2 / 2
        critical = _share(gap, way + rest / hard, way + rest / gently)
    if critical:
        return gently + critical * (hard - gently)
    way = moment.speed * DELAY - moment.its_speed**2 / (2 * leader)
    unsafe, safe = way + moment.speed**2 / (2 * hard), way + moment.speed**2 / (2 * gently) + MARGIN
    return gently * _share(gap - MARGIN, unsafe, safe)


def _share(gap: float, unsafe: float, safe: float) -> float:
    """The fuzzy membership: 1 up to the unsafe distance, 0 from the safe one on."""
    return 1.0 if gap <= unsafe else max((safe - gap) / (safe - unsafe), 0.0) if safe > unsafe else 0.0


CAREFUL = DriverModel("careful driver", _careful, DELAY, RELEASED, JERK)
DRIVERS = (
    CAREFUL,
    DriverModel("Reg157", _reg157, REACTS, 0.0, math.inf),
    DriverModel("FSM", _fsm, DELAY, 0.0, JERK),
    DriverModel("RSS", _rss, DELAY, 0.0, JERK),
)


def drive_on(
    driver: DriverModel,
    seen: Callable[[int, float, float, float], Moment],
    free: Sequence[float],
    step: float,
    first: float = 0.0,
) -> tuple[list[float], list[float]]:
    """Returns where a driver is, in metres along its path from ``first`` on, and its speeds in m/s.

    ``seen`` tells what it sees, from the number of the step, its place, speed and acceleration; ``free`` are
    its speeds at every step as long as it has seen no danger; ``step`` is 0.1 s with Mattas et al."""
    places, speeds, gained, delay = [first], [free[0]], 0.0, math.ceil(driver.delay / step - 1e-9)
    waited, deceleration, is_alarmed = 0, 0.0, False
    for at in range(len(free) - 1):
        moment = seen(at, places[-1], speeds[-1], gained)
        wanted = driver.braking(moment)
        speed = speeds[-1] if is_alarmed else free[at + 1]
        if wanted > 0:
            is_alarmed = True
            if waited < delay:
                waited, deceleration = waited + 1, driver.released
            else:
                deceleration = min(deceleration + driver.jerk * step, wanted)
            speed = max(speeds[-1] - min(deceleration, moment.grip) * step, 0.0)
        gained = (speed - speeds[-1]) / step
        speeds.append(speed)
        places.append(places[-1] + speed * step)
    return places, speeds


def stopping_distance(speed: float, grip: float = FULL) -> float:
    """Returns the way in metres that the careful driver needs to stop, from a danger on and from 3 m/s on,
    where the road lets it brake with ``grip`` m/s^2 at most."""
    full, released = min(grip, FULL), min(grip, RELEASED)
    rises = (full - released) / JERK
    braking = speed - released * DELAY
    fastest = braking - (released + full) / 2 * rises
    way = (speed + braking) / 2 * DELAY + braking * rises - released / 2 * rises**2 - JERK / 6 * rises**3
    return way + fastest**2 / (2 * full)
