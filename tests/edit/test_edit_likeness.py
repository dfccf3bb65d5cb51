"""Changes that take a value from another place, or name the stations between which a slope changes."""

from itertools import pairwise

import numpy as np
import pytest

from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.plan import read_plan
from roadgpt.check.measures import MeasuredFeature, RoadMeasures, measure
from roadgpt.design import draft
from roadgpt.errors import EditError
from roadgpt.road import Design, World, build
from roadgpt_edit.editing import Edited, edit
from tables import rows

WORLD = World()
STRAIGHT = draft(read_plan("straight flat len=240"), WORLD, seed=1)
LENGTH = build(STRAIGHT).length
LISTED = draft(
    read_plan(
        "straight len=60; turn left deg=60 r=40; straight len=35; turn right deg=90 r=25; straight len=50; "
        "turn left deg=45 r=30; straight len=30 | flat"
    ),
    WORLD,
    seed=2,
)


def edited(design: Design, plan: str) -> Edited:
    return edit(design, read_change_plan(plan), WORLD)


def measured(design: Design) -> RoadMeasures:
    return measure(build(design).centreline())


def turns(design: Design) -> tuple[MeasuredFeature, ...]:
    return measured(design).turns


def lengths(design: Design) -> list[float]:
    return [straight.length for straight in measured(design).straights]


def mean_grade(design: Design, start: float, end: float) -> float:
    """The mean grade in percent between two stations in metres."""
    road = build(design)
    return float(100 * (road.at(end)[2] - road.at(start)[2]) / (end - start))


@pytest.mark.parametrize(
    "plan", ["turn 3: angle =turn 1", "turn right: angle =turn 1", "turn -1: angle =turn 1"]
)
def test_an_angle_is_taken_from_another_turn(plan: str) -> None:
    after = turns(edited(LISTED, plan).design)
    changed = after[1 if "right" in plan else 2]
    assert changed.degrees == pytest.approx(turns(LISTED)[0].degrees, abs=1.5)


@pytest.mark.parametrize("place", ["road: length", "straight 1: length", "turn 2: angle", "turn 2: radius"])
def test_slightly_and_much_are_less_and_more_than_the_plain_word(place: str) -> None:
    def of(design: Design) -> float:
        turn = turns(design)[1]
        return {"road": build(design).length, "stra": lengths(design)[0]}.get(
            place[:4], turn.degrees if "angle" in place else turn.radius
        )

    words = ("much less", "less", "slightly less", "slightly more", "more", "much more")
    found = [of(edited(LISTED, f"{place} {word}").design) for word in words]
    found.insert(3, of(LISTED))
    assert all(other > 1.01 * one for one, other in pairwise(found)), found


def test_no_longer_than_another_changes_only_what_is_longer() -> None:
    before, after = lengths(LISTED), lengths(edited(LISTED, "straight all: length ..straight 2").design)
    assert max(after) <= before[1] + 1.0
    assert after[3] == pytest.approx(before[3], abs=0.5)


def test_at_least_as_much_as_another_changes_only_what_is_less() -> None:
    before, after = turns(LISTED), turns(edited(LISTED, "turn all: radius turn 3..").design)
    assert min(turn.radius for turn in after) >= 0.95 * before[2].radius
    assert after[0].radius == pytest.approx(before[0].radius, rel=0.02)


@pytest.mark.parametrize(("first", "grade"), [("up =5", 5.0), ("down =4", -4.0), ("flat", 0.0)])
def test_a_slope_is_taken_with_its_direction(first: str, grade: float) -> None:
    sloped = edited(LISTED, f"road: slope up =7; straight 1: slope {first}").design
    after = edited(sloped, "straight 3: slope =straight 1").design
    model, found = measured(sloped).straights[0].grade, measured(after).straights[2].grade
    assert found == pytest.approx(model, abs=0.6)
    assert model == pytest.approx(grade, abs=1.0)  # the tolerance of a grade that words give


@pytest.mark.parametrize(
    ("plan", "start", "end", "grade"),
    [
        ("road after(start len=150): slope down =4", 150, 0, -4.0),
        ("road from(end len=90): slope down =4", -90, 0, -4.0),
        ("road before(start len=80): slope up =5", 0, 80, 5.0),
        ("road between(start len=60, start len=160): slope up =6", 60, 160, 6.0),
        ("road between(end len=40, end len=120): slope up =6", -120, -40, 6.0),
        ("road between(start len=60, end len=60): climb =4", 60, -60, 100 * 4 / (LENGTH - 120)),
    ],
)
def test_stations_bound_a_slope(plan: str, start: float, end: float, grade: float) -> None:
    after = edited(STRAIGHT, plan).design
    length = build(after).length
    assert length == pytest.approx(LENGTH, abs=1.0)
    start, end = start % LENGTH, end % LENGTH or LENGTH
    middle = np.array([start + 0.3 * (end - start), start + 0.7 * (end - start)])
    assert mean_grade(after, *middle) == pytest.approx(grade, abs=0.7)
    for low, high in ((0, start), (end, length)):
        if high - low > 50:  # what lies outside stays level beyond the joint
            away = (low, high - 25) if low == 0 else (low + 25, high)
            assert abs(mean_grade(after, *away)) < 0.6


@pytest.mark.parametrize(
    ("plan", "complaint"),
    [
        ("turn 2: radius =straight 1", "compares with a straight, which does not bend"),
        ("turn 2: angle =turn all", "has to compare with one turn or one straight"),
        ("straight 2: length =road", "has to compare with one turn or one straight"),
        ("turn 2: radius =turn 9", "there is no ninth turn"),
        ("straight 2: length =start len=40", "cannot name a place"),
        ("straight 1: climb =straight 2", "is not expected"),
        ("turn 2: radius +turn 1", "is not expected"),
        ("turn 2: radius turn 1", "something is missing"),
        ("road after(start len=900): slope up", f"the road is only {LENGTH:.0f} m long, not 900 m"),
        ("road between(start len=50, end len=900): slope up", "not 900 m"),
        ("road between(start len=50, start len=52): slope up", "too short for a slope"),
        ("road between(turn 1, start len=50): slope up", "mixes distances with other words"),
        ("road flat after(start len=50): slope up", "mixes distances with other words"),
        ("road on(start len=50): slope up", "mixes distances with other words"),
        ("road after(start len=50): length more", "only its slope or its climb can be changed"),
    ],
)
def test_what_cannot_be_taken_or_bounded_is_said(plan: str, complaint: str) -> None:
    with pytest.raises(EditError, match=complaint):
        edited(STRAIGHT if "start len" in plan else LISTED, plan)


@pytest.mark.parametrize(
    ("plan", "length"),
    [
        ("road: length +20; straight 2: length ..100", 20),
        ("road: length -20; straight 2: length =35", -20),
        ("straight 1: length 20..; road: length +30", 30),
    ],
)
def test_a_wish_that_is_met_does_not_change_the_length_of_the_road(plan: str, length: float) -> None:
    before, after = build(LISTED).length, build(edited(LISTED, plan).design).length
    assert after - before == pytest.approx(length, abs=0.025 * before)


@pytest.mark.parametrize(
    "plan",
    [
        "road: slope up =7; straight 1: slope ..5",
        "straight all: length =70; straight 2: length ..50",
        "turn all: radius x2; turn 2: radius ..40",
    ],
)
def test_a_limit_that_another_wish_breaks_is_refused(plan: str) -> None:
    with pytest.raises(EditError, match="need requests of their own"):
        edited(LISTED, plan)


@pytest.mark.parametrize(
    "plan",
    [
        "road: slope up =4; road after(start len=150): slope down =4",
        "road after(start len=150): slope down =4; road: slope up =4",
    ],
)
def test_a_stretch_keeps_its_own_slope_beside_a_wish_for_the_whole_road(plan: str) -> None:
    after = edited(STRAIGHT, plan).design
    assert mean_grade(after, 20, 110) == pytest.approx(4, abs=0.5)
    assert mean_grade(after, 190, LENGTH - 5) == pytest.approx(-4, abs=0.5)


def test_a_shorter_stretch_wins_over_a_longer_one() -> None:
    after = edited(STRAIGHT, "start len=60: slope flat; start len=200: slope up =6").design
    assert abs(mean_grade(after, 0, 35)) < 0.7
    assert mean_grade(after, 110, 170) == pytest.approx(6, abs=0.5)


@pytest.mark.parametrize(
    ("plan", "number", "radius"),
    [
        ("turn 1: radius +10; turn 2: radius =turn 1", 1, 50),
        ("turn 1: radius x1.5; turn 2: radius =turn 1", 1, 60),
        ("turn 3: radius ..60; turn 2: radius =turn 3", 1, 30),
    ],
)
def test_the_new_value_of_a_model_is_computed(plan: str, number: int, radius: float) -> None:
    before = turns(LISTED)
    measured_at = {50: before[0].radius + 10, 60: 1.5 * before[0].radius, 30: before[2].radius}
    assert turns(edited(LISTED, plan).design)[number].radius == pytest.approx(measured_at[radius], rel=0.06)


@pytest.mark.parametrize(
    "plan",
    [
        "turn 2: radius =turn 3; turn 3: radius =turn 1",
        "turn 2: shape hairpin; turn 1: angle =turn 2",
        "straight 1: length =turn 1; turn 1: radius =25",
        "straight 1: slope more; straight 3: slope =straight 1",
    ],
)
def test_the_unknown_new_value_of_a_model_is_refused(plan: str) -> None:
    with pytest.raises(EditError, match="need requests of their own"):
        edited(LISTED, plan)


@pytest.mark.parametrize(
    ("plan", "complaint"),
    rows(__file__, "what_says_nothing_is_said"),
)
def test_what_says_nothing_is_said(plan: str, complaint: str) -> None:
    with pytest.raises(EditError, match=complaint):
        edited(LISTED, plan)
