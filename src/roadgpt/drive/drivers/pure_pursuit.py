"""The pure-pursuit driver: a simple, weak baseline."""

import math
from dataclasses import dataclass

from roadgpt.drive.driving_line import highest_speeds, line_along, pedals, pursuit_curvature, stations
from roadgpt.drive.keeping_distance import KeepingDistance
from roadgpt.drive.view import Command, View
from roadgpt.road import Road, World
from roadgpt.road.speed_profile import DrivingLimits, plan_speed


@dataclass(eq=False)
class PurePursuit:
    """Steers along a circle to a point ahead in the middle of the lane; ignores tyre slip.

    It cuts bends at low speed and runs wide at high speed: a weak baseline. In junctions it drives no faster
    than people do (``roadgpt.drive.driving_line``), and it stops at stop signs.

    Args:
        risk: planned lateral acceleration in bends, in g; at most 0.95 times the friction.
        headway: time in seconds in which the car would reach the point that it steers towards.
        nearest: smallest distance to the point that it steers towards, in metres.
        wheelbase: wheelbase in metres."""

    name = "pure_pursuit"

    risk: float = 0.7
    headway: float = 0.65
    nearest: float = 4.5
    wheelbase: float = 2.83

    def start(self, road: Road, world: World, seed: int) -> None:
        """Plans the speed along the middle of the lane."""
        del seed  # the same road is driven the same way every time
        line = line_along(road, world.profile_of(road).middle(stations(road)))
        lateral = min(self.risk, 0.95 * world.site.friction)
        limits = DrivingLimits(lateral, lateral, lateral, world.driven_speed)
        self._line, self._speed = line, plan_speed(line, limits, highest_speeds(road, world, line))
        self._distance = KeepingDistance(line, road)

    def steer(self, view: View) -> Command:
        """Steers towards a point of the lane's middle ahead of the car, and follows the planned speed."""
        line = self._line
        bend = pursuit_curvature(line, view, max(self.headway * view.speed, self.nearest))
        command = Command(math.atan(self.wheelbase * bend), *pedals(line, self._speed, view.s, view.speed))
        return self._distance.kept(view, command)
