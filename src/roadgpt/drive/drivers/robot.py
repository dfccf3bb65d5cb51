"""The test robot: holds its path and its speed, and reacts to nobody."""

import math
from dataclasses import dataclass

from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.driving_line import pedals_for
from roadgpt.drive.view import Command, View
from roadgpt.road import Road, World

GOES_ON = 0.5  # m/s^2, with which somebody else changes the speed
NEAR = 0.5  # m and m/s; larger errors, as at a start from rest, are not summed up


@dataclass(eq=False)
class Robot(Reference):
    """Drives as the robots in the cars of Euro NCAP's tests do: holds the middle of its lane and its speed,
    whatever is ahead.

    The speed is that of the scene, else the speed limit; where the scene makes a car that stands go on, that
    with which it has gone on. Euro NCAP allows the car 0.5 km/h more and 0.05 m to either side. The robot
    does not slow down for bends: where a bend needs more friction than there is, the car leaves its path. It
    does not look at others, lights or signs.

    It steers as the driver ``reference`` does, with two differences. The feedback also sums up what is left
    of an error. And where the curvature changes at once, as at the corners of junctions, the car turns in
    gradually: its centre of gravity stays on the path if its yaw per metre follows the curvature of the path
    with a lag of ``to_rear`` metres, because the rear axle rolls along its heading.

    Args:
        summed: steering angle per summed lateral error, in rad per metre and second.
        pull: acceleration per speed error, in 1/s.
        drawn: acceleration per summed speed error, in 1/s^2."""

    name = "robot"

    summed: float = 0.05
    pull: float = 3.0
    drawn: float = 2.0

    def start(self, road: Road, world: World, seed: int) -> None:
        """Plans the path and the speed for a road."""
        super().start(road, world, seed)
        line = self._line
        self._yaw = line.curvature[:1]
        for curvature, stretch in zip(line.curvature[1:], line.stretch[1:], strict=True):
            share = math.exp(-line.step * stretch / self.to_rear)
            self._yaw.append(share * self._yaw[-1] + (1 - share) * curvature)
        stands, whats = world.scene.stands, {each.what for each in world.scene.actions}
        self._stands = stands and not whats <= {"wait", "release"}
        self._held = world.driven_speed if stands and whats and not self._stands else world.first_speed
        self._aside = self._behind = self._was = 0.0

    def steer(self, view: View) -> Command:
        """Steers for the bend ahead and against the errors; holds the speed."""
        steer, aside = self.steered(view, self._yaw)
        was, self._was = self._was, max(view.vx, 0.0)
        if self._stands and abs(self._was - was) > GOES_ON * view.dt:
            self._held = self._was
        slower = self._held - self._was
        self._aside += aside * view.dt if abs(aside) < NEAR else 0.0
        self._behind += slower * view.dt if abs(slower) < NEAR else 0.0
        wanted = self.pull * slower + self.drawn * self._behind
        grade = self._line.grade[self._line.place(view.s)[0]]
        return Command(steer - self.summed * self._aside, *pedals_for(wanted, grade, view.vx))
