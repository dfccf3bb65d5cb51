"""Pure pursuit: computes the circle that leads from the car to a point of its line ahead of the car.

Source: R. C. Coulter, "Implementation of the pure pursuit path tracking algorithm", CMU-RI-TR-92-01 (1992).
"""

import math

from roadgpt.drive.driving_line import DrivingLine
from roadgpt.drive.view import View

NEAREST = 1.0  # m, lower bound of the distance to the point


def pursuit_curvature(line: DrivingLine, view: View, ahead: float) -> float:
    """Returns the curvature of the circle from the car to a point of the line ahead, in 1/m, positive to the
    left.

    Args:
        line: the line to follow.
        view: the current state of the car.
        ahead: distance to the point, in metres along the road.
    """
    i, share = line.place(view.s + ahead)
    dx = line.x[i] + share * (line.x[i + 1] - line.x[i]) - view.x
    dy = line.y[i] + share * (line.y[i + 1] - line.y[i]) - view.y
    angle = math.atan2(dy, dx) - view.heading
    return 2 * math.sin(angle) / max(math.hypot(dx, dy), NEAREST)
