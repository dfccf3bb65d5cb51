"""Exports roads as binary glTF 2.0: solid meshes for renderers, game engines and mesh tools.

shoulder ______|____________:____________|______ shoulder   the slabs of road and shoulders touch;
        |______|_________________________|______|           lines and path lie a little above them

The file has one buffer with all numbers, and JSON that describes its contents. Textures are noise: they tile
without a seam, and are the same for every road. Source: Khronos Group, glTF 2.0 (ISO/IEC 12113:2022)."""

import io
import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from PIL import Image
from shapely.geometry.polygon import orient

from roadgpt.export.ego import Poses, goal_of
from roadgpt.geometry.curve import Array
from roadgpt.ground.mesh import GroundMesh, mesh_of, water_of
from roadgpt.network import Network, NetworkRoad, network_of, only_road
from roadgpt.network.landscape import ground_around
from roadgpt.network.markings import arrows, strokes
from roadgpt.network.paved import Area, polygons_in
from roadgpt.network.structures import solids
from roadgpt.network.surface import JunctionSurface, NetworkSurface, stations_of, triangulated
from roadgpt.road import Profile, Road, World
from roadgpt.road.edges import line, named_lines, normals
from roadgpt.road.profile import DASH, GAP
from roadgpt_formats.ego import on_the_ground

THICKNESS = 0.5  # m, thickness of the slabs
PAINT = 0.005  # m by which markings lie above the road; less would flicker at a coarse depth resolution
KERB = 0.12  # m, height of a traffic island
PATH = 0.02  # m by which the path lies above the road
PATH_WIDTH = 0.3  # m
NAMES = {"left": "left edge line", "right": "right edge line", "middle": "middle line"}
UP = np.array([0.0, 0.0, 1.0])
FLOAT, UINT = 5126, 5125  # component types
VERTICES, INDICES = 34962, 34963  # targets of buffer views
# The picture repeats in both directions, and is filtered where it appears small.
REPEATED = {"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497}
Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])  # x stays, up is y, left is -z
SIDE = 256  # pixels of a texture
MATERIALS = {
    "asphalt": ((0.06, 0.06, 0.065, 1.0), 0.9),
    "gravel": ((0.23, 0.20, 0.15, 1.0), 1.0),
    "grass": ((0.21, 0.32, 0.13, 1.0), 1.0),
    "rock": ((0.24, 0.23, 0.21, 1.0), 1.0),
    "water": ((0.07, 0.15, 0.22, 1.0), 0.15),
    "concrete": ((0.35, 0.33, 0.31, 1.0), 0.9),
    "paint": ((0.85, 0.85, 0.85, 1.0), 0.6),
    "path": ((0.0, 0.30, 0.75, 1.0), 0.7),
}
"""Base colour (linear red, green, blue, opacity) and roughness of each material, 0 to 1."""


class Grain(NamedTuple):
    """A texture that varies the brightness of a surface."""

    metres: float  # side length in metres of the square area that the texture covers
    seed: int
    octaves: tuple[tuple[int, float], ...]
    """Layers of noise: for each, the number of noise cells along a side of the texture, and the amplitude
    relative to the mean brightness."""


GRAINS = {
    "asphalt": Grain(5.0, 11, ((128, 0.34), (256, 0.30), (8, 0.10))),
    "gravel": Grain(4.0, 17, ((64, 0.30), (256, 0.40))),
    "grass": Grain(37.0, 23, ((24, 0.10), (64, 0.16), (256, 0.22))),
}
"""Textures by material. Their sizes and amplitudes are also used by the HTML page that replays a drive."""


@dataclass(frozen=True, eq=False)
class TriangleMesh:
    """Triangles of one material, in coordinates with z up."""

    name: str
    material: str
    points: Array  # points of shape (n, 3) in metres
    normals: Array  # unit normals of shape (n, 3)
    texture: Array
    """Texture coordinates of shape (n, 2) in metres, across and along the surface.

    The texture of the material is repeated in both directions."""
    triangles: np.ndarray  # indices of points, of shape (m, 3), counter-clockwise seen from outside


_Band = tuple[Array, Array, Array, np.ndarray]
"""Points, normals, texture coordinates and triangles, as in TriangleMesh."""


class Gltf:
    """Binary glTF 2.0: road, shoulders, markings, textures, ground and the path of the car; y is up."""

    name = "gltf"
    suffix = ".glb"
    holds_junctions = True

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the scene.

        It shows the path of the drive, or the middle of the right lane if there is no drive."""
        path.write_bytes(to_bytes(meshes(road, world, poses), road.at(0.0)))

    def land(self, road: Road, world: World) -> bytes:
        """Returns a scene of the land around a road alone, for formats that do not hold it."""
        return to_bytes(land_meshes(road, world), road.at(0.0))


def meshes(road: Road, world: World, poses: Poses | None = None) -> list[TriangleMesh]:
    """Returns the meshes of a road or a network: slabs, lines, the path and, if the roads do not float, the
    ground with its water.

    The path is the drive ``poses``, or the middle of the driven lane if ``poses`` is None; there is none on a
    map without a route."""
    network = network_of(road, world)
    only = only_road(road, world)
    if only is not None:
        out = [*_slabs(only, ""), *_lines(only)]
    else:
        surface = NetworkSurface.of(network)
        out = [each for member in surface.roads for each in _slabs(member, f" {member.id}")]
        out += [each for number, area in enumerate(surface.areas) for each in _junction(area, number)]
        out += _painted(network)
    if road.has_way:
        out.append(_path(road, stations_of(only) if only else road.sample().s, world, poses))
    return out + land_meshes(road, world)


def land_meshes(road: Road, world: World) -> list[TriangleMesh]:
    """Returns the meshes of the ground around a road, its water, and bridges and tunnels; none if the road
    floats."""
    network, ground = network_of(road, world), ground_around(road, world)
    if not ground.pavement.rims:
        return []
    out = [_land("ground", "grass", mesh_of(ground, to_horizon=False))]
    built = zip(ground.pavement.spans, solids(network, ground), strict=True)
    out += [_solid(f"{span.kind} {n}", each) for n, (span, each) in enumerate(built)]
    if len((water := water_of(ground)).triangles):
        out.append(_land("water", "water", water))
    return out


def _slabs(member: NetworkRoad, number: str) -> list[TriangleMesh]:
    road, s = member.road, stations_of(member)
    edges, rims = member.profile.edges(s), member.profile.rims(s)
    out = [_slab(f"road{number}", "asphalt", road, s, *edges)]
    if (rims.left > edges.left).any():
        out.append(_slab(f"left verge{number}", "gravel", road, s, rims.left, edges.left))
    if (rims.right < edges.right).any():
        out.append(_slab(f"right verge{number}", "gravel", road, s, edges.right, rims.right))
    return out


def _lines(member: NetworkRoad) -> list[TriangleMesh]:
    road, profile, s, out = member.road, member.profile, stations_of(member), []
    for number, painted in enumerate(named_lines(profile, s)):
        name = NAMES.get(painted.place) or f"lane line {number}"
        if painted.is_broken:
            out.append(_dashed(name, road, profile, s, painted.number))
        else:
            out.append(_strip(name, "paint", road, s, *painted.edges))
    return out


def _junction(area: JunctionSurface, number: int) -> list[TriangleMesh]:
    found = [("junction", "asphalt", area.paved, 0.0), ("junction verge", "gravel", area.shoulder, 0.0)]
    found += [("island", "grass", part, 0.0) for part in area.green]
    found += [("kerbed island", "concrete", part, KERB) for part in area.kerbed]
    return [
        _block(f"{name} {number}", material, part, area.height, up)
        for name, material, part, up in found
        if not part.is_empty
    ]


def _block(name: str, material: str, area: Area, height: float, up: float) -> TriangleMesh:
    """Returns the closed block under a level area, ``up`` metres higher than its surface."""
    flat, corners = triangulated(area)
    bands: list[_Band] = []
    for z, facing, triangles in ((height + up, 1.0, corners), (height - THICKNESS, -1.0, corners[:, ::-1])):
        points = np.column_stack([flat, np.full(len(flat), z)])
        bands.append((points, np.tile(facing * UP, (len(flat), 1)), flat, triangles))
    for part in polygons_in(area):
        for ring in (orient(part).exterior, *orient(part).interiors):
            line_ = np.asarray(ring.coords, float)[:, :2]
            along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(line_, axis=0).T))]
            out = np.diff(line_, axis=0, append=line_[1:2])
            outward = np.column_stack([out[:, 1], -out[:, 0], np.zeros(len(out))])
            outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-9)
            high, low = (
                np.column_stack([line_, np.full(len(line_), z)]) for z in (height + up, height - THICKNESS)
            )
            bands.append(_band(high, low, outward, along, (0.0, -THICKNESS)))
    return _joined(name, material, bands)


def _painted(network: Network) -> list[TriangleMesh]:
    bands: list[_Band] = []
    for stroke in strokes(network):
        along = np.gradient(stroke.points[:, :2], axis=0)
        left = np.column_stack([-along[:, 1], along[:, 0], np.zeros(len(along))])
        left *= stroke.width / 2 / np.maximum(np.linalg.norm(left, axis=1, keepdims=True), 1e-9)
        s = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(stroke.points, axis=0), axis=1))]
        middle = stroke.points + PAINT * UP
        across = (stroke.width / 2, -stroke.width / 2)
        bands.append(_band(middle + left, middle - left, np.tile(UP, (len(s), 1)), s, across))
    for arrow in arrows(network):
        points = arrow.points + PAINT * UP
        bands.append((points, np.tile(UP, (len(points), 1)), points[:, :2], arrow.corners))
    return [_joined("lines", "paint", bands)] if bands else []


def _solid(name: str, triangles: Array) -> TriangleMesh:
    points = triangles.reshape(-1, 3)
    facing = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    facing = np.repeat(facing / np.maximum(np.linalg.norm(facing, axis=1, keepdims=True), 1e-9), 3, axis=0)
    return TriangleMesh(
        name, "concrete", points, facing, points[:, :2], np.arange(len(points)).reshape(-1, 3)
    )


def _land(name: str, material: str, mesh: GroundMesh) -> TriangleMesh:
    return TriangleMesh(name, material, mesh.points, mesh.normals, mesh.points[:, :2], mesh.triangles)


def _dashed(name: str, road: Road, profile: Profile, s: Array, index: int) -> TriangleMesh:
    """Returns a broken line, an ``index`` in ``Profile.markings``. Its last dash may be shorter."""
    starts = np.arange(0.0, road.length, DASH + GAP).tolist()
    ends = [min(start + DASH, road.length) for start in starts]
    parts = [
        np.r_[start, s[(s > start) & (s < end)], end]
        for start, end in zip(starts, ends, strict=True)
        if end > start
    ]
    along = np.concatenate(parts)  # evaluates the road only once
    _, edges = profile.markings(along)[index]
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
        start, end = world.start_on(road), goal_of(road)
        part = np.r_[start, s[(s > start) & (s < end)], end]
        middle = world.profile_of(road).middle(part)
        half = np.minimum(PATH_WIDTH, world.profile_of(road).width(part) / 2) / 2
        return _strip("path", "path", road, part, middle + half, middle - half, PATH)
    # keeps a single point where the car stands
    moved = np.r_[True, np.hypot(np.diff(poses.x), np.diff(poses.y)) > 1e-6]
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
    """Returns the surface between two offsets, ``lift`` metres above the road, front faces up."""
    a, b = line(road, s, left) + lift * UP, line(road, s, right) + lift * UP
    return TriangleMesh(name, material, *_band(a, b, normals(road, s), s, (left, right)))


def _slab(name: str, material: str, road: Road, s: Array, left: Array, right: Array) -> TriangleMesh:
    """Returns the closed slab between two offsets, with underside, flanks and ends."""
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
    n = len(left)
    i = np.arange(n - 1)
    first = np.stack([n + i, n + i + 1, i + 1], axis=-1)
    second = np.stack([n + i, i + 1, i], axis=-1)
    sideways = np.concatenate([np.broadcast_to(each, n) for each in across])
    texture = np.column_stack([sideways, np.tile(along, 2)])
    triangles = np.stack([first, second], axis=1).reshape(-1, 3)
    return np.concatenate([left, right]), np.tile(normals, (2, 1)), texture, triangles


def _end(a: Array, b: Array, c: Array, d: Array, across: Array) -> _Band:
    """Returns a quad, counter-clockwise seen from outside; a, b below and c, d above."""
    points = np.array([a, b, c, d])
    facing = np.cross(b - a, d - a)
    texture = np.column_stack([across[[0, 1, 1, 0]], [-THICKNESS, -THICKNESS, 0.0, 0.0]])
    normals = np.repeat((facing / np.linalg.norm(facing))[None], 4, axis=0)
    return points, normals, texture, np.array([[0, 1, 2], [0, 2, 3]])


def _joined(name: str, material: str, bands: Sequence[_Band]) -> TriangleMesh:
    shifts = np.cumsum([0, *(len(points) for points, *_ in bands)])
    triangles = [band[3] + shift for band, shift in zip(bands, shifts, strict=False)]
    points, normals, texture = (np.concatenate([band[k] for band in bands]) for k in range(3))
    return TriangleMesh(name, material, points, normals, texture, np.concatenate(triangles))


def _left(heading: Array) -> Array:
    return np.stack([-np.sin(heading), np.cos(heading), np.zeros_like(heading)], axis=-1)


def to_bytes(meshes: Sequence[TriangleMesh], near: Array) -> bytes:
    """Returns the bytes of a binary glTF file with the given meshes.

    Args:
        meshes: The meshes of the scene; each becomes a separate node of the file.
        near: A point of the scene, (x, y, z) in metres. Coordinates are stored relative to it, because single
            precision is too coarse far from the origin."""
    origin = np.round(near)
    used = list(dict.fromkeys(mesh.material for mesh in meshes))
    data = _scene(meshes, origin, used)
    content = bytearray()
    for mesh in meshes:
        tile = GRAINS[mesh.material].metres if mesh.material in GRAINS else 1.0
        where = {
            "POSITION": _put(data, content, (mesh.points - origin) @ Y_UP.T, bounded=True),
            "NORMAL": _put(data, content, mesh.normals @ Y_UP.T),
            "TEXCOORD_0": _put(data, content, mesh.texture / tile),
        }
        indices = _put(data, content, mesh.triangles.reshape(-1))
        primitive = {"attributes": where, "indices": indices, "material": used.index(mesh.material)}
        data["meshes"].append({"name": mesh.name, "primitives": [primitive]})
    for name in used:
        if name in GRAINS:
            data["images"].append(_image(data, content, name))
    data = {key: value for key, value in data.items() if value != []}
    data["buffers"] = [{"byteLength": len(content)}]
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(content), b"BIN\0")
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks) + len(content)) + chunks + bytes(content)


def _scene(meshes: Sequence[TriangleMesh], origin: Array, materials: Sequence[str]) -> dict[str, Any]:
    grained = [name for name in materials if name in GRAINS]
    children = list(range(1, len(meshes) + 1))
    whole = {"name": "map", "translation": (Y_UP @ origin + 0.0).tolist(), "children": children}
    return {
        "asset": {"version": "2.0", "generator": "RoadGPT"},
        "scene": 0,
        "scenes": [{"name": "road", "nodes": [0]}],
        "nodes": [whole, *({"name": mesh.name, "mesh": i} for i, mesh in enumerate(meshes))],
        "materials": [_material(name, grained) for name in materials],
        "textures": [{"source": i, "sampler": 0} for i in range(len(grained))],
        "samplers": [REPEATED] if grained else [],
        **{name: [] for name in ("images", "meshes", "accessors", "bufferViews", "buffers")},
    }


def _image(data: dict[str, Any], content: bytearray, material: str) -> dict[str, Any]:
    """Appends a picture to the buffer."""
    view = _view(data, content, _picture(material))
    return {"bufferView": view, "mimeType": "image/png", "name": material}


def _view(data: dict[str, Any], content: bytearray, packed: bytes, **more: int) -> int:
    """Appends bytes to the buffer, padded to a multiple of 4; returns the index of their view."""
    data["bufferViews"].append({"buffer": 0, "byteOffset": len(content), "byteLength": len(packed), **more})
    content += packed + b"\0" * (-len(packed) % 4)
    return len(data["bufferViews"]) - 1


def _put(data: dict[str, Any], content: bytearray, values: np.ndarray, bounded: bool = False) -> int:
    """Appends an array to the buffer and returns the index of its accessor."""
    is_index = values.ndim == 1
    packed = np.ascontiguousarray(values, dtype="<u4" if is_index else "<f4")
    accessor: dict[str, Any] = {
        "bufferView": _view(data, content, packed.tobytes(), target=INDICES if is_index else VERTICES),
        "componentType": UINT if is_index else FLOAT,
        "count": len(packed),
        "type": "SCALAR" if is_index else f"VEC{packed.shape[1]}",
    }
    if bounded:
        accessor |= {"min": packed.min(axis=0).tolist(), "max": packed.max(axis=0).tolist()}
    data["accessors"].append(accessor)
    return len(data["accessors"]) - 1


def _material(name: str, grained: Sequence[str]) -> dict[str, Any]:
    colour, roughness = MATERIALS[name]
    looks: dict[str, Any] = {
        "baseColorFactor": list(colour),
        "metallicFactor": 0,
        "roughnessFactor": roughness,
    }
    if name in grained:
        looks["baseColorTexture"] = {"index": grained.index(name)}
    return {"name": name, "pbrMetallicRoughness": looks}


@cache
def _picture(name: str) -> bytes:
    grain = GRAINS[name]
    levels = np.clip(np.round(225 * _noise(grain)), 0, 255).astype(np.uint8)
    data = io.BytesIO()
    Image.fromarray(levels).save(data, format="PNG", optimize=True)
    return data.getvalue()


def _noise(grain: Grain) -> Array:
    """Returns the brightness of each pixel, 1 on average, as an array of shape (SIDE, SIDE)."""
    rng = np.random.default_rng(grain.seed)
    out = np.ones((SIDE, SIDE))
    for cells, strength in grain.octaves:
        knots = rng.random((cells, cells)) - 0.5
        place = np.arange(SIDE) * cells / SIDE
        low = place.astype(int)
        share = place - low
        rows = knots[low] * (1 - share[:, None]) + knots[(low + 1) % cells] * share[:, None]
        out += strength * (rows[:, low] * (1 - share) + rows[:, (low + 1) % cells] * share)
    return out
