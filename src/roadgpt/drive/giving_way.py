"""Where a driver on a route waits for others: before junctions for those who have priority, and before
crosswalks for persons who are on them or about to step onto them. Where the route changes lanes, the driver
comes in behind those who are ahead or beside it in the other lane.

A driver enters a junction as the traffic around it does (``roadgpt.traffic.following``): when nobody to whom
it gives way (``roadgpt.network.lanes``) is where the ways meet, or would come there within MARGIN seconds of
the car's leaving that place. Who stands does not keep it for longer than TURN seconds; after PATIENCE seconds
it goes before those who can still stop without effort. At crosswalks: Vienna Convention on Road Traffic
(1968), article 21."""

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from roadgpt.compiled import compiled
from roadgpt.drive.driving_line import FRONT, DrivingLine, FloatArray, turning_speed
from roadgpt.drive.path_ahead import HALF_WIDTH, SPARE
from roadgpt.drive.view import Other, View
from roadgpt.language.table import VEHICLES
from roadgpt.network import legs_of, network_of
from roadgpt.network.lanes import Lanes, lanes_of
from roadgpt.network.markings import CROSSWALK
from roadgpt.network.network import Leg
from roadgpt.road import Road, World
from roadgpt.traffic.following import (
    AGAINST_MUST,
    EASY,
    HORIZON,
    JAM,
    MARGIN,
    PATIENCE,
    STANDING,
    TURN,
    idm,
    is_awaited,
    time_over,
)  # fmt: skip

HEADWAY = 1.5  # s
PULL = 1.5  # m/s^2, with which the car is expected to drive on, as the cars of the traffic
LENGTH = 4.7  # m, of RoadGPT's saloon
SPACING = 2.0  # m between points of the ways of others
ASIDE, SAME = 1.5, 0.7  # m from a way, cosine of the angle to it, within which somebody drives along it
SOON, NEAR = 1.0, 0.7  # s, m: a person so far from the lanes or from the crosswalk counts
STRIP = 1.2  # m: a person so far to the side of the car's middle who walks on does not count
STROLLS = 0.1  # m/s
HIDDEN = 3.0  # s, for which a driver remembers who is hidden behind somebody
BEFORE = 4.0  # s before the road on which its route changes lanes, the driver begins to look into the other


class GivingWay:
    """The junctions and crosswalks of one route, and which of them the driver waits before."""

    def __init__(self, road: Road, world: World, line: DrivingLine) -> None:
        network, legs = network_of(road, world), legs_of(road, world)
        lanes = lanes_of(network)
        self._junctions: list[tuple[float, float, FloatArray]] = []
        """For each junction where the car gives way the station of the line, the speed in m/s at which people
        drive through, and the ``_ways`` of others."""
        for before, leg, start, end in zip(legs, legs[1:], road.starts[1:], road.starts[2:], strict=False):
            if network.road(leg.road).junction is None or not (keys := lanes.gives_way_to(leg)):
                continue
            stop, first, last = lanes[before].stop, line.place(start)[0], line.place(end)[0] + 1
            bend = max(map(abs, line.curvature[first : last + 1]))
            ahead = 0.0 if stop is None else lanes[before].length - stop
            rows = [row for key in keys for row in _ways(lanes, leg, key, start, end)]
            top = min(turning_speed(bend), world.driven_speed)
            self._junctions.append((start - ahead, top, np.array(rows)))
        self._changes: list[tuple[float, float, float]] = []
        """For each change of lanes its first and last station, and the offset of the path after it."""
        for k, (before, leg) in enumerate(pairwise(legs)):
            if leg.road == before.road:
                begin, _, end = road.starts[k : k + 3]
                self._changes.append((begin, end, line.offset[line.place(end)[0]]))
        self._line, self._beside = line, 0.0
        profile, self._crosswalks = world.profile_of(road), list[tuple[float, FloatArray]]()
        for s in (each.s for each in road.crosswalks):
            edges, own = profile.edges(s), line.offset[line.place(s)[0]]
            place = (*road.at(s)[:2], road.heading(s), edges.left, edges.right, own)
            self._crosswalks.append((s - CROSSWALK[1] / 2, np.array(place, float)))
        self._waited, self._goes, self._seen = 0.0, False, np.empty((0, 6))

    def lines(self, view: View) -> list[float]:
        """Returns the distances in metres, along the route, to the lines before which the car has to wait."""
        front, far = view.s + FRONT, view.speed**2 / (2 * EASY) + view.speed + 5.0
        while self._junctions and self._junctions[0][0] <= front:
            del self._junctions[0]
            self._waited, self._goes, self._seen = 0.0, False, np.empty((0, 6))
        while self._crosswalks and self._crosswalks[0][0] <= front:
            del self._crosswalks[0]
        must = view.speed**2 / (2 * AGAINST_MUST) + front  # the station before which the car cannot stop
        found = []
        if self._junctions and must < (line := self._junctions[0][0]) < front + far:
            self._waited += view.dt if view.speed < STANDING and line < front + 5.0 else 0.0
            _, top, ways = self._junctions[0]
            margin, limit = 0.0 if self._goes else MARGIN, view.world.limits.speed_limit
            car = np.array([front, line - front, view.speed, top, self._waited, margin, limit])
            self._goes = not _is_awaited(ways, self._vehicles(view), car)
            found += [] if self._goes else [line - view.s]
        if self._crosswalks and must < (line := self._crosswalks[0][0]) < front + far:
            persons = [each for each in view.others if each.group == "person"]
            if any(_is_crossing(self._crosswalks[0][1], each) for each in persons):
                found.append(line - view.s)
        return found

    def _vehicles(self, view: View) -> FloatArray:
        """Returns x, y, heading, speed and length of the vehicles that are seen, and of who is hidden for at
        most HIDDEN seconds, which come last: where it is if it went on evenly."""
        kept, rows = self._seen, [(*each[1:6], 0.0) for each in view.others if each.kind in VEHICLES]
        seen = np.array(rows).reshape(-1, 6)
        kept[:, 0] += view.dt * kept[:, 3] * np.cos(kept[:, 2])
        kept[:, 1] += view.dt * kept[:, 3] * np.sin(kept[:, 2])
        kept[:, 5] += view.dt
        away = np.hypot(*(kept[:, None, :2] - seen[:, :2]).T).min(axis=0, initial=math.inf)
        self._seen = np.concatenate([seen, kept[(away > ASIDE) & (kept[:, 5] < HIDDEN)]])
        return self._seen

    def behind(self, view: View) -> float:
        """Returns the acceleration in m/s^2 with which the car comes behind those in the lane that its route
        changes to; infinite where it changes to none, or is there."""
        least, is_beside = math.inf, False
        for begin, end, offset in self._changes:
            if not begin - BEFORE * view.speed < view.s < end or abs(view.t - offset) < ASIDE / 2:
                continue
            for other in view.others:
                s, t = map(float, view.road.locate(other.x, other.y))
                gap, closes = s - other.length / 2 - view.s - FRONT, max(other.speed - view.speed, 0.0)
                if other.kind not in VEHICLES or abs(t - offset) > ASIDE or gap > HORIZON:
                    continue
                if gap > 0.0:  # who is passed before the path comes into its lane is not followed
                    met = s + other.length / 2 + other.speed * gap / max(view.speed - other.speed, 1e-3)
                    aside = abs(t - self._line.offset[self._line.place(min(met, end))[0]])
                    if aside < other.width / 2 + HALF_WIDTH + SPARE:
                        follows = idm(view.speed, math.inf, gap, other.speed, PULL, EASY, HEADWAY)
                        least = min(least, follows)
                elif gap + LENGTH + other.length > -JAM - EASY * closes:
                    is_beside = True
                    if self._beside < (TURN if max(other.speed, view.speed) < STANDING else PATIENCE):
                        least = min(least, -EASY)
        self._beside = self._beside + view.dt if is_beside else 0.0
        return least


def _ways(lanes: Lanes, leg: Leg, key: Leg, start: float, end: float) -> Iterator[tuple[float, ...]]:
    """Yields points of the ways that lead into a lane to which a leg of a route gives way: x, y, heading,
    metres from there to where the two ways meet and to the end of that place, the station of the route at
    its end, and metres to the junction. The leg leads from station ``start`` to ``end``."""
    place = lanes.meeting(leg, key)
    assert place is not None
    last = start + place.own[1] / lanes[leg].length * (end - start)
    first, until = place.others
    open_ = [(key, first)]
    while open_:
        here, ahead = open_.pop()
        lane = lanes[here]
        s = np.arange(lane.length, 0.0, -SPACING)
        for (x, y, _), heading, left in zip(lane.at(s), lane.heading(s), ahead - s, strict=True):
            yield x, y, heading, left, left + until - first, last, left - first
        if ahead < HORIZON:
            round_ = lanes[key].member.junction  # one comes around a ring to where one began
            before = [each for each in lane.predecessors if lanes[each].member.junction != round_]
            open_ += [(each, ahead + lanes[each].length) for each in before]


@compiled
def _is_awaited(ways: FloatArray, others: FloatArray, car: FloatArray) -> bool:
    """Returns whether the car has to wait for one of the others: x, y, heading, speed and length of each.
    ``car`` has the station of its front, the metres before its line, its speed, its speed in the junction,
    for how long it has waited, the seconds that it keeps free, and up to which speed others may speed up."""
    front, before, v, top, waited, margin, limit = car
    for other in others:
        speed, half = other[3], other[4] / 2.0
        for way in ways:
            c, s = math.cos(way[2]), math.sin(way[2])
            dx, dy = other[0] - way[0], other[1] - way[1]
            ahead = dx * c + dy * s
            if abs(ahead) > SPACING / 2.0 or abs(dy * c - dx * s) > ASIDE:
                continue
            left = way[3] - ahead - half
            if math.cos(other[2] - way[2]) < SAME or way[4] - ahead + half < 0.0:
                continue
            if left > 0.0:
                spare = left - way[3] + way[6] - speed * speed / (2.0 * EASY) - speed - 15.0
                through = max(way[5] - front + LENGTH, 0.0)
                leaves = time_over(v, through, top, PULL)
                if v > top:  # it slows down before the junction
                    leaves = 2.0 * before / (v + top) + max(through - before, 0.0) / top
                arrives = time_over(speed, left, limit, PULL)
                if not is_awaited(speed, spare, arrives, leaves + margin, waited, TURN):
                    continue
            return True
    return False


def _is_crossing(crosswalk: FloatArray, person: Other) -> bool:
    """Returns whether a person is on a crosswalk or about to step onto it, and not beyond the car's path. A
    crosswalk is x, y and heading of its middle, and in metres to the left of it the edges of the lanes and
    the middle of the path."""
    x, y, heading, left, right, own = crosswalk.tolist()
    c, s = math.cos(heading), math.sin(heading)
    dx, dy = person.x - x, person.y - y
    along, t = dx * c + dy * s, dy * c - dx * s
    across = person.speed * math.sin(person.heading - heading)
    is_near = abs(along) < CROSSWALK[1] / 2 + NEAR and right - NEAR < t + SOON * across < left + NEAR
    is_beyond = (t - own) * across > 0.0 and abs(t - own) > STRIP
    return is_near and abs(across) > STROLLS and not is_beyond
