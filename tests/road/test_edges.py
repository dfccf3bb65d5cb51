"""Lines beside the road: near enough to it, not more points than that takes, and never folded."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import Design, Road, build
from roadgpt.road.edges import CHORD, line, stations
from strategies import designs


@settings(max_examples=40)
@given(design=designs(), t=st.sampled_from([-7.0, -4.0, 0.0, 4.0, 7.0]))
def test_chords_stay_within_millimetres_of_the_road(design: Design, t: float) -> None:
    road = build(design)
    s = stations(road, 7.0)
    assert (s[0], s[-1]) == (0.0, pytest.approx(road.length))
    assert (np.diff(s) > 0).all()
    points = line(road, s, t)
    middle, between = (points[1:] + points[:-1]) / 2, (s[1:] + s[:-1]) / 2
    off = middle - road.at(between, t)
    heading = road.heading(between)
    aside = off[:, 1] * np.cos(heading) - off[:, 0] * np.sin(heading)
    loose = (np.abs(road.curvature(s) * t) < 0.8) & (
        np.abs(road.curvature(s)) < 1
    )  # pinched lines follow no curve
    followed = loose[1:] & loose[:-1]
    assert np.abs(aside[followed]).max(initial=0.0) < 2 * CHORD
    assert np.abs(off[followed, 2]).max(initial=0.0) < 2 * CHORD


def test_lines_do_not_fold_where_a_bend_has_no_room() -> None:
    level = GradeProfile(0.0, (0.0, 12.0), (0.0, 0.0))
    road = Road(PieceCurve(0, 0, 0, (Piece(12.0, 1 / 3, 1 / 3),)), level)
    s = stations(road, 7.0)
    for t in (-7.0, -2.0, 2.0, 7.0):
        steps = np.diff(line(road, s, t)[:, :2], axis=0)
        heading = road.heading((s[1:] + s[:-1]) / 2)
        along = steps[:, 0] * np.cos(heading) + steps[:, 1] * np.sin(heading)
        assert (along > 0).all()
