"""Rasterises triangles with four samples per pixel; the nearest triangle wins.

Let a triangle have the corners P0, P1, P2 in camera coordinates (right, down, forward). Every quantity q that
varies linearly over the triangle then satisfies q / w = g . ray, where w is the depth, and ray = (x, y, 1) is
the direction of a pixel. The vector g follows from the values q_i at the corners: P_i . g = q_i. This also
holds for corners behind the camera, so that only the outline of the triangle in the image needs clipping.
Source: M. Olano and T. Greer, Triangle scan conversion using 2D homogeneous coordinates, 1997."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.compiled import compiled, inlined
from roadgpt.geometry.curve import Array
from roadgpt.scene.mesh import Mesh

NEAR = 0.12  # m; anything nearer is not drawn
SAMPLES = 4
# Shares of a pixel's width in its four rows: a rotated grid gives upright and level edges four steps each.
OFFSETS = 0.375, 0.875, 0.125, 0.625
PLANE = 12  # numbers per triangle: three each for depth, two coordinates and light

Depth = NDArray[np.float32]
Numbers = NDArray[np.int32]


class RenderBuffers(NamedTuple):
    """Working memory for one image. Each thread has its own buffers, so that threads can render at once."""

    depth: Depth  # inverse depth of each sample in 1/m, ``(4 * height, width)``
    ids: Numbers  # number of the triangle that each sample shows, same shape as ``depth``; -1 for the sky
    planes: Array
    """Plane equations ``(n, PLANE)`` of the drawn triangles; the numbers in ``ids`` are indices of rows."""
    kinds: NDArray[np.int64]  # surface types ``(n,)`` of these triangles
    seen: Array  # the points of one patch in camera coordinates, (n, 3)
    picture: NDArray[np.float32]  # the image in linear light, (height, width, 3)


@inlined
def _fill(
    x: Array, y: Array, corners: int, a: float, b: float, c: float, number: int, depth: Depth, ids: Numbers
) -> None:
    """Marks samples in a convex outline where the triangle, with depth 1 / (a x + b y + c), is nearer."""
    rows, columns = depth.shape
    top, bottom = y[0], y[0]
    for k in range(1, corners):
        top, bottom = min(top, y[k]), max(bottom, y[k])
    first = max(0, int(np.ceil(4.0 * max(top, -1.0) - 0.5)))
    last = min(rows - 1, int(np.floor(4.0 * min(bottom, rows / 4.0) - 0.5)))
    for row in range(first, last + 1):
        level = (row + 0.5) / 4.0
        left, right = 1e30, -1e30
        for k in range(corners):
            n = k + 1 if k + 1 < corners else 0
            x0, y0, x1, y1 = x[k], y[k], x[n], y[n]
            if y0 > y1:  # both triangles that share an edge follow it downwards, and get the same point
                x0, y0, x1, y1 = x1, y1, x0, y0
            if y0 <= level < y1:
                place = x0 + (level - y0) * ((x1 - x0) / (y1 - y0))
                left, right = min(left, place), max(right, place)
        if left > right:
            continue
        offset = OFFSETS[row & 3]
        begin = max(0, int(np.ceil(max(left, -8.0) - offset)))
        end = min(columns, int(np.ceil(min(right, columns + 8.0) - offset)))
        start = b * level + c + a * offset
        for i in range(begin, end):
            near = np.float32(start + a * i)
            if near > depth[row, i]:
                depth[row, i] = near
                ids[row, i] = number


@inlined
def _is_outside(sphere: Array, eye: Array, reach_x: float, reach_y: float) -> bool:
    dx, dy, dz = sphere[0] - eye[0], sphere[1] - eye[1], sphere[2] - eye[2]
    right = dx * eye[3] + dy * eye[4] + dz * eye[5]
    down = dx * eye[6] + dy * eye[7] + dz * eye[8]
    ahead = dx * eye[9] + dy * eye[10] + dz * eye[11]
    radius = sphere[3]
    return bool(
        ahead + radius < NEAR
        or abs(right) - reach_x * ahead > radius * np.sqrt(1.0 + reach_x * reach_x)
        or abs(down) - reach_y * ahead > radius * np.sqrt(1.0 + reach_y * reach_y)
    )


@inlined
def _beyond(x: float, y: float, ahead: float, reach_x: float, reach_y: float) -> int:
    """Returns a bit for each border of the image that a point lies beyond, and one if it is too near."""
    code = 1 if x > reach_x * ahead else (2 if -x > reach_x * ahead else 0)
    code += 4 if y > reach_y * ahead else (8 if -y > reach_y * ahead else 0)
    if x > reach_x * ahead and -x > reach_x * ahead:  # behind the camera it may be both
        code |= 2
    if y > reach_y * ahead and -y > reach_y * ahead:
        code |= 8
    return code + (16 if ahead < NEAR else 0)


@inlined
def _outline(three: Array, focal: float, middle_x: float, middle_y: float, x: Array, y: Array) -> int:
    corners = 0
    for k in range(3):
        p, q = three[k], three[(k + 1) % 3]
        is_before, next_is = p[2] >= NEAR, q[2] >= NEAR
        if is_before:
            x[corners] = middle_x + focal * p[0] / p[2]
            y[corners] = middle_y + focal * p[1] / p[2]
            corners += 1
        if is_before != next_is:
            if next_is:
                p, q = q, p
            part = (p[2] - NEAR) / (p[2] - q[2])
            x[corners] = middle_x + focal * (p[0] + part * (q[0] - p[0])) / NEAR
            y[corners] = middle_y + focal * (p[1] + part * (q[1] - p[1])) / NEAR
            corners += 1
    return corners


@inlined
def _holds_samples(x: Array, y: Array, corners: int, rows: int, columns: int) -> bool:
    left, right, top, bottom = x[0], x[0], y[0], y[0]
    for k in range(1, corners):
        left, right = min(left, x[k]), max(right, x[k])
        top, bottom = min(top, y[k]), max(bottom, y[k])
    if right < 0.0 or left > columns or bottom < 0.0 or top > rows / 4.0:
        return False
    # in both directions, samples lie at one, three, five and seven eighths of a pixel
    return bool(
        np.ceil(4.0 * top - 0.5) <= np.floor(4.0 * bottom - 0.5)
        and np.ceil(4.0 * left - 0.5) <= np.floor(4.0 * right - 0.5)
    )


@inlined
def _to_camera(
    points: Array, first: int, end: int, eye: Array, reach_x: float, reach_y: float, seen: Array,
    codes: NDArray[np.uint8],
) -> None:  # fmt: skip
    for n in range(first, end):
        dx, dy, dz = points[n, 0] - eye[0], points[n, 1] - eye[1], points[n, 2] - eye[2]
        m = n - first
        for k in range(3):
            seen[m, k] = dx * eye[3 + 3 * k] + dy * eye[4 + 3 * k] + dz * eye[5 + 3 * k]
        codes[m] = _beyond(seen[m, 0], seen[m, 1], seen[m, 2], reach_x, reach_y)


@inlined
def _cross_products(three: Array, across: Array) -> float:
    """Writes the cross products of pairs of corners; returns the determinant, negative for a front."""
    a, b, c = three[0], three[1], three[2]
    for k in range(3):
        j, m = (k + 1) % 3, (k + 2) % 3
        across[0, k] = b[j] * c[m] - b[m] * c[j]
        across[1, k] = c[j] * a[m] - c[m] * a[j]
        across[2, k] = a[j] * b[m] - a[m] * b[j]
    volume: float = a[0] * across[0, 0] + a[1] * across[0, 1] + a[2] * across[0, 2]
    return volume


@inlined
def _plane_equations(
    attributes: Array, triangles: NDArray[np.int64], t: int, across: Array, volume: float, focal: float,
    middle_x: float, middle_y: float, plane: Array,
) -> None:  # fmt: skip
    """Computes the vectors g (see the top of this file) for 1, which gives the inverse depth, and for the
    three attributes of a triangle. The rays are (x, y, 1) with x and y in pixels."""
    for k in range(4):
        for j in range(3):
            g = 0.0
            for m in range(3):
                g += (1.0 if k == 0 else attributes[triangles[t, m], k - 1]) * across[m, j]
            plane[3 * k + j] = g / volume
        plane[3 * k] /= focal
        plane[3 * k + 1] /= focal
        plane[3 * k + 2] -= plane[3 * k] * middle_x + plane[3 * k + 1] * middle_y


@compiled
def draw(mesh: Mesh, eye: Array, buffers: RenderBuffers, count: int) -> int:
    """Draws a mesh into the samples, and stores the plane and the kind of each drawn triangle. ``count`` is
    the number of triangles that earlier calls have drawn. Returns ``count`` plus the number drawn here.

    ``eye`` has the shape (13,): the camera's position, its axes to the right, downwards and forward, and its
    focal length in pixels."""
    triangles, ranges = mesh.triangles, mesh.ranges
    depth, planes, seen = buffers.depth, buffers.planes, buffers.seen
    rows, columns = depth.shape
    focal, middle_x, middle_y = eye[12], columns / 2.0, rows / 8.0
    reach_x, reach_y = middle_x / focal, middle_y / focal
    codes = np.empty(seen.shape[0], np.uint8)
    px, py, three, across = np.empty(4), np.empty(4), np.empty((3, 3)), np.empty((3, 3))
    for patch in range(ranges.shape[0]):
        if _is_outside(mesh.spheres[patch], eye, reach_x, reach_y):
            continue
        first = ranges[patch, 0]
        _to_camera(mesh.points, first, ranges[patch, 1], eye, reach_x, reach_y, seen, codes)
        for t in range(ranges[patch, 2], ranges[patch, 3]):
            i0, i1, i2 = triangles[t, 0] - first, triangles[t, 1] - first, triangles[t, 2] - first
            if codes[i0] & codes[i1] & codes[i2]:  # all beyond the same border
                continue
            for j in range(3):
                three[0, j], three[1, j], three[2, j] = seen[i0, j], seen[i1, j], seen[i2, j]
            volume = _cross_products(three, across)
            if volume > -1e-9:  # seen from behind, or edge on
                continue
            corners = _outline(three, focal, middle_x, middle_y, px, py)
            if not _holds_samples(px, py, corners, rows, columns):
                continue
            plane = planes[count]
            _plane_equations(
                mesh.attributes, triangles, t, across, volume, focal, middle_x, middle_y, plane,
            )  # fmt: skip
            buffers.kinds[count] = mesh.kinds[t]
            _fill(px, py, corners, plane[0], plane[1], plane[2], count, depth, buffers.ids)
            count += 1
    return count
