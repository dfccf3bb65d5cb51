"""Renders camera images of roads with a software rasteriser. Main method: ``Scene.render``.

It needs no display and no graphics driver: compiled code draws triangles, and the same pose gives the same
bytes. The scene of a road has asphalt and markings, shoulders and embankments, posts, terrain that follows
the road, trees, a sky with haze, and optionally a car. Only the road is real: everything else is scenery that
rules and physics do not use.
"""

from roadgpt.scene.camera import MOUNTS, Camera, CameraPlacement, CameraPose, Mount, Pose
from roadgpt.scene.scene import Scene

__all__ = ["MOUNTS", "Camera", "CameraPlacement", "CameraPose", "Mount", "Pose", "Scene"]
