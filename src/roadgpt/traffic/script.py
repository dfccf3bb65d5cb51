"""The mover ``script``: the actors of a scene, who are where it says at first, and do what it says; and its
rows of parked cars."""

import math
from collections import Counter

import numpy as np

from roadgpt.brief.scene import HEAD_ON, LEAVES, MOST_MORE
from roadgpt.language.table import MANEUVERS
from roadgpt.road.road import START
from roadgpt.traffic.acting import BEHIND, INTO, ONCOMING, STANDS, Act, Car
from roadgpt.traffic.actor import HEADING, SIZES, STILL, Actor, FloatArray, TestedCar, corners
from roadgpt.traffic.boxes import touch
from roadgpt.traffic.following import ALONG
from roadgpt.traffic.places import parked_rows
from roadgpt.traffic.traffic import LATE, NEVER, Stage
from roadgpt.traffic.way import SPACING, Way

UNCOVERED = 3.0  # s that who changes lanes has left before who stands behind it is reached
IN_SIGHT = 150.0  # m ahead, in which somebody sees others in its lane
BESIDE = 0.2  # m between two who pass each other, at least


class Script:
    """Moves the actors of a scene, and places its rows of parked cars."""

    def __init__(self, stage: Stage) -> None:
        """Draws the numbers of the scene and places everybody as seen from where the tested car starts.
        Raises SceneError if something of the scene cannot be on this road."""
        self._stage, self._way = stage, Way.along(stage.road, stage.world)
        first = self._way.from_road(min(START, stage.road.length / 2))
        self._acts = self._placed(Car(first, stage.world.first_speed, *SIZES["car"][:2]))
        free = [act.way.points for act in self._acts if act.way is not self._way]
        free += [corners(np.array(state), act.size) for act in self._acts if (state := act.state())]
        rows = parked_rows(stage.world.scene, stage.road, stage.world, stage.seed, free)
        kinds = [*(act.kind for act in self._acts), *(kind for kind, _ in rows)]
        self.actors = [
            Actor(f"{kind} {kinds[: n + 1].count(kind)}", kind, SIZES[kind]) for n, kind in enumerate(kinds)
        ]
        self._parked = np.array([state for _, state in rows]).reshape(-1, 5)
        self._sizes = np.array([actor.size[:2] for actor in self.actors]).reshape(-1, 2)
        self.happened: dict[str, float] = {}
        """What of the scene has begun, in words, and at which station of its road the tested car was then."""

    def _placed(self, car: Car) -> list[Act]:
        """Returns the acts of everybody, as seen from the tested car."""
        found, events, kinds = list[Act](), dict[tuple[str, ...], float](), Counter[str]()
        for number, role in enumerate(self._stage.world.scene.actors):
            kinds[role.kind] += 1
            name, alike = (role.kind, str(kinds[role.kind])), list[Act]()
            low = int(role.count.lo or 1)
            high = int(role.count.hi or low + MOST_MORE)
            for copy in range(np.random.default_rng([self._stage.seed, number]).integers(low, high + 1)):
                rng = np.random.default_rng([self._stage.seed, number, copy])
                alike.append(Act(self._stage, self._way, role, car, rng, events, name, alike))
            found += alike
        self._order(found)
        return found

    def _order(self, acts: list[Act]) -> None:
        """Puts those ahead in the tested car's lane behind one another where the scene leaves open where they
        are: who stands beyond whom, and who drives beyond those who stand. Who stands behind somebody that
        leaves the lane is as far from it, where that happens, as the scene says."""
        ahead = [act for act in acts if act.where == "ahead" and act.is_along and not act.role.at]
        leavers = [act for act in ahead if act.first in LEAVES and act.v > 0]
        last: Act | None = None
        for act in ahead:
            if act.v == 0 and "station" not in act.n and "lead" not in act.n:
                if leavers and act.copy == 0:
                    gap = act.n.get("gap", UNCOVERED * leavers[0].v)
                    act.put(max(act.s, leavers[0].begins + gap + act.between(leavers[0])))
                elif last and (act.copy or not act.is_placed):
                    act.put(max(act.s, last.s + act.between(last) + STANDS))
                last = act
        for leaver in leavers:
            for act in ahead:
                wide = (act.size.width + leaver.size.width) / 2
                if act.v == 0 and leaver.begins < act.s and abs(act.t - leaver.t) < wide:
                    leaver.leave(act)
        for act in ahead:
            if last and act.v > 0 and act.first not in LEAVES and not act.is_placed and act.s < last.s:
                act.put(last.s + act.between(last) + BEHIND * act.v)
        onto = [act for act in acts if act.forward < 0 and act.is_along and not act.is_placed]
        late = [act.s + act.size.length / 2 - self._way.length for act in onto if act.first in HEAD_ON]
        spare = min((act.s - act.car.s - act.half - ONCOMING for act in onto), default=0.0)
        nearer = min(max(late, default=0.0), spare)
        for act in onto if nearer > 0 else ():  # so that what they begin happens on a short road, too
            act.put(act.s - nearer)
        placed = list[Act]()
        for act in sorted(acts, key=lambda each: not each.is_placed):
            while inside := next((each for each in placed if _touch(act, each)), None):
                act.part(inside)
            while near := next((each for each in placed if not act.is_placed and act.runs_into(each)), None):
                act.part(near)
            placed.append(act)
        for act in acts:
            act.check()

    def _seen(self, car: TestedCar) -> Car:
        s = self._way.from_road(car.s)
        x, y, _, heading = self._way.pose(s)
        s += (car.x - x) * math.cos(heading) + (car.y - y) * math.sin(heading)
        return Car(s, car.speed, car.length, car.width)

    def start(self, car: TestedCar, bodies: FloatArray) -> FloatArray:
        """Places everybody as seen from the tested car."""
        del bodies
        self._acts = self._placed(self._seen(car))
        return self._states()

    def move(self, time: float, car: TestedCar, bodies: FloatArray) -> FloatArray:
        """Returns the states of all actors STEP after ``time``. They slow down for others ahead in their
        lane, but not for the tested car, unless they overtake it. Who hits it from behind stops there."""
        seen = self._seen(car)
        self._look(bodies, car)
        for act in self._acts:
            _meet(act, car)
            act.move(time, seen)
        for actor, act in zip(self.actors, self._acts, strict=False):
            self.happened |= {
                did: car.s for n in act.shown if (did := _did(actor, act, n)) not in self.happened
            }
        return self._states()

    def _look(self, bodies: FloatArray, car: TestedCar) -> None:
        """Tells everybody how far it is to who is ahead on its way, and how fast that moves along it. Who
        comes onto its way before it is there is seen by those who stand later in the scene."""
        own = (car.x, car.y, 0.0, car.heading, car.speed, car.length, car.width)
        rows = np.vstack([np.hstack([self._states(), self._sizes]), bodies, own])
        seen = {act.way: act.way.boxes(rows) for act in self._acts if act.v != 0}
        for number, act in enumerate(self._acts):
            act.ahead = None
            if act.v == 0:
                continue
            along, left, half, wide, speed, aside = seen[act.way]
            ahead = math.copysign(act.forward, act.forward * act.v)
            apart = ahead * (along - act.s)
            gap = apart - half - act.size.length / 2
            gap[-1] -= INTO * abs(act.v) * (act.where != "behind")  # the headway with which it follows
            later = left + aside * np.maximum(gap, 0.0) / abs(act.v)
            later[number:] = left[number:]
            sides = [act.t] if act.slide is None else [act.t, act.slide.begin + act.slide.by]
            near = np.min([np.abs(each - side) for each in (left, later) for side in sides], axis=0)
            if act.uncovers and (not act.begun or act.slide):
                to = np.abs(left - sides[-1]) if act.slide else np.inf
                near = np.where(np.abs(speed) < STILL, to, near)
            is_ahead = (apart > SPACING) & (gap < IN_SIGHT) & (near < wide + act.size.width / 2 + BESIDE)
            is_ahead[-1] &= act.minds and ahead * speed[-1] >= ALONG * car.speed
            if is_ahead.any():
                first = int(np.where(is_ahead, gap, np.inf).argmin())
                act.ahead = float(gap[first]), float(ahead * speed[first])

    def _states(self) -> FloatArray:
        nowhere = (np.nan,) * 5
        return np.vstack([*(act.state() or nowhere for act in self._acts), self._parked])

    @property
    def limited(self) -> dict[str, bool]:
        """See ``Traffic.limited``."""
        return {
            _did(actor, act, n) + said: is_prescribed
            for actor, act in zip(self.actors, self._acts, strict=False)
            for n, (said, is_prescribed) in sorted(act.limited.items())
        }

    @property
    def stopped(self) -> list[int]:
        """The numbers of those who hit the tested car from behind."""
        return [n for n, act in enumerate(self._acts) if act.hits]

    @property
    def missed(self) -> tuple[str, ...]:
        """What of the scene has not begun so far, a sentence for each actor."""
        found = []
        for actor, act in zip(self.actors, self._acts, strict=False):
            number = next((n for n in range(len(act.deeds)) if n not in act.shown), None)
            if number is None:
                continue
            why = "the drive ended before"
            if number < act.begun and act.meeting and act.car.s > act.meeting.car:
                why = LATE
            elif act.state() is None:
                is_gone = act.forward * (act.s - act.way.length / 2) > 0
                why = "it had left the road" if is_gone else "it was not on the road yet"
            elif not act.deeds[number].is_open and act.wait(act.deeds[number]) == math.inf:
                why = "what it waits for did not come"
            found.append(f"{NEVER} {_did(actor, act, number)}: {why}")
        return tuple(found)


def _did(actor: Actor, act: Act, number: int) -> str:
    """Returns in words that somebody does one of its actions."""
    whats = [deed.what for deed in act.deeds[: number + 1]]
    if number < 0:
        return actor.name
    return f"{actor.name} {MANEUVERS[whats[-1]].said}{' again' * (whats.count(whats[-1]) - 1)}"


def _touch(act: Act, other: Act) -> bool:
    """Returns whether two would be in one place at first."""
    (x, y, _, heading), (x_2, y_2, _, heading_2) = (each.way.pose(each.s, each.t) for each in (act, other))
    return bool(touch(x_2 - x, y_2 - y, heading, *act.size[:2], heading_2, *other.size[:2]))


def _meet(act: Act, car: TestedCar) -> None:
    """Tells somebody who touches the tested car for the first time whether it hits it from behind."""
    if act.hits is not None or (state := act.state()) is None:
        return
    dx, dy, heading = car.x - state[0], car.y - state[1], state[HEADING]
    if touch(dx, dy, heading, *act.size[:2], car.heading, car.length, car.width):
        is_ahead = dx * math.cos(heading) + dy * math.sin(heading) > act.size.length / 2
        act.hits = is_ahead and act.v > 0 and act.slide is None and math.cos(car.heading - heading) > ALONG
