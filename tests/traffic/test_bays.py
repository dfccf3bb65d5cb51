"""Parking bays at an angle: how the cars stand in them, and how they leave them."""

import math
from itertools import pairwise

import numpy as np
import pytest
import shapely

from roadgpt.brief.plan import plan, read_plan
from roadgpt.errors import BriefError
from roadgpt.geometry.boxes import corners
from roadgpt.run import Run, Setup, perform
from roadgpt.traffic import SIZES

LEAST = 2.5  # m, width of a bay across the car that stands in it (RASt 06)


def run_of(scene: str, words: str = "straight 200") -> Run:
    return perform(f"{words} && ego v=30; {scene}", seed=6, setup=Setup(driver="reference", reader="plan"))


def turned(run: Run, n: int, at: int) -> float:
    """By how many degrees somebody points to the left of the road where it is."""
    assert run.road is not None
    assert run.drive is not None
    assert run.drive.others is not None
    x, y, _, heading, _ = run.drive.others.states[at, n]
    s, _ = run.road.locate(np.array([x]), np.array([y]))
    return math.degrees(math.remainder(heading - float(run.road.heading(s)[0]), 2 * math.pi))


@pytest.mark.parametrize(
    ("words", "side", "angle", "wanted"),
    [
        ("straight 200", "right", 60, -60.0),
        ("straight 200", "left", 45, 135.0),  # as the oncoming lane leads, with the nose to its right
        ("straight 200 | oneway", "left", 90, 90.0),
        ("straight 200 || left_hand", "left", 60, 60.0),
    ],
)
def test_a_row_stands_at_that_angle_beside_the_lanes(
    words: str, side: str, angle: int, wanted: float
) -> None:
    run = run_of(f"parked {side} angle={angle}", words)
    assert run.road is not None
    assert run.drive is not None
    others = run.drive.others
    assert others is not None
    assert len(others.actors) > 20
    boxes = []
    profile = run.world.profile_of(run.road)
    for n, actor in enumerate(others.actors):
        assert turned(run, n, 0) == pytest.approx(wanted, abs=0.5)
        x, y, _, heading, _ = others.states[0, n]
        box = corners(np.array([x, y]), heading, np.array(SIZES[actor.kind][:2]))
        boxes.append(shapely.Polygon(box))
        s, t = run.road.locate(*np.array(box).T)
        edges = profile.edges(s)
        inside = edges.left - t if side == "left" else t - edges.right
        assert -0.3 < inside.max() <= 0.0
    headings, moved = others.states[0, :-1, 3], np.diff(others.states[0, :, :2], axis=0)
    apart = np.abs(moved[:, 0] * np.sin(headings) - moved[:, 1] * np.cos(headings)).min()
    assert apart > 0.99 * LEAST  # in wide bends nearly
    assert not any(one.intersects(two) for one, two in pairwise(boxes))


@pytest.mark.parametrize("angle", [45, 60, 90])
@pytest.mark.parametrize(("what", "nose"), [("turn_in", 1.0), ("reverse", -1.0)])
def test_one_leaves_its_bay_ahead_or_in_reverse(what: str, nose: float, angle: int) -> None:
    run = run_of(f"car beside right angle={angle} s=120: {what} time=2")
    assert run.drive is not None
    assert run.drive.others is not None
    assert run.road is not None
    states = run.drive.others.states[:, 0]
    is_there = ~np.isnan(states[:, 0])
    states = states[is_there]
    assert turned(run, 0, int(is_there.argmax())) == pytest.approx(nose * angle, abs=4.0)
    moved = np.diff(states[:, :2], axis=0)
    ahead = moved[:, 0] * np.cos(states[:-1, 3]) + moved[:, 1] * np.sin(states[:-1, 3])
    assert (nose * ahead > -1e-3).all()
    assert nose * ahead.sum() > 5.0
    _, t = run.road.locate(states[:, 0], states[:, 1])
    edge = float(run.world.profile_of(run.road).edges(120.0).right)
    length, width, _ = SIZES["car"]
    half = (length * math.sin(math.radians(angle)) + width * math.cos(math.radians(angle))) / 2
    assert edge - 0.3 < t[0] + half < edge  # wholly beside the lanes at first
    assert t.max() > -2.5  # and in the lane then


def test_plans_say_the_angle_and_of_whom() -> None:
    line = "straight len=200 && car beside right angle=45: reverse; parked left; parked right angle=60"
    assert plan(read_plan(line)) == line
    for wrong in ("car beside right angle=45", "car ahead angle=45: brake", "parked right angle=20"):
        with pytest.raises(BriefError):
            read_plan(f"straight 200 && {wrong}")
