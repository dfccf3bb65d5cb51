from itertools import chain

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.brief.element import Element
from roadgpt.design.elements import cut, turn_element
from roadgpt.design.layout import keeps_clear, place, smallest_box, walk
from roadgpt.road import Design, World, build


def elements_strategy() -> st.SearchStrategy[list[Element]]:
    turn = st.builds(
        turn_element,
        angle=st.floats(15, 200),
        hand=st.sampled_from([1, -1]),
        radius=st.floats(15, 90),
        transition=st.floats(2, 15),
        required_grade=st.none(),
    )
    straight = st.floats(1, 90).map(Element)
    pairs = st.lists(st.tuples(straight, turn).map(list), min_size=1, max_size=5)
    return pairs.map(lambda several: [*chain.from_iterable(several), Element(25.0)])


def built(elements: list[Element], x: float = 0.0, y: float = 0.0, theta: float = 0.0) -> Design:
    segments = tuple(part for element in elements for part in cut(element))
    return Design(starting_point=(x, y, 0.0), theta=theta, segments=segments)


@settings(max_examples=20, deadline=None)
@given(elements_strategy())
def test_the_walked_line_is_the_road_that_is_built(elements: list[Element]) -> None:
    line, road = walk(elements), build(built(elements))
    assert road.length == pytest.approx(line.s[-1], abs=0.02)
    points = road.plan.at(np.minimum(line.s, road.length))
    assert np.abs(points[:, 0] + 1j * points[:, 1] - line.z).max() < 0.05


@settings(max_examples=20, deadline=None)
@given(elements_strategy())
def test_segments_keep_angle_and_radius_of_their_element(elements: list[Element]) -> None:
    for element in elements:
        parts = cut(element._replace(incline=2.5))
        assert sum(part.distance for part in parts) == pytest.approx(element.length, abs=0.01)
        assert sum(part.turn_degrees for part in parts) == pytest.approx(element.turn, abs=1e-9)
        assert {part.incline for part in parts} == {2.5}
        if element.turn:
            road = build(Design(starting_point=(0, 0, 0), theta=0, segments=tuple(parts)))
            bend = np.abs(road.curvature(np.linspace(0, road.length, 400)))
            assert bend.max() == pytest.approx(1 / element.radius, rel=2e-3)


@settings(max_examples=20, deadline=None)
@given(elements_strategy(), st.integers(0, 1000))
def test_a_placed_road_lies_inside_the_map(elements: list[Element], seed: int) -> None:
    world, line = World(), walk(elements)
    where = place(line, world, np.random.default_rng(seed))
    if where is None:
        assert smallest_box(line) > world.site.map_size - world.section.road_width - 15
        return
    road = build(built(elements, *where))
    edges = np.concatenate([road.at(road.sample(0.5).s, t)[:, :2] for t in (-4, 4)])
    assert edges.min() > 0.05
    assert edges.max() < world.site.map_size - 0.05


@settings(max_examples=20, deadline=None)
@given(elements_strategy())
def test_what_keeps_clear_really_does(elements: list[Element]) -> None:
    line = walk(elements)
    if not keeps_clear(line, World(), with_shoulders=True):
        return
    points = np.stack([line.z.real, line.z.imag], axis=1)
    far = 30  # m along the road
    for i in range(0, len(points) - far, 7):
        rest = shapely.LineString(points[i + far :]) if len(points) - i - far > 1 else None
        assert rest is None or shapely.distance(shapely.Point(points[i]), rest) > 10.5


def test_a_loop_does_not_keep_clear() -> None:
    loop = [Element(60.0), turn_element(270, 1, 20, 5, None), Element(60.0)]
    assert not keeps_clear(walk(loop), World(), with_shoulders=False)
    assert keeps_clear(walk([Element(60.0), turn_element(170, 1, 20, 5, None), Element(60.0)]), World(), True)
