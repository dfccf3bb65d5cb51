"""Two wishes for the same place: opposites are refused by name, and a part of the road keeps its own wish."""

from itertools import combinations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.brief.change.plan import read_change_plan
from roadgpt.check.measures import RoadMeasures, measure
from roadgpt.errors import EditError, IdleEditError
from roadgpt.road import Design, Segment, World, build
from roadgpt_edit.editing import edit
from tables import rows

PARTS = [(30, 0), (26, 50), (45, 0), (30, -60), (40, 0), (32, 70), (50, 0)]
ROAD = Design(
    starting_point=(60, 40, 10),
    theta=45,
    segments=tuple(
        Segment(
            distance=d, direction="left" if t > 0 else "right" if t else "straight", turn_degrees=t, incline=2
        )
        for d, t in PARTS
    ),
)
OPPOSITES = rows(__file__, "opposites")
COMPATIBLE = rows(__file__, "compatible")


def after(plan: str) -> Design:
    return edit(ROAD, read_change_plan(plan), World()).design


@pytest.mark.parametrize(("one", "other"), OPPOSITES)
def test_opposites_are_refused_by_name_in_either_order(one: str, other: str) -> None:
    for first, second in ((one, other), (other, one)):
        with pytest.raises(EditError, match="contradict each other; leave one of them out") as raised:
            after(f"{first}; {second}")
        assert f"'{first}'" in str(raised.value)
        assert f"'{second}'" in str(raised.value)


@pytest.mark.parametrize(("one", "other"), COMPATIBLE)
def test_what_can_both_be_meant_is_done_in_either_order(one: str, other: str) -> None:
    was = measure(build(ROAD).centreline())
    for plan in (f"{one}; {other}", f"{other}; {one}"):
        try:
            design = after(plan)
        except IdleEditError:
            continue
        now = measure(build(design).centreline())
        for wish in (one, other):
            assert holds(wish, was, now), (plan, wish)


def holds(wish: str, was: RoadMeasures, now: RoadMeasures) -> bool:
    """Does the changed road have what one wish asks for? Written without the code that edits."""
    place, said = wish.split(": ")
    if place == "road" or place.startswith("straight") or "slope" in said:
        return True
    one, new = (road.turns[int(place.split()[1]) - 1] for road in (was, now))
    what, value = said.split(" ", 1)
    if what == "side":
        return new.side == value
    if what == "shape":
        return new.radius > 38 if value == "gentle" else new.degrees > 140
    before, after = (turn.degrees if what == "angle" else turn.radius for turn in (one, new))
    slack = 0.06 * after
    if value in ("more", "less"):
        return after > 1.02 * before if value == "more" else after < 0.98 * before
    if value.startswith("="):
        return abs(after - float(value[1:])) < slack
    if value.startswith(".."):
        return after < float(value[2:]) + slack
    return (
        after > float(value[:-2]) - slack if value.endswith("..") else abs(after - before - float(value)) < 3
    )


def radii(design: Design) -> list[float]:
    return [turn.radius for turn in measure(build(design).centreline()).turns]


def test_a_wish_without_a_number_goes_no_further_than_a_limit() -> None:
    was, now = radii(ROAD), radii(after("turn 2: radius less; turn 2: radius 19.."))
    assert now[1] == pytest.approx(19, rel=0.04)  # alone, it would be 15 m
    assert now[0::2] == pytest.approx(was[0::2], rel=0.02)


def test_what_would_undo_itself_is_done_once() -> None:
    once, twice = (
        measure(build(after(plan)).centreline()).turns
        for plan in ("turn 2: side other", "turn 2: side other; turn 2: side other")
    )
    assert [turn.side for turn in twice] == [turn.side for turn in once] == ["left", "left", "left"]
    assert after("road: mirror; road: mirror") == after("road: mirror")
    told = edit(ROAD, read_change_plan("turn 2: side other; turn 2: side other"), World()).changes
    assert told.count("'turn 2: side other' is asked for twice and done once") == 1


@pytest.mark.parametrize(
    "plans", ["turn all: angle +10; turn 2: angle +20", "turn 2: angle +20; turn all: angle +10"]
)
def test_a_part_keeps_its_own_wish(plans: str) -> None:
    before, now = (measure(build(design).centreline()).turns for design in (ROAD, after(plans)))
    more = [turn.degrees - was.degrees for turn, was in zip(now, before, strict=True)]
    assert more == pytest.approx([10, 20, 10], abs=2.5)


SIZES = ["more", "less", "=30", "=60", "40..", "..35"]


@settings(max_examples=8, deadline=None)
@given(st.sampled_from([*combinations(SIZES, 2)]), st.sampled_from(["straight 2: length", "turn 2: radius"]))
def test_no_two_wishes_are_half_done(sizes: tuple[str, str], of: str) -> None:
    """Either the road has what both ask for, or nothing is built."""
    try:
        design = after("; ".join(f"{of} {size}" for size in sizes))
    except EditError:
        return
    found, was = (measure(build(each).centreline()) for each in (design, ROAD))
    now, then = (
        each.turns[1].radius if "turn" in of else [f for f in each.features if f.kind == "straight"][1].length
        for each in (found, was)
    )
    holds = {
        "more": now > then - 0.5,
        "less": now < then + 0.5,
        "=30": abs(now - 30) < 3.1,
        "=60": abs(now - 60) < 4,
        "40..": now > 38.5,
        "..35": now < 36.5,
    }
    assert all(holds[size] for size in sizes), (sizes, then, now)
