"""Edits of a Design: what is asked for is measured afterwards, and nothing else is touched."""

import json
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from edit_truth import changed_besides, roads
from roadgpt import check
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.model import Brief
from roadgpt.check.measures import RoadMeasures, measure
from roadgpt.design import draft
from roadgpt.errors import EditError
from roadgpt.road import Design, Geometry, Segment, Site, World, build, in_short_segments
from roadgpt.road.design import read_design
from roadgpt_edit.editing import Edited, edit
from roadgpt_edit.road_elements import elements_on_road, joined
from tables import rows

WORLD = World()
ROADS = roads()


def seen(design: Design) -> RoadMeasures:
    """What a person sees."""
    return measure(build(design).centreline())


def edited(design: Design, plan: str, world: World = WORLD, geometry: Geometry = "arcs") -> Edited:
    """A design after the changes of a plan."""
    return edit(design, read_change_plan(plan), world, geometry)


def changed(road: str, plan: str) -> Design:
    """The road of that name after the changes of a plan."""
    return edited(ROADS[road], plan).design


@pytest.mark.parametrize("name", sorted(ROADS))
def test_blocks_are_the_segments_in_order_and_the_turns_that_are_seen(name: str) -> None:
    design = ROADS[name]
    blocks, found = elements_on_road(design)
    assert joined(blocks) == design.segments
    turns = [block for block in blocks if block.is_turn]
    assert [turn.side for turn in turns] == [turn.side for turn in found.turns]
    for block, turn in zip(turns, found.turns, strict=True):
        written = sum(segment.turn_degrees for segment in block.segments)
        assert abs(abs(written) - turn.degrees) < 6
        assert (written > 0) == (turn.side == "left")


def test_segments_that_make_one_turn_count_as_one() -> None:
    design = ROADS["h05"]  # three segments to the left in a row, 180 degrees
    assert len(seen(design).turns) == 1
    after = changed("h05", "turn: angle =150")
    assert seen(after).turns[0].degrees == pytest.approx(150, abs=1.5)
    with pytest.raises(EditError, match="there is no second turn; the road has one"):
        changed("h05", "turn 2: angle more")


def test_a_turn_beyond_what_one_segment_may_turn_is_written_as_several() -> None:
    after = changed("h11", "turn 2: shape hairpin")
    assert seen(after).turns[1].degrees >= 140
    assert all(abs(segment.turn_degrees) <= 70 for segment in after.segments)


def test_the_mirror_image_of_the_mirror_image_is_the_road() -> None:
    for name in ("r01", "h08"):
        twice = edited(changed(name, "road: mirror"), "road: mirror").design
        assert twice.segments == ROADS[name].segments
        assert twice.theta == pytest.approx(ROADS[name].theta)
        assert twice.starting_point == pytest.approx(ROADS[name].starting_point)


def test_the_mirror_image_of_one_turn_leaves_all_others_as_they_are() -> None:
    after = changed("r01", "turn 2: mirror")
    assert [turn.side for turn in seen(after).turns] == ["right", "right", "left"]
    assert changed_besides(ROADS["r01"], after, [5]) == []
    with pytest.raises(EditError, match="name a turn"):
        changed("r01", "straight 1: mirror")


def test_a_bend_that_only_the_spline_makes_cannot_be_changed() -> None:
    turns = [element for element in elements_on_road(ROADS["r01"], "spline")[0] if element.is_turn]
    assert [bool(turn.segments) for turn in turns] == [True, True, True, False]
    with pytest.raises(EditError, match="turn 4 is made by no segment of the road"):
        edited(ROADS["r01"], "turn 4: angle more", geometry="spline")


def test_turns_to_one_hand_do_not_run_into_each_other() -> None:
    after = changed("h14", "turn 1: side left")
    assert [turn.side for turn in seen(after).turns] == ["left", "left", "left", "right"]


@pytest.mark.parametrize(
    ("road", "plan", "advice"),
    rows(__file__, "what_cannot_be_is_refused_with_the_reason"),
)
def test_what_cannot_be_is_refused_with_the_reason(road: str, plan: str, advice: str) -> None:
    with pytest.raises(EditError, match=advice) as caught:
        changed(road, plan)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("radius", [18, 25, 45])
@pytest.mark.parametrize("is_radius_first", [True, False])
def test_an_angle_and_a_radius_may_both_be_said(radius: int, is_radius_first: bool) -> None:
    wishes = ["turn 2: angle =45", f"turn 2: radius ={radius}"]
    turn = seen(changed("h01", "; ".join(wishes[::-1] if is_radius_first else wishes))).turns[1]
    assert turn.degrees == pytest.approx(45, abs=2)
    assert turn.radius == pytest.approx(radius, rel=0.08)


def test_turns_that_are_excepted_by_number_stay() -> None:
    before, after = (seen(road).turns for road in
                     (ROADS["h08"], changed("h08", "turn 1,2,3 but(turn 2): angle less")))  # fmt: skip
    same = [(one.degrees, one.radius) == pytest.approx((other.degrees, other.radius), rel=0.03)
            for one, other in zip(before, after, strict=True)]  # fmt: skip
    assert same == [False, True, False, True]


def test_a_road_of_hops_and_splines_is_changed_as_it_is_seen() -> None:
    design = in_short_segments(ROADS["h01"])
    after = edited(design, "turn 2: angle +20", geometry="spline").design
    before, now = (measure(build(one, "spline").centreline()).turns for one in (design, after))
    assert now[1].degrees - before[1].degrees == pytest.approx(20, abs=2)
    assert now[0].degrees == pytest.approx(before[0].degrees, abs=1.5)
    assert check.inspect(build(after, "spline"), None, WORLD) == ()


LONG_TAIL = "add straight len=250 at_end"


def test_the_usual_map_grows_rather_than_the_rest_of_the_road_shrinks() -> None:
    before = ROADS["h01"]
    after = edited(before, LONG_TAIL)
    size = after.world.site.map_size
    assert size > WORLD.site.map_size
    assert any(f"the map is {size:g} m wide" in sentence for sentence in after.changes)
    assert after.design.segments[: len(before.segments)] == before.segments
    assert build(after.design).length == pytest.approx(build(before).length + 250, abs=1)
    assert check.inspect(build(after.design), None, after.world) == ()
    assert check.inspect(build(after.design), None, WORLD) != ()


def test_a_map_of_another_size_stays_and_what_then_changes_is_told() -> None:
    world = World(site=Site(map_size=260))
    with pytest.raises(EditError, match="the map runs from 0 to 260 m"):
        edited(ROADS["h01"], "straight -1: length +900", world)
    after = edited(ROADS["h01"], LONG_TAIL, world)
    assert after.world == world
    assert any("to keep it valid" in sentence for sentence in after.changes)
    assert check.inspect(build(after.design), None, world) == ()


CHANGES = rows(__file__, "changes")


@settings(max_examples=12)
@given(st.integers(0, 400), st.lists(st.sampled_from(CHANGES), min_size=1, max_size=3, unique=True))
def test_any_edit_gives_a_valid_road_or_a_reason(seed: int, some: list[str]) -> None:
    design = draft(Brief(), WORLD, seed=seed)
    before = design.model_copy(deep=True)
    with suppress(EditError):
        made = edited(design, "; ".join(some))
        assert check.inspect(build(made.design), None, WORLD) == ()
        assert made.changes
        assert made.design != design
    assert design == before


@pytest.mark.parametrize("plan", ["road: mirror", *(f"turn {n}: mirror" for n in (1, 2, 3)), *CHANGES])
def test_an_edited_road_is_read_back_from_its_file_as_it_is(plan: str) -> None:
    with suppress(EditError):
        after = changed("r01", plan)
        assert read_design(json.loads(json.dumps(after.to_json()))) == (after, ())


def test_a_segment_without_a_radius_keeps_what_its_writer_left_open() -> None:
    after = changed("h01", "turn 2: angle +5")
    assert all(segment.radius is None for segment in after.segments)
    assert after.segments[0] == Segment(distance=60, direction="straight")


def test_turns_are_made_to_alternate_as_the_first_one_begins() -> None:
    assert [turn.side for turn in seen(changed("h13", "turn all: alternate")).turns] == ["left", "right"]
    with pytest.raises(EditError, match="so already"):
        changed("h01", "turn all: alternate")


def test_a_bound_changes_only_what_is_beyond_it() -> None:
    old, new = ROADS["h08"], changed("h08", "road: slope ..3")
    for one, other in zip(old.segments, new.segments, strict=True):
        assert other.incline == pytest.approx(min(max(one.incline, -3.0), 3.0))
    with pytest.raises(EditError, match="so already"):
        changed("h08", "road: slope ..14")


@pytest.mark.parametrize("name", sorted(ROADS))
def test_a_reversed_road_is_the_same_line_driven_back(name: str) -> None:
    before, after = build(ROADS[name]), build(changed(name, "road: reverse"))
    assert after.length == pytest.approx(before.length, abs=0.01)
    s = np.linspace(0, before.length, 100)
    back = before.at(before.length - s)
    assert np.hypot(*(after.at(s) - back)[:, :2].T).max() < 0.15  # designs round to centimetres
    rise = (after.at(s) - back)[:, 2]
    assert np.abs(rise[[0, -1]]).max() < 0.01
    assert np.abs(rise).max() < 2.0  # the grade changes where a segment begins, which is now its other end
    assert any("former end" in sentence for sentence in edited(ROADS[name], "road: reverse").changes)


def test_only_the_whole_road_is_reversed() -> None:
    with pytest.raises(EditError, match="only the whole road can be reversed"):
        changed("h05", "turn 1: reverse")


@pytest.mark.parametrize(("plan", "metres"), [("=6", 6.0), ("=-4", -4.0), ("=0", 0.0)])
def test_the_road_climbs_as_many_metres_as_asked(plan: str, metres: float) -> None:
    for name, design in ROADS.items():
        height = (
            build(changed(name, f"road: climb {plan}")).centreline()[:, 2] if _can(design, metres) else None
        )
        if height is not None:
            assert height[-1] - height[0] == pytest.approx(metres, abs=0.35)


def _can(design: Design, metres: float) -> bool:
    return (
        abs(metres) / build(design).length < 0.9 * WORLD.limits.max_grade and design.segments[0].incline != 0
    )


def test_a_climb_is_changed_by_metres_and_too_much_is_refused() -> None:
    before = build(ROADS["h05"]).centreline()[:, 2]
    after = build(changed("h05", "road: climb +3")).centreline()[:, 2]
    assert after[-1] - after[0] == pytest.approx(before[-1] - before[0] + 3, abs=0.35)
    with pytest.raises(EditError, match="steeper than the"):
        changed("h05", "road: climb =200")
    uneven = tuple(Segment(distance=d, direction="straight", incline=i) for d, i in ((30, 12), (80, 2)))
    steep = Design(starting_point=(40, 40, 10), theta=45, segments=uneven)
    height = build(edited(steep, "road: climb =9").design).centreline()[:, 2]
    assert height[-1] - height[0] == pytest.approx(9, abs=0.35)  # not 12 % x 1.7, which no rule allows
    with pytest.raises(EditError, match="no climb in metres"):
        changed("h05", "road: climb more")


def test_two_straights_change_places_and_the_turns_stay() -> None:
    parts = [(30, 0, 0), (30, 60, 0), (70, 0, 4), (30, -50, 0), (40, 0, -3), (30, 40, 0), (50, 0, 0)]
    segments = tuple(
        Segment(
            distance=d, direction="left" if t > 0 else "right" if t else "straight", turn_degrees=t, incline=g
        )
        for d, t, g in parts
    )
    design = Design(starting_point=(60, 40, 10), theta=45, segments=segments)
    after = edited(design, "straight 2,3: swap")
    now = [(s.distance, s.turn_degrees, s.incline) for s in after.design.segments]
    assert now == [parts[i] for i in (0, 1, 4, 3, 2, 5, 6)]
    assert "straight 2 and straight 3 have changed places; they are named as before" in after.changes
    again = edited(after.design, "straight 2,3: swap")
    assert again.design.segments == design.segments
    with pytest.raises(EditError, match="two turns, or two straights, can change places"):
        edited(design, "straight all: swap")


def test_only_the_part_that_climbs_becomes_steeper() -> None:
    """A straight that falls by 4 % for 60 m and then climbs by 5 % is one straight of two parts."""
    parts = [Segment(distance=60, direction="straight", incline=grade) for grade in (-4.0, 5.0)]
    design = Design(starting_point=(40, 40, 10), theta=45, segments=tuple(parts))
    for plan, wanted in (
        ("straight up: slope =8", [-4, 8]),
        ("straight down: slope less", [-2, 5]),
        ("road up: slope x0.5", [-4, 2.5]),
        ("straight down: slope =8", [-8, 5]),
        ("straight down: slope 6..", [-6, 5]),
        ("straight up: slope ..3", [-4, 3]),
        ("straight up: slope down =3", [-4, -3]),
        ("straight: slope flat", [0, 0]),
    ):
        after = edited(design, plan).design
        assert [segment.incline for segment in after.segments] == pytest.approx(wanted, abs=0.3), plan


def test_what_changes_nothing_gives_way_to_a_reading_of_the_same_sort_that_does() -> None:
    before = len(seen(ROADS["r01"]).turns)
    idle = replace(
        read_change_plan(f"turn: x..{before + 2}"), words="two more", others=(f"turn: x{before + 2}",)
    )
    made = edit(ROADS["r01"], idle, WORLD)
    assert len(seen(made.design).turns) == before + 2
    assert made.confidence == 0.5
    for others in ((), ("turn 1: remove",)):
        with pytest.raises(EditError, match="is so already"):
            edit(ROADS["r01"], replace(idle, others=others), WORLD)


def test_a_doubtful_reading_that_this_road_cannot_have_gives_way_to_the_next_that_it_can() -> None:
    others = ("turn 8: angle less", "turn 2: angle =60", "turn 1: remove")
    asked = replace(read_change_plan("turn 9: angle less"), words="ease it", confidence=0.3, others=others)
    made = edit(ROADS["r01"], asked, WORLD)
    assert made.design == changed("r01", "turn 2: angle =60")
    assert made.confidence == 0.3
    assert "'turn 9: angle less', the likeliest reading, cannot be done" in made.changes[-1]
    assert "no ninth turn" in made.changes[-1]
    for surer in (replace(asked, confidence=0.9), replace(asked, others=others[:1])):
        with pytest.raises(EditError, match="no ninth turn"):
            edit(ROADS["r01"], surer, WORLD)
