"""The solver of repairs and changes: frozen elements stay as they are, and free ones meet what is asked."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt import check
from roadgpt.brief.model import Brief
from roadgpt.brief.outline import Feature
from roadgpt.brief.ranges import Range
from roadgpt.check.measures import measure
from roadgpt.design import draft
from roadgpt.road import Design, World, build
from roadgpt_edit.fit import FittedRoad, Requirements, fit
from roadgpt_edit.road_elements import RoadElements, elements_on_road

WORLD = World()


def asked_of(elements: RoadElements, name: str, feature: Feature) -> RoadElements:
    """The elements, with a requirement of one of them."""
    return tuple(replace(e, asked=feature) if e.name == name else e for e in elements)


def fitted(design: Design, name: str, feature: Feature, length: Range | None = None) -> FittedRoad:
    """The road on which one element has what is asked of it, and all others are frozen."""
    elements, _ = elements_on_road(design)
    frozen = {element.name for element in elements} - {name}
    needs = Requirements(WORLD, length, before=design)
    return fit(design, asked_of(elements, name, feature), needs, frozen)


@settings(max_examples=settings.default.max_examples // 4, deadline=None)
@given(st.integers(0, 60), st.floats(0.8, 1.25), st.data())
def test_one_turn_gets_its_angle_and_all_other_segments_keep_every_number(
    seed: int, share: float, data: st.DataObject
) -> None:
    design = draft(Brief(), WORLD, seed=seed)
    elements, found = elements_on_road(design)
    turns = [element for element in elements if element.is_turn]
    turn = data.draw(st.sampled_from(turns))
    assert turn.seen is not None
    degrees = max(share * turn.seen.degrees, 14.0)
    after = fitted(design, turn.name, Feature("turn", "turn", degrees=Range(degrees - 1, degrees + 1)))
    kept = [i for i in range(len(design.segments)) if i not in turn.members]
    for index in kept:
        one, other = design.segments[index], after.design.segments[index]
        assert one.model_copy(update={"vertical_radius": None}) == other.model_copy(
            update={"vertical_radius": None}
        )
    if not after.objection:
        seen = measure(build(after.design).centreline()).turns
        assert len(seen) == len(found.turns)
        assert abs(seen[turns.index(turn)].degrees - degrees) <= 1
        assert check.inspect(build(after.design), None, WORLD) == ()


def test_most_angles_that_are_near_are_found() -> None:
    done = 0
    for seed in range(6):
        design = draft(Brief(), WORLD, seed=seed)
        elements, _ = elements_on_road(design)
        turn = next(element for element in elements if element.is_turn)
        assert turn.seen is not None
        wanted = Range(0.88 * turn.seen.degrees, 0.94 * turn.seen.degrees)
        done += not fitted(design, turn.name, Feature("turn", "turn", degrees=wanted)).objection
    assert done >= 5


def test_what_is_as_asked_comes_back_as_it_is() -> None:
    design = draft(Brief(), WORLD, seed=2)
    after = fitted(design, "turn 1", Feature("turn", "turn", degrees=Range(10, 300)))
    assert after.design == design
    assert after.objection == ""


def test_a_length_of_the_road_is_made_by_the_elements_that_are_free() -> None:
    design = draft(Brief(), WORLD, seed=5)
    elements, found = elements_on_road(design)
    straight = max((e for e in elements if not e.is_turn), key=lambda element: element.length)
    wanted = Range(found.length + 9, found.length + 15)
    after = fitted(design, straight.name, Feature("straight", "straight"), wanted)
    assert not after.objection
    assert build(after.design).length == pytest.approx(found.length + 12, abs=3.5)
    pairs = zip(design.segments, after.design.segments, strict=True)
    assert {i for i, (one, other) in enumerate(pairs) if one != other} <= set(straight.members)
