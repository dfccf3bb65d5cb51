"""Measures how critical a drive among others was, every ``STEP`` seconds, for each of the others.

Places are stations along the middle of the driven lane, and offsets ``t`` to its left, of the middles of
boxes; the stretch of a box along and across is that of the turned box. The other is *ahead* if its middle is.
It is in the *same lane* if its box reaches into the driven lane, and so does the tested car's; or if both
boxes cover the same offsets, wherever the tested car is.

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

from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry import wrap_angle
from roadgpt.geometry.curve import LEAST_STRETCH
from roadgpt.network.lanes import HEADROOM
from roadgpt.traffic.actor import HEADING, SPEED, STEP, X, Y, Z
from roadgpt.verdict.contact import OUTLINE, middles, separation, turned

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

EVEN = 0.02  # m/s; speeds that differ by less are equal, but for rounding
NEAR = 150.0  # m, beyond which others are not measured: 4 s at 130 km/h
ALONG = 0.5  # m between points of the middle of the lane
ACROSS = np.sin(np.radians(30.0))


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes along a Line, and across it; metres, radians, m/s."""

    along: FloatArray
    t: FloatArray
    heading: FloatArray
    half: FloatArray  # (..., 2): half of length and width
    velocity: FloatArray  # (..., 2): along and across

    def __getitem__(self, rows: Any) -> "Boxes":
        return Boxes(*(part[rows] for part in vars(self).values()))

    @property
    def reach(self) -> tuple[FloatArray, FloatArray]:
        """Half of what the box covers along and across."""
        c, s = np.abs(np.cos(self.heading)), np.abs(np.sin(self.heading))
        length, width = self.half[..., 0], self.half[..., 1]
        return length * c + width * s, length * s + width * c


@dataclass(frozen=True, eq=False)
class Measures:
    """Measures of a drive of shape (times, actors), infinite where they do not apply, or where the other is
    not there or more than NEAR away."""

    time: FloatArray
    """Times in seconds, shape (times,)."""
    ttc: FloatArray
    """Time to collision in seconds."""
    conflict: FloatArray
    """Conflict time in seconds."""
    headway: FloatArray
    """Time headway in seconds."""
    deceleration: FloatArray
    """Required deceleration in m/s^2; 0 where none is required or nobody is ahead in the same lane."""
    gap: FloatArray
    """From bumper to bumper along the lane in metres, of others ahead in the same lane."""
    distance: FloatArray
    """Distance between the boxes in metres."""
    pet: FloatArray
    """The smallest post-encroachment time in seconds, shape (actors,)."""
    pet_time: FloatArray
    """When the first one had left the area, in seconds, shape (actors,); NaN without a post-encroachment
    time."""
    lane: "Line"
    """The middle of the driven lane, along which all are measured."""
    car: Boxes
    others: Boxes
    """NaN where the other is not there or more than NEAR away."""


@lru_cache(maxsize=1)  # a collision is asked for them five times
def measure(road: "Road", drive: "Drive", world: "World") -> Measures:
    """Returns the measures of a drive with others on the road."""
    assert drive.others is not None
    time = np.arange(0.0, drive.duration + 1e-6, STEP)
    pose = middles(drive)
    slip = np.arctan2(drive["vy"], drive["vx"])  # of the car's motion against its heading
    x, y, heading, z, speed, slip = (
        np.interp(time, drive["time"], column) for column in (*pose.T, drive["z"], drive["speed"], slip)
    )
    states = drive.others.at(time)
    away = states[..., [X, Y]] - np.stack([x, y], axis=-1)[:, None]
    level = np.abs(z[:, None] - drive.car.height - states[..., Z]) < HEADROOM
    near = level & (np.hypot(away[..., 0], away[..., 1]) < NEAR)  # false for NaN
    step, who = np.nonzero(near)
    sizes = np.array([each.size[:2] for each in drive.others.actors]).reshape(-1, 2) / 2
    lane = driven_lane(road, world)
    half = np.broadcast_to(np.array([drive.car.length, drive.car.width]) / 2, (len(time), 2))
    car = lane.boxes(x, y, heading, half, np.abs(speed), slip)
    found = states[near]
    others = lane.boxes(found[:, X], found[:, Y], found[:, HEADING], sizes[who], found[:, SPEED])
    own = car[step]
    (stretch, side), (stretches, sides) = own.reach, others.reach
    rate, its = own.velocity[:, 0], others.velocity[:, 0]
    abreast = np.abs(others.t - own.t) < sides + side
    same = (lane.holds(others) & lane.holds(own)) | abreast
    ahead = same & (others.along > own.along)
    gap = np.maximum(others.along - stretches - own.along - stretch, 0.0)
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

    def spread(values: FloatArray, without: float = np.inf) -> FloatArray:
        out = np.full(near.shape + values.shape[1:], without)
        out[near] = values
        return out

    return Measures(
        time,
        spread(ttc),
        spread(_conflict(own, others)),
        spread(np.where(ahead, arrival - time[step], np.inf)),
        spread(needed, 0.0),
        spread(np.where(ahead, gap, np.inf)),
        spread(_distance(away[near], heading[step], own.half, found[:, HEADING], others.half)),
        np.array([each[0] for each in pets]),
        np.array([each[1] for each in pets]),
        lane,
        car,
        Boxes(*(spread(part, np.nan) for part in vars(others).values())),
    )


class Line:
    """A line on the ground that is straightened, with the width in metres of the strip along it; before its
    begin and after its end it goes straight on. ``points`` (n, 3) are x, y, z, about ALONG apart."""

    def __init__(self, points: FloatArray, width: FloatArray) -> None:
        from scipy.spatial import cKDTree

        self.middle, self.z, self.width = points[:, :2], points[:, 2], width
        steps = np.diff(self.middle, axis=0)
        self.run = np.concatenate([[0.0], np.cumsum(np.hypot(*steps.T))])
        self.heading = np.unwrap(np.arctan2(*np.gradient(self.middle, self.run, axis=0).T[::-1]))
        self.curvature = np.gradient(self.heading, self.run)
        self.curvature[[0, -1]] = 0.0
        self.tree = cKDTree(self.middle)

    def boxes(
        self, x: FloatArray, y: FloatArray, heading: FloatArray, half: FloatArray, speed: FloatArray,
        slip: FloatArray | float = 0.0,
    ) -> Boxes:  # fmt: skip
        """Returns boxes at these places; ``slip`` is that of their motion against their heading."""
        _, i = self.tree.query(np.stack([x, y], axis=-1))
        cos, sin = np.cos(self.heading[i]), np.sin(self.heading[i])
        dx, dy = x - self.middle[i, 0], y - self.middle[i, 1]
        ahead, t = dx * cos + dy * sin, dy * cos - dx * sin
        bend = self.curvature[i]
        along = self.run[i] + ahead / np.maximum(1 - bend * t, LEAST_STRETCH)
        t = t - bend * ahead**2 / (2 * np.maximum(1 - bend * t, LEAST_STRETCH))
        way = np.asarray(wrap_angle(heading - np.interp(along, self.run, self.heading)))
        velocity = speed[:, None] * np.stack([np.cos(way + slip), np.sin(way + slip)], axis=-1)
        return Boxes(along, t, way, half, velocity)

    def at(self, along: FloatArray, t: FloatArray | float = 0.0) -> FloatArray:
        """Returns the points (..., 3) ``t`` metres to the left of the line."""
        within = np.clip(along, 0.0, self.run[-1])
        x, y, z, heading = (
            np.interp(within, self.run, each) for each in (*self.middle.T, self.z, self.heading)
        )
        cos, sin, beyond = np.cos(heading), np.sin(heading), along - within
        return np.stack([x + beyond * cos - t * sin, y + beyond * sin + t * cos, z], axis=-1)

    def holds(self, boxes: Boxes) -> BoolArray:
        """Whether a box reaches into the strip."""
        return np.asarray(np.abs(boxes.t) - boxes.reach[1] < np.interp(boxes.along, self.run, self.width) / 2)


def driven_lane(road: "Road", world: "World") -> Line:
    """Returns the middle of the lane that the tested car is to follow."""
    profile = world.profile_of(road)
    s = np.linspace(0.0, road.length, max(2, int(road.length / ALONG) + 1))
    return Line(road.at(s, profile.middle(s)), profile.width(s))


def _required(gap: FloatArray, rate: FloatArray, its: FloatArray, gained: FloatArray) -> FloatArray:
    closing = np.maximum(rate - its, 0.0)
    brakes, stops = gained < 0, -its / gained
    moving = closing**2 / (2 * gap) - gained
    standing = rate**2 / (2 * (gap - its**2 / (2 * gained)))
    meets = np.where(closing > 0, 2 * gap / closing, np.inf)  # when both have the same speed, with ``moving``
    needed = np.where(closing > 0, moving, 0.0)
    needed = np.where(brakes & (meets > stops), standing, needed)
    needed = np.where(rate > 0, np.maximum(needed, 0.0), 0.0)
    return np.asarray(np.where((its < 0) & (closing > 0), np.inf, needed))


def _conflict(own: Boxes, others: Boxes) -> FloatArray:
    """Until two boxes that move evenly, without turning, touch: the last of the times at which they begin to
    overlap along the normals of their sides, if it is before the first at which they cease to."""
    away = np.stack([others.along - own.along, others.t - own.t], axis=-1)
    velocity = others.velocity - own.velocity
    angle = others.heading - own.heading
    c, s = np.abs(np.cos(angle)), np.abs(np.sin(angle))
    first, last = np.zeros(len(away)), np.full(len(away), np.inf)
    for heading, mine, theirs in (
        (own.heading, own.half, others.half),
        (others.heading, others.half, own.half),
    ):
        cos, sin = np.cos(heading), np.sin(heading)
        for normal, reach in (
            (np.stack([cos, sin], -1), mine[:, 0] + theirs[:, 0] * c + theirs[:, 1] * s),
            (np.stack([-sin, cos], -1), mine[:, 1] + theirs[:, 0] * s + theirs[:, 1] * c),
        ):
            place, rate = (away * normal).sum(-1), (velocity * normal).sum(-1)
            with np.errstate(divide="ignore", invalid="ignore"):
                times = np.sort(np.stack([(-reach - place) / rate, (reach - place) / rate]), axis=0)
            rests, inside = rate == 0, np.abs(place) < reach
            first = np.maximum(first, np.where(rests, np.where(inside, 0.0, np.inf), times[0]))
            last = np.minimum(last, np.where(rests, np.where(inside, np.inf, -np.inf), times[1]))
    is_behind = others.along + others.reach[0] < own.along - own.reach[0]
    return np.asarray(np.where((first <= last) & ~is_behind, first, np.inf))


def _pet(
    time: FloatArray, car: Boxes, others: Boxes, step: NDArray[np.int64], own: BoolArray
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
    beyond = np.abs(t - path) - side - car.half[0, 1]  # of the strip of the tested car
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


def _distance(
    away: FloatArray, own: FloatArray, half: FloatArray, other: FloatArray, halves: FloatArray
) -> FloatArray:
    """Returns the distance between boxes in plan: from a corner of one to the other box, or 0."""
    least = np.full(len(away), np.inf)
    for place, mine, its, size, sizes in (
        (away, own, other, half, halves),
        (-away, other, own, halves, half),
    ):
        corners = place[:, None] + turned(OUTLINE * sizes[:, None], its[:, None])
        beyond = np.maximum(np.abs(turned(corners, -mine[:, None])) - size[:, None], 0.0)
        least = np.minimum(least, np.hypot(beyond[..., 0], beyond[..., 1]).min(axis=1))
    apart = separation(away, own, other, half, halves).max(axis=-1)
    return np.where(apart < 0, 0.0, least)
