"""Features of roads against figures known from elsewhere, and the map's cells against a slow search."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief import read
from roadgpt.campaign.columns import cell_of
from roadgpt.road import Design, Segment, build
from roadgpt_search.behaviour import BOUNDS, behaviour_of, directions


def bend(turn: float, radius: float, incline: float = 0.0) -> Segment:
    """A turn of a known radius, in degrees and metres."""
    ramp = 4.0
    return Segment(
        distance=radius * math.radians(abs(turn)) + ramp,
        direction="left" if turn > 0 else "right",
        turn_degrees=turn,
        radius=radius,
        transition=ramp,
        incline=incline,
    )


def straight(length: float, incline: float = 0.0) -> Segment:
    return Segment(distance=length, direction="straight", incline=incline)


def road_of(*segments: Segment):
    return build(Design(starting_point=(60, 60, 5), theta=10, segments=segments))


def test_a_road_has_the_features_that_it_was_drawn_with() -> None:
    road = road_of(straight(40, 5), bend(60, 30, 5), straight(40, 5), bend(-45, 50, 5), straight(30, 5))
    found = behaviour_of(road, None)
    assert found["RADIUS"] == pytest.approx(30, rel=0.03)
    assert found["TURNS"] == 2
    assert found["LEFT"] == 0.5
    assert found["TURNED"] == pytest.approx(105, abs=1)
    assert found["LENGTH"] == pytest.approx(road.length, abs=0.5)
    assert found["GRADE"] == pytest.approx(5, abs=0.2)
    assert found["CLIMB"] == pytest.approx(0.05 * road.length, abs=0.3)
    assert set(found) <= set(BOUNDS)


def test_sides_and_turns_are_counted_in_driving_order() -> None:
    brief = read("turn x3", reader="plan")
    bends = [bend(60, 30), bend(45, 50), bend(-90, 40)]
    road = road_of(straight(40), bends[0], straight(30), bends[1], straight(30), bends[2], straight(20, -6))
    found = behaviour_of(road, brief)
    assert (found["TURNS"], found["LEFT"]) == (3, pytest.approx(2 / 3))
    assert [found[f"DEGREES_{n}"] for n in (1, 2, 3)] == pytest.approx([60, 45, 90], abs=0.5)
    assert [found[f"RADIUS_{n}"] for n in (1, 2, 3)] == pytest.approx([30, 50, 40], rel=0.03)
    assert found["GRADE"] == pytest.approx(6, abs=0.1)
    assert found["CLIMB"] == pytest.approx(float(road.at(road.length)[2] - road.at(0.0)[2]), abs=0.01)
    assert found["CLIMB"] < -0.5
    assert set(behaviour_of(road, None)) == set(found) - {
        f"{w}_{n}" for w in ("DEGREES", "RADIUS") for n in (1, 2, 3)
    }


@given(st.floats(0, 6.28), st.integers(1, 72))
def test_directions_are_counted_all_round(start: float, tens: int) -> None:
    """Turning on by so many times 5 degrees passes that many times two half directions."""
    heading = start + np.radians(np.arange(0.0, 5.0 * tens, 0.25))
    slow = {int(math.degrees(h) % 360 // 10) for h in heading}
    assert directions(heading) == pytest.approx(len(slow) / 36)
    if tens == 72:
        assert directions(heading) == 1.0  # the field's own DIR_COV gives a circle 0.5


@given(st.floats(-1, 2), st.floats(-500, 500), st.integers(2, 40))
def test_a_cell_is_the_one_whose_borders_enclose_the_value(
    curvature: float, angle: float, cells: int
) -> None:
    found = cell_of({"MAX_CURV": curvature, "STD_SA": angle}, ("MAX_CURV", "STD_SA"), cells, BOUNDS)
    assert found is not None
    for axis, value, at in zip(("MAX_CURV", "STD_SA"), (curvature, angle), found, strict=True):
        low, high = BOUNDS[axis]
        borders = np.linspace(low, high, cells + 1)
        inside = min(max(value, low), high)
        assert 0 <= at < cells
        assert borders[at] - 1e-9 <= inside <= borders[at + 1] + 1e-9
