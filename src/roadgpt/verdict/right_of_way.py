"""Finds where the tested car passed red lights, or took the right of way from others.

- red light: the front of the car passes the line before its lights while they show red;
- failure to yield: the front of the car enters a junction, and somebody drives a way through it to which the
  car's way gives way (see ``network.lanes``); at its speed at that moment it would come to the place where
  the ways meet before the car has left it, or within 1 s; the car comes there first; and then, because of
  that, it brakes by 3 m/s2 or more over 0.5 s, or the two have a near miss (see ``verdict.criteria``).
  Or the two touch there, whoever came first. Who comes at a red light has no priority.

To give way is not to compel others to change their speed abruptly (Vienna Convention on Road Traffic, 1968,
article 1); above 3 m/s2 UN Regulation No. 79, 5.6.4.7, calls a situation critical for who approaches. The
rest is our definition. Only vehicles count here.
"""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from roadgpt.language.table import VEHICLES
from roadgpt.network import legs_of, network_of
from roadgpt.network.lanes import Lane, lanes_of
from roadgpt.network.network import RoadEnd
from roadgpt.traffic.actor import HEADING, SPEED, STEP, STILL, X, Y
from roadgpt.verdict.verdict import Incident, IncidentKind

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World
    from roadgpt.traffic import Tracks

HARD, OVER = 3.0, 5  # m/s^2, samples
SPARE = 1.0  # s
BEGINS = 3.0  # m from the start of a way, within which whoever drives it was seen first
SAME = 0.7  # cosine of the angle to a way above which somebody drives along it
LATER = 3.0  # s after its front has left a way, in which its rear may still be touched there


def taken(
    road: "Road", drive: "Drive", world: "World", known: Sequence[Incident]
) -> Iterator[tuple[IncidentKind, float, str | None]]:
    """Yields kind, time and the other's name of what a car on a route did wrong; ``known`` are its collisions
    and near misses."""
    from roadgpt.traffic.following import GREEN, RED
    from roadgpt.traffic.lights import lights_of

    assert drive.others is not None
    network, others = network_of(road, world), drive.others
    lanes, front = lanes_of(network), drive["s"] + drive.car.ahead + drive.car.length / 2
    lights = lights_of(road, world, drive.seed)

    def shows(arm: RoadEnd, time: float) -> int:
        return lights.shown(arm, time) if drive.lights else GREEN

    def reached(place: float, ahead: float = 0.0) -> float:
        passed = np.maximum.accumulate(front + ahead)
        return float(np.interp(place, passed, drive["time"], left=np.nan, right=np.inf))

    for way in road.passages:
        time = np.inf if way.light_line is None else reached(way.light_line)
        if np.isfinite(time) and shows(way.arrival, time) == RED:
            yield "red light", time, None
    hits = {each.other: each.at_time for each in known if each.contact is not None}
    blamed = set[tuple[float, int]]()
    for leg, start, end in zip(legs_of(road, world), road.starts, road.starts[1:], strict=False):
        enters = reached(start)
        if network.road(leg.road).junction is None or not np.isfinite(enters):
            continue
        for key in lanes.gives_way_to(leg):
            place, arm = lanes.meeting(leg, key), network.connection_of[key.road][1].incoming
            if place is None or shows(arm, enters) == RED:
                continue
            first, last = start + np.array(place.own) / lanes[leg].length * (end - start)
            comes, clears = reached(first), reached(last, -drive.car.length)
            for number, begins, arrives, leaves in who_drives(others, lanes[key], place.others[0]):
                name, v = others.actors[number].name, others.states[:, number, SPEED]
                missed = [each.at_time for each in known if each.other == name and each.contact is None]
                if enters <= hits.get(name, -1.0) and begins <= hits[name] <= leaves + LATER:
                    blamed.add((enters, number))
                    continue
                now, then = int(enters / STEP), int(arrives / STEP)
                would = v[now:then].sum() * STEP / max(v[now], STILL)  # or NaN: not there yet
                if not (comes < arrives and v[now] > STILL and would < clears - enters + SPARE):
                    continue
                slowed = [k for k in range(now, then - OVER + 1) if v[k] - v[k + OVER] >= HARD * OVER * STEP]
                is_forced = any(shows(arm, k * STEP) == GREEN for k in slowed)
                if is_forced or any(enters - SPARE <= time <= arrives + SPARE for time in missed):
                    blamed.add((enters, number))
    for time, number in sorted(blamed):
        yield "failure to yield", time, others.actors[number].name


def who_drives(
    others: "Tracks", lane: Lane, place: float, begins: float = BEGINS
) -> Iterator[tuple[int, float, float, float]]:
    """Yields for everybody who drives along a lane, seen there within ``begins`` metres of its start: the
    number, and when its front comes into the lane, comes to a station, and leaves it or was seen last."""
    import shapely

    half = np.array([each.size.length for each in others.actors]) / 2
    is_vehicle = np.array([each.kind in VEHICLES for each in others.actors], bool)
    states = others.states
    shapely.prepare(lane.area)
    x = states[..., X] + half * np.cos(states[..., HEADING])
    y = states[..., Y] + half * np.sin(states[..., HEADING])
    step, who = np.nonzero(shapely.contains_xy(lane.area, x, y) & is_vehicle)
    s, _ = lane.locate(x[step, who], y[step, who])
    along = np.cos(states[step, who, HEADING] - lane.heading(s)) > SAME
    step, who, s = step[along], who[along], s[along]
    for number in np.unique(who):
        own = np.flatnonzero(who == number)
        for rows in np.split(own, np.flatnonzero(np.diff(step[own]) > 1) + 1):
            there = rows[s[rows] >= place]
            if s[rows[0]] <= begins and len(there):
                first, at, last = (float(step[k]) * STEP for k in (rows[0], there[0], rows[-1]))
                yield int(number), first, at, last
