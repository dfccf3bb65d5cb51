"""Measures how critical a drive among others was, every ``STEP`` seconds, for each of the others.

Places are stations along the middle of the driven lane, and offsets ``t`` to its left, of the middles of
boxes; the stretch of a box along and across is that of the turned box. The other is *ahead* if its middle is.
It is in the *same lane* if its box reaches into the driven lane, and so does the tested car's; or if both
boxes cover the same offsets, wherever the tested car is. Of things, such as cones, the latter alone counts.

- time to collision (Hayward 1972; as in UN Regulation No. 157): of somebody ahead in the same lane, the gap
  from bumper to bumper by the speed at which it closes, both speeds along the lane;
- conflict time, our own definition, for paths that cross or meet: until the boxes touch if everybody keeps
  the speed along the lane, the speed across it and the heading against it. Who is wholly behind the tested
  car is left out;
- time headway (van Winsum and Heino 1996): of somebody ahead in the same lane, until the tested car's front
  is where the other's rear is now, by the tested car's recorded motion;
- required deceleration (Jansson 2005): the smallest constant one with which the tested car does not touch
  somebody ahead in the same lane who keeps its present acceleration, and then its rest if it brakes. It is
  infinite if the other comes towards the car;
- post-encroachment time (Allen, Shin and Cooper 1978): of somebody who crossed the tested car's path, at 30
  degrees or more for some time, from when the first one left the area that both needed to when the second one
  reached it; 0 if they were in it together. The area is where the other's box covered the strip that the
  tested car's box needs;
- distance: between the boxes in plan.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry import boxes
from roadgpt.geometry.curve import Array
from roadgpt.language.table import THINGS
from roadgpt.network.lanes import HEADROOM
from roadgpt.network.line import Boxes, Line, driven_line
from roadgpt.traffic.actor import HEADING, STEP, X, Y, Z
from roadgpt.verdict.oracle import BoolArray

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World


EVEN = 0.02  # m/s; speeds that differ by less are equal, but for rounding
NEAR = 150.0  # m, beyond which others are not measured: 4 s at 130 km/h
BESIDE = 0.5  # m, on both sides of a car that passes somebody: its way
ACROSS = np.sin(np.radians(30.0))


@dataclass(frozen=True, eq=False)
class Measures:
    """Measures of a drive of shape (times, actors), infinite where they do not apply, or where the other is
    not there or more than NEAR away."""

    time: Array
    """Times in seconds, shape (times,)."""
    ttc: Array
    """Time to collision in seconds."""
    conflict: Array
    """Conflict time in seconds."""
    headway: Array
    """Time headway in seconds."""
    deceleration: Array
    """Required deceleration in m/s^2; 0 where none is required or nobody is ahead in the same lane."""
    gap: Array
    """From bumper to bumper along the lane in metres, of others ahead in the same lane."""
    distance: Array
    """Distance between the boxes in metres."""
    pet: Array
    """The smallest post-encroachment time in seconds, shape (actors,)."""
    pet_time: Array
    """When the first one had left the area, in seconds, shape (actors,); NaN without a post-encroachment
    time."""
    lane: Line
    """The middle of the driven lane, along which all are measured."""
    car: Boxes
    others: Boxes
    """NaN where the other is not there or more than NEAR away."""


@lru_cache(maxsize=1)  # a collision is asked for them five times
def measure(road: "Road", drive: "Drive", world: "World") -> Measures:
    """Returns the measures of a drive with others on the road."""
    assert drive.others is not None
    time = np.arange(0.0, drive.duration + 1e-6, STEP)
    x, y, heading = drive.middles.T
    slip = np.arctan2(drive["vy"], drive["vx"])  # of the car's motion against its heading
    columns = x, y, drive["z"] - drive.car.height, heading, np.abs(drive["speed"]), slip
    own = np.column_stack([np.interp(time, drive["time"], column) for column in columns])
    states = drive.others.at(time)
    away = states[..., [X, Y]] - own[:, None, [X, Y]]
    level = np.abs(own[:, None, Z] - states[..., Z]) < HEADROOM
    near = level & (np.hypot(away[..., 0], away[..., 1]) < NEAR)  # false for NaN
    step, who = np.nonzero(near)
    sizes = np.array([each.size[:2] for each in drive.others.actors]).reshape(-1, 2)
    lane = driven_line(road, world)
    if drive.moves:  # whom the car was made to pass is beside its way, though it may be in a lane beside it
        lane = replace(lane, width=np.minimum(lane.width, drive.car.width + 2 * BESIDE))
    car = lane.boxes(own[:, :5], np.array([drive.car.length, drive.car.width]), own[:, 5])
    found, mine = states[near], car[step]
    others = lane.boxes(found, sizes[who])
    (stretch, side), (stretches, sides) = mine.reach, others.reach
    rate, its = mine.velocity[:, 0], others.velocity[:, 0]
    abreast = np.abs(others.t - mine.t) < sides + side
    is_thing = np.array([each.kind in THINGS for each in drive.others.actors], bool)[who]
    same = (lane.holds(others) & lane.holds(mine) & ~is_thing) | abreast
    ahead = same & (others.along > mine.along)
    gap = np.maximum(others.along - stretches - mine.along - stretch, 0.0)
    closing = rate - its
    front = np.maximum.accumulate(car.along + car.reach[0])
    arrival = np.interp(others.along - stretches, front, time, right=np.inf)
    faster = np.full(near.shape, np.nan)
    faster[near] = its
    gained = np.nan_to_num(np.gradient(faster, STEP, axis=0)[near]) if len(time) > 1 else np.zeros(len(step))
    with np.errstate(divide="ignore", invalid="ignore"):
        ttc = np.where(ahead & (closing > EVEN), gap / closing, np.inf)
        needed = np.where(ahead, _required(gap, rate, its, gained), 0.0)
    pets = [_pet(time, car, others, step, who == each) for each in range(len(sizes))]

    def spread(values: Array, without: float = np.inf) -> Array:
        out = np.full(near.shape + values.shape[1:], without)
        out[near] = values
        return out

    return Measures(
        time,
        spread(ttc),
        spread(_conflict(mine, others)),
        spread(np.where(ahead, arrival - time[step], np.inf)),
        spread(needed, 0.0),
        spread(np.where(ahead, gap, np.inf)),
        spread(boxes.distance(away[near], own[step, HEADING], mine.size, found[:, HEADING], others.size)),
        np.array([each[0] for each in pets]),
        np.array([each[1] for each in pets]),
        lane,
        car,
        Boxes(*(spread(part, np.nan) for part in vars(others).values())),
    )


def _required(gap: Array, rate: Array, its: Array, gained: Array) -> Array:
    closing = np.maximum(rate - its, 0.0)
    brakes, stops = gained < 0, -its / gained
    moving = closing**2 / (2 * gap) - gained
    standing = rate**2 / (2 * (gap - its**2 / (2 * gained)))
    meets = np.where(closing > 0, 2 * gap / closing, np.inf)  # when both have the same speed, with ``moving``
    needed = np.where(closing > 0, moving, 0.0)
    needed = np.where(brakes & (meets > stops), standing, needed)
    needed = np.where(rate > 0, np.maximum(needed, 0.0), 0.0)
    return np.asarray(np.where((its < 0) & (closing > 0), np.inf, needed))


def _conflict(own: Boxes, others: Boxes) -> Array:
    """Until two boxes that move evenly, without turning, touch: the last of the times at which they begin to
    overlap along the normals of their sides, if it is before the first at which they cease to."""
    away = np.stack([others.along - own.along, others.t - own.t], axis=-1)
    velocity = others.velocity - own.velocity
    place, rate = (np.stack(boxes.along(each.T, own.heading, others.heading)) for each in (away, velocity))
    reach = np.stack(boxes.reach(own.heading, own.size.T, others.heading, others.size.T))
    with np.errstate(divide="ignore", invalid="ignore"):
        times = np.sort(np.stack([(-reach - place) / rate, (reach - place) / rate]), axis=0)
    rests, inside = rate == 0, np.abs(place) < reach
    first = np.where(rests, np.where(inside, 0.0, np.inf), times[0]).max(axis=0, initial=0.0)
    last = np.where(rests, np.where(inside, np.inf, -np.inf), times[1]).min(axis=0)
    is_behind = others.along + others.reach[0] < own.along - own.reach[0]
    return np.asarray(np.where((first <= last) & ~is_behind, first, np.inf))


def _pet(
    time: Array, car: Boxes, others: Boxes, step: NDArray[np.int64], own: BoolArray
) -> tuple[float, float]:
    """Returns the smallest post-encroachment time of one of the others, whose rows are ``own``, and when the
    first one had left the area."""
    none = (np.inf, np.nan)
    if own.sum() < 3:
        return none
    k, along, t = step[own], others.along[own], others.t[own]
    stretch, side = (each[own] for each in others.reach)
    way = np.maximum.accumulate(car.along)
    path = np.interp(along, way, car.t)
    beyond = np.abs(t - path) - side - car.size[0, 1] / 2  # of the strip of the tested car
    best = none
    edges = np.flatnonzero(np.diff(np.concatenate([[False], beyond < 0, [False]])))
    for m, n in zip(edges[::2], edges[1::2] - 1, strict=True):  # the first and the last step over the strip
        if m == 0 or n == len(k) - 1 or k[n + 1] - k[m - 1] != n - m + 2:
            continue  # it was not seen to come or to leave
        is_across = np.abs(np.sin(others.heading[own][m : n + 1])).max() >= ACROSS
        if not is_across or (t[m - 1] > path[m - 1]) == (t[n + 1] > path[n + 1]):
            continue
        comes = np.interp(0.0, -beyond[m - 1 : m + 1], time[k[m - 1 : m + 1]])
        leaves = np.interp(0.0, beyond[n : n + 2], time[k[n : n + 2]])
        lowest, highest = (along - stretch)[m : n + 1].min(), (along + stretch)[m : n + 1].max()
        reach = car.reach[0]
        enters = np.interp(lowest, np.maximum.accumulate(car.along + reach), time, right=np.inf)
        clears = np.interp(highest, np.maximum.accumulate(car.along - reach), time, right=np.inf)
        if np.isinf(enters):
            continue
        pet = max(enters - leaves, comes - clears, 0.0)
        if pet < best[0]:
            best = (float(pet), float(min(leaves, clears)))
    return best
