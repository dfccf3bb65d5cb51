"""The mover ``script``: the actors of a scene, who are where it says at first, and do what it says; and its
rows of parked cars."""

import math
from collections import Counter

import numpy as np

from roadgpt.brief.scene import ENDED, HEAD_ON, LATE, LEAVES, MOST_MORE, NEVER, STRUCK, Event, Role
from roadgpt.geometry.boxes import corners, touch
from roadgpt.language.table import MANEUVERS
from roadgpt.network.line import SPACING, driven_line
from roadgpt.traffic.actor import HEADING, SIZES, STEP, STILL, Actor, FloatArray, TestedCar
from roadgpt.traffic.course import Met
from roadgpt.traffic.crash import crash
from roadgpt.traffic.extras import COMES, Extra
from roadgpt.traffic.following import ALONG
from roadgpt.traffic.performer import Performer
from roadgpt.traffic.places import parked_rows, works_rows
from roadgpt.traffic.placing import BEHIND, INTO, ONCOMING, STANDS, Placing
from roadgpt.traffic.traffic import T0, Stage, Stretch

UNCOVERED = 3.0  # s that who changes lanes has left before who stands behind it is reached
IN_SIGHT = 150.0  # m ahead, in which somebody sees others in its lane
BESIDE = 0.2  # m between two who pass each other, at least
LATER = 20.0  # s to a collision, from which on there is no conflict yet: cruise control that follows wavers


def how_many(role: Role, number: int, seed: int) -> int:
    """Returns how many there are of the role of a scene with this number."""
    low = int(role.count.lo or 1)
    high = int(role.count.hi or low + MOST_MORE)
    return int(np.random.default_rng([seed, number]).integers(low, high + 1))


class Script:
    """Moves the actors of a scene, and places its rows of parked cars."""

    def __init__(self, stage: Stage) -> None:
        """Draws the numbers of the scene and places everybody as seen from where the tested car starts.
        Raises SceneError if something of the scene cannot be on this road."""
        self._stage, self._way = stage, driven_line(stage.road, stage.world)
        first = self._way.from_road(stage.world.start_on(stage.road))
        met = Met(first, stage.world.first_speed, *SIZES["car"][:2])
        self._performers = self._placed(met)
        free = [each.course.way.points for each in self._performers if each.course.way is not self._way]
        there = [(np.array(at), each.size) for each in self._performers if (at := each.state())]
        free += [corners(state[:2], state[HEADING], np.array(size)) for state, size in there]
        rows = works_rows(stage.road, stage.world, stage.seed)
        free += [corners(state[:2], state[HEADING], np.array(SIZES[kind])) for kind, state in rows]
        rows += parked_rows(stage.world.scene, stage.road, stage.world, stage.seed, free)
        kinds = [each.role.kind for each in self._performers]
        kinds += [*(each.kind for each in self._extras), *(kind for kind, _ in rows)]
        self.actors = [
            Actor(f"{kind} {kinds[: n + 1].count(kind)}", kind, SIZES[kind]) for n, kind in enumerate(kinds)
        ]
        self._parked = np.array([state for _, state in rows]).reshape(-1, 5)
        self._sizes = np.array([actor.size[:2] for actor in self.actors]).reshape(-1, 2)
        self.happened: dict[str, float] = {}
        """What of the scene has begun, in words, and at which station of its road the tested car was then."""
        self._time, self._meets_in = 0.0, self._to_meeting(met)

    def _placed(self, met: Met) -> list[Performer]:
        """Returns everybody where they are at first, as seen from the tested car."""
        found, kinds = list[Performer](), Counter[str]()
        self._of_role: dict[int, Performer] = {}
        self.crashed = dict[int, tuple[float, float]]()
        """When and where those in some rows hit whom of the others they are to hit."""
        self.events: dict[tuple[str, ...], float] = {}
        """When what the actors do has begun and ended, as ``Maneuver.event`` names it."""
        for number, role in enumerate(self._stage.world.scene.actors):
            kinds[role.kind] += 1
            name, alike = (role.kind, str(kinds[role.kind])), list[Placing]()
            for copy in range(how_many(role, number, self._stage.seed)):
                rng = np.random.default_rng([self._stage.seed, number, copy])
                alike.append(Placing(self._stage, self._way, role, met, rng, alike, self.events))
            found += [Performer(each, None if each.copy else name) for each in alike]
            self._of_role[number] = found[-len(alike)]
        self._order([each.placed for each in found])
        named = {f"{kind} {count}": each for each in found for kind, count in [each.name or ("", "")]}
        for number, aim in self._stage.aims.items():
            each = self._of_role[number]
            each.is_there, each.foe = aim is not None, named.get(str(each.role.hits))
            if aim is not None:
                each.placed.aim(aim)
                each.placed.check()
        does = [(each, n, maneuver.what) for each in found for n, maneuver in enumerate(each.maneuvers)]
        self._extras = [Extra(who, n) for who, n, what in does if what in COMES]
        return found

    def role(self, number: int) -> tuple[Performer, int, int | None]:
        """Returns the first of those of one of the roles of the scene, its row in states, and that of whom
        else it is to hit."""
        who = self._of_role[number]
        foe = None if who.foe is None else self._performers.index(who.foe)
        return who, self._performers.index(who), foe

    def _order(self, everybody: list[Placing]) -> None:
        """Puts those ahead in the tested car's lane behind one another where the scene leaves open where they
        are: who stands beyond whom, and who drives beyond those who stand. Who stands behind somebody that
        leaves the lane is as far from it, where that happens, as the scene says."""
        along = [each for each in everybody if each.course.is_along]
        ahead = [each for each in along if each.role.where == "ahead" and not each.role.at]
        leavers = [each for each in ahead if each.first in LEAVES and each.longitudinal.v > 0]
        last: Placing | None = None
        for each in ahead:
            if each.longitudinal.v == 0 and "station" not in each.n and "lead" not in each.n:
                if leavers and each.copy == 0:
                    gap = each.n.get("gap", UNCOVERED * leavers[0].longitudinal.v)
                    each.put(max(each.course.s, leavers[0].begins + gap + each.between(leavers[0])))
                elif last and (each.copy or not each.is_placed):
                    each.put(max(each.course.s, last.course.s + each.between(last) + STANDS))
                last = each
        for leaver in leavers:
            for each in ahead:
                wide, apart = (each.size.width + leaver.size.width) / 2, each.lateral.t - leaver.lateral.t
                if each.longitudinal.v == 0 and leaver.begins < each.course.s and abs(apart) < wide:
                    leaver.leave(each)
        for each in ahead:
            v, is_open = each.longitudinal.v, each.first not in LEAVES and not each.is_placed
            if last and v > 0 and is_open and each.course.s < last.course.s:
                each.put(last.course.s + each.between(last) + BEHIND * v)
        onto = [each for each in along if each.course.forward < 0 and not each.is_placed]
        ends = self._way.length
        late = [each.course.s + each.size.length / 2 - ends for each in onto if each.first in HEAD_ON]
        spare = min((each.course.s - each.met.s - each.half - ONCOMING for each in onto), default=0.0)
        nearer = min(max(late, default=0.0), spare)
        for each in onto if nearer > 0 else ():  # so that what they begin happens on a short road, too
            each.put(each.course.s - nearer)
        placed = list[Placing]()
        for each in sorted(everybody, key=lambda one: not one.is_placed):
            while inside := next((other for other in placed if each.touches(other)), None):
                each.part(inside)
            while near := next((o for o in placed if not each.is_placed and each.runs_into(o)), None):
                each.part(near)
            placed.append(each)
        for each in everybody:
            each.check()

    def _seen(self, car: TestedCar) -> Met:
        s = self._way.from_road(car.s)
        x, y, _, heading = self._way.pose(s)
        cos, sin, dx, dy = math.cos(heading), math.sin(heading), car.x - x, car.y - y
        return Met(s + dx * cos + dy * sin, car.speed, car.length, car.width, dy * cos - dx * sin)

    def start(self, car: TestedCar, bodies: FloatArray) -> FloatArray:
        """Places everybody as seen from the tested car."""
        del bodies
        self._performers = self._placed(self._seen(car))
        return self._states()

    def move(self, time: float, car: TestedCar, bodies: FloatArray) -> FloatArray:
        """Returns the states of all actors STEP after ``time``. They slow down for others ahead in their
        lane, but not for the tested car, unless they overtake it. Who hits it from behind stops there."""
        seen = self._seen(car)
        if self._stage.world.scene.is_test or self._stage.world.scene.stays:
            self._time, self._meets_in = time, self._to_meeting(seen)
        self._look(bodies, car)
        past = self._states() if self._stage.aims else np.empty((0, 5))
        for each in self._performers:
            _touch(each, car)
            each.move(time, seen)
        for extra in self._extras:
            extra.move()
        for row, each in enumerate(self._performers if self._stage.aims else ()):
            foe = None if each.foe is None else self._performers.index(each.foe)
            if (
                foe is not None
                and row not in self.crashed
                and crash(each, self._performers[foe], past[[row, foe]])
            ):
                s = self._way.to_road(float(self._way.locate(*self._states()[row, :2])[0]))
                self.crashed[row] = time + STEP, s
                self.happened.setdefault(f"{self.actors[row].name} hits {self.actors[foe].name}", car.s)
        for actor, each in zip(self.actors, self._performers, strict=False):
            self.happened |= {
                did: car.s for n in each.shown if (did := _did(actor, each, n)) not in self.happened
            }
        return self._states()

    def _look(self, bodies: FloatArray, car: TestedCar) -> None:
        """Tells everybody how far it is to who is ahead on its way, and how fast that moves along it. Who
        comes onto its way before it is there is seen by those who stand later in the scene."""
        own = (car.x, car.y, 0.0, car.heading, car.speed, car.length, car.width)
        rows = np.vstack([np.hstack([self._states(), self._sizes]), bodies, own])
        ways = {each.course.way for each in self._performers if each.longitudinal.v != 0}
        seen = {way: way.boxes(rows[:, :5], rows[:, 5:]) for way in ways}
        for number, each in enumerate(self._performers):
            v, lateral, course = each.longitudinal.v, each.lateral, each.course
            each.longitudinal.ahead = None
            if v == 0:
                continue
            boxes = seen[course.way]
            left, (half, wide), (speed, aside) = boxes.t, boxes.reach, boxes.velocity.T
            ahead = math.copysign(course.forward, course.forward * v)
            apart = ahead * (boxes.along - course.s)
            gap = apart - half - each.size.length / 2
            gap[-1] -= INTO * abs(v) * (each.role.where != "behind")  # the headway with which it follows
            later = left + aside * np.maximum(gap, 0.0) / abs(v)
            later[number:] = left[number:]
            near = np.min([np.abs(to - t) for to in (left, later) for t in (lateral.t, lateral.end)], axis=0)
            if each.placed.uncovers and (not each.begun or lateral.slide):
                to = np.abs(left - lateral.end) if lateral.slide else np.inf
                near = np.where(np.abs(speed) < STILL, to, near)
            is_ahead = (apart > SPACING) & (gap < IN_SIGHT) & (near < wide + each.size.width / 2 + BESIDE)
            for other, foe in enumerate(self._performers if self._stage.aims else ()):
                is_ahead[other] &= foe is not each.foe and foe.foe is not each
            is_ahead[-1] &= each.minds and ahead * speed[-1] >= ALONG * car.speed
            if is_ahead.any():
                first = int(np.where(is_ahead, gap, np.inf).argmin())
                each.longitudinal.ahead = float(gap[first]), float(ahead * speed[first])

    def _to_meeting(self, met: Met) -> float:
        """Returns in how many seconds the tested car, as fast as everybody is now, comes to the first one in
        its path, or who comes there from a side, or one behind it comes to it; infinity if none does. Who
        comes past it counts, too, where it stands until all has happened."""
        boxes = self._way.boxes(self._states(), self._sizes)
        ahead, away, (half, wide) = boxes.along - met.s, boxes.t - met.t, boxes.reach
        comes = (ahead > 0) & (np.sign(away) * boxes.velocity[:, 1] < -STILL)
        closing = np.sign(ahead) * (met.v - boxes.velocity[:, 0])
        is_near = (np.abs(away) < wide + met.width / 2) | self._stage.world.scene.stays
        closing = np.where(is_near, closing, np.where(comes, met.v, 0.0))
        gap = np.maximum(np.abs(ahead) - half - met.length / 2, 0.0)[closing > 0]
        return float((gap / closing[closing > 0]).min(initial=math.inf))

    @property
    def event(self) -> Stretch:
        """See ``Traffic.event``."""
        later = LATER if self._time else math.inf
        is_due = any(each.role.hits in STRUCK and each.hits is None for each in self._performers)
        if is_due and self._stage.world.scene.stays:
            return "before"
        if self._meets_in >= later and all(each.has_done for each in self._performers):
            return "past"
        acts = any(0 < time <= self._time for each in self._performers for time, _ in each.since.values())
        return "now" if acts or self._meets_in <= T0 else "before"

    def _states(self) -> FloatArray:
        nowhere = (np.nan,) * 5
        own = [each.state() or nowhere for each in self._performers]
        own += [each.state() or nowhere for each in self._extras]
        return np.vstack([*own, self._parked])

    @property
    def limited(self) -> dict[str, bool]:
        """See ``Traffic.limited``."""
        return {
            _did(actor, each, n) + said: is_prescribed
            for actor, each in zip(self.actors, self._performers, strict=False)
            for n, (said, is_prescribed) in each.limited.items()
        }

    @property
    def stopped(self) -> list[int]:
        """The numbers of those who hit the tested car from behind."""
        return [n for n, each in enumerate(self._performers) if each.hits]

    @property
    def missed(self) -> tuple[str, ...]:
        """What of the scene has not begun so far, a sentence for each actor."""
        found = []
        for actor, each in zip(self.actors, self._performers, strict=False):
            if each.foe is not None and self._performers.index(each) not in self.crashed:
                found.append(f"{NEVER} {actor.name} hits {each.role.hits}: {ENDED}")
            number = next((n for n in range(len(each.maneuvers)) if n not in each.shown), None)
            if number is not None:
                found.append(f"{NEVER} {_did(actor, each, number)}: {_why(each, number)}")
        return tuple(found)

    @property
    def history(self) -> tuple[Event, ...]:
        """See ``Traffic.history``."""
        found = list[Event]()
        for actor, each in zip(self.actors, self._performers, strict=False):
            for n, maneuver in enumerate(each.maneuvers):
                if n not in each.shown:
                    found.append(Event(actor.name, maneuver.said, why=_why(each, n)))
                    continue
                time, state = each.since[n]
                s = None if state is None else self._way.to_road(float(self._way.locate(*state[:2])[0]))
                found.append(Event(actor.name, maneuver.said, time, s, each.until.get(n)))
            if each.foe is not None:
                when, at = self.crashed.get(self._performers.index(each), (None, None))
                why = ENDED if when is None else ""
                found.append(Event(actor.name, f"hits {each.role.hits}", when, at, why=why))
        return tuple(found)


def _why(who: Performer, number: int) -> str:
    """Returns why somebody has not done one of its maneuvers."""
    maneuver, course = who.maneuvers[number], who.course
    if number > who.begun:
        return "what it does before that never began"
    if number < who.begun and course.meeting and who.triggers.met.s > course.meeting.its:
        return LATE
    if who.state() is None:
        is_gone = course.forward * (course.s - course.way.length / 2) > 0
        return "it had left the road" if is_gone else "it was not on the road yet"
    if not maneuver.is_open and who.triggers.wait(maneuver) == math.inf:
        return "what it waits for did not come"
    return ENDED


def _did(actor: Actor, who: Performer, number: int) -> str:
    """Returns in words that somebody does one of its maneuvers."""
    if number < 0:
        return actor.name
    maneuver = who.maneuvers[number]
    return f"{actor.name} {MANEUVERS[maneuver.what].said}{' again' * maneuver.before}"


def _touch(who: Performer, car: TestedCar) -> None:
    """Tells somebody who touches the tested car for the first time whether it hits it from behind."""
    if who.hits is not None or (state := who.state()) is None:
        return
    dx, dy, heading = car.x - state[0], car.y - state[1], state[HEADING]
    if touch(dx, dy, heading, *who.size[:2], car.heading, car.length, car.width):
        is_ahead = dx * math.cos(heading) + dy * math.sin(heading) > who.size.length / 2
        moves = who.longitudinal.v > 0 and who.lateral.slide is None
        who.hits = is_ahead and moves and math.cos(car.heading - heading) > ALONG
