"""Computes where the roads of a network lie: their ends, their carriageways, and which of these overlap.

All roads are computed together. The result for a network is cached, so that all rules share it."""

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry import GradeProfile, PieceCurve
from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Indices
from roadgpt.geometry.pieces import along_all
from roadgpt.network import Network, NetworkRoad, RoadEnd
from roadgpt.network.network import Contact
from roadgpt.network.paved import stations_of

SAG = 0.01  # m, between the edge of a bend and the chords of its polygon
TRIM = 1e-3  # m, by which polygons end before the road, so that roads that are joined do not touch
SLACK = SAG + TRIM  # m, by which the true carriageway may extend beyond its polygon
CONTACTS: tuple[Contact, ...] = ("start", "end")


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
    def ends(self) -> dict[RoadEnd, EndPose]:
        """The EndPose of both ends of every road of the network."""
        places, headings = along_all(self._plans, [np.array([0.0, plan.length]) for plan in self._plans])
        rows = iter(zip(places.tolist(), headings.tolist(), strict=True))
        return {
            RoadEnd(member.id, contact): EndPose(x, y, z, heading, grade)
            for member in self.network.roads
            for contact, (z, grade), ((x, y), heading) in zip(CONTACTS, _heights(member), rows, strict=False)
        }

    @cached_property
    def _edges(self) -> tuple[Array, Array, Array, Indices]:
        """Returns the points ``(n, 2)`` of all right edges in metres, those of all left edges, the stations
        of the points on their roads, and the index of the first point of each road, followed by ``n``."""
        stations = [_inside(stations_of(each.road, SAG)) for each in self.network.roads]
        places, heading = along_all(self._plans, stations)
        pairs = zip(self.network.roads, stations, strict=True)
        left, right = np.concatenate([each.profile.edges(s) for each, s in pairs], axis=1)
        to_left = np.stack((-np.sin(heading), np.cos(heading)), axis=1)
        first = np.cumsum([0, *map(len, stations)])
        return (
            places + right[:, None] * to_left,
            places + left[:, None] * to_left,
            np.concatenate(stations),
            first,
        )

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

        i, j = shapely.STRtree(self.polygons).query(self.polygons, predicate="intersects")
        found = []
        for one, other in sorted(zip(i[i < j].tolist(), j[i < j].tolist(), strict=True)):
            members = self.network.roads[one], self.network.roads[other]
            if members[0].junction is None or members[0].junction != members[1].junction:
                area = shapely.intersection(*shapely.make_valid(self.polygons[[one, other]]))
                if area.area > 0:
                    found.append((*members, area.area, area.centroid.x, area.centroid.y))
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


def _inside(stations: Array) -> Array:
    """Returns stations from one end of a road to the other, the outermost ones moved inwards by ``TRIM``."""
    trim = min(TRIM, stations[-1] / 4)
    return np.clip(stations, trim, stations[-1] - trim)


def _heights(member: NetworkRoad) -> tuple[tuple[float, float], tuple[float, float]]:
    profile = member.road.elevation
    if isinstance(profile, GradeProfile) and not any(profile.grades):
        return (profile.z0, 0.0), (profile.z0, 0.0)
    z, grade = (f(np.array([0.0, member.road.length])).tolist() for f in (profile.height, profile.grade))
    return (z[0], grade[0]), (z[1], grade[1])
