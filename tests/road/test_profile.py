"""The cross-section: the default two-lane road, and World as the place where readers find it."""

import json

import numpy as np
import pytest
from pydantic import ValidationError

from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import Profile, Road, World

STATIONS = np.array([[0.0, 1.0, 2.5], [40.0, 60.0, 80.0]])
BEND = Road(
    PieceCurve(0.0, 0.0, 0.0, (Piece(80.0, 1 / 40, 1 / 40),)), GradeProfile(0.0, (0.0, 80.0), (0.0, 0.0))
)


def test_a_two_lane_road_has_its_edges_where_a_drawing_has_them() -> None:
    profile = Profile(3.25, 1.5)
    for values, metres in (
        (profile.width(STATIONS), 3.25),
        (profile.shoulder(STATIONS), 1.5),
        (profile.middle(STATIONS), -1.625),
        (profile.edges(STATIONS).left, 3.25),
        (profile.edges(STATIONS).right, -3.25),
        (profile.rims(STATIONS).left, 4.75),
        (profile.rims(STATIONS).right, -4.75),
    ):
        assert values.shape == STATIONS.shape
        assert (values == metres).all()
    assert profile.middle(7.0).shape == ()
    assert (profile.paved_reach, profile.reach) == (3.25, 4.75)


def test_edges_of_a_bend_lie_on_circles_about_its_centre() -> None:
    s = np.linspace(0.0, 80.0, 9)
    profile = World(lane_width=3.0, verge=2.5).profile
    edges, rims = profile.edges(s), profile.rims(s)
    for offsets, radius in ((edges.left, 37.0), (edges.right, 43.0), (rims.left, 34.5), (rims.right, 45.5)):
        away = BEND.at(s, offsets)[:, :2] - [0.0, 40.0]  # a left bend of 40 m from (0, 0) along +x
        assert np.hypot(*away.T) == pytest.approx(radius, abs=1e-9)


def test_a_world_answers_with_its_profile() -> None:
    world = World(lane_width=2.75, verge=0.0)
    assert world.profile == Profile(2.75, 0.0)
    assert world.road_width == 5.5
    assert world.marking_edges[1] == -2.75


def test_the_shoulder_is_read_under_both_names_and_written_under_the_old_one() -> None:
    assert World(shoulder=1.5) == World(verge=1.5) == World.model_validate_json('{"shoulder": 1.5}')
    assert json.loads(World(shoulder=1.5).model_dump_json())["verge"] == 1.5
    with pytest.raises(ValidationError):
        World(shoulder=-1.0)
    with pytest.raises(ValidationError):
        World(verge=1.0, shoulder=2.0)
