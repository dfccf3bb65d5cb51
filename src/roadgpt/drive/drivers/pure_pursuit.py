"""Pure pursuit: the plain, weak baseline."""

import math
from typing import TYPE_CHECKING

from roadgpt.drive.driving_line import line_along
from roadgpt.drive.pedals import pedals
from roadgpt.drive.speed_profile import Limits, plan_speed
from roadgpt.drive.view import Command, View

if TYPE_CHECKING:
    from roadgpt.road import Road, World


class PurePursuit:
    """Steers on the circle that leads to a point of the lane's middle ahead, and knows nothing of slip.

    It cuts bends at low speed and runs wide at high speed: the weak baseline. Source: R. C. Coulter,
    "Implementation of the pure pursuit path tracking algorithm", CMU-RI-TR-92-01 (1992).

    Args:
        risk: lateral acceleration in bends, in g; at most 0.95 of the friction is used.
        headway: seconds to the point ahead; nearest: metres, its least distance.
        wheelbase: metres.
    """

    name = "pure_pursuit"

    def __init__(
        self, risk: float = 0.7, headway: float = 0.65, nearest: float = 4.5, wheelbase: float = 2.83
    ) -> None:
        self.risk, self.headway, self.nearest, self.wheelbase = risk, headway, nearest, wheelbase

    def start(self, road: "Road", world: "World", seed: int) -> None:
        """Plan the speed along the middle of the right lane."""
        del seed  # the same road is driven the same way every time
        line = line_along(road, -world.lane_width / 2)
        lateral = min(self.risk, 0.95 * world.friction)
        self._line, self._speed = line, plan_speed(line, Limits(lateral, lateral, lateral, world.speed_limit))

    def steer(self, view: View) -> Command:
        """Aim at the point ahead; follow the planned speed."""
        line = self._line
        i, share = line.place(view.s + max(self.headway * view.speed, self.nearest))
        dx = line.x[i] + share * (line.x[i + 1] - line.x[i]) - view.x
        dy = line.y[i] + share * (line.y[i + 1] - line.y[i]) - view.y
        angle = math.atan2(dy, dx) - view.heading
        steer = math.atan(2 * self.wheelbase * math.sin(angle) / max(math.hypot(dx, dy), 1.0))
        return Command(steer, *pedals(line, self._speed, view.s, view.speed))
