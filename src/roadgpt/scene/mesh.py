"""Stores triangles in patches; a patch that lies completely outside the camera's view is not drawn."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from roadgpt.geometry.curve import Array

ROAD, GRASS, POST, PLAIN = 0, 1, 2, 3
"""Kinds of surface; PLAIN and all higher numbers are colours of a palette."""


class Patch(NamedTuple):
    """Triangles that lie close together."""

    points: Array  # points in metres, (n, 3)
    attributes: Array
    """Attributes of each point, (n, 3): two surface coordinates, and the brightness of the light. Parts of
    the car have their normals here, because their light depends on the car's pose."""
    triangles: NDArray[np.int64]  # indices of points, (m, 3), counter-clockwise as seen from the visible side
    kinds: NDArray[np.int64]  # surface type of each triangle, such as grass or paint, as a number, (m,)


class Mesh(NamedTuple):
    """Several patches in shared arrays, for compiled code; the first four fields are those of a Patch."""

    points: Array
    attributes: Array
    triangles: NDArray[np.int64]
    kinds: NDArray[np.int64]
    ranges: NDArray[np.int64]
    """Index ranges of each patch, (p, 4): first point, end of the points, first triangle, end of the
    triangles."""
    spheres: Array  # centre and radius in metres of a bounding sphere of each patch, (p, 4)

    @classmethod
    def of(cls, patches: list[Patch]) -> "Mesh":
        """Returns a mesh of the patches in the given order; at least one patch is required."""
        ends = np.cumsum([(len(p.points), len(p.triangles)) for p in patches], axis=0)
        starts = np.concatenate([np.zeros((1, 2), np.int64), ends[:-1]])
        ranges = np.stack([starts[:, 0], ends[:, 0], starts[:, 1], ends[:, 1]], axis=1)
        spheres = np.stack([sphere_around(p.points) for p in patches])
        return cls(*joined(patches), ranges, spheres)


def joined(patches: list[Patch]) -> Patch:
    """Returns one patch that holds the triangles of several patches."""
    starts = np.cumsum([0, *(len(patch.points) for patch in patches)])
    return Patch(
        np.concatenate([patch.points for patch in patches]),
        np.concatenate([patch.attributes for patch in patches]),
        np.concatenate([patch.triangles + at for patch, at in zip(patches, starts, strict=False)]),
        np.concatenate([patch.kinds for patch in patches]),
    )


def sphere_around(points: Array) -> Array:
    """Returns the centre and the radius of a sphere that holds all points, (4,)."""
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    return np.asarray(np.r_[centre, np.linalg.norm(points - centre, axis=1).max()])


def grid(points: Array, attributes: Array, kind: int) -> Patch:
    """Returns the surface through a grid of points ``(rows, columns, 3)``. The surface is visible only from
    the side to which the cross product a x b points, where a is the direction of increasing row index and b
    the direction of increasing column index."""
    rows, columns = points.shape[:2]
    at = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    triangles = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return Patch(
        points.reshape(-1, 3), attributes.reshape(-1, 3), triangles, np.full(len(triangles), kind, np.int64)
    )


def attributes(u: ArrayLike, v: ArrayLike, light: ArrayLike) -> Array:
    """Returns the attributes of points, as in ``Patch``, as one array ``(..., 3)``: the surface coordinates
    ``u`` and ``v``, and the brightness ``light``. The three are broadcast to one shape."""
    return np.stack(np.broadcast_arrays(*(np.asarray(a, float) for a in (u, v, light))), axis=-1)
