"""A driver of your own, as the guide on drivers explains it."""

import math

from roadgpt.drive import Command


class MyDriver:
    """Looks 8 m ahead along the middle of its lane."""

    def steer(self, view):
        """Asked every 20 ms; gives back an angle of the front wheels and the pedals."""
        ahead = min(view.s + 8, view.road.length)
        x, y, _ = view.road.at(ahead, view.world.profile_of(view.road).middle(ahead))
        bearing = math.atan2(y - view.y, x - view.x) - view.heading
        wanted = math.atan2(math.sin(bearing), math.cos(bearing))
        pedal = 0.3 * (30 / 3.6 - view.speed)
        return Command(steer=0.7 * wanted, throttle=max(pedal, 0), brake=max(-pedal, 0))
