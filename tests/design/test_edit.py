"""Edits of a Design: what is asked for is measured afterwards, and nothing else is touched."""

from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from edit_truth import changed_besides, roads
from roadgpt import check
from roadgpt.brief.model import Brief
from roadgpt.check.measures import Measures, measure
from roadgpt.design import draft
from roadgpt.design.edit import edit
from roadgpt.design.road_elements import elements_on_road, joined
from roadgpt.errors import EditError
from roadgpt.road import Design, Segment, Site, World, build, in_short_segments

WORLD = World()
ROADS = roads()


def seen(design: Design) -> Measures:
    """What a person sees."""
    return measure(build(design).centreline())


def changed(road: str, words: str) -> Design:
    """The road of that name after a change."""
    return edit(ROADS[road], words, WORLD).design


@pytest.mark.parametrize("name", sorted(ROADS))
def test_blocks_are_the_segments_in_order_and_the_turns_that_are_seen(name: str) -> None:
    design = ROADS[name]
    blocks, found = elements_on_road(design)
    assert joined(blocks) == design.segments
    turns = [block for block in blocks if block.kind == "turn"]
    assert [turn.side for turn in turns] == [turn.side for turn in found.turns]
    for block, turn in zip(turns, found.turns, strict=True):
        written = sum(segment.turn_degrees for segment in block.segments)
        assert abs(abs(written) - turn.degrees) < 6
        assert (written > 0) == (turn.side == "left")


def test_segments_that_make_one_turn_count_as_one() -> None:
    design = ROADS["h05"]  # three segments to the left in a row, 180 degrees
    assert len(seen(design).turns) == 1
    after = changed("h05", "make the turn 150 degrees")
    assert seen(after).turns[0].degrees == pytest.approx(150, abs=1.5)
    with pytest.raises(EditError, match="there is no second turn; the road has one"):
        changed("h05", "make the second turn sharper")


def test_what_was_not_spoken_of_keeps_every_number() -> None:
    before, after = ROADS["r06"], changed("r06", "make the third turn sharper by 10 degrees")
    assert changed_besides(before, after, [7]) == []
    pairs = zip(before.to_json().items(), after.to_json().items(), strict=True)
    other = [key for (key, one), (_, two) in pairs if one != two]
    assert [key for key in other if key.startswith("road_segment")] == ["road_segment7"]


def test_a_turn_beyond_what_one_segment_may_turn_is_written_as_several() -> None:
    after = changed("h11", "make the second turn a hairpin")
    assert seen(after).turns[1].degrees >= 140
    assert all(abs(segment.turn_degrees) <= 70 for segment in after.segments)


def test_the_mirror_image_of_the_mirror_image_is_the_road() -> None:
    for name in ("r01", "h08"):
        twice = edit(changed(name, "mirror the road"), "mirror the road", WORLD).design
        assert twice.segments == ROADS[name].segments
        assert twice.theta == pytest.approx(ROADS[name].theta)
        assert twice.starting_point == pytest.approx(ROADS[name].starting_point)


def test_what_is_added_can_be_removed_again() -> None:
    more = changed("h01", "add a right turn after the second turn")
    assert [turn.side for turn in seen(more).turns] == ["left", "right", "right"]
    less = edit(more, "remove the third turn", WORLD).design
    assert [turn.side for turn in seen(less).turns] == ["left", "right"]


def test_numbers_count_on_the_road_as_it_was_before() -> None:
    after = changed("h14", "remove the first turn and make the second turn sharper")
    turns = seen(after).turns
    assert [turn.side for turn in turns] == ["left", "left", "right"]
    assert turns[0].degrees > 33


def test_turns_to_one_hand_do_not_run_into_each_other() -> None:
    after = changed("h14", "make the first turn a left turn")
    assert [turn.side for turn in seen(after).turns] == ["left", "left", "left", "right"]


@pytest.mark.parametrize(
    ("road", "words", "advice"),
    [
        ("r01", "make the fifth turn sharper", "no fifth turn; the road has 3 turns"),
        ("r09", "make the last turn sharper", "no turn"),
        ("h01", "make the hairpin tighter", "no hairpin"),
        ("h01", "make the turn sharper", "could be any of 2"),
        ("h01", "make the second turn with a radius of 5 m", "tighter than the 14.3 m"),
        ("h01", "make the road climb at 40 %", "steeper than the 15 %"),
        ("h01", "make the first turn a left turn", "is so already"),
        ("h07", "make the road level", "is so already"),
        ("h01", "make the first straight 900 m long", "leaves the map"),
        ("h01", "make the road 5 m long", "too short"),
        ("h01", "make the middle turn sharper", "none is in the middle"),
        ("h07", "mirror the road", "mirror image is the same"),
        ("h01", "make the second turn a chicane", "cannot be made several"),
        ("h01", "add a left turn of 500 degrees", "cannot be added"),
        ("h01", "make the first straight tighter", "does not bend; name a turn"),
        ("h01", "make the first straight a left turn", "has no side; name a turn"),
        ("h01", ", ".join(["make the first turn sharper"] * 13), "too many"),
    ],
)
def test_what_cannot_be_is_refused_with_the_reason(road: str, words: str, advice: str) -> None:
    with pytest.raises(EditError, match=advice) as caught:
        edit(ROADS[road], words, WORLD)
    assert "\n" not in str(caught.value)


def test_a_straight_between_turns_of_one_hand_goes_and_the_turns_stay_two() -> None:
    before = seen(ROADS["h13"])
    after = seen(changed("h13", "remove the second straight"))
    assert len(before.straights) - len(after.straights) == 1
    assert [turn.side for turn in after.turns] == ["left", "left"]


def test_an_angle_and_a_radius_may_both_be_said() -> None:
    turn = seen(changed("h01", "second turn: 80 degrees, radius 25 m")).turns[1]
    assert turn.degrees == pytest.approx(80, abs=2)
    assert turn.radius == pytest.approx(25, rel=0.08)


def test_turns_that_are_excepted_by_number_stay() -> None:
    before, after = (seen(road).turns for road in
                     (ROADS["h08"], changed("h08", "make turns 1 to 3 gentler except turn 2")))  # fmt: skip
    same = [(one.degrees, one.radius) == pytest.approx((other.degrees, other.radius), rel=0.03)
            for one, other in zip(before, after, strict=True)]  # fmt: skip
    assert same == [False, True, False, True]


def test_half_of_a_road_has_turns_of_its_own() -> None:
    before, after = (seen(road).turns for road in
                     (ROADS["h08"], changed("h08", "make the turns tighter in the second half")))  # fmt: skip
    assert after[0].radius == pytest.approx(before[0].radius, rel=0.03)
    assert after[-1].radius < 0.95 * before[-1].radius


def test_a_changed_road_is_told_as_it_measures() -> None:
    made = edit(ROADS["h01"], "make the second turn 80 degrees", WORLD)
    assert any("turn 2: 60 -> 80 degrees" in sentence for sentence in made.changes)
    assert made.unused == ()


def test_a_road_of_hops_and_splines_is_changed_as_it_is_seen() -> None:
    design = in_short_segments(ROADS["h01"])
    after = edit(design, "make the second turn sharper by 20 degrees", WORLD, "spline").design
    before, now = (measure(build(one, "spline").centreline()).turns for one in (design, after))
    assert now[1].degrees - before[1].degrees == pytest.approx(20, abs=2)
    assert now[0].degrees == pytest.approx(before[0].degrees, abs=1.5)
    assert check.inspect(build(after, "spline"), None, WORLD) == ()


def test_roads_on_other_maps_keep_inside() -> None:
    world = World(site=Site(map_size=120))
    design = draft(Brief(), world, seed=3)
    after = edit(design, "add a left turn at the end", world).design
    assert check.inspect(build(after), None, world) == ()


def test_the_same_request_gives_the_same_road() -> None:
    words = "make the second turn sharper and add a left turn at the end"
    assert edit(ROADS["h12"], words, WORLD) == edit(ROADS["h12"], words, WORLD)


CHANGES = [
    "make the first turn sharper",
    "make the last turn gentler",
    "make the first turn 45 degrees",
    "make the last turn with a radius of 30 m",
    "flip the last turn",
    "make the last straight 20 m longer",
    "make the end downhill",
    "make the start uphill at 6 %",
    "add a left turn at the end",
    "add a sharp right turn after the first turn",
    "remove the first turn",
    "remove the last turn",
    "make all turns gentler",
    "make the whole road level",
    "mirror the road",
]


@settings(max_examples=40)
@given(st.integers(0, 400), st.lists(st.sampled_from(CHANGES), min_size=1, max_size=3, unique=True))
def test_any_edit_gives_a_valid_road_or_a_reason(seed: int, some: list[str]) -> None:
    design = draft(Brief(), WORLD, seed=seed)
    before = design.model_copy(deep=True)
    with suppress(EditError):
        made = edit(design, ", ".join(some), WORLD)
        assert check.inspect(build(made.design), None, WORLD) == ()
        assert made.changes
        assert made.design != design
    assert design == before


def test_a_segment_without_a_radius_keeps_what_its_writer_left_open() -> None:
    after = changed("h01", "make the second turn sharper by 5 degrees")
    assert all(segment.radius is None for segment in after.segments)
    assert after.segments[0] == Segment(distance=60, direction="straight")


def test_blocks_are_named_for_what_they_were() -> None:
    blocks, _ = elements_on_road(ROADS["h01"])
    assert [block.name for block in blocks] == ["gap 0", "turn 1", "gap 1", "turn 2", "gap 2"]


def test_turns_are_made_to_alternate_as_the_first_one_begins() -> None:
    assert [turn.side for turn in seen(changed("h13", "alternate the turns")).turns] == ["left", "right"]
    with pytest.raises(EditError, match="so already"):
        changed("h01", "alternate the turns")


def test_a_bound_changes_only_what_is_beyond_it() -> None:
    old, new = ROADS["h08"], changed("h08", "cap the slope at 3 %")
    for one, other in zip(old.segments, new.segments, strict=True):
        assert other.incline == pytest.approx(min(max(one.incline, -3.0), 3.0))
    with pytest.raises(EditError, match="so already"):
        changed("h08", "no slope over 14 %")


def test_a_road_ends_with_one_straight_of_the_length_that_was_said() -> None:
    new = seen(changed("r14", "end with a 60 m straight"))
    assert new.features[-1].kind == "straight"
    assert new.features[-1].length == pytest.approx(60, abs=2)


def test_turns_that_are_to_lie_apart_have_a_straight_between_them() -> None:
    new = seen(changed("h06", "separate the two turns by 40 m"))
    assert [feature.kind for feature in new.features] == ["straight", "turn", "straight", "turn", "straight"]
    assert new.features[2].length == pytest.approx(40, abs=3)


def test_what_is_removed_cannot_be_changed_as_well() -> None:
    with pytest.raises(EditError, match="turn 1 is to go and to be changed at once"):
        changed("h14", "remove the first turn and make the first turn sharper")


def test_all_straights_get_shorter_where_one_of_them_can_hardly_be() -> None:
    old, new = seen(ROADS["r12"]), seen(changed("r12", "make all straights shorter"))
    assert len(new.straights) == len(old.straights)
    for one, other in zip(old.straights, new.straights, strict=True):
        assert other.length <= one.length + 0.6
    assert sum(each.length for each in new.straights) < 0.8 * sum(each.length for each in old.straights)


def test_the_two_tightest_are_two() -> None:
    old, new = seen(ROADS["r12"]).turns, seen(changed("r12", "widen the two tightest turns a bit")).turns
    wider = {i for i, (a, b) in enumerate(zip(old, new, strict=True)) if b.radius > 1.05 * a.radius}
    assert wider == set(sorted(range(len(old)), key=lambda i: old[i].radius)[:2])
