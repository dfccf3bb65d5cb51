"""Variations keep what was asked for: by the rules, and as measured by hand; changes are what they say."""

import math
from functools import cache
from itertools import groupby, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt import check
from roadgpt.brief import read
from roadgpt.brief.element import Element, Elements
from roadgpt.design.elements import as_written, design_of, elements_of, segments_of
from roadgpt.design.layout import MapPose
from roadgpt.road import Design, Road, Segment, Site, World, build
from roadgpt_sbft.validator import sbft_verdict
from roadgpt_search.variation import (
    MUTATIONS,
    Candidate,
    Kind,
    VariationContext,
    VariationTask,
    crossed_over,
    interpolated,
    make_candidate,
    mutated,
)

WORLD = World(site=Site(map_size=200))
FLAT, UPHILL, SERPENTINE = "| flat turns=1..", "turn x3 | up", "serpentine"
PLANS = (FLAT, UPHILL, SERPENTINE, "turn x2 up; straight down; turn left")
SEEDS = st.integers(0, 2**40)


@cache
def setting(line: str) -> VariationContext:
    return VariationContext(read(line, reader="plan"), WORLD, "sbft")


@cache
def drafts(line: str) -> tuple[Candidate, ...]:
    made = (make_candidate(VariationTask("draft", (), "draft", (seed,), setting(line))) for seed in range(5))
    return tuple(one for one in made if one)


def child(line: str, kind: Kind, seed: int) -> Candidate | None:
    parents = drafts(line)
    chosen = {"vary": 1, "cross": 2}.get(kind, 0)
    own = tuple(parents[(seed + i) % len(parents)].design for i in range(chosen))
    return make_candidate(VariationTask(kind, own, kind, (seed,), setting(line)))


def hands(road: Road) -> list[str]:
    """Turns of a road as one would count them on its curvature: stretches of one hand of 10 degrees or more,
    unless they follow each other within 8 m."""
    s = np.arange(0.0, road.length, 0.25)
    signs = np.where(np.abs(road.curvature(s)) > 1 / 300, np.sign(road.curvature(s)), 0).astype(int)
    found, at = [], 0
    for sign, group in groupby(signs):
        n = len(list(group))
        turned = math.degrees(abs(road.curvature(s[at : at + n]).sum() * 0.25))
        if sign and turned >= 10:
            same = found and found[-1][0] == sign and s[at] - found[-1][1] < 8
            found = found[:-1] if same else found
            found.append((sign, float(s[at + n - 1])))
        at += n
    return ["left" if sign > 0 else "right" for sign, _ in found]


def slopes(road: Road) -> np.ndarray:
    """Percent, over every 20 m."""
    z = road.at(np.arange(0.0, road.length, 1.0))[:, 2]
    return 100 * (z[20:] - z[:-20]) / 20


@settings(max_examples=12)
@given(SEEDS, st.sampled_from(PLANS), st.sampled_from(["vary", "cross"]))
def test_every_variation_keeps_the_brief_and_every_rule(seed: int, line: str, kind: Kind) -> None:
    one = child(line, kind, seed)
    if one is None:
        return
    road = build(one.design)
    assert not check.inspect(road, setting(line).brief, WORLD)
    assert sbft_verdict(road.control_points(), WORLD.site.map_size)[0]
    turns, grades = hands(road), slopes(road)
    if line == FLAT:
        assert np.abs(grades).max() < 1
        assert turns
    elif line == UPHILL:
        assert len(turns) == 3
        assert grades.min() > -1
        assert road.at(road.length)[2] > road.at(0.0)[2]
    elif line == SERPENTINE:
        assert len(turns) >= 4
        assert all(a != b for a, b in pairwise(turns))
    else:
        assert len(turns) == 3
        assert turns[-1] == "left"
        assert grades.min() <= -1


def test_the_same_task_makes_the_same_road_and_another_seed_another() -> None:
    for kind in ("draft", "vary", "cross"):
        one, again, other = (child(PLANS[1], kind, seed) for seed in (5, 5, 6))  # type: ignore[arg-type]
        assert (one is None) == (again is None)
        if one is None or again is None:
            assert kind == "cross"  # what takes after two need not keep what both were asked for
            continue
        assert one.design == again.design
        assert np.array_equal(one.shape.metres, again.shape.metres)
        assert other is None or other.design != one.design


@settings(max_examples=15)
@given(st.integers(0, 4), st.sampled_from(PLANS))
def test_elements_give_the_road_back(number: int, line: str) -> None:
    design = drafts(line)[number % len(drafts(line))].design
    x, y, _ = design.starting_point
    again = design_of(elements_of(design.segments), MapPose(x, y, design.theta), WORLD)
    one, other = build(design), build(again)
    assert other.length == pytest.approx(one.length, abs=0.05)
    share = np.linspace(0, 1, 50)
    apart = np.hypot(*(one.at(share * one.length) - other.at(share * other.length))[:, :2].T)
    assert apart.max() < 0.05
    third = design_of(elements_of(again.segments), MapPose(x, y, design.theta), WORLD)
    assert elements_of(again.segments) == elements_of(third.segments)


def test_designs_of_other_hands_have_elements_too() -> None:
    """Without radii, as language models write them, and with a radius that leaves part of a turn straight."""
    plain = Design(
        starting_point=(50, 50, 1),
        theta=0,
        segments=(
            Segment(distance=30, direction="straight"),
            Segment(distance=40, direction="left", turn_degrees=60, incline=3),
            Segment(distance=60, direction="right", turn_degrees=-50, radius=25, transition=4),
        ),
    )
    elements = elements_of(plain.segments)
    assert [float(np.sign(element.turn)) for element in elements] == [0, 1, 0, -1, 0]
    assert sum(as_written(element).length for element in elements) == pytest.approx(130, abs=0.5)
    assert elements[1].incline == 3
    assert elements[3].radius == 25
    one, other = build(plain), build(design_of(elements, MapPose(50, 50, 0), WORLD))
    assert np.hypot(*(one.at(130.0) - other.at(other.length))[:2]) < 1.5


INCLINES = st.floats(-14, 14)
SIZES = st.one_of(st.floats(12, 200), st.floats(-200, -12))
ELEMENTS = st.one_of(
    st.tuples(st.floats(1, 150), INCLINES).map(lambda pair: Element(straight=pair[0], incline=pair[1])),
    st.tuples(SIZES, st.floats(15, 120), st.floats(2, 16), INCLINES).map(lambda turn: Element(0.0, *turn)),
)
ROWS = st.lists(ELEMENTS, min_size=1, max_size=8).map(tuple)


@given(ROWS, SEEDS, st.sampled_from(sorted(MUTATIONS)))
def test_changes_stay_within_what_roads_may_be(elements: Elements, seed: int, name: str) -> None:
    after = MUTATIONS[name].make(elements, np.random.default_rng(seed), WORLD)
    assert after
    for element in after:
        assert abs(element.incline) <= 15
        assert (0 < element.straight <= 150) if not element.turn else (14 < element.radius <= 120)
    if MUTATIONS[name].is_numeric:
        assert [np.sign(element.turn) for element in after] == [np.sign(element.turn) for element in elements]
        changed = sum(a != b for a, b in zip(elements, after, strict=True))
        assert changed <= (len(elements) if name in ("packed", "enlarged") else 1)
    again = MUTATIONS[name].make(elements, np.random.default_rng(seed), WORLD)
    assert again == after


@given(ROWS, SEEDS)
def test_what_is_turned_round_twice_is_itself(elements: Elements, seed: int) -> None:
    rng = np.random.default_rng(seed)
    for name in ("mirrored", "backwards"):
        change = MUTATIONS[name].make
        assert change(change(elements, rng, WORLD), rng, WORLD) == elements


@given(ROWS, ROWS, SEEDS)
def test_a_crossing_begins_as_one_and_ends_as_the_other(one: Elements, other: Elements, seed: int) -> None:
    after = crossed_over(one, other, np.random.default_rng(seed))
    assert after[0] == one[0]
    assert after[-1] == other[-1]
    assert any(after == one[:i] + other[j:] for i in range(1, len(one) + 1) for j in range(len(other)))


@given(ROWS, SEEDS, st.floats(0, 1))
def test_between_two_roads_lies_every_number(elements: Elements, seed: int, share: float) -> None:
    other = mutated(elements, np.random.default_rng(seed), WORLD, numeric=1.0)
    middle = interpolated(elements, other, share)
    assert middle is not None
    for a, b, c in zip(elements, other, middle, strict=True):
        for low, high, value in zip(a[:5], b[:5], c[:5], strict=True):
            assert min(low, high) - 1e-9 <= value <= max(low, high) + 1e-9
    assert interpolated(elements, other, 0.0) == elements
    assert interpolated(elements, (*elements, Element(straight=5.0)), share) is None


@given(ROWS)
def test_no_slope_lies_at_the_edge_of_flat(elements: Elements) -> None:
    """1 % is up and 0.9 % is flat: what is written as 1.0 % is measured as either."""
    for element in elements:
        segment = segments_of((element,), World())[0]
        assert abs(abs(segment.incline) - 1) > 0.19
        assert round(segment.incline, 1) == segment.incline
        assert abs(segment.incline - element.incline) < 0.26


def test_segments_of_a_wide_turn_are_cut_as_the_format_asks() -> None:
    segments = segments_of(
        (Element(turn=-170.0, radius=20.0, transition=5.0, incline=2.0), Element(straight=30.0)), World()
    )
    assert [segment.direction for segment in segments] == ["right"] * 3 + ["straight"]
    assert all(abs(segment.turn_degrees) <= 70 for segment in segments)
    assert sum(segment.turn_degrees for segment in segments) == pytest.approx(-170, abs=0.2)
