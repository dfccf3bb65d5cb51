"""Computes the brightness of the terrain around a road, and the patches with which the terrain is drawn."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import ndimage

from roadgpt.geometry.curve import Array
from roadgpt.road.land import Land
from roadgpt.scene.light import daylight
from roadgpt.scene.mesh import GRASS, Patch, attributes, grid

BLOCK = 8  # cells along a side of a patch


@dataclass(frozen=True, eq=False)
class LitTerrain:
    """The terrain with its brightness in the light of sun and sky."""

    land: Land

    @cached_property
    def light(self) -> Array:
        """The brightness (rows, columns) of the terrain, computed from its slope."""
        land = self.land
        slope_y, slope_x = np.gradient(ndimage.gaussian_filter(land.heights, 1.0), land.y, land.x)
        normals = np.stack([-slope_x, -slope_y, np.ones_like(slope_x)], axis=-1)
        return daylight(normals / np.linalg.norm(normals, axis=-1, keepdims=True))

    def light_at(self, x: Array, y: Array) -> Array:
        """Returns the brightness of the terrain at points (x, y)."""
        return self.land.between(self.light, x, y)

    def patches(self) -> list[Patch]:
        """Returns the surface of the terrain as patches."""
        land = self.land
        x, y = np.meshgrid(land.x, land.y, indexing="ij")
        points, values = np.stack([x, y, land.heights.T], axis=-1), attributes(0.0, 0.0, self.light.T)
        rows, columns = land.heights.shape
        blocks = [
            (slice(i, i + BLOCK + 1), slice(j, j + BLOCK + 1))
            for j in range(0, rows - 1, BLOCK)
            for i in range(0, columns - 1, BLOCK)
        ]
        return [grid(points[block], values[block], GRASS) for block in blocks]
