"""Models a wheel: its tread, its sidewall, and a rim with five spokes."""

from collections.abc import Iterator

import numpy as np

from roadgpt.export.ego import CAR
from roadgpt.geometry.curve import Array
from roadgpt.scene.body import CarPart, surface
from roadgpt.scene.palette import GAP, RIM, TYRE

AROUND = 30  # corners
OUTER, INNER = 0.155, -0.09  # m from the hub's middle outward: the tyre's faces
RIM_RADIUS, HUB_RADIUS = 0.232, 0.06  # m
SPOKE = 0.5  # of a fifth of the rim


def wheel(side: float) -> Iterator[CarPart]:
    """Yields the parts of a wheel around its hub; ``side`` is 1 for left wheels, -1 for right ones."""
    radius = CAR.wheel / 2
    yield _turned([(radius, INNER), (radius, OUTER - 0.03), (radius - 0.03, OUTER)], side, TYRE)
    yield _turned([(radius - 0.03, OUTER), (RIM_RADIUS, OUTER - 0.005)], side, TYRE)
    yield _turned([(RIM_RADIUS, OUTER - 0.005), (RIM_RADIUS - 0.022, OUTER + 0.004)], side, RIM)
    yield _turned([(RIM_RADIUS - 0.022, OUTER - 0.03), (0.0, OUTER - 0.03)], side, GAP)
    yield _turned([(HUB_RADIUS, OUTER + 0.004), (0.0, OUTER + 0.006)], side, RIM)
    for k in range(5):
        middle = 2 * np.pi * k / 5
        angles = middle + np.array([-1.0, 1.0]) * SPOKE * np.pi / 5
        inner = _ring(HUB_RADIUS, OUTER + 0.002, middle + np.array([-0.7, 0.7]), side)
        outer = _ring(RIM_RADIUS - 0.02, OUTER + 0.002, angles * 1.0, side)
        yield surface(np.stack([outer, inner], axis=1), RIM)


def _turned(profile: list[tuple[float, float]], side: float, kind: int) -> CarPart:
    """Returns the surface of revolution of a profile of (radius, distance outwards) about the axle."""
    angles = np.linspace(0.0, 2 * np.pi, AROUND + 1)
    return surface(np.stack([_ring(r, y, angles, side) for r, y in profile], axis=1), kind)


def _ring(radius: float, outward: float, angles: Array, side: float) -> Array:
    turned = -angles * side
    return np.column_stack(
        [radius * np.cos(turned), np.full(len(angles), side * outward), radius * np.sin(turned)]
    )
