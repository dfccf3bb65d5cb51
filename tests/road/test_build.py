"""A Road keeps what its Design says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.errors import UsageError
from roadgpt.road import Design, Road, Segment, build, in_short_segments

turns = st.one_of(st.floats(-70, -1), st.floats(1, 70))
segments = st.builds(
    lambda distance, turn, incline, straight, transition: Segment(
        distance=distance,
        direction="straight" if straight else "left" if turn > 0 else "right",
        incline=incline,
        turn_degrees=0.0 if straight else turn,
        transition=transition,
    ),
    st.floats(8, 90),
    turns,
    st.floats(-15, 15),
    st.booleans(),
    st.none() | st.floats(1, 20),
)
designs = st.builds(
    Design,
    starting_point=st.tuples(st.floats(0, 250), st.floats(0, 250), st.floats(-28, 40)),
    theta=st.floats(-360, 720),
    segments=st.lists(segments, min_size=1, max_size=8).map(tuple),
)


@given(designs)
def test_every_segment_keeps_its_distance_and_turn(design: Design) -> None:
    road = build(design)
    ends = np.cumsum([0.0] + [s.distance for s in design.segments])
    assert road.length == pytest.approx(ends[-1], abs=1e-6)
    turned = np.degrees(np.diff(road.heading(ends)))
    assert turned == pytest.approx([s.turn_degrees for s in design.segments], abs=1e-4)


@given(designs)
def test_curvature_never_jumps(design: Design) -> None:
    plan = build(design).plan
    joints = zip(plan.pieces, plan.pieces[1:], strict=False)
    assert all(abs(a.k1 - b.k0) < 1e-6 for a, b in joints)
    assert plan.pieces[0].k0 == plan.pieces[-1].k1 == 0


@given(designs)
def test_the_far_end_of_a_long_segment_lies_at_the_height_of_its_inclines(design: Design) -> None:
    road = build(design)
    climbed = sum(s.distance * s.incline / 100 for s in design.segments)
    rise = road.at(road.length)[2] - design.starting_point[2]
    assert rise == pytest.approx(climbed, abs=1e-6)


@given(designs)
def test_grades_never_leave_the_range_of_the_inclines(design: Design) -> None:
    road = build(design)
    grades = road.grade(np.linspace(0, road.length, 500)) * 100
    inclines = [s.incline for s in design.segments]
    assert grades.min() >= min(inclines) - 1e-9
    assert grades.max() <= max(inclines) + 1e-9


def one(**turn: float) -> Design:
    lead = Segment(distance=20, direction="straight")
    bend = Segment(direction="left", **turn)
    return Design(starting_point=(50, 50, 0), theta=0, segments=(lead, bend, lead))


def test_a_radius_is_kept_and_the_rest_stays_straight() -> None:
    road = build(one(distance=80, turn_degrees=60, radius=25, transition=10))
    assert 1 / road.sample(0.1).curvature.max() == pytest.approx(25)
    bent = sum(p.length for p in road.plan.pieces if p.k0 or p.k1)
    assert bent == pytest.approx(25 * np.radians(60) + 10)


def test_spline_geometry_is_roadgpts_translation() -> None:
    """Worked by hand from the thesis: start, 5 m level stub, then turn and hop; 0 degrees looks along +x."""
    design = Design(
        starting_point=(10, 20, 1),
        theta=0,
        segments=(
            Segment(distance=50, direction="left", incline=10, turn_degrees=90),
            Segment(distance=40, direction="right", incline=-5, turn_degrees=-90),
        ),
    )
    road = build(design, "spline")
    assert road.nodes is not None
    assert road.nodes == pytest.approx(np.array([[10, 20, 1], [15, 20, 1], [15, 70, 6], [55, 70, 4]]))


def test_a_road_is_not_endless() -> None:
    endless = Segment(distance=90_000, direction="straight")
    with pytest.raises(UsageError, match="up to 50 km"):
        build(Design(starting_point=(0, 0, 0), theta=0, segments=(endless,)))


def test_hops_make_a_spline_that_keeps_the_bends_and_grades() -> None:
    lead = Segment(distance=60, direction="straight", incline=8)
    bends = [
        Segment(distance=45, direction="left", incline=8, turn_degrees=60, radius=20, transition=8),
        Segment(distance=45, direction="right", incline=-3, turn_degrees=-60, radius=20, transition=8),
    ]
    design = Design(starting_point=(50, 50, 0), theta=20, segments=(lead, *bends, lead))
    arcs, spline = build(design), build(in_short_segments(design), "spline")
    assert spline.length == pytest.approx(arcs.length, abs=0.1)
    s = np.linspace(20, arcs.length - 2, 300)
    assert spline.at(s)[:, :2] == pytest.approx(arcs.at(s)[:, :2], abs=0.05)
    assert 1 / np.abs(spline.curvature(s)).max() == pytest.approx(20, rel=0.05)
    assert spline.grade(s) == pytest.approx(arcs.grade(s), abs=0.01)
    assert np.abs(spline.grade(np.linspace(0, 20, 50))).max() < 0.12
    assert all(abs(segment.turn_degrees) <= 70 for segment in in_short_segments(design).segments)


@given(designs, st.floats(0, 1), st.floats(-4, 4))
def test_locate_undoes_at(design: Design, share: float, t: float) -> None:
    road = build(design)
    s = share * road.length
    x, y, _ = road.at(s, t)
    found = road.at(*road.locate(x, y))
    assert found[:2] == pytest.approx([x, y], abs=1e-4)


@given(designs)
def test_a_road_survives_its_json(design: Design) -> None:
    import json

    road = build(design)
    again = Road.from_json(json.loads(json.dumps(road.to_json())))
    assert again.centreline().tobytes() == road.centreline().tobytes()
