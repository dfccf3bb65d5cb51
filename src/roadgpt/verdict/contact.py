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

from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.boxes import corners, separation, touching, turned
from roadgpt.geometry.curve import Array
from roadgpt.language.names import Face
from roadgpt.network.lanes import HEADROOM
from roadgpt.traffic.actor import HEADING, SPEED, STEP, X, Y, Z
from roadgpt.verdict.oracle import BoolArray
from roadgpt.verdict.verdict import STANDS, Contact, Incident

if TYPE_CHECKING:
    from roadgpt.drive import Drive


TOUCH = 1e-3  # m; positions of tracks are rounded to it
SLACK = 1.0  # m, by which the car's way between two samples of a track may differ from a straight line


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
    met = touching(place, heading, size)
    own, its_own = cast("tuple[Face, Face]", met.faces)
    speed, its = float(abs(between(drive["speed"]))), float(other[SPEED])
    velocity = turned(np.array([between(drive["vx"]), between(drive["vy"])]), heading[0])
    impact = velocity - its * np.array([np.cos(heading[1]), np.sin(heading[1])])
    outline = corners(place[1], heading[1], size[1])
    across = np.clip(turned(outline - place[0], -heading[0])[:, 1], -size[0, 1] / 2, size[0, 1] / 2)
    is_aside = own in ("left", "right")
    fault = speed > STANDS and (
        abs(its) <= STANDS or own == "front" or (is_aside and drive["outside"][step] > 0)
    )
    return Incident(
        "collision",
        float(between(drive["s"])),
        (float(between(drive["x"])), float(between(drive["y"]))),
        time,
        actor.name,
        Contact(
            xy=(float(met.spot[0]), float(met.spot[1])),
            face=own,
            other_face=its_own,
            place=met.place,
            speed=speed,
            other_speed=its,
            impact_speed=float(np.hypot(*impact)),
            overlap=float(np.ptp(across) / drive.car.width) if own == "front" else None,
            nuplan_at_fault=bool(fault),
        ),
    )
