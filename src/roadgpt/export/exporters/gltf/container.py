"""Writes meshes as a binary glTF file: one buffer with all numbers, and JSON that describes its contents.

Textures are noise. They tile without a seam, and are the same for every road.
"""

import io
import json
import struct
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from PIL import Image

from roadgpt.geometry.curve import Array

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
    "paint": ((0.85, 0.85, 0.85, 1.0), 0.6),
    "path": ((0.0, 0.30, 0.75, 1.0), 0.7),
}
"""Base colour (linear red, green, blue, opacity) and roughness of each material, 0 to 1."""


class Grain(NamedTuple):
    """A texture that varies the brightness of a surface."""

    metres: float
    """Side length in metres of the square area that the texture covers."""
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
    points: Array
    """Points of shape (n, 3) in metres."""
    normals: Array
    """Unit normals of shape (n, 3)."""
    texture: Array
    """Texture coordinates of shape (n, 2) in metres, across and along the surface.

    The texture of the material is repeated in both directions.
    """
    triangles: np.ndarray
    """Indices of points, of shape (m, 3), counter-clockwise seen from outside."""


def to_bytes(meshes: Sequence[TriangleMesh], near: Array) -> bytes:
    """Returns the bytes of a binary glTF file with the given meshes.

    Args:
        meshes: The meshes of the scene; each becomes a separate node of the file.
        near: A point of the scene, (x, y, z) in metres. Coordinates are stored relative to it, because single
            precision is too coarse far from the origin.
    """
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
    """Returns the JSON of the scene, before any mesh is put into the buffer."""
    grained = [name for name in materials if name in GRAINS]
    return {
        "asset": {"version": "2.0", "generator": "RoadGPT"},
        "scene": 0,
        "scenes": [{"name": "road", "nodes": [0]}],
        "nodes": [
            {
                "name": "map",
                "translation": (Y_UP @ origin + 0.0).tolist(),
                "children": list(range(1, len(meshes) + 1)),
            },
            *({"name": mesh.name, "mesh": i} for i, mesh in enumerate(meshes)),
        ],
        "materials": [_material(name, grained) for name in materials],
        "textures": [{"source": i, "sampler": 0} for i in range(len(grained))],
        "samplers": [REPEATED] if grained else [],
        "images": [],
        "meshes": [],
        "accessors": [],
        "bufferViews": [],
        "buffers": [],
    }


def _image(data: dict[str, Any], content: bytearray, material: str) -> dict[str, Any]:
    """Appends a picture to the buffer, padded to a multiple of 4 bytes."""
    packed = _picture(material)
    view = {"buffer": 0, "byteOffset": len(content), "byteLength": len(packed)}
    data["bufferViews"].append(view)
    content += packed + b"\0" * (-len(packed) % 4)
    return {"bufferView": len(data["bufferViews"]) - 1, "mimeType": "image/png", "name": material}


def _put(data: dict[str, Any], content: bytearray, values: np.ndarray, bounded: bool = False) -> int:
    """Appends an array to the buffer and returns the index of its accessor.

    All arrays are multiples of 4 bytes.
    """
    is_index = values.ndim == 1
    packed = np.ascontiguousarray(values, dtype="<u4" if is_index else "<f4")
    view = {"buffer": 0, "byteOffset": len(content), "byteLength": packed.nbytes}
    data["bufferViews"].append({**view, "target": INDICES if is_index else VERTICES})
    content += packed.tobytes()
    accessor: dict[str, Any] = {
        "bufferView": len(data["bufferViews"]) - 1,
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
    """Returns the texture of a material as a grey PNG file."""
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
