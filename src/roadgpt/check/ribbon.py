"""Represents the surface of a road by a row of quads, and computes the distances between quads with numpy.

left[0] ---- left[1] ---- left[2]        quad i is (left i, left i+1, right i+1, right i),
   |   quad 0   |   quad 1   |           clockwise where the road does not fold
right[0] --- right[1] --- right[2]"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from roadgpt.geometry.curve import Array
from roadgpt.road import Edges, Samples

Indices = NDArray[np.intp]

Boxes = tuple[Array, Array]
"""Lower and upper corners (x, y) of n bounding boxes, ``(n, 2)`` each."""

BLOCK = 8  # quads per bounding box in the second comparison
PORTION = 512  # quads per bounding box in the first comparison and per result; a multiple of BLOCK
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
    apart.

    Each item contains all such pairs for ``PORTION`` consecutive values of j, in driving order, so a caller
    that needs only the first contact can stop early. To avoid comparing all quads of a long road, bounding
    boxes of many quads are compared first."""
    low, high = quads.min(axis=1) - reach, quads.max(axis=1)
    blocks, portions = _boxes(low, high, BLOCK), _boxes(low, high, PORTION)
    for portion in range(len(portions[0])):
        yield _pairs_of_portion(portion, portions, blocks, (low, high), apart)


def _pairs_of_portion(
    portion: int, portions: Boxes, blocks: Boxes, boxes: Boxes, apart: int
) -> tuple[Indices, Indices]:
    near = _meeting(portions, np.arange(portion + 1), np.array([portion]))[0]
    per = PORTION // BLOCK
    own = np.arange(portion * per, min((portion + 1) * per, len(blocks[0])))
    theirs = (near[:, None] * per + np.arange(per)).ravel()
    first, second = _meeting(blocks, theirs[theirs < len(blocks[0])], own)
    worth = (first <= second) & ((second - first + 1) * BLOCK > apart)
    first, second = first[worth], second[worth]
    within = np.arange(BLOCK)
    i = (first[:, None, None] * BLOCK + within[:, None]) + np.zeros(BLOCK, np.intp)
    j = (second[:, None, None] * BLOCK + within) + np.zeros((BLOCK, 1), np.intp)
    wanted = (j - i >= apart) & (j < len(boxes[0]))
    i, j = i[wanted], j[wanted]
    low, high = boxes
    meet = _touch(low[i], high[i], low[j], high[j])
    return i[meet], j[meet]


def _boxes(low: Array, high: Array, size: int) -> Boxes:
    starts = np.arange(0, len(low), size)
    return np.minimum.reduceat(low, starts), np.maximum.reduceat(high, starts)


def _meeting(boxes: Boxes, some: Indices, others: Indices) -> tuple[Indices, Indices]:
    low, high = boxes
    touch = _touch(low[some][:, None], high[some][:, None], low[others], high[others])
    one, other = np.nonzero(touch)
    return some[one], others[other]


def _touch(low: Array, high: Array, other_low: Array, other_high: Array) -> Any:
    return (
        (low[..., 0] <= other_high[..., 0])
        & (other_low[..., 0] <= high[..., 0])
        & (low[..., 1] <= other_high[..., 1])
        & (other_low[..., 1] <= high[..., 1])
    )


def gaps(quads: Array, i: Indices, j: Indices) -> Array:
    """Returns the signed distances in metres ``(m,)`` between convex quads i and j, by the separating axis
    theorem: at least this far apart, or, if negative, the distance by which one must move to separate them.
    """
    used, index = np.unique(np.concatenate((i, j)), return_inverse=True)
    quads, i, j = quads[used], index[: len(i)], index[len(i) :]
    sides = np.roll(quads, -1, axis=1) - quads
    outward = np.stack((-sides[..., 1], sides[..., 0]), axis=-1)
    outward /= np.maximum(np.sqrt((outward**2).sum(axis=-1, keepdims=True)), 1e-12)
    edge = (outward * quads).sum(axis=-1)
    return np.maximum(_beyond(quads, outward, edge, i, j), _beyond(quads, outward, edge, j, i))


def _beyond(quads: Array, outward: Array, edge: Array, i: Indices, j: Indices) -> Array:
    """Returns how far all of quad j lies beyond the side of quad i that separates them best."""
    normal, corner = outward[i][:, :, None], quads[j][:, None]
    along = normal[..., 0] * corner[..., 0] + normal[..., 1] * corner[..., 1]
    return np.asarray((along.min(axis=2) - edge[i]).max(axis=1))
