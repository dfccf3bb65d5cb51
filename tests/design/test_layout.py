from itertools import chain

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.design.layout import keeps_clear, place, smallest_box, walk
from roadgpt.design.spans import Slope, Span, cut, turn_span
from roadgpt.road import Design, World, build


def spans_strategy() -> st.SearchStrategy[list[Span]]:
    turn = st.builds(
        turn_span,
        angle=st.floats(15, 200),
        hand=st.sampled_from([1, -1]),
        radius=st.floats(15, 90),
        ramp=st.floats(2, 15),
        grade=st.none(),
    )
    straight = st.floats(1, 90).map(Span)
    pairs = st.lists(st.tuples(straight, turn).map(list), min_size=1, max_size=5)
    return pairs.map(lambda several: [*chain.from_iterable(several), Span(25.0)])


def built(spans: list[Span], x: float = 0.0, y: float = 0.0, theta: float = 0.0) -> Design:
    segments = tuple(part for span in spans for part in cut(span, [Slope(span.length, 0.0)]))
    return Design(starting_point=(x, y, 0.0), theta=theta, segments=segments)


@settings(max_examples=100, deadline=None)
@given(spans_strategy())
def test_the_walked_line_is_the_road_that_is_built(spans: list[Span]) -> None:
    line, road = walk(spans), build(built(spans))
    assert road.length == pytest.approx(line.s[-1], abs=0.02)
    points = road.plan.at(np.minimum(line.s, road.length))
    assert np.abs(points[:, 0] + 1j * points[:, 1] - line.z).max() < 0.05


@settings(max_examples=100, deadline=None)
@given(spans_strategy())
def test_segments_keep_angle_and_radius_of_their_span(spans: list[Span]) -> None:
    for span in spans:
        parts = cut(span, [Slope(span.length, 2.5)])
        assert sum(part.distance for part in parts) == pytest.approx(span.length, abs=0.01)
        assert sum(part.turn_degrees for part in parts) == pytest.approx(span.turn, abs=1e-9)
        assert {part.incline for part in parts} == {2.5}
        if span.turn:
            road = build(Design(starting_point=(0, 0, 0), theta=0, segments=tuple(parts)))
            bend = np.abs(road.curvature(np.linspace(0, road.length, 400)))
            assert bend.max() == pytest.approx(1 / span.radius, rel=2e-3)


@settings(max_examples=100, deadline=None)
@given(spans_strategy(), st.integers(0, 1000))
def test_a_placed_road_lies_inside_the_map(spans: list[Span], seed: int) -> None:
    world, line = World(), walk(spans)
    where = place(line, world, np.random.default_rng(seed))
    if where is None:
        assert smallest_box(line) > world.map_size - world.road_width - 15
        return
    road = build(built(spans, *where))
    edges = np.concatenate([road.at(road.sample(0.5).s, t)[:, :2] for t in (-4, 4)])
    assert edges.min() > 0.05
    assert edges.max() < world.map_size - 0.05


@settings(max_examples=100, deadline=None)
@given(spans_strategy())
def test_what_keeps_clear_really_does(spans: list[Span]) -> None:
    line = walk(spans)
    if not keeps_clear(line, World(), with_verges=True):
        return
    points = np.stack([line.z.real, line.z.imag], axis=1)
    far = 30  # m along the road
    for i in range(0, len(points) - far, 7):
        rest = shapely.LineString(points[i + far :]) if len(points) - i - far > 1 else None
        assert rest is None or shapely.distance(shapely.Point(points[i]), rest) > 10.5


def test_a_loop_does_not_keep_clear() -> None:
    loop = [Span(60.0), turn_span(270, 1, 20, 5, None), Span(60.0)]
    assert not keeps_clear(walk(loop), World(), with_verges=False)
    assert keeps_clear(walk([Span(60.0), turn_span(170, 1, 20, 5, None), Span(60.0)]), World(), True)


def test_headings_are_free_where_there_is_room_and_diagonal_where_there_is_little() -> None:
    rng = np.random.default_rng(1)
    short, long = walk([Span(100.0)]), walk([Span(320.0)])
    octants = {int(place(short, World(), rng).theta // 45) for _ in range(100)}
    assert octants == set(range(8))
    thetas = np.array([place(long, World(), rng).theta for _ in range(20)])
    assert (np.abs(thetas % 90 - 45) < 10).all()
    assert place(walk([Span(400.0)]), World(), rng) is None
