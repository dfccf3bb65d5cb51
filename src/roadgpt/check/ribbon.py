"""Represents the surface of a road by a row of quads, and finds those that come near each other.

left[0] ---- left[1] ---- left[2]        quad i is (left i, left i+1, right i+1, right i),
   |   quad 0   |   quad 1   |           clockwise where the road does not fold
right[0] --- right[1] --- right[2]"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Indices
from roadgpt.road import Edges, Samples

PORTION = 512  # quads that are compared with all others at a time
SLIVER = 1e-6  # m^2: a corner flatter than this does not count as convex


def sides(samples: Samples, edges: Edges) -> tuple[Array, Array]:
    """Returns the left and the right edge points of a road at its samples, ``(n, 2)`` each, in metres."""
    centre = np.stack((samples.x, samples.y), axis=1)
    across = np.stack((-np.sin(samples.heading), np.cos(samples.heading)), axis=1)
    return centre + edges.left[:, None] * across, centre + edges.right[:, None] * across


def bulge(samples: Samples, edges: Edges) -> float:
    """Returns the largest distance in metres between an edge of a road and the chords between its samples:
    the rise of an arc over its chord, chord^2 * curvature / 8, on the outer edge of the tightest bend."""
    step, bend = samples.s[1] - samples.s[0], float(np.abs(samples.curvature).max())
    reach = float(max(np.abs(edges.left).max(), np.abs(edges.right).max()))
    return float(step**2 * bend * (1 + bend * reach) / 8)


def extent(samples: Samples, edges: Edges) -> tuple[Array, Array]:
    """Returns the lower and upper corner (x, y) of the bounding box of a road, ``(2,)`` each, in metres."""
    points, slack = np.concatenate(sides(samples, edges)), bulge(samples, edges)
    return points.min(axis=0) - slack, points.max(axis=0) + slack


def quads_of(left: Array, right: Array) -> Array:
    """Returns quads ``(n - 1, 4, 2)`` between left and right edge points ``(n, 2)``."""
    return np.stack((left[:-1], left[1:], right[1:], right[:-1]), axis=1)


def is_convex(quads: Array) -> NDArray[np.bool_]:
    """Returns for each quad whether it is convex, clockwise and not degenerate, ``(n,)``; False for a
    coordinate that is not finite."""
    sides = np.roll(quads, -1, axis=1) - quads
    ahead = np.roll(sides, -1, axis=1)
    corner = sides[..., 0] * ahead[..., 1] - sides[..., 1] * ahead[..., 0]
    return np.asarray((corner < -SLIVER).all(axis=1))


def near_pairs(quads: Array, reach: float, apart: int = 2) -> Iterator[tuple[Indices, Indices]]:
    """Yields index pairs of quads, j - i >= ``apart``, whose bounding boxes are at most ``reach`` metres
    apart along x and y.

    Each item contains all such pairs for ``PORTION`` consecutive values of j, in driving order, so a caller
    that needs only the first contact can stop early."""
    import shapely

    boxes = shapely.box(*(quads.min(axis=1) - reach).T, *quads.max(axis=1).T)
    tree = shapely.STRtree(boxes)
    for first in range(0, len(boxes), PORTION):
        j, i = tree.query(boxes[first : first + PORTION])
        wanted = j + first - i >= apart
        yield i[wanted], j[wanted] + first
