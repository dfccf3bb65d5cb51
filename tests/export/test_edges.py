"""Lines beside the road: near enough to it, not more points than that takes, and never folded."""

from itertools import chain, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from exported import ROADS, WORLD
from roadgpt.errors import ExportError
from roadgpt.export.edges import CHORD, LONGEST, line, stations
from roadgpt.export.lanelets import lanelet_sections
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import Design, Road, build
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


def test_a_straight_has_few_points_and_a_hairpin_many() -> None:
    straight = stations(Road.through([[0, 0], [100, 0], [200, 0]]), 7.0)
    assert len(straight) <= 2 + 200 / LONGEST
    level = GradeProfile(0.0, (0.0, 200.0), (0.0, 0.0))
    hairpin = Road(PieceCurve(0, 0, 0, (Piece(80), Piece(40, 1 / 15, 1 / 15), Piece(80))), level)
    s = stations(hairpin, 7.0)
    inside = (s > 81) & (s < 119)
    assert np.diff(s[inside]).max() < 0.45
    assert np.diff(s[s < 75]).max() > 5


def test_lines_do_not_fold_where_a_bend_has_no_room() -> None:
    level = GradeProfile(0.0, (0.0, 12.0), (0.0, 0.0))
    road = Road(PieceCurve(0, 0, 0, (Piece(12.0, 1 / 3, 1 / 3),)), level)
    s = stations(road, 7.0)
    for t in (-7.0, -2.0, 2.0, 7.0):
        steps = np.diff(line(road, s, t)[:, :2], axis=0)
        heading = road.heading((s[1:] + s[:-1]) / 2)
        along = steps[:, 0] * np.cos(heading) + steps[:, 1] * np.sin(heading)
        assert (along > 0).all()


def test_numbers_that_are_not_finite_are_refused() -> None:
    level = GradeProfile(0.0, (0.0, 50.0), (0.0, float("nan")))
    road = Road(PieceCurve(0, 0, 0, (Piece(50.0),)), level)
    with pytest.raises(ExportError, match="not finite"):
        stations(road, 4.0)


@pytest.mark.parametrize("name", ROADS)
def test_sections_meet_and_cover_the_road(name: str) -> None:
    road = ROADS[name]
    found = lanelet_sections(road, WORLD)
    middles = found[0][-1][1].points, found[-1][-1][1].points  # between the lanes
    assert middles[0][0] == pytest.approx(road.at(0.0), abs=1e-4)
    assert middles[1][-1] == pytest.approx(road.at(road.length), abs=1e-4)
    assert len(found) == max(1, round(road.length / 50))
    for one, other in pairwise(found):
        assert [*one] == [*other] == [-1, 1]
        for before, after in zip(chain(*one.values()), chain(*other.values()), strict=True):
            assert (before.points[-1] == after.points[0]).all()
