"""Designs through hops, as `--geometry spline` draws them, climb as was asked."""

import pytest

from roadgpt.road import Design, Segment
from roadgpt.road.builder import in_short_segments


@pytest.mark.parametrize("incline", [3.333, -7.771, 11.111])
def test_hops_have_the_incline_of_the_design_to_a_thousandth_of_a_percent(incline: float) -> None:
    """On the last metres of a straight, where no other slope is near."""
    parts = [
        Segment(distance=45, direction="left", turn_degrees=50, incline=-incline / 3),
        Segment(distance=80, direction="straight", incline=incline),
    ]
    design = Design(starting_point=(60, 60, 0), theta=10, segments=tuple(parts))
    hops = in_short_segments(design).segments[-8:]
    assert [each.incline for each in hops] == pytest.approx([incline] * len(hops), abs=1e-3)
