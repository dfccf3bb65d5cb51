"""How fast the drivers of this folder go: steadily, and slower where the road bends."""

import math
import os

GENTLE = 3.0  # m/s^2 to the side, at most: a third of what dry asphalt holds
ANSWER = 0.5  # pedal per m/s of error
WHEELBASE = 2.83  # m


class SpeedControl:
    """Keeps a speed by the pedals.

    Args:
        speed_kmh: on straights; None takes it from the environment variable ``SPEED_KMH``, else 25 km/h, at
            which the competition drives its DAVE-2.
    """

    def __init__(self, speed_kmh: float | None = None) -> None:
        """At this speed."""
        self.speed_kmh = float(os.environ.get("SPEED_KMH", "25")) if speed_kmh is None else speed_kmh

    def pedals(self, speed: float, bend: float, limit: float = math.inf) -> tuple[float, float]:
        """Throttle and brake at a speed (m/s) for a bend (1/m), and no faster than ``limit`` (m/s)."""
        wanted = min(self.speed_kmh / 3.6, limit, math.sqrt(GENTLE / max(abs(bend), 1e-3)))
        pedal = ANSWER * (wanted - speed) + 0.05
        return min(max(pedal, 0.0), 1.0), min(max(-0.4 * pedal, 0.0), 1.0)
