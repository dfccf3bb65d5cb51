"""Builds the meshes of roads and networks: carriageways and shoulders as one surface, posts, level junctions,
islands, lines, signs, and the land around them.

The colours of asphalt and shoulders depend on a station s, an offset t, and the offsets of lane boundaries
at this station. All roads of a network lie one after another on one axis of stations. The last two stretches
of this axis are for junctions: on the first, boundaries are so far away that nothing is painted; on the
second, the carriageway ends at t = 0."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np
import shapely
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.ground.ground import Ground
from roadgpt.ground.mesh import GroundMesh, mesh_of, water_of
from roadgpt.ground.relief import smooth
from roadgpt.network import Network, NetworkRoad, RoadEnd, network_of, only_road
from roadgpt.network.markings import JunctionSign, arrows, between_crosswalks, signs, strokes
from roadgpt.network.paved import Area
from roadgpt.network.structures import solids
from roadgpt.network.surface import (
    ROUND,
    JunctionSurface,
    NetworkSurface,
    polygons,
    stations_of,
    triangulated,
)
from roadgpt.road import Profile, Road, World
from roadgpt.road.edges import line, normals
from roadgpt.road.profile import LINE as PAINTED
from roadgpt.scene.light import (
    BLACK,
    CONCRETE,
    DIM_RED,
    DIM_YELLOW,
    GREEN,
    RED,
    RIM,
    WATER,
    WHITE,
    YELLOW,
    daylight,
    level_light,
)
from roadgpt.scene.mesh import GRASS, POST, ROAD, Patch, attributes, grid, joined
from roadgpt.scene.shade import INSET, LINE, PERIOD, LaneBoundaries

TILE = 64.0  # m, side of the squares that the land is cut into
ROCK = (0.12, 0.3)  # 1 less the cosine of the slope: from where grass ends, and where all is rock
BLOCK = 24  # steps from station to station in a patch
THICK = 0.5  # m, thickness of a road that floats
POST_EVERY, POST_WIDE, POST_HIGH = 25.0, 0.14, 1.0
"""Distance between posts, width of a post, and height of a post, in metres. The distance is half of that on
straight German roads, to give a better impression of speed."""
LIFT = 0.006  # m by which lines and medians lie above the road
POST_FROM_RIM = 0.6  # m from the outer edge of the shoulder
FAR = 1e4  # m, offset of boundaries that are too far away to be seen
BESIDE = 0.3  # m of asphalt with an edge line, laid along a kerb
KERB = 0.12  # m, height of a traffic island
OVERLAP = 0.05  # m by which the edge line of a junction lies on that of a road
BARE = 0.8  # m beside the carriageway of a junction, beyond which its shoulder is all grass
LEAST_OFFSET = 1e-6  # m
CHECKS = 8  # squares across the lane at the end of the route
SignColour = Literal["grey", "white", "red", "yellow", "green", "black", "dim red", "dim yellow"]
COLOURS: dict[SignColour, int] = {
    "grey": RIM, "white": WHITE, "red": RED, "yellow": YELLOW, "green": GREEN, "black": BLACK,
    "dim red": DIM_RED, "dim yellow": DIM_YELLOW,
}  # fmt: skip


def land_patches(ground: Ground) -> list[Patch]:
    """Returns the surface of the ground and of its water. The first surface coordinate of the ground says how
    much of it is rock, 0 to 1: all where it is steep."""
    mesh, water = mesh_of(ground), water_of(ground)
    up = mesh.normals
    bare = smooth(1.0 - up[:, 2], *ROCK)
    values = attributes(bare, 0.0, daylight(up))
    out = _tiles(mesh, values, GRASS)
    if len(water.triangles):
        out += _tiles(water, attributes(0.0, 0.0, np.full(len(water.points), level_light())), WATER)
    return out


def _concrete(triangles: Array) -> Patch:
    """Returns triangles ``(m, 3, 3)`` as a patch, each with its own corners."""
    facing = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    facing /= np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-9)
    light = np.repeat(daylight(facing), 3)
    corners = np.arange(3 * len(triangles)).reshape(-1, 3)
    kinds = np.full(len(triangles), CONCRETE, np.int64)
    return Patch(triangles.reshape(-1, 3), attributes(0.0, 0.0, light), corners, kinds)


def _tiles(mesh: GroundMesh, values: Array, kind: int) -> list[Patch]:
    """Returns the triangles of a mesh in patches of those that lie in the same square."""
    middles = mesh.points[mesh.triangles, :2].mean(axis=1)
    keys = np.floor(middles / TILE).astype(np.int64)
    order = np.lexsort(keys.T)
    cuts = np.flatnonzero(np.any(np.diff(keys[order], axis=0), axis=1)) + 1
    out = []
    for members in np.split(order, cuts):
        used, triangles = np.unique(mesh.triangles[members], return_inverse=True)
        kinds = np.full(len(members), kind, np.int64)
        out.append(Patch(mesh.points[used], values[used], triangles.reshape(-1, 3), kinds))
    return out


def _blocks(rows: Array, values: Array, kind: int) -> list[Patch]:
    return [
        grid(rows[i : i + BLOCK + 1], values[i : i + BLOCK + 1], kind) for i in range(0, len(rows) - 1, BLOCK)
    ]


def surface(road: Road, profile: Profile, s: Array, start: float = 0.0) -> list[Patch]:
    """Returns the surface of carriageway and shoulders, with points at the stations ``s``. The surface
    coordinates of a point are ``start`` + station and the offset t, in metres."""
    bounds = [t for _, t in reversed(profile.boundaries(s))]
    offsets = [bounds[0]]
    for one, other in pairwise(bounds):
        offsets += [(one + other) / 2, other]
    if profile.has_shoulders:
        left, right = profile.rims(s)
        offsets = [right, *offsets, left]
    rows = np.stack([line(road, s, t) for t in offsets], axis=1)
    light = daylight(_upwards(road, s))
    t = np.sign(np.stack(offsets, axis=1)) * np.linalg.norm(rows - road.at(s)[:, None], axis=-1)
    return _blocks(rows, attributes(start + s[:, None], t, light[:, None]), ROAD)


def median(road: Road, profile: Profile, s: Array) -> list[Patch]:
    """Returns the grass of a median between the lines beside it, with points at the stations ``s``; nothing
    if there is no median."""
    if not profile.is_divided:
        return []
    left, right = profile.edges_of(-profile.side, s)
    rows = np.stack([line(road, s, t) for t in (right + PAINTED / 2, left - PAINTED / 2)], axis=1)
    light = np.repeat(daylight(_upwards(road, s))[:, None], 2, axis=1)
    return _blocks(rows + [0.0, 0.0, LIFT], attributes(0.0, 0.0, light), GRASS)


def _upwards(road: Road, s: Array) -> Array:
    if road.profile is not None and road.profile.superelevation_angle is not None:
        along, left = np.gradient(road.at(s), axis=0), road.at(s, 1.0) - road.at(s)
        banked = np.cross(along, left)
        return np.asarray(banked / np.linalg.norm(banked, axis=-1, keepdims=True))
    return normals(road, s)


def slab(road: Road, profile: Profile, s: Array) -> list[Patch]:
    """Returns the sides, the underside and the ends of a floating road."""
    left, right = (line(road, s, t) for t in profile.edges(s))
    down = np.array([0.0, 0.0, -THICK])
    out = []
    sides = (left, left + down, 0.62), (right + down, right, 0.62), (left + down, right + down, 0.4)
    for a, b, light in sides:
        out += _blocks(np.stack([a, b], axis=1), attributes(0.0, 0.0, np.full((len(s), 2), light)), CONCRETE)
    for at, order in ((0, -1), (-1, 1)):
        corners = np.array([[left[at], left[at] + down], [right[at], right[at] + down]])
        out.append(grid(corners[::order], attributes(0.0, 0.0, np.full((2, 2), 0.62)), CONCRETE))
    return out


def posts(road: Road, profile: Profile, is_free: Callable[[Array], bool]) -> list[Patch]:
    """Returns the posts beside a road as upright boxes, whose second surface coordinate is the height in
    metres. There is no post at a position ``(3,)`` for which ``is_free`` returns False."""
    count = max(1, int(road.length / POST_EVERY))
    s = np.asarray((np.arange(count) + 0.5) * (road.length / count), np.float64)
    model, facing = _post()
    out = []
    edges, rims = profile.edges(s), profile.rims(s)
    for sign, edge, rim in ((-1, edges.right, rims.right), (1, edges.left, rims.left)):
        has_room = sign * (rim - edge) >= POST_FROM_RIM + 0.2
        places = line(road, s, rim - sign * POST_FROM_RIM)
        for place, heading in zip(places[has_room], road.heading(s)[has_room], strict=True):
            if not is_free(place):
                continue
            c, n = np.cos(heading), np.sin(heading)
            turn = np.array([[c, n, 0.0], [-n, c, 0.0], [0.0, 0.0, 1.0]])
            values = model.attributes.copy()
            values[:, 2] = daylight(facing @ turn)
            out.append(Patch(model.points @ turn + place, values, model.triangles, model.kinds))
    return out


@cache
def _post() -> tuple[Patch, Array]:
    half = POST_WIDE / 2
    ring = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * [half, half * 0.8]
    outward = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    heights = np.array([[-0.1], [POST_HIGH]])
    parts, facing = [], []
    for k in range(4):
        net = np.stack([np.column_stack([ring[k : k + 2], np.full(2, h)]) for h in (-0.1, POST_HIGH)])
        parts.append(grid(net[:, ::-1], attributes(k, heights, np.zeros((2, 2))), POST))
        facing += [outward[k]] * 4
    lid = np.column_stack([ring[[0, 3, 1, 2]], np.full(4, POST_HIGH)]).reshape(2, 2, 3)
    parts.append(grid(lid.swapaxes(0, 1), attributes(0.0, POST_HIGH, np.zeros((2, 2))), POST))
    facing += [np.array([0.0, 0.0, 1.0])] * 4
    return joined(parts), np.array(facing)


@dataclass(frozen=True, eq=False)
class StationAxis:
    """The axis of stations on which all roads of a network lie, and the boundaries of lanes along it."""

    starts: dict[int, float]  # the station at which each road begins, by the id of the road
    plain: float  # the first station of the stretch on which nothing is painted
    kerb: float  # the first station of the stretch on which the carriageway ends at offset 0
    lanes: LaneBoundaries

    @classmethod
    def of(cls, network: Network, parts: NetworkSurface) -> "StationAxis":
        """Returns the axis of all roads of a network. The stretch without paint is longer than the greatest x
        extent of a junction."""
        widest = max([0.0, *(float(np.ptp(each.paved.bounds[::2])) for each in parts.areas)])
        starts, rows, at = {}, [], 0.0
        for each in parts.roads:
            # a broken line begins with a dash at the start of each road
            length = PERIOD * (math.ceil(each.road.length / PERIOD) + 1)
            starts[each.id] = at
            rows.append(_three(network, each, np.minimum(np.arange(length), each.road.length)))
            at += length
        plain, wide = at, math.ceil(widest) + 2
        rows.append(np.tile([FAR, 0.9 * FAR, -FAR], (wide, 1)))
        rows.append(np.tile([0.0, -FAR, -2 * FAR], (4, 1)))
        marks = np.array([1, 2, 1])
        offsets = np.ascontiguousarray(np.concatenate(rows))
        # the length is far beyond the axis, so that no goal is drawn at its end: see ``_start_and_goal``
        lanes = LaneBoundaries(offsets, marks, 1, 1.0, FAR * FAR)
        return cls(starts, plain, plain + wide, lanes)


def _three(network: Network, member: NetworkRoad, s: Array) -> Array:
    """Returns the offsets ``(n, 3)`` of left edge, centre line and right edge.

    If ``_has_broken_line_only`` is False, the lines within the carriageway are drawn as separate patches, and
    the left edge takes the place of the centre line."""
    found = [t for _, t in member.profile.boundaries(s)]
    centre = np.zeros_like(s) if _has_broken_line_only(network, member) else found[0]
    return np.stack([found[0], centre, found[-1]], axis=1)


def _has_broken_line_only(network: Network, member: NetworkRoad) -> bool:
    if network.crossed & {RoadEnd(member.id, "start"), RoadEnd(member.id, "end")}:
        return False
    profile = member.profile
    inner = profile.markings(np.zeros(1))[1:-1]
    middle = [float(edges.left[0] + edges.right[0]) for _, edges in inner]
    return [marking for marking, _ in inner] == ["broken"] and abs(middle[0]) < LEAST_OFFSET


def patches_of(road: Road, world: World, ground: Ground) -> tuple[list[Patch], LaneBoundaries]:
    """Returns the patches of roads, junctions, lines, arrows and signs, of the route's start and goal, and of
    the land; and the boundaries of lanes along the axis of stations."""
    network, land = network_of(road, world), land_patches(ground)
    land += [_concrete(each) for each in solids(network, ground)]
    is_laid = bool(ground.pavement.rims)  # and does not float
    if (only := only_road(road, world)) is not None:  # whose boundaries show its lines, start and goal
        patches = _road(network, only, 0.0, is_laid, has_others=False)
        return [*patches, *land], LaneBoundaries.of(only.profile, road.length)
    parts = NetworkSurface.of(network)
    axis = StationAxis.of(network, parts)
    out: list[Patch] = []
    for member in parts.roads:
        out += _road(network, member, axis.starts[member.id], is_laid)
    for area in parts.areas:
        out += _junction(area, axis)
    by_road = {each.id for each in parts.roads if _has_broken_line_only(network, each)}
    for stroke in strokes(network):
        if stroke.kind == "edge" and stroke.road is None:
            out.append(_kerb_line(stroke.points, axis.kerb))
        elif stroke.kind in ("stop", "give_way", "crosswalk") or (
            stroke.kind == "lane" and stroke.road not in by_road
        ):
            out.append(_painted(stroke.points, stroke.width))
    for arrow in arrows(network):
        out.append(_patch(arrow.points + [0.0, 0.0, LIFT], level_light(), arrow.corners, WHITE))
    out += _start_and_goal(road)
    for sign in signs(network):
        out += [_flat(face.points, COLOURS[face.colour]) for face in faces_of(sign)]
    return [*out, *land], axis.lanes


def _road(
    network: Network, member: NetworkRoad, start: float, is_laid: bool, has_others: bool = True
) -> list[Patch]:
    road, profile = member.road, member.profile
    s = green = stations_of(member)
    if has_others:
        first, last = between_crosswalks(network, member)
        green = np.r_[first, s[(s > first) & (s < last)], last]
    out = [*surface(road, profile, s, start), *median(road, profile, green)]
    if not is_laid:
        return [*out, *slab(road, profile, s)]

    def is_beside(place: Array) -> bool:
        return not has_others or bool(shapely.distance(network.paved, shapely.Point(place[:2])) > 0.5)

    return [*out, *posts(road, profile, is_beside)]


def _junction(area: JunctionSurface, axis: StationAxis) -> list[Patch]:
    out = [_level(area.paved, area.height, ROAD, axis.plain)]
    if not area.shoulder.is_empty:
        out += _shoulder(area, axis.kerb)
        out += [_level(island, area.height, GRASS, 0.0) for island in area.green]
    for island in area.kerbed:
        out.append(_level(island, area.height + KERB, CONCRETE, 0.0))
        ring = np.asarray(island.exterior.coords, float)[:: 1 if island.exterior.is_ccw else -1, :2]
        low = np.column_stack([ring, np.full(len(ring), area.height)])
        out.append(_strip(low, low + [0.0, 0.0, KERB], 0.7, CONCRETE))
    return out


def _shoulder(area: JunctionSurface, station: float) -> list[Patch]:
    """Returns the shoulder of a junction: gravel that turns into grass, and grass farther away.

    All corners of the whole may lie at the carriageway, as those between two ways do; between corners without
    any distance from it, it would be all gravel."""
    near, far = near_and_far(area)
    out = [] if near.is_empty else [_level(near, area.height, ROAD, station, area.paved)]
    return out if far.is_empty else [*out, _level(far, area.height, GRASS, 0.0)]


def near_and_far(area: JunctionSurface) -> tuple[Area, Area]:
    """Returns the shoulder of a junction within ``BARE`` metres of its carriageway, and beyond."""
    near = area.paved.buffer(BARE, quad_segs=ROUND)
    return polygons(area.shoulder.intersection(near)), polygons(area.shoulder.difference(near))


def _level(area: Area, height: float, kind: int, station: float, beside: "Area | None" = None) -> Patch:
    """Returns a level area; with ``beside``, its offsets are the distances from that area."""
    flat, triangles = triangulated(area)
    if beside is None:
        s, t = flat[:, 0] - flat[:, 0].min(), flat[:, 1] - flat[:, 1].min()
    else:
        s, t = flat[:, 0] + flat[:, 1], np.asarray(shapely.distance(beside, shapely.points(flat)))
        s = s - s.min()
    values = attributes(station + s, t, level_light())
    if kind != ROAD:
        values[:, :2] = 0.0
    points = np.column_stack([flat, np.full(len(flat), height)])
    return Patch(points, values, triangles, np.full(len(triangles), kind, np.int64))


def _strip(right: Array, left: Array, light: float, kind: int) -> Patch:
    values = attributes(0.0, 0.0, np.full((len(right), 2), light))
    return grid(np.stack([right, left], axis=1), values, kind)


def _offset(points: Array, t: float) -> Array:
    """Returns a line moved to its left by ``t`` metres, each point along the mean of its two normals."""
    along = np.gradient(points[:, :2], axis=0)
    left = np.column_stack([-along[:, 1], along[:, 0]])
    left /= np.maximum(np.linalg.norm(left, axis=1, keepdims=True), 1e-9)
    return np.column_stack([points[:, :2] + t * left, points[:, 2]])


def _kerb_line(points: Array, station: float) -> Patch:
    """Returns asphalt with an edge line; the carriageway lies to the left of the points.

    Where the line is open, it begins and ends a little on the road: as it lies above the road, the asphalt
    before it would be seen as a gap between it and the road's own line."""
    if not np.array_equal(points[0], points[-1]):
        steps = points[[0, -1]] - points[[1, -2]]
        steps *= OVERLAP / np.linalg.norm(steps, axis=1, keepdims=True)
        points = np.concatenate([points[:1] + steps[0], points[1:-1], points[-1:] + steps[1]])
    edge = _offset(points, -PAINTED / 2) + [0.0, 0.0, LIFT]
    inner = _offset(points, BESIDE - PAINTED / 2) + [0.0, 0.0, LIFT]
    s = station + np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))]
    values = attributes(s[:, None], np.array([0.0, -BESIDE]), level_light())
    return grid(np.stack([edge, inner], axis=1), values, ROAD)


def _painted(points: Array, width: float, kind: int = WHITE) -> Patch:
    right, left = (_offset(points, t) + [0.0, 0.0, LIFT] for t in (-width / 2, width / 2))
    return _strip(right, left, level_light(), kind)


def _start_and_goal(route: Road) -> list[Patch]:
    if not route.has_way:
        return []
    assert route.profile is not None
    left, right = (float(t) for t in route.profile.lane(0.0))
    out = [_painted(route.at(np.full(2, 0.5), np.array([right + 0.25, left - 0.08])), LINE + 2 * INSET)]
    left, right = (float(t) for t in route.profile.lane(route.length))
    bounds = np.linspace(right + 0.25, left - 0.08, CHECKS + 1)
    for row in range(2):
        s = route.length - 0.25 - 0.5 * row
        for k in range(CHECKS):
            square = route.at(np.full(2, s), bounds[k : k + 2])
            out.append(_painted(square, 0.5, WHITE if (row + k) % 2 else BLACK))
    return out


def _flat(points: Array, kind: int) -> Patch:
    corners = np.arange(1, len(points) - 1)
    triangles = np.stack([np.zeros_like(corners), corners, corners + 1], axis=1)
    normal = np.cross(points[1] - points[0], points[2] - points[0])
    return _patch(points, daylight((normal / np.linalg.norm(normal))[None])[0], triangles, kind)


def _patch(points: Array, light: float, triangles: NDArray[np.int64], kind: int) -> Patch:
    values = attributes(0.0, 0.0, np.full(len(points), light))
    return Patch(points, values, triangles, np.full(len(triangles), kind, np.int64))


POLE, POLE_SIDES = 0.04, 6  # radius of a post in m, and number of its sides
FOOT = 0.5  # m by which a post reaches into the ground
LAYER = 0.012  # m between two colours of a sign
MIDDLE = {"stop": 2.45, "yield": 2.4, "priority": 2.35, "lights": 2.75}
"""Height in metres of the middle of each sign above the foot of its post."""
OCTAGON = np.pi / 8 + np.arange(8) * np.pi / 4
TRIANGLE = np.pi / 2 + np.arange(3) * 2 * np.pi / 3 + np.pi
DIAMOND = np.arange(4) * np.pi / 2
CIRCLE = np.arange(24) * np.pi / 12
BAR = 0.045  # m, width of the bars of letters
TALL, WIDE = 0.26, 0.13  # m, of a letter
LETTERS = {
    "S": ("top", "upper left", "middle", "lower right", "foot"),
    "T": ("top", "centre"),
    "O": ("top", "upper left", "lower left", "upper right", "lower right", "foot"),
    "P": ("top", "upper left", "lower left", "upper right", "middle"),
}
"""The bars of the letters of a stop sign, in the order of the word."""
APART = 0.18  # m, from the middle of a letter to that of the next
BOX, LENS = (0.42, 1.2, 0.25), 0.15  # m: width, height and depth of a traffic light; radius of a lens
LENS_APART, BOARD, FACE_RIM = 0.38, 0.09, 0.13  # m: lens to lens; board and its white rim, beyond the box


class SignFace(NamedTuple):
    """One flat polygon of a sign."""

    colour: SignColour
    points: Array
    """Corners ``(n, 3)`` in metres, counter-clockwise as seen from the visible side; the polygon is
    convex."""


def faces_of(sign: JunctionSign) -> Iterator[SignFace]:
    """Yields the faces of a sign and of its post. Of two overlapping faces, the rear one is yielded first."""
    top = MIDDLE[sign.control]
    yield from _tube(sign, POLE, -FOOT, top)
    if sign.control == "lights":
        yield from _lights(sign, top)
        return
    for layer, (colour, outline) in enumerate(_layers(sign)):
        ahead = POLE + LAYER * (min(layer, 2) + 1)
        if not layer:
            yield SignFace("grey", _placed(sign, outline[::-1], top, ahead))
        yield SignFace(colour, _placed(sign, outline, top, ahead))


def _layers(sign: JunctionSign) -> list[tuple[SignColour, Array]]:
    """Returns the colours of a sign's front, from back to front, each with its outline ``(n, 2)``."""
    if sign.control == "stop":
        letters: list[tuple[SignColour, Array]] = [("white", bar) for bar in _word()]
        return [("white", _polygon(OCTAGON, 0.48)), ("red", _polygon(OCTAGON, 0.44)), *letters]
    if sign.control == "yield":
        return [("red", _polygon(TRIANGLE, 0.52)), ("white", _polygon(TRIANGLE, 0.33))]
    return [("white", _polygon(DIAMOND, 0.45)), ("yellow", _polygon(DIAMOND, 0.33))]


def _word() -> Iterator[Array]:
    half, wide, tall = BAR / 2, WIDE / 2, TALL / 2
    up, across = tall - half, wide - half
    boxes = {  # left, right, lower and upper edge
        "top": (-wide, wide, up - half, tall),
        "middle": (-wide, wide, -half, half),
        "foot": (-wide, wide, -tall, half - up),
        "centre": (-half, half, -tall, tall),
        "upper left": (-wide, half - across, 0.0, tall),
        "lower left": (-wide, half - across, -tall, 0.0),
        "upper right": (across - half, wide, 0.0, tall),
        "lower right": (across - half, wide, -tall, 0.0),
    }
    for number, bars in enumerate(LETTERS.values()):
        for left, right, low, high in map(boxes.__getitem__, bars):
            corners = np.array([[left, low], [right, low], [right, high], [left, high]])
            yield corners + [(number - (len(LETTERS) - 1) / 2) * APART, 0.0]


def _polygon(angles: Array, radius: float) -> Array:
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def _placed(sign: JunctionSign, outline: Array, height: float, ahead: float) -> Array:
    """Returns a polygon that faces the traffic; x of the outline points to the right as drivers see it."""
    c, s = np.cos(sign.heading), np.sin(sign.heading)
    right, towards = np.array([s, -c, 0.0]), np.array([-c, -s, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    foot = np.array(sign.place)
    return np.asarray(foot + outline[:, :1] * right + (outline[:, 1:] + height) * up + ahead * towards)


def _tube(sign: JunctionSign, radius: float, low: float, high: float) -> Iterator[SignFace]:
    angles = np.arange(POLE_SIDES + 1) * 2 * np.pi / POLE_SIDES
    ring = np.column_stack([radius * np.cos(angles), radius * np.sin(angles), 0 * angles])
    for one, two in pairwise(np.array(sign.place) + ring):
        down, up = np.array([0, 0, low]), np.array([0, 0, high])
        yield SignFace("grey", np.array([one + down, two + down, two + up, one + up]))


def _lights(sign: JunctionSign, middle: float) -> Iterator[SignFace]:
    """Yields a box before a black board with a white rim, and three lenses, of which the green one is lit."""
    wide, high, deep = BOX
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    board, rim = (corners * [wide / 2 + more, high / 2 + more] for more in (BOARD, FACE_RIM))
    yield SignFace("grey", _placed(sign, rim[::-1], middle, POLE))
    yield SignFace("white", _placed(sign, rim, middle, POLE))
    yield SignFace("black", _placed(sign, board, middle, POLE + LAYER))
    back, front = (_placed(sign, corners * [wide / 2, high / 2], middle, ahead) for ahead in (POLE, deep))
    yield SignFace("black", front)
    for k in range(4):
        n = (k + 1) % 4
        yield SignFace("black", np.array([back[k], back[n], front[n], front[k]]))
    lens = _polygon(CIRCLE, LENS)
    colours: tuple[SignColour, ...] = ("green", "dim yellow", "dim red")
    for k, colour in enumerate(colours):
        yield SignFace(colour, _placed(sign, lens + [0.0, (k - 1) * LENS_APART], middle, deep + LAYER))
