"""Follows the others on the road during a drive: whom the driver sees, and when the car touches one."""

import math
from collections.abc import Sequence
from itertools import repeat
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.scene import Scene
from roadgpt.brief.visibility import visual_range
from roadgpt.compiled import bound, compiled, inlined
from roadgpt.drive.drive import COLUMNS, Box, FloatArray
from roadgpt.drive.lanes_along import LanesAlong
from roadgpt.drive.view import LightAhead, Other, Others
from roadgpt.geometry.boxes import part_inside, touch
from roadgpt.ground.sight import Horizon, is_behind_land
from roadgpt.language.names import ActorKind
from roadgpt.language.table import VEHICLES
from roadgpt.network.landscape import horizon_around
from roadgpt.network.lanes import HEADROOM
from roadgpt.road import Road, World
from roadgpt.traffic import STEP, Actor, TestedCar, Traffic
from roadgpt.traffic.actor import bodies

if TYPE_CHECKING:
    from roadgpt.drive.drive_monitor import DriveMonitor
    from roadgpt.scene import Body

SEEN = 200.0  # m, between the middles of the car and of another
EYE = 1.2  # m, height of the driver's eye, which looks from the middle of the car
SPACING = 5.0  # m between the places at which the height of the road is known
BESIDE = 6.0  # m, within which the road lies under a line of sight
FLAT = 0.002  # m, from the middle of three such places to the line between the others, twice: hides nobody
X, Y, Z, HEADING, SPEED, S, T = map([*COLUMNS].index, ("x", "y", "z", "heading", "speed", "s", "t"))


@compiled
def look_around(
    states: FloatArray, looks: FloatArray, car: FloatArray, order: "NDArray[np.int64]", seen: FloatArray
) -> tuple[int, bool]:
    """Writes into ``order`` the numbers of the actors that are seen, nearest first, and into ``seen`` the x,
    y, heading in (-pi, pi], speed, length and width of each, and 1.0 if it is a vehicle, else 0.0; returns
    how many they are and whether the car touches one.

    ``states`` are as in Tracks, ``looks`` (n, 5) lengths, widths, heights, whether they are vehicles, and
    from how many metres they are seen, and ``car`` has the x, y and z of the middle of the car's box on the
    ground, its heading, length and width. Roads that cross above each other do not count."""
    x, y, z, heading, length, width = car
    far = np.empty(len(states))
    count, touches = 0, False
    for k in range(len(states)):
        dx, dy = states[k, 0] - x, states[k, 1] - y
        far[k] = math.hypot(dx, dy)
        if abs(states[k, 2] - z) <= HEADROOM:
            touches = touches or touch(dx, dy, heading, length, width, states[k, 3], looks[k, 0], looks[k, 1])
        if not far[k] <= looks[k, 4]:  # also who is not there
            continue
        place = count
        while place > 0 and far[order[place - 1]] > far[k]:
            order[place] = order[place - 1]
            place -= 1
        order[place] = k
        count += 1
    for place in range(count):
        k = order[place]
        seen[place, 0], seen[place, 1], seen[place, 3] = states[k, 0], states[k, 1], states[k, 4]
        seen[place, 2] = math.atan2(math.sin(states[k, 3]), math.cos(states[k, 3]))
        seen[place, 4], seen[place, 5], seen[place, 6] = looks[k, 0], looks[k, 1], looks[k, 3]
    return count, touches


@inlined
def _hides(
    states: FloatArray, sizes: FloatArray, m: int, eye: FloatArray, x: float, y: float, z: float
) -> bool:
    """Returns whether box ``m`` lies between the eye and a point."""
    low, high = part_inside(
        eye[0] - states[m, 0], eye[1] - states[m, 1], x - eye[0], y - eye[1], states[m, 3],
        sizes[m, 0], sizes[m, 1], 0.0, 1.0,
    )  # fmt: skip
    one, two = eye[2] + low * (z - eye[2]), eye[2] + high * (z - eye[2])
    return low < high and min(one, two) < states[m, 2] + sizes[m, 2] and max(one, two) > states[m, 2]


@compiled
def in_sight(
    states: FloatArray, sizes: FloatArray, eye: FloatArray, road: FloatArray, horizon: Horizon,
    order: "NDArray[np.int64]", seen: FloatArray, count: int, reach: float,
) -> int:  # fmt: skip
    """Keeps in ``order`` and ``seen``, as ``look_around`` wrote them, those whom the driver's eye at x, y, z
    sees within ``reach`` metres, and returns how many they are.

    Somebody is seen if a line from the eye leads to the top of its box, at its middle or a corner, past all
    other boxes and, for the middle, above the points (n, 3) of the road and the land. ``sizes`` are lengths,
    widths and heights."""
    near, before, kept = order[:count].copy(), np.empty(count, np.int64), 0
    ways = np.empty((count, 4))  # distance, bearing and radius of a box, and half of the angle that it covers
    for place in range(count):
        k = near[place]
        x, y = states[k, 0] - eye[0], states[k, 1] - eye[1]
        far, radius = math.hypot(x, y), math.hypot(sizes[k, 0], sizes[k, 1]) / 2.0
        wide = math.asin(radius / far) if far > radius else math.pi
        ways[place, 0], ways[place, 1], ways[place, 2], ways[place, 3] = far, math.atan2(y, x), radius, wide
    for place in range(count):
        k, far = near[place], ways[place, 0]
        ahead, aside, top = states[k, 0] - eye[0], states[k, 1] - eye[1], states[k, 2] + sizes[k, 2]
        is_hidden = far > reach
        for n in range(len(road)):
            x, y = road[n, 0] - eye[0], road[n, 1] - eye[1]
            u = (x * ahead + y * aside) / max(far * far, 1e-9)
            if 0.0 < u < 1.0 and abs(y * ahead - x * aside) < BESIDE * far:
                is_hidden = is_hidden or road[n, 2] > eye[2] + u * (top - eye[2])
        if is_hidden or is_behind_land(horizon, eye[0], eye[1], eye[2], states[k, 0], states[k, 1], top):
            continue
        some = 0
        for n in range(count):
            apart, least = abs(ways[n, 1] - ways[place, 1]), ways[n, 3] + ways[place, 3]
            is_nearer = n != place and ways[n, 0] - ways[n, 2] < far + ways[place, 2]
            if is_nearer and min(apart, 2.0 * math.pi - apart) < least:
                before[some] = near[n]
                some += 1
        c, s, is_seen = math.cos(states[k, 3]), math.sin(states[k, 3]), False
        for point in range(5):
            if is_seen:
                break
            along = (0.0, 1.0, 1.0, -1.0, -1.0)[point] * sizes[k, 0] / 2.0
            across = (0.0, 1.0, -1.0, 1.0, -1.0)[point] * sizes[k, 1] / 2.0
            x, y = states[k, 0] + along * c - across * s, states[k, 1] + along * s + across * c
            is_seen = True
            for n in range(some):
                if _hides(states, sizes, before[n], eye, x, y, top):
                    is_seen = False
                    break
        if is_seen:
            order[kept] = k
            for n in range(seen.shape[1]):
                seen[kept, n] = seen[place, n]
            kept += 1
    return kept


@compiled
def look(
    before: FloatArray, after: FloatArray, share: float, looks: FloatArray, row: FloatArray,
    box: FloatArray, road: FloatArray, horizon: Horizon, states: FloatArray,
    order: "NDArray[np.int64]", seen: FloatArray,
) -> tuple[int, bool]:  # fmt: skip
    """Writes into ``states`` where the actors are, when a ``share`` of the time between two samples has
    passed, and into ``order`` and ``seen`` those whom the driver sees; returns how many they are and whether
    the car touches somebody.

    ``row`` is the state of the car in the order of COLUMNS, and ``box`` has the length and width of its box,
    the metres from its centre of gravity forward to the middle of the box, and upward from the ground;
    ``road`` has points every SPACING metres, or none if it is flat."""
    for k in range(len(states)):
        for n in range(states.shape[1]):  # whole rows would take seconds to compile
            past, coming = before[k, n], after[k, n]
            states[k, n] = (1.0 - share) * past + share * coming if share > 0.0 else past
    length, width, ahead, height = box
    x, y = row[X] + ahead * math.cos(row[HEADING]), row[Y] + ahead * math.sin(row[HEADING])
    car = np.array([x, y, row[Z] - height, row[HEADING], length, width])
    count, touches = look_around(states, looks, car, order, seen)
    here, far = int(row[S] / SPACING), int(SEEN / SPACING)
    eye = np.array([x, y, row[Z] - height + EYE])
    near = road[max(here - far, 0) : here + far]
    return in_sight(states, looks, eye, near, horizon, order, seen, count, SEEN), touches


def heights_along(road: Road) -> FloatArray:
    """Returns points of a road every SPACING metres, or none if it is flat, so that it hides nobody."""
    line = road.at(np.arange(0.0, road.length, SPACING))
    is_hilly = np.abs(np.diff(line[:, 2], 2)).max(initial=0.0) > FLAT
    return np.ascontiguousarray(line if is_hilly else line[:0])


def looks_of(actors: Sequence[Actor], scene: Scene) -> FloatArray:
    """Returns how somebody looks to drivers, as ``look_around`` takes it."""
    reach = [min(SEEN, visual_range(scene, each.kind) + each.size.length / 2) for each in actors]
    looks = [(*each.size, each.kind in VEHICLES, far) for each, far in zip(actors, reach, strict=True)]
    return np.array(looks).reshape(-1, 5)


class Company:
    """The others on the road during one drive."""

    def __init__(self, traffic: Traffic, box: Box, monitor: "DriveMonitor", road: Road, world: World) -> None:
        self._traffic, self._box, self._monitor = traffic, box, monitor
        passages = road.passages if traffic.lights is not None else ()
        lines = [(each.light_line, each.arrival) for each in passages]
        self._lines = [(line, end) for line, end in lines if line is not None]
        self.has_lights = bool(self._lines)
        """Whether traffic lights that run are on the way."""
        self._scene, self._samples = world.scene, 0
        self._lights_reach = visual_range(world.scene, "lights")
        self._kinds: list[ActorKind] = []
        self._heights = heights_along(road)
        self._horizon = horizon_around(road, world)
        self._lanes_along = LanesAlong(road, world)
        self._near = np.empty(0, np.int64)
        """Where along the road each of the others has been seen since the last sample, as ``find`` has it."""
        self._outline = np.array([box.length, box.width, box.ahead, box.height])
        self._looks = none = np.empty((0, 5))
        self._found = none, np.empty(0, np.int64), np.empty((0, 7))
        self._past = self._outline, self._heights, self._horizon
        given = (none, none, 0.0, none, np.empty(0), *self._past, *self._found)
        self._look = bound(look, given)

    def seen(self, row: FloatArray, time: float) -> Others:
        """Moves the others on to this time, tells the monitor whether the car touches one, and returns those
        that the driver sees. Call it at every control step; ``row`` is the state of the car in the order of
        COLUMNS."""
        if time >= self._samples * STEP - 1e-6:
            self._move_on(row)
        given = (*self._traffic.around(time), self._looks, row, *self._past, *self._found)
        count, touches = self._look(*given)
        if touches:
            self._monitor.touch(time)
        _, order, seen = self._found
        some, boxes = order[:count], seen[:count].copy()
        near = self._near[some]
        places = self._lanes_along.places(boxes[:, 0], boxes[:, 1], near)
        self._near[some] = near
        said = zip([self._kinds[k] for k in some.tolist()], *boxes.T[:6].tolist(), *places, strict=True)
        others = Others(map(tuple.__new__, repeat(Other), said))  # faster than Other._make
        others.boxes = boxes
        return others

    def _move_on(self, row: FloatArray) -> None:
        box, (x, y, heading, speed, s, t) = self._box, row[[X, Y, HEADING, SPEED, S, T]].tolist()
        x, y = x + box.ahead * math.cos(heading), y + box.ahead * math.sin(heading)
        self._traffic.advance(TestedCar(x, y, heading, speed, s, t, box.length, box.width))
        self._samples += 1
        if came := self._traffic.actors[len(self._kinds) :]:
            self._kinds += [each.kind for each in came]
            self._looks, count = np.vstack([self._looks, looks_of(came, self._scene)]), len(self._kinds)
            self._found = np.empty((count, 5)), np.empty(count, np.int64), np.empty((count, 7))
        self._near = np.full(len(self._kinds), -1)

    def bodies(self, time: float) -> "list[Body]":
        """Returns the bodies of the others at this time, for images."""
        return bodies(self._traffic.actors, self._traffic.at(time))

    def lights(self, s: float, time: float) -> tuple[LightAhead, ...]:
        """Returns the lights ahead of station ``s`` of the route, and what they show at this time."""
        shown, reach = self._traffic.lights, self._lights_reach
        if shown is None:
            return ()
        near = [(line - s, end) for line, end in self._lines if 0 <= line - s <= reach]
        return tuple(
            [LightAhead(far, ("green", "yellow", "red")[shown.shown(end, time)]) for far, end in near]
        )
