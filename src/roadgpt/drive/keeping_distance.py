"""Makes drivers keep their distance to others on the road.

A driver follows whoever is in its path by the Intelligent Driver Model, as the traffic around it does
(``roadgpt.traffic.following``). Its path is the strip that the car covers along the planned line: others on
it count, also who only reaches into it, who crosses it or moves into it, and who comes towards the car. Red
lights count like somebody who stands behind their stop line, and so do the lines where it gives way
(``roadgpt.drive.giving_way``). At stop signs it stops once."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.compiled import bound
from roadgpt.drive.driving_line import (
    BEFORE_LINE,
    CREEP,
    FRONT,
    FULL_BRAKE,
    DrivingLine,
    FloatArray,
    pedals_for,
)
from roadgpt.drive.view import Command, Others, View
from roadgpt.road import Road

if TYPE_CHECKING:
    from roadgpt.drive.giving_way import GivingWay

TIME_GAP = 1.5  # s, to the one ahead: the usual setting; ISO 15622 asks for at least 0.8 s
PULL, BRAKE = 1.5, 2.0  # m/s^2, IDM's a and b, as the cars of the traffic have
FOLLOWS = np.array([TIME_GAP, PULL, BRAKE])
HARDEST = 9.0  # m/s^2
FIRM = 3.0  # m/s^2, with which a car stops at a yellow light; else it drives on
ROLLS = 0.3  # m/s, below which a car that need not go on is held by its brake
HALTED = 0.05  # m/s, below which the car counts as standing; a verdict asks for less than 0.1
REACH = 4.0  # m before a stop line, within which the car has to stand, as in CARLA's test of stop signs
LEAST_BRAKE = 0.25  # brake pedal, 0 to 1
NEAR, ROLL_UP = 10.0, 1.0  # m before the line, m/s^2: a car that stops too early there rolls on
GOES_ON = 0.1  # m/s^2, from which on a standing car goes on: 7 cm beyond the least distance


class KeepingDistance:
    """Keeps a driver's distance along its planned line."""

    def __init__(self, line: DrivingLine, road: Road | None = None) -> None:
        """Prepares for a line, and the stop lines of a route if it is to stop at them."""
        self._line = line
        self._stop_lines = [
            each.stop_line for each in (road.passages if road else ()) if each.stop_line is not None
        ]
        self._along = self._path = np.empty(0)
        self._stops_at: set[float] = set()
        """The lights at which the car stops: the stations of their lines, to the millimetre."""
        self._giving_way: GivingWay | None = None

    def ahead(self, view: View, lines: Sequence[float] = ()) -> FloatArray:
        """Returns for each of the others the metres to it, its speed along the path, the acceleration that it
        allows (see ``path_ahead.look_ahead``), and 1.0 if it is a vehicle, else 0.0. A red light counts as a
        vehicle that stands behind its stop line, and so do further ``lines``, metres ahead along the
        route."""
        from roadgpt.drive.path_ahead import STEP, look_ahead  # only drives among others load it

        line = self._line
        if not len(self._path):
            self._along = line.step * np.concatenate([[0.0], np.cumsum(line.stretch[:-1])])
            even = np.arange(0.0, self._along[-1], STEP)
            columns = [np.interp(even, self._along, each) for each in (line.x, line.y, line.heading)]
            self._path = np.column_stack(columns)
            given = (self._path, 0.0, np.empty((0, 7)), FOLLOWS, FOLLOWS)
            self._look = bound(look_ahead, given)
        first, share = line.place(view.s)
        before, after = self._along[first : first + 2].tolist()
        others = (view.others if isinstance(view.others, Others) else Others(view.others)).boxes
        barriers = [self._barrier(view.s + distance) for distance in (*self._to_stop_at(view), *lines)]
        if barriers:
            others = np.vstack([others, barriers])
        car = np.array([view.x, view.y, view.heading, view.speed, FRONT])
        return self._look(self._path, before + share * (after - before), others, car, FOLLOWS)

    def _barrier(self, s: float) -> tuple[float, ...]:
        """Returns what stands for a red light at a stop line: something across the path, so far behind the
        line that the car, which stops JAM before it, stops BEFORE_LINE before the line."""
        from roadgpt.traffic.following import JAM

        line = self._line
        i = line.place(s + JAM - BEFORE_LINE)[0]
        return line.x[i], line.y[i], line.heading[i], 0.0, 0.0, 1.0, 1.0

    def _to_stop_at(self, view: View) -> list[float]:
        """Returns the distances in metres to the stop lines at whose lights the car has to stop. Where it
        once began to stop, it does until the lights are green."""
        found = []
        for distance, shows in view.lights:
            left, place = distance - FRONT, round(view.s + distance, 3)
            if shows == "green" or left <= 0.0:
                self._stops_at.discard(place)
            elif place in self._stops_at or view.speed**2 / 2 / left < {"yellow": FIRM}.get(shows, HARDEST):
                self._stops_at.add(place)
                found.append(distance)
        return found

    def _stopping(self, view: View, command: Command) -> Command:
        """Returns the command, changed near a stop line: the car brakes to a stop before the line, once, and
        rolls on slowly if it has stopped too early."""
        left = self._stop_lines[0] - view.s - FRONT
        if left > BEFORE_LINE + view.speed * view.dt:
            if left < NEAR and view.speed < CREEP / 2:  # it stopped too early, where its plan still brakes
                grade = float(view.road.grade(view.s))
                return Command(command.steer, *pedals_for(ROLL_UP, grade, view.speed))
            return command
        if (view.speed < HALTED and left < REACH) or left < -REACH:
            del self._stop_lines[0]
            return command
        needed = view.speed**2 / 2 / max(left, BEFORE_LINE / 2)
        return Command(command.steer, 0.0, min(max(needed / FULL_BRAKE, LEAST_BRAKE), 1.0))

    def kept(self, view: View, command: Command) -> Command:
        """Returns the command, with less throttle or more brake for stop signs, red lights, others in the
        path, and those to whom the driver gives way."""
        command = self._stopping(view, command) if self._stop_lines else command
        if not (view.others or view.lights):
            return command
        lines, least = list[float](), np.inf
        if view.route is not None:
            from roadgpt.drive.giving_way import GivingWay  # only drives among others load it

            self._giving_way = self._giving_way or GivingWay(view.route, view.world, self._line)
            lines, least = self._giving_way.lines(view), self._giving_way.behind(view)
        least = min([least, *self.ahead(view, lines)[:, 2].tolist()])
        return slowed(self._line, view, command, max(least, -HARDEST))


def slowed(line: DrivingLine, view: View, command: Command, acceleration: float) -> Command:
    """Returns the command with the pedals for an acceleration in m/s^2, unless it asks for less."""
    if acceleration == np.inf:
        return command
    throttle, brake = pedals_for(acceleration, line.grade[line.place(view.s)[0]], view.speed)
    if view.speed < ROLLS and acceleration < GOES_ON:
        throttle, brake = 0.0, max(brake, LEAST_BRAKE)
    return Command(command.steer, min(command.throttle, throttle), max(command.brake, brake))
