"""Exports roads as BeamNG levels: mesh road, decal roads, materials, start of the car and a scenario.

    NAME-beamng/levels/LEVEL/info.json
                             main.materials.json
                             main/items.level.json, main/MissionGroup/...
                             scenarios/drive/drive.json, drive.prefab.json

To use a level, copy ``NAME-beamng`` to ``mods/unpacked`` in BeamNG's user folder, or copy the contents of
``NAME-beamng/levels`` to ``levels`` in that folder.
"""

import json
import re
from pathlib import Path

from roadgpt.export.exporters.beamng import files
from roadgpt.export.exporters.beamng.roads import level_road
from roadgpt.export.poses import Poses
from roadgpt.road import Road, World

MODEL = "etk800"  # RoadGPT's and the competition's car
SEED = 0  # of the offsets against flicker


class BeamNG:
    """BeamNG level folder: mesh road, drivable decal road, markings, materials, start, goal and scenario."""

    name = "beamng"
    suffix = "-beamng"

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the level folder. ``poses`` is ignored, because a level cannot hold a drive."""
        title = path.name.removesuffix(self.suffix)
        write_level(road, path / "levels", level_name(title), world, title)


def level_name(title: str) -> str:
    """Returns a name that BeamNG accepts for a level: lower-case letters, digits and underscores."""
    plain = re.sub(r"[^a-z0-9]+", "_", title.lower()).strip("_")
    return f"roadgpt_{plain or 'road'}"


def write_level(road: Road, levels: Path, name: str, world: World, title: str = "") -> Path:
    """Writes a level into a folder of levels, and returns the level's own folder.

    Args:
        road: The road.
        levels: The folder of levels; the level becomes a sub-folder.
        name: Name of the level and of its folder, as returned by ``level_name``.
        world: The World, which defines lane width, shoulder width and friction.
        title: Title of the level in the game; empty to use ``name``.

    Raises:
        ExportError: The road has a number that is not finite.
        OSError: The folder cannot be written.
    """
    scene = level_road(road, world, SEED)
    title = title or name
    about, group = files.scenario(name, title)
    written = {
        "info.json": _json(files.info(name, title, world)),
        "main.materials.json": _json(files.materials(world)),
        "scenarios/drive/drive.json": _json([about]),
        "scenarios/drive/drive.prefab.json": files.one_per_line([files.car(name, scene, MODEL), *group]),
    }
    for folder, objects in files.items(name, scene, world).items():
        written[f"main/{folder}/items.level.json"] = files.one_per_line(objects)
    for place, text in written.items():
        target = levels / name / place
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8", newline="\n")
    return levels / name


def _json(value: object) -> str:
    return json.dumps(value, indent=1) + "\n"
