"""Builds the meshes of the road: carriageway and shoulders as one surface, embankments, and posts."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise

import numpy as np
from scipy import ndimage

from roadgpt.export.edges import FOOT, Embankment, embankments, line, normals, stations
from roadgpt.geometry.curve import Array
from roadgpt.road import Profile, Road, World
from roadgpt.road.land import Land
from roadgpt.road.profile import LINE
from roadgpt.scene.light import CONCRETE, daylight, level_light
from roadgpt.scene.mesh import GRASS, POST, ROAD, Patch, attributes, grid, joined

CELLS = 8  # cells along a side of a patch
CHORD = 0.004  # m, greatest distance between a curve and its polyline
LONGEST = 4.0  # m between stations, so that light and texture follow crests
BLOCK = 24  # steps from station to station in a patch
THICK = 0.5  # m, thickness of a road that floats
POST_EVERY, POST_WIDE, POST_HIGH = 25.0, 0.14, 1.0
"""Distance between posts, width of a post, and height of a post, in metres. The distance is half of that on
straight German roads, to give a better impression of speed."""
LIFT = 0.006  # m by which lines and medians lie above the road
POST_FROM_RIM = 0.6  # m from the outer edge of the shoulder


@dataclass(frozen=True, eq=False)
class LitTerrain:
    """The terrain with its brightness in the light of sun and sky."""

    land: Land

    @cached_property
    def light(self) -> Array:
        """The brightness (rows, columns) of the terrain, computed from its slope."""
        land = self.land
        slope_y, slope_x = np.gradient(ndimage.gaussian_filter(land.heights, 1.0), land.y, land.x)
        normals = np.stack([-slope_x, -slope_y, np.ones_like(slope_x)], axis=-1)
        return daylight(normals / np.linalg.norm(normals, axis=-1, keepdims=True))

    def light_at(self, x: Array, y: Array) -> Array:
        """Returns the brightness of the terrain at points (x, y)."""
        return self.land.between(self.light, x, y)

    def patches(self) -> list[Patch]:
        """Returns the surface of the terrain as patches."""
        land = self.land
        x, y = np.meshgrid(land.x, land.y, indexing="ij")
        points, values = np.stack([x, y, land.heights.T], axis=-1), attributes(0.0, 0.0, self.light.T)
        rows, columns = land.heights.shape
        blocks = [
            (slice(i, i + CELLS + 1), slice(j, j + CELLS + 1))
            for j in range(0, rows - 1, CELLS)
            for i in range(0, columns - 1, CELLS)
        ]
        return [grid(points[block], values[block], GRASS) for block in blocks]


def road_patches(road: Road, world: World, terrain: LitTerrain) -> list[Patch]:
    """Returns the triangle patches of the road: its surface, and what is around it. A road with shoulders has
    embankments and posts; a road without shoulders has the slab of a floating road."""
    profile = world.profile_of(road)
    s = stations_between(road, profile.reach)
    if not profile.has_shoulders:
        return [*surface(road, profile, s), *median(road, profile, s), *slab(road, profile, s)]
    banks = embankments(road, profile, s, terrain.land)
    slopes = [patch for bank in banks for patch in slope(bank, terrain)]
    return [*surface(road, profile, s), *median(road, profile, s), *slopes, *posts(road, profile)]


def stations_between(road: Road, rim: float) -> Array:
    """Returns the stations ``(n,)`` in metres at which lines along the road need points.

    The stations are at most ``LONGEST`` apart. Take a curve at most ``rim`` metres beside the centre
    line: a polyline with points at these stations deviates from the curve by at most about ``CHORD``."""
    s = stations(road, rim, CHORD)
    parts = np.maximum(1, np.ceil(np.diff(s) / LONGEST)).astype(int)
    steps = np.repeat(np.diff(s) / parts, parts)
    return np.asarray(np.minimum(np.r_[0.0, np.cumsum(steps)], road.length))


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
    if not profile.median:
        return []
    left, right = profile.sides(s)
    rows = np.stack([line(road, s, t) for t in (right + LINE / 2, left - LINE / 2)], axis=1)
    light = np.repeat(daylight(_upwards(road, s))[:, None], 2, axis=1)
    return _blocks(rows + [0.0, 0.0, LIFT], attributes(0.0, 0.0, light), GRASS)


def _upwards(road: Road, s: Array) -> Array:
    if road.profile is not None and road.profile.superelevation_angle is not None:
        along, left = np.gradient(road.at(s), axis=0), road.at(s, 1.0) - road.at(s)
        banked = np.cross(along, left)
        return np.asarray(banked / np.linalg.norm(banked, axis=-1, keepdims=True))
    return normals(road, s)


def slope(bank: Embankment, terrain: LitTerrain) -> list[Patch]:
    """Returns an embankment. Where the embankment is low, its foot is as bright as the land there, so that no
    edge is visible."""
    edge, foot, is_left = bank
    rows = np.stack([edge, foot] if is_left else [foot, edge], axis=1)
    along = np.gradient(edge, axis=0)
    down = foot - edge
    outward = np.cross(along, down) if is_left else np.cross(down, along)
    outward /= np.maximum(np.linalg.norm(outward, axis=-1, keepdims=True), 1e-9)
    own, met = daylight(outward), terrain.light_at(foot[:, 0], foot[:, 1])
    at_foot = met + (own - met) * np.clip((edge[:, 2] - foot[:, 2] - FOOT - 1.5) / 4.0, 0.0, 1.0)
    light = np.stack([np.full_like(own, level_light()), at_foot], axis=1)
    return _blocks(rows, attributes(0.0, 0.0, light if is_left else light[:, ::-1]), GRASS)


def slab(road: Road, profile: Profile, s: Array) -> list[Patch]:
    """Returns the sides, the underside and the ends of a floating road."""
    left, right = (line(road, s, t) for t in profile.edges(s))
    down = np.array([0.0, 0.0, -THICK])
    out = []
    for a, b, light in (
        (left, left + down, 0.62),
        (right + down, right, 0.62),
        (left + down, right + down, 0.4),
    ):
        out += _blocks(np.stack([a, b], axis=1), attributes(0.0, 0.0, np.full((len(s), 2), light)), CONCRETE)
    for at, turn in ((0, True), (-1, False)):
        corners = np.array([[left[at], left[at] + down], [right[at], right[at] + down]])
        net = corners[::-1] if turn else corners
        out.append(grid(net, attributes(0.0, 0.0, np.full((2, 2), 0.62)), CONCRETE))
    return out


def posts(road: Road, profile: Profile, is_free: Callable[[Array], bool] = lambda place: True) -> list[Patch]:
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
