"""Sketches say beforehand what is then measured on the road that is built."""

from functools import cache

import numpy as np
import pytest

from campaign.quick import features_of_road
from roadgpt.brief import read
from roadgpt.design import draft
from roadgpt.geometry import interpolate
from roadgpt.road import Design, Road, Site, World, build
from roadgpt.run import prove
from roadgpt.run.execution import features_of
from roadgpt_search.behaviour import behaviour_of
from roadgpt_search.surrogate import NAMES, STEERING
from roadgpt_search.variation import (
    Kind,
    Sketch,
    VariationContext,
    VariationTask,
    candidate_of,
    sketch,
    sketch_of,
)

WORLD = World(site=Site(map_size=200.0, z_floor=0.0))
PLANS = ("| flat turns=1..", "turn x3 | up", "serpentine")
AXES = ("MAX_CURV", "STD_SA", "DIR_COV", "TURNED", "LENGTH")


@cache
def setting(line: str) -> VariationContext:
    return VariationContext(read(line, reader="plan"), WORLD, "sbft", AXES)


@cache
def parents(line: str) -> tuple[Design, ...]:
    brief = setting(line).brief
    assert brief is not None
    return tuple(draft(brief, WORLD, seed=seed) for seed in range(4))


def sketched(line: str, kind: Kind, seed: int) -> Sketch | None:
    own = parents(line)[: {"vary": 1, "cross": 2}.get(kind, 0)]
    return sketch(VariationTask(kind, own, kind, (seed,), setting(line)))


@pytest.mark.parametrize("kind", ["vary", "cross", "wild"])
def test_a_sketch_says_what_the_built_road_has(kind: Kind) -> None:
    """The measures of the built road come from exact curves that are sampled anew. One sketch in 25 may
    be further off: where a bend begins just where the car is no longer slow, it counts whole or in part.
    """
    agree = []
    for seed in range(100):
        one = sketched(PLANS[0], kind, seed)
        made = candidate_of((one, setting(PLANS[0]))) if one else None
        if one is None or made is None:
            continue
        road = build(made.design)
        measured = features_of(road.sample().points) | behaviour_of(road, None)
        assert set(one.features) == {"MAX_CURV", "DIR_COV", "TURNED", "LENGTH"}
        assert one.features["LENGTH"] == pytest.approx(measured["LENGTH"], abs=0.5)
        assert one.features["DIR_COV"] == pytest.approx(measured["DIR_COV"], abs=1.5 / 26)
        assert one.features["TURNED"] == pytest.approx(measured["TURNED"], abs=8)
        seen, real = one.surrogate_features, features_of_road(road, WORLD)
        steers_alike = seen[STEERING[0]] == pytest.approx(real[STEERING[0]], rel=0.05, abs=0.02)
        curvatures = [
            i for i, name in enumerate(NAMES) if name.startswith(("left_", "right_", "mean", "root"))
        ]
        apart = np.sort(np.abs(seen[curvatures] - real[curvatures]))
        is_as_tight = one.features["MAX_CURV"] == pytest.approx(measured["MAX_CURV"], rel=0.03, abs=0.001)
        agree.append(is_as_tight and steers_alike and apart[-3] < 0.06 and apart[-1] < 0.3)
    assert len(agree) >= 50
    assert np.mean(agree) >= 0.96


def test_for_the_competition_a_sketch_has_the_curvature_of_the_spline() -> None:
    """Where the curvature changes at once, the spline that is driven is tighter than the road."""
    official = setting(PLANS[0])._replace(is_interpolated=True)
    missed, tighter = [], []
    for seed in range(24):
        one = sketched(PLANS[0], "wild", seed)
        made = candidate_of((one, official)) if one else None
        if made is None:
            continue
        road = build(made.design)
        driven = features_of(interpolate(road.control_points()))
        seen = sketch_of((made.design, official))[0].features
        assert seen["DIR_COV"] == pytest.approx(driven["DIR_COV"], abs=1.5 / 26)
        missed.append(abs(seen["MAX_CURV"] - driven["MAX_CURV"]))
        tighter.append(driven["MAX_CURV"] - features_of(road.sample().points)["MAX_CURV"])
    assert np.quantile(missed, 0.9) < 0.0014  # half of a cell of the feature map
    assert max(tighter) > 0.001


def test_the_steering_of_a_sketch_is_nearly_that_of_the_drive() -> None:
    """In proportion, on roads that the car drives to their end, and whose curvature often changes at once."""
    found = []
    for seed in range(15):
        one = sketched(PLANS[0], "wild", seed)
        made = candidate_of((one, setting(PLANS[0]))) if one else None
        if one and made:
            run = prove(build(made.design), 0, WORLD)
            if run.outcome == "PASS":
                found.append((one.surrogate_features[STEERING[0]], steering(run.road, run.drive)))
    assert len(found) >= 6
    assert np.corrcoef(np.array(found).T)[0, 1] > 0.7


def steering(road: Road | None, drive: object) -> float:
    """Standard deviation of the front wheels' angle, from the drive alone."""
    assert road is not None
    return float(np.std(np.array(drive["steer"])))  # type: ignore[index]
