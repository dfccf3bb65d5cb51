"""Finds what went wrong in a drive on a route through junctions, or with others on the road, each time with
its place. An incident begins at the first step at which its condition holds.

On a route:

- out of lane: as in ``verdict.oracle``; inside a junction, the lane is that of the route's connecting road;
- wrong turn: more than 90 % of the car is outside its lane; its centre of gravity is beside the road of the
  route, on a road that the route does not use; and its heading is within 30 degrees of the direction of this
  unused road (outside junctions, of either direction); it ends when the car is back on the route's road;
- wrong way: the car's centre of gravity is on the road of the route, and its heading differs by more than 90
  degrees from that of the route, for 1 s or longer;
- off road: the outer edge of a tyre is outside the paved area of the network;
- stop line: the front of the car crosses the line at a stop sign, and the car never stood still (below 0.1
  m/s) while its front was within the last 4 m before the line.

The rule for stop signs is that of CARLA (leaderboard and scenario_runner). The other kinds resemble CARLA's
criteria, with stricter limits. With others on the road, also on a single one:

- collision: the first contact with each of the others, see ``verdict.contact``;
- near miss: with somebody who was not hit, a conflict time (see ``verdict.measures``) below 0.95 s while the
  tested car moves, the bound of nuPlan for the time to collision; or a post-encroachment time below 1 s, at
  which Peesapati, Hunter and Rodgers (2013) found the closest relation to accidents. Those with the same
  other within 3 s are one; none is counted after a collision, since nobody moves then as cars would;
- blocked: the tested car stands (below 0.1 m/s) for 30 s with nobody within 10 m ahead in its lane, our
  definition;
- out of lane, also on a single road;
- red light, failure to yield, on a route: see ``verdict.right_of_way``;
- speeding: more than 5 % and more than 1 m/s above the limit of the lane for 1 s, our definition.
"""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roadgpt.drive.outlook import limits_of
from roadgpt.geometry import wrap_angle
from roadgpt.network import legs_of, network_of, only_road
from roadgpt.verdict.contact import contacts_of
from roadgpt.verdict.measures import measure
from roadgpt.verdict.oracle import is_outside
from roadgpt.verdict.right_of_way import taken
from roadgpt.verdict.verdict import STANDS, Incident, IncidentKind

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

GONE = 0.9  # share of the car outside its lane; a car that slides wide and comes back took no wrong turn
ALONG = math.radians(30.0)  # between the heading of the car and that of a wrong road on which it drives
BACKWARDS, BACK = math.radians(90.0), 1.0  # between the headings of car and route; s of driving the wrong way
STOP_WITHIN = 4.0  # m before the line
EDGE = 0.02  # m, by which a tyre may be beyond the polygon of the paved area, whose chords cut bends by 2 mm
STEP = 1.0  # m, between points at which the heading of other roads is known
CONFLICT, ENCROACHED = 0.95, 1.0  # s
APART = 3.0  # s between two near misses
STOOD, PATIENCE, FREE = 0.1, 30.0, 10.0  # m/s, s, m
OVER, OVER_BY, TOO_FAST = 1.05, 1.0, 1.0  # ratio, m/s, s


def incidents_of(road: "Road", drive: "Drive", world: "World") -> tuple[Incident, ...]:
    """Returns what went wrong on a route or among others on the road, in order of time."""
    time, is_route = drive["time"], only_road(road, world) is None
    found = list[Incident]()

    def add(kind: IncidentKind, times: list[float], other: str | None = None) -> None:
        for at in times:
            s, x, y = (float(np.interp(at, time, drive[name])) for name in ("s", "x", "y"))
            found.append(Incident(kind, s, (x, y), float(at), other))

    add("out of lane", _lasting(time, is_outside(road, drive, world)))
    if is_route:
        edges = world.profile_of(road).edges(drive["s"])
        is_beside: BoolArray = (drive["t"] > edges.left) | (drive["t"] < edges.right)
        turned = np.abs(wrap_angle(drive["heading"] - road.heading(drive["s"])))
        add("wrong turn", _lasting(time, _is_on_wrong_road(road, world, drive, is_beside)))
        add("wrong way", _lasting(time, (turned > BACKWARDS) & ~is_beside, BACK))
        add("off road", _lasting(time, _is_off_road(road, world, drive)))
        add("stop line", _stops_missed(road, drive))
    if drive.others is None:
        return tuple(sorted(found, key=lambda each: each.at_time))
    contacts, measured = contacts_of(drive), measure(road, drive, world)
    found += contacts
    hit, crashed = {each.other for each in contacts}, min((each.at_time for each in contacts), default=np.inf)
    speed = np.interp(measured.time, time, drive["speed"])
    for number, actor in enumerate(drive.others.actors):
        if actor.name in hit:
            continue
        times = [*measured.time[(measured.conflict[:, number] < CONFLICT) & (speed > STANDS)]]
        if measured.pet[number] < ENCROACHED:
            times.append(measured.pet_time[number])
        times = sorted(each for each in times if each < crashed)
        late = [each for n, each in enumerate(times) if n == 0 or each - times[n - 1] > APART]
        add("near miss", late, actor.name)
    if is_route:
        for kind, at, other in [*taken(road, drive, world, found)]:
            add(kind, [at], other)
    is_free = measured.gap.min(axis=1, initial=np.inf) > FREE
    add("blocked", _lasting(measured.time, (speed < STOOD) & is_free, PATIENCE))
    limit = limits_at(road, world, drive["s"])
    fast = (drive["speed"] > OVER * limit) & (drive["speed"] > limit + OVER_BY)
    add("speeding", _lasting(time, fast, TOO_FAST))
    return tuple(sorted(found, key=lambda each: each.at_time))


def limits_at(road: "Road", world: "World", s: FloatArray) -> FloatArray:
    """Returns the speed limit in m/s, at these stations, of the lane that the tested car is to follow."""
    starts, limits = zip(*(limits_of(road, world) or [(0.0, world.limits.speed_limit)]), strict=True)
    return np.asarray(np.array(limits)[np.searchsorted(starts[1:], s, "right")])


def _lasting(time: FloatArray, holds: BoolArray, least: float = 0.0) -> list[float]:
    """Returns when a condition began that then held for ``least`` seconds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]])))
    stretches = zip(edges[::2], edges[1::2] - 1, strict=True)
    return [float(time[first]) for first, last in stretches if time[last] - time[first] >= least - 1e-9]


def _is_on_wrong_road(road: "Road", world: "World", drive: "Drive", beside: BoolArray) -> BoolArray:
    """Returns at which steps the car, beside its own road, drives along another one, or is not back yet."""
    from shapely import contains_xy

    from roadgpt.network.paved import ribbon

    wrong, own = np.zeros(len(drive), bool), {leg.road for leg in legs_of(road, world)}
    steps = np.flatnonzero(beside & (drive["outside"] > GONE))
    for member in network_of(road, world).roads if len(steps) else ():
        x, y = drive["x"][steps], drive["y"][steps]
        on = contains_xy(ribbon(member.road), x, y)
        if member.id in own or not on.any():
            continue
        s = np.linspace(0.0, member.road.length, max(2, math.ceil(member.road.length / STEP) + 1))
        points = member.road.plan.at(s)
        away = np.hypot(x[on, None] - points[:, 0], y[on, None] - points[:, 1])
        ahead = member.road.heading(s[np.argmin(away, axis=1)])
        turned = np.abs(wrap_angle(drive["heading"][steps[on]] - ahead))
        if member.junction is None:  # an arm, on which one may drive either way
            turned = np.minimum(turned, math.pi - turned)
        wrong[steps[on][turned < ALONG]] = True
    for step in np.flatnonzero(beside[1:]) + 1:
        wrong[step] |= wrong[step - 1]
    return wrong


def _is_off_road(road: "Road", world: "World", drive: "Drive") -> BoolArray:
    """Returns at which steps the outer edge of a tyre is outside the paved area. The rear axle is assumed to
    be as far behind the middle of the car as the front axle is ahead of it."""
    import shapely

    box, paved = drive.car, network_of(road, world).paved.buffer(EDGE)
    shapely.prepare(paved)
    front, side = box.axle, box.tyres / 2
    rear = 2 * box.ahead - front
    corners = np.array([[front, side], [front, -side], [rear, -side], [rear, side]])
    c, n = np.cos(drive["heading"])[:, None], np.sin(drive["heading"])[:, None]
    x = drive["x"][:, None] + c * corners[:, 0] - n * corners[:, 1]
    y = drive["y"][:, None] + n * corners[:, 0] + c * corners[:, 1]
    return np.asarray(~shapely.contains_xy(paved, x, y).all(axis=1))


def _stops_missed(road: "Road", drive: "Drive") -> list[float]:
    """Returns when the front of the car crossed a stop line without having stood before it."""
    front = drive["s"] + drive.car.ahead + drive.car.length / 2
    missed = []
    for line in [way.stop_line for way in road.passages if way.stop_line is not None]:
        step = int(np.argmax(front > line))
        near = (front[:step] >= line - STOP_WITHIN) & (drive["speed"][:step] < STOOD)
        if front[step] > line and not near.any():
            missed.append(float(drive["time"][step]))
    return missed
