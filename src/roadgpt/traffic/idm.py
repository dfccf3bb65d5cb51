"""Vehicles that drive along the lanes of the map and react to each other and to the tested car: the flow of
a scene.

The density is 5, 12 or 25 vehicles for each km and lane (light, medium, dense). It is there from the start,
and held by vehicles that come in where the map's lanes begin; who finds no room waits outside.

Drivers differ. How far they follow is log-normal (R. T. Luttinen, Statistical analysis of vehicle time
headways, Helsinki 1996), and who keeps less than the usual headway comes right behind somebody: traffic
arrives in bunches (R. J. Cowan, Useful headway models, Transp. Res. 9, 1975). At a point of a straight road
8 to 12 % of the headways are below 1 s, and their coefficient of variation is 0.8 to 1.1. A change of lane
lasts 4.6 s with a spread of 2.3 s, and 13.3 s at most (T. Toledo, D. Zohar, Modeling duration of lane
changes, Transp. Res. Record 1999, 2007): these seconds lie between its first and its last centimetre."""

import math
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from roadgpt.compiled import bound
from roadgpt.language.names import ActorKind, Flow
from roadgpt.language.table import FLOWS, ROAD_USERS
from roadgpt.network import legs_of, network_of
from roadgpt.network.lanes import Lanes, lanes_of
from roadgpt.network.line import LEAST_GRIP, SLOWING
from roadgpt.network.network import Leg, Network, RoadEnd
from roadgpt.road import Road
from roadgpt.traffic import following as f
from roadgpt.traffic.actor import SIZES, SPEED, STEP, Actor, FloatArray, TestedCar
from roadgpt.traffic.lane_map import PER_CHANGE, PF, PG, LaneMap, lane_map, on_friction, place_on, touched
from roadgpt.traffic.lights import Lights
from roadgpt.traffic.places import works_rows
from roadgpt.traffic.traffic import Stage

DENSITY: Mapping[str, float] = {name: per_km / 1000.0 for name, per_km in FLOWS.items()}
"""Vehicles for each metre of a lane by the name of the flow."""
IN_FLOWS = {kind: row.in_flows for kind, row in ROAD_USERS.items() if row.in_flows}
SHARES = [each.share for each in IN_FLOWS.values()]
SPREAD, SLOWEST, FASTEST = 0.1, 0.8, 1.2  # of the share of the limit that drivers choose: SUMO's speedDev
ALIKE = 0.03  # the spread of that share around that of whom one comes right behind
USUAL = IN_FLOWS["car"].headway  # s
HEADWAYS, SHORTEST, LONGEST = (
    0.6,
    0.3,
    3.0,
)  # of the share of that which drivers keep: log-normal, and its ends
EVEN, ALONE = 12.0, 2.0  # shape and mean of the vehicles from one that comes alone to the next that does
CHANGES, VARY, QUICKEST, LASTING = 5.4, 0.52, 2.5, 13.3  # s of a change of lane, log-normal, and its ends
REACH = 500.0  # m: lanes that come nowhere as near to the driven road are left out
KEPT = 4  # lanes behind a vehicle that are remembered, and ahead of it that are always planned
TURNS_BACK = 1e-6  # how often somebody leaves on the road on which it came, where there are other exits
CLEAR = 8.0  # m, from the middle of a vehicle at the start to the place where it stops
LEAST_SPEED = 4.0  # m/s, with which a vehicle comes onto the map at least
NEAREST, LENGTH = 20.0, 8.0  # m between the middles of two who follow each other at the start; for a vehicle
APART = 12.0  # m, from the middle of a vehicle at the start to who stands or drives there by a scene
NOBODY, NO_LIGHTS = np.empty((0, 7)), np.empty(0, np.int64)
ABREAST = 15.0  # m, from the tested car to somebody in another lane at the start
EARLY = 35.0  # m, before roadworks that block its lane, somebody has to change lanes
AHEAD, BEHIND = 30.0, 15.0  # m before and behind the tested car where nobody is at first, and 2 s of its way


class IdmMover:
    """The flow of a scene. ``actors`` grows as vehicles come in."""

    def __init__(self, stage: Stage, flow: Flow | None = None, is_filled: bool = True) -> None:
        """Prepares the flow of the stage's scene, or another one; ``is_filled`` is whether it is there at
        the start."""
        self.actors: list[Actor] = []
        self._seed, self._is_filled = stage.seed, is_filled
        self.comes_in = True
        road, network = stage.road, network_of(stage.road, stage.world)
        lanes = lanes_of(network)
        dry, self.ids = lane_map(lanes, stage.world.limits.speed_limit, _near(lanes, road))
        self.lanes = _closed(stage, on_friction(dry, _friction(stage, network, dry, self.ids)))
        circle, falls = self.lanes.sample[:, PG], np.abs(self.lanes.sample[:, PF])
        least = np.minimum.reduceat(circle - falls, self.lanes.first[:-1])
        self._ease = np.maximum(SLOWING * least, LEAST_GRIP)
        """With how many m/s^2 one slows down easily everywhere on each lane."""
        self._denied = 0.0
        self.lights = stage.lights or Lights(network, stage.seed)
        self._ends = [RoadEnd(key.road, "end" if lanes[key].is_along else "start") for key in self.ids]
        self._path = _path(road, legs_of(road, stage.world), self.ids)
        self._rng = np.random.default_rng([self._seed, 0])
        self._exit_roads = np.array([self.ids[n].road for n in self.lanes.exits])
        size, longest = 64, max(len(self.ids) + 2 * KEPT, len(self._path[1])) + 1
        self._numbers = np.zeros((size, f.NUMBERS))
        self._whole = np.zeros((size, 7), np.int64)
        self._ways = np.full((size, longest), -1, np.int64)
        self._states = np.full((size, 5), math.nan)
        self._who, self._rows = np.zeros(0, np.int64), np.zeros(0, np.int64)
        """The actors that are there, and the row of each."""
        self._present = 1
        self._free = list(range(size - 1, 0, -1))
        self._entries = np.zeros((size * 12, 5))
        self._room = np.full((len(self.ids), 2), math.inf)
        self.waits = dict.fromkeys(np.flatnonzero(self.lanes.begins).tolist(), 0)
        scene = stage.world.scene
        usual = DENSITY.get(flow or scene.flow or "none", 0.0)
        self._density = np.full(len(self.ids), usual)  # vehicles for each metre of each lane
        if flow is None and scene.oncoming is not None:
            for n in _against(network, self.ids, self._path[1]):
                self._density[n] = DENSITY.get(scene.oncoming, 0.0)
        self._begin_density = self._density[list(self.waits)]
        self._due = self._rng.random(len(self.waits))
        self._next = [self._headway() for _ in self.waits]
        self._last = [1.0] * len(self.waits)
        """How far the next one follows that comes into each of these lanes, and the share of the limit that
        the last one drives."""
        is_road = self.lanes.junction < 0  # ways through a junction lie over each other
        self._wanted = float((self._density * self.lanes.length)[is_road].sum())
        self._tick, self._step = 0, f.step
        self._goes_on = np.diff(self.lanes.onward_of) > 0

    def start(self, car: TestedCar | None, bodies: FloatArray = NOBODY) -> FloatArray:
        """Places the vehicles that are there at the start, and returns their states."""
        self._see(car)
        for n in range(len(self.ids)) if self._is_filled else ():
            begin, end = self.lanes.usable[n]
            if self.lanes.junction[n] >= 0 or end - begin < 20.0 or self.lanes.ends[n]:
                continue
            count = int((end - begin) * self._density[n] + self._rng.random())
            count = min(count, int((end - begin) / 15.0))
            if not count:
                continue
            least = min(NEAREST, (end - begin) / count)
            gaps = self._rng.dirichlet(np.ones(count + 1)) * (end - begin - least * count)
            ahead, limit, factor = math.inf, float(self.lanes.limit[n]), None
            for s in (begin + np.cumsum(gaps[:-1]) + least * (np.arange(count) + 0.5)).tolist()[::-1]:
                follows = self._headway()
                if follows < 1.0 and ahead < end:
                    s = max(s, ahead - LENGTH - follows * USUAL * limit)
                x, y, _, _, bend = place_on(self.lanes, n, s)
                near = np.hypot(bodies[:, 0] - x, bodies[:, 1] - y) < bodies[:, 5] / 2 + APART
                if (car is not None and _is_close(car, x, y, n in self._path[1])) or near.any():
                    continue
                far = max(min(ahead, end + least / 2) - s - LENGTH, 0.0)
                most = min(bend, far / (follows * USUAL), self._stoppable(n, s))
                ahead, factor = s, self.enter(n, s, most, follows, factor)
        return self._shown()

    def move(self, time: float, car: TestedCar | None, bodies: FloatArray) -> FloatArray:
        """Returns the states of all actors, shape ``(actors, 5)``, STEP after ``time``."""
        self._see(car)
        lights = np.array([self.lights.shown(end, time) for end in self._ends])
        given = (self._crowd(lights), bodies, self._room, self._tick)
        if not self._tick:
            self._step = bound(f.step, given)
        self._step(*given)
        self._denied = max(self._denied, float(self._numbers[:, f.DENIED].max()))
        self._tick += 1
        if self.comes_in:
            self._let_in()
        self._tidy()
        return self._shown()

    def _crowd(self, lights: NDArray[np.int64]) -> f.Crowd:
        n = self._present
        return f.Crowd(
            self.lanes, self._numbers[:n], self._whole[:n], self._ways[:n], self._states[:n], self._entries,
            lights,
        )  # fmt: skip

    @property
    def stopped(self) -> list[int]:
        """The numbers of those whom the tested car touched."""
        found: list[int] = self._who[self._whole[self._rows, f.STATE] == f.STANDS_HIT].tolist()
        return found

    @property
    def limited(self) -> dict[str, bool]:
        """In a sentence, that somebody could not brake as hard as it wanted to."""
        said = f"a vehicle of the flow wanted to brake with {self._denied:.1f} m/s2, more than the road gives"
        return {said: False} if self._denied else {}

    @property
    def vehicles(self) -> int:
        """The number of vehicles on the map now."""
        return len(self._rows)

    def _stoppable(self, lane: int, s: float) -> float:
        """Returns the speed in m/s from which one stops easily before the junction at the end of a lane."""
        left = max(float(self.lanes.stop[lane]) - s - CLEAR, 0.0)
        return math.sqrt(2.0 * min(f.EASY, self._ease[lane]) * left) if self._goes_on[lane] else math.inf

    def _see(self, car: TestedCar | None) -> None:
        """Enters the tested car into its row."""
        row, whole = self._numbers[f.TESTED], self._whole[f.TESTED]
        if car is None:
            whole[f.STATE] = f.ABSENT
            return
        self._states[f.TESTED] = car.x, car.y, 0.0, car.heading, car.speed
        row[: f.BRAKES + 1] = 0.0, car.speed, car.length, car.width, 1.0, 0.0, 0.0, 1.5, 2.0
        row[f.PROGRESS] = 1.0
        starts, lanes = self._path
        k = min(max(bisect_right(starts, car.s) - 1, 0), len(lanes) - 1)
        if whole[f.STATE] == f.ABSENT:
            self._ways[f.TESTED, : len(lanes)] = lanes
            whole[: f.GOAL] = 0, len(lanes), -1, -1, f.DRIVES, 0
        share = (car.s - starts[k]) / max(starts[k + 1] - starts[k], 1e-6)
        whole[f.AT] = k
        row[f.S] = share * self.lanes.length[lanes[k]]

    def enter(
        self, lane: int, s: float, most: float, follows: float = 1.0, factor: float | None = None
    ) -> float:
        """Adds a vehicle at a station of a lane, with a speed of at most ``most`` m/s, that follows
        ``follows`` times as far away as is usual: if less, somebody who drives ``factor`` times as fast as
        one may. Returns the factor with which it drives itself."""
        number = len(self.actors) + 1
        rng = np.random.default_rng([self._seed, number])
        way, goal = self._way_from(lane, rng)
        longest = float(self.lanes.longest[way].min())
        kind: ActorKind = list(IN_FLOWS)[int(rng.choice(len(IN_FLOWS), p=SHARES))]
        if SIZES[kind].length > longest:
            kind = "car"
        size = SIZES[kind]
        row = self._row()
        _, headway, pull, brake, top = IN_FLOWS[kind]
        mean, spread = (1.0, SPREAD) if factor is None or follows >= 1.0 else (factor, ALIKE)
        factor = float(np.clip(rng.normal(mean, spread), SLOWEST, FASTEST))
        speed = min(most, float(self.lanes.limit[lane]) * factor, top)
        self._numbers[row] = 0.0
        self._numbers[row, : f.BRAKES + 1] = (
            s, speed, size.length, size.width, factor, top, headway * follows, pull, brake,
        )  # fmt: skip
        changes = CHANGES * math.exp(VARY * rng.standard_normal() - VARY**2 / 2)
        self._numbers[row, f.CHANGES] = min(max(changes, QUICKEST), LASTING)
        self._numbers[row, f.PROGRESS] = 1.0
        self._whole[row] = 0, len(way), -1, -1, f.DRIVES, 0, goal
        self._ways[row, : len(way)] = way
        *place, heading, _ = place_on(self.lanes, lane, s)
        self._states[row] = *place, heading, speed
        self.actors.append(Actor(f"{kind} {sum(each.kind == kind for each in self.actors) + 1}", kind, size))
        self._who, self._rows = np.append(self._who, number - 1), np.append(self._rows, row)
        self._present = max(self._present, row + 1)
        crowd = self._crowd(NO_LIGHTS)
        f.hold(crowd, row)
        self._numbers[row, f.V] = self._states[row, SPEED] = min(speed, f.bends(crowd, row)[1])
        return factor

    def _headway(self) -> float:
        """Draws by how many times as far as others of its kind one follows."""
        return float(np.clip(self._rng.lognormal(0.0, HEADWAYS), SHORTEST, LONGEST))

    def _row(self) -> int:
        if not self._free:
            size = len(self._numbers)
            for name in ("_numbers", "_whole", "_ways", "_states"):
                old = getattr(self, name)
                setattr(self, name, np.concatenate([old, np.zeros_like(old)]))
            self._entries = np.zeros((size * 24, 5))
            self._free = list(range(2 * size - 1, size - 1, -1))
        return self._free.pop()

    def _way_from(
        self, lane: int, rng: np.random.Generator, goal: int = -1, length: float = 0.0, full: int = -1
    ) -> tuple[list[int], int]:
        """Returns the lanes that a vehicle drives through, and to which exit: to ``goal`` if it can be
        reached from there without more changes of lane than another, else to one that is drawn. It does
        not come through the lane ``full``, nor where the vehicle is too long, if there is another way."""
        lanes, way = self.lanes, [lane]
        while True:
            onward = lanes.onward[lanes.onward_of[way[-1]] : lanes.onward_of[way[-1] + 1]].tolist()
            good = [each for each in onward if each != full and lanes.longest[each] >= length] or onward
            if not good:
                return way, goal
            far = lanes.to_exit[:, good].min(axis=1)
            is_near = far < far.min() + PER_CHANGE / 2
            if goal < 0 or not is_near[goal]:
                share = is_near * np.where(self._exit_roads == self.ids[lane].road, TURNS_BACK, 1.0)
                goal = int(rng.choice(len(share), p=share / share.sum()))
            there = min(good, key=lambda each: float(lanes.to_exit[goal, each]))
            if there in way:
                return way, goal
            way.append(there)

    def _let_in(self) -> None:
        """Lets vehicles in: the flow is the density times the speed that is driven now, more if there are
        fewer on the map than there should be, and less if there are more."""
        speeds = self._numbers[self._rows, f.V]
        pace = float(speeds.mean()) if len(speeds) else float(self.lanes.limit.mean())
        rate = pace * min(max(2.0 - len(speeds) / max(self._wanted, 1.0), 0.0), 2.0)
        self._due -= rate * self._begin_density * STEP
        for n, lane in enumerate(self.waits):
            if self._due[n] <= 0.0:
                self._due[n] += float(self._rng.gamma(EVEN, ALONE / EVEN))
                self.waits[lane] += 1
            if not self.waits[lane]:
                continue
            (room, its), firm = self._room[lane].tolist(), min(f.FIRM, self._ease[lane])
            gap, most = room - 5.0 - f.JAM, min(float(self.lanes.limit[lane]), self._stoppable(lane, 0.0))
            fastest = gap / (self._next[n] * USUAL), math.sqrt(its * its + 2.0 * firm * max(gap, 0.0))
            speed = min(most, *fastest)
            if gap > f.JAM and speed >= min(most, max(LEAST_SPEED, its)):
                self._last[n] = self.enter(lane, 0.0, speed, self._next[n], self._last[n])
                self._next[n] = self._headway()
                self.waits[lane] -= self._next[n] >= 1.0

    def _tidy(self) -> None:
        """Takes out who has left, and plans on for who needs it."""
        whole, ways, rows = self._whole, self._ways, self._rows
        at, last = whole[rows, f.AT], whole[rows, f.LAST]
        has_left = whole[rows, f.STATE] == f.ABSENT
        for n in np.flatnonzero((last - at < KEPT) & self._goes_on[ways[rows, last - 1]] & ~has_left):
            row, end = rows[n], last[n]
            rng = np.random.default_rng([self._seed, int(self._who[n]) + 1, self._tick])
            here, full = map(int, ways[row, end - 1 : end + 1])
            length, goal = float(self._numbers[row, f.LENGTH]), int(whole[row, f.GOAL])
            more, whole[row, f.GOAL] = self._way_from(here, rng, goal, length, full)
            begin = max(int(at[n]) - KEPT, 0)
            way = [*ways[row, begin : end - 1].tolist(), *more]
            ways[row, : len(way)] = way
            whole[row, [f.AT, f.GRANTED]] -= begin
            whole[row, f.LAST] = len(way)
        if has_left.any():
            self._free += rows[has_left].tolist()
            self._rows, self._who = rows[~has_left], self._who[~has_left]
            self._present = int(self._rows.max(initial=0)) + 1

    def _shown(self) -> FloatArray:
        out = np.full((len(self.actors), 5), math.nan)
        out[self._who] = self._states[self._rows]
        return out


def _friction(stage: Stage, network: Network, lanes: LaneMap, ids: Sequence[Leg]) -> FloatArray:
    """Returns the friction of each sample of the lanes: on the tested car's roads that of its stations."""
    road, world = stage.road, stage.world
    found, begins = np.full(len(lanes.station), world.site.friction), dict[int, tuple[float, Leg]]()
    for leg, start in zip(legs_of(road, world), road.starts, strict=False):
        begins.setdefault(leg.road, (start, leg))
    for n, key in enumerate(ids) if world.scene.slippery else ():
        if key.road in begins:
            (start, leg), member = begins[key.road], network.road(key.road)
            rows, leads = slice(*lanes.first[n : n + 2]), member.profile.leads_along
            s = lanes.station[rows]
            s = start + (s if leads(key.lane) == leads(leg.lane) else member.road.length - s)
            found[rows] = [world.friction_at(each) for each in s.tolist()]
    return found


def _closed(stage: Stage, lanes: LaneMap) -> LaneMap:
    """Returns the lanes, of which those that roadworks block end there, where one leads past them."""
    ends, usable, found = lanes.ends.copy(), lanes.usable.copy(), np.zeros((9, 5))
    for kind, (x, y, _, heading, _) in works_rows(stage.road, stage.world, stage.seed):
        count = touched(lanes, x, y, heading, *SIZES[kind][:2], 0.0, -1.0, found, 0)
        for n, s in found[:count, :2]:
            if max(lanes.beside[int(n)]) >= 0:
                ends[int(n)], usable[int(n), 1] = True, min(usable[int(n), 1], s - EARLY)
    return lanes._replace(ends=ends, usable=usable)


def _is_close(car: TestedCar, x: float, y: float, is_own: bool) -> bool:
    """Returns whether a place is too close to the tested car for somebody to be there at first, in a lane
    that it follows or in another one."""
    dx, dy = x - car.x, y - car.y
    if not is_own:
        return math.hypot(dx, dy) < ABREAST
    along = dx * math.cos(car.heading) + dy * math.sin(car.heading)
    near = AHEAD + 2.0 * car.speed
    return bool(-BEHIND - 2.0 * car.speed < along < near and math.hypot(dx, dy) < near)


def _near(lanes: Lanes, road: Road) -> frozenset[Leg] | None:
    """Returns the lanes that come within REACH of a road; None if all do."""
    tree = cKDTree(road.at(np.linspace(0.0, road.length, max(2, int(road.length / 10.0))))[:, :2])
    found = set()
    for lane in lanes:
        points = lane.at(np.linspace(0.0, lane.length, max(2, int(lane.length / 25.0))))[:, :2]
        if float(np.min(tree.query(points)[0])) < REACH:
            found.add(lane.id)
    return None if len(found) == len(lanes) else frozenset(found)


def _path(road: Road, legs: Sequence[Leg], ids: Sequence[Leg]) -> tuple[list[float], list[int]]:
    """Returns the lanes that the tested car follows, and the stations at which they begin; where it changes
    lanes on a road, that road's last lane."""
    starts, lanes = [0.0], []
    for n, (leg, end) in enumerate(zip(legs, road.starts[1:], strict=True)):
        if n + 1 < len(legs) and legs[n + 1].road == leg.road:
            continue
        lanes.append(ids.index(leg))
        starts.append(end)
    return starts, lanes


def _against(network: Network, ids: Sequence[Leg], path: Sequence[int]) -> Iterator[int]:
    """Yields the lanes of the roads that the tested car follows that lead against it."""
    own = {ids[n].road: network.road(ids[n].road).profile.leads_along(ids[n].lane) for n in path}
    for n, key in enumerate(ids):
        if key.road in own and network.road(key.road).profile.leads_along(key.lane) != own[key.road]:
            yield n
