"""Quads of the ribbon: shapely measures the same gaps, and no near pair is missed."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.check.ribbon import gaps, is_convex, near_pairs, quads_of
from roadgpt.check.sbft import edges

seeds = st.integers(0, 2**32 - 1)


def winding_quads(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    heading = np.cumsum(rng.normal(0, 0.15, rng.integers(2, 120)))
    forward = np.stack((np.cos(heading), np.sin(heading)), axis=1)
    across = np.stack((-forward[:, 1], forward[:, 0]), axis=1) * 4
    centre = np.cumsum(forward, axis=0)
    return quads_of(centre + across, centre - across)


@given(seeds)
@settings(max_examples=40, deadline=None)
def test_gaps_have_the_sign_that_shapely_finds(seed: int) -> None:
    quads = winding_quads(seed)
    quads = quads[is_convex(quads)]
    i, j = np.triu_indices(len(quads), 1)
    found = gaps(quads, i, j)
    shapes = shapely.polygons(quads)
    distance, clear = shapely.distance(shapes[i], shapes[j]), np.abs(found) > 1e-9
    assert ((distance > 0) == (found > 0))[clear].all()
    assert (found <= distance + 1e-9).all()  # a separating axis never shows more than the distance
    deep = shapely.area(shapely.intersection(shapes[i], shapes[j]))
    assert ((deep > 0) == (found < 0))[clear].all()


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


@given(seeds)
@settings(max_examples=10, deadline=None)
def test_portions_of_a_long_ribbon_hold_all_its_pairs_in_driving_order(seed: int) -> None:
    rng = np.random.default_rng(seed)
    heading = np.cumsum(rng.normal(0, 0.06, 2000))
    centre = np.cumsum(np.stack((np.cos(heading), np.sin(heading)), axis=1), axis=0)
    quads = quads_of(centre + [0.0, 4.0], centre - [0.0, 4.0])
    low, high = quads.min(axis=1), quads.max(axis=1)
    meet = ((low[:, None] - 1 <= high) & (low - 1 <= high[:, None])).all(axis=2)
    wanted = np.argwhere(np.triu(meet, 5))
    portions = list(near_pairs(quads, 1.0, 5))
    found = np.concatenate([np.stack(pair, axis=1) for pair in portions])
    assert np.array_equal(found[np.lexsort(found.T[::-1])], wanted)
    ends = [j for _, j in portions if len(j)]
    assert all(one.max() < other.min() for one, other in pairwise(ends))


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


def test_a_quad_with_a_hole_in_its_numbers_is_not_convex() -> None:
    assert not is_convex(np.array([[[0, 4], [1, 4], [1, np.nan], [0, -4]]], float))[0]


def test_touching_quads_have_no_gap() -> None:
    square = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float)
    quads = np.stack([square, square + [1, 0], square + [1.5, 0.25], square + [3, 0]])
    assert gaps(quads, np.array([0, 1, 0]), np.array([1, 2, 3])) == pytest.approx([0, -0.5, 2])


def test_nodes_that_coincide_give_no_warning_and_no_edges() -> None:
    left, right = edges(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [2.0, 0.0]]))
    assert np.isnan(left[1]).all()
    assert np.isfinite(right[[0, 2]]).all()
