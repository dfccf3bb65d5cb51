"""Finds where the tested car touched others on the road.

Both are boxes in plan. Between two steps of a drive, a box moves evenly along a straight line and turns
evenly. A contact is the first moment at which the boxes are within TOUCH of each other; it is found by
conservative advancement: nobody can come closer than the distance, divided by the fastest approach, allows.
The distance is that of the separating axis theorem (``geometry.boxes``).

``nuplan_at_fault`` is that of nuPlan (Karnchanachari et al. 2024, "no at-fault collisions"): it is the tested
car's fault, if it moves and hits somebody who stands, or hits somebody with its front, or with a side while
part of it is outside its lane. It is not the tested car's if it stands, if it is hit in its rear by somebody
who moves, or at a side within its lane.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.boxes import corners, separation, turned
from roadgpt.geometry.curve import Array
from roadgpt.network.lanes import HEADROOM
from roadgpt.traffic.actor import HEADING, SPEED, STEP, X, Y, Z
from roadgpt.verdict.oracle import BoolArray
from roadgpt.verdict.verdict import STANDS, Contact, Face, Incident

if TYPE_CHECKING:
    from roadgpt.drive import Drive


TOUCH = 1e-3  # m; positions of tracks are rounded to it
SLACK = 1.0  # m, by which the car's way between two samples of a track may differ from a straight line
CORNER = 0.02  # m, within which a corner belongs to the place of contact
PARALLEL = np.radians(20.0)  # two sides at a smaller angle meet flat; else a corner meets a side


def contacts_of(drive: "Drive") -> tuple[Incident, ...]:
    """Returns the first contact with each of the others, in order of time."""
    if drive.others is None or not drive.others.actors:
        return ()
    from_step, actor, share = _first_contacts(drive)
    rows = zip(from_step.tolist(), actor.tolist(), share.tolist(), strict=True)
    return tuple(sorted((_described(drive, *row) for row in rows), key=lambda each: each.at_time))


def _first_contacts(drive: "Drive") -> tuple[NDArray[np.int64], NDArray[np.int64], Array]:
    """Returns step, actor and share of the way to the next step of the first contacts, one for each actor."""
    assert drive.others is not None
    others, time, car = drive.others, drive["time"], drive.middles
    size = np.array([drive.car.length, drive.car.width])
    sizes = np.array([each.size[:2] for each in others.actors])
    reach, reaches = np.hypot(*size) / 2, np.hypot(sizes[:, 0], sizes[:, 1]) / 2
    step, actor = np.nonzero(_is_near(drive, car, reach + reaches))
    after = np.minimum(step + 1, len(time) - 1)
    states, later = others.at(time[step], actor), others.at(time[after], actor)
    later = np.where(np.isnan(later), states, later)  # somebody who leaves is there up to the step before
    level = np.abs(drive["z"][step] - drive.car.height - states[:, Z]) < HEADROOM
    away = states[:, [X, Y]] - car[step, :2]
    change = later[:, [X, Y]] - car[after, :2] - away
    turn, turns = car[after, 2] - car[step, 2], later[:, HEADING] - states[:, HEADING]
    most = np.hypot(*change.T) + reach * np.abs(turn) + reaches[actor] * np.abs(turns)
    near = np.flatnonzero(level & (np.hypot(*away.T) - reach - reaches[actor] <= most + TOUCH))
    step, actor = step[near], actor[near]
    away, change, most = away[near], change[near], most[near]
    headings, turn, turns, sizes = states[near, HEADING], turn[near], turns[near], sizes[actor]
    share, is_open = np.zeros(len(step)), np.ones(len(step), bool)
    while is_open.any():
        k = np.flatnonzero(is_open)
        u = share[k]
        place, own, other = away[k] + u[:, None] * change[k], car[step[k], 2] + u * turn[k], headings[k]
        apart = separation(place, own, size, other + u * turns[k], sizes[k]).max(axis=-1)
        is_open[k] = apart > TOUCH
        share[k] += np.where(apart > TOUCH, apart / np.maximum(most[k], TOUCH / 2), 0.0)
        is_open[k] &= share[k] <= 1.0
    touched = np.flatnonzero(share <= 1.0)
    _, first = np.unique(actor[touched], return_index=True)  # rows are in the order of time
    chosen = touched[first]
    return step[chosen], actor[chosen], share[chosen]


def _is_near(drive: "Drive", car: Array, reach: Array) -> BoolArray:
    """Returns for each step and actor whether they may touch between the samples of the track around it,
    shape (steps, actors); ``reach`` is the sum of the radii around the boxes."""
    assert drive.others is not None
    states, time = drive.others.states, drive["time"]
    sample = np.clip((time / STEP + 1e-9).astype(int), 0, len(states) - 1)
    at = np.arange(len(states)) * STEP
    place = np.stack([np.interp(at, time, car[:, 0]), np.interp(at, time, car[:, 1])], axis=-1)
    away = states[..., [X, Y]] - place[:, None]
    free = np.hypot(away[..., 0], away[..., 1]) - reach
    moved = np.full_like(free, np.inf)  # after the last sample the others stand and the car goes on
    moved[:-1] = np.nan_to_num(np.hypot(*np.moveaxis(np.diff(away, axis=0), -1, 0)))
    return np.asarray((free <= moved + SLACK)[sample])


def _described(drive: "Drive", step: int, number: int, share: float) -> Incident:
    assert drive.others is not None
    actor, last = drive.others.actors[number], min(step + 1, len(drive) - 1)

    def between(values: Array) -> Array:
        return np.asarray((1 - share) * values[step] + share * values[last])

    time = float(between(drive["time"]))
    car, other = between(drive.middles), drive.others.at(time)[number]
    if np.isnan(other[X]):  # it left at the step itself
        other = drive.others.at(drive["time"][step])[number]
    size = np.array([[drive.car.length, drive.car.width], actor.size[:2]])
    place, heading = np.stack([car[:2], other[[X, Y]]]), np.array([car[2], other[HEADING]])
    outlines = corners(place, heading, size)
    inside = [
        point
        for mine in (0, 1)
        for point in outlines[mine]
        if (np.abs(turned(point - place[1 - mine], -heading[1 - mine])) <= size[1 - mine] / 2 + CORNER).all()
    ]
    spot = np.mean(inside, axis=0) if inside else place.mean(axis=0)
    away = place[1] - place[0]
    apart = separation(away, heading[0], size[0], heading[1], size[1])
    faces = [
        _face(n, away * (1 - 2 * n), heading, apart, turned(spot - place[n], -heading[n])) for n in (0, 1)
    ]
    speed, its = float(abs(between(drive["speed"]))), float(other[SPEED])
    velocity = turned(np.array([between(drive["vx"]), between(drive["vy"])]), heading[0])
    impact = velocity - its * np.array([np.cos(heading[1]), np.sin(heading[1])])
    across = np.clip(turned(outlines[1] - place[0], -heading[0])[:, 1], -size[0, 1] / 2, size[0, 1] / 2)
    is_aside = faces[0] in ("left", "right")
    fault = speed > STANDS and (
        abs(its) <= STANDS or faces[0] == "front" or (is_aside and drive["outside"][step] > 0)
    )
    return Incident(
        "collision",
        float(between(drive["s"])),
        (float(between(drive["x"])), float(between(drive["y"]))),
        time,
        actor.name,
        Contact(
            xy=(float(spot[0]), float(spot[1])),
            face=faces[0],
            other_face=faces[1],
            speed=speed,
            other_speed=its,
            impact_speed=float(np.hypot(*impact)),
            overlap=float(np.ptp(across) / drive.car.width) if faces[0] == "front" else None,
            nuplan_at_fault=bool(fault),
        ),
    )


def _face(mine: int, away: Array, heading: Array, apart: Array, spot: Array) -> Face:
    """Returns with which side box ``mine``, 0 or 1, met the other, which is ``away`` from it: that along the
    line on which both are ``apart`` the most. A corner that meets a side is one of the front or the rear, as
    with nuPlan; ``spot`` is where it is."""
    flat, is_across = divmod(int(apart.argmax()), 2)
    ahead, left = turned(away, -heading[mine])
    turn = (heading[mine] - heading[flat] + np.pi / 4) % np.pi - np.pi / 4  # -45 to 135 degrees
    is_crossed = turn > np.pi / 4
    if abs(turn - is_crossed * np.pi / 2) > PARALLEL:
        return "front" if spot[0] > 0 else "rear"
    if is_across != is_crossed:
        return "left" if left > 0 else "right"
    return "front" if ahead > 0 else "rear"
