"""The test robot: holds its path and its speed, and reacts to nobody."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from roadgpt.drive.driving_line import first_speed, line_along, pedals_for, stations
from roadgpt.drive.view import Command, View
from roadgpt.road.speed_profile import GRAVITY

if TYPE_CHECKING:
    from roadgpt.road import Road, World

TURN = 2 * math.pi
NEAR = 0.5  # m and m/s; larger errors, as at a start from rest, are not summed up


@dataclass(eq=False)
class Robot:
    """Drives as the robots in the cars of Euro NCAP's tests do: holds the middle of its lane and its speed,
    whatever is ahead.

    The speed is that of the scene, else the speed limit. Euro NCAP allows the car 0.5 km/h more and 0.05 m to
    either side. The robot does not slow down for bends: where a bend needs more friction than there is, the
    car leaves its path. It does not look at others, lights or signs.

    It steers as the driver ``reference`` does, with two differences. The feedback also sums up what is left
    of an error. And where the curvature changes at once, as at the corners of junctions, the car turns in
    gradually: its centre of gravity stays on the path if its yaw per metre follows the curvature of the path
    with a lag of ``to_rear`` metres, because the rear axle rolls along its heading.

    Args:
        wheelbase: wheelbase in metres.
        to_rear: distance in metres from the centre of gravity to the rear axle.
        understeer: steering angle beyond the Ackermann angle per lateral acceleration, in rad per m/s^2.
        slip: slip angle of the rear axle per lateral acceleration, in rad per m/s^2.
        gain: steering angle per lateral error at the point ahead, in rad per metre.
        ahead: distance in metres to the point ahead while the car is at rest.
        headway: increase of this distance with speed, in metres per m/s.
        summed: steering angle per summed lateral error, in rad per metre and second.
        lag: steering delay in seconds.
        pull: acceleration per speed error, in 1/s.
        drawn: acceleration per summed speed error, in 1/s^2."""

    name = "robot"

    wheelbase: float = 2.83
    to_rear: float = 1.47
    understeer: float = 0.0020
    slip: float = 0.0055
    gain: float = 0.10
    ahead: float = 5.0
    headway: float = 0.25
    summed: float = 0.05
    lag: float = 0.10
    pull: float = 3.0
    drawn: float = 2.0

    def start(self, road: "Road", world: "World", seed: int) -> None:
        """Plans the path and the speed for a road."""
        del seed  # the same road is driven the same way every time
        self._line = line = line_along(road, world.profile_of(road).middle(stations(road)))
        self._yaw = [line.curvature[0]]
        for curvature, stretch in zip(line.curvature[1:], line.stretch[1:], strict=True):
            share = math.exp(-line.step * stretch / self.to_rear)
            self._yaw.append(share * self._yaw[-1] + (1 - share) * curvature)
        self._speed = first_speed(world)
        self._aside = self._slower = 0.0

    def steer(self, view: View) -> Command:
        """Steers for the bend ahead and against the errors; holds the speed."""
        line, v = self._line, max(view.vx, 0.0)
        i, share = line.place(view.s)
        error = view.t - line.offset[i] - share * (line.offset[i + 1] - line.offset[i])
        heading = line.heading[i] + share * (line.heading[i + 1] - line.heading[i])
        turned = math.remainder(view.heading - heading, TURN)
        j, share = line.place(view.s + self.lag * v)
        bend = line.curvature[j] + share * (line.curvature[j + 1] - line.curvature[j])
        yaw = self._yaw[j] + share * (self._yaw[j + 1] - self._yaw[j])
        # A road that falls to the right needs force to the left, as a bend to the left does.
        lateral = v * v * bend + GRAVITY * math.sin(line.superelevation[j])
        drift = self.to_rear * yaw - self.slip * lateral
        self._aside += error * view.dt if abs(error) < NEAR else 0.0
        steer = math.atan(self.wheelbase * yaw) + self.understeer * lateral - self.summed * self._aside
        steer -= self.gain * (error + (self.ahead + self.headway * v) * (turned + drift))
        slower = self._speed - v
        self._slower += slower * view.dt if abs(slower) < NEAR else 0.0
        wanted = self.pull * slower + self.drawn * self._slower
        return Command(steer, *pedals_for(wanted, line.grade[i], v))
