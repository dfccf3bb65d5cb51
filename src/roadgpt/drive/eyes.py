"""What a driver's camera sees, where the simulator has no pictures of its own."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from roadgpt.drive.view import Camera
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from numpy import uint8
    from numpy.typing import NDArray

    from roadgpt.road import Road, World

POSE = ("x", "y", "z", "heading", "pitch", "roll", "steer", "speed", "brake")


def camera_of(driver: Any) -> Camera | None:
    """What the driver asks for; None where it drives without looking.

    Raises:
        UsageError: its attribute ``camera`` is something else.
    """
    camera = getattr(driver, "camera", None)
    if camera is not None and not isinstance(camera, Camera):
        raise UsageError("the driver's attribute camera must be a roadgpt.drive.Camera")
    return camera


class Eyes:
    """Draws the road as the driver's camera sees it; bytes depend on nothing but road, world and pose."""

    def __init__(self, camera: Camera, road: "Road", world: "World") -> None:
        """A camera on a car on this road.

        Raises:
            UsageError: no camera has such a size or field of view.
        """
        from roadgpt.scene import Camera as Pinhole
        from roadgpt.scene import Place, Scene

        half = math.tan(camera.field_of_view / 2) * camera.width / camera.height
        place = Place(camera.ahead, camera.up, -camera.down)
        self._camera = Pinhole(camera.width, camera.height, 2 * math.atan(half), "bonnet", place)
        self._scene = Scene.of(road, world)
        self._every, self._step = max(1, camera.every), 0
        self._image: NDArray[uint8] | None = None

    def see(self, row: Mapping[str, float]) -> "NDArray[uint8]":
        """The picture ``(height, width, 3)`` at a control step; a new one every so many steps.

        Args:
            row: of a drive, by name of its columns.
        """
        from roadgpt.scene import Pose

        if self._image is None or self._step % self._every == 0:
            self._image = self._scene.render(self._camera, Pose(*(row[name] for name in POSE)))
        self._step += 1
        return self._image
