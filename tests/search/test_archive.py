"""The map of a search, its choice of what is driven, and its pairs: each beside a slow way to the same."""

import math
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.brief.element import Element
from roadgpt_search.archive import (
    ANYWHERE,
    NOVELTY,
    Archive,
    select,
    spread_out,
)
from roadgpt_search.behaviour import bounds_of
from roadgpt_search.boundary_pairs import paired

MAPS = [
    (("MAX_CURV", "STD_SA"), 25),
    (("MAX_CURV", "DIR_COV", "CLIMB"), 7),
    (("LEFT",), 3),
    (("RADIUS_2", "DEGREES_1", "LENGTH", "TURNED"), 5),
]


@pytest.mark.parametrize(("axes", "cells"), MAPS)
def test_it_has_the_cells_and_the_elites_of_pyribs(axes: tuple[str, ...], cells: int) -> None:
    """Solutions at random, many of them beyond the map or on an edge of a cell, and many of equal quality."""
    from ribs.archives import GridArchive  # takes seconds

    ranges = [bounds_of(axis) for axis in axes]
    theirs = GridArchive(solution_dim=1, dims=[cells] * len(axes), ranges=ranges)
    ours = Archive(axes, cells)
    rng = np.random.default_rng(11)
    low, high = np.array(ranges).T
    places = low + rng.uniform(-0.2, 1.2, (1000, len(axes))) * (high - low)
    edges = low + rng.integers(0, cells + 1, (200, len(axes))) / cells * (high - low)
    places = np.concatenate([places, np.minimum(edges, high)])
    assert np.array_equal(ours.cells(places), theirs.index_of(places))
    quality = rng.integers(-6, 3, len(places)) / 2
    for number, (place, one) in enumerate(zip(places, quality, strict=True)):
        ours.add(number, dict(zip(axes, place, strict=True)), float(one), bool(one > 0))
        theirs.add_single([float(number)], one, place)
    kept = theirs.data(["index", "solution"], return_type="dict")
    assert ours.elites() == [int(n) for n in kept["solution"][np.argsort(kept["index"]), 0]]
    assert len(ours.elites()) > min(20, cells - 1)


@settings(max_examples=15)
@given(st.integers(1, 12), st.integers(1, 9), st.integers(0, 99), st.sampled_from(["failures", "coverage"]))
def test_what_is_driven_is_what_a_slow_choice_would_drive(n: int, wanted: int, seed: int, goal: str) -> None:
    rng = np.random.default_rng(seed)
    trees = 5
    cells = rng.integers(0, 4, (trees, n)), rng.integers(0, 3, (trees, n))
    margins = rng.normal(0.2, 0.5, (trees, n))
    counts = Counter({0: 3, 1: 1}), Counter({2: 2})
    found = select(goal, wanted, margins, cells, [Counter(one) for one in counts])  # type: ignore[arg-type]
    known = [{cell: float(one[cell]) for cell in range(4)} for one in counts]
    left, slow = list(range(n)), []
    while len(slow) < wanted and left:

        def worth(i: int) -> float:
            total, chances, plain = 0.0, 0.0, 0.0
            for tree in range(trees):
                weight = 1.0 if goal == "coverage" else float(margins[tree, i] <= 0)
                floor = 0.0 if goal == "coverage" else ANYWHERE
                new = [
                    1 / (1 + its[int(own[tree, i])]) ** NOVELTY for its, own in zip(known, cells, strict=True)
                ]
                total += weight * (floor + sum(new) / 2)
                chances += weight / trees
                plain += sum(new) / 2 / trees
            if goal == "failures" and len(slow) in (3, 7):  # the fourth and the eighth explore
                return round(math.sqrt(max(chances, 0.5 / trees)) * plain, 12)
            return round(total / trees, 12)

        # of equal worth either may come first, as rounding has it
        best = max(left, key=lambda i: (worth(i), found[len(slow) :][:1] == [i], -i))
        slow.append(best)
        for tree in range(trees):
            weight = 1.0 if goal == "coverage" else float(margins[tree, best] <= 0)
            for its, own in zip(known, cells, strict=True):
                its[int(own[tree, best])] += weight / trees
        left = [i for i in left if i != best]
    assert found == slow


@given(st.integers(1, 15), st.integers(1, 20), st.integers(0, 50))
def test_what_is_spread_comes_from_the_harder_half(n: int, wanted: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    hazard = rng.random(n)
    found = spread_out([*rng.random((n, 4))], wanted, hazard)
    assert len(found) == min(n, wanted)
    assert len(set(found)) == len(found)
    ranks = [int((hazard > hazard[i]).sum()) for i in found]
    assert max(ranks) < max(wanted, math.ceil(n / 2))
    assert min(ranks) == 0


LENGTHS = st.floats(1, 60)


@settings(max_examples=50)
@given(st.lists(st.tuples(LENGTHS, st.floats(15, 40), st.booleans(), st.booleans()), min_size=1, max_size=9))
def test_pairs_are_the_nearest_relatives(roads: list) -> None:
    elements = {
        number: (
            Element(straight=length),
            Element(turn=40.0 if left else -40.0, radius=radius, transition=4.0),
        )
        for number, (length, radius, left, _) in enumerate(roads, 1)
    }
    kept = [number for number, road in enumerate(roads, 1) if road[3]]
    lost = [number for number, road in enumerate(roads, 1) if not road[3]]
    found = paired(elements, kept, lost)
    rest = {(a, b) for a in kept for b in lost if roads[a - 1][2] == roads[b - 1][2]}
    for pair in found:
        nearest = min(
            math.hypot((roads[a - 1][0] - roads[b - 1][0]) / 10, (roads[a - 1][1] - roads[b - 1][1]) / 2)
            for a, b in rest
        )
        assert pair.distance == pytest.approx(nearest)
        rest = {(a, b) for a, b in rest if a != pair.kept and b != pair.lost}
    assert not rest
