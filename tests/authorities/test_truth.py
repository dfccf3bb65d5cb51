"""Truths that people write down: every key is judged as the referee judges it, where it is at hand."""

import json
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from outside_judge import SHARED, load_referee
from roadgpt.check.measures import measure
from roadgpt.check.truth import Truth, holds
from roadgpt.design.designers.planner import Planner
from roadgpt.road import World, build
from roadgpt_study.plan import read_prompts
from strategies import designs, sensible_briefs

planner = Planner()


@pytest.fixture(scope="module")
def referee() -> ModuleType:
    found = load_referee()
    if found is None:
        pytest.skip("the referee is not at hand")
    return found


def drawn_truth(rng: np.random.Generator, found: Any) -> dict[str, Any]:
    """A truth with every key now and then, about a road that may or may not be like that."""

    def span(value: float, width: float) -> Any:
        low = round(value + rng.normal() * width, 2)
        kind = rng.integers(4)
        return [low, None] if kind == 0 else [None, low] if kind == 1 else [low - width, low + width]

    def wish(feature: Any = None) -> dict[str, Any]:
        kind = feature.kind if feature is not None else str(rng.choice(["turn", "straight"]))
        out: dict[str, Any] = {"kind": kind}
        if kind == "turn" and rng.random() < 0.4:
            out["dir"] = str(rng.choice(["left", "right"]))
        if rng.random() < 0.3:
            out["grade"] = str(rng.choice(["up", "down", "flat"]))
        if kind == "turn" and rng.random() < 0.3:
            out["deg"] = span(feature.degrees if feature is not None else 60, 20)
        if rng.random() < 0.2:
            out["len"] = span(feature.length if feature is not None else 40, 15)
        if kind == "turn" and rng.random() < 0.2:
            out["radius"] = span(feature.radius if feature is not None else 40, 15)
        return out

    def kept(features: Any) -> list[dict[str, Any]]:
        return [wish(f) for f in features if f.kind == "turn" or rng.random() < 0.4]

    turns = len(found.turns)
    every: dict[str, Any] = {
        "turns": turns if rng.random() < 0.5 else [int(rng.integers(0, 4)), None],
        "left": int(rng.integers(0, 3)),
        "right": [None, int(rng.integers(0, 4))],
        "grade": str(rng.choice(["up", "down", "flat"])),
        "sequence": kept(found.features) if rng.random() < 0.8 else [wish() for _ in range(rng.integers(4))],
        "ends": wish(),
        "starts": wish(),
        "alternating": True,
        "max_grade": span(found.steepest, 2),
        "climb": span(found.climb, 3),
        "length": span(found.length, 20),
        "hilly": int(rng.integers(0, 3)) if rng.random() < 0.5 else [0, 2],
        "min_radius": span(found.radius, 10),
        "turning": span(found.turning, 30),
    }
    return {key: value for key, value in every.items() if rng.random() < 0.7}


@settings(max_examples=60)
@given(design=designs(), seed=st.integers(0, 10**6))
def test_random_roads_are_judged_alike(referee: ModuleType, design, seed) -> None:
    assert_judged_alike(referee, build(design).centreline(), seed)


@settings(max_examples=60)
@given(brief=sensible_briefs(), seed=st.integers(0, 10**6))
def test_designed_roads_are_judged_alike(referee: ModuleType, brief, seed) -> None:
    points = build(planner.draft(brief, World(), (), (), seed)).centreline().round(4)
    assert_judged_alike(referee, points, seed)


def assert_judged_alike(referee: ModuleType, points: Any, seed: int) -> None:
    found, rng = measure(points), np.random.default_rng(seed)
    for _ in range(6):
        truth = drawn_truth(rng, found)
        try:
            theirs = referee.check(points, truth)[0]
        except IndexError:  # theirs, where the grade changes class at the very last metre
            return
        assert holds(found, Truth.model_validate(truth)) == theirs, truth


def test_both_verdicts_occur(referee: ModuleType) -> None:
    """Of the keys that are drawn, each is kept by some roads and broken by others."""
    rng, said = np.random.default_rng(0), dict[str, set[bool]]()
    for seed in range(12):
        from roadgpt.brief import read

        points = build(planner.draft(read("two turns, then a straight"), World(), (), (), seed)).centreline()
        found = measure(points)
        for _ in range(10):
            for key, good in holds(found, Truth.model_validate(drawn_truth(rng, found))).items():
                said.setdefault(key, set()).add(good)
    assert {key for key, values in said.items() if len(values) < 2} <= {"hilly"}
    assert set(said) == set(Truth.model_fields)


def test_the_development_prompts_can_be_read(referee: ModuleType) -> None:
    file = SHARED / "prompts" / "dev.jsonl"
    if not file.exists():
        pytest.skip("the prompts are not at hand")
    prompts = read_prompts(file)
    lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    assert [prompt.prompt for prompt in prompts] == [line["prompt"] for line in lines]
    points = build(planner.draft(sensible(), World(), (), (), 1)).centreline()
    found = measure(points)
    for prompt, line in zip(prompts, lines, strict=True):
        assert prompt.truth is not None
        assert holds(found, prompt.truth) == referee.check(points, line["truth"])[0]


def sensible() -> Any:
    from roadgpt.brief import read

    return read("turn x3 | up", "plan")
