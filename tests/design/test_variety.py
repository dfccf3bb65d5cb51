from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.brief.model import Brief, exactly
from roadgpt.design.designers.planner import Planner
from roadgpt.design.variety import ENOUGH, PlanShape, Shapes, apart, apart_by_metres, nearest, shape_of
from roadgpt.road import Design, World, read_design


def lines(seed: int, count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Random smooth lines: stations and points."""
    rng = np.random.default_rng(seed)
    out = []
    for _ in range(count):
        s = np.arange(0.0, rng.uniform(80, 300))
        heading = np.cumsum(np.convolve(rng.normal(0, 0.1, len(s)), np.ones(20) / 20, "same"))
        out.append((s, np.cumsum(np.exp(1j * heading))))
    return out


def stacked(shapes: list[PlanShape]) -> PlanShape:
    return PlanShape(*(np.array(column) for column in zip(*shapes, strict=True)))


def moved(z: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    z = z * np.exp(1j * rng.uniform(0, 6)) + complex(*rng.uniform(-90, 90, 2))
    return z.conj() if rng.random() < 0.5 else z


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_a_shifted_turned_mirrored_road_is_the_same(seed: int) -> None:
    ((s, z),) = lines(seed, 1)
    copy = moved(z, np.random.default_rng(seed))
    shapes = shape_of(s, z), stacked([shape_of(s, copy)])
    by_share, by_metres = apart(*shapes), apart_by_metres(*shapes)
    assert by_share[0] == pytest.approx(0, abs=1e-4)
    assert by_metres[0] == pytest.approx(0, abs=1e-4)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 10**6))
def test_a_road_that_only_goes_on_further_is_the_same_by_metres(seed: int) -> None:
    ((s, z),) = lines(seed, 1)
    half = len(s) // 2
    shapes = shape_of(s, z), stacked([shape_of(s[:half], z[:half])])
    by_share, by_metres = apart(*shapes), apart_by_metres(*shapes)
    assert by_metres[0] == pytest.approx(0, abs=1e-4)
    assert by_share[0] > 5


def test_a_campaign_never_repeats_itself() -> None:
    planner, earlier = Planner(), list[Design]()
    for seed in range(40):
        earlier.append(planner.draft(Brief(), World(), (), earlier, seed))
    shapes = Shapes().of(earlier)
    for i in range(1, len(earlier)):
        own = PlanShape(*(column[i] for column in shapes))
        before = PlanShape(*(column[:i] for column in shapes))
        by_share, by_metres = apart(own, before), apart_by_metres(own, before)
        assert by_share.min() > 5
        assert by_metres.min() > 5


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.booleans())
def test_the_nearest_is_found_among_few_of_many(seed: int, by_metres: bool) -> None:
    many = lines(seed, 40)
    rng = np.random.default_rng(seed)
    s, z = many[0]
    shapes = stacked([shape_of(*line) for line in many[1:]])
    own = shape_of(s, moved(z, rng) + rng.uniform(0, 6) * np.sin(s / rng.uniform(5, 40)))
    shapes = stacked([*(PlanShape(*(column[i] for column in shapes)) for i in range(39)), shape_of(s, z)])
    known = [apart(own, shapes).min(), *([apart_by_metres(own, shapes).min()] if by_metres else [])]
    found = nearest(own, shapes, by_metres)
    if min(known) < ENOUGH:
        assert found < ENOUGH
        assert found in known
    else:
        assert found == inf


def test_a_resumed_campaign_goes_on_as_it_would_have() -> None:
    planner, brief, earlier = Planner(), Brief(turns=exactly(2)), list[Design]()
    for seed in range(60):
        earlier.append(planner.draft(brief, World(), (), earlier, seed))
    for start in (20, 40, 59):
        read = [read_design(design.to_json())[0] for design in earlier[:start]]
        assert Planner().draft(brief, World(), (), read, start) == earlier[start]
    known = planner._shapes.of(earlier)
    for one, other in zip(known, Shapes().of(earlier), strict=True):
        assert np.array_equal(one, other)  # whether they were drafted here or read
