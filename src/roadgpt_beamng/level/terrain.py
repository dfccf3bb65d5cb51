"""Writes the land around a road as BeamNG's terrain: a .ter file, its .terrain.json, and what loads it.

    version 9 (1 byte), size (uint32), size x size heights (uint16), size x size layers (1 byte), number of
    materials (uint32), and each name after a byte with its length

All is little-endian, and rows go from south to north. Source: the format as the game's community describes
it; no tool other than the game can check such files."""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.network.landscape import ground_around
from roadgpt.road import Road, World

VERSION, FULL = 9, 65_535
SMALLEST = 256  # heights along a side; sides are powers of two
MATERIAL = "Grass"
HOLE, MOUTH = 255, 2.0  # the layer without land; m before and behind the mouth of a tunnel
BELOW = 0.15  # m by which the land lies below roads, whose meshes carry the wheels


def write_terrain(road: Road, world: World, folder: Path, level: str) -> dict[str, Any]:
    """Writes the terrain files into the folder of a level; returns the fields of its TerrainBlock."""
    ground = ground_around(road, world)
    x, y = (each.ravel() for each in np.meshgrid(ground.x, ground.y))
    is_road = ~np.isnan(ground.road(x, y)).reshape(ground.heights.shape)
    heights = ground.heights - BELOW * is_road
    size = max(SMALLEST, 1 << (max(heights.shape) - 1).bit_length())
    pad = [(0, size - n) for n in heights.shape]
    heights = np.pad(heights, pad, mode="edge")
    lowest, span = float(heights.min()), max(float(np.ptp(heights)), 1.0)
    levels = np.rint((heights - lowest) / span * FULL).astype("<u2")
    name = MATERIAL.encode()
    layers = np.zeros(levels.shape, "u1")
    for portal in ground.pavement.portals:  # the mouth of a tunnel is open
        off = np.stack([x, y], axis=-1) - (portal.left + portal.right)[:2] / 2
        half = np.hypot(*(portal.left - portal.right)[:2]) / 2
        is_before = (np.abs(off @ portal.ahead) < MOUTH) & (np.hypot(*off.T) < half + MOUTH)
        layers[: len(ground.y), : len(ground.x)][is_before.reshape(ground.heights.shape)] = HOLE
    data = struct.pack("<BI", VERSION, size) + levels.tobytes() + layers.tobytes()
    data += struct.pack("<IB", 1, len(name)) + name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "terrain.ter").write_bytes(data)
    about = {
        "version": VERSION, "size": size, "datafile": f"/levels/{level}/terrain.ter", "materials": [MATERIAL],
        "heightMapItemSize": 2, "heightMapSize": size * size, "layerMapItemSize": 1,
        "layerMapSize": size * size,
    }  # fmt: skip
    (folder / "terrain.terrain.json").write_text(json.dumps(about, indent=1) + "\n", encoding="utf-8")
    return {
        "position": [round(float(ground.x[0]), 4), round(float(ground.y[0]), 4), round(lowest, 4)],
        "terrainFile": f"/levels/{level}/terrain.ter",
        "squareSize": ground.cell,
        "maxHeight": round(span, 4),
        "baseTexSize": 1024,
    }
