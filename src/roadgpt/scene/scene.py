"""Defines the Scenery: a road that can be rendered."""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from roadgpt.errors import UsageError
from roadgpt.export.ego import CAR
from roadgpt.ground.ground import Ground
from roadgpt.network.landscape import ground_around
from roadgpt.road import Road, World
from roadgpt.scene.bodies import Body, mesh_of
from roadgpt.scene.camera import Camera, Pose, axes_of
from roadgpt.scene.car import palette_of, saloon
from roadgpt.scene.light import screen_table
from roadgpt.scene.mesh import Mesh
from roadgpt.scene.network_mesh import patches_of
from roadgpt.scene.patterns import noise
from roadgpt.scene.raster import PLANE, SAMPLES, RenderBuffers, draw
from roadgpt.scene.shade import LaneBoundaries, shade, to_screen
from roadgpt.scene.trees import Trees, overlay, pictures, plant
from roadgpt.scene.weather import Weather

Image = NDArray[np.uint8]


STEP = 5.0  # m between the points of the way beside which trees stand
OVER_LAND, UNDER_ROOFS = 0.6, 3.5  # m, of a camera above land; a tunnel's roof is higher above it
FARTHEST = 1e7  # m or rad; greatest number in a pose


def landscape(road: Road, world: World) -> tuple[Ground, Trees]:
    """Returns the ground around all roads of a road's network, and the trees on it."""
    ground = ground_around(road, world)
    return ground, plant(ground, world.scene.landscape, road.centreline(STEP)[:, :2])


@dataclass(frozen=True, eq=False)
class Scenery:
    """The scene of one road. It is built once and can then render any number of images, also in several
    threads at the same time."""

    road: Road
    world: World
    ground: Ground
    mesh: Mesh
    trees: Trees
    lanes: LaneBoundaries
    weather: Weather | None
    _own: threading.local = field(default_factory=threading.local, repr=False)

    def __reduce__(self) -> tuple[Callable[[Road, World], "Scenery"], tuple[Road, World]]:
        return Scenery.of, (self.road, self.world)  # a copy has its own working memory

    @classmethod
    def of(cls, road: Road, world: World) -> "Scenery":
        """Returns the scene of a road, or of the whole network of a route; always the same for the same
        arguments."""
        road = world.lay(road)
        ground, trees = landscape(road, world)
        patches, lanes = patches_of(road, world, ground)
        return cls(road, world, ground, Mesh.of(patches), trees, lanes, Weather.of(world.scene, road))

    def render(
        self,
        camera: Camera,
        pose: Pose,
        out: Image | None = None,
        car: Pose | None = None,
        others: Sequence[Body] = (),
    ) -> Image:
        """Returns an RGB image ``(height, width, 3)`` of bytes, as the camera on a car at ``pose`` sees it.

        Args:
            camera: the camera.
            pose: pose of the car that carries the camera.
            out: contiguous array of bytes to write the image to; None for a new array.
            car: pose of the car that is drawn, with its shadow; None to draw no car.
            others: the others on the road."""
        if not all(np.abs(each).max() <= FARTHEST for each in (pose, car) if each is not None):
            raise UsageError("a number of a pose is not finite, or beyond 10,000 km")
        shape = (camera.height, camera.width, 3)
        if out is None:
            out = np.empty(shape, np.uint8)
        if out.shape != shape or out.dtype != np.uint8:
            raise UsageError(f"out must be an array of bytes of shape {shape}")
        eye = camera.eye(pose)
        if camera.mount == "chase":  # above land that is higher behind the car
            x, y, z = eye.position
            lift = float(self.ground.height(np.array([x]), np.array([y]))[0]) + OVER_LAND - z
            eye.position[2] += lift if 0.0 < lift < UNDER_ROOFS else 0.0
        numbers = np.concatenate([eye.position, eye.axes.ravel(), [eye.focal]])
        meshes = [self.mesh, *([] if car is None else [saloon().placed(car, eye)])]
        meshes += [mesh_of(others)] if others else []
        buffers = self._buffers(camera, sum(len(mesh.triangles) for mesh in meshes))
        buffers.depth.fill(0.0)
        buffers.ids.fill(-1)
        count = 0
        for mesh in meshes:
            count = draw(mesh, numbers, buffers, count)
        palette = palette_of(car)
        shade(buffers, palette, noise(), numbers, self.lanes, _shade_of(car))
        trees = self.trees
        order = np.argsort((eye.position - trees.places) @ eye.axes[2], kind="stable")
        overlay(order, trees, pictures(), numbers, buffers, self.weather is not None)
        if self.weather is not None:
            self.weather.change(buffers, palette, numbers, pose if car is None else car)
        to_screen(buffers.picture, screen_table(), out)
        return out

    def _buffers(self, camera: Camera, count: int) -> RenderBuffers:
        key = (camera.width, camera.height)
        kept: dict[tuple[int, int], RenderBuffers] = self._own.__dict__.setdefault("sheets", {})
        if key not in kept or len(kept[key].kinds) < count:
            high, wide = camera.height, camera.width
            kept[key] = RenderBuffers(
                np.empty((SAMPLES * high, wide), np.float32),
                np.empty((SAMPLES * high, wide), np.int32),
                np.empty((count, PLANE)),
                np.empty(count, np.int64),
                np.empty((max(*np.ptp(self.mesh.ranges[:, :2], axis=1), len(saloon().mesh.points)), 3)),
                np.empty((high, wide, 3), np.float32),
            )
        return kept[key]


def _shade_of(car: Pose | None) -> NDArray[np.float64]:
    out = np.zeros(9)
    if car is not None:
        forward, _, up = axes_of(car.heading, car.pitch, car.roll)
        out[:3] = np.array([car.x, car.y, car.z]) - CAR.gravity_height * up
        out[3:5] = forward[:2] / max(np.hypot(*forward[:2]), 1e-9)
        out[5:] = CAR.length, CAR.width, CAR.middle, 1.0
    return out
