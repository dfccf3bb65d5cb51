r"""Creates the meshes of a road: closed slabs, thin strips on top of them, and the surrounding ground.

shoulder ______|____________:____________|______ shoulder   the slabs of road and shoulders touch;
        |______|_________________________|______|           lines and path lie a little above them
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from roadgpt.export.edges import line, normals, stations
from roadgpt.export.ego import goal_of, on_the_ground, start_of
from roadgpt.export.embankments import Embankment, embankments
from roadgpt.export.exporters.gltf.container import TriangleMesh
from roadgpt.export.painted_lines import named_lines
from roadgpt.export.poses import Poses
from roadgpt.geometry.curve import Array
from roadgpt.road import Profile, Road, World
from roadgpt.road.land import FAR, Land
from roadgpt.road.profile import DASH, GAP

THICKNESS = 0.5  # m, thickness of the slabs
PAINT = 0.005  # m by which markings lie above the road; less would flicker at a coarse depth resolution
PATH = 0.02  # m by which the path lies above the road
PATH_WIDTH = 0.3  # m
NAMES = {"left": "left edge line", "right": "right edge line", "middle": "middle line"}
UP = np.array([0.0, 0.0, 1.0])

_Band = tuple[Array, Array, Array, np.ndarray]
"""Points, normals, texture coordinates and triangles, as in TriangleMesh."""


def meshes(road: Road, world: World, poses: Poses | None = None) -> list[TriangleMesh]:
    """Returns the meshes of a road: slabs, lines, the path and, if the road has shoulders, the ground.

    The path is the drive ``poses``, or the middle of the driven lane if ``poses`` is None.

    Raises:
        ExportError: The road has a number that is not finite.
    """
    profile = world.profile_of(road)
    s = stations(road, profile.reach)
    edges, rims = profile.edges(s), profile.rims(s)
    out = [_slab("road", "asphalt", road, s, *edges)]
    if (rims.left > edges.left).any():
        out.append(_slab("left verge", "gravel", road, s, rims.left, edges.left))
    if (rims.right < edges.right).any():
        out.append(_slab("right verge", "gravel", road, s, edges.right, rims.right))
    for number, painted in enumerate(named_lines(profile, s)):
        name = NAMES.get(painted.place) or f"lane line {number}"
        if painted.is_broken:
            out.append(_dashed(name, road, profile, s, painted.number))
        else:
            out.append(_strip(name, "paint", road, s, *painted.edges))
    out.append(_path(road, s, world, poses))
    if profile.has_shoulders:  # without a shoulder, the road floats
        out.append(_ground(road, world, s))
    return out


def _ground(road: Road, world: World, s: Array) -> TriangleMesh:
    """Returns the land around the road, and the embankments from the edges and ends of the road down to the
    land."""
    land = Land.around(road, world)
    near = slice(len(FAR), -len(FAR))  # the outer rows and columns are only for the horizon
    x, y = np.meshgrid(land.x[near], land.y[near])
    slope_y, slope_x = np.gradient(land.heights[near, near], land.y[near], land.x[near])
    up = np.stack([-slope_x, -slope_y, np.ones_like(slope_x)], axis=-1).reshape(-1, 3)
    points = np.stack([x, y, land.heights[near, near]], axis=-1).reshape(-1, 3)
    rows, columns = x.shape
    at = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).reshape(-1)
    low = np.stack([at, at + 1, at + columns + 1], axis=-1)
    high = np.stack([at, at + columns + 1, at + columns], axis=-1)
    normals = up / np.linalg.norm(up, axis=-1, keepdims=True)
    level: _Band = points, normals, points[:, :2], np.concatenate([low, high])
    banks = embankments(road, world.profile_of(road), s, land)
    return _joined("ground", "grass", [level, *map(_sloped, banks)])


def _sloped(bank: Embankment) -> _Band:
    """Returns the surface of an embankment, with its front faces outwards."""
    left, right = (bank.foot, bank.edge) if bank.is_left else (bank.edge, bank.foot)
    along = np.gradient(bank.edge, axis=0)
    facing = np.cross(along, left - right)
    normals = facing / np.maximum(np.linalg.norm(facing, axis=-1, keepdims=True), 1e-9)
    points, both, _, triangles = _band(left, right, normals, np.zeros(len(left)), (0.0, 0.0))
    return points, both, points[:, :2], triangles


def _dashed(name: str, road: Road, profile: Profile, s: Array, index: int) -> TriangleMesh:
    """Returns a broken line, given by its index in ``Profile.markings``. Its last dash may be shorter."""
    starts = np.arange(0.0, road.length, DASH + GAP).tolist()
    ends = [min(start + DASH, road.length) for start in starts]
    parts = [
        np.r_[start, s[(s > start) & (s < end)], end]
        for start, end in zip(starts, ends, strict=True)
        if end > start
    ]
    along = np.concatenate(parts)  # evaluates the road only once
    edges = profile.markings(along)[index].edges
    whole = _strip("", "paint", road, along, *edges)
    n = len(whole.points) // 2
    cuts = np.cumsum([len(part) for part in parts])[:-1]
    columns = whole.points[:n], whole.points[n:], whole.normals[:n], along, *edges
    dashes = [
        _band(left, right, up, at, (t, u))
        for left, right, up, at, t, u in zip(*(np.split(each, cuts) for each in columns), strict=True)
    ]
    return _joined(name, "paint", dashes)


def _path(road: Road, s: Array, world: World, poses: Poses | None) -> TriangleMesh:
    if poses is None:
        start, end = start_of(road), goal_of(road)
        part = np.r_[start, s[(s > start) & (s < end)], end]
        middle = world.profile_of(road).middle(part)
        half = np.minimum(PATH_WIDTH, world.profile_of(road).width(part) / 2) / 2
        return _strip("path", "path", road, part, middle + half, middle - half, PATH)
    moved = np.r_[
        True, np.hypot(np.diff(poses.x), np.diff(poses.y)) > 1e-6
    ]  # keeps a single point where the car stands
    ground = on_the_ground(poses, 0.0)[moved] + PATH * UP
    heading = poses.heading[moved]
    if len(ground) < 2:
        ground, heading = np.repeat(ground, 2, axis=0), np.repeat(heading, 2)
        ground[1, :2] += PATH_WIDTH * np.array([np.cos(heading[0]), np.sin(heading[0])])
    left = PATH_WIDTH / 2 * _left(heading)
    along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(ground[:, :2], axis=0).T))]
    normals = np.repeat(UP[None], len(ground), axis=0)
    across = (PATH_WIDTH / 2, -PATH_WIDTH / 2)
    return TriangleMesh("path", "path", *_band(ground + left, ground - left, normals, along, across))


def _strip(
    name: str, material: str, road: Road, s: Array, left: ArrayLike, right: ArrayLike, lift: float = PAINT
) -> TriangleMesh:
    """Returns the surface between two offsets, ``lift`` metres above the road, with its front faces up."""
    a, b = line(road, s, left) + lift * UP, line(road, s, right) + lift * UP
    return TriangleMesh(name, material, *_band(a, b, normals(road, s), s, (left, right)))


def _slab(name: str, material: str, road: Road, s: Array, left: Array, right: Array) -> TriangleMesh:
    """Returns the closed slab between two offsets, with its underside, flanks and ends."""
    a, b = line(road, s, left), line(road, s, right)
    low_a, low_b = a - THICKNESS * UP, b - THICKNESS * UP
    up, aside = normals(road, s), _left(road.heading(s))
    deep = (0.0, -THICKNESS)
    sides = [
        _band(a, b, up, s, (left, right)),
        _band(low_b, low_a, -up, s, (right, left)),
        _band(low_a, a, aside, s, deep[::-1]),
        _band(b, low_b, -aside, s, deep),
        _end(low_a[0], low_b[0], b[0], a[0], np.array([left[0], right[0]])),
        _end(low_b[-1], low_a[-1], a[-1], b[-1], np.array([right[-1], left[-1]])),
    ]
    return _joined(name, material, sides)


def _band(
    left: Array, right: Array, normals: Array, along: Array, across: tuple[ArrayLike, ArrayLike]
) -> _Band:
    """Returns the band between a left and a right edge."""
    n = len(left)
    i = np.arange(n - 1)
    first = np.stack([n + i, n + i + 1, i + 1], axis=-1)
    second = np.stack([n + i, i + 1, i], axis=-1)
    sideways = np.concatenate([np.broadcast_to(each, n) for each in across])
    texture = np.column_stack([sideways, np.tile(along, 2)])
    triangles = np.stack([first, second], axis=1).reshape(-1, 3)
    return np.concatenate([left, right]), np.tile(normals, (2, 1)), texture, triangles


def _end(a: Array, b: Array, c: Array, d: Array, across: Array) -> _Band:
    """Returns a quad of four corners, counter-clockwise seen from outside; a, b below and c, d above."""
    points = np.array([a, b, c, d])
    facing = np.cross(b - a, d - a)
    texture = np.column_stack([across[[0, 1, 1, 0]], [-THICKNESS, -THICKNESS, 0.0, 0.0]])
    normals = np.repeat((facing / np.linalg.norm(facing))[None], 4, axis=0)
    return points, normals, texture, np.array([[0, 1, 2], [0, 2, 3]])


def _joined(name: str, material: str, bands: Sequence[_Band]) -> TriangleMesh:
    """Returns one mesh of several bands."""
    shifts = np.cumsum([0, *(len(points) for points, *_ in bands)])
    triangles = [band[3] + shift for band, shift in zip(bands, shifts, strict=False)]
    points, normals, texture = (np.concatenate([band[k] for band in bands]) for k in range(3))
    return TriangleMesh(name, material, points, normals, texture, np.concatenate(triangles))


def _left(heading: Array) -> Array:
    return np.stack([-np.sin(heading), np.cos(heading), np.zeros_like(heading)], axis=-1)
