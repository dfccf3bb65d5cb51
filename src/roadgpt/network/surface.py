"""Divides the surface of a network into the roads outside junctions and the level areas of the junctions.

A roundabout is one area, which includes the pieces of its ring. The roads and the areas together cover the
paved area of the network. Pictures, pages and exported meshes are made from these parts."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from roadgpt.brief.junctions import RAMPS
from roadgpt.geometry.curve import Array
from roadgpt.ground.ground import SLOPE, Pavement, Portal, Span
from roadgpt.network.network import Junction, Kind, Network, NetworkRoad, RoadEnd
from roadgpt.network.paved import GRID, NEAR, Area, paved_by, polygons_in
from roadgpt.road import Road
from roadgpt.road.edges import line, stations

if TYPE_CHECKING:
    from shapely import Polygon

COVER = 7.0  # m from the road in a tunnel to the least land above it
UNDER = 2.0  # m from a road on a bridge to the land below it, at least; less beside its ends
LONGEST = 4.0  # m between the points of a road's rim
ROUND = 8  # segments in a quarter of a circle, where a shoulder rounds a corner
GREEN = 0.1  # least share of a hole in the paved area that shoulders leave free, so that grass grows there


@dataclass(frozen=True, eq=False)
class JunctionSurface:
    """The level surface of one junction, or of one roundabout, seen from above."""

    kind: Kind
    height: float  # height in metres
    junctions: tuple[int, ...]  # the ids of the junctions: one, or all those of a roundabout
    paved: Area  # the area of the connecting roads, and of the ring of a roundabout
    shoulder: Area
    """The shoulder around the paved area, without the shoulders of the roads that lead there; may be
    empty."""
    kerbed: tuple["Polygon", ...]
    """Traffic islands with kerbs: holes in the paved area that are too small for a shoulder, and the noses of
    medians."""
    green: tuple["Polygon", ...]
    """The areas of grass inside the shoulders of larger islands, such as the middle of a roundabout, and the
    medians beside ramps."""


@dataclass(frozen=True, eq=False)
class NetworkSurface:
    """The surface of a network, in parts that do not overlap."""

    roads: tuple[NetworkRoad, ...]  # the roads outside junctions and roundabouts
    areas: tuple[JunctionSurface, ...]
    shoulder: float
    """The width in metres of the shoulder around the junctions, see ``Network.shoulder``; 0 for none."""

    @classmethod
    def of(cls, network: Network) -> "NetworkSurface":
        """Returns the surface of a network, divided into its parts."""
        roads = network.roads_outside
        width = network.shoulder
        if not network.nodes:  # roads without junctions may be splines, and have no paved area
            return cls(roads, (), width)
        beside = paved_by([with_shoulders(each) for each in roads]) if width > 0 else network.paved
        areas = tuple(
            _area_of(network, node, paved, width, beside)
            for node, paved in zip(network.nodes, network.paved_nodes, strict=True)
        )
        return cls(roads, areas, width)

    @property
    def reach(self) -> float:
        """The largest distance in metres from the reference line of a road in ``roads`` to the outer edge of
        its shoulder, an upper bound; roads with a wider ``shoulder`` do not count."""
        return max(each.profile.reach for each in self.roads if each.shoulder <= self.shoulder)


def stations_of(member: NetworkRoad) -> Array:
    """Returns the stations ``(n,)`` in metres at which the surface of a road has points: close enough for
    all lines beside it, and at most ``LONGEST`` apart."""
    s = stations(member.road, member.profile.reach)
    parts = np.maximum(1, np.ceil(np.diff(s) / LONGEST)).astype(int)
    place = np.r_[0, np.cumsum(parts)]
    return np.interp(np.arange(place[-1] + 1), place, s)


def pavement_of(network: Network, spans: Sequence[Span] = ()) -> Pavement:
    """Returns the surface of all roads and junctions of a network with their shoulders, which the ground
    meets: not on bridges and in tunnels, the ``spans``."""
    import shapely
    from shapely.geometry.polygon import orient

    parts = NetworkSurface.of(network)
    inner, outer, shapes, covers, decks, portals = [], [], [], [], [], list[Portal]()
    clear = []
    for member in parts.roads:
        own = sorted((each for each in spans if each.road == member.id), key=lambda each: each.start)
        stops = [0.0, *(at for each in own for at in (each.start, each.end)), member.road.length]
        for number, (start, end) in enumerate(pairwise(stops)):
            left, right, left_rim, right_rim = lines_of(member, start, end)
            if number % 2 == 0:
                inner.append(sheet(right, left))
                outer += [sheet(left, left_rim), sheet(right_rim, right)]
                shapes.append(shapely.Polygon(np.concatenate([right_rim, left_rim[::-1]])[:, :2]))
                continue
            decks.append(sheet(right_rim, left_rim))
            if own[number // 2].kind == "bridge":
                low_left, low_right = (_lowered(rim) for rim in (left_rim, right_rim))
                clear.append(sheet(low_right, low_left))
            else:
                covers.append(sheet(right_rim, left_rim) + [0.0, 0.0, COVER])
                for at, way in ((0, 1), (-1, -1)):
                    ahead = way * _unit(left_rim[at] - right_rim[at])[::-1] * [1.0, -1.0]
                    one, other = (left_rim[at], right_rim[at])[::way]
                    portals.append(Portal(one, other, ahead, COVER))
    for area in parts.areas:
        for part in (area.paved, *area.kerbed, *area.green, area.shoulder):
            flat, corners = triangulated(part)
            level = np.column_stack([flat, np.full(len(flat), area.height)])
            (inner if part is area.paved else outer).append(level[corners])
        shapes += [area.paved, area.shoulder, *area.kerbed, *area.green]
    if len(shapes) == 1 and shapes[0].is_valid:
        whole = shapes[0]
    else:
        united = shapely.union_all(shapely.make_valid(np.array(shapes, object)))
        whole = shapely.set_precision(united, GRID)
    rings = [
        np.asarray(ring.coords, float)[:-1, :2]
        for part in polygons_in(whole)
        for ring in (orient(part).exterior, *orient(part).interiors)
    ]
    cover, under, deck = (np.concatenate([np.empty((0, 3, 3)), *each]) for each in (covers, clear, decks))
    more = {"portals": tuple(portals), "covers": cover, "clear": under, "spans": tuple(spans), "decks": deck}
    return Pavement.of(np.concatenate([*inner, *outer]), rings, **more)


def lines_of(member: NetworkRoad, start: float, end: float) -> list[Array]:
    """Returns the left and right edge and the left and right rim between two stations, ``(n, 3)`` each, on
    the sides of the triangles that exporters make of the road."""
    s, profile = stations_of(member), member.profile
    own = np.r_[start, s[(s > start) & (s < end)], end]
    lines = (line(member.road, s, t) for t in (*profile.edges(s), *profile.rims(s)))
    return [np.column_stack([np.interp(own, s, each[:, k]) for k in range(3)]) for each in lines]


def _lowered(rim: Array) -> Array:
    """Returns the line ``(n, 3)`` of land below a rim of a bridge: down from both ends, then along it."""
    far = np.r_[0.0, np.cumsum(np.hypot(*np.diff(rim[:, :2], axis=0).T))]
    down = np.minimum(SLOPE * np.minimum(far, far[-1] - far), UNDER)
    return np.asarray(rim - down[:, None] * [0.0, 0.0, 1.0])


def _unit(vector: Array) -> Array:
    flat = vector[:2]
    return np.asarray(flat / np.hypot(*flat))


def sheet(right: Array, left: Array) -> Array:
    """Returns the triangles ``(2n - 2, 3, 3)`` between two lines ``(n, 3)``, seen from where ``left`` is left
    of ``right``."""
    a, b, c, d = right[:-1], right[1:], left[1:], left[:-1]
    return np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3, 3)


def free_ends(network: Network, road: NetworkRoad) -> tuple[bool, bool]:
    """Returns whether the start and whether the end of a road is free. A free end is at no junction."""
    return (
        RoadEnd(road.id, "start") not in network.junction_at,
        RoadEnd(road.id, "end") not in network.junction_at,
    )


def with_shoulders(member: NetworkRoad) -> Road:
    """Returns a road whose shoulders are driving lanes, so that its paved area includes them."""
    profile = member.profile
    sides = [tuple(replace(lane, kind="driving") for lane in side) for side in (profile.left, profile.right)]
    return member.road.with_profile(replace(profile, left=sides[0], right=sides[1]))


def _area_of(
    network: Network, node: tuple[Kind, tuple[Junction, ...]], paved: Area, width: float, beside: Area
) -> JunctionSurface:
    """Returns the surface of one of ``Network.nodes``, from its paved area, the width in metres of the
    shoulder, and ``beside``: the area of all roads outside junctions, with their shoulders."""
    import shapely

    kind, junctions = node
    wide = paved.buffer(width, quad_segs=ROUND) if width > 0 else paved
    holes = [shapely.Polygon(hole) for part in shapely.get_parts(paved) for hole in part.interiors]
    noses = list(_beside_medians(network, paved, wide, holes))
    kerbed, green = ([], noses) if kind in RAMPS else (noses, [])
    for hole in holes:
        rest = shapely.difference(hole, wide)
        if rest.area < GREEN * hole.area:
            kerbed.append(hole)
        else:
            green += [part for part in shapely.get_parts(rest) if part.area > 0]
    used = shapely.union_all([network.paved, beside, *kerbed, *green])
    shoulder = polygons(shapely.difference(wide, used)) if width > 0 else shapely.MultiPolygon()
    height = junctions[0].node[2]
    numbers = tuple(each.id for each in junctions)
    return JunctionSurface(kind, height, numbers, paved, shoulder, tuple(kerbed), tuple(green))


def _beside_medians(
    network: Network, paved: Area, wide: Area, holes: "Sequence[Polygon]"
) -> "Iterator[Polygon]":
    """Yields what lies between the ways of a junction and the ends of medians, apart from the ``holes`` in
    the paved area of the junction; ``wide`` is this area with a shoulder around it."""
    import shapely

    for part in shapely.get_parts(network.paved):
        for hole in map(shapely.Polygon, part.interiors):
            is_near = shapely.dwithin(hole, paved, NEAR) and shapely.difference(hole, wide).area < NEAR
            if is_near and not any(each.contains(hole.representative_point()) for each in holes):
                yield hole


def polygons(shape: Any) -> Area:
    """Returns the polygons among the parts of a shape, without lines and points."""
    import shapely

    parts = polygons_in(shape)
    return parts[0] if len(parts) == 1 else shapely.MultiPolygon(parts)


def triangulated(area: Area) -> tuple[Array, NDArray[np.int64]]:
    """Returns the corners ``(n, 2)`` of an area in metres, and triangles that fill it: indices ``(m, 3)`` of
    corners, counter-clockwise. An empty area has none."""
    import shapely

    found = shapely.get_parts(shapely.constrained_delaunay_triangles(area))
    if not len(found):
        return np.empty((0, 2)), np.empty((0, 3), np.int64)
    corners = shapely.get_coordinates(found).reshape(-1, 4, 2)[:, :3]
    points, at = np.unique(corners.reshape(-1, 2), axis=0, return_inverse=True)
    triangles = at.reshape(-1, 3).astype(np.int64)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    turn = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    triangles[turn < 0] = triangles[turn < 0][:, ::-1]
    return points, triangles[np.abs(turn) > 0]
