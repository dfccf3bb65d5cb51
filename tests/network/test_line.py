"""Checks the Line on arcs, whose stations and offsets are known."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.network.line import SPACING, Line

LENGTH, GRADE, WIDTH = 60.0, 0.05, 3.5


def arc(radius: float) -> Line:
    """Returns an arc to the left that begins at the origin along x, and rises."""
    s = np.linspace(0.0, LENGTH, int(LENGTH / SPACING) + 1)
    x, y = radius * np.sin(s / radius), radius * (1 - np.cos(s / radius))
    return Line.through(np.column_stack([x, y, GRADE * s]), WIDTH)


def place(radius: float, s: float, t: float) -> tuple[float, float, float]:
    """Returns x, y and heading at a station of the arc, which goes straight on beyond its ends."""
    within = min(max(s, 0.0), LENGTH)
    heading, beyond = within / radius, s - within
    x = (radius - t) * math.sin(heading) + beyond * math.cos(heading)
    return x, radius - (radius - t) * math.cos(heading) + beyond * math.sin(heading), heading


@given(st.floats(15.0, 500.0), st.floats(-20.0, LENGTH + 20.0), st.floats(-6.0, 6.0))
def test_places_along_an_arc_are_the_exact_ones(radius: float, s: float, t: float) -> None:
    line, (x, y, heading) = arc(radius), place(radius, s, t)
    near_end = min(abs(s), abs(s - LENGTH)) < 2 * SPACING  # the headings of the last points are one-sided
    slack = 0.1 if near_end or not 0.0 <= s <= LENGTH else 2e-3
    assert line.pose(s, t) == pytest.approx((x, y, GRADE * s, heading), abs=5 * slack)
    assert [float(each) for each in line.locate(x, y)] == pytest.approx([s, t], abs=5 * slack)


@given(st.floats(15.0, 500.0), st.floats(5.0, LENGTH - 5.0), st.floats(-6.0, 6.0), st.floats(-3.0, 3.0))
def test_boxes_lie_and_move_to_a_line_as_they_do_on_the_ground(
    radius: float, s: float, t: float, turned: float
) -> None:
    line, (x, y, heading) = arc(radius), place(radius, s, t)
    size = np.array([4.6, 1.8])
    boxes = line.boxes(np.array([[x, y, 0.0, heading + turned, 10.0]]), size)
    covered = abs(4.6 * math.cos(turned)) + abs(1.8 * math.sin(turned))
    across = abs(1.8 * math.cos(turned)) + abs(4.6 * math.sin(turned))
    assert boxes.velocity[0] == pytest.approx([10 * math.cos(turned), 10 * math.sin(turned)], abs=0.02)
    assert [float(each[0]) for each in boxes.reach] == pytest.approx([covered / 2, across / 2], abs=0.01)
    if abs(abs(t) - across / 2 - WIDTH / 2) > 0.05:
        assert bool(line.holds(boxes)[0]) == (abs(t) - across / 2 < WIDTH / 2)


def test_who_is_not_there_is_nowhere_on_a_line() -> None:
    boxes = arc(30.0).boxes(np.full((2, 5), np.nan), np.array([4.6, 1.8]))
    assert np.isnan(boxes.along).all()
    assert np.isnan(boxes.t).all()
