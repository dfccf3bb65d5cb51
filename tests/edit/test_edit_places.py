"""Changes of so many metres of road, of the number of turns and of their order, measured afterwards."""

import numpy as np
import pytest

from edit_truth import roads
from roadgpt import check
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.plan import read_plan
from roadgpt.check.measures import MeasuredFeature, measure
from roadgpt.design import draft
from roadgpt.errors import EditError
from roadgpt.road import Design, Segment, World, build
from roadgpt_edit.editing import Edited, edit
from tables import rows

WORLD = World()
STRAIGHT = draft(read_plan("straight flat len=240"), WORLD, seed=1)
WINDING = draft(read_plan("turn x5 alternating | flat"), WORLD, seed=3)
LISTED = draft(
    read_plan(
        "straight len=60; turn left deg=60 r=30; straight len=60; turn right deg=90 r=25; straight len=60; "
        "hairpin left | flat"
    ),
    WORLD,
    seed=2,
)
JOINT = 40.0  # m before and behind a joint of slopes, where a parabola joins them


def edited(design: Design, plan: str) -> Edited:
    return edit(design, read_change_plan(plan), WORLD)


def turns(design: Design) -> tuple[MeasuredFeature, ...]:
    return measure(build(design).centreline()).turns


def grades(design: Design, low: float, high: float) -> np.ndarray:
    """The grades in percent of pieces of 5 m between two shares of the road, from its heights."""
    road = build(design)
    s = np.arange(low * road.length, high * road.length, 5.0)
    return 100 * np.diff(road.at(s)[:, 2]) / 5.0


@pytest.mark.parametrize(
    ("plan", "start", "end", "grade"),
    [
        ("end len=80: slope down =5", -80, 0, -5.0),
        ("start len=100: slope up =6", 0, 100, 6.0),
        ("road half1: slope up =4", 0, 0.5, 4.0),
        ("end len=120: climb =6", -120, 0, 5.0),
        ("start len=60: slope steeply_down", 0, 60, -9.0),
    ],
)
def test_so_many_metres_of_a_straight_have_a_slope_of_their_own(
    plan: str, start: float, end: float, grade: float
) -> None:
    after, length = edited(STRAIGHT, plan).design, build(STRAIGHT).length
    low, high = start % length / length, (end or length) / length if end != 0.5 else 0.5
    joint = JOINT / length
    inside = grades(after, low + joint * (low > 0), high - joint * (high < 1))
    assert inside == pytest.approx(grade, abs=0.05)
    outside = (0.0, low - joint) if low > 0 else (high + joint, 1.0)
    assert grades(after, *outside) == pytest.approx(grades(STRAIGHT, *outside), abs=0.05)
    assert build(after).length == pytest.approx(length, abs=0.5)
    assert check.inspect(build(after), None, WORLD) == ()


BENT = draft(
    read_plan(
        "straight len=40; turn left deg=107 r=18; straight len=30; turn right deg=116 r=37; straight len=45 "
        "| flat"
    ),
    WORLD,
    seed=1,
)
"""The arcs of its turns reach from 46 to 74 m and from 125 to 184 m."""


@pytest.mark.parametrize("station", [54, 60, 62, 140, 155, 172])
def test_a_stretch_ends_within_an_arc_and_the_line_of_the_road_stays(station: int) -> None:
    before, after = (
        build(design) for design in (BENT, edited(BENT, f"start len={station}: slope up =4").design)
    )
    stations = np.linspace(0, min(before.length, after.length), 500)
    assert after.length == pytest.approx(before.length, abs=0.004)
    assert np.hypot(*(after.at(stations) - before.at(stations))[:, :2].T).max() < 0.003
    heights = after.at(np.array([0.0, station, after.length]))[:, 2]
    assert heights[2] - heights[0] == pytest.approx(0.04 * station, abs=0.1)  # level behind it
    assert (
        float(after.at(float(station))[2]) - heights[0] < 0.04 * station - 0.02
    )  # the crest is rounded there
    assert check.inspect(after, None, WORLD) == ()


def test_a_stretch_that_ends_amid_a_long_turn_is_refused() -> None:
    turn = Segment(distance=61.09, direction="left", turn_degrees=70.0, radius=50.0)
    design = Design(
        starting_point=(100.0, 50.0, 0.0),
        theta=90.0,
        segments=(
            Segment(distance=20.0, direction="straight"),
            turn,
            Segment(distance=60.0, direction="straight"),
        ),
    )
    with pytest.raises(EditError, match=r"station 50 m of this road lies in a turn"):
        edited(design, "start len=50: slope up")


@pytest.mark.parametrize(
    ("plan", "complaint"),
    rows(__file__, "what_cannot_be_is_said_in_a_sentence"),
)
def test_what_cannot_be_is_said_in_a_sentence(plan: str, complaint: str) -> None:
    with pytest.raises(EditError, match=complaint):
        edited(WINDING, plan)


@pytest.mark.parametrize(("plan", "sides"), [("turn: x3", 3), ("turn: x..4", 4), ("turn: x6..", 6)])
def test_a_road_gets_so_many_turns(plan: str, sides: int) -> None:
    before, after = turns(WINDING), turns(edited(WINDING, plan).design)
    assert len(after) == sides
    kept = min(len(before), len(after))
    assert [t.side for t in after[:kept]] == [t.side for t in before[:kept]]
    assert [t.radius for t in after[:kept]] == pytest.approx([t.radius for t in before[:kept]], rel=0.1)


def test_turns_of_one_side_are_counted_alone() -> None:
    before = [turn.side for turn in turns(WINDING)]
    after = [turn.side for turn in turns(edited(WINDING, "turn left: x1").design)]
    assert after.count("left") == 1
    assert after.count("right") == before.count("right")
    hairpins = roads()["h05"]
    assert len(turns(edited(hairpins, "hairpin: x2").design)) == len(turns(hairpins)) + 1


@pytest.mark.parametrize(
    ("plan", "order"),
    [
        ("turn 3: at_start", (2, 0, 1)),
        ("turn 1: at_end", (1, 2, 0)),
        ("turn 3: before(turn 2)", (0, 2, 1)),
        ("turn 1: after(turn 2)", (1, 0, 2)),
        ("turn 3: between(turn 1, turn 2)", (0, 2, 1)),
        ("turn 1: at_middle", (1, 0, 2)),
        ("turn 3: before(straight 1)", (2, 0, 1)),
        ("turn 1,3: swap", (2, 1, 0)),
    ],
)
def test_a_turn_moves_with_its_angle_and_radius(plan: str, order: tuple[int, ...]) -> None:
    before, made = turns(LISTED), edited(LISTED, plan)
    after = turns(made.design)
    assert [turn.side for turn in after] == [before[i].side for i in order]
    assert [turn.degrees for turn in after] == pytest.approx([before[i].degrees for i in order], abs=4)
    assert [turn.radius for turn in after] == pytest.approx([before[i].radius for i in order], rel=0.1)
    assert build(made.design).length == pytest.approx(build(LISTED).length, rel=0.1)
    assert "named as before" in made.changes[0]


@pytest.mark.parametrize(
    ("plan", "low", "high"),
    [
        ("straight 2: slope steeply_up", 6.5, 15.0),
        ("straight 2: slope gently_up", 1.3, 5.5),
        ("straight 2: slope steeply_down", -15.0, -6.5),
        ("turn 2: slope gently_down", -5.5, -1.3),
    ],
)
def test_a_word_for_steepness_is_a_range_of_grades(plan: str, low: float, high: float) -> None:
    found = measure(build(edited(LISTED, plan).design).centreline())
    feature = (
        found.turns[1] if plan.startswith("turn") else next(f for f in found.gaps[1] if f.kind == "straight")
    )
    assert low <= feature.grade <= high


@pytest.mark.parametrize(("kind", "sign"), [("crest", 1), ("dip", -1)])
def test_a_crest_or_a_dip_lies_where_it_is_asked_for(kind: str, sign: int) -> None:
    made = edited(STRAIGHT, f"add {kind} at_middle")
    road = build(made.design)
    s = np.arange(0.0, road.length, 1.0)
    heights = sign * (road.at(s)[:, 2] - build(STRAIGHT).at(s)[:, 2])
    assert s[heights.argmax()] == pytest.approx(road.length / 2, abs=5)
    assert heights.max() > 1.5
    assert road.length == pytest.approx(build(STRAIGHT).length, abs=0.1)
    assert check.inspect(road, None, WORLD) == ()
    assert made.changes[0].startswith(f"a {kind} of 120 m is new, its middle at")


@pytest.mark.parametrize(
    "place", ["on(straight 2)", "between(turn 1, turn 2)", "after(turn 1)", "before(turn 2)"]
)
def test_a_crest_lies_on_the_straight_that_is_named(place: str) -> None:
    road, after = build(LISTED), build(edited(LISTED, f"add crest {place}").design)
    first, second, _ = turns(LISTED)
    middle = (first.end + second.start) / 2
    rises = after.at(np.array([first.end, middle, second.start]))[:, 2]
    assert rises[1] > max(rises[0], rises[2]) + 0.3
    before = np.arange(0.0, first.start, 2.0)
    assert after.at(before)[:, 2] == pytest.approx(road.at(before)[:, 2], abs=0.3)


@pytest.mark.parametrize(
    ("plan", "complaint"),
    [
        ("add crest x2 at_end", "adds several at once"),
        ("add zigzag at_end", "'zigzag' cannot be added"),
        ("add dip on(straight shortest)", r"a dip needs a straight of 40 m or more; there are \d+ m"),
    ],
)
def test_a_hill_that_cannot_be_added_is_refused(plan: str, complaint: str) -> None:
    with pytest.raises(EditError, match=complaint):
        edited(WINDING, plan)


@pytest.mark.parametrize(
    ("plan", "complaint"),
    rows(__file__, "what_would_be_done_in_part_or_at_another_place_is_refused"),
)
def test_what_would_be_done_in_part_or_at_another_place_is_refused(plan: str, complaint: str) -> None:
    with pytest.raises(EditError, match=complaint):
        edited(LISTED if "straight -1" in plan or "turn 3)" in plan else WINDING, plan)


def test_limits_of_a_stretch_concern_its_own_slopes() -> None:
    ridge = edited(STRAIGHT, "road half1: slope up =7; road half2: slope down =3").design
    assert edited(ridge, "end len=80: slope ..2").design != ridge
    with pytest.raises(EditError, match="is so already"):
        edited(ridge, "end len=80: slope ..6")
