"""Binary glTF 2.0: the road as solid meshes for renderers, game engines and mesh tools.

Source: Khronos Group, glTF 2.0 (ISO/IEC 12113:2022).
"""

from pathlib import Path

from roadgpt.export.exporters.gltf.container import to_bytes
from roadgpt.export.exporters.gltf.surfaces import meshes
from roadgpt.export.poses import Poses
from roadgpt.road import Road, World


class Gltf:
    """Binary glTF 2.0: road, shoulders, markings, textures, ground, the path of the car; y is up."""

    name = "gltf"
    suffix = ".glb"

    def save(self, road: Road, path: Path, world: World, poses: Poses | None = None) -> None:
        """Writes the scene. The path is that of the drive, or else the middle of the right lane."""
        path.write_bytes(to_bytes(meshes(road, world, poses), road.at(0.0)))
