"""Vertical radii of drafts, repairs, changes and variations, measured by differences of heights."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from design.short_searches import short_searches
from roadgpt import check, read
from roadgpt.brief.model import Brief, Clause, at_least, exactly
from roadgpt.brief.plan import read_plan
from roadgpt.brief.ranges import Range
from roadgpt.check.measures import measure
from roadgpt.design import draft, road_search
from roadgpt.design.elements import elements_of
from roadgpt.design.vertical import softened
from roadgpt.drive.driving_line import line_along
from roadgpt.errors import DesignError
from roadgpt.road import Design, Limits, Segment, World, build
from roadgpt.road.design import vertical_curves
from roadgpt.road.speed_profile import DrivingLimits, plan_speed
from tables import rows

WORLD = World()
WORDS = rows(__file__, "words")


def felt(design: Design, world: World = WORLD) -> float:
    """The greatest vertical acceleration, m/s^2, at the speeds that are planned for the right lane."""
    road = build(design)
    s = np.arange(0.0, road.length, 0.25)
    bend = np.gradient(np.gradient(road.at(s)[:, 2], 0.25), 0.25)[4:-4]
    lane = line_along(road, -world.section.lane_width / 2)
    level = replace(lane, crest=[0.0] * len(lane.crest))
    speed = np.array(plan_speed(level, DrivingLimits(0.64, 0.9, 0.7, world.limits.speed_limit)))
    v = np.interp(s[4:-4], lane.step * np.arange(len(speed)), speed)
    return float((v**2 * np.abs(bend)).max())


@pytest.mark.parametrize("words", WORDS)
@pytest.mark.parametrize("kmh", [50, 70, 110])
def test_no_draft_is_too_abrupt_for_its_speed(words: str, kmh: float) -> None:
    brief, world = read(words), World(limits=Limits(speed_limit=kmh / 3.6))
    assert felt(draft(brief, world, seed=round(kmh)), world) <= 3.05


def test_slopes_that_cannot_be_had_at_the_speed_are_refused_in_a_sentence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(road_search, "FINISHED", 20)  # drafts that fail alike, instead of 100
    brief = read_plan("straight flat len=30; straight up len=25 pct=12; straight flat; turn left")
    said = r"too fast for a speed limit of 70 km/h.*--speed-limit [35]0"
    with short_searches(), pytest.raises(DesignError, match=said):
        draft(brief, WORLD, seed=1)
    slow = World(limits=Limits(speed_limit=30 / 3.6))
    assert felt(draft(brief, slow, seed=1), slow) <= 3.05


def test_a_short_hump_that_was_asked_for_may_be_as_abrupt_as_wheels_can_follow() -> None:
    brief = read_plan("straight len=60; crest len=40 pct=10; straight len=40 | turns=0")
    design = draft(brief, WORLD, seed=2)
    assert 3 < felt(design) <= 9.85
    assert check.inspect(build(design), brief, WORLD) == ()
    assert [finding.rule for finding in check.inspect(build(design), None, WORLD)] == ["too_abrupt"]


@given(st.data())
def test_parabolas_keep_their_radius_or_the_room_between_them(data: st.DataObject) -> None:
    n = data.draw(st.integers(2, 8))
    lengths = data.draw(st.lists(st.floats(0.5, 200), min_size=n, max_size=n))
    grades = data.draw(st.lists(st.sampled_from([-0.1, -0.03, 0.0, 0.02, 0.12]), min_size=n, max_size=n))
    radii = data.draw(st.lists(st.none() | st.floats(1, 3000), min_size=n, max_size=n))
    found = vertical_curves(lengths, grades, radii)
    ends = np.cumsum(lengths)
    for parabola in found:
        assert parabola.s == pytest.approx(ends[parabola.number - 1])
        asked = radii[parabola.number]
        assert parabola.radius <= (asked or 250.0) * (1 + 1e-9)
    assert all(a.s + a.half < b.s - b.half for a, b in pairwise(found))
    assert all(p.s - p.half > 0 and p.s + p.half < ends[-1] for p in found)


@given(st.data())
def test_softened_grades_leave_room_wherever_there_are_such(data: st.DataObject) -> None:
    n = data.draw(st.integers(2, 9))
    lengths = data.draw(st.lists(st.floats(8, 120), min_size=n, max_size=n))
    grades = data.draw(st.lists(st.floats(-12, 12), min_size=n, max_size=n))
    radii = data.draw(st.lists(st.floats(50, 900), min_size=n - 1, max_size=n - 1))
    out = softened(grades, lengths, radii, [Range(-12.0, 12.0)] * n)  # one slope for all would do
    halves = [0.0, *(r * abs(b - a) / 200 for r, (a, b) in zip(radii, pairwise(out), strict=True)), 0.0]
    for length, before, after in zip(lengths, halves, halves[1:], strict=False):
        assert before + after <= 1.03 * length  # the projections have nearly converged
    assert min(grades) - 1e-9 <= min(out) <= max(out) <= max(grades) + 1e-9


@pytest.mark.parametrize("kind", ["hairpin", "switchback"])
def test_roads_with_hairpins_climb_or_fall_steadily_over_legs(kind: str) -> None:
    ways = set()
    for seed in range(8):
        brief = Brief(clauses=(Clause(kind=kind, count=at_least(2)),), steepest=at_least(4))
        road = build(draft(brief, WORLD, seed=seed))
        grade = road.grade(np.arange(0.0, road.length, 0.5))
        assert (grade > 0.005).all() or (grade < -0.005).all()
        ways.add(bool(grade[0] > 0))
        turns = measure(road.centreline()).turns
        assert len(turns) >= 3
        assert min(b.start - a.end for a, b in pairwise(turns)) >= 30
    assert ways == {True, False}


def test_hairpins_on_a_level_road_stay_level() -> None:
    brief = Brief(clauses=(Clause(kind="hairpin", count=exactly(3)),), slope="flat")
    grade = build(draft(brief, WORLD, seed=1)).sample().grade
    assert np.abs(grade).max() < 0.01


@given(
    st.lists(
        st.tuples(st.sampled_from([0.0, 3.0, -5.0]), st.sampled_from([0, 0, 40, -60])), min_size=1, max_size=8
    )
)
def test_elements_climb_as_the_segments_of_which_they_are_made(row: list[tuple[float, float]]) -> None:
    sides = {0: "straight", 40: "left", -60: "right"}
    segments = [Segment(distance=30, direction=sides[t], turn_degrees=t, incline=i) for i, t in row]
    elements = elements_of(segments)
    ends = [np.cumsum([0.0, *(each.length for each in elements)])]
    ends += [np.cumsum([0.0, *(each.length * each.incline / 100 for each in elements)])]
    at = 30.0 * np.arange(len(row) + 1)
    assert ends[0][-1] == pytest.approx(at[-1])
    assert np.interp(at, *ends) == pytest.approx(np.cumsum([0.0, *(0.3 * i for i, _ in row)]))
    assert sum(each.turn for each in elements) == pytest.approx(sum(t for _, t in row))
