"""The project's referee, an outside judge of roads: it measures what we measure.

What it said of some roads lies in ``data/``; where it is at hand itself, it is asked of many more.
"""

import json
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from outside_judge import load_referee
from roadgpt.check.measures import LEAST_TURN, Measures, measure
from roadgpt.check.truth import Truth, holds
from roadgpt.design.designers.planner import Planner
from roadgpt.road import World, build, read_design
from strategies import designs, sensible_briefs

FROZEN = [json.loads(line) for line in (Path(__file__).parent / "data" / "referee.jsonl").open("rb")]
planner = Planner()


@pytest.fixture(scope="module")
def referee() -> ModuleType:
    found = load_referee()
    if found is None:
        pytest.skip("the referee is not at hand")
    return found


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


@settings(max_examples=60, deadline=None)
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


@settings(max_examples=60, deadline=None)
@given(brief=sensible_briefs(), seed=st.integers(0, 10**6))
def test_designed_roads_measure_alike(referee: ModuleType, brief, seed) -> None:
    points = build(planner.draft(brief, World(), (), (), seed)).centreline().round(4)
    assert_same(measure(points), referee.measure(points))


def given_keys(truth: dict[str, Any]) -> dict[str, Any]:
    """A truth without the keys that it leaves open."""
    wishes = [{key: value for key, value in wish.items() if value is not None} for wish in truth["sequence"]]
    return {**truth, "sequence": wishes}
