"""Repair: proposed roads become valid, and stay what was proposed."""

import math
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from authorities import roadgpt_checks
from llm_like import random_lists
from roadgpt import check
from roadgpt.brief.model import Brief, Clause, exactly
from roadgpt.brief.readers.plan import PlanReader
from roadgpt.check.measures import measure
from roadgpt.design import draft
from roadgpt.design.repair import Repaired, repair
from roadgpt.road import Design, Segment, World, build, read_design
from strategies import designs, worlds

WORLD = World()
read = PlanReader().read


def road_of(*segments: tuple, start=(125.0, 125.0, 0.0), theta=0.0) -> Design:
    """Segments as (metres, degrees, percent)."""
    sides = {1: "left", -1: "right", 0: "straight"}
    made = [
        Segment(distance=d, turn_degrees=t, incline=g, direction=sides[int(np.sign(t))])
        for d, t, g in segments
    ]
    return Design(starting_point=start, theta=theta, segments=tuple(made))


def grade_class(percent: float) -> str:
    return "up" if percent >= 1 else "down" if percent <= -1 else "flat"


def proposed_turns(design: Design) -> list[tuple[str, str]]:
    """Side and slope of every turn that the list proposes, told by the list alone."""
    out = []
    for hand, group in groupby(design.segments, key=lambda segment: np.sign(segment.turn_degrees)):
        own = list(group)
        if hand and abs(sum(s.turn_degrees for s in own)) >= 10:
            mean = sum(s.distance * s.incline for s in own) / sum(s.distance for s in own)
            out.append(("left" if hand > 0 else "right", grade_class(mean)))
    return out


def shown_turns(design: Design) -> list[tuple[str | None, str]]:
    """The same, measured on the finished road."""
    found = measure(build(design).centreline())
    return [(turn.side, grade_class(turn.grade)) for turn in found.turns]


def is_valid(design: Design, brief: Brief | None = None, world: World = WORLD) -> bool:
    return check.inspect(build(design), brief, world) == ()


def test_roadgpt_s_own_checks_accept_a_quarter_to_a_third_of_the_random_lists() -> None:
    accepted = sum(not roadgpt_checks.verdict(each) for each in random_lists(120, seed=1))
    assert 0.25 <= accepted / 120 <= 0.35


def test_roadgpt_s_checks_have_the_faults_that_are_known_of_them() -> None:
    sharp = road_of((30, 70, 0), (30, 70, 0), (30, 70, 0), start=(120.0, 120.0, 0.0)).to_json()
    assert roadgpt_checks.verdict(sharp) == ""  # five nodes: never looked at
    assert check.sbft_verdict(np.array(roadgpt_checks.nodes_of(sharp))[:, :2], 250) == (
        False,
        "The road is too sharp",
    )
    assert roadgpt_checks.verdict(road_of((120, 0, -60), start=(50.0, 50.0, 90.0)).to_json()) == ""
    assert roadgpt_checks.verdict(road_of((120, 0, 60), start=(50.0, 50.0, 0.0)).to_json()) == "steep"


def test_random_lists_become_valid_and_stay_what_was_proposed() -> None:
    lengths, angles, right = [], [], 0
    lists = [read_design(each)[0] for each in random_lists(50, seed=4)]
    for proposed in lists:
        design = repair(proposed, None, WORLD, "full").design
        right += is_valid(design) and shown_turns(design) == proposed_turns(proposed)
        for one, other in zip(proposed.segments, design.segments, strict=True):
            lengths.append(abs(other.distance / one.distance - 1))
            if one.turn_degrees:
                angles.append(abs(other.turn_degrees / one.turn_degrees - 1))
            assert np.sign(other.turn_degrees) == np.sign(one.turn_degrees)
            assert other.direction == one.direction
            assert grade_class(other.incline) == grade_class(one.incline)
    assert right >= 0.95 * len(lists)
    assert np.median(lengths) <= 0.20
    assert np.median(angles) <= 0.15


def test_each_way_of_repairing_does_more_than_the_one_before() -> None:
    lists = [read_design(each)[0] for each in random_lists(15, seed=9)]
    valid = [sum(is_valid(repair(each, None, WORLD, how).design) for each in lists) for how in HOWS]
    assert valid[0] < valid[1] < valid[2]


HOWS = ("none", "place", "full")


@pytest.mark.parametrize("how", HOWS)
def test_what_is_right_already_comes_back_as_it_is(how: str) -> None:
    brief = read("turn x3 | up")
    for seed in range(5):
        design = draft(brief, WORLD, seed=seed)
        assert repair(design, brief, WORLD, how) == Repaired(design, ())


@settings(max_examples=settings.default.max_examples // 4, deadline=None)
@given(designs(), worlds(), st.sampled_from(HOWS))
def test_any_list_comes_back_as_a_road_with_its_changes_told(design: Design, world: World, how: str) -> None:
    after, changes = repair(design, None, world, how)
    assert bool(changes) == (after != design)
    assert len(after.segments) == len(design.segments)
    assert read_design(after.to_json())[0] == after
    assert repair(design, None, world, how) == (after, changes)
    if how == "none":
        assert after == design
    if how == "place":
        assert after.segments == design.segments
        low, high = -1e-9, world.site.map_size + 1e-9
        if is_valid(design, None, world):
            assert after == design
        elif (after.starting_point, after.theta) != (design.starting_point, design.theta):
            points = build(after).centreline()
            assert points[:, :2].min() >= low
            assert points[:, :2].max() <= high


def test_a_road_beside_the_map_is_moved_no_further_than_it_must() -> None:
    after, changes = repair(road_of((100, 0, 0), start=(200.0, 60.0, 0.0)), None, WORLD, "place")
    x, y, _ = after.starting_point
    assert after.theta == 0
    assert y == 60
    assert 148 < x < 150  # 100 m and what a spline runs over fit before the border
    assert changes == (f"start moved from (200, 60) to ({x:g}, 60)",)
    assert is_valid(after)


def test_a_road_too_long_for_the_map_s_side_is_turned_by_the_least_angle() -> None:
    proposed = road_of((300, 0, 0), start=(10.0, 10.0, 0.0))
    after, changes = repair(proposed, None, WORLD, "place")
    assert is_valid(after)
    assert [change.split()[0] for change in changes] == ["start", "turned"]
    # slow and exact: the box of a rectangle of 302.1 m by 8 m, turned by ever more, in steps of 0.001 degrees
    angles = np.radians(np.arange(0, 45, 0.001))
    width = 302.1 * np.cos(angles) + 8 * np.sin(angles)
    least = math.degrees(angles[np.argmax(width <= 250 - 0.2)])
    turned = min(after.theta, 360 - after.theta)
    assert turned == pytest.approx(least, abs=0.02)


def test_what_is_too_large_for_the_map_is_left_to_be_repaired_in_full() -> None:
    proposed = road_of((500, 0, 0), start=(10.0, 125.0, 0.0))
    assert repair(proposed, None, WORLD, "place") == Repaired(proposed, ())
    after, changes = repair(proposed, None, WORLD, "full")
    assert is_valid(after)
    assert any("distance 500 ->" in change for change in changes)


def test_a_road_under_the_ground_is_raised() -> None:
    after, changes = repair(road_of((100, 0, -5), start=(50.0, 50.0, -26.0)), None, WORLD, "place")
    assert changes == ("start raised from -26 to -22 m",)
    assert is_valid(after)


def test_a_sharp_turn_is_widened_with_no_other_change_than_it_needs() -> None:
    proposed = road_of((40, 0, 0), (12, 70, 0), (40, 0, 0), start=(80.0, 125.0, 0.0))
    after, changes = repair(proposed, None, WORLD, "full")
    assert is_valid(after)
    assert len(changes) == 1
    assert changes[0].startswith("segment 2: ")
    assert after.segments[0] == proposed.segments[0]
    assert after.segments[2] == proposed.segments[2]


def test_a_grade_beyond_the_limit_is_brought_to_it() -> None:
    after, changes = repair(road_of((60, 0, 22), (60, 0, -40), start=(60.0, 60.0, 0.0)), None, WORLD, "full")
    assert [s.incline for s in after.segments] == [15, -15]
    assert changes == ("segment 1: grade 22 -> 15 %", "segment 2: grade -40 -> -15 %")


def test_a_long_straight_road_is_turned_into_the_diagonal_and_not_made_shorter() -> None:
    proposed = road_of(
        (49, 0, 5), (123, 0, -2), (75, 0, 22), (37, 0, -9), start=(60.0, 100.0, 0.0), theta=20.0
    )
    after = repair(proposed, None, WORLD, "full").design
    assert is_valid(after)
    assert [s.distance for s in after.segments] == [49, 123, 75, 37]
    assert [s.incline for s in after.segments] == [5, -2, 15, -9]


def test_two_turns_of_one_hand_close_together_are_parted() -> None:
    proposed = road_of((40, 40, 0), (4, 0, 0), (40, 40, 0), start=(80.0, 80.0, 0.0))
    assert len(shown_turns(proposed)) == 1
    after = repair(proposed, None, WORLD, "full").design
    assert is_valid(after)
    assert shown_turns(after) == [("left", "flat"), ("left", "flat")]


def test_a_loop_over_itself_is_opened() -> None:
    proposed = road_of((60, 0, 0), *[(40, 60, 0)] * 6, (90, 0, 0))
    after = repair(proposed, None, WORLD, "full").design
    assert is_valid(after)
    assert shown_turns(after) == [("left", "flat")]


def test_radii_of_a_design_of_ours_give_way_only_where_they_must() -> None:
    brief = read("turn x3 sharp")
    design = draft(brief, WORLD, seed=3)
    moved = design.model_copy(update={"starting_point": (240.0, 240.0, 0.0)})
    after = repair(moved, brief, WORLD, "full").design
    assert is_valid(after, brief)
    assert after.segments == design.segments


PROMISES = {
    "turn left 90; straight 60; turn right 45": road_of(
        (50, 0, 0), (60, 70, 2), (40, 0, 0), (50, -60, 0), (30, 0, 0)
    ),
    "turn x3 | up": road_of((30, 0, 0), (50, 60, 2), (45, -50, -4), (20, 0, 5), (50, 30, 1)),
    "turn x2 left gentle | up pct=5": road_of((25, 60, 1), (20, 0, 0), (30, 40, 9)),
    "straight up; straight down; turn right": road_of((40, 0, 6), (30, 0, 1), (45, 0, -9), (30, -45, 0)),
    "turn x2 | len=250": road_of((80, 0, 0), (60, 60, 0), (90, -60, 0), (100, 0, 0)),
    "turn x2 | up climb=12": road_of((60, 0, 2), (60, 50, 3), (50, -50, 2), (30, 0, 4)),
}


@pytest.mark.parametrize("line", PROMISES)
def test_a_proposal_with_the_right_turns_is_made_true_to_its_brief(line: str) -> None:
    brief = read(line)
    assert not is_valid(PROMISES[line], brief)
    after = repair(PROMISES[line], brief, WORLD, "full").design
    assert check.inspect(build(after), brief, WORLD) == ()


@pytest.mark.parametrize("asked", [150, 210, 300])
def test_turns_that_should_add_up_to_a_sum_are_made_to(asked: int) -> None:
    proposed = road_of((30, 0, 0), (30, 60, 0), (40, 0, 0), (30, -60, 0), (40, 0, 0), (30, 60, 0), (30, 0, 0))
    brief = read(f"turn x3 | turning={asked}")
    after = repair(proposed, brief, WORLD, "full").design
    assert is_valid(after, brief)
    assert sum(abs(segment.turn_degrees) for segment in after.segments) == pytest.approx(asked, rel=0.1)


def test_a_proposal_with_other_turns_than_asked_is_made_valid_and_stays_what_it_is() -> None:
    brief = Brief(clauses=(Clause(kind="turn", count=exactly(3)),))
    proposed = road_of((30, 0, 0), (8, 60, 0), (40, 0, 20), start=(240.0, 20.0, 0.0))
    after = repair(proposed, brief, WORLD, "full").design
    assert is_valid(after)
    assert next(finding.sentence for finding in check.inspect(build(after), brief, WORLD)).startswith(
        "asked for 3 turns, has 1"
    )


def test_an_open_count_is_shared_out_so_that_the_least_changes() -> None:
    brief = read("turn x1.. up; turn x1.. down")
    up, down = (30, 50, 5), (30, -50, -5)
    proposed = road_of((30, 0, 5), up, (30, 0, 5), (40, -50, 2), (30, 0, 5), up, (30, 0, 0), down)
    after = repair(proposed, brief, WORLD, "full").design
    assert is_valid(after, brief)
    assert shown_turns(after) == [("left", "up"), ("right", "up"), ("left", "up"), ("right", "down")]


def test_a_straight_that_already_goes_as_asked_answers_for_it() -> None:
    brief = Brief(clauses=(Clause(kind="straight", slope="down"),), turns=exactly(1))
    proposed = road_of((40, 0, 0), (30, 50, 0), (40, 0, -6))
    assert repair(proposed, brief, WORLD, "full") == Repaired(proposed, ())


def test_a_list_beyond_all_reason_comes_back_quickly() -> None:
    proposed = road_of(*[(30, 40, 3)] * 400)
    after, changes = repair(proposed, None, WORLD, "full")
    assert after.segments == proposed.segments
    assert changes == ()


def test_the_example_of_the_guide_runs(capsys: pytest.CaptureFixture[str]) -> None:
    guide = Path(__file__).resolve().parents[2] / "docs" / "how-to" / "use-a-chat-model.md"
    code = guide.read_text(encoding="utf-8").split("```python\n")[1].split("```")[0]
    exec(compile(code, str(guide), "exec"), {})
    assert capsys.readouterr().out.startswith("start moved from (230, 30) to (")
