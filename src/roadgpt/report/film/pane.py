"""One picture of a film: a Run seen from one camera."""

import math
from dataclasses import dataclass

from roadgpt.report.film.glyphs import Frame
from roadgpt.report.film.overlay import Overlay
from roadgpt.report.film.trip import Trip
from roadgpt.run import Run
from roadgpt.scene import Camera, Mount, Scene

FIELDS: dict[str, float] = {"chase": math.radians(62), "bonnet": math.radians(72)}


@dataclass(frozen=True, eq=False)
class Pane:
    """Renders a Run from one camera at any time; may be used by several threads."""

    scene: Scene
    trip: Trip
    camera: Camera
    overlay: Overlay
    has_car: bool

    @classmethod
    def of(cls, run: Run, scene: Scene, trip: Trip, mount: Mount, width: int, height: int) -> "Pane":
        """Returns the pane of a Run for one mount of the camera, with the field of view in FIELDS."""
        camera = Camera(width, height, FIELDS[mount], mount)
        return cls(scene, trip, camera, Overlay(run, width, height), run.drive is not None)

    def draw(self, time: float) -> Frame:
        """Returns the picture ``(height, width, 3)`` at a time in seconds; after the drive the last one."""
        now = min(time, self.trip.duration)
        car = self.trip.car(now)
        pose = self.trip.follower(now) if self.camera.mount == "chase" else car
        frame = self.scene.render(self.camera, pose, car=car if self.has_car else None)
        self.overlay.lay(frame, self.trip.readout(now), time >= self.trip.duration)
        return frame
