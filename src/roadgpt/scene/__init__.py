"""Scenes: makes camera images of roads, by a rasteriser of our own. Verb: ``Scene.render``.

No display, no driver of a graphics card, nothing to be installed: triangles are drawn by compiled code, and
the same pose gives the same bytes. A road's scene has asphalt and markings, verges and banks, posts, land
that follows the road, trees, a sky with haze, and a car where one is to be seen. Only the road is real: the
rest is scenery, and knows nothing of rules or physics.
"""

from roadgpt.scene.camera import MOUNTS, Camera, Eye, Mount, Place, Pose
from roadgpt.scene.scene import Scene

__all__ = ["MOUNTS", "Camera", "Eye", "Mount", "Place", "Pose", "Scene"]
