"""Finds what a car did wrong on a route through junctions, each time with its place.

The kinds of incidents:

- out of lane: as in ``verdict.oracle``; inside a junction, the lane is that of the route's connecting road;
- wrong turn: more than 90 % of the car is outside its lane; its centre of gravity is beside the road of the
  route, on a road that the route does not use; and its heading is within 30 degrees of the direction of this
  unused road (outside junctions, of either direction);
- wrong way: the car's centre of gravity is on the road of the route, and its heading differs by more than 90
  degrees from that of the route, for 1 s or longer;
- off road: the outer edge of a tyre is outside the paved area of the network;
- stop line: the front of the car crosses the line at a stop sign, and the car never stood still (below 0.1
  m/s) while its front was within the last 4 m before the line.

The rule for stop signs is that of CARLA (leaderboard and scenario_runner). The other kinds resemble CARLA's
criteria, with stricter limits. An incident begins at the first step at which its condition holds, and ends
when the condition no longer holds; a wrong turn ends when the car is back on the road of the route.
"""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry import wrap_angle
from roadgpt.network import Network, legs_of, network_of
from roadgpt.verdict.oracle import is_outside
from roadgpt.verdict.verdict import Incident, IncidentKind

if TYPE_CHECKING:
    from roadgpt.drive import Drive
    from roadgpt.road import Road, World

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

GONE = 0.9  # share of the car outside its lane; a car that slides wide and comes back took no wrong turn
ALONG = math.radians(30.0)  # between the heading of the car and that of a wrong road on which it drives
BACKWARDS = math.radians(90.0)  # between the heading of the car and that of the route
PATIENCE = 1.0  # s of driving the wrong way
STOOD = 0.1  # m/s
STOP_WITHIN = 4.0  # m before the line
EDGE = 0.02  # m, by which a tyre may be beyond the polygon of the paved area, whose chords cut bends by 2 mm
STEP = 1.0  # m, between points at which the heading of other roads is known


def incidents_of(route: "Road", drive: "Drive", world: "World") -> tuple[Incident, ...]:
    """Returns what the car did wrong on a route, in order of time."""
    network, edges = network_of(route, world), world.profile_of(route).edges(drive["s"])
    is_beside: BoolArray = (drive["t"] > edges.left) | (drive["t"] < edges.right)
    others = [each.id for each in network.roads if each.id not in {leg.road for leg in legs_of(route, world)}]
    steps_of: dict[IncidentKind, list[int]] = {
        "out of lane": begins(is_outside(route, drive, world)),
        "wrong turn": begins(_is_on_wrong_road(network, others, drive, is_beside)),
        "wrong way": begins(_is_backwards(route, drive, is_beside)),
        "off road": begins(_is_off_road(network, drive)),
        "stop line": _stops_missed(route, drive),
    }
    found = [(step, kind) for kind, steps in steps_of.items() for step in steps]
    return tuple(
        Incident(
            kind,
            float(drive["s"][step]),
            (float(drive["x"][step]), float(drive["y"][step])),
            float(drive["time"][step]),
        )
        for step, kind in sorted(found, key=lambda each: each[0])
    )


def begins(holds: BoolArray) -> list[int]:
    """Returns the indices of the steps at which a condition begins to hold.

    ``holds`` says for each step whether the condition holds, shape ``(n,)``.
    """
    steps = np.flatnonzero(holds & ~np.concatenate([[False], holds[:-1]]))
    return [int(step) for step in steps]


def _is_on_wrong_road(
    network: Network, others: Sequence[int], drive: "Drive", beside: BoolArray
) -> BoolArray:
    """Returns at which steps the car, beside its own road, drives along one of the ``others`` (ids)."""
    from shapely import contains_xy

    from roadgpt.network.paved import ribbon

    wrong = np.zeros(len(drive), bool)
    steps = np.flatnonzero(beside & (drive["outside"] > GONE))
    for member in map(network.road, others if len(steps) else ()):
        x, y = drive["x"][steps], drive["y"][steps]
        on = contains_xy(ribbon(member.road), x, y)
        if not on.any():
            continue
        s = np.linspace(0.0, member.road.length, max(2, math.ceil(member.road.length / STEP) + 1))
        points = member.road.plan.at(s)
        away = np.hypot(x[on, None] - points[:, 0], y[on, None] - points[:, 1])
        ahead = member.road.heading(s[np.argmin(away, axis=1)])
        turned = np.abs(wrap_angle(drive["heading"][steps[on]] - ahead))
        if member.junction is None:  # an arm, on which one may drive either way
            turned = np.minimum(turned, math.pi - turned)
        wrong[steps[on][turned < ALONG]] = True
    for first in begins(wrong):
        back = np.flatnonzero(~beside[first:])
        wrong[first : first + back[0] if len(back) else None] = True
    return wrong


def _is_backwards(route: "Road", drive: "Drive", beside: BoolArray) -> BoolArray:
    turned = np.abs(wrap_angle(drive["heading"] - route.heading(drive["s"])))
    against = (turned > BACKWARDS) & ~beside
    kept = np.zeros(len(drive), bool)
    for first in begins(against):
        rest = np.flatnonzero(~against[first:])
        last = first + int(rest[0]) - 1 if len(rest) else len(drive) - 1
        if drive["time"][last] - drive["time"][first] >= PATIENCE - 1e-9:
            kept[first : last + 1] = True
    return kept


def wheels(drive: "Drive") -> FloatArray:
    """Returns the points (x, y) of the outer edges of the four tyres at every step, in metres, ``(n, 4, 2)``.

    The order is front left, front right, rear right, rear left. The rear axle is assumed to be as far
    behind the middle of the car as the front axle is ahead of the middle.
    """
    box = drive.car
    front, side = box.axle, box.tyres / 2
    rear = 2 * box.ahead - front
    corners = np.array([[front, side], [front, -side], [rear, -side], [rear, side]])
    c, n = np.cos(drive["heading"])[:, None], np.sin(drive["heading"])[:, None]
    x = drive["x"][:, None] + c * corners[:, 0] - n * corners[:, 1]
    y = drive["y"][:, None] + n * corners[:, 0] + c * corners[:, 1]
    return np.stack([x, y], axis=-1)


def _is_off_road(network: Network, drive: "Drive") -> BoolArray:
    import shapely

    paved = network.paved.buffer(EDGE)
    shapely.prepare(paved)
    at = wheels(drive)
    off: BoolArray = ~shapely.contains_xy(paved, at[..., 0], at[..., 1]).all(axis=1)
    return off


def _stops_missed(route: "Road", drive: "Drive") -> list[int]:
    """Returns the steps at which the front of the car crosses a stop line without having stood before it."""
    front = drive["s"] + drive.car.ahead + drive.car.length / 2
    missed = []
    for way in route.passages:
        line = way.stop_line
        if line is None or not (front > line).any():
            continue
        step = int(np.argmax(front > line))
        near = (front[:step] >= line - STOP_WITHIN) & (drive["speed"][:step] < STOOD)
        if not near.any():
            missed.append(step)
    return missed
