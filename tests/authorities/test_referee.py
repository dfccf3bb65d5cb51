"""The project's referee, an outside judge of roads: it measures what we measure.

What it said of some roads lies in ``data/``; where it is at hand itself, it is asked of many more.
"""

import importlib.util
import json
import sys
from math import inf
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from roadgpt.brief.outline import Feature, Group, Outline
from roadgpt.brief.ranges import Range
from roadgpt.check.measures import LEAST_TURN, Measures, measure
from roadgpt.check.rules.promises import complaints
from roadgpt.design.designers.planner import Planner
from roadgpt.road import World, build, read_design
from strategies import designs, sensible_briefs

REFEREE = Path(__file__).resolve().parents[3] / "shared" / "referee.py"
FROZEN = [json.loads(line) for line in (Path(__file__).parent / "data" / "referee.jsonl").open("rb")]
GRADES = {"up": Range(1, inf), "down": Range(-inf, -1), "flat": Range(-0.999999, 0.999999)}
planner = Planner()


@pytest.fixture(scope="module")
def referee() -> ModuleType:
    if not REFEREE.exists():
        pytest.skip("the referee is not at hand")
    return load_referee()


def load_referee() -> ModuleType:
    spec = importlib.util.spec_from_file_location("referee", REFEREE)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules["referee"] = module
    spec.loader.exec_module(module)
    return module


def assert_same(ours: Measures, theirs: dict[str, Any], doubt: float = 1e-6) -> None:
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
        "length": ours.length,
        "climb": ours.climb,
        "mean": ours.grade,
        "max_grade": ours.steepest,
        "min_radius": ours.radius,
        "turning": ours.turning,
        "hilly": ours.hills,
    }
    for key, value in pairs.items():
        assert value == pytest.approx(theirs[key], rel=doubt, abs=doubt), key


@pytest.mark.parametrize("number", range(len(FROZEN)))
def test_what_the_referee_said_of_some_roads(number: int) -> None:
    known = FROZEN[number]
    ours = measure(build(read_design(known["design"])[0]).centreline().round(4))
    assert_same(ours, known["measures"], doubt=2e-3)  # points are rounded, on another machine otherwise
    for row in known["truths"]:
        assert (not complaints(ours, outline_of(row["truth"]))) == all(row["holds"].values()), row


def test_the_referee_said_yes_and_no() -> None:
    said = [all(row["holds"].values()) for known in FROZEN for row in known["truths"]]
    assert min(said.count(True), said.count(False)) > 30


@settings(max_examples=150, deadline=None)
@given(design=designs())
def test_random_segment_lists_measure_alike(referee: ModuleType, design) -> None:
    points = build(design).centreline()
    try:
        theirs = referee.measure(points)
    except IndexError:  # theirs, where the grade changes class at the very last metre
        return
    ours = measure(points)
    angles = [turn.degrees for turn in ours.turns] + [f["deg"] for f in theirs["features"] if f["deg"]]
    assume(all(abs(angle - LEAST_TURN) > 1e-6 for angle in angles))  # rounding decides whether it is a turn
    assert_same(ours, theirs)


@settings(max_examples=100, deadline=None)
@given(brief=sensible_briefs(), seed=st.integers(0, 10**6))
def test_designed_roads_measure_alike_and_are_judged_alike(referee: ModuleType, brief, seed) -> None:
    points = build(planner.draft(brief, World(), (), (), seed)).centreline().round(4)
    ours = measure(points)
    assert_same(ours, referee.measure(points))
    rng = np.random.default_rng(seed)
    for _ in range(4):
        truth = altered_truth(ours, rng)
        kept = not complaints(ours, outline_of(truth))
        assert kept == all(referee.check(points, truth)[0].values()), truth


def truth_of(ours: Measures, rng: np.random.Generator) -> dict[str, Any]:
    """What a person who looks at the road might have asked for."""
    sequence = []
    for feature in ours.features:
        straight = feature.kind == "straight"
        if straight and rng.random() < 0.5:
            continue
        shown = rng.choice(feature.pieces) if straight else feature
        wish: dict[str, Any] = {"kind": feature.kind}
        if rng.random() < 0.5:
            wish["grade"] = "up" if shown.grade >= 1 else "down" if shown.grade <= -1 else "flat"
        if rng.random() < 0.5:
            wish["len"] = [shown.length - 5, shown.length + 5]
        if not straight and rng.random() < 0.7:
            wish["dir"] = feature.side
        if not straight and rng.random() < 0.5:
            wish["deg"] = [feature.degrees - 5, None]
        sequence.append(wish)
    truth: dict[str, Any] = {"sequence": sequence, "turns": len(ours.turns), "left": ours.count("left")}
    truth["length"] = [ours.length - 10, ours.length + 10]
    truth["hilly"] = ours.hills
    return truth


def altered_truth(ours: Measures, rng: np.random.Generator) -> dict[str, Any]:
    """The same, with something in it that may no longer be so."""
    truth = truth_of(ours, rng)
    sequence = truth["sequence"]
    wish = sequence[rng.integers(len(sequence))] if sequence else {}
    match rng.integers(8):
        case 0:
            truth["turns"] = [0, len(ours.turns) + int(rng.integers(-1, 2))]
        case 1:
            wish["dir" if wish.get("kind") == "turn" else "len"] = (
                "left" if wish.get("dir") == "right" else None
            )
            wish = {key: value for key, value in wish.items() if value is not None}
            sequence[:] = [{k: v for k, v in w.items() if v is not None} for w in sequence]
        case 2 if wish:
            wish["grade"] = str(rng.choice(["up", "down", "flat"]))
        case 3 if wish:
            wish["len"] = [float(rng.uniform(10, 60)), None]
        case 4:
            truth["grade"] = str(rng.choice(["up", "down", "flat"]))
        case 5:
            truth["ends"] = {"kind": "turn", "dir": "left"}
        case 6:
            truth["starts"] = {"kind": "straight", "len": [float(rng.uniform(10, 60)), None]}
        case 7:
            truth["alternating"] = True
    return truth


def range_of(value: Any) -> Range | None:
    if value is None:
        return None
    low, high = value if isinstance(value, list) else (value, value)
    return Range(-inf if low is None else low, inf if high is None else high)


def feature_of(wish: dict[str, Any]) -> Feature:
    return Feature(
        wish["kind"],
        wish["kind"],
        side=wish.get("dir"),
        degrees=range_of(wish.get("deg")),
        length=range_of(wish.get("len")),
        grade=GRADES.get(wish.get("grade", "")),
    )


def outline_of(truth: dict[str, Any]) -> Outline:
    return Outline(
        groups=tuple(Group(feature_of(wish)) for wish in truth["sequence"]),
        turns=range_of(truth["turns"]) or Range(),
        left=range_of(truth["left"]) or Range(),
        alternating=truth.get("alternating", False),
        grade=truth.get("grade"),
        hills=Range(truth["hilly"], inf),
        length=range_of(truth["length"]),
        starts=feature_of(truth["starts"]) if "starts" in truth else None,
        ends=feature_of(truth["ends"]) if "ends" in truth else None,
    )
