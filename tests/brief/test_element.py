from math import radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.element import Element


@given(
    st.floats(10, 300), st.sampled_from([1, -1]), st.floats(12, 300), st.floats(0, 1), st.floats(0.1, 10_000)
)
def test_curvature_over_the_length_of_a_turn_adds_up_to_its_angle(
    degrees: float, hand: int, radius: float, share: float, straight: float
) -> None:
    """A clothoid, an arc and a clothoid: the area under the curvature is the change of heading."""
    transition = share * radius * radians(degrees)
    turn = Element(turn=hand * degrees, radius=radius, transition=transition)
    s = [0.0, transition, turn.length - transition, turn.length]
    bend = [0.0, turn.curvature, turn.curvature, 0.0]
    assert np.degrees(np.trapezoid(bend, s)) == pytest.approx(hand * degrees)
    assert Element(straight).length == straight
    assert Element(straight).curvature == 0
