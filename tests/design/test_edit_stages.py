"""Changes that cannot be made at once: they are made one after the other, and measured afterwards."""

import numpy as np
import pytest

from edit_truth import roads
from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.plan import read_plan
from roadgpt.check.measures import MeasuredFeature, Measures, measure
from roadgpt.design import draft
from roadgpt.design.edit import Edited, edit
from roadgpt.errors import EditError, IdleEditError
from roadgpt.road import Design, World, build

WORLD = World()
CLIMBING = draft(
    read_plan(
        "straight len=50; turn left deg=60 r=30; straight len=50; turn right deg=80 r=25; straight len=40; "
        "turn left deg=40 r=40; straight len=40 | up pct=4"
    ),
    WORLD,
    seed=1,
)
LEVEL = draft(
    read_plan(
        "straight len=60; turn left deg=90 r=30; straight len=40; turn right deg=160 r=22; straight len=60 "
        "| flat"
    ),
    WORLD,
    seed=1,
)
LEVEL_END = draft(
    read_plan(
        "straight len=50; turn left deg=60 r=30; straight len=50; turn right deg=80 r=25; straight len=40; "
        "turn left deg=40 r=40; straight len=30 | flat"
    ),
    WORLD,
    seed=1,
)
ROADS = {**roads(), "climbing": CLIMBING, "level": LEVEL}
AFTERWARDS = [
    "turn 1: radius x1.15",
    "straight 1: length +12",
    "end: slope up =3",
    "road: mirror",
]
"""Changes that nearly every road can have."""


def edited(design: Design, plan: str) -> Edited:
    """A design after the changes of a plan."""
    return edit(design, read_change_plan(plan), WORLD)


def after(design: Design, plan: str) -> Measures:
    """What a person sees of the road after the changes of a plan."""
    return measure(build(edited(design, plan).design).centreline())


def angles(found: Measures) -> list[float]:
    """The angles of all turns, positive to the left."""
    return [turn.degrees if turn.side == "left" else -turn.degrees for turn in found.turns]


def straights(found: Measures) -> list[MeasuredFeature]:
    """The straights between the turns, and those at the ends."""
    return [feature for gap in found.gaps for feature in gap if feature.kind == "straight"]


def in_two_requests(design: Design, first: str, second: str) -> Design | None:
    """A design after two requests, one after the other; None if one of them is refused.

    A request for what is so already changes nothing.
    """
    for plan in (first, second):
        try:
            design = edited(design, plan).design
        except IdleEditError:
            continue
        except EditError:
            return None
    return design


@pytest.mark.parametrize("name", sorted(ROADS))
@pytest.mark.parametrize("plan", AFTERWARDS)
def test_to_reverse_and_to_change_is_the_same_as_two_requests(name: str, plan: str) -> None:
    design = ROADS[name]
    for first, second in (("road: reverse", plan), (plan, "road: reverse")):
        wanted = in_two_requests(design, first, second)
        if wanted is None:
            with pytest.raises(EditError):
                edited(design, f"{first}; {second}")
        else:
            assert edited(design, f"{first}; {second}").design == wanted


def test_after_a_reversal_the_parts_are_named_in_the_new_direction() -> None:
    old = measure(build(CLIMBING).centreline()).turns
    new = after(CLIMBING, "road: reverse; turn 1: radius x1.3").turns
    assert new[0].radius == pytest.approx(1.3 * old[2].radius, rel=0.05)
    assert new[2].radius == pytest.approx(old[0].radius, rel=0.05)
    new = after(CLIMBING, "turn 1: radius x1.3; road: reverse").turns
    assert new[2].radius == pytest.approx(1.3 * old[0].radius, rel=0.05)
    said = edited(CLIMBING, "road: reverse; turn 1: radius x1.3").changes
    at = next(i for i, sentence in enumerate(said) if "in the new direction" in sentence)
    assert any("former end" in sentence for sentence in said[:at])
    assert any(sentence.startswith("turn 1: radius 40 -> 52 m") for sentence in said[at:])


@pytest.mark.parametrize(
    ("plan", "metres"),
    [
        ("turn 2: radius x1.5; road: climb =8", 8.0),
        ("road: climb =8; turn 2: remove", 8.0),
        ("road: climb =-5; add turn right deg=60 r=30 at_end", -5.0),
        ("straight 1: slope flat; road: climb =8", 8.0),
        ("road: reverse; road: climb =6", 6.0),
        ("road: climb =5; road: slope up", 5.0),
        ("straight 1: climb =0; road: climb =8", 8.0),
        ("add turn right deg=60 r=30 at_start; road: climb =-5", -5.0),
        ("straight 1: climb =2; road from(turn 1): climb =3", 5.0),
    ],
)
def test_a_height_holds_when_all_else_is_done(plan: str, metres: float) -> None:
    height = build(edited(CLIMBING, plan).design).centreline()[:, 2]
    assert height[-1] - height[0] == pytest.approx(metres, abs=0.35)


@pytest.mark.parametrize(
    "plan", ["road: climb +3; straight 1: length +20", "straight 1: length +20; road: climb +3"]
)
def test_a_difference_of_height_is_one_to_the_height_before(plan: str) -> None:
    old, new = (build(design).centreline()[:, 2] for design in (CLIMBING, edited(CLIMBING, plan).design))
    assert new[-1] - new[0] == pytest.approx(old[-1] - old[0] + 3, abs=0.35)


def test_a_part_with_a_slope_of_its_own_keeps_it() -> None:
    first, *others = straights(after(CLIMBING, "road: climb =8; straight 1: slope flat"))
    assert abs(first.grade) < 0.8
    assert np.ptp([each.grade for each in others]) < 0.5


def test_heights_of_two_straights() -> None:
    first, *_, last = straights(after(CLIMBING, "straight 1: climb =3; straight -1: climb =-2"))
    assert (first.grade, last.grade) == (pytest.approx(6, abs=0.7), pytest.approx(-5, abs=2.2))


@pytest.mark.parametrize(
    ("plan", "wanted"),
    [
        ("turn 2: remove; turn 1,3: swap", [40, 60]),
        ("turn 1,3: swap; turn 2: remove", [40, 60]),
        ("turn 3: at_start; add turn right deg=90 r=25 at_end", [40, 60, -80, -90]),
        ("add turn right deg=90 r=25 at_end; turn 1: at_end", [-80, 40, -90, 60]),
        ("turn 1: at_end; add turn right deg=90 r=25 at_end", [-80, 40, 60, -90]),
        ("turn 1,2: swap; add turn right deg=50 r=25 after(turn 1)", [-80, 60, -50, 40]),
        ("turn: x2; turn 1: at_end", [-80, 60]),
        ("turn 1: at_end; turn 3: at_end", [-80, 60, 40]),
        ("turn 1,3: swap; turn 1: at_start", [60, 40, -80]),
        (
            "add turn left deg=50 r=30 at_end; turn 1: at_end; add turn left deg=50 r=30 at_end",
            [-80, 40, 50, 60, 50],
        ),
        ("turn left: x3; turn right: x2", [60, -80, 40, 60, -60]),
        ("turn left: x1; turn right: x1", [60, -80]),
    ],
)
def test_places_are_those_before_the_change_in_the_order_of_the_plan(plan: str, wanted: list[float]) -> None:
    assert angles(after(CLIMBING, plan)) == pytest.approx(wanted, abs=4)


@pytest.mark.parametrize(
    ("road", "plan", "same"),
    [
        (CLIMBING, "turn sharpest: swap =turn 1", "turn 1,2: swap"),
        (CLIMBING, "turn right: swap =turn gentlest", "turn 2,3: swap"),
        (CLIMBING, "straight longest: swap =straight 3", "straight 1,3: swap"),
        (LEVEL, "hairpin: swap =turn 1", "turn 1,2: swap"),
        (LEVEL, "turn 1: swap =hairpin", "turn all: swap"),
    ],
)
def test_things_of_different_names_change_places(road: Design, plan: str, same: str) -> None:
    assert edited(road, plan).design == edited(road, same).design


def test_what_is_named_by_distances_is_changed_first() -> None:
    road = build(edited(CLIMBING, "turn -1: remove; start len=40: slope flat").design)
    assert len(measure(road.centreline()).turns) == 2
    assert float(road.at(35.0)[2]) == pytest.approx(float(road.at(0.0)[2]), abs=0.3)
    added = build(edited(CLIMBING, "add straight len=60 at_start; start len=40: slope down =5").design)
    for station in (5.0, 45.0, 62.0):  # the new straight falls on as the old start does
        fall = float(added.at(station)[2]) - float(added.at(station + 10)[2])
        assert fall == pytest.approx(0.5, abs=0.1)


def test_a_crest_is_made_on_the_slopes_of_the_same_plan() -> None:
    road = build(edited(CLIMBING, "add crest on(straight 2); road: slope down =3").design)
    heights = road.centreline()[:, 2]
    length = road.length
    s = np.linspace(0, length, len(heights))
    crest = heights[(s > 0.2 * length) & (s < 0.6 * length)]
    assert np.diff(crest).max() > 0  # it climbs somewhere there
    assert np.diff(heights[s < 0.15 * length]).max() < 0
    assert np.diff(heights[s > 0.7 * length]).max() < 0


def test_a_whole_straight_counts_what_is_there_after_the_removals() -> None:
    found = after(CLIMBING, "turn -1,-2: remove; add straight len=70 whole at_end")
    assert len(found.turns) == 1
    assert straights(found)[-1].length == pytest.approx(70, abs=2)


@pytest.mark.parametrize(
    "plan",
    ["turn 3: remove; add straight len=60 whole at_end", "add straight len=60 whole at_end; turn 3: remove"],
)
def test_a_whole_straight_comes_last(plan: str) -> None:
    assert straights(after(CLIMBING, plan))[-1].length == pytest.approx(60, abs=2)


def test_parts_that_a_removal_joined_are_still_found() -> None:
    found = after(CLIMBING, "turn 2: remove; turn 1: at_end; straight 3: climb =2")
    assert angles(found) == pytest.approx([40, 60], abs=4)
    assert found.turns[0].start * 0.04 + 2 == pytest.approx(0.04 * 50 + 2, abs=0.3)
    joined = straights(found)[1]
    assert joined.length * joined.grade / 100 == pytest.approx(2, abs=0.3)
    kept = after(CLIMBING, "turn 2: remove; straight 3: slope flat; turn 1,3: swap; road: climb =8")
    assert kept.climb == pytest.approx(8, abs=0.35)


def test_a_crest_may_stand_on_a_straight_that_gets_longer() -> None:
    short = "straight 4: length =60; add crest on(straight 4)"
    assert any("a crest of 60 m is new" in sentence for sentence in edited(LEVEL_END, short).changes)


def test_what_moved_is_named_as_before() -> None:
    said = edited(CLIMBING, "turn 1: remove; turn 2,3: swap").changes
    assert any(sentence.startswith("turn 2 and turn 3 have changed places") for sentence in said)
    said = edited(CLIMBING, "add straight len=100 at_end; turn 1,2: swap").changes
    assert any(sentence.startswith("straight 4: length 40 -> 140 m") for sentence in said)
    assert not any("is gone" in sentence for sentence in said)


def test_a_straight_that_differs_from_a_level_one() -> None:
    plan = "straight 1: slope flat; straight 2: slope +2 =straight 1"
    assert straights(after(CLIMBING, plan))[1].grade == pytest.approx(2, abs=0.7)


def test_differences_of_several_heights_are_those_to_the_heights_before() -> None:
    old = straights(measure(build(CLIMBING).centreline()))
    new = straights(after(CLIMBING, "straight all: climb +1; straight all: length x1.5"))
    for before, now in zip(old, new, strict=True):
        assert now.length * now.grade / 100 == pytest.approx(before.length * before.grade / 100 + 1, abs=0.35)


@pytest.mark.parametrize(
    ("plan", "grade"),
    [
        ("add turn right deg=40 r=25 between(turn 1, turn 2); road: slope up =6", 6),
        ("road: slope down =5; add hairpin left at_end", -5),
        ("road: slope x0.5; add turn right deg=50 r=25 at_end", 2),
        ("road: slope flat; add straight len=60 at_start; turn 1,2: swap", 0),
    ],
)
def test_what_is_new_has_the_slope_of_the_whole_road(plan: str, grade: float) -> None:
    road = build(edited(CLIMBING, plan).design)
    heights = road.at(np.linspace(0, road.length, 30))[:, 2]
    assert np.diff(heights) / road.length * 2900 == pytest.approx([grade] * 29, abs=0.5)


def test_what_is_new_keeps_a_slope_that_is_told_of_it() -> None:
    found = after(
        CLIMBING, "add turn right deg=50 r=25 up pct=2 at_end; road: slope up =6; straight 1: slope flat"
    )
    assert found.turns[-1].grade == pytest.approx(2, abs=1)
    own = straights(found)
    assert abs(own[0].grade) < 0.8
    assert own[1].grade == pytest.approx(6, abs=0.5)


@pytest.mark.parametrize(
    ("plan", "number", "what"),
    [("turn 3: radius ..turn 1", 2, "radius"), ("turn 3: angle turn 1..", 2, "degrees")],
)
def test_what_is_to_be_beyond_another_value_is_clearly_beyond_it(plan: str, number: int, what: str) -> None:
    turns = after(CLIMBING, plan).turns
    share = getattr(turns[number], what) / getattr(turns[0], what)
    assert 0.9 < share < 0.985 if what == "radius" else 1.015 < share < 1.1


def test_a_straight_that_is_to_be_longer_is_longer() -> None:
    longer = straights(after(CLIMBING, "straight 3: length straight 1.."))
    assert 1.01 * longer[0].length < longer[2].length < 1.1 * longer[0].length
    same = straights(after(CLIMBING, "straight all: length ..straight 2"))
    assert same[1].length == pytest.approx(
        straights(measure(build(CLIMBING).centreline()))[1].length, abs=0.5
    )


def test_splines_are_not_cut_within_bends() -> None:
    design = edit(CLIMBING, read_change_plan("start len=70: slope flat"), WORLD, "spline").design
    assert [segment.turn_degrees for segment in design.segments] == [
        segment.turn_degrees for segment in CLIMBING.segments
    ]


def test_the_map_may_grow_in_a_later_stage_and_it_is_said_once() -> None:
    plan = "turn 1,3: swap; add straight len=120 at_end; add straight len=90 at_start"
    made = edited(CLIMBING, plan)
    assert made.world.site.map_size > WORLD.site.map_size
    assert sum("m wide" in sentence for sentence in made.changes) == 1
    assert edit(CLIMBING, read_change_plan(plan), WORLD.changed(map_size=200)).world.site.map_size == 200


def test_a_stage_that_is_so_already_is_said() -> None:
    made = edited(CLIMBING, "turn: x3; turn 1,2: swap; road: reverse")
    assert any("was so already" in sentence for sentence in made.changes)
    assert angles(measure(build(made.design).centreline())) == pytest.approx([-40, -60, 80], abs=4)
    with pytest.raises(EditError, match="nothing is to be changed"):
        edited(CLIMBING, "turn all: angle 20..; turn: x3")


@pytest.mark.parametrize(
    ("plan", "complaint"),
    [
        ("turn 2: remove; turn 2: at_end", "speaks of something that the same request removes"),
        ("turn 2: remove; turn 1,2: swap", "speaks of something that the same request removes"),
        ("turn 2: at_start; turn 2: remove", "speaks of something that the same request removes"),
        ("turn 3: at_start; turn: x2", "speaks of something that the same request removes"),
        (
            "road between(turn 1, turn 2): climb =2; straight between(turn 1, turn 2): remove",
            "speaks of something that the same request removes",
        ),
        ("road: slope up =4; road: climb =8", "both give a part of the road its slopes"),
        ("straight 1: slope flat; straight 1: climb =2", "both give a part of the road its slopes"),
        ("road half1: slope flat; road: climb =8", "both give a part of the road its slopes"),
        ("road up_to(turn 2): climb =5; road from(turn 2): climb =5", "both give a part of the road"),
        ("road: slope down; road: climb =5", "contradict each other"),
        ("straight 1: climb =-2; straight 1: slope up", "contradict each other"),
        ("straight 1: climb =2; straight 1: slope steeply_up", "both give a part of the road its slopes"),
        ("road: slope ..3; straight 1: climb =5", "need requests of their own"),
        ("straight all: climb =2; straight 1: climb =3", "need requests of their own"),
        ("straight all: slope flat; turn all: slope flat; road: climb =8", "leaves nothing that could climb"),
        (
            "straight 1: climb =2; road from(turn 1): climb =3; road: climb =10",
            "leaves nothing that could climb",
        ),
        ("add crest on(straight 2); road: climb =8", "need requests of their own"),
        ("add straight len=40 pct=10 up at_end; road: climb =8", "need requests of their own"),
        ("start len=60: climb =2; road: slope down =3", "need requests of their own"),
        ("start len=120: climb =5; turn 1: remove", "need requests of their own"),
        ("add crest on(straight 2); straight 2: slope up =5", "need requests of their own"),
        ("add crest on(straight 2); straight 2: length =25", "a crest needs a straight of 40 m or more"),
        ("road: reverse; road: reverse", "reversed twice"),
        ("road: reverse; turn 1: radius =turn 1; turn 2: radius x1.5", "compares a place with itself"),
        ("turn 1: swap =turn 1", "has to name two different things"),
        ("turn all: swap =turn 1", "has to name two different things"),
        ("turn 1: swap =straight 1", "two turns, or two straights, can change places"),
        ("turn 1: mirror =turn 2", "'=' is not expected"),
        ("straight 1: length -80 =straight 2", "would be less than nothing"),
        ("turn 3: radius x0.5 =turn 2", "tighter than"),
        ("straight 1: climb +2 =straight 2", "'=' is not expected"),
    ],
)
def test_what_cannot_be_combined_is_said(plan: str, complaint: str) -> None:
    with pytest.raises(EditError, match=complaint):
        edited(CLIMBING, plan)


@pytest.mark.parametrize(
    ("plan", "number", "length"),
    [
        ("straight 2: length x2 =straight 1", 1, 101),
        ("straight -1: length +5 =straight 1", 3, 55.5),
        ("straight 3: length -15 =straight 1", 2, 35.5),
        ("straight 2: length -5 =straight 1; straight 1: length =60", 1, 55),
        ("straight 3: length x150% =straight 4", 2, 60),
    ],
)
def test_a_length_that_differs_from_another_by_so_much(plan: str, number: int, length: float) -> None:
    assert straights(after(CLIMBING, plan))[number].length == pytest.approx(length, abs=3.5)


def test_angles_radii_and_slopes_that_differ_from_others_by_so_much() -> None:
    assert after(CLIMBING, "turn 3: angle -10 =turn 1").turns[2].degrees == pytest.approx(50, abs=2)
    assert after(CLIMBING, "turn 3: radius x0.75 =turn 1").turns[2].radius == pytest.approx(22.5, rel=0.06)
    assert straights(after(CLIMBING, "straight 2: slope +2 =straight 1"))[1].grade == pytest.approx(
        6, abs=0.7
    )
    fallen = "straight 1: slope down =3; straight 2: slope x2 =straight 1"
    assert straights(after(CLIMBING, fallen))[1].grade == pytest.approx(-6, abs=0.7)


@pytest.mark.parametrize(
    "line",
    [
        "hairpin: swap =turn -1",
        "straight 2: length x2 =straight 1",
        "turn 3: radius +5 =turn 1; turn 2: angle -10 =turn sharpest",
        "road: reverse; turn all: radius x1.2; road: climb =-3",
    ],
)
def test_plans_are_written_as_they_are_read(line: str) -> None:
    assert change_plan(read_change_plan(line)) == line
