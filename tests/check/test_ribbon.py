"""Quads of the ribbon: no near pair is missed, and convex ones are valid."""

import numpy as np
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.check.ribbon import is_convex, near_pairs, quads_of

seeds = st.integers(0, 2**32 - 1)


def winding_quads(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    heading = np.cumsum(rng.normal(0, 0.15, rng.integers(2, 120)))
    forward = np.stack((np.cos(heading), np.sin(heading)), axis=1)
    across = np.stack((-forward[:, 1], forward[:, 0]), axis=1) * 4
    centre = np.cumsum(forward, axis=0)
    return quads_of(centre + across, centre - across)


@given(seeds, st.floats(0, 3), st.integers(2, 20))
@settings(max_examples=60, deadline=None)
def test_near_pairs_are_those_whose_boxes_come_near(seed: int, reach: float, apart: int) -> None:
    quads = winding_quads(seed)
    low, high = quads.min(axis=1), quads.max(axis=1)
    wanted = {
        (i, j)
        for i in range(len(quads))
        for j in range(i + apart, len(quads))
        if (low[i] - reach <= high[j]).all() and (low[j] - reach <= high[i]).all()
    }
    portions = list(near_pairs(quads, reach, apart))
    i, j = (np.concatenate(column) for column in zip(*portions, strict=True))
    assert len(i) == len(wanted)
    assert set(zip(i.tolist(), j.tolist(), strict=True)) == wanted


@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=4, max_size=4))
@settings(max_examples=300)
def test_convex_quads_are_valid_and_equal_their_hull(corners: list[tuple[int, int]]) -> None:
    quad = np.array([corners], float)
    shape = shapely.polygons(quad[0])
    is_clockwise_hull = (
        bool(shapely.is_valid(shape))
        and not shapely.is_ccw(shapely.get_exterior_ring(shape))
        and shapely.area(shape) == shapely.area(shapely.convex_hull(shape))
        and len(shapely.convex_hull(shape).exterior.coords) == 5
    )
    assert bool(is_convex(quad)[0]) == is_clockwise_hull
