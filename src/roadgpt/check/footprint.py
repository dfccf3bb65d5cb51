"""Computes where the roads of a network lie: their ends, their carriageways, and which of these overlap.

All roads are computed together. The result for a network is cached, so that all rules share it."""

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry import CubicProfile, GradeProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.geometry.pieces import advance
from roadgpt.network import Network, NetworkRoad, RoadEnd
from roadgpt.network.building import edges_at

SAG = 0.01  # m, between the edge of a bend and the chords of its polygon
LONGEST = 8.0  # m, of a chord of a bend
WIDENING = 1.0  # m, of a chord where a width varies
TRIM = 1e-3  # m, by which polygons end before the road, so that roads that are joined do not touch
SLACK = SAG + TRIM  # m, by which the true carriageway may extend beyond its polygon
ROUNDING = 1e-9  # m

Indices = NDArray[np.intp]


class EndPose(NamedTuple):
    """The centre line at one end of a road: the point in metres, and the heading in radians and the grade as
    a ratio in the direction of increasing stations."""

    x: float
    y: float
    z: float
    heading: float
    grade: float

    def beside(self, t: float) -> tuple[float, float]:
        """Returns the point (x, y), in metres, that lies ``t`` metres to the left of the centre line."""
        return self.x - t * math.sin(self.heading), self.y + t * math.cos(self.heading)


@dataclass(frozen=True, eq=False)
class Footprint:
    """The carriageways of all roads of a network in plan view, without shoulders."""

    network: Network

    @cached_property
    def _plans(self) -> list[PieceCurve]:
        plans = [each.road.plan for each in self.network.roads]
        assert all(isinstance(plan, PieceCurve) for plan in plans)
        return plans  # type: ignore[return-value]

    @cached_property
    def _pieces(self) -> tuple[Indices, Array, Array, Array, Array, Array, Array]:
        """All lines, arcs and clothoids, one after another, ``(m,)`` each: the index of the road, the length,
        the curvature at the start and its change per metre, and heading, x and y at the start."""
        rows = [(n, p.length, p.k0, p.k1) for n, plan in enumerate(self._plans) for p in plan.pieces]
        table = np.array(rows)
        owner, length, k0, k1 = table[:, 0].astype(np.intp), *table[:, 1:].T
        starts = np.array([(plan.x, plan.y, plan.heading0) for plan in self._plans])[owner]
        first = np.searchsorted(owner, owner)
        heading = starts[:, 2] + _before(length * (k0 + k1) / 2, first)
        dk = (k1 - k0) / length
        dx, dy = advance(length, heading, k0, dk, length)
        x, y = starts[:, 0] + _before(dx, first), starts[:, 1] + _before(dy, first)
        return owner, length, k0, dk, heading, x, y

    def _places(self, index: Indices, u: Array) -> tuple[Array, Array, Array]:
        """Returns x, y and heading ``u`` metres behind the starts of pieces; arrays of the shape of ``u``."""
        length, k0, dk, heading, x, y = (column[index] for column in self._pieces[1:])
        dx, dy = advance(u, heading, k0, dk, length)
        return x + dx, y + dy, heading + u * (k0 + u * dk / 2)

    @cached_property
    def ends(self) -> dict[RoadEnd, EndPose]:
        """The EndPose of both ends of every road of the network."""
        owner, length, *_ = self._pieces
        last = np.flatnonzero(np.diff(owner, append=-1))
        x, y, heading = (column.tolist() for column in self._places(last, length[last]))
        found = {}
        for n, (member, plan) in enumerate(zip(self.network.roads, self._plans, strict=True)):
            (z0, g0), (z1, g1) = _heights(member)
            found[RoadEnd(member.id, "start")] = EndPose(plan.x, plan.y, z0, plan.heading0, g0)
            found[RoadEnd(member.id, "end")] = EndPose(x[n], y[n], z1, heading[n], g1)
        return found

    @cached_property
    def _edges(self) -> tuple[Array, Array, Array, Indices]:
        """Returns the points ``(n, 2)`` of all right edges in metres, those of all left edges, the stations
        of the points on their roads, and the index of the first point of each road, followed by ``n``."""
        index, u = self._stations()
        pieces, length, *_ = self._pieces
        owner = pieces[index]
        x, y, heading = self._places(index, u)
        first = np.searchsorted(owner, np.arange(len(self._plans) + 1))
        s = _before(length, np.searchsorted(pieces, pieces))[index] + u
        usual = np.array([edges_at(each.profile, 0.0) for each in self.network.roads])
        left, right = np.repeat(usual, np.diff(first), axis=0).T.copy()
        for n in np.flatnonzero(self._varies).tolist():
            here = slice(first[n], first[n + 1])
            left[here], right[here] = self.network.roads[n].profile.edges(s[here])
        sin, cos = np.sin(heading), np.cos(heading)
        return (
            np.stack((x - right * sin, y + right * cos), axis=1),
            np.stack((x - left * sin, y + left * cos), axis=1),
            s,
            first,
        )

    def _stations(self) -> tuple[Indices, Array]:
        """Returns the piece of each point of the edges, and its distance in metres from the piece's start."""
        owner, length, k0, dk, *_ = self._pieces
        reach = np.array([each.profile.paved_reach for each in self.network.roads])[owner]
        varies = self._varies[owner]
        bend = np.maximum(np.abs(k0), np.abs(k0 + dk * length))
        with np.errstate(divide="ignore"):
            step = np.minimum(LONGEST, np.sqrt(8 * SAG / (bend * (1 + bend * reach))))
        step = np.where(varies, np.minimum(step, WIDENING), np.where(bend == 0, length, step))
        count = np.maximum(1, np.ceil(length / step - ROUNDING)).astype(np.intp)
        ends = np.diff(owner, append=-1) != 0
        index = np.repeat(np.arange(len(owner)), count + ends)
        nth = np.arange(len(index)) - np.searchsorted(index, index)
        u = nth * (length / count)[index]
        trim = np.minimum(TRIM, length / 4)
        starts = np.searchsorted(owner, owner) == np.arange(len(owner))
        u = np.where((nth == 0) & starts[index], trim[index], u)
        u = np.where((nth == count[index]) & ends[index], (length - trim)[index], u)
        return index, u

    @cached_property
    def _varies(self) -> NDArray[np.bool_]:
        return np.array([_varies(each) for each in self.network.roads])

    @cached_property
    def bounds(self) -> Array:
        """The smallest x and y and the largest x and y in metres of each polygon, ``(n, 4)``. The true
        carriageway may extend beyond its polygon by up to ``SLACK`` metres."""
        right, left, _, first = self._edges
        low = np.minimum.reduceat(np.minimum(right, left), first[:-1])
        high = np.maximum.reduceat(np.maximum(right, left), first[:-1])
        return np.concatenate((low, high), axis=1)

    def outermost(self, n: int, side: int) -> tuple[float, float, float]:
        """Returns the point (x, y) where the carriageway of ``network.roads[n]`` extends farthest to one
        side, and the station of the road there, in metres. Sides: 0 smallest x, 1 smallest y, 2 largest x, 3
        largest y."""
        right, left, s, first = self._edges
        here = slice(first[n], first[n + 1])
        points = np.concatenate((right[here], left[here]))
        along = points[:, side % 2]
        worst = int(along.argmin() if side < 2 else along.argmax())
        x, y = points[worst].tolist()
        return x, y, float(np.tile(s[here], 2)[worst])

    @cached_property
    def polygons(self) -> NDArray[Any]:
        """The carriageways as shapely polygons, shape ``(n,)``, in the order of ``network.roads``."""
        import shapely

        right, left, _, first = self._edges
        corners = [np.concatenate((right[a:b], left[a:b][::-1])) for a, b in pairwise(first.tolist())]
        return np.array([shapely.Polygon(each) for each in corners], object)

    @cached_property
    def overlaps(self) -> tuple[tuple[NetworkRoad, NetworkRoad, float, float, float], ...]:
        """The pairs of roads whose carriageways overlap in plan view, with the area in square metres that
        both cover, and x and y of the centroid of this area. Connecting roads of the same junction are not
        compared."""
        import shapely

        i, j = _near(self.bounds)
        inside = np.array([-1 if each.junction is None else each.junction for each in self.network.roads])
        apart = (inside[i] != inside[j]) | (inside[i] < 0)
        i, j = i[apart], j[apart]
        shapely.prepare(self.polygons)
        meet = shapely.intersects(self.polygons[i], self.polygons[j])
        found = []
        for one, other in zip(i[meet], j[meet], strict=True):
            both = [shapely.make_valid(self.polygons[n]) for n in (one, other)]
            area = shapely.intersection(*both)
            if area.area > 0:
                middle = area.centroid
                members = self.network.roads[one], self.network.roads[other]
                found.append((*members, area.area, middle.x, middle.y))
        return tuple(found)

    @cached_property
    def folded(self) -> tuple[NetworkRoad, ...]:
        """The roads whose edges touch or cross each other: such a road overlaps itself, or nearly does."""
        import shapely

        is_valid = shapely.is_valid(self.polygons)
        return tuple(each for each, fine in zip(self.network.roads, is_valid, strict=True) if not fine)


@lru_cache(maxsize=2)
def footprint(network: Network) -> Footprint:
    """Returns the Footprint of a network. The Footprints of the last two networks are cached."""
    return Footprint(network)


def _before(values: Array, first: Indices) -> Array:
    """Returns, for each value, the sum of the values from index ``first`` up to the value before this one."""
    total = np.cumsum(values) - values
    return np.asarray(total - total[first])


def _near(bounds: Array) -> tuple[Indices, Indices]:
    low, high = bounds[:, None, :2], bounds[None, :, 2:]
    touch = (low <= high).all(axis=2)
    one, other = np.nonzero(np.triu(touch & touch.T, 1))
    return one, other


def _varies(member: NetworkRoad) -> bool:
    lanes = (*member.profile.left, *member.profile.right)
    widths = [member.profile.offset, *(lane.width for lane in lanes if lane.kind == "driving")]
    return any(isinstance(width, CubicProfile) for width in widths)


def _heights(member: NetworkRoad) -> tuple[tuple[float, float], tuple[float, float]]:
    profile = member.road.elevation
    if isinstance(profile, GradeProfile) and not any(profile.grades):
        return (profile.z0, 0.0), (profile.z0, 0.0)
    z, grade = (f(np.array([0.0, member.road.length])).tolist() for f in (profile.height, profile.grade))
    return (z[0], grade[0]), (z[1], grade[1])
