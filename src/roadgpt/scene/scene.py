"""The Scene: a road as cameras see it."""

import threading
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from roadgpt.errors import UsageError
from roadgpt.export.ego import CAR
from roadgpt.geometry.curve import Array
from roadgpt.road import Road, World
from roadgpt.road.land import Land
from roadgpt.scene.camera import Camera, Pose, axes_of
from roadgpt.scene.car import palette_of, saloon
from roadgpt.scene.meadow import Meadow
from roadgpt.scene.mesh import Mesh
from roadgpt.scene.raster import PLANE, SAMPLES, draw
from roadgpt.scene.ribbon import road_patches
from roadgpt.scene.shade import shade, to_screen
from roadgpt.scene.sprites import overlay
from roadgpt.scene.textures import noise, screen_table
from roadgpt.scene.trees import Trees, pictures, plant

Image = NDArray[np.uint8]


FARTHEST = 1e7  # m, and rad


@dataclass(eq=False)
class Sheet:
    """Room for one picture; each thread has its own, so that pictures can be drawn side by side."""

    depth: NDArray[np.float32]
    ids: NDArray[np.int32]
    picture: NDArray[np.float32]
    planes: NDArray[np.float64]
    kinds: NDArray[np.int64]
    seen: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Scene:
    """Built once for a road; draws any number of pictures of it, from several threads if need be."""

    road: Road
    world: World
    land: Land
    ground: Mesh
    trees: Trees
    _own: threading.local = field(default_factory=threading.local, repr=False)

    @classmethod
    def of(cls, road: Road, world: World) -> "Scene":
        """The scene of a road; the same road and world always give the same pictures.

        Raises:
            ExportError: the road has a number that is not finite.
        """
        land = Land.around(road, world)
        meadow = Meadow(land)
        ground = Mesh.of([*road_patches(road, world, meadow), *meadow.patches()])
        return cls(road, world, land, ground, plant(road, world, land))

    def render(self, camera: Camera, pose: Pose, out: Image | None = None, car: Pose | None = None) -> Image:
        """A picture ``(height, width, 3)`` of bytes, red first, from a camera on a car at ``pose``.

        Args:
            camera: which one.
            pose: of the car that carries it.
            out: where the picture goes, contiguous; a new array if there is none.
            car: of the car that is seen, and its shadow; None draws none.

        Raises:
            UsageError: a number of a pose is not finite, or ``out`` has another shape.
        """
        if not all(np.abs(each).max() <= FARTHEST for each in (pose, car) if each is not None):
            raise UsageError("a pose has a number that is not finite, or lies beyond 10,000 km")
        shape = (camera.height, camera.width, 3)
        if out is None:
            out = np.empty(shape, np.uint8)
        if out.shape != shape or out.dtype != np.uint8:
            raise UsageError(f"the picture is bytes of the shape {shape}; give such an array")
        sheet = self._sheet(camera)
        eye = camera.eye(pose)
        numbers = np.concatenate([eye.position, eye.axes.ravel(), [eye.focal]])
        sheet.depth.fill(0.0)
        sheet.ids.fill(-1)
        count = _draw(self.ground, self.ground.points, self.ground.attributes, numbers, sheet, 0)
        if car is not None:
            made = saloon()
            count = _draw(made.mesh, *made.placed(car, eye), numbers, sheet, count)
        shade(
            sheet.ids, sheet.depth, sheet.planes, sheet.kinds, palette_of(car), noise(), numbers,
            np.concatenate([[self.world.lane_width, self.road.length], _shade_of(car)]), sheet.picture,
        )  # fmt: skip
        trees = self.trees
        order = np.argsort((eye.position - trees.places) @ eye.axes[2], kind="stable")
        overlay(
            order, trees.places, trees.sizes, trees.looks, trees.tints, pictures(),
            numbers, sheet.depth, sheet.picture,
        )  # fmt: skip
        to_screen(sheet.picture, screen_table(), out)
        return out

    def _sheet(self, camera: Camera) -> Sheet:
        """This thread's room for a picture of this size."""
        key = (camera.width, camera.height)
        kept: dict[tuple[int, int], Sheet] = self._own.__dict__.setdefault("sheets", {})
        if key not in kept:
            high, wide = camera.height, camera.width
            count = len(self.ground.triangles) + len(saloon().mesh.triangles)
            kept[key] = Sheet(
                np.empty((SAMPLES * high, wide), np.float32),
                np.empty((SAMPLES * high, wide), np.int32),
                np.empty((high, wide, 3), np.float32),
                np.empty((count, PLANE)),
                np.empty(count, np.int64),
                np.empty((max(*np.ptp(self.ground.ranges[:, :2], axis=1), len(saloon().mesh.points)), 3)),
            )
        return kept[key]


def _draw(mesh: Mesh, points: Array, attributes: Array, eye: Array, sheet: Sheet, count: int) -> int:
    """Draw a mesh whose points lie elsewhere than it says, if it is a car."""
    spheres = mesh.spheres
    if points is not mesh.points:
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        spheres = np.r_[middle, np.linalg.norm(points - middle, axis=1).max()][None]
    return draw(
        points, attributes, mesh.triangles, mesh.kinds, mesh.ranges, spheres,
        eye, sheet.depth, sheet.ids, sheet.planes, sheet.seen, sheet.kinds, count,
    )  # fmt: skip


def _shade_of(car: Pose | None) -> NDArray[np.float64]:
    """The car as its shadow needs it."""
    out = np.zeros(9)
    if car is not None:
        forward, _, up = axes_of(car.heading, car.pitch, car.roll)
        out[:3] = np.array([car.x, car.y, car.z]) - CAR.gravity_height * up
        out[3:5] = forward[:2] / max(np.hypot(*forward[:2]), 1e-9)
        out[5:] = CAR.length, CAR.width, CAR.middle, 1.0
    return out
