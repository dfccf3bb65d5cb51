"""Somebody of a scene on its way: it meets the tested car, and does its maneuvers one after another."""

import math
from typing import cast

import numpy as np

from roadgpt.brief.scene import ACCELERATES, ON_ITS_WAY
from roadgpt.network.line import GRIP
from roadgpt.road.speed_profile import GRAVITY
from roadgpt.traffic.actor import STEP, STILL, FloatArray
from roadgpt.traffic.course import Met
from roadgpt.traffic.following import AFTER_CONTACT
from roadgpt.traffic.maneuver import FAST, LATERAL, Phase
from roadgpt.traffic.placing import Placing
from roadgpt.traffic.triggers import LAST

GOES = 2.0  # s before its own meeting, from which on it goes on also if the tested car waits for it
CATCH_UP = 1.0  # s, in which most of the way that is missing before a meeting is made good
MATCHED = 3.0  # m/s^2, with which somebody matches the tested car
PASSED = 10.0  # m, the gap at which one has overtaken
ROUNDED, STEEP = 0.05, 0.1  # m/s^2, by which limits are told, and from which pull on a grade that is


class Performer:
    """An actor of a scene during the drive, in metres and seconds."""

    def __init__(self, placed: Placing, name: tuple[str, str] | None) -> None:
        """Begins where it is ``placed``. What it does has its ``name`` in the events of the scene."""
        self.placed, self.name = placed, name
        self.role, self.size, self.maneuvers = placed.role, placed.size, placed.maneuvers
        self.course, self.lateral, self.longitudinal = placed.course, placed.lateral, placed.longitudinal
        self.triggers = placed.triggers
        self._limited: dict[int, tuple[str, bool]] = {}
        self.hits: bool | None = None
        """Whether it hit the tested car from behind when it first touched it; None if it has not."""
        self.begun, self.shown = 0, set[int]()
        """How many maneuvers have begun, and the numbers of those that it did while it was there."""
        self.since: dict[int, tuple[float, tuple[float, ...] | None]] = {}
        """When each maneuver began, and its state then."""
        self.until: dict[int, float] = {}
        """When each maneuver had ended."""
        self.phases: list[Phase] = []
        self.clock = 0.0
        """The rest of the maneuver that it does, and for how long the first of these phases has lasted."""
        self._matches = placed.matches
        self.is_there, self.foe = True, cast("Performer | None", None)
        """Whether it takes part at all, and whom of the others it is to hit."""
        self._slides: tuple[float, FloatArray] | None = None
        """Its heading and its velocity (x, y) in m/s, after it has hit another one or was hit by it."""

    @property
    def limited(self) -> dict[int, tuple[str, bool]]:
        """Of the maneuvers that ask for more than there is, in words with how much less they were done, and
        whether the scene says the number and the road does not give it; -1 is its speed."""
        slower = f" is slower than {3.6 * self.longitudinal.told:.0f} km/h where it comes to a bend"
        slowed = {-1: (slower, False)} if self.longitudinal.is_slowed else {}
        return slowed | dict(sorted(self._limited.items()))

    @property
    def minds(self) -> bool:
        """Whether it drives behind the tested car as behind others: who comes from behind to overtake it, and
        others who have done all that they do, or are late where they meet it."""
        if self.role.hits:
            return False
        if self.role.where == "behind":
            return any(each.what == "overtake" for each in self.maneuvers)
        has_done, met = self.begun == len(self.maneuvers) and not self.phases, self.triggers.met
        return self.hits is None and (
            self.course.apart(met) < -met.length if self.course.meeting else has_done
        )

    @property
    def has_done(self) -> bool:
        """Whether it has done all that it does, or goes on with the last of that without end."""
        is_last = not self.phases or self.phases[0].lasts == math.inf
        return self.is_there and self.begun == len(self.maneuvers) and is_last

    def state(self) -> tuple[float, ...] | None:
        """Returns its state; None while it is not there: its box is not yet, or no longer, on its way."""
        v, slope, course = self.longitudinal.v, self.lateral.slope, self.course
        is_behind = self.role.where in ("behind", "parked") or bool(self.role.hits)
        is_behind &= not self.placed.stage.world.first_speed
        if not self.is_there or not course.is_there(
            is_behind, v > 0 and len(self.shown) < len(self.maneuvers)
        ):
            return None
        x, y, z, heading = course.way.pose(course.s, self.lateral.t)
        if self._slides is not None:
            heading, (vx, vy) = self._slides
            return x, y, z, heading, float(vx * math.cos(heading) + vy * math.sin(heading))
        turned, turns = math.atan(slope), math.pi * course.backs
        heading += turns + (turned if course.forward > 0 else math.pi - turned)
        return x, y, z, heading, math.copysign(math.hypot(v, v * slope), v) * (-1 if course.backs else 1)

    def move(self, time: float, met: Met) -> None:
        """Moves it from a time to STEP later."""
        self.triggers.time, self.triggers.met, left = time, met, STEP
        if self._slides is not None:
            x, y, _ = (self.state() or (0.0, 0.0, 0.0))[:3]
            self.slide(np.array([x, y]), *self._slides, STEP)
            return
        if self.hits:
            self.longitudinal.goal, self.longitudinal.pull, self.phases = 0.0, AFTER_CONTACT, []
            self.longitudinal.v = min(self.longitudinal.v, max(met.v, 0.0))
        elif not self.begun:
            self._match()
        while self.begun < len(self.maneuvers) and not self.hits:
            wait = max(self.triggers.wait(self.maneuvers[self.begun], self._before()), 0.0)
            if wait >= left:
                break
            self._go(wait)
            left -= wait
            self.begun += 1
            self._tell("with")
            self._begin()
            self._show()
            self._enter()
        self._go(left)
        if self.phases:
            self._show()

    def slide(self, place: FloatArray, heading: float, velocity: FloatArray, lasts: float) -> None:
        """Slides for some seconds from a place (x, y) with a velocity (x, y) until it stands."""
        speed = max(float(np.hypot(*velocity)), 1e-9)
        pull = AFTER_CONTACT * min(self.placed.stage.world.site.friction, 1.0)
        left, time = max(speed - pull * lasts, 0.0), min(lasts, speed / pull)
        x, y = place + velocity / speed * (speed + left) / 2 * time
        s, t = self.course.way.locate(x, y)
        self.course.s, self.lateral.t, self.longitudinal.v = float(s), float(t), left
        self._slides, self.phases = (heading, velocity * left / speed), []

    def _match(self) -> None:
        """Chooses the speed before the first maneuver, so that it meets the tested car whatever that does."""
        course, speed, triggers, met = self.course, self.longitudinal, self.triggers, self.triggers.met
        if self.placed.held:
            ahead, faster = self.placed.held
            wanted = (ahead + faster * triggers.time - (course.along - met.s)) / CATCH_UP
            wanted += met.v + faster
            speed.goal, speed.pull = min(max(wanted, speed.cruise / 2), FAST), MATCHED
        elif self._matches and course.meeting:
            eta, cruise, way = course.eta(speed.v, met), speed.cruise, course.meeting.own - course.s
            speed.goal, speed.pull = cruise, MATCHED
            self._matches = eta > LAST and way > self._planned(GOES)
            if self._matches:
                missing = way - self._planned(eta)
                faster = math.copysign(min(abs(missing) / CATCH_UP, math.sqrt(4.0 * abs(missing))), missing)
                least = 0.5 if self.state() or met.v < STILL else 0.0  # else both would wait
                speed.goal = min(max(cruise + faster, least * cruise), 1.5 * cruise)

    def _planned(self, eta: float) -> float:
        return self.triggers.planned(eta, self.maneuvers, self.placed.lead)

    def _begin(self) -> None:
        """Begins the maneuver that is next."""
        maneuver, v, t = self.maneuvers[self.begun - 1], self.longitudinal.v, self.lateral.t
        if maneuver.what in LATERAL:
            by = abs(self.placed.offsets.leads_to(maneuver, self.course.along, t) - t)
            asked = by * (math.pi / maneuver.slides(by, math.inf)) ** 2 / 2
            self._note(asked, self.course.sideways(v), " sideways")
        self.phases = self.triggers.phases(maneuver)

    def _show(self) -> None:
        """Notes that it does what it does, if it is there; who meets the tested car where the scene leaves
        open when, does so on its path and before the car has passed."""
        if not self.begun or self.state() is None:
            return
        maneuver, meeting, met = self.maneuvers[self.begun - 1], self.course.meeting, self.triggers.met
        is_on_its_way = self.course.backs or maneuver.what in ON_ITS_WAY
        if meeting and not self.course.is_along and maneuver.is_open and is_on_its_way:
            left = meeting.own - self.course.s - self.size.length / 2
            if left > met.width or met.s - met.length / 2 > meeting.its:
                return
        self.shown.add(self.begun - 1)

    def _tell(self, word: str) -> None:
        number, time = self.begun - 1, self.triggers.time
        if word == "with":
            self.since[number] = time, self.state()
            if number:
                self.until.setdefault(number - 1, time)
        else:
            self.until.setdefault(number, time)
        if self.name:
            self.triggers.events[word, *self.name, self.maneuvers[number].what] = time

    def _enter(self) -> None:
        """Begins the phase that is next."""
        self.clock = 0.0
        if not self.phases:
            self._tell("after")
            return
        phase = self.phases[0]
        if phase.goal is not None:
            self.longitudinal.goal, self.longitudinal.pull = phase.goal, phase.pull
        if phase.to is not None:
            self.lateral.slide_to(phase.to, phase.slides)

    def _before(self) -> float | None:
        """Returns after how many seconds the maneuver that it does has ended; None before the first one."""
        if not self.begun:
            return None
        return 0.0 if not self.phases else self._left() if len(self.phases) == 1 else math.inf

    def _left(self) -> float:
        """Returns after how many seconds the phase ends, as far as it can be seen now."""
        phase, left, v, course = self.phases[0], math.inf, self.longitudinal.v, self.course
        if phase.until == "speed":
            most = self.longitudinal.room(self.longitudinal.goal > v)
            left = abs(self.longitudinal.goal - v) / min(self.longitudinal.pull, most)
        elif phase.until == "there":
            left = self.lateral.left(v)
        elif phase.until == "passed":
            met = self.triggers.met
            left = (PASSED - (course.along - met.s - self.placed.half)) / max(v - met.v, 1e-9)
        elif phase.until == "met" and course.meeting:
            left = (course.forward * (course.meeting.own - course.s) + self.size.length) / max(v, 1e-9)
        return max(left if phase.lasts is None else min(left, phase.lasts - self.clock), 0.0)

    def _go(self, lasts: float) -> None:
        """Moves it, and the tested car as fast as it is, by some seconds."""
        while lasts > 1e-9:
            part, met = min(lasts, self._left()) if self.phases else lasts, self.triggers.met
            self._drive(part)
            self.triggers.time, self.triggers.met = (
                self.triggers.time + part,
                met._replace(s=met.s + met.v * part),
            )
            self.clock, lasts = self.clock + part, lasts - part
            if self.phases and self._left() < 1e-9:
                if self.phases[0].lasts is not None:
                    self.longitudinal.goal = self.longitudinal.v
                del self.phases[0]
                self._enter()

    def _drive(self, time: float) -> None:
        """Moves it by some seconds, within which nothing else begins."""
        follows = self.phases[0].follows if self.phases else None
        if follows is not None:
            self.longitudinal.follow(self.triggers.met, follows)
        asked, most, since = self.longitudinal.pull, self.longitudinal.most(), self.course.s
        if self.phases and follows is None:
            self._note(asked, most)
        gone = self.longitudinal.step(time, min(asked, most))
        self.lateral.step(self.course, since, self.longitudinal.v, gone, time)

    def _note(self, asked: float, most: float, where: str = "") -> None:
        """Notes that its maneuver asks for more than there is."""
        if asked > most + ROUNDED:
            course, world = self.course, self.placed.stage.world
            _, _, falls = course.way.room(course.s, 0.0)
            mu = world.site.friction
            if course.way is course.lane:
                mu = world.friction_at(course.lane.to_road(course.s))
            if abs(falls) > STEEP:
                where += f" on a grade of {100 * abs(math.tan(math.asin(falls / GRAVITY))):.0f} %"
            given = not ACCELERATES.isdisjoint(self.maneuvers[self.begun - 1].n) and bool(most < GRIP)
            said = f" with at most {most:.1f} m/s2, not {asked:.1f}{where}: friction is {mu:g}"
            self._limited.setdefault(self.begun - 1, (said, given))
