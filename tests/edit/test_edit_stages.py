"""Changes that cannot be made at once: they are made one after the other, and measured afterwards."""

import numpy as np
import pytest

from edit_truth import roads
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.plan import read_plan
from roadgpt.check.measures import MeasuredFeature, RoadMeasures, measure
from roadgpt.design import draft
from roadgpt.errors import EditError, IdleEditError
from roadgpt.road import Design, World, build
from roadgpt_edit.editing import Edited, edit
from tables import rows

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


def after(design: Design, plan: str) -> RoadMeasures:
    """What a person sees of the road after the changes of a plan."""
    return measure(build(edited(design, plan).design).centreline())


def angles(found: RoadMeasures) -> list[float]:
    """The angles of all turns, positive to the left."""
    return [turn.degrees if turn.side == "left" else -turn.degrees for turn in found.turns]


def straights(found: RoadMeasures) -> list[MeasuredFeature]:
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


@pytest.mark.parametrize("name", sorted(ROADS)[::6])
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


@pytest.mark.parametrize(
    ("plan", "metres"),
    rows(__file__, "a_height_holds_when_all_else_is_done"),
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


@pytest.mark.parametrize(
    ("plan", "wanted"),
    rows(__file__, "places_are_those_before_the_change_in_the_order_of_the_plan"),
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


def test_a_crest_is_made_on_the_slopes_of_the_same_plan() -> None:
    road = build(edited(CLIMBING, "add crest on(straight 2); road: slope down =3").design)
    heights = road.centreline()[:, 2]
    length = road.length
    s = np.linspace(0, length, len(heights))
    crest = heights[(s > 0.2 * length) & (s < 0.6 * length)]
    assert np.diff(crest).max() > 0  # it climbs somewhere there
    assert np.diff(heights[s < 0.15 * length]).max() < 0
    assert np.diff(heights[s > 0.7 * length]).max() < 0


@pytest.mark.parametrize(
    "plan",
    ["turn 3: remove; add straight len=60 whole at_end", "add straight len=60 whole at_end; turn 3: remove"],
)
def test_a_whole_straight_comes_last(plan: str) -> None:
    assert straights(after(CLIMBING, plan))[-1].length == pytest.approx(60, abs=2)


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


def test_the_map_may_grow_in_a_later_stage_and_it_is_said_once() -> None:
    plan = "turn 1,3: swap; add straight len=120 at_end; add straight len=90 at_start"
    made = edited(CLIMBING, plan)
    assert made.world.site.map_size > WORLD.site.map_size
    assert sum("m wide" in sentence for sentence in made.changes) == 1
    assert edit(CLIMBING, read_change_plan(plan), WORLD.changed(map_size=200)).world.site.map_size == 200


@pytest.mark.parametrize(
    ("plan", "complaint"),
    rows(__file__, "what_cannot_be_combined_is_said"),
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
