"""The hand of a scene's script at the tested car: it does what the scene tells the car to do.

Pedals and wheel are two hands; docs/explanation/who-has-the-wheel.md has the states, and who has which. The
driver is asked at every step, also while it has neither. Where the car changes lanes, overtakes or passes
somebody, the lane that it is to keep to moves: the driver is started again for a road whose driven lane is
the new one. In a test, the robot drives until the event begins, and the drive ends AFTER it is past."""

import math
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from roadgpt.brief.scene import AROUND, CAR, ENDED, NEVER, Event, Mark
from roadgpt.drive.drive import PEDALS, RETURNS, RUN_IN, SCRIPT, Box, GivenTask, LaneMove
from roadgpt.drive.drivers.reference import Reference
from roadgpt.drive.drivers.robot import Robot
from roadgpt.drive.driving_line import BEFORE_LINE, pedals_for
from roadgpt.drive.keeping_distance import HALTED, LEAST_BRAKE, ROLLS
from roadgpt.drive.shunt import Shunt
from roadgpt.drive.view import DrivingTask, View
from roadgpt.errors import DriverError, SceneError
from roadgpt.geometry import wrap_angle
from roadgpt.language.names import Side
from roadgpt.language.table import CUES, MANEUVERS, THINGS, VEHICLES
from roadgpt.network.line import driven_line
from roadgpt.traffic.actor import STILL
from roadgpt.traffic.course import Course, Met
from roadgpt.traffic.lateral import Lateral, Offsets
from roadgpt.traffic.longitudinal import Longitudinal
from roadgpt.traffic.maneuver import CHANGE, FAST, LATERAL, ROLL, STOP, Maneuver, Phase, drawn
from roadgpt.traffic.places import SIGN, offset_of, stretch_of
from roadgpt.traffic.traffic import T0, Stage
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
HOLDS = 0.1  # share of full braking, with which a driver only holds its speed on a slope
LONGER, SETTLES = 1.2, 0.5  # share and s, by which a change of speed may last longer than it is told to
STEADY = 0.5  # m/s, of changes of speed that are too small to be compared
AT_FIRST = 30 / 3.6  # m/s, to which it pulls out, if nothing is said
LONG = 20.0  # s, for which it has not come into a lane, and stands: more than a change and a contact take
NEAREST = 0.3  # m before the place where it stops
BACK = 0.5  # m/s, with which it is steered back at most
FAR = 1e6  # m, to nobody
TIGHTEST = 8.0  # m, the radius of a slow movement sideways: near full lock
CLEAR = 1.0  # m, beside whom it passes
CLEAR_OF_PEOPLE = 1.5  # m, also of who rides a bicycle: Germany, StVO, section 5, in towns
EARLY = 1.0  # s, before it would have to begin to go around somebody
FOLLOWING = 2.0  # s of headway, with which it still follows whom it overtakes
EDGE = 0.2  # m, from the edge of the shoulder, or the road, where it pulls over
ROW, CONES = 15.0, 1.5  # m between those that stand in one row; s at the limit between cones of roadworks
PASSED = {"overtake": 10.0, "pass": 2.0}  # m, behind its rear, where it goes back
TASKS = ("speed", "brake", "stop", "creep", "change_lane")
"""What a driver may do itself."""
INTO_LANE = ("change_lane", "pull_out", "pull_over")
ERRORS = ("run_light", "run_sign")
"""What it does although the driver brakes."""
EMERGENCY, CLOSE, SOON, SIDEWAYS = 0.6, 8.0, 3.0, 15.0
"""Share of full braking from which on the driver's counts there, if somebody is so near: m, s, m aside."""
EARLY_ERROR = 3.0  # s before a line that it runs over, or a corner that it cuts
LANE = 3.5  # m, usual width
CORNER = math.radians(25.0)  # less is no turn at a junction
AFTER = 4.0  # s that a test goes on when its event is over: as long as it began before (T0)
LEAVES = 0.1  # m/s, with which it moves farther out of its lane: lane support begins from 0.2 on


class ScriptHand:
    """What a scene tells the tested car to do, during one drive."""

    def __init__(
        self,
        road: "Road",
        world: "World",
        box: Box,
        seed: int,
        traffic: "Traffic | None",
        driver: object = None,
    ) -> None:
        """Draws the numbers. What the ``driver`` follows it does itself. Raises SceneError if the road has no
        place that an action names, DriverError if there is no such task."""
        follows = getattr(driver, "follows", ())
        if wrong := sorted({*follows} - {*TASKS}):
            raise DriverError(
                f"a driver cannot follow {', '.join(wrong)}; name some of {', '.join(TASKS)} in its follows"
            )
        self._follows, self._tasks = frozenset(follows), dict[int, GivenTask]()
        self._seed, self._world, self._box, self._traffic = seed, world, box, traffic
        self.road = road
        """That whose driven lane is the one that the car is to keep to."""
        self._line, rng = driven_line(road, world), np.random.default_rng([seed, *OWN])
        self._maneuvers, whats = list[Maneuver](), [each.what for each in world.scene.actions]
        self._places = dict[int, float]()
        """Where the car stands that stops before a place: the station of its front along the line."""
        self._stretches = dict[int, tuple[float, float, float]]()
        """Where it errs: from where to where along the line, and to which side."""
        self._shunt: Shunt | None = None
        self._ends = dict[int, float]()
        """Where the front of the car is when it has changed lanes before a place."""
        for number, action in enumerate(world.scene.actions):
            self._maneuvers.append(Maneuver(action, drawn(action, rng), whats[:number].count(action.what)))
            self._put(number)
        if world.scene.stands and whats[:1] == ["wait"]:  # it does so from the begin on
            self._maneuvers[0].rolls = 0.0
        self._nobody = Met(FAR, 0.0, box.length, box.width)
        self._lateral, self.moves = Lateral(), tuple[LaneMove, ...]()
        self._lane = 0.0
        """How far the lane to which it goes back is to the left of that in which it was at first."""
        if world.scene.offset is not None or world.scene.parks:
            self.moves = (LaneMove(-2.0, -1.0, self._aside_at_first(road, rng)),)
            road = road.with_profile(world.profile_of(road).moved(*self.moves[0]))
        self._follow(road)
        self._begun, self._phases = 0, list[Phase]()
        self._since = self._planned = self._v = 0.0
        """When the phase began, the speed that it has planned for now, and that at its begin."""
        self._firm = 0.0
        """For how many seconds the driver has braked firmly."""
        self._stands = world.scene.stands
        self._said, self._skipped = list[str](), list[str]()
        self._did_it = dict[int, Event]()
        """The events of maneuvers that have begun, or never will."""
        self._around = ""
        """Who is overtaken or passed."""
        self.has_crashed, self._hand = False, cast("str | None", None)
        event = "past" if traffic is None else traffic.event
        self._has_event = world.scene.is_test and (bool(self._maneuvers) or event != "past")
        is_robot = getattr(driver, "name", "") == Robot.name
        self._robot, self._runs_in = Robot(), self._has_event and not self._stands and not is_robot
        if self._runs_in:
            self._robot.start(self.road, world, seed)
        self._is_due, self._calm, self._away = False, 0.0, 0.0
        """Whether the event has begun, for how many seconds it has been over, and how far the car was from
        the middle of its lane."""

    def _watch(self, view: View) -> None:
        """Notes whether the event of a test has begun, and for how long it has been over."""
        event = "past" if self._traffic is None else self._traffic.event
        near = self._front + T0 * self._speed.v
        enters = any(self._line.from_road(way.line) < near for way in self.road.passages[:1])
        self._is_due = self._is_due or enters or bool(self._begun) or event == "now"
        before, self._away = self._away, abs(self._aside(view))
        phase = self._phases[0] if self._phases else None
        is_held = phase and self._speed.v < HALTED and (phase.until == "speed" or phase.lasts == math.inf)
        is_done = self._begun == len(self._maneuvers) and (is_held or not self._phases)
        is_over = is_done and self._is_due and event == "past" and self._away - before < LEAVES * view.dt
        self._calm = self._calm + view.dt if is_over else 0.0

    def _aside_at_first(self, road: "Road", rng: np.random.Generator) -> float:
        """Returns how far to the left of its lane it is at first."""
        scene, s = self._world.scene, self._world.start_on(road)
        if scene.parks is None:
            return drawn(scene, rng)["offset"]
        return offset_of("parked", scene.parks, s, road, self._world, self._box.width)

    def _follow(self, road: "Road") -> None:
        """Takes a road whose driven lane is the one that the car is to keep to."""
        self.road, self._line, box = road, driven_line(road, self._world), self._box
        self._course = Course(self._line, self._line, box.length, 1, True, False, True, False)
        self._speed = Longitudinal(
            self._course, self._lateral, "car", self._world.first_speed, self._world.first_speed
        )
        stage = Stage(road, self._world, self._seed)
        offsets = Offsets(stage, self._course, "ahead", None, {}, None, box.width, box.width)
        self._triggers = Triggers(
            self._course, offsets, self._lateral, self._speed, self._nobody, {}, waits=False
        )
        self._steering: Reference | None = None

    def _long(self, by: float, lateral: float) -> float:
        """Returns how many metres along the road it moves sideways: a cubic with this greatest speed."""
        return max(self._speed.v * 1.5 * abs(by) / lateral, math.pi * math.sqrt(abs(by) * TIGHTEST / 2))

    def _move(self, by: float, lateral: float) -> None:
        """Moves the lane by some metres to the left, with a speed sideways of at most so many m/s."""
        s = self._line.to_road(self._course.s - self._box.ahead)
        self._lay(LaneMove(s, s + self._long(by, lateral), by))

    def _stay(self, s: float, back: float) -> None:
        """Stays in the lane that it has at a station, if so many metres before that it had another one."""
        profile, end = self._world.profile_of(self.road), s - back - self._box.length
        if by := profile.aside_at(s) - profile.aside_at(end):
            self._lay(LaneMove(end - 1.0, end, by))

    def _lay(self, move: LaneMove) -> None:
        """Moves the lane between two stations."""
        s, triggers, v = self._line.to_road(self._course.s - self._box.ahead), self._triggers, self._speed.v
        self.moves = (*self.moves, move)
        self._follow(self.road.with_profile(self._world.profile_of(self.road).moved(*move)))
        self._course.s, self._speed.v = self._line.from_road(s) + self._box.ahead, v
        self._triggers.time, self._triggers.signs = triggers.time, triggers.signs
        self._lateral.t, self._lateral.slope, self._lateral.slide = 0.0, 0.0, None

    def _put(self, number: int) -> None:
        """Finds the place of a maneuver that the scene names by a part of the route."""
        each, line = self._maneuvers[number], self._line
        mark, n = each.action.at, each.n
        if each.what in (*ERRORS, "cut_corner"):
            self._stretches[number] = self._stretch(each)
        if "distance" in n:
            n["station"] = line.from_road(self._world.start_on(self.road)) + n.pop("distance")
        if mark is None or mark.what:
            return
        first, last = stretch_of(mark, self.road, line)
        if mark.word == "before" and each.what == "change_lane":
            self._ends[number] = first
            return
        if each.what not in ("stop", "wait") or mark.word != "before":
            n["station"] = {"after": last, "in": (first + last) / 2, "before": first}[mark.word]
            return
        ways = [way for way in self.road.passages if abs(line.from_road(way.start) - first) < NEAREST]
        at = line.from_road(ways[0].line) if ways and mark.of == "junction" else first
        self._places[number] = at - BEFORE_LINE

    def _stretch(self, maneuver: Maneuver) -> tuple[float, float, float]:
        """Returns where along the line it errs, up to where, and to which side it cuts a corner."""
        line, road, what = self._line, self.road, maneuver.what
        found = list[tuple[float, float, float]]()
        for way in road.passages:
            turn = float(wrap_angle(road.heading(way.end) - road.heading(way.start)))
            if what == "cut_corner" and abs(turn) > CORNER:
                found.append((way.start, way.end, math.copysign(1.0, turn)))
            elif way.control in {"run_light": ("lights",), "run_sign": ("stop", "yield")}.get(what, ()):
                found.append((way.line, way.end, 0.0))
        if what == "cut_corner" and not found:
            start, end = stretch_of(Mark(word="in", of="turn", number=1), road, line)
            turn = float(wrap_angle(road.heading(line.to_road(end)) - road.heading(line.to_road(start))))
            return start, end, math.copysign(1.0, turn)
        if not found:
            lacks = {"run_light": "traffic lights", "run_sign": "sign to give way at"}[what]
            raise SceneError(f"the tested car {MANEUVERS[what].said}, and the road has no {lacks}")
        start, end, side = found[0]
        return line.from_road(start), line.from_road(end), side

    def _through(self, maneuver: Maneuver, start: float, end: float, side: float) -> list[Phase]:
        """Returns what it does where it errs: it goes on as fast as it is, or cuts the corner."""
        if maneuver.what in ERRORS:
            return [Phase(self._speed.v, CHANGE, until="beyond")]
        by, v = side * maneuver.n.get("shift", LANE / 2), max(self._speed.v, 1.0)
        middle = ((start + end) / 2 - self._front) / v
        slides = max(min(middle, math.pi / 2 * abs(by) / LATERAL["drift"]), math.sqrt(abs(by)))
        return [
            Phase(to=by, slides=slides, until="there"),
            Phase(until="beyond"),
            Phase(to=0.0, slides=slides, until="there"),
        ]

    @property
    def _front(self) -> float:
        return self._course.s + self._box.length / 2

    def shared(self, view: View, command: Pedals) -> tuple[Pedals, str | None]:
        """Returns the command that counts, of the driver's and the script's, and the name of the script's
        hands; None if it has none. Call it once for every control step. Nothing begins or ends any more once
        the car ``has_crashed``: it brakes then whatever anybody says."""
        if not self.has_crashed:
            command, self._hand = self._shared(view, command)
        return command, self._hand

    def _shared(self, view: View, command: Pedals) -> tuple[Pedals, str | None]:
        self._see(view)
        self._go_on(view)
        self._begin_in_time(view)
        if self._has_event or self._world.scene.stays:
            self._watch(view)
        if self._runs_in and not self._is_due:
            return self._robot.steer(view), RUN_IN
        if self._is_task:
            return command, None
        if not self._phases and not (self._stands and not self._begun):
            if self._is_left_parked and not self.is_over:  # its driver pulls out
                self._move(self._back(), LATERAL["pull_out"])
            return command, None
        if self._phases and self._phases[0].until == "shunted" and self._shunt is not None:
            return self._shunt.command(view), SCRIPT
        steer, throttle, brake = command
        steers = self._hands != "pedals"
        errs = bool(self._begun and self._phases) and self._maneuvers[self._begun - 1].what in ERRORS
        if errs and not (brake > EMERGENCY and self._meets_somebody(view)):
            brake = 0.0
        if not steers or (self._phases and (self._phases[0].goal is not None or not self._phases[0].until)):
            own_throttle, own_brake = self._pedals(view)
            throttle, brake = own_throttle if brake <= own_brake + HOLDS else 0.0, max(brake, own_brake)
            brake = 0.0 if throttle else brake
        return (self._steered(view) if steers else steer, throttle, brake), SCRIPT if steers else PEDALS

    def _meets_somebody(self, view: View) -> bool:
        """Whether somebody is close before the car, or about to come from a side."""
        if self._traffic is None:
            return False
        x, y = (self._traffic.at(view.time)[:, :2] - (view.x, view.y)).T
        cos, sin = math.cos(view.heading), math.sin(view.heading)
        ahead, aside = x * cos + y * sin, y * cos - x * sin
        near = (ahead > 0.0) & (ahead < CLOSE + SOON * view.speed) & (np.abs(aside) < SIDEWAYS)
        return bool(near.any())

    @property
    def _is_left_parked(self) -> bool:
        """Whether it has done everything, and is still parked as at first."""
        is_done = self._begun == len(self._maneuvers) and not self._phases
        return is_done and self._world.scene.parks is not None and len(self.moves) == 1

    @property
    def is_over(self) -> bool:
        """Whether the drive ends, because its event is over, or it has done everything and the car stays
        where it is parked, or has turned round."""
        if self._calm > AFTER:
            return True
        if self._begun == len(self._maneuvers) and not self._phases and self._shunt is not None:
            return self._maneuvers[-1].what == "u_turn"
        return self._is_left_parked and all(each.what != "release" for each in self._maneuvers)

    @property
    def _is_task(self) -> bool:
        """Whether its driver does now what the scene tells."""
        return bool(self._phases) and self._begun - 1 in self._tasks

    @property
    def is_changing(self) -> bool:
        """Whether its driver changes lanes now by itself."""
        return any(
            each.what == "change_lane" and self._triggers.time <= each.end for each in self._tasks.values()
        )

    @property
    def tasks(self) -> tuple[GivenTask, ...]:
        """What its driver was to do itself so far."""
        return tuple(self._tasks.values())

    @property
    def task(self) -> DrivingTask | None:
        """What its driver is to do itself, now or next."""
        number = self._begun - 1 if self._is_task else self._begun
        if number >= len(self._maneuvers) or self._maneuvers[number].what not in self._follows:
            return None
        each = self._maneuvers[number]
        n = {name: value for name, value in each.n.items() if name not in CUES}
        if number in self._places:
            n["distance"] = self._places[number] - self._front
        if self._is_task and each.what != "change_lane":
            goal = self._phases[0].goal
            n |= {"to": 0.0 if goal is None else goal, "accel": self._phases[0].pull}
        return DrivingTask(each.what, n, each.action.side, self._is_task)

    def _hand_over(self, number: int, view: View) -> None:
        """Gives the driver as a task what begins."""
        each, v, phase, at = self._maneuvers[number], self._speed.v, self._phases[0], None
        if each.what == "change_lane":
            start, at, goal = self.moves[-1]
            lasts = (at - start) / max(v, 1.0)
        else:
            goal = phase.goal or 0.0
            lasts = abs(v - goal) / phase.pull
            if number in self._places:
                at, lasts = self._line.to_road(self._places[number] + BEFORE_LINE), lasts + v / STOP
        end = view.time + LONGER * lasts + RETURNS
        self._tasks[number] = GivenTask(self._did(number), each.what, view.time, end, goal, at)

    def _see(self, view: View) -> None:
        before, self._speed.v = self._speed.v, max(view.vx, 0.0)
        self._course.s = self._line.from_road(view.s) + self._box.ahead
        self._triggers.time = view.time
        by_driver = not self._is_task and (not self._phases or self._hands == "wheel")
        is_firm = by_driver and before - self._speed.v > FIRM * view.dt
        self._firm = self._firm + view.dt if is_firm else 0.0
        did = f"while {self._did(self._begun - 1)}" if self._phases and self._is_refused else ""
        if did and self._turns_back(view):
            self._give_up(did, view)

    def _turns_back(self, view: View) -> bool:
        """Steers back to the middle of the lane, if it is on its way from there, and not beside whom it goes
        around."""
        if self._lateral.end != 0.0:
            self._lateral.slide_to(0.0, max(math.pi / 2 * abs(self._lateral.t) / BACK, view.dt))
            self._phases = [Phase(to=0.0, slides=1.0, until="there")]
            if self._maneuvers[self._begun - 1].what == "cut_corner":
                self._skipped.append(f"{NEVER} {self._did(self._begun - 1)}: it was given up")
            return True
        is_out = bool(self._around) and len(self._phases) > 1
        _, met, _ = self._met(self._around) if is_out else ("", self._nobody, 0.0)
        if not is_out or met.s - met.length / 2 < self._front:
            return False
        del self._phases[:-1]
        self._skipped.append(f"{NEVER} {self._did(self._begun - 1)}: it was given up")
        self._enter(view)
        return True

    @property
    def _is_refused(self) -> bool:
        """Whether the driver brakes firmly."""
        return self._firm > LASTS - 1e-9

    def _give_up(self, when: str, view: View) -> None:
        by = f"its driver braked with more than {FIRM:g} m/s2 at {view.time:.1f} s"
        self._said.append(f"the script gave up {when}: {by}")
        number = self._begun - 1
        event = self._did_it.get(number) or Event(CAR, self._maneuvers[number].said)
        self._did_it[number] = replace(event, until=event.time and view.time, why=f"given up: {by}")

    @property
    def _hands(self) -> str:
        """The hands that it needs for what it does, or for waiting for the first thing to do."""
        return MANEUVERS[self._maneuvers[self._begun - 1].what].hands if self._begun else "pedals"

    def _did(self, number: int) -> str:
        """Returns in words what a maneuver is."""
        each = self._maneuvers[number]
        whom = each.action.whom or (self._around if number == self._begun - 1 else "")
        return f"the tested car {MANEUVERS[each.what].said}{whom and ' '}{whom}{' again' * each.before}"

    def _met(self, name: str | None = None) -> tuple[str, Met, float]:
        """Returns who is ahead in the lane of the tested car, or has a name: its name, how it is seen from
        there, and how far its middle is to the left of that. Those that stand in one row with it count as
        one with who has a name."""
        if self._traffic is None:
            return "", self._nobody, 0.0
        actors, states = self._traffic.actors, self._traffic.at(self._triggers.time)
        boxes = self._line.boxes(states, np.array([each.size[:2] for each in actors]).reshape(-1, 2))
        ahead = boxes.along - self._course.s
        is_it = np.array([each.name == name for each in actors], bool)
        is_it = (is_it if name else (ahead > 0) & self._line.holds(boxes)) & np.isfinite(ahead)
        if not is_it.any():
            return "", self._nobody, 0.0
        first = int(np.where(is_it, ahead, np.inf).argmin())
        half, wide = (float(each[first]) for each in boxes.reach)
        low, high = float(boxes.along[first]) - half, float(boxes.along[first]) + half
        left, right = float(boxes.t[first]) + wide, float(boxes.t[first]) - wide
        stands, aside = np.hypot(*boxes.velocity.T) < STILL, np.abs(boxes.t - boxes.t[first])
        are_cones, far = actors[first].kind in THINGS, ROW
        in_row = stands & stands[first] & np.isfinite(ahead) & (aside < boxes.reach[1] + wide)
        if are_cones:  # of roadworks, which lead aside
            far, one = (
                max(ROW, CONES * self._world.limits.speed_limit),
                self._line.width_at(boxes.along[first]),
            )
            in_row = [each.kind in THINGS for each in actors] & stands & (aside < one)
        for each in (
            np.argsort(np.abs(ahead - ahead[first])) if name or are_cones else ()
        ):  # the nearest first
            begin, end = boxes.along[each] - boxes.reach[0][each], boxes.along[each] + boxes.reach[0][each]
            if in_row[each] and begin - far < high and end + far > low:
                low, high = min(low, float(begin)), max(high, float(end))
                if are_cones:
                    t, half = float(boxes.t[each]), float(boxes.reach[1][each])
                    left, right = max(left, t + half), min(right, t - half)
        met = Met((low + high) / 2, float(boxes.velocity[first, 0]), high - low, left - right)
        return actors[first].name, met, (left + right) / 2

    def _begin_in_time(self, view: View) -> None:
        """Begins what is next if it is time."""
        while self._begun < len(self._maneuvers):
            number, each = self._begun, self._maneuvers[self._begun]
            if each.event and self._traffic is not None:
                self._triggers.events = self._traffic.events
            if {"gap", "headway", "ttc"} & {*each.n}:
                self._triggers.met = self._met()[1]
            if number in self._places and self._places[number] < self._front:
                self._did_it[number] = Event(CAR, each.said, why="it had passed the place before")
                self._skipped.append(f"{NEVER} {self._did(number)}: {self._did_it[number].why}")
                self._begun, self._phases = number + 1, []
                continue
            if self._wait(number, each) >= view.dt:
                return
            self._begun += 1
            if self._is_refused:
                self._give_up(f"before {self._did(number)}", view)
                self._phases = []
                continue
            if self._phases:
                self._tell("after", self._maneuvers[number - 1], view)
            self._tell("with", each, view)
            self._lateral.t, self._lateral.slide = self._aside(view), None
            if each.what in (*AROUND, *INTO_LANE):
                self._go_aside(each, view)
            elif each.what in ("reverse", "u_turn"):
                self._shunt = Shunt(self.road, self._world, self._box, each, view)
                if each.what == "reverse":
                    self._stay(view.s, self._shunt.reach)
                self._phases = [Phase(0.0, STOP, until="speed"), Phase(until="shunted")]
            elif number in self._stretches:
                self._phases = self._through(each, *self._stretches[number])
            else:
                self._phases = [] if each.what == "release" else self._triggers.phases(each)
            rest = self._maneuvers[self._begun :]
            creeps = each.what == "creep"
            is_waiting = not rest[0].is_open if rest else self._world.scene.stays
            is_waiting |= creeps and self._begun in (*self._places, *self._ends, *self._stretches)
            if "duration" not in each.n and (creeps or (each.what in ("stop", "pull_over") and is_waiting)):
                self._phases.append(Phase(lasts=math.inf if is_waiting else ROLL))
            if self._phases:
                self._enter(view)
                if each.what in self._follows:
                    self._hand_over(number, view)

    def _wait(self, number: int, maneuver: Maneuver) -> float:
        """Returns in how many seconds a maneuver begins, as far as it can be seen now."""
        v, before = self._speed.v, None if not number else math.inf if self._phases else 0.0
        if maneuver.what in AROUND and maneuver.is_open:
            return self._until_around(maneuver, before)
        if number in self._places:
            left = self._places[number] - self._front
            return 0.0 if v**2 / 2 / max(left, NEAREST) >= self._decel(maneuver) else math.inf
        if number in self._ends:
            by = float(self._line.width_at(self._course.s))
            left = self._ends[number] - self._front
            return 0.0 if left <= self._long(by, self._sideways(maneuver, by)) else math.inf
        if number in self._stretches and maneuver.is_open:
            early = max(v * EARLY_ERROR, self._long(LANE, LATERAL["drift"]) / 2)
            return 0.0 if self._stretches[number][0] - self._front <= early else math.inf
        return self._triggers.wait(maneuver, before)

    def _tell(self, word: str, maneuver: Maneuver, view: View) -> None:
        number = self._maneuvers.index(maneuver)
        event = self._did_it.get(number) or Event(CAR, maneuver.said, view.time, view.s)
        self._did_it[number] = event if word == "with" else replace(event, until=view.time)
        if self._traffic is not None:
            self._traffic.tell((word, "ego", "1", maneuver.what), view.time)

    def _until_around(self, maneuver: Maneuver, before: float | None) -> float:
        """Returns in how many seconds it begins to go around somebody."""
        name, met, t = self._met(maneuver.action.whom)
        if before == math.inf or not name:
            return math.inf
        by, v = self._by(maneuver, name, met, t), self._speed.v
        lasts = 1.5 * abs(by) / self._sideways(maneuver, by)
        gap = met.s - self._course.s - (met.length + self._box.length) / 2
        return 0.0 if gap <= max((v - met.v) * (lasts + EARLY), FOLLOWING * v + NEAREST) else math.inf

    @staticmethod
    def _sideways(maneuver: Maneuver, by: float) -> float:
        """Returns the greatest speed in m/s with which a maneuver moves it sideways by some metres."""
        n = maneuver.n
        if "duration" in n and "lateral" not in n and maneuver.what != "pull_over":
            return max(1.5 * abs(by) / n["duration"], NEAREST)
        return n.get("lateral", LATERAL[maneuver.what])

    def _by(self, maneuver: Maneuver, name: str, met: Met, t: float) -> float:
        """Returns by how many metres to the left it goes around somebody."""
        profile, s = self._world.profile_of(self.road), self._line.to_road(self._course.s)
        inner: Side = "right" if profile.left_hand else "left"
        side = maneuver.action.side or inner
        if maneuver.what == "pass":
            is_person = name.rpartition(" ")[0] not in (*VEHICLES, *THINGS) or name.startswith("bicycle")
            free = (met.width + self._box.width) / 2 + (CLEAR_OF_PEOPLE if is_person else CLEAR)
            by = t + SIGN[side] * free
            return by if by * SIGN[side] > 0 else 0.0
        try:
            return offset_of("lane", inner, s, self.road, self._world, self._box.width)
        except SceneError:
            return offset_of("oncoming", None, s, self.road, self._world, self._box.width)

    def _go_aside(self, maneuver: Maneuver, view: View) -> None:
        """Begins to change lanes, or to go around somebody; raises SceneError if there is no lane."""
        n, accel = maneuver.n, maneuver.n.get("accel")
        goal = n.get("to", None if accel is None else FAST * (accel > 0))
        there = Phase(goal, abs(accel or CHANGE), until="there")
        if maneuver.what == "pull_out" and goal is None and self._speed.v < ROLLS:
            there = there._replace(goal=min(AT_FIRST, self._world.limits.speed_limit))
        if maneuver.what in ("pull_out", "pull_over"):
            profile, s = self._world.profile_of(self.road), self._line.to_road(self._course.s)
            by, self._phases = self._back(), [there]
            if maneuver.what == "pull_over":
                rims, kerb = profile.rims(s), "left" if profile.left_hand else "right"
                side = SIGN[maneuver.action.side or kerb]
                edge = float(rims.left if side > 0 else rims.right)
                by = edge - side * (self._box.width / 2 + EDGE) - float(profile.middle(s))
                self._phases.append(Phase(0.0, STOP, until="speed"))
                self._phases += [Phase(lasts=n["duration"])] if "duration" in n else []
            self._move(by, self._sideways(maneuver, by))
            return
        if maneuver.what == "change_lane":
            at = self._line.to_road(self._course.s), self.road, self._world, self._box.width
            by, self._phases = offset_of("lane", maneuver.action.side, *at), [there]
            self._lane += by - self._back()
            self._move(by, self._sideways(maneuver, by))
            return
        self._around, met, t = self._met(maneuver.action.whom)
        by = self._by(maneuver, self._around, met, t) if self._around else 0.0
        if by:
            self._refuse_off_road(maneuver, by, self._line.to_road(met.s))
            self._move(by, self._sideways(maneuver, by))
        self._phases = [there, there._replace(until="passed"), there]

    def _back(self) -> float:
        """Returns by how many metres to the left it goes back to its lane."""
        s = self._line.to_road(self._course.s - self._box.ahead)
        return self._lane - self._world.profile_of(self.road).aside_at(s)

    def _refuse_off_road(self, maneuver: Maneuver, by: float, s: float) -> None:
        profile = self._world.profile_of(self.road)
        t, edges = float(profile.middle(s)) + by, profile.edges(s)
        lacks = self._box.width / 2 + max(t - float(edges.left), float(edges.right) - t)
        if lacks > 0:
            raise SceneError(
                f"{self._did(self._begun - 1)} at {s:.0f} m, where {lacks:.1f} m of road are missing"
            )

    @staticmethod
    def _decel(maneuver: Maneuver) -> float:
        return maneuver.n.get("decel", STOP)

    def _aside(self, view: View) -> float:
        """Returns how far the car is to the left of the middle of its lane."""
        return view.t - float(self._world.profile_of(self.road).middle(view.s))

    def _enter(self, view: View) -> None:
        """Begins the phase that is next."""
        phase = self._phases[0]
        if self._around and len(self._phases) == 1 and self.moves:
            by = self._back()
            self._move(by, self._sideways(self._maneuvers[self._begun - 1], by))
            self._around = ""
        self._since, self._planned, self._v = view.time, self._speed.v, self._speed.v
        if phase.to is not None:
            self._lateral.slide_to(phase.to, phase.slides)

    def _go_on(self, view: View) -> None:
        """Ends phases that are over, and plans speed and place for now."""
        while self._phases and self._is_over(self._phases[0], view.time - self._since):
            phase = self._phases.pop(0)
            self._compare(phase, view.time - self._since)
            if phase.until == "passed" and self._met(self._around)[1] is self._nobody:
                did = self._did(self._begun - 1)
                self._skipped.append(f"{NEVER} {did}: it had left the road before")
            if self._phases:
                self._enter(view)
            what, stays = self._maneuvers[self._begun - 1].what, bool(self._phases) and self._phases[0].lasts
            if not self._phases or (stays == math.inf and what != "creep"):
                self._tell("after", self._maneuvers[self._begun - 1], view)
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
        task = self._tasks.get(self._begun - 1)
        if task is not None and phase.lasts is None and self._triggers.time > task.end:
            return True
        if phase.lasts is not None and lasted >= phase.lasts - 1e-6:
            return True
        if phase.until == "there":
            gone = (
                not self.moves or self._line.to_road(self._course.s) - self._box.ahead >= self.moves[-1].end
            )
            return gone and self._lateral.slide is None
        if phase.until == "passed":
            _, met, _ = self._met(self._around)
            rear = self._course.s - self._box.length / 2 - met.s - met.length / 2
            return met is self._nobody or rear > PASSED[self._maneuvers[self._begun - 1].what]
        if phase.until == "shunted":
            return self._shunt is not None and self._shunt.is_done
        if phase.until == "beyond":
            return self._front > self._stretches[self._begun - 1][1]
        if phase.until != "speed" or phase.goal is None:
            return False
        v, least = self._speed.v, HALTED if phase.goal == 0 else REACHED
        return v <= phase.goal + least if self._v >= phase.goal else v >= phase.goal - least

    def _compare(self, phase: Phase, lasted: float) -> None:
        """Notes that a change of speed was slower than told."""
        is_other = self._begun - 1 in (*self._places, *self._tasks)
        if phase.goal is None or phase.until != "speed" or is_other:
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
        return pedals_for(wanted, float(self.road.grade(view.s)), v)

    def _steered(self, view: View) -> float:
        """Returns the angle of the front wheels with which the car follows its place sideways."""
        if self._steering is None:
            self._steering = Reference()
            self._steering.start(self.road, self._world, 0)
        return self._steering.steered(view, aside=self._lateral.t, slope=self._lateral.slope)[0]

    @property
    def has_end(self) -> bool:
        """Whether it makes the car stand, or go on, for a time that ends by itself."""
        lasts = self._phases[0].lasts if self._phases else math.inf
        if lasts != math.inf:
            return lasts is not None
        return any("time" in each.n for each in self._maneuvers[self._begun :][:1])

    @property
    def missed(self) -> tuple[str, ...]:
        """What the car was told to do and has not begun so far, in sentences."""
        found = list(self._skipped)
        if self._around and self._phases and not self.has_crashed:
            found.append(f"{NEVER} {self._did(self._begun - 1)}: it had not come past")
        elif self._phases and self._maneuvers[self._begun - 1].what in INTO_LANE:
            stands = self._speed.v < ROLLS and self._triggers.time - self._since > LONG
            if self._phases[0].until == "there" and stands:
                found.append(f"{NEVER} {self._did(self._begun - 1)}: it had not come there")
        if self._begun < len(self._maneuvers):
            found.append(f"{NEVER} {self._did(self._begun)}: {self._why(self._begun)}")
        return tuple(found)

    def _why(self, number: int) -> str:
        """Returns why a maneuver has not begun."""
        each = self._maneuvers[number]
        if number > self._begun:
            return "what it does before that never began"
        comes = each.is_open or bool({"time", "station"} & {*each.n})
        has_come = comes or number in (*self._places, *self._ends)
        return ENDED if has_come else "what it waits for did not come"

    @property
    def history(self) -> tuple[Event, ...]:
        """What the scene makes the car do, each with whether it has happened so far."""
        every = enumerate(self._maneuvers)
        return tuple(self._did_it.get(n) or Event(CAR, each.said, why=self._why(n)) for n, each in every)

    @property
    def limited(self) -> tuple[str, ...]:
        """What it did with less than the scene says, or gave up, in sentences."""
        return tuple(self._said)
