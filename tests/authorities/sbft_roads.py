"""Roads to hunt differences with: control points as competition tools write them, and mean ones.

``random_road`` draws from every family; ``mutated`` changes a road a little, often towards a close call.
"""

import numpy as np


def random_road(rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """Control points ``(n, 2)`` and a map size, both in metres."""
    map_size = float(rng.choice([100, 200, 250, 1000], p=[0.1, 0.5, 0.3, 0.1]))
    family = FAMILIES[rng.integers(len(FAMILIES))]
    return np.asarray(family(rng, map_size), float), map_size


def mutated(points: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """One or two small changes: a point moved, dropped, met again; the road shifted, scaled, turned round."""
    for _ in range(rng.integers(1, 3)):
        points = MUTATIONS[rng.integers(len(MUTATIONS))](points.copy(), rng)
    return points


def scattered(rng, size):
    return rng.uniform(0, size, (rng.integers(2, 12), 2))


def wandering(rng, size):
    """Hops of one length with a heading that drifts."""
    count, hop = rng.integers(2, 40), rng.choice([2, 5, 10, 15])
    heading = rng.uniform(0, 2 * np.pi) + np.cumsum(rng.normal(0, rng.choice([0.1, 0.3, 0.7]), count))
    return rng.uniform(0.2, 0.8, 2) * size + hop * np.cumsum(np.c_[np.cos(heading), np.sin(heading)], axis=0)


def bending(rng, size):
    """Arcs and straights, a point every metre or few, radii about the limit."""
    step = rng.choice([1.0, 2.0, 5.0])
    curvature = np.concatenate(
        [
            np.full(rng.integers(4, 20), rng.choice([-1, 0, 1]) / rng.uniform(13.5, 40))
            for _ in range(rng.integers(1, 7))
        ]
    )
    heading = rng.uniform(0, 2 * np.pi) + np.cumsum(curvature * step)
    road = np.cumsum(step * np.c_[np.cos(heading), np.sin(heading)], axis=0)
    return np.round(road - road.mean(axis=0) + rng.uniform(0.3, 0.7, 2) * size, 4)


def circling(rng, size):
    """A circle or spiral: ends meet, arms lie a road's width apart, the radius is about the limit."""
    turns, radius = rng.uniform(0.2, 2.2), rng.choice([14.2, 14.4, 15, 20, 30])
    angle = np.arange(0, turns * 2 * np.pi, rng.choice([1.0, 2.0, 5.0]) / radius)
    growth = rng.choice([0, 7.9, 8.0, 8.1, 9, 12]) / (2 * np.pi)
    arm = radius + growth * angle
    return size / 2 + np.c_[arm * np.cos(angle), arm * np.sin(angle)]


def on_a_lattice(rng, size):
    """Straights along the axes in whole metres: sides coincide, borders are touched exactly."""
    step = rng.choice([1, 2, 4, 8])
    moves = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])[
        np.repeat(rng.integers(0, 4, 8), rng.integers(1, 6, 8))[: rng.integers(1, 25)]
    ]
    return rng.choice([4, 8, 20, 96, 100]) + step * np.concatenate(([[0, 0]], np.cumsum(moves, axis=0)))


def straight(rng, size):
    """Two or three points, now and then just 20 m apart, or 4 m from the border."""
    angle = rng.choice([0, 0.5, 1, rng.uniform(0, 4)]) * np.pi
    length = rng.choice([0.01, 1, 19.999, 20, 20.001, 25, 30, 100, rng.uniform(1, 60)])
    start = rng.choice([4, 4.001, 3.999, 0, size / 2, size - 4, size + 4], 2)
    parts = np.linspace(0, length, rng.integers(2, 7))
    return start + parts[:, None] * [np.cos(angle), np.sin(angle)]


def tiny(rng, size):
    return size / 2 + rng.normal(0, rng.choice([0.003, 0.03, 0.3, 3]), (rng.integers(2, 7), 2))


def far_away(rng, size):
    """Wholly or partly outside the map."""
    return wandering(rng, size) + rng.choice([-2, -1, -0.5, 0, 0.5, 1, 2], 2) * size


def there_and_back(rng, size):
    road = wandering(rng, size)
    return np.concatenate((road, road[-2::-1] + rng.choice([0, 0, 0.001, 4, 8])))


FAMILIES = (
    scattered, wandering, bending, bending, circling, on_a_lattice, straight, tiny, far_away,
    there_and_back,
)  # fmt: skip


def moved(points, rng):
    points[rng.integers(len(points))] += rng.normal(0, rng.choice([0.001, 0.1, 1, 5]), 2)
    return points


def dropped(points, rng):
    return np.delete(points, rng.integers(len(points)), axis=0) if len(points) > 2 else points


def revisited(points, rng):
    return np.concatenate((points, points[rng.integers(len(points))][None]))


def reversed_way(points, rng):
    return points[::-1]


def shifted(points, rng):
    return points + rng.choice([-100, -4, 0.5, 4, 100], 2)


def pushed_to_the_border(points, rng):
    """The lowest node to about half a road's width from the border."""
    return points - points.min(axis=0) + rng.choice([3.99, 4, 4.01, 4.1], 2)


def scaled(points, rng):
    return points.mean(axis=0) + (points - points.mean(axis=0)) * rng.choice([0.1, 0.5, 0.99, 1.01, 2])


def rounded(points, rng):
    return np.round(points, rng.integers(0, 3))


MUTATIONS = (moved, dropped, revisited, reversed_way, shifted, pushed_to_the_border, scaled, rounded)
