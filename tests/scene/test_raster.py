"""The rasteriser against rays that are cast one by one at every triangle."""

import numpy as np
import pytest

from roadgpt.scene.mesh import Mesh, Patch
from roadgpt.scene.raster import NEAR, OFFSETS, PLANE, RenderBuffers, draw

WIDE, HIGH, FOCAL = 20, 12, 14.0


def axes(rng: np.random.Generator) -> np.ndarray:
    """Right, down and forward as rows, at random."""
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.linalg.det(q)


def drawn(
    patches: list[Patch], eye: np.ndarray, turn: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Depths, kinds that are seen (-1: nothing), and the coordinates interpolated there."""
    mesh = Mesh.of(patches)
    depth, ids = np.zeros((4 * HIGH, WIDE), np.float32), np.full((4 * HIGH, WIDE), -1, np.int32)
    planes, kinds = np.empty((len(mesh.triangles), PLANE)), np.empty(len(mesh.triangles), np.int64)
    numbers = np.concatenate([eye, turn.ravel(), [FOCAL]])
    room = np.empty((max(np.ptp(mesh.ranges[:, :2], axis=1)), 3))
    picture = np.empty((HIGH, WIDE, 3), np.float32)
    draw(mesh, numbers, RenderBuffers(depth, ids, planes, kinds, room, picture), 0)
    rows, columns = np.mgrid[0 : 4 * HIGH, 0:WIDE]
    x, y = columns + np.array(OFFSETS)[rows % 4], (rows + 0.5) / 4
    p = planes[np.maximum(ids, 0)]
    w = 1 / (p[..., 0] * x + p[..., 1] * y + p[..., 2])
    u = (p[..., 3] * x + p[..., 4] * y + p[..., 5]) * w
    return depth, np.where(ids < 0, -1, kinds[np.maximum(ids, 0)]), u


def cast(
    points: np.ndarray, triangles: np.ndarray, u: np.ndarray, eye: np.ndarray, turn: np.ndarray
) -> tuple:
    """For every sample the nearest triangle that faces it, its depth, and u there: by solving for each."""
    rows, columns = np.mgrid[0 : 4 * HIGH, 0:WIDE]
    x = (columns + np.array([0.375, 0.875, 0.125, 0.625])[rows % 4] - WIDE / 2) / FOCAL
    y = ((rows + 0.5) / 4 - HIGH / 2) / FOCAL
    rays = np.stack([x, y, np.ones_like(x)], axis=-1) @ turn
    best, which = np.full(x.shape, np.inf), np.full(x.shape, -1)
    there, unsure = np.zeros(x.shape), np.zeros(x.shape, bool)
    for n, (a, b, c) in enumerate(points[triangles]):
        facing = np.dot(np.cross(b - a, c - a), a - eye)
        system = np.stack([np.broadcast_to(a - b, rays.shape), np.broadcast_to(a - c, rays.shape), rays], -1)
        beta, gamma, w = np.moveaxis(
            np.linalg.solve(system, np.broadcast_to(a - eye, rays.shape)[..., None])[..., 0], -1, 0
        )
        least = np.minimum(np.minimum(beta, gamma), 1 - beta - gamma)
        unsure |= (
            (np.abs(least) < 1e-4) | (np.abs(w - NEAR) < 1e-3) | ((least > 0) & (np.abs(w - best) < 1e-3 * w))
        )
        hit = (least > 0) & (w > NEAR) & (w < best) & (facing < 0)
        best, which = np.where(hit, w, best), np.where(hit, n, which)
        value = u[triangles[n]]
        there = np.where(hit, value[0] + beta * (value[1] - value[0]) + gamma * (value[2] - value[0]), there)
    return best, which, there, unsure


@pytest.mark.parametrize("seed", range(6))
def test_the_nearest_triangle_is_seen_as_rays_see_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    eye, turn = rng.normal(size=3), axes(rng)
    count = 60
    middles = eye + rng.uniform(-4, 4, (count, 1, 3))
    points = (middles + rng.normal(size=(count, 3, 3)) * 2).reshape(-1, 3)
    u = rng.normal(size=len(points))
    values = np.column_stack([u, u, u])
    triangles = np.arange(3 * count).reshape(-1, 3)
    each = [
        Patch(points[t], values[t], np.array([[0, 1, 2]]), np.array([n])) for n, t in enumerate(triangles)
    ]
    depth, kinds, seen = drawn(each, eye, turn)
    best, which, there, unsure = cast(points, triangles, u, eye, turn)
    assert (which >= 0).mean() > 0.2
    sure = ~unsure
    assert sure.mean() > 0.9
    np.testing.assert_array_equal(kinds[sure], which[sure])
    hit = sure & (which >= 0)
    np.testing.assert_allclose(1 / depth[hit], best[hit], rtol=1e-4)
    np.testing.assert_allclose(seen[hit], there[hit], atol=1e-5)


def test_a_surface_of_many_triangles_has_no_holes_and_no_seams() -> None:
    rng = np.random.default_rng(3)
    n = 9
    x, y = np.meshgrid(np.linspace(-40, 40, n), np.linspace(-40, 40, n), indexing="ij")
    inside = np.zeros((n, n))
    inside[1:-1, 1:-1] = 1
    net = np.stack(
        [x + inside * rng.uniform(-3, 3, x.shape), y + inside * rng.uniform(-3, 3, x.shape), 0 * x], -1
    )
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = at[:-1, :-1].ravel(), at[1:, :-1].ravel(), at[1:, 1:].ravel(), at[:-1, 1:].ravel()
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    flat = Patch(net.reshape(-1, 3), net.reshape(-1, 3), triangles, np.arange(len(triangles)))
    down = np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, -1]])
    depth, kinds, u = drawn([flat], np.array([0.3, 0.2, 15.0]), down)
    assert (kinds >= 0).all()
    np.testing.assert_allclose(1 / depth, 15.0, rtol=1e-5)
    columns = np.arange(WIDE) + np.array(OFFSETS)[np.arange(4 * HIGH) % 4][:, None]
    np.testing.assert_allclose(u, 0.3 + (columns - WIDE / 2) / FOCAL * 15.0, atol=1e-6)


def test_what_faces_away_or_lies_behind_is_not_seen() -> None:
    corner = np.array([[-5.0, -5, 4], [0, 5, 4], [5, -5, 4]])
    for points, is_seen in ((corner, True), (corner[::-1], False), (corner * [1, 1, -1], False)):
        patch = Patch(points, points, np.array([[0, 1, 2]]), np.array([7]))
        _, kinds, _ = drawn([patch], np.zeros(3), np.eye(3))
        assert (7 in kinds) == is_seen
