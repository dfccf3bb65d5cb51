r"""The hand of a scene's script at the tested car: it does what the scene tells the car to do.

Pedals and wheel are two hands. The driver is asked at every step, also while it has neither.

             an action begins: the script takes what the action needs
        +-----------------------------------------------------------------+
        |                                                                 v
    +--------+   it has ended, or "release" begins: both go back    +------------+
    | driver | <--------------------------------------------------- |   script   |
    +--------+                                                      +------------+
        | the driver brakes with more than 3.5 m/s2 for 0.2 s           | so does the driver, and the
        v when an action is to begin                                    v script steers
    this one is given up                          it steers to the middle of the lane, and gives this one up

Pedals: the stronger brake counts, the script's or the driver's, and throttle is the script's while the driver
does not brake harder. Wheel: the script's. The lane does not count while the script steers, nor in the
RETURNS seconds behind that."""

import math
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.drive.drive import PEDALS, SCRIPT, Box
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.driving_line import BEFORE_LINE, pedals_for
from roadgpt.drive.keeping_distance import HALTED, LEAST_BRAKE, ROLLS
from roadgpt.drive.view import View
from roadgpt.language.table import MANEUVERS
from roadgpt.network.line import driven_line
from roadgpt.road.road import START
from roadgpt.traffic.course import Course, Met
from roadgpt.traffic.lateral import Lateral, Offsets
from roadgpt.traffic.longitudinal import Longitudinal
from roadgpt.traffic.maneuver import STOP, Maneuver, Phase, drawn
from roadgpt.traffic.places import stretch_of
from roadgpt.traffic.traffic import NEVER, Stage
from roadgpt.traffic.triggers import Triggers

if TYPE_CHECKING:
    from roadgpt.road import Road, World
    from roadgpt.traffic import Traffic

Pedals = tuple[float, float, float]
"""The angle of the front wheels in radians, throttle and brake."""
OWN = (101, 103, 111)  # beside the seed, for the numbers of the tested car
FIRM, LASTS = 3.5, 0.2  # m/s^2, s: what cruise control may not brake with (ISO 15622), so the driver objects
PULL = 2.0  # 1/s, acceleration per speed error
AHEAD = 1.5  # m/s, by which the planned speed may be ahead of the car's
REACHED = 0.1  # m/s
LONGER, SETTLES = 1.2, 0.5  # share and s, by which a change of speed may last longer than it is told to
STEADY = 0.5  # m/s, of changes of speed that are too small to be compared
NEAREST = 0.3  # m before the place where it stops
BACK = 0.5  # m/s, with which it is steered back at most
FAR = 1e6  # m, to nobody


class ScriptHand:
    """What a scene tells the tested car to do, during one drive."""

    def __init__(self, road: "Road", world: "World", box: Box, seed: int, traffic: "Traffic | None") -> None:
        """Draws the numbers. Raises SceneError if the road has no place that an action names."""
        self._road, self._world, self._box, self._traffic = road, world, box, traffic
        self._line, rng = driven_line(road, world), np.random.default_rng([seed, *OWN])
        self._maneuvers, whats = list[Maneuver](), [each.what for each in world.scene.actions]
        self._places = dict[int, float]()
        """Where the car stands that stops before a place: the station of its front along the line."""
        for number, action in enumerate(world.scene.actions):
            self._maneuvers.append(Maneuver(action, drawn(action, rng), whats[:number].count(action.what)))
            self._put(number)
        line = self._line
        self._course = Course(line, line, box.length, 1, True, False, True, False)
        self._lateral = Lateral()
        self._speed = Longitudinal(self._course, self._lateral, "car", world.first_speed, world.first_speed)
        offsets = Offsets(
            Stage(road, world, seed), self._course, "ahead", None, {}, None, box.width, box.width
        )
        self._nobody = Met(FAR, 0.0, box.length, box.width)
        self._triggers = Triggers(
            self._course, offsets, self._lateral, self._speed, self._nobody, {}, waits=False
        )
        self._begun, self._phases = 0, list[Phase]()
        self._since = self._planned = self._v = 0.0
        """When the phase began, the speed that it has planned for now, and that at its begin."""
        self._firm = 0.0
        """For how many seconds the driver has braked firmly."""
        self._stands = world.scene.speed is not None and world.first_speed == 0
        self._said, self._skipped = list[str](), list[str]()
        self._steering: Reference | None = None

    def _put(self, number: int) -> None:
        """Finds the place of a maneuver that the scene names by a part of the route."""
        each, line = self._maneuvers[number], self._line
        mark, n = each.action.at, each.n
        if "distance" in n:
            n["station"] = line.from_road(min(START, self._road.length / 2)) + n.pop("distance")
        if mark is None or mark.what:
            return
        first, last = stretch_of(mark, self._road, line)
        if each.what not in ("stop", "wait") or mark.word != "before":
            n["station"] = {"after": last, "in": (first + last) / 2, "before": first}[mark.word]
            return
        ways = [way for way in self._road.passages if abs(line.from_road(way.start) - first) < NEAREST]
        at = line.from_road(ways[0].line) if ways and mark.of == "junction" else first
        self._places[number] = at - BEFORE_LINE

    @property
    def _front(self) -> float:
        return self._course.s + self._box.length / 2

    def shared(self, view: View, command: Pedals) -> tuple[Pedals, str | None]:
        """Returns the command that counts, of the driver's and the script's, and the name of the script's
        hands; None if it has none. Call it once for every control step."""
        self._see(view)
        self._go_on(view)
        self._begin_in_time(view)
        if not self._phases and not (self._stands and not self._begun):
            return command, None
        steer, throttle, brake = command
        if self._hands == "wheel":
            return (self._steered(view), throttle, brake), SCRIPT
        own_throttle, own_brake = self._pedals(view)
        throttle = own_throttle if brake <= own_brake else 0.0
        return (steer, throttle, max(brake, own_brake)), PEDALS

    def _see(self, view: View) -> None:
        before, self._speed.v = self._speed.v, max(view.vx, 0.0)
        self._course.s = self._line.from_road(view.s) + self._box.ahead
        self._triggers.time = view.time
        by_driver = not self._phases or self._hands == "wheel"
        is_firm = by_driver and before - self._speed.v > FIRM * view.dt
        self._firm = self._firm + view.dt if is_firm else 0.0
        if self._phases and self._is_refused and self._lateral.end != 0.0:
            by = abs(self._lateral.t)
            self._lateral.slide_to(0.0, max(math.pi / 2 * by / BACK, view.dt))
            self._phases = [Phase(to=0.0, slides=1.0, until="there")]
            self._give_up(f"while {self._did(self._begun - 1)}", view)

    @property
    def _is_refused(self) -> bool:
        """Whether the driver brakes firmly."""
        return self._firm > LASTS - 1e-9

    def _give_up(self, when: str, view: View) -> None:
        by = f"its driver braked with more than {FIRM:g} m/s2 at {view.time:.1f} s"
        self._said.append(f"the script gave up {when}: {by}")

    @property
    def _hands(self) -> str:
        """The hands that it needs for what it does, or for waiting for the first thing to do."""
        return MANEUVERS[self._maneuvers[self._begun - 1].what].hands if self._begun else "pedals"

    def _did(self, number: int) -> str:
        """Returns in words what a maneuver is."""
        each = self._maneuvers[number]
        return f"the tested car {MANEUVERS[each.what].said}{' again' * each.before}"

    def _met(self) -> Met:
        """Returns who is ahead in the lane of the tested car."""
        if self._traffic is None:
            return self._nobody
        states = self._traffic.at(self._triggers.time)
        sizes = np.array([each.size[:2] for each in self._traffic.actors])
        boxes = self._line.boxes(states, sizes)
        ahead = boxes.along - self._course.s
        ahead[~((ahead > 0) & self._line.holds(boxes))] = np.inf
        if not np.isfinite(ahead).any():
            return self._nobody
        first = int(ahead.argmin())
        return Met(
            float(boxes.along[first]), float(boxes.velocity[first, 0]), *map(float, 2 * boxes.size[first])
        )

    def _begin_in_time(self, view: View) -> None:
        """Begins what is next if it is time."""
        while self._begun < len(self._maneuvers):
            number, each = self._begun, self._maneuvers[self._begun]
            if each.event and self._traffic is not None:
                self._triggers.events = self._traffic.events
            if {"gap", "headway", "ttc"} & {*each.n}:
                self._triggers.met = self._met()
            before = None if not number else math.inf if self._phases else 0.0
            if number in self._places:
                left = self._places[number] - self._front
                if left < 0:
                    self._skipped.append(f"{NEVER} {self._did(number)}: it had passed the place before")
                    self._begun, self._phases = number + 1, []
                    continue
                wait = 0.0 if self._speed.v**2 / 2 / max(left, NEAREST) >= self._decel(each) else math.inf
            else:
                wait = self._triggers.wait(each, before)
            if wait >= view.dt:
                return
            self._begun += 1
            if self._is_refused:
                self._give_up(f"before {self._did(number)}", view)
                self._phases = []
                continue
            self._lateral.t, self._lateral.slide = self._aside(view), None
            self._phases = [] if each.what == "release" else self._triggers.phases(each)
            rest = self._maneuvers[self._begun :]
            if each.what == "stop" and "duration" not in each.n and rest and not rest[0].is_open:
                self._phases.append(Phase(lasts=math.inf))
            if self._phases:
                self._enter(view)

    @staticmethod
    def _decel(maneuver: Maneuver) -> float:
        return maneuver.n.get("decel", STOP)

    def _aside(self, view: View) -> float:
        """Returns how far the car is to the left of the middle of its lane."""
        return view.t - float(self._world.profile_of(self._road).middle(view.s))

    def _enter(self, view: View) -> None:
        """Begins the phase that is next."""
        phase = self._phases[0]
        self._since, self._planned, self._v = view.time, self._speed.v, self._speed.v
        if phase.to is not None:
            self._lateral.slide_to(phase.to, phase.slides)

    def _go_on(self, view: View) -> None:
        """Ends phases that are over, and plans speed and place for now."""
        while self._phases and self._is_over(self._phases[0], view.time - self._since):
            phase = self._phases.pop(0)
            self._compare(phase, view.time - self._since)
            if self._phases:
                self._enter(view)
        if not self._phases:
            return
        phase, v = self._phases[0], self._speed.v
        if self._lateral.slide is not None:
            self._lateral.step(self._course, self._course.s, v, v * view.dt, view.dt)
        if phase.goal is not None:
            left = phase.goal - self._planned
            self._planned += math.copysign(min(phase.pull * view.dt, abs(left)), left)
            self._planned = min(max(self._planned, v - AHEAD), v + AHEAD)

    def _is_over(self, phase: Phase, lasted: float) -> bool:
        if phase.lasts is not None and lasted >= phase.lasts - 1e-6:
            return True
        if phase.until == "there":
            return self._lateral.slide is None
        if phase.until != "speed" or phase.goal is None:
            return False
        v, least = self._speed.v, HALTED if phase.goal == 0 else REACHED
        return v <= phase.goal + least if self._v >= phase.goal else v >= phase.goal - least

    def _compare(self, phase: Phase, lasted: float) -> None:
        """Notes that a change of speed was slower than told."""
        if phase.goal is None or phase.until != "speed" or self._begun - 1 in self._places:
            return
        change = abs(self._v - phase.goal)
        if change > STEADY and lasted > LONGER * change / phase.pull + SETTLES:
            slow = change / lasted
            self._said.append(f"{self._did(self._begun - 1)} with {slow:.1f} m/s2, not {phase.pull:.1f}")

    def _pedals(self, view: View) -> tuple[float, float]:
        """Returns throttle and brake for the speed that is planned for now."""
        phase = self._phases[0] if self._phases else Phase(0.0)
        v, number = self._speed.v, self._begun - 1
        halts = phase.goal == 0 or (phase.goal is None and self._planned < ROLLS)
        if halts and v < ROLLS:
            return 0.0, LEAST_BRAKE
        wanted = PULL * (self._planned - v)
        if phase.goal is not None and abs(self._planned - phase.goal) > REACHED:
            wanted += math.copysign(phase.pull, phase.goal - self._planned)
        if halts and number in self._places:
            left, decel = self._places[number] - self._front, self._decel(self._maneuvers[number])
            wanted = PULL * (math.sqrt(2 * decel * max(left, 0.0)) - v) - decel
        return pedals_for(wanted, float(self._road.grade(view.s)), v)

    def _steered(self, view: View) -> float:
        """Returns the angle of the front wheels with which the car follows its place sideways."""
        if self._steering is None:
            self._steering = Reference()
            self._steering.start(self._road, self._world, 0)
        return self._steering.steered(view, aside=self._lateral.t, slope=self._lateral.slope)[0]

    @property
    def missed(self) -> tuple[str, ...]:
        """What the car was told to do and has not begun so far, in sentences."""
        found = list(self._skipped)
        if self._begun < len(self._maneuvers):
            each = self._maneuvers[self._begun]
            has_come = each.is_open or {"time", "station"} & {*each.n} or self._begun in self._places
            why = "the drive ended before" if has_come else "what it waits for did not come"
            found.append(f"{NEVER} {self._did(self._begun)}: {why}")
        return tuple(found)

    @property
    def limited(self) -> tuple[str, ...]:
        """What it did with less than the scene says, or gave up, in sentences."""
        return tuple(self._said)
