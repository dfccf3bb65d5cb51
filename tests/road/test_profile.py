"""The cross-section of a road: lanes, shoulders and markings at each station, and its form in road files."""

import json
import random
from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve
from roadgpt.road import CrossSection, Profile, Road, World
from roadgpt.road.profile import Kind, LaneStrip, profile_from_json, profile_to_json
from tables import rows

STATIONS = np.array([[0.0, 1.0, 2.5], [40.0, 60.0, 80.0]])
BEND = Road(
    PieceCurve(0.0, 0.0, 0.0, (Piece(80.0, 1 / 40, 1 / 40),)), GradeProfile(0.0, (0.0, 80.0), (0.0, 0.0))
)
WIDENING = CubicProfile((0.0, 80.0), ((3.0, 0.0, 3 / 80**2, -2 / 80**3), (4.0, 0.0, 0.0, 0.0)))


def test_a_two_lane_road_has_its_edges_where_a_drawing_has_them() -> None:
    profile = Profile.of(1, 1, 3.25, 1.5)
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


def test_three_lanes_along_and_two_against_have_the_edges_of_a_drawing() -> None:
    profile = Profile.of(3, 2, 3.5, 2.0)
    left, right = profile.lane_edges(0.0)
    assert [float(t) for t in left] == [3.5, 7.0, 9.0]
    assert [float(t) for t in right] == [-3.5, -7.0, -10.5, -12.5]
    assert profile.count == (3, 2)
    assert (float(profile.middle(0.0)), float(profile.width(0.0))) == (-8.75, 3.5)
    assert (float(profile.lane(0.0).left), float(profile.lane(0.0).right)) == (-7.0, -10.5)
    assert (profile.paved_reach, profile.reach) == (10.5, 12.5)


def test_markings_are_painted_over_boundaries_and_inside_the_edges_of_the_carriageway() -> None:
    lines = Profile.of(2, 1, 3.0, 1.0).markings(0.0)
    found = [(marking, round(float(edges.left), 3), round(float(edges.right), 3)) for marking, edges in lines]
    assert found == [
        ("solid", 3.0, 2.88),
        ("solid", 0.06, -0.06),
        ("broken", -2.94, -3.06),
        ("solid", -5.88, -6.0),
    ]
    usual = [marking for marking, _ in Profile.of().markings(0.0)]
    assert usual == ["solid", "broken", "solid"]
    one_way = [float(edges.left) for _, edges in Profile.of(1, 0, 3.0).markings(0.0)]
    assert one_way == pytest.approx([0.0, -2.88])


def test_a_front_tyre_may_reach_the_outer_edges_of_the_markings_beside_its_lane() -> None:
    usual, wide, one_way = Profile.of(), Profile.of(2, 1, 3.0), Profile.of(1, 0, 3.0)
    assert [float(t) for t in usual.marking_limits(0.0)] == pytest.approx([0.06, -4.0])
    assert [float(t) for t in wide.marking_limits(0.0)] == pytest.approx([-2.94, -6.0])
    assert [float(t) for t in one_way.marking_limits(0.0)] == pytest.approx([0.0, -3.0])
    inner = replace(wide, driven=0)
    assert [float(t) for t in inner.marking_limits(0.0)] == pytest.approx([0.06, -3.06])


def test_a_width_that_varies_is_followed_by_middle_edges_and_reach() -> None:
    profile = Profile.of(2, 1, WIDENING, 1.0)
    assert profile.width([0.0, 40.0, 80.0, 99.0]) == pytest.approx([3.0, 3.5, 4.0, 4.0])
    assert profile.middle([0.0, 40.0, 80.0]) == pytest.approx([-4.5, -5.25, -6.0])
    assert profile.edges([40.0]).right == pytest.approx([-7.0])
    assert profile.reach == pytest.approx(9.0)
    bulging = CubicProfile((0.0, 2.0), ((3.0, 2.0, -1.0, 0.0), (3.0, 0.0, 0.0, 0.0)))  # 4 m in the middle
    assert Profile.of(1, 1, bulging, 0.0).paved_reach == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("left", "right", "driven"),
    [
        ((), (LaneStrip("shoulder", 1.0),), 1),
        ((), (LaneStrip("driving", 3.0),), 1),
        ((), (LaneStrip("shoulder", 1.0), LaneStrip("driving", 3.0)), 0),
        ((), (LaneStrip("driving", -3.0),), 0),
        ((), (LaneStrip("driving", CubicProfile((0.0,), ((3.0, 0.1, 0.0, 0.0),))),), 0),
    ],
)
def test_cross_sections_that_cannot_be_are_refused(
    left: tuple[LaneStrip, ...], right: tuple[LaneStrip, ...], driven: int
) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        Profile(left, right, driven)


KINDS: tuple[Kind, ...] = (
    "driving",
    "driving",
    "driving",
    "shoulder",
    "median",
    "biking",
    "sidewalk",
    "parking",
)


@pytest.mark.parametrize("seed", range(60))
def test_strips_of_any_kind_lie_beside_each_other_in_any_order(seed: int) -> None:
    """Laid out by hand, from the left rim to the right one: what lies between the outermost driving lanes is
    the carriageway."""
    rng = random.Random(seed)
    left, right = (
        tuple(
            LaneStrip(rng.choice(KINDS), rng.choice((0.5, 2.0, 3.5)), rng.choice(("solid", "broken", "none")))
            for _ in range(rng.randint(0, 5))
        )
        for _ in range(2)
    )
    driven = [n for n, lane in enumerate(right) if lane.kind == "driving"]
    profile = Profile(left, right, rng.choice(driven or [0]), "double", offset=rng.choice((0.0, 1.25)))
    at = profile.offset + sum(float(lane.width) for lane in left)
    strips: list[tuple[int, LaneStrip, float, float]] = []
    for number, lane in (*list(enumerate(left, 1))[::-1], *((-n, lane) for n, lane in enumerate(right, 1))):
        strips.append((number, lane, at, at - float(lane.width)))
        at -= float(lane.width)
    assert {number: lane for number, lane, *_ in strips} == profile.lanes
    for number, _, high, low in strips:
        assert profile.edges_of(number, 0.0) == pytest.approx((high, low))
    road = [strip for strip in strips if strip[1].kind == "driving"]
    assert profile.along_ids == tuple(strip[0] for strip in road if strip[0] < 0)
    assert profile.against_ids[::-1] == tuple(strip[0] for strip in road if strip[0] > 0)
    if strips:
        assert profile.rims(0.0) == pytest.approx((strips[0][2], strips[-1][3]))
    if not road:
        assert profile.edges(0.0) == pytest.approx((profile.offset, profile.offset))
        return
    assert profile.edges(0.0) == pytest.approx((road[0][2], road[-1][3]))
    inside = strips[strips.index(road[0]) : strips.index(road[-1]) + 1]
    bounds = profile.boundaries(0.0)
    assert [float(t) for _, t in bounds] == pytest.approx([inside[0][2], *(strip[3] for strip in inside)])
    for (marking, _), (number, lane, *_) in zip(bounds[1:], inside, strict=True):  # the edge on its right
        below = profile.lanes.get(number - 1)
        inner = below.marking if number > 1 and below is not None else "double"
        assert marking == (lane.marking if number < 0 else inner)
    assert profile.is_divided == (
        min(strip[0] for strip in road) < 0 < max(strip[0] for strip in road)
        and any(strip[1].kind == "median" for strip in inside)
    )
    if driven:
        bound = bounds[profile.boundaries_to_left][1]
        assert profile.lane(0.0).left == pytest.approx(bound)
        assert profile.middle(0.0) == pytest.approx((bound + bounds[profile.boundaries_to_left + 1][1]) / 2)
    else:
        assert profile.driven_id == max(profile.against_ids)
        assert profile.middle(0.0) == pytest.approx(sum(profile.edges_of(profile.driven_id, 0.0)) / 2)
        assert profile.lane(0.0) == pytest.approx(profile.edges_of(profile.driven_id, 0.0))
        assert bounds[profile.boundaries_to_left][1] == pytest.approx(profile.lane(0.0).left)
        with pytest.raises(UsageError, match="no lane leads along the road"):
            Road.from_json(BEND.with_profile(profile).to_json())
    assert profile_from_json(profile_to_json(profile)) == profile
    mirrored = profile.mirrored
    assert mirrored.edges(0.0) == pytest.approx((-road[-1][3], -road[0][2]))
    assert mirrored.along_ids == tuple(-number for number in profile.along_ids)


@pytest.mark.parametrize("left_hand", [False, True])
def test_a_median_of_an_older_file_is_the_lane_beside_the_centre_line(left_hand: bool) -> None:
    data = profile_to_json(Profile.of(2, 2, 3.5, 1.0))
    if left_hand:
        data = {**data, "left_hand": True}
    profile = profile_from_json({**data, "median": 2.0})
    own, other = (profile.left, profile.right) if left_hand else (profile.right, profile.left)
    assert other[0] == LaneStrip("median", 2.0, "solid")
    assert own == Profile.of(2, 2, 3.5, 1.0).right
    assert profile.is_divided
    assert [float(t) for _, t in profile.boundaries(0.0)] == pytest.approx(
        [7, 3.5, 0, -2, -5.5, -9] if left_hand else [9, 5.5, 2, 0, -3.5, -7]
    )


def test_a_road_file_keeps_the_cross_section_to_the_last_digit() -> None:
    angle = CubicProfile((0.0, 30.0), ((0.0, 0.0, 1e-4, -2e-6), (0.036, 0.0, 0.0, 0.0)))
    road = BEND.with_profile(Profile.of(2, 1, WIDENING, 1.25, angle))
    again = Road.from_json(json.loads(json.dumps(road.to_json())))
    assert again.profile == road.profile
    assert np.array_equal(again.at(STATIONS, 3.0), road.at(STATIONS, 3.0))
    assert "profile" not in BEND.to_json()


@pytest.mark.parametrize(
    ("change", "sentence"),
    rows(__file__, "cross_sections_in_files_that_cannot_be_are_refused_in_one_sentence"),
)
def test_cross_sections_in_files_that_cannot_be_are_refused_in_one_sentence(
    change: dict[str, object], sentence: str
) -> None:
    data = BEND.with_profile(Profile.of()).to_json()
    with pytest.raises(UsageError, match=sentence):
        Road.from_json({**data, "profile": {**data["profile"], **change}})


def test_a_world_lays_its_lanes_on_roads_that_have_none() -> None:
    world = World(section=CrossSection(lanes="2+1", lane_width=3.0, lane_width_end=4.0))
    road = world.lay(BEND)
    assert road.profile is not None
    assert road.profile.count == (2, 1)
    assert road.profile.width([0.0, 40.0, 80.0]) == pytest.approx([3.0, 3.5, 4.0])
    assert world.lay(road) is road
    assert World(section=CrossSection(lane_width=3.0)).lay(BEND) is BEND
    assert world.section.road_width == 16.0
    assert World().section.profile(80.0) == Profile.of()


def test_the_shoulder_is_read_under_both_names_and_written_under_the_old_one() -> None:
    world = World(section=CrossSection(shoulder=1.5))
    for text in ('{"shoulder": 1.5}', '{"verge": 1.5}'):
        assert World.model_validate_json(text) == world
    assert json.loads(World(section=CrossSection(shoulder=1.5)).model_dump_json())["verge"] == 1.5
    with pytest.raises(ValidationError):
        World(section=CrossSection(shoulder=-1.0))
    with pytest.raises(ValidationError):
        World.model_validate({"verge": 1.0, "shoulder": 2.0})
