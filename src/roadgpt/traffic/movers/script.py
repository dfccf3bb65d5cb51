"""The mover ``script``: the actors of a scene, who are where it says at first, and do what it says; and its
rows of parked cars."""

import math
from collections import Counter

import numpy as np

from roadgpt.brief.scene import DOINGS
from roadgpt.road.road import START
from roadgpt.traffic.acting import Act, Car
from roadgpt.traffic.actor import SIZES, Actor, FloatArray, TestedCar, corners
from roadgpt.traffic.places import parked_rows
from roadgpt.traffic.traffic import Stage
from roadgpt.traffic.way import Way


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

    def _placed(self, car: Car) -> list[Act]:
        """Returns the acts of everybody, as seen from the tested car."""
        found, events, kinds = list[Act](), dict[tuple[str, ...], float](), Counter[str]()
        for number, role in enumerate(self._stage.world.scene.actors):
            kinds[role.kind] += 1
            name, alike = (role.kind, str(kinds[role.kind])), list[Act]()
            low, high = int(role.count.lo or 1), int(role.count.hi or 50)
            for copy in range(np.random.default_rng([self._stage.seed, number]).integers(low, high + 1)):
                rng = np.random.default_rng([self._stage.seed, number, copy])
                alike.append(Act(self._stage, self._way, role, car, rng, events, name, alike))
            found += alike
        return found

    def _seen(self, car: TestedCar) -> Car:
        s = self._way.from_road(car.s)
        x, y, _, heading = self._way.pose(s)
        s += (car.x - x) * math.cos(heading) + (car.y - y) * math.sin(heading)
        return Car(s, car.speed, car.length, car.width)

    def start(self, car: TestedCar) -> FloatArray:
        """Places everybody as seen from the tested car."""
        self._acts = self._placed(self._seen(car))
        return self._states()

    def move(self, time: float, car: TestedCar, bodies: FloatArray) -> FloatArray:
        """Returns the states of all actors STEP after ``time``. They react to nobody else's body."""
        del bodies
        seen = self._seen(car)
        for act in self._acts:
            act.move(time, seen)
        return self._states()

    def _states(self) -> FloatArray:
        nowhere = (np.nan,) * 5
        return np.vstack([*(act.state() or nowhere for act in self._acts), self._parked])

    def missed(self) -> tuple[str, ...]:
        """Returns what of the scene has not begun so far, a sentence for each actor."""
        found = []
        for actor, act in zip(self.actors, self._acts, strict=False):
            is_late = act.state() is None and not act.is_gone
            deed = act.unseen or next(iter(act.deeds[0 if is_late else act.begun :]), None)
            if deed is None:
                continue
            why = "the drive ended before"
            if act.state() is None:
                why = "it was not on the road yet" if is_late else "it had left the road"
            elif not deed.is_open and act.wait(deed) == math.inf:
                why = "what it waits for did not come"
            found.append(f"it never happened that {actor.name} {DOINGS[deed.what].said}: {why}")
        return tuple(found)
