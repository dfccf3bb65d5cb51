"""The project's referee, an outside judge of roads: it measures what we measure, and judges every key of a
truth that people write down as we do.

What it said of some roads lies in ``data/``; where it is at hand itself, it is asked of many more.
"""

import json
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from outside_judge import SHARED, load_referee
from roadgpt.brief import read
from roadgpt.check.measures import LEAST_TURN, RoadMeasures, measure
from roadgpt.check.truth import Truth, holds
from roadgpt.design.designers.planner import Planner
from roadgpt.errors import RoadGPTError
from roadgpt.road import Design, Segment, World, build, read_design
from roadgpt_study.plan import read_prompts
from strategies import designs, sensible_briefs

FROZEN = [json.loads(line) for line in (Path(__file__).parent / "data" / "referee.jsonl").open("rb")]
planner = Planner()


@pytest.fixture(scope="module")
def referee() -> ModuleType:
    found = load_referee()
    if found is None:
        pytest.skip("the referee is not at hand")
    return found


def assert_same(ours: RoadMeasures, theirs: dict[str, Any], doubt: float = 1e-6) -> None:
    """Equal measures, but for a share of so much."""
    assert len(ours.features) == len(theirs["features"])
    for one, other in zip(ours.features, theirs["features"], strict=True):
        assert (one.kind, one.side) == (other["kind"], other["dir"])
        assert (one.start, one.end) == pytest.approx((other["a"], other["b"]), abs=doubt)
        assert one.radius == pytest.approx(other["radius"], rel=doubt)
        assert one.grade == pytest.approx(other["slope"], abs=doubt)
        if one.kind == "turn":
            assert one.degrees == pytest.approx(other["deg"], abs=doubt)
        else:
            ends = [(piece.start, piece.end) for piece in one.pieces]
            assert ends == [pytest.approx((piece["a"], piece["b"]), abs=doubt) for piece in other["pieces"]]
    assert (ours.lowest_grade, ours.highest_grade) == pytest.approx(theirs["g20"], abs=doubt)
    pairs = {
        "length": ours.length, "climb": ours.climb, "mean": ours.grade, "max_grade": ours.steepest,
        "min_radius": ours.radius, "turning": ours.turning, "hilly": ours.hills,
    }  # fmt: skip
    for key, value in pairs.items():
        assert value == pytest.approx(theirs[key], rel=doubt, abs=doubt), key


@pytest.mark.parametrize("number", range(len(FROZEN)))
def test_what_the_referee_said_of_some_roads(number: int) -> None:
    known = FROZEN[number]
    ours = measure(build(read_design(known["design"])[0]).centreline().round(4))
    assert_same(ours, known["measures"], doubt=2e-3)  # points are rounded, on another machine otherwise
    for row in known["truths"]:
        assert holds(ours, Truth.model_validate(given_keys(row["truth"]))) == row["holds"], row


# The last straight is level, falls and is level: it ends level, and as a whole hardly falls.
LEVEL_AT_LAST = Design(
    starting_point=(0, 0, 0),
    theta=0,
    segments=tuple(
        Segment(distance=long, direction="left" if turn else "straight", turn_degrees=turn, incline=incline)
        for long, turn, incline in ((15, 11, 0), (10, 0, 0), (10, 11, 0), (10, 0, 0), (10, 0, -2), (10, 0, 0))
    ),
)


@given(design=designs(), seed=st.integers(0, 10**6))
@example(design=LEVEL_AT_LAST, seed=65)
def test_random_segment_lists_are_measured_and_judged_alike(referee: ModuleType, design, seed) -> None:
    points = build(design).centreline()
    try:
        theirs = referee.measure(points)
    except IndexError:  # theirs, where the grade changes class at the very last metre
        return
    ours = measure(points)
    angles = [turn.degrees for turn in ours.turns] + [f["deg"] for f in theirs["features"] if f["deg"]]
    assume(all(abs(angle - LEAST_TURN) > 1e-6 for angle in angles))  # rounding decides whether it is a turn
    assert_same(ours, theirs)
    assert_judged_alike(referee, points, ours, seed)


@given(brief=sensible_briefs(), seed=st.integers(0, 10**6))
def test_designed_roads_are_measured_and_judged_alike(referee: ModuleType, brief, seed) -> None:
    points = build(planner.draft(brief, World(), (), (), seed)).centreline().round(4)
    assert_same(measure(points), referee.measure(points))
    assert_judged_alike(referee, points, measure(points), seed)


def assert_judged_alike(referee: ModuleType, points: Any, found: RoadMeasures, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(6):
        truth = drawn_truth(rng, found)
        assert holds(found, Truth.model_validate(truth)) == referee.check(points, truth)[0], truth


def test_of_the_keys_that_are_drawn_each_is_kept_and_broken() -> None:
    rng, said = np.random.default_rng(0), dict[str, set[bool]]()
    for seed in range(12):
        brief = read("two turns, then a straight")
        found = measure(build(planner.draft(brief, World(), (), (), seed)).centreline())
        for _ in range(10):
            for key, good in holds(found, Truth.model_validate(drawn_truth(rng, found))).items():
                said.setdefault(key, set()).add(good)
    assert {key for key, values in said.items() if len(values) < 2} <= {"hilly"}
    assert set(said) == set(Truth.model_fields)


def test_the_development_prompts_can_be_read_and_are_kept(referee: ModuleType) -> None:
    """Of nearly all of them all roads are right; what a road of other words breaks is told alike."""
    file = SHARED / "prompts" / "dev.jsonl"
    if not file.exists():
        pytest.skip("the prompts are not at hand")
    lines = [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]
    prompts = read_prompts(file)
    assert [prompt.prompt for prompt in prompts] == [line["prompt"] for line in lines]
    points = build(planner.draft(read("turn x3 | up", "plan"), World(), (), (), 1)).centreline()
    for prompt, line in zip(prompts, lines, strict=True):
        assert prompt.truth is not None
        assert holds(measure(points), prompt.truth) == referee.check(points, line["truth"])[0]
    perfect = [line["id"] for line in lines if all_right(line, referee)]
    assert len(perfect) >= 20, perfect


def all_right(prompt: dict[str, Any], referee: ModuleType) -> bool:
    """Whether three roads of a prompt keep its truth."""
    earlier: list[Design] = []
    try:
        brief = read(prompt["prompt"])
    except RoadGPTError:
        return False
    for seed in range(3):
        try:
            earlier.append(planner.draft(brief, World(), (), earlier, seed))
        except RoadGPTError:
            return False
        points = build(earlier[-1]).centreline().round(4)
        if not all(referee.check(points, prompt["truth"])[0].values()):
            return False
    return True


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


def given_keys(truth: dict[str, Any]) -> dict[str, Any]:
    """A truth without the keys that it leaves open."""
    wishes = [{key: value for key, value in wish.items() if value is not None} for wish in truth["sequence"]]
    return {**truth, "sequence": wishes}
