"""Follows the others on the road during a drive: which of them the driver sees, and when the car touches one
of them."""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.visibility import visual_range
from roadgpt.compiled import compiled
from roadgpt.drive.drive import COLUMNS, Box, FloatArray
from roadgpt.drive.view import LightAhead, Other
from roadgpt.network.lanes import HEADROOM
from roadgpt.traffic import STEP, TestedCar, Traffic
from roadgpt.traffic.boxes import touch

if TYPE_CHECKING:
    from roadgpt.drive.drive_monitor import DriveMonitor
    from roadgpt.road import Road, World

SEEN = 200.0  # m, between the middles of the car and of another
_PLACES = [[*COLUMNS].index(name) for name in ("x", "y", "z", "heading", "speed", "s", "t")]


@compiled
def look_around(
    states: FloatArray, sizes: FloatArray, car: FloatArray, order: "NDArray[np.int64]", seen: FloatArray
) -> tuple[int, bool]:
    """Writes into ``order`` the numbers of the actors that are seen, nearest first, and into ``seen`` the x,
    y, heading in (-pi, pi] and speed of each; returns how many they are and whether the car touches one.

    ``states`` are as in Tracks, ``sizes`` (n, 2) lengths and widths, and ``car`` has the x, y and z of the
    middle of the car's box on the ground, its heading, length and width. Roads that cross above each other do
    not count."""
    x, y, z, heading, length, width = car
    far = np.empty(len(states))
    count, touches = 0, False
    for k in range(len(states)):
        dx, dy = states[k, 0] - x, states[k, 1] - y
        far[k] = math.hypot(dx, dy)
        if not far[k] <= SEEN:  # also who is not there
            continue
        place = count
        while place > 0 and far[order[place - 1]] > far[k]:
            order[place] = order[place - 1]
            place -= 1
        order[place] = k
        count += 1
        if abs(states[k, 2] - z) <= HEADROOM:
            touches = touches or touch(dx, dy, heading, length, width, states[k, 3], sizes[k, 0], sizes[k, 1])
    for place in range(count):
        k = order[place]
        seen[place, 0], seen[place, 1], seen[place, 3] = states[k, 0], states[k, 1], states[k, 4]
        seen[place, 2] = math.atan2(math.sin(states[k, 3]), math.cos(states[k, 3]))
    return count, touches


class Company:
    """The others on the road during one drive."""

    def __init__(
        self, traffic: Traffic, box: Box, monitor: "DriveMonitor", road: "Road", world: "World"
    ) -> None:
        self._traffic, self._box, self._monitor = traffic, box, monitor
        passages = road.passages if traffic.lights is not None else ()
        lines = [(each.light_line, each.arrival) for each in passages]
        self._lines = [(line, end) for line, end in lines if line is not None]
        self._scene, self._samples = world.scene, 0
        self._reach: list[float] = []  # from the car's middle to that of each of the others
        self._looks: list[tuple[str, float, float]] = []
        self._sizes, self._order, self._seen = np.empty((0, 2)), np.empty(0, np.int64), np.empty((0, 4))

    def seen(self, row: FloatArray, time: float) -> tuple[Other, ...]:
        """Moves the others on to this time, tells the monitor whether the car touches one, and returns those
        that the driver sees. Call it at every control step; ``row`` is the state of the car in the order of
        COLUMNS."""
        x, y, z, heading, speed, s, t = row[_PLACES].tolist()
        box, c, sine = self._box, math.cos(heading), math.sin(heading)
        x, y = x + box.ahead * c, y + box.ahead * sine
        if time >= self._samples * STEP - 1e-6:
            self._traffic.advance(TestedCar(x, y, heading, speed, s, t, box.length, box.width))
            self._samples += 1
            new = self._traffic.actors[len(self._looks) :]
            self._looks += [(each.kind, *each.size[:2]) for each in new]
            self._reach += [visual_range(self._scene, each.kind) + each.size.length / 2 for each in new]
            self._sizes = np.array([look[1:] for look in self._looks]).reshape(-1, 2)
            self._order, self._seen = np.empty(len(self._looks), np.int64), np.empty((len(self._looks), 4))
        states, looks = self._traffic.at(time), self._looks
        car = np.array([x, y, z - box.height, heading, box.length, box.width])
        count, touches = look_around(states, self._sizes, car, self._order, self._seen)
        if touches:
            self._monitor.touch(time)
        near = zip(self._order[:count].tolist(), self._seen[:count].tolist(), strict=True)
        return tuple(
            [
                Other._make((looks[k][0], *where, *looks[k][1:]))
                for k, where in near
                if math.hypot(where[0] - x, where[1] - y) <= self._reach[k]
            ]
        )

    def lights(self, s: float, time: float) -> tuple[LightAhead, ...]:
        """Returns the lights ahead of station ``s`` of the route, and what they show at this time."""
        shown, reach = self._traffic.lights, visual_range(self._scene, "lights")
        if shown is None:
            return ()
        return tuple(
            [
                LightAhead(line - s, ("green", "yellow", "red")[shown.shown(end, time)])
                for line, end in self._lines
                if 0 <= line - s <= reach
            ]
        )
