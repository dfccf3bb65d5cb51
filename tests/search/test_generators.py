"""Searches ask for the same whatever happened to them, keep the Brief, and find more than drafts do.

Nobody drives here: the margin is a law of the road's curvature, known to the test and not to the search.
"""

from collections.abc import Callable, Sequence
from functools import cache
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from roadgpt import check, plugins
from roadgpt.brief import read
from roadgpt.brief.model import Brief
from roadgpt.campaign import Cell, CellBudget, Goal, Proposal, Result
from roadgpt.campaign.columns import cell_of
from roadgpt.design import draft
from roadgpt.design.elements import elements_of
from roadgpt.errors import UsageError
from roadgpt.road import Design, Site, World, build
from roadgpt.run import Request, Setup
from roadgpt.run.execution import features_of
from roadgpt_search.behaviour import BOUNDS, behaviour_of
from roadgpt_search.boundary_pairs import distance, pairs_of

WORLD = World(site=Site(map_size=200))
SMALL = {"batch": 5}
FEW = {"batch": 5, "candidates": 2}
SEARCHES = ("random", "genetic", "quality_diversity")
UPHILL = "turn x3 | up"
FLAT = "| flat turns=1.."


class Here:
    def map(self, function: Callable[[Any], Any], items: Sequence[Any]) -> list[Any]:
        return [function(item) for item in items]


class Backwards(Here):
    """Workers that end in another order."""

    def map(self, function: Callable[[Any], Any], items: Sequence[Any]) -> list[Any]:
        return [function(item) for item in reversed(items)][::-1]


@cache
def brief_of(words: str) -> Brief:
    return read(words, reader="plan")


def cell_for(
    generator: str, words: str = UPHILL, goal: Goal = "failures", seed: int = 1, **settings: Any
) -> Cell:
    usual = FEW if generator == "quality_diversity" else SMALL
    request = Request(words=words, seed=seed, world=WORLD, setup=Setup(reader="plan"))
    brief = brief_of(words) if words else None
    return Cell("c01", request, brief, generator, goal, usual | settings, CellBudget(tests=100))


def driven(cell: Cell, proposal: Proposal, number: int, batch: int) -> Result:
    """The car fails where the road's right turns are tight for 10 m and more."""
    design = proposal.design or draft(cell.brief or Brief(), WORLD, seed=proposal.seed)
    road = build(design)
    bend = road.sample().curvature
    tight = -np.convolve(bend, np.full(11, 1 / 11), "same").min()
    margin = float(1.2 - 24 * tight)
    features = features_of(road.centreline()) | behaviour_of(road, cell.brief)
    features["STD_SA"] = float(1500 * np.sqrt((bend**2).mean()))
    outcome = "FAIL" if margin <= 0 else "PASS"
    return Result(
        number, batch, proposal, outcome, "", design, road.length, max(margin, -0.001), features=features
    )  # type: ignore[arg-type]


def searched(cell: Cell, batches: int, pool: Any = None) -> tuple[list[Result], list[list[Proposal]]]:
    """A campaign of so many batches: a batch is thought out before the one before it is known."""
    generator = plugins.find("generators", cell.generator)(cell)
    results: list[list[Result]] = []
    asked: list[list[Proposal]] = []
    number = 1
    for batch in range(batches):
        if batch >= 2:
            generator.tell(results[batch - 2])
        asked.append(generator.ask(batch, number, generator.batch_size, pool or Here()))
        results.append([driven(cell, one, at, batch) for at, one in enumerate(asked[-1], number)])
        number += len(asked[-1])
    return [result for batch in results for result in batch], asked


@cache
def known(name: str, words: str, goal: Goal, batches: int) -> tuple[list[Result], list[list[Proposal]]]:
    """What a search finds that several tests look at."""
    return searched(cell_for(name, words, goal), batches)


@pytest.mark.parametrize("name", SEARCHES)
def test_the_same_seed_asks_for_the_same_and_another_for_something_else(name: str) -> None:
    _, one = known(name, UPHILL, "failures", 5)
    _, again = searched(cell_for(name), 3, Backwards())
    assert one[:3] == again
    _, other = searched(cell_for(name, seed=2), 1)
    designs = [[proposal.design for proposal in batch] for batch in (*one, *other)]
    assert all(this != that for this, that in combinations(designs, 2))
    assert all(len(batch) == 5 for batch in one)


@pytest.mark.parametrize(
    ("name", "goal"),
    [("random", "failures"), ("genetic", "hardest")]
    + [("quality_diversity", goal) for goal in ("failures", "boundary")],
)
def test_told_again_it_goes_on_as_if_nothing_had_happened(name: str, goal: Goal) -> None:
    """What the campaign does after a crash: a new generator hears the old results, and was never asked."""
    cell = cell_for(name, goal=goal)
    results, asked = known(name, UPHILL, goal, 5)
    fresh = plugins.find("generators", name)(cell)
    for batch in range(3):
        fresh.tell([result for result in results if result.batch == batch])
    first = next(result.number for result in results if result.batch == 4)
    assert fresh.ask(4, first, 5, Here()) == asked[4]


@pytest.mark.parametrize("name", SEARCHES)
def test_every_road_that_is_asked_for_keeps_the_brief(name: str) -> None:
    for words in (UPHILL, FLAT):
        cell = cell_for(name, words)
        _, asked = known(name, words, "failures", 5 if words == UPHILL else 6)
        for proposal in (one for batch in asked[:3] for one in batch if one.design):
            assert proposal.design is not None
            road = build(proposal.design)
            assert not check.inspect(road, cell.brief, WORLD)
            heights = road.centreline()[:, 2]
            if words == UPHILL:
                assert heights[-1] > heights[0]
            else:
                assert np.ptp(heights) < 0.011 * road.length


def test_a_search_finds_more_failures_in_more_cells_than_drafts_do() -> None:
    found = {}
    for name in SEARCHES:
        results, _ = known(name, FLAT, "failures", 6)
        cells = {cell_of(r.features, ("MAX_CURV", "STD_SA"), 25, BOUNDS) for r in results if r.failed}
        found[name] = sum(result.failed for result in results), len(cells)
    assert found["quality_diversity"][0] > 2 * found["random"][0]
    assert found["quality_diversity"][1] > 1.5 * found["random"][1]
    assert found["genetic"][0] > found["random"][0]


def test_no_road_is_like_one_that_it_was_told_of() -> None:
    least = 8.0
    _, asked = searched(cell_for("quality_diversity", FLAT, apart=least, candidates=4), 5)
    shapes = [[plan_of(one.design) for one in batch if one.design] for batch in asked]
    assert sum(map(len, shapes)) > 20
    for batch, own in enumerate(shapes[2:], 2):
        known = [shape for told in shapes[: batch - 1] for shape in told]
        for number, shape in enumerate(own):
            for other in known + own[:number]:
                assert best_fit(shape, other) >= least - 0.3


def plan_of(design: Design) -> np.ndarray:
    """Points at equal shares of the length, around their centre."""
    road = build(design)
    plan = road.at(np.linspace(0, road.length, 80))[:, :2]
    return np.asarray(plan - plan.mean(axis=0))


def best_fit(one: np.ndarray, other: np.ndarray) -> float:
    """RMS distance in metres under the best of 180 turns, mirrored or not."""
    angles = np.radians(np.arange(0, 360, 2))
    turned = np.stack([np.cos(angles), -np.sin(angles), np.sin(angles), np.cos(angles)], axis=1).reshape(
        -1, 2, 2
    )
    both = (one, one * [1, -1])
    return min(float(np.sqrt((((a @ turned) - other) ** 2).sum(axis=2).mean(axis=1)).min()) for a in both)


def test_the_boundary_is_closed_in_on() -> None:
    cell = cell_for("quality_diversity", FLAT, goal="boundary", seed=5, batch=6, candidates=4)
    results, _ = searched(cell, 8)
    between = [result for result in results if result.proposal.origin.startswith("between")]
    assert between
    early = pairs_of([result for result in results if not result.proposal.origin.startswith("between")])
    pairs = pairs_of(results)
    assert pairs[0].distance < 0.7 * early[0].distance
    by_number = {result.number: result for result in results}
    kept, lost = by_number[pairs[0].kept], by_number[pairs[0].lost]
    assert (kept.outcome, lost.outcome) == ("PASS", "FAIL")
    assert kept.design is not None
    assert lost.design is not None
    assert pairs[0].distance == distance(elements_of(kept.design.segments), elements_of(lost.design.segments))


def test_coverage_fills_the_map_faster_than_failures_do() -> None:
    reached = {}
    goals: tuple[Goal, ...] = ("coverage", "failures")
    for goal in goals:
        results, _ = known("quality_diversity", FLAT, goal, 6)
        reached[goal] = len({cell_of(r.features, ("MAX_CURV", "STD_SA"), 25, BOUNDS) for r in results})
    assert reached["coverage"] > reached["failures"]


def test_other_axes_can_be_asked_for() -> None:
    axes = ("RADIUS_1", "RADIUS_2", "LENGTH")
    cell = cell_for("quality_diversity", axes=list(axes), cells=50)
    results, asked = searched(cell, 4)
    assert len(asked[3]) == 5
    assert all(axis in result.features for axis in axes for result in results)


def test_tests_without_words_are_searched_too() -> None:
    for name in SEARCHES:
        _, asked = searched(cell_for(name, "", batch=3), 3)
        assert all(one.design is not None for batch in asked for one in batch)


def test_results_that_came_to_nothing_do_no_harm() -> None:
    cell = cell_for("quality_diversity")
    generator = plugins.find("generators", cell.generator)(cell)
    results = known("quality_diversity", UPHILL, "failures", 5)[0][:5]
    lost = [Result(r.number, 0, r.proposal, "ERROR", "it broke") for r in results]
    generator.tell(lost)
    assert len(generator.ask(2, 11, 5, Here())) == 5
    assert len(generator.ask(3, 16, 2, Here())) == 2


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"axes": ["HEIGHT"]}, "no feature 'HEIGHT'"),
        ({"cells": 1}, "cells"),
        ({"batch": 0}, "batch"),
        ({"axis": ["MAX_CURV"]}, "is unknown; there are batch, axes, also, cells"),
        ({"archive": "cvt"}, "'archive' of the generator .* is unknown"),
    ],
)
@pytest.mark.parametrize("name", SEARCHES)
def test_settings_that_cannot_be_are_told_of(name: str, settings: dict[str, Any], said: str) -> None:
    """By every search: a plan has one table of settings for all its generators."""
    with pytest.raises(UsageError, match=said):
        plugins.find("generators", name)(cell_for(name, **settings))


def test_splines_are_not_searched() -> None:
    cell = cell_for("genetic")
    setup = Setup(reader="plan", geometry="spline")
    request = cell.request.model_copy(update={"setup": setup})
    with pytest.raises(UsageError, match="arcs"):
        plugins.find("generators", "genetic")(Cell("c01", request, cell.brief, "genetic", "failures"))
