"""Renders camera images of roads. Main method: ``Scenery.render``.

The images are drawn by a software rasteriser in compiled code, without a display or graphics driver. The same
pose always gives the same bytes. The scene of a road has asphalt and markings, shoulders and embankments,
posts, terrain that follows the road, trees, a sky with haze, and optionally cars and others. Road checks and
vehicle physics use only the road; everything else is scenery."""

from roadgpt.scene.bodies import Body
from roadgpt.scene.camera import MOUNTS, Camera, CameraPlacement, CameraPose, Mount, Pose
from roadgpt.scene.scene import Scenery

__all__ = ["MOUNTS", "Body", "Camera", "CameraPlacement", "CameraPose", "Mount", "Pose", "Scenery"]
