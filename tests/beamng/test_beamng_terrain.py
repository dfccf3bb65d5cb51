"""The land of a level: a .ter file as its format is described, with the heights of the ground."""

import json
import struct
from pathlib import Path

import numpy as np
import pytest

from roadgpt.export import save
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.network.landscape import ground_around
from roadgpt.road import Road, World

ROAD = Road(
    PieceCurve(60.0, 60.0, 0.3, (Piece(60.0), Piece(50.0, 1 / 60, 1 / 60))),
    GradeProfile(4.0, (0.0, 110.0), (0.05, -0.02)),
)
WORLD = World().changed(ground="hilly:5")


def objects_in(folder: Path) -> list[dict[str, object]]:
    text = (folder / "main/MissionGroup/sky_and_ground/items.level.json").read_text(encoding="utf-8")
    return [json.loads(line) for line in text.splitlines()]


def level_of(folder: Path, world: World) -> Path:
    save(ROAD, folder, ["beamng"], world)
    (level,) = (folder / "road-beamng/levels").iterdir()
    return level


def test_the_terrain_has_the_heights_of_the_ground_and_lies_just_below_the_road(tmp_path: Path) -> None:
    level = level_of(tmp_path, WORLD)
    (block,) = [each for each in objects_in(level) if each["class"] == "TerrainBlock"]
    assert block["terrainFile"] == f"/levels/{level.name}/terrain.ter"
    data = (level / "terrain.ter").read_bytes()
    version, size = struct.unpack_from("<BI", data)
    assert version == 9
    assert size >= 256
    assert size & (size - 1) == 0
    levels = np.frombuffer(data, "<u2", size * size, 5).reshape(size, size)
    layers = np.frombuffer(data, "u1", size * size, 5 + 2 * size * size)
    assert not layers.any()
    count, length = struct.unpack_from("<IB", data, 5 + 3 * size * size)
    assert count == 1
    assert data[-length:].decode() == json.loads((level / "terrain.terrain.json").read_text())["materials"][0]
    x0, y0, z0 = block["position"]
    step = block["maxHeight"] / 65_535
    ground, rng = ground_around(ROAD, WORLD), np.random.default_rng(2)
    j, i = rng.integers(0, min(ground.heights.shape), (2, 400))
    x, y = x0 + block["squareSize"] * i, y0 + block["squareSize"] * j
    told, real = z0 + step * levels[j, i], ground.height(x, y)
    beside = np.isnan(ground.road(x, y))
    assert told[beside] == pytest.approx(real[beside], abs=step)
    s = np.arange(5.0, 105.0, 3.0)
    points = ROAD.at(s)
    i, j = (np.rint((points[:, k] - at) / block["squareSize"]).astype(int) for k, at in ((0, x0), (1, y0)))
    below = points[:, 2] - (z0 + step * levels[j, i])
    assert (below > 0.08).all()
    assert (below < 0.25).all()


def test_a_level_has_either_land_or_the_plane(tmp_path: Path) -> None:
    kinds = [{each["class"] for each in objects_in(level_of(tmp_path / str(n), world))}
             for n, world in enumerate((WORLD, World()))]  # fmt: skip
    assert ["TerrainBlock" in each for each in kinds] == [True, False]
    assert ["GroundPlane" in each for each in kinds] == [False, True]
