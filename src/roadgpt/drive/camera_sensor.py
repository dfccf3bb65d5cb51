"""Renders the images of a driver's camera, for simulators that have no camera of their own."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from numpy import uint8
from numpy.typing import NDArray

from roadgpt.drive.view import CameraSpec
from roadgpt.errors import UsageError
from roadgpt.road import Road, World

if TYPE_CHECKING:
    from roadgpt.scene import Body

POSE = ("x", "y", "z", "heading", "pitch", "roll", "steer", "speed", "brake")


def camera_of(driver: Any) -> CameraSpec | None:
    """Returns the camera that the driver asks for, or None if it asks for none."""
    camera = getattr(driver, "camera", None)
    if camera is not None and not isinstance(camera, CameraSpec):
        raise UsageError("the driver's attribute camera must be a roadgpt.drive.CameraSpec")
    return camera


class CameraSensor:
    """Renders the road as the driver's camera sees it; the image depends only on the road, the world,
    the pose, steering and braking of the car, and the others on the road."""

    def __init__(self, camera: CameraSpec, road: Road, world: World) -> None:
        """Mounts a camera on a car on this road."""
        from roadgpt.scene import Camera as Pinhole
        from roadgpt.scene import CameraPlacement, Scenery

        half = math.tan(camera.field_of_view / 2) * camera.width / camera.height
        place = CameraPlacement(camera.ahead, camera.up, -camera.down)
        self._camera = Pinhole(camera.width, camera.height, 2 * math.atan(half), "bonnet", place)
        self._scene = Scenery.of(road, world)
        self._every, self._step = max(1, camera.every), 0
        self._image: NDArray[uint8] | None = None

    def see(self, row: Mapping[str, float], others: "Sequence[Body]" = ()) -> NDArray[uint8]:
        """Returns the image ``(height, width, 3)`` at a control step, ``row`` of a drive. A new image is
        rendered every ``camera.every`` steps; in between, the last image is returned again."""
        from roadgpt.scene import Pose

        if self._image is None or self._step % self._every == 0:
            self._image = self._scene.render(self._camera, Pose(*(row[name] for name in POSE)), others=others)
        self._step += 1
        return self._image
