"""Moves one actor of a scene along its way: its actions one after another, each in phases, and what it does
before the first of them.

Speeds change with a constant acceleration. Sideways, an actor moves by half a cosine wave: slowly at first
and at the end, and in the middle with the greatest speed that its action says."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from roadgpt.brief.junctions import Side
from roadgpt.brief.scene import ActorKind, Mark, What, Where
from roadgpt.traffic.actor import STEP, Size
from roadgpt.traffic.following import HARDEST, JAM, idm, time_over
from roadgpt.traffic.way import GRIP, Way

ROLL = 4.0  # s, after which the first action begins whose begin the scene leaves open
LAST = 2.5  # s before a meeting, from which on somebody who is moving no longer matches the tested car
CATCH_UP = 1.0  # s, in which most of the way that is missing before a meeting is made good
MATCHED = 3.0  # m/s^2, with which somebody matches the tested car
SHARPEST = 2.0  # sideways nobody moves faster than the speed ahead divided by this
FAST = 250.0 / 3.6  # m/s, the most that a scene can ask for
BRAKE, STOP, CHANGE = 6.0, 3.0, 2.0  # m/s^2
TURNING = 20.0 / 3.6  # m/s, of vehicles that turn at a junction, at most
LATERAL: Mapping[What, float] = {
    "swerve": 0.5, "drift": 0.5, "cut_in": 1.5, "cut_out": 1.5, "change_lane": 1.0, "overtake": 1.5,
    "merge": 1.0, "pull_out": 1.0, "wrong_way": 1.0,
}  # fmt: skip
"""The greatest speed sideways in m/s."""
PULL: Mapping[str, float] = {
    "car": 2.0, "van": 1.5, "truck": 0.8, "bus": 0.9, "motorcycle": 2.5, "bicycle": 2.5, "animal": 4.0,
}  # fmt: skip
"""The acceleration from rest in m/s^2. The bicycle of Euro NCAP's CBLA reaches 15 km/h within 3.5 m."""
PATH, RUNS, RUNNING_PATH = 1.0, 6.0 / 3.6, 1.5
"""Euro NCAP's persons reach their speed within 1 m (CPNA), or 1.5 m if they run (CPFA)."""


def pull_of(kind: ActorKind, speed: float) -> float:
    """Returns with which acceleration in m/s^2 somebody starts to move who will have this speed in m/s."""
    if kind in ("adult", "child"):
        return max(speed**2 / 2 / (RUNNING_PATH if speed > RUNS else PATH), 0.1)
    return PULL[kind]


def starts(kind: ActorKind, n: Mapping[str, float], usual: float) -> tuple[float, float]:
    """Returns the speed in m/s that somebody comes to from rest, and the acceleration in m/s^2, by the
    numbers of an action; ``usual`` is the speed of which they say nothing."""
    goal = n.get("to", usual)
    return goal, abs(n.get("accel", pull_of(kind, goal)))


class Car(NamedTuple):
    """The tested car as it is seen from its lane: the station of its middle, its speed and how far it has
    come in metres and seconds, and its size."""

    s: float
    v: float
    came: float
    length: float
    width: float

    def after(self, time: float) -> "Car":
        """Returns the car some seconds later if it keeps its speed."""
        return self._replace(s=self.s + self.v * time, came=self.came + self.v * time)


class Deed(NamedTuple):
    """An action with the numbers that were drawn for it, in metres and seconds."""

    what: What
    side: Side | None
    n: Mapping[str, float]
    event: Mark | None = None
    """What somebody else does, on which it begins."""


class Meeting(NamedTuple):
    """Two stations in metres that are to be reached at the same time: that of an actor's middle along its
    way, and that of the tested car's front along its lane."""

    own: float
    car: float


class Phase(NamedTuple):
    """A part of an action."""

    goal: float | None = None
    """The speed in m/s that it comes to, by ``pull``; negative backwards, None: as it is."""
    pull: float = CHANGE
    to: float | None = None
    """Where it moves to sideways, in metres to the left of the way, within ``slides`` seconds."""
    slides: float = 0.0
    lasts: float | None = None
    """After how many seconds it ends at the latest; the speed that is reached by then stays."""
    until: Literal["speed", "there", "passed", "met"] | None = None
    follows: float | None = None
    """The headway in seconds to the tested car that it keeps."""


class Slide(NamedTuple):
    """A movement sideways in half a cosine wave: its begin and its extent in metres, and seconds."""

    begin: float
    by: float
    lasts: float

    @property
    def peak(self) -> float:
        """The greatest speed in m/s."""
        return math.pi / 2 * abs(self.by) / self.lasts


@dataclass(eq=False)
class Act:
    """An actor of a scene on its way. Metres, seconds; ``forward`` is 1, or -1 against the way."""

    kind: ActorKind
    where: Where
    size: Size
    deeds: list[Deed]
    way: Way
    forward: int
    shift: float
    """From a station of its way to that of the tested car's lane beside it."""
    s: float
    t: float
    v: float
    cruise: float
    """The speed that it is to have when it meets the tested car."""
    limit: float
    aside: Callable[["Act", Deed], float]
    """Returns where an action leads to, in metres to the left of the way."""
    events: dict[tuple[str, ...], float]
    """When what has begun and ended in the scene."""
    name: tuple[str, ...] | None
    """How events call it; None for the second of several alike and those behind it."""
    meeting: Meeting | None = None
    waits: bool = False
    """Whether it stands until it has to go to be in time for its meeting."""
    held: tuple[float, float] | None = None
    """How far its middle is ahead of the tested car's at first, and how much faster it is, if it keeps to
    that until its first action."""
    matches: bool = False
    """Whether it comes to its meeting when the tested car does."""
    begun: int = 0
    unseen: Deed | None = None
    """The first action that began when it was gone."""
    phases: list[Phase] = field(default_factory=list)
    clock: float = 0.0
    pull: float = CHANGE
    slide: Slide | None = None
    slope: float = 0.0

    def __post_init__(self) -> None:
        self.v = min(self.v, self.way.bend(self.s, self.t, self.forward)[1])
        self.goal, self.signs = self.v, dict[int, float]()

    @property
    def along(self) -> float:
        """The station along the tested car's lane."""
        return self.s + self.shift

    @property
    def is_gone(self) -> bool:
        """Whether it has left the road, or its way."""
        return self.state() is None and self.forward * (self.s - self.way.length / 2) > 0

    def state(self) -> tuple[float, ...] | None:
        """Returns its state; None while it is not there: its box is not yet, or no longer, on its way."""
        half = 0.0 if self.way.road_stations is None else self.size.length / 2 - 0.01
        if not half <= self.s <= self.way.length - half:
            return None
        x, y, z, heading = self.way.pose(self.s, self.t)
        turned = math.atan(self.slope)
        heading += turned if self.forward > 0 else math.pi - turned
        return x, y, z, heading, math.copysign(math.hypot(self.v, self.v * self.slope), self.v)

    def move(self, time: float, car: Car) -> None:
        """Moves it from a time to STEP later."""
        left = STEP
        if not self.begun:
            self._match(time, car)
        while self.begun < len(self.deeds):
            wait = max(self.wait(self.deeds[self.begun], time, car), 0.0)
            if wait >= left:
                break
            self._go(wait, time, car)
            time, car, left = time + wait, car.after(wait), left - wait
            deed = self.deeds[self.begun]
            self.begun += 1
            self.unseen = self.unseen or (deed if self.is_gone else None)
            self._tell("with", time)
            self.phases = self._phases(deed, car)
            self._enter(time)
        self._go(left, time, car)

    def _tell(self, word: str, time: float) -> None:
        if self.name:
            self.events[word, *self.name, self.deeds[self.begun - 1].what] = time

    def _match(self, time: float, car: Car) -> None:
        """Chooses the speed before the first action, so that it meets the tested car whatever that does."""
        if self.held:
            ahead, faster = self.held
            wanted = car.v + faster + (ahead + faster * time - (self.along - car.s)) / CATCH_UP
            self.goal, self.pull = min(max(wanted, self.cruise / 2), FAST), MATCHED
        elif self.matches:
            eta, self.goal, self.pull = self._eta(car), self.cruise, MATCHED
            self.matches = eta > LAST
            if self.matches and self.meeting:
                missing = self.forward * (self.meeting.own - self.s) - self._planned(eta)
                faster = math.copysign(min(abs(missing) / CATCH_UP, math.sqrt(4.0 * abs(missing))), missing)
                self.goal = min(max(self.cruise + faster, 0.0), 1.5 * self.cruise)

    def _eta(self, car: Car) -> float:
        """The seconds until the tested car is where they meet, at its speed now."""
        assert self.meeting is not None
        return (self.meeting.car - car.s - car.length / 2) / max(car.v, 1e-3)

    def _planned(self, eta: float) -> float:
        """Returns how far it is to be from its meeting so many seconds before it."""
        deed = self.deeds[0] if self.deeds else None
        if deed is None or not {"to", "accel"} & {*deed.n} or {"time", "gap", "headway"} & {*deed.n}:
            return self.cruise * eta
        last, goal = deed.n.get("ttc", LAST), deed.n.get("to", self.cruise)
        pull = abs(deed.n.get("accel", CHANGE))
        return self.cruise * (eta - last) + reach(last, self.cruise, goal, pull)

    def wait(self, deed: Deed, time: float, car: Car) -> float:
        """Returns in how many seconds an action begins, as far as it can be seen now."""
        n, speed = deed.n, max(car.v, 1e-3)
        if deed.event:
            mark = deed.event
            key = (mark.word, mark.of, str(mark.number), str(mark.what))
            return self.events.get(key, math.inf) - time
        if "time" in n:
            return n["time"] - time
        if "distance" in n:
            return (n["distance"] - car.came) / speed
        if "station" in n:
            left = self.forward * (n["station"] - self.along)
            return left / max(abs(self.v), 1e-3) if left > 0 else 0.0
        if "ttc" in n and self.meeting:
            return self._eta(car) - n["ttc"]
        if {"gap", "headway", "ttc"} & {*n}:
            return self._until(n, time, car)
        before = 0.0 if not self.phases else self._left(car) if len(self.phases) == 1 else math.inf
        if deed.what == "turn_off" and self.meeting:
            room = self.meeting.own - self.s - (self.v**2 - n.get("to", TURNING) ** 2) / 2 / STOP
            return max(before, room / max(self.v, 1e-3))
        if self.begun:
            return before
        if self.meeting and self.waits:
            way = self.forward * (self.meeting.own - self.s)
            return self._eta(car) - time_over(0.0, max(way, 0.0), *starts(self.kind, n, self.cruise))
        return self._eta(car) - LAST if self.meeting else ROLL - time

    def _until(self, n: Mapping[str, float], time: float, car: Car) -> float:
        """Returns in how many seconds a gap, a headway or a time to collision is reached, from either side;
        if it is there from the begin on, the action begins after ROLL."""
        gap, rate = self.gap(car), self._rate(car)
        behind = car.v if self.along > car.s else self.v
        if "ttc" in n:
            aim = -rate * n["ttc"]
            if rate >= 0:
                return math.inf
        else:
            aim = n["gap"] if "gap" in n else n["headway"] * behind
        off = gap - aim
        first = self.signs.setdefault(self.begun, off)
        if abs(first) < 0.3:
            return ROLL - time
        if first * off <= 0:
            return 0.0
        return -off / rate if off * rate < 0 else math.inf

    def gap(self, car: Car) -> float:
        """The distance to the tested car from bumper to bumper; of those in other lanes, it is negative where
        they are beside or behind the car."""
        apart = self.along - car.s
        is_one_lane = self.where in ("ahead", "behind", "oncoming")
        return (abs(apart) if is_one_lane else apart) - (self.size.length + car.length) / 2

    def _rate(self, car: Car) -> float:
        """How fast the gap grows."""
        away = self.forward * self.v - car.v
        return -away if self.where in ("ahead", "behind", "oncoming") and self.along < car.s else away

    def _phases(self, deed: Deed, car: Car) -> list[Phase]:  # noqa: C901 - a table
        """Returns what an action consists of, seen from where it begins."""
        n, what, v, t = deed.n, deed.what, self.v, self.t
        lasts, accel = n.get("duration"), n.get("accel") or None
        to = n.get("to")
        out: Phase
        pull = CHANGE if accel is None else abs(accel)

        def aside(place: float, share: float = 1.0) -> Phase:
            width = abs(place - t)
            slides = math.pi / 2 * width / n.get("lateral", LATERAL[what])
            if lasts is not None and "lateral" not in n:
                slides = lasts * share
            slides = max(slides, math.pi * math.sqrt(width / 2 / GRIP), 1e-3)
            goal = to if to is not None else None if accel is None else FAST * (accel > 0)
            return Phase(goal, pull, place, slides, until="there")

        match what:
            case "keep":
                return [Phase(lasts=ROLL if lasts is None else lasts)]
            case "brake":
                return [Phase(min(to or 0.0, v), n.get("decel", BRAKE), lasts=lasts, until="speed")]
            case "stop":
                halt = [Phase(0.0, n.get("decel", STOP), until="speed")]
                speed = v or self.cruise
                waits = [Phase(lasts=lasts), Phase(speed, pull_of(self.kind, speed), until="speed")]
                return halt if lasts is None else halt + waits
            case "speed":
                if to is None and accel is not None:
                    return [Phase(FAST * (accel > 0), pull, lasts=ROLL if lasts is None else lasts)]
                goal = self.limit if to is None else to
                if accel is None and lasts:
                    return [Phase(goal, max(abs(goal - v) / lasts, 1e-6), until="speed")]
                return [Phase(goal, pull, lasts=lasts, until="speed")]
            case "follow":
                headway = max(self.gap(car) - JAM, 0.0) / max(v, 1.0)
                return [Phase(lasts=math.inf if lasts is None else lasts, follows=headway)]
            case "open_gap":
                slower = max(v - 2.0, 0.0)
                slow, again = Phase(slower, 1.0, until="speed"), Phase(v, 1.0, until="speed")
                return [slow, Phase(lasts=max((lasts or 6.0) - 2 * (v - slower), 0.0)), again]
            case "swerve":
                out = aside(self.aside(self, deed), 0.5)
                pause = max((lasts or 0.0) - 2 * out.slides, 0.0)
                return [out, Phase(lasts=pause), out._replace(to=t)]
            case "overtake" if self.forward > 0:
                fast = Phase(max(car.v + 20 / 3.6, v) if to is None else to, pull, until="passed")
                if self.where != "behind":
                    return [fast]
                out = aside(self.aside(self, deed))
                return [out._replace(goal=fast.goal), fast, out._replace(to=t, goal=None)]
            case "overtake":
                out = aside(self.aside(self, deed))
                return [out, Phase(lasts=3.0), out._replace(to=t)]
            case "pull_out":
                goal = self.limit if to is None else to
                out = aside(self.aside(self, deed))
                return [out._replace(goal=goal, pull=pull_of(self.kind, goal) if accel is None else pull)]
            case "drift" | "cut_in" | "cut_out" | "change_lane" | "wrong_way":
                return [aside(self.aside(self, deed))]
            case "reverse":
                back = Phase(-(5 / 3.6 if to is None else to), 1.0, until="speed")
                return [Phase(0.0, STOP, until="speed"), back, Phase(lasts=lasts or math.inf)]
            case "turn_off":
                return [Phase(min(v, TURNING) if to is None else to, STOP, until="met")]
            case _:  # merge, turn_in, turn_across, cross, run_light, run_sign
                goal = self.cruise if to is None else to
                start = pull_of(self.kind, goal) if self.waits else CHANGE
                return [Phase(goal, start if accel is None else pull, until="met")]

    def _enter(self, time: float) -> None:
        """Begins the phase that is next."""
        self.clock = 0.0
        if not self.phases:
            self._tell("after", time)
            return
        phase = self.phases[0]
        if phase.goal is not None:
            self.goal, self.pull = phase.goal, phase.pull
        if phase.to is not None:
            self.slide = Slide(self.t, phase.to - self.t, phase.slides)
            self.slid = 0.0

    def _left(self, car: Car) -> float:
        """Returns after how many seconds the phase ends, as far as it can be seen now."""
        phase, left = self.phases[0], math.inf
        if phase.until == "speed":
            left = abs(self.goal - self.v) / self.pull
        elif phase.until == "there":
            left = (
                0.0 if self.slide is None else max(self.slide.lasts - self.slid, 0.0) / (self._pace() or 1e-9)
            )
        elif phase.until == "passed":
            missing = 10.0 - (self.along - car.s - (self.size.length + car.length) / 2)
            left = missing / max(self.v - car.v, 1e-9)
        elif phase.until == "met":
            far = math.inf if self.meeting is None else self.forward * (self.meeting.own - self.s)
            left = (far + self.size.length) / max(self.v, 1e-9)
        return max(left if phase.lasts is None else min(left, phase.lasts - self.clock), 0.0)

    def _go(self, lasts: float, time: float, car: Car) -> None:
        """Moves it by some seconds from a time on."""
        while lasts > 1e-9:
            part = min(lasts, self._left(car)) if self.phases else lasts
            self._drive(part, car)
            lasts, time, car = lasts - part, time + part, car.after(part)
            self.clock += part
            if self.phases and self._left(car) < 1e-9:
                if self.phases[0].lasts is not None:
                    self.goal = self.v
                del self.phases[0]
                self._enter(time)

    def _pace(self) -> float:
        """How fast the time of a movement sideways passes: slower for who is slow, not at all at rest."""
        assert self.slide is not None
        return min(1.0, abs(self.v) / (SHARPEST * self.slide.peak)) if self.slide.by else 1.0

    def _drive(self, time: float, car: Car) -> None:
        """Moves it by some seconds, within which nothing else begins."""
        if self.phases and self.phases[0].follows is not None:
            pull = idm(self.v, FAST, self.gap(car), car.v, PULL["car"], CHANGE, self.phases[0].follows)
            self.goal, self.pull = (FAST if pull > 0 else 0.0), max(min(abs(pull), HARDEST), 1e-6)
        before, speeds_up = self.v, min(time, abs(self.goal - self.v) / self.pull)
        self.v += math.copysign(self.pull * speeds_up, self.goal - self.v)
        if speeds_up < time:
            self.v = self.goal
        stretch, fastest = self.way.bend(self.s, self.t, self.forward)
        self.v = min(self.v, fastest)
        gone = (before + self.v) / 2 * speeds_up + self.v * (time - speeds_up)
        self.s += self.forward * gone / stretch
        if self.slide is None:
            return
        self.slid += self._pace() * time
        share = self.slid / self.slide.lasts
        if share >= 1.0 - 1e-9:
            self.t, self.slope, self.slide = self.slide.begin + self.slide.by, 0.0, None
            return
        self.t = self.slide.begin + self.slide.by * (1 - math.cos(math.pi * share)) / 2
        aside = math.copysign(self.slide.peak, self.slide.by) * math.sin(math.pi * share)
        self.slope = aside / max(abs(self.v), SHARPEST * self.slide.peak)


def reach(time: float, speed: float, goal: float, pull: float) -> float:
    """Returns how far one comes in some seconds whose speed changes to ``goal`` with ``pull``."""
    changes = min(time, abs(goal - speed) / max(pull, 1e-9))
    last = speed + math.copysign(pull * changes, goal - speed)
    return (speed + last) / 2 * changes + last * (time - changes)
