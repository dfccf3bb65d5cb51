"""Laws of the rules: what a road is does not hang on where it lies or which way it is driven."""

import math

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from roadgpt import plugins
from roadgpt.check import inspect
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.road import CrossSection, Road, Site, World

WORLD = World(site=Site(map_size=1000))
SHAPE_RULES = (
    "finite",
    "number_of_points",
    "too_short",
    "below_floor",
    "too_steep",
    "too_tight",
    "no_overlap",
)

lengths = st.floats(5, 60)
bends = st.one_of(st.just(0.0), st.floats(17, 80).map(lambda r: 1 / r), st.floats(6, 12).map(lambda r: 1 / r))
pieces = st.builds(lambda n, k, hand: Piece(n, hand * k, hand * k), lengths, bends, st.sampled_from([-1, 1]))
gentle = st.builds(
    lambda n, k, hand: Piece(n, hand * k, hand * k), lengths, st.floats(0, 0.06), st.sampled_from([-1, 1])
)
grades = st.one_of(st.floats(-0.14, 0.14), st.floats(0.16, 0.5), st.floats(-0.5, -0.16))
settled = settings(max_examples=60, deadline=None)


@st.composite
def roads(draw: st.DrawFn) -> Road:
    plan = PieceCurve(500.0, 500.0, 0.0, tuple(draw(st.lists(pieces, min_size=1, max_size=7))))
    return Road(plan, GradeProfile(100.0, (0.0, plan.length), (draw(grades), draw(grades))))


def laid(road: Road, x: float, y: float, turn: float) -> Road:
    """The same road at another place, turned."""
    assert isinstance(road.plan, PieceCurve)
    return Road(PieceCurve(x, y, road.plan.heading0 + turn, road.plan.pieces), road.elevation)


def reversed_way(road: Road) -> Road:
    """The same road driven from its end."""
    assert isinstance(road.plan, PieceCurve)
    assert isinstance(road.elevation, GradeProfile)
    x, y, z = road.at(road.length)
    back = tuple(Piece(p.length, -p.k1, -p.k0) for p in road.plan.pieces[::-1])
    g0, g1 = road.elevation.grades
    plan = PieceCurve(x, y, float(road.heading(road.length)) + math.pi, back)
    return Road(plan, GradeProfile(z, (0.0, road.length), (-g1, -g0)))


def objects(rule: str, road: Road, world: World = WORLD) -> bool:
    return bool(plugins.find("rules", rule)(road, None, world))


def is_no_close_call(road: Road) -> bool:
    """Does the verdict on overlap stay the same if lanes are 5 cm wider or narrower?"""
    wider, narrower = (
        World(site=Site(map_size=1000), section=CrossSection(lane_width=width)) for width in (4.05, 3.95)
    )
    return objects("no_overlap", road, wider) == objects("no_overlap", road, narrower)


@given(roads(), st.floats(-100, 100), st.floats(-100, 100), st.floats(-math.pi, math.pi))
@settled
def test_where_a_road_lies_changes_no_verdict_but_inside_map(
    road: Road, dx: float, dy: float, turn: float
) -> None:
    assume(is_no_close_call(road))
    there = laid(road, 500 + dx, 500 + dy, turn)
    assert [objects(rule, there) for rule in SHAPE_RULES] == [objects(rule, road) for rule in SHAPE_RULES]


@given(roads())
@settled
def test_driving_it_backwards_changes_no_verdict_on_overlap_radius_and_map(road: Road) -> None:
    assume(is_no_close_call(road))
    for rule in ("no_overlap", "too_tight", "too_steep", "inside_map", "too_short"):
        assert objects(rule, reversed_way(road)) == objects(rule, road), rule


@given(roads(), st.floats(0, 250), st.floats(0, 250), st.floats(-math.pi, math.pi))
@settled
def test_a_road_is_inside_the_map_where_all_its_edge_points_are(
    road: Road, x: float, y: float, turn: float
) -> None:
    road, world = laid(road, x, y, turn), World(site=Site(map_size=250))
    s = np.linspace(0, road.length, 4000)
    edge = np.concatenate([road.at(s, t)[:, :2] for t in (-4.0, 4.0)])
    room = min(edge.min(), 250 - edge.max())
    assume(room < -0.1 or room > 1.5)  # nearer to the border, SBFT's spline has a word in it
    assert objects("inside_map", road, world) == (room < 0)


@given(
    st.lists(gentle, min_size=1, max_size=4), st.floats(-math.pi, math.pi), st.floats(0, 2), st.floats(0, 2)
)
@settings(max_examples=200, deadline=None)
def test_what_strict_lets_pass_the_competition_lets_pass(
    shape: list[Piece], turn: float, room_x: float, room_y: float
) -> None:
    """Roads in a corner of the map, as close to its border as that."""
    road = Road(PieceCurve(0.0, 0.0, turn, tuple(shape)), GradeProfile(0.0, (0.0, 1.0), (0.0, 0.0)))
    x, y = np.min([road.at(np.linspace(0, road.length, 500), t)[:, :2].min(axis=0) for t in (-4, 4)], axis=0)
    road = laid(road, room_x - x, room_y - y, 0.0)
    assert inspect(road, None, World()) or not inspect(road, None, World(), rules="sbft")
