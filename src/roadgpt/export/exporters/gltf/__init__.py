"""Exports roads as binary glTF 2.0: solid meshes for renderers, game engines and mesh tools.

Source: Khronos Group, glTF 2.0 (ISO/IEC 12113:2022).
"""

from pathlib import Path

from roadgpt.export.exporters.gltf.container import to_bytes
from roadgpt.export.exporters.gltf.surfaces import meshes
from roadgpt.export.poses import Poses
from roadgpt.road import Road, World


class Gltf:
    """Binary glTF 2.0: road, shoulders, markings, textures, ground and the path of the car; y is up."""

    name = "gltf"
    suffix = ".glb"

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the scene.

        It shows the path of the drive, or the middle of the right lane if there is no drive.
        """
        path.write_bytes(to_bytes(meshes(road, world, poses), road.at(0.0)))
