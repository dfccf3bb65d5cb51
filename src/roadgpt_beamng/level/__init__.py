"""Exports roads as BeamNG levels: mesh road, decal roads, materials, start of the car and a scenario.

    NAME-beamng/levels/LEVEL/info.json
                             main.materials.json
                             main/items.level.json, main/MissionGroup/...
                             scenarios/drive/drive.json, drive.prefab.json
                             terrain.ter, terrain.terrain.json, where the World has land

To use a level, copy ``NAME-beamng`` to ``mods/unpacked`` in BeamNG's user folder, or copy the contents of
``NAME-beamng/levels`` to ``levels`` in that folder.

Source: BeamNG documentation, "Level format"; levels written by the SBFT competition's code and by BeamNGpy.
No tool other than the game can check such files; ``roadgpt doctor beamng`` loads a level in the game.
"""

import json
import re
import tomllib
import uuid
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.export.ego import Poses
from roadgpt.geometry.curve import Array
from roadgpt.reading import read_text
from roadgpt.road import Road, World
from roadgpt.road.profile import DASH, GAP
from roadgpt_beamng.level.roads import GOAL, OWN, LevelRoad, Strip, level_road
from roadgpt_beamng.level.terrain import write_terrain

Item = dict[str, Any]
CONSTANTS: dict[str, Item] = tomllib.loads(read_text(Path(__file__).with_name("constants.toml")))
# Arbitrary but fixed, so that ids are always the same.
NAMESPACE = uuid.UUID("6f1d2c0e-5b0a-5c39-9d3e-0f3a52b1c7aa")
ABOVE_GROUND = 0.5  # m above the road at which a car is put down
# Least friction coefficient for each ground model of BeamNG, in descending order.
GROUNDS = ((0.8, "ASPHALT"), (0.45, "ASPHALT_WET"), (0.25, "SNOW"), (0.0, "ICE"))
DECIMALS = 4
MODEL = "etk800"  # RoadGPT's and the competition's car
SEED = 0  # of the offsets against flicker


class BeamNG:
    """BeamNG level folder: mesh road, drivable decal road, markings, materials, start, goal and scenario."""

    name = "beamng"
    suffix = "-beamng"

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the level folder. ``poses`` is ignored, because a level cannot hold a drive."""
        title = path.name.removesuffix(self.suffix)
        name = level_name(title)
        write_level(road, path / "levels", name, world, title)
        if world.has_ground:
            folder = path / "levels" / name
            block = write_terrain(road, world, folder, name)
            item = _object(name, "theTerrain", "TerrainBlock", "sky_and_ground", **block)
            objects = folder / "main/MissionGroup/sky_and_ground/items.level.json"
            lines = [line for line in objects.read_text("utf-8").splitlines() if '"GroundPlane"' not in line]
            objects.write_text("\n".join([*lines, json.dumps(item)]) + "\n", "utf-8", newline="\n")


def level_name(title: str) -> str:
    """Returns a name that BeamNG accepts for a level: lower-case letters, digits and underscores."""
    plain = re.sub(r"[^a-z0-9]+", "_", title.lower()).strip("_")
    return f"roadgpt_{plain or 'road'}"


def write_level(road: Road, levels: Path, name: str, world: World, title: str = "") -> Path:
    """Writes a level into a folder of levels, and returns the level's own folder. ``name`` is one that
    ``level_name`` returned; ``title`` is the title in the game, or empty to use ``name``."""
    scene = level_road(road, world, SEED)
    title = title or name
    drive = "scenarios/drive/drive.prefab.json"
    about = {"name": title, "lapConfig": [GOAL], "prefabs": [f"levels/{name}/{drive}"]}
    written = {
        "info.json": _json(_info(name, title, world)),
        "main.materials.json": _json(_materials(world)),
        "scenarios/drive/drive.json": _json([CONSTANTS["drive"] | about]),
        drive: _one_per_line(
            [
                _object(name, "ego", "BeamNGVehicle", "drive_group", **_start(scene), jBeam=MODEL),
                _object(name, "drive_group", "SimGroup", ""),
            ]
        ),
    }
    for folder, objects in items(name, scene, world).items():
        written[f"main/{folder}/items.level.json"] = _one_per_line(objects)
    for place, text in written.items():
        target = levels / name / place
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8", newline="\n")
    return levels / name


def ground_model(friction: float) -> str:
    """Returns the name of BeamNG's ground model for a friction coefficient."""
    return next(name for least, name in GROUNDS if friction >= least)


def items(name: str, scene: LevelRoad, world: World) -> Mapping[str, Sequence[Item]]:
    """Returns the objects in each ``items.level.json`` file of a level. The keys are the folders of these
    files, relative to ``main``."""
    groups = ("sky_and_ground", "roads", "player")
    return {
        "": [_object(name, "MissionGroup", "SimGroup", "", enabled="1")],
        "MissionGroup": [_object(name, group, "SimGroup", "MissionGroup") for group in groups],
        "MissionGroup/sky_and_ground": _surroundings(name, world, scene.ground),
        "MissionGroup/roads": [
            _strip(name, part)
            for strip in scene.strips
            for part in (_dashes(strip) if strip.is_dashed else (strip,))
        ],
        "MissionGroup/player": _player(name, scene),
    }


def _object(level: str, name: str, kind: str, parent: str, **fields: Any) -> Item:
    given = {"name": name, "class": kind, "persistentId": str(uuid.uuid5(NAMESPACE, f"{level}/{name}"))}
    return {**given, **({"__parent": parent} if parent else {}), **CONSTANTS.get(kind, {}), **fields}


def _surroundings(level: str, world: World, height: float) -> list[Item]:
    group = "sky_and_ground"
    half = world.site.map_size / 2
    ground = [half, half, round(height, DECIMALS)]
    return [
        _object(level, "level_info", "LevelInfo", group),
        _object(level, "tod", "TimeOfDay", group),
        _object(level, "sky", "ScatterSky", group),
        _object(level, "ground", "GroundPlane", group, position=ground),
    ]


def _dashes(strip: Strip) -> list[Strip]:
    """Returns one decal for each dash of a broken line, with a node at both ends and one in the middle."""
    nodes = strip.nodes
    along = np.r_[0.0, np.cumsum(np.linalg.norm(np.diff(nodes[:, :3], axis=0), axis=1))]

    def at(stations: Array) -> Array:
        return np.column_stack([np.interp(stations, along, column) for column in nodes.T])

    out = []
    for number, start in enumerate(np.arange(0.0, along[-1], DASH + GAP), 1):
        end = min(start + DASH, float(along[-1]))
        if end - start > DASH / 4:  # a shorter dash has no room for a node between its ends
            out.append(
                replace(strip, name=f"{strip.name}_{number:03d}", nodes=at(np.linspace(start, end, 3)))
            )
    return out


def _strip(level: str, strip: Strip) -> Item:
    nodes = _rows(strip.nodes)
    kind, fields = "DecalRoad", Item(position=nodes[0][:3])
    if strip.is_mesh:
        upwards = None if strip.normals is None else _rows(strip.normals)
        nodes = [[*node, *(upwards[i] if upwards else (0, 0, 1))] for i, node in enumerate(nodes)]
        kind = "MeshRoad"
        fields |= dict.fromkeys(("topMaterial", "bottomMaterial", "sideMaterial"), strip.material)
    else:
        fields |= {"material": strip.material, "drivability": strip.drivability}
        fields |= {"renderPriority": strip.priority, **({"oneWay": True} if strip.is_one_way else {})}
    return _object(level, strip.name, kind, "roads", **fields, nodes=nodes)


def _player(level: str, scene: LevelRoad) -> list[Item]:
    start = _start(scene)
    goal = scene.goal.round(DECIMALS).tolist()
    return [
        _object(level, "spawn", "SpawnSphere", "player", **start),
        _object(level, GOAL, "BeamNGWaypoint", "player", position=goal),
    ]


def _start(scene: LevelRoad) -> Item:
    return {
        "position": (scene.start + [0, 0, ABOVE_GROUND]).round(DECIMALS).tolist(),
        "rotationMatrix": rotation(scene.heading, scene.grade).ravel().round(9).tolist(),
    }


def rotation(heading: float, grade: float) -> Array:
    """Returns the rotation matrix (3, 3) of a car with this heading (in radians) and grade (a ratio).

    The rows of the matrix point left, backwards and upwards from the car, because BeamNG's cars face -y if
    they are not rotated. Level files contain the rows one after another.
    """
    size = np.hypot(1.0, grade)
    ahead = np.array([np.cos(heading), np.sin(heading), grade]) / size
    left = np.array([-np.sin(heading), np.cos(heading), 0.0])
    return np.array([left, -ahead, np.cross(ahead, left)])


def _materials(world: World) -> Item:
    """Returns the content of ``main.materials.json``."""
    ground = ground_model(world.site.friction)
    wanted = (
        (OWN.road, (0.16, 0.16, 0.17), ground),
        (OWN.surface, (0.16, 0.16, 0.17), ground),
        (OWN.verge, (0.24, 0.29, 0.15), "GRASS"),
        ("roadgpt_grass", (0.15, 0.30, 0.10), "GRASS"),
        (OWN.edge, (0.90, 0.90, 0.88), ground),
        (OWN.middle, (0.85, 0.65, 0.10), ground),
    )
    return {name: _material(name, colour, model) for name, colour, model in wanted}


def _material(name: str, colour: tuple[float, float, float], model: str) -> Item:
    stage = {"baseColorFactor": [*colour, 1], "roughnessFactor": 0.9, "metallicFactor": 0}
    is_decal = name in (OWN.surface, OWN.edge, OWN.middle)
    return {
        "name": name,
        "mapTo": name,
        "class": "Material",
        "persistentId": str(uuid.uuid5(NAMESPACE, f"material/{name}")),
        "Stages": [stage, {}, {}, {}],
        "groundType": model,
        "translucent": is_decal,
        "translucentZWrite": is_decal,
        **CONSTANTS["Material"],
    }


def _info(name: str, title: str, world: World) -> Item:
    side = int(np.ceil(world.site.map_size))
    spawn = {"objectname": "spawn", "translationId": title, "previews": []}
    own = {"title": title, "size": [side, side], "spawnPoints": [spawn], "levelName": name}
    return CONSTANTS["info"] | own


def _one_per_line(objects: Sequence[Item]) -> str:
    return "".join(json.dumps(each) + "\n" for each in objects)


def _rows(nodes: Array) -> list[list[float]]:
    rows: list[list[float]] = (np.round(nodes, DECIMALS) + 0.0).tolist()
    return rows


def _json(value: object) -> str:
    return json.dumps(value, indent=1) + "\n"
