"""Finds what went wrong in a drive with others on the road, each time with its place.

The kinds of incidents:

- collision: the first contact with each of the others, see ``verdict.contact``;
- near miss: with somebody who was not hit, a conflict time (see ``verdict.measures``) below 0.95 s while the
  tested car moves, the bound of nuPlan for the time to collision; or a post-encroachment time below 1 s, at
  which Peesapati, Hunter and Rodgers (2013) found the closest relation to accidents;
- blocked: the tested car stands (below 0.1 m/s) for 30 s with nobody within 10 m ahead in its lane, our
  definition;
- out of lane, on a single road: as in ``verdict.oracle``; on a route it is one of ``verdict.incidents``;
- red light, failure to yield, on a route: see ``verdict.right_of_way``;
- speeding: more than 5 % and more than 1 m/s above the limit of the lane for 1 s, our definition.

An incident begins at the first step at which its condition holds. Near misses with the same other within 3 s
are one; none is counted after a collision, since nobody moves then as cars would.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roadgpt.drive.outlook import limits_of
from roadgpt.network import only_road
from roadgpt.verdict.contact import contacts_of
from roadgpt.verdict.measures import measure
from roadgpt.verdict.oracle import is_outside
from roadgpt.verdict.right_of_way import taken
from roadgpt.verdict.verdict import STANDS, Incident, IncidentKind

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

BoolArray = NDArray[np.bool_]

CONFLICT, ENCROACHED = 0.95, 1.0  # s
APART = 3.0  # s between two near misses
STOOD, PATIENCE, FREE = 0.1, 30.0, 10.0  # m/s, s, m
OVER, OVER_BY, TOO_FAST = 1.05, 1.0, 1.0  # ratio, m/s, s


def incidents_among_others(road: "Road", drive: "Drive", world: "World") -> tuple[Incident, ...]:
    """Returns what went wrong among others on the road, in order of time."""
    if drive.others is None:
        return ()
    found, measured = list(contacts_of(drive)), measure(road, drive, world)
    hit, crashed = {each.other for each in found}, min((each.at_time for each in found), default=np.inf)
    speed = np.interp(measured.time, drive["time"], drive["speed"])
    for number, actor in enumerate(drive.others.actors):
        if actor.name in hit:
            continue
        times = [*measured.time[(measured.conflict[:, number] < CONFLICT) & (speed > STANDS)]]
        if measured.pet[number] < ENCROACHED:
            times.append(measured.pet_time[number])
        times = sorted(time for time in times if time < crashed)
        late = [time for n, time in enumerate(times) if n == 0 or time - times[n - 1] > APART]
        found += [_at(drive, "near miss", time, actor.name) for time in late]
    if only_road(road, world) is not None:
        found += [
            _at(drive, "out of lane", time)
            for time in _lasting(drive["time"], is_outside(road, drive, world))
        ]
    else:
        found += [_at(drive, *wrong) for wrong in [*taken(road, drive, world, found)]]
    is_free = measured.gap.min(axis=1, initial=np.inf) > FREE
    found += [
        _at(drive, "blocked", time) for time in _lasting(measured.time, (speed < STOOD) & is_free, PATIENCE)
    ]
    limit = limits_along(road, drive, world)
    fast = (drive["speed"] > OVER * limit) & (drive["speed"] > limit + OVER_BY)
    found += [_at(drive, "speeding", time) for time in _lasting(drive["time"], fast, TOO_FAST)]
    return tuple(sorted(found, key=lambda each: each.at_time))


def limits_along(road: "Road", drive: "Drive", world: "World") -> NDArray[np.float64]:
    """Returns the speed limit in m/s of the lane that the tested car is to follow, at every step."""
    starts, limits = zip(*(limits_of(road, world) or [(0.0, world.limits.speed_limit)]), strict=True)
    return np.asarray(np.array(limits)[np.searchsorted(starts[1:], drive["s"], "right")])


def _at(drive: "Drive", kind: IncidentKind, time: float, other: str | None = None) -> Incident:
    s, x, y = (float(np.interp(time, drive["time"], drive[name])) for name in ("s", "x", "y"))
    return Incident(kind, s, (x, y), float(time), other)


def _lasting(time: NDArray[np.float64], holds: BoolArray, least: float = 0.0) -> list[float]:
    """Returns when a condition began that then held for ``least`` seconds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], holds, [False]])))
    stretches = zip(edges[::2], edges[1::2] - 1, strict=True)
    return [float(time[first]) for first, last in stretches if time[last] - time[first] >= least - 1e-9]
