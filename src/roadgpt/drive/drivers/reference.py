"""The reference driver: steers along the middle of its lane with feed-forward and look-ahead
feedback."""

import math
from dataclasses import dataclass

from roadgpt.drive.driving_line import highest_speeds, line_along, pedals, stations
from roadgpt.drive.keeping_distance import KeepingDistance
from roadgpt.drive.view import Command, View
from roadgpt.road import Road, World
from roadgpt.road.speed_profile import GRAVITY, DrivingLimits, plan_speed


@dataclass(eq=False)
class Reference:
    """Keeps to the middle of its lane; a road on which it fails is probably not drivable.

    Steering follows N. R. Kapania, J. C. Gerdes, "Design of a feedback-feedforward steering controller for
    accurate path tracking and stability at the limits of handling", Vehicle System Dynamics 53 (2015): the
    steady-state steering angle for the bend ahead, plus feedback on the lateral error at a point ahead of the
    car, with the slip angle taken into account. The planned speed respects the friction circle, and takes
    grades, crests and superelevation into account. In junctions it drives no faster than people do
    (``roadgpt.drive.driving_line``), and it stops at stop signs.

    Args:
        risk: planned lateral acceleration in bends, in g; at most 0.72 times the friction.
        wheelbase: wheelbase in metres.
        to_rear: distance in metres from the centre of gravity to the rear axle.
        understeer: steering angle beyond the Ackermann angle per lateral acceleration, in rad per m/s^2.
            ``understeer`` and ``slip`` depend on the car; both were measured on RoadGPT's car in steady state
            at 0.3 g.
        slip: slip angle of the rear axle per lateral acceleration, in rad per m/s^2.
        gain: steering angle per lateral error at the point ahead, in rad per metre.
        ahead: distance in metres to the point ahead while the car is at rest; while the car moves, the
            distance is ``ahead + headway * speed``.
        headway: increase with speed of the distance to the point ahead, in metres per m/s.
        lag: steering delay in seconds. The driver steers for the curvature that the car will reach after this
            delay."""

    name = "reference"

    risk: float = 0.6
    wheelbase: float = 2.83
    to_rear: float = 1.47
    understeer: float = 0.0020
    slip: float = 0.0055
    gain: float = 0.10
    ahead: float = 5.0
    headway: float = 0.25
    lag: float = 0.10

    def start(self, road: Road, world: World, seed: int) -> None:
        """Plans the line and the speed for a road."""
        del seed  # the same road is driven the same way every time
        line = line_along(road, world.profile_of(road).middle(stations(road)))
        lateral = min(self.risk, FRICTION_USED * world.site.friction)
        limits = DrivingLimits(lateral, BRAKING * lateral, TRACTION * lateral, world.driven_speed)
        self._line, self._speed = line, plan_speed(line, limits, highest_speeds(road, world, line))
        self._distance = KeepingDistance(line, road)

    def steer(self, view: View) -> Command:
        """Steers for the bend ahead and against the lateral error; follows the planned speed."""
        steer, _ = self.steered(view)
        command = Command(steer, *pedals(self._line, self._speed, view.s, max(view.vx, 0.0)))
        return self._distance.kept(view, command)

    def steered(
        self, view: View, curvature: list[float] | None = None, aside: float = 0.0, slope: float = 0.0
    ) -> tuple[float, float]:
        """Returns the steering angle for the curvature of the car's motion in 1/m at each station of the
        line, that of the line if it is not given, and the lateral error in metres. The car is to be
        ``aside`` metres to the left of the line, and ``slope`` is how that changes per metre."""
        line, v = self._line, max(view.vx, 0.0)
        curvature = line.curvature if curvature is None else curvature
        i, share = line.place(view.s)
        error = view.t - line.offset[i] - share * (line.offset[i + 1] - line.offset[i]) - aside
        heading = line.heading[i] + share * (line.heading[i + 1] - line.heading[i])
        turned = math.remainder(view.heading - heading - math.atan(slope), math.tau)
        j, share = line.place(view.s + self.lag * v)
        bend = curvature[j] + share * (curvature[j + 1] - curvature[j])
        # A road that falls to the right needs force to the left, as a bend to the left does.
        lateral = v * v * bend + GRAVITY * math.sin(line.superelevation[j])
        drift = self.to_rear * bend - self.slip * lateral
        steer = self.wheelbase * bend + self.understeer * lateral
        steer -= self.gain * (error + (self.ahead + self.headway * v) * (turned + drift))
        return steer, error


FRICTION_USED = 0.72  # share of the friction that bends may need; the rest is for corrections
BRAKING = 0.9  # of the lateral limit
TRACTION = 0.8  # of the lateral limit
