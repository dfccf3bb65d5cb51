"""Finds where places lie along the tested car's road, and in which of its driving lanes."""

import math

import numpy as np
from numpy.typing import NDArray

from roadgpt.compiled import compiled
from roadgpt.drive.outlook import from_left
from roadgpt.geometry.curve import LEAST_STRETCH, Array
from roadgpt.network import legs_of, network_of
from roadgpt.network.line import SPACING
from roadgpt.road import Road, World

FEW = 8  # points, of which one is looked at before its neighbours are


@compiled
def find(
    x: Array, y: Array, points: Array, edges: Array, own: "NDArray[np.int64]", near: "NDArray[np.int64]",
    found: Array,
) -> None:  # fmt: skip
    """Writes the station, the offset and the lane of each place into ``found`` (n, 3), as seen from the
    nearest point and corrected for the curvature there; NaN is no lane. ``points`` have x, y, heading,
    station and curvature; ``edges`` and ``own`` are those of LanesAlong. ``near`` has for each place the
    number of the point around which it is looked for, -1 for all, and gets that which was found."""
    for k in range(len(x)):
        at, best = max(near[k], 0), np.inf
        for step in (FEW, 1):
            if step > 1 and near[k] >= 0:
                continue
            first, last = (0, len(points)) if step > 1 else (max(at - FEW, 0), min(at + FEW + 1, len(points)))
            for n in range(first, last, step):
                away = (points[n, 0] - x[k]) ** 2 + (points[n, 1] - y[k]) ** 2
                if away < best:
                    at, best = n, away
        near[k] = at
        dx, dy, bend = x[k] - points[at, 0], y[k] - points[at, 1], points[at, 4]
        cos, sin = math.cos(points[at, 2]), math.sin(points[at, 2])
        ahead, t = dx * cos + dy * sin, dy * cos - dx * sin
        stretch = max(1.0 - bend * t, LEAST_STRETCH)
        found[k, 0] = points[at, 3] + ahead / stretch
        found[k, 1] = t - bend * ahead**2 / (2.0 * stretch)
        found[k, 2] = np.nan
        for n in range(edges.shape[2]):
            if edges[1, at, n] < found[k, 1] <= edges[0, at, n]:
                found[k, 2] = own[at] - n


class LanesAlong:
    """The driving lanes along a road or route, every SPACING metres."""

    def __init__(self, road: Road, world: World) -> None:
        network, rows, first = network_of(road, world), list[list[Array]](), 0.0
        s = np.linspace(0.0, road.length, max(int(road.length / SPACING), 1) + 1)
        self._points = np.column_stack([road.at(s, 0.0)[:, :2], road.heading(s), s, road.curvature(s)])
        self._own = np.zeros(len(s), int)
        """How many lanes are to the left of the one that the car is to follow."""
        before = None
        for leg, start, end in zip(legs_of(road, world), road.starts, road.starts[1:], strict=False):
            first = first if leg.road == before else start  # where the lane is changed, a road has two legs
            before, member = leg.road, network.road(leg.road)
            here = np.flatnonzero((s >= start) & (s <= end))
            sign = 1 if member.profile.leads_along(leg.lane) else -1
            own = s[here] - first if sign > 0 else member.road.length - (s[here] - first)
            lanes = from_left(member.profile, leg.lane)
            self._own[here] = lanes.index(leg.lane)
            rows += [[] for _ in lanes[len(rows) :]]
            for row, lane in zip(rows, lanes, strict=False):
                left, right = member.profile.edges_of(lane, own)[::sign]
                row.append(np.stack([here, sign * left, sign * right]))
        self._edges = np.full((2, len(s), len(rows)), np.nan)
        """The offsets of the left and the right edges of the lanes, which are in order from the left."""
        for number, row in enumerate(rows):
            where, *edges = np.concatenate(row, axis=1)
            self._edges[:, where.astype(int), number] = edges

    def places(
        self, x: Array, y: Array, near: "NDArray[np.int64]"
    ) -> tuple[list[float], list[float], list[int | None]]:
        """Returns the stations, the offsets and the lanes of places, as ``Other`` has them; for ``near`` see
        ``find``."""
        found = np.empty((len(x), 3))
        find(x, y, self._points, self._edges, self._own, near, found)
        s, t, lanes = found.T.tolist()
        return s, t, [None if math.isnan(lane) else int(lane) for lane in lanes]
