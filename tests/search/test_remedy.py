"""Small changes that remove a failure, and the faults that follow from them."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import combinations, product
from types import SimpleNamespace
from typing import Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import cumulative_trapezoid

from roadgpt.errors import GivenUpError
from roadgpt.road import Design, Road, Segment, World, build
from roadgpt.run import Request, Run, Setup
from roadgpt.verdict import Verdict
from roadgpt_search.faults import remedy
from roadgpt_search.faults.remedy import REMEDIES, Alignment, TriedGroup, faults_by_remedy, remedies_of

WORLD = World()


def straight(metres: float, incline: float = 0.0) -> Segment:
    return Segment(distance=metres, direction="straight", incline=incline)


def bend(degrees: float, radius: float) -> Segment:
    length = abs(np.radians(degrees)) * radius + 6.0
    side: Literal["left", "right"] = "left" if degrees > 0 else "right"
    return Segment(
        distance=length, direction=side, turn_degrees=degrees, radius=radius, transition=6.0, incline=0.0
    )


def road_of(*segments: Segment) -> Road:
    return build(Design(starting_point=(60.0, 120.0, 0.0), theta=0.0, segments=segments))


BENDS = (bend(80, 30), bend(-90, 16), bend(60, 20))
ROAD = road_of(straight(40), BENDS[0], straight(25), BENDS[1], straight(20), BENDS[2], straight(40))
VERDICT = Verdict("FAIL", "out of lane", "", "", 0.9, -0.1, 1, at_s=60.0, side="left")
TIGHT = 1  # the bend of 16 m among the bends of ROAD


def heading_of(road: Road) -> float:
    """Degrees turned in all, by scipy's trapezoid rule over the curvature."""
    s = np.linspace(0, road.length, 4001)
    return float(np.degrees(cumulative_trapezoid(road.curvature(s), s)[-1]))


def test_a_shape_gives_its_road_again() -> None:
    shape = Alignment.of(ROAD)
    again = shape.road(ROAD)
    assert again.length == pytest.approx(ROAD.length)
    s = np.linspace(0, ROAD.length, 300)
    assert np.abs(again.at(s) - ROAD.at(s)).max() < 0.05
    assert len(shape.bends()) == 3


@given(st.integers(0, 2), st.floats(0.7, 1.4))
@settings(max_examples=15)
def test_a_wider_bend_turns_as_far_and_a_shorter_one_less(number: int, factor: float) -> None:
    shape = Alignment.of(ROAD)
    its = shape.bends()[number]
    wider, shorter = shape.widened(its, factor).road(ROAD), shape.shortened(its, factor).road(ROAD)
    turned = (80, -90, 60)[number]
    assert heading_of(wider) == pytest.approx(50, abs=0.6)
    assert heading_of(shorter) == pytest.approx(50 + (factor - 1) * turned, abs=0.9)
    own = slice(its.first, its.last + 1)
    after = shape.widened(its, factor).curvature[own]
    assert np.abs(shape.curvature[own]).max() / np.abs(after).max() == pytest.approx(factor)
    assert np.abs(shape.shortened(its, factor).curvature).max() == np.abs(shape.curvature).max()


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_bend_is_eased_and_set_apart(number: int) -> None:
    shape = Alignment.of(ROAD)
    its = shape.bends()[number]
    eased = shape.eased(its, 10.0)
    assert heading_of(eased.road(ROAD)) == pytest.approx(50, abs=0.6)
    assert np.abs(np.diff(eased.curvature)).max() < np.abs(np.diff(shape.curvature)).max() + 1e-12
    own = slice(its.first, its.last + 1)
    steepest = [np.abs(np.diff(each.curvature[own])).max() for each in (eased, shape)]
    # a ramp over 6 m becomes one over the 21 samples of the mean, 10.5 m
    assert steepest[0] / steepest[1] == pytest.approx(6 / 10.5, rel=0.02)
    longer = shape.with_straight(its, 10.0)
    assert longer.stations[-1] == pytest.approx(shape.stations[-1] + 10)
    assert heading_of(longer.road(ROAD)) == pytest.approx(50, abs=0.3)
    at = its.first
    assert not longer.curvature[at : at + 21].any()
    np.testing.assert_array_equal(longer.curvature[at + 21 :], shape.curvature[at + 1 :])
    assert len(longer.grade) == len(longer.steps) == len(longer.curvature)


Fails = Callable[[Road, World], float | None]


def failing(
    road: Road, at_s: float, monkeypatch: pytest.MonkeyPatch, fails: Fails
) -> Mapping[str, bool | None]:
    """The changes that remove a failure of a car which fails where ``fails(road, world)`` gives a station."""

    def proved(tried: Road, seed: int, world: World, setup: Setup, index: int, **rest: object) -> object:
        assert (seed, index) == (7, 3)
        station = fails(tried, world)
        verdict = SimpleNamespace(kept=station is None, at_s=station)
        return SimpleNamespace(verdict=verdict, outcome="PASS", is_lost=False)

    monkeypatch.setattr(remedy, "prove", proved)
    run = Run(Request(words="", world=WORLD), 3, 7, road=road, verdict=replace(VERDICT, at_s=at_s))
    return remedies_of(run)


def test_the_change_that_removes_the_cause_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cars that fail by one law each: where a bend is too tight, too long, or too near to the one before."""
    shape = Alignment.of(ROAD)
    tight = shape.bends()[TIGHT]
    place = float(shape.stations[tight.first] + 15)

    def too_tight(road: Road, world: World) -> float | None:
        return place if np.abs(Alignment.of(road).curvature).max() > 1 / 17 else None

    found = failing(ROAD, place, monkeypatch, too_tight)
    assert found["wider 15"]
    assert found["wider 30"], "a larger change counts where the small one does"
    kinds = {name.split()[0] for name, gone in found.items() if gone}
    assert kinds <= {"wider", "eased"}
    assert found["flatter half"] is found["flatter no"] is None, "the road is level"

    def too_long(road: Road, world: World) -> float | None:
        its = Alignment.of(road)
        turned = its.curvature * its.steps
        most = max(abs(np.degrees(turned[b.first : b.last + 1].sum())) for b in its.bends())
        return 50.0 if most > 70 else None

    found = failing(road_of(straight(40), BENDS[1], straight(40)), 50.0, monkeypatch, too_long)
    assert [name for name, gone in found.items() if gone] == ["shorter 30"], "76 and 63 degrees are left"

    def too_near(road: Road, world: World) -> float | None:
        its = Alignment.of(road)
        first, second = its.bends()[:2]
        return place if its.stations[second.first] - its.stations[first.last] < 30 else None

    found = failing(ROAD, place, monkeypatch, too_near)
    assert [name for name, gone in found.items() if gone] == ["apart 10", "apart 20"]

    def too_fast(road: Road, world: World) -> float | None:
        return place if world.limits.speed_limit > 18 else None

    found = failing(ROAD, place, monkeypatch, too_fast)
    assert [name for name, gone in found.items() if gone] == ["slower 15", "slower 30"]


def test_a_car_that_fails_30_m_farther_on_has_passed_the_place(monkeypatch: pytest.MonkeyPatch) -> None:
    place = float(Alignment.of(ROAD).stations[Alignment.of(ROAD).bends()[TIGHT].first] + 15)
    beyond = failing(ROAD, place, monkeypatch, lambda road, world: place + 45)
    assert {name for name, gone in beyond.items() if gone} == {
        r.name for r in REMEDIES if r.kind != "flatter"
    }
    near = failing(ROAD, place, monkeypatch, lambda road, world: place + 20)
    assert not any(near.values())


def test_without_a_bend_nothing_about_bends_applies(monkeypatch: pytest.MonkeyPatch) -> None:
    road = road_of(straight(120))
    found = failing(road, 60.0, monkeypatch, lambda road, world: 60.0)
    assert {name for name, gone in found.items() if gone is not None} == {"slower 15", "slower 30"}


def test_a_driver_that_breaks_down_does_not_pass_and_a_lost_drive_is_repeated(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    road = road_of(straight(120))
    run = Run(Request(words="", world=WORLD), 3, 7, road=road, verdict=VERDICT)
    broken = SimpleNamespace(
        verdict=None, outcome="ERROR", is_lost=False, description="the driver broke down"
    )
    monkeypatch.setattr(remedy, "prove", lambda *rest, **more: broken)
    assert remedies_of(run)["slower 15"] is False
    lost = SimpleNamespace(verdict=None, outcome="ERROR", is_lost=True, description="no answer")
    passed = SimpleNamespace(verdict=SimpleNamespace(kept=True), outcome="PASS", is_lost=False)
    answers = iter([lost, lost, passed])
    monkeypatch.setattr(remedy, "prove", lambda *rest, **more: next(answers))
    assert remedies_of(run)["slower 15"] is True
    monkeypatch.setattr(remedy, "prove", lambda *rest, **more: lost)
    with pytest.raises(GivenUpError, match="no answer"):
        remedies_of(run)


NAMES = [each.name for each in REMEDIES]
WIDER, APART = "wider 15", "apart 10"
tried = st.builds(
    lambda size, gone: (size, ({name: name in gone for name in NAMES},)),
    st.integers(1, 9),
    st.sets(st.sampled_from([*NAMES[:4], NAMES[8], NAMES[11]]), max_size=3),
)


def is_good(groups: list[TriedGroup], found: list[str | None]) -> bool:
    """The definition, pair by pair: every failure of a group does as its tested one does."""
    members: dict[str, list[Mapping[str, bool | None]]] = {}
    for group, name in zip(groups, found, strict=True):
        if name is not None:
            members.setdefault(name, []).extend([group[1][0]] * group[0])
    for name, its in members.items():
        if its and np.mean([bool(a[name] and b[name]) for a, b in product(its, its)]) < 0.85:
            return False
    for one, other in combinations(members, 2):
        both = [
            (a[one] and b[one]) or (a[other] and b[other]) for a, b in product(members[one], members[other])
        ]
        if np.mean([bool(each) for each in both]) > 0.2 + 1e-9:
            return False
    return True


@given(st.lists(tried, min_size=1, max_size=5))
@settings(max_examples=25, deadline=None)
def test_faults_keep_to_the_definition_and_cover_as_much_as_any(groups: list[TriedGroup]) -> None:
    """Against all ways to give each group a change that removes it, or none."""
    found = faults_by_remedy(groups)
    assert is_good(groups, found)
    removing = [[None, *(name for name in NAMES if group[1][0][name])] for group in groups]
    for group, name in zip(groups, found, strict=True):
        assert name is None or group[1][0][name]
    ways = [list(way) for way in product(*removing)]
    best = max(value_of(groups, way) for way in ways if is_good(groups, way) and is_whole(groups, way))
    assert value_of(groups, found) == pytest.approx(best)


def value_of(groups: list[TriedGroup], way: list[str | None]) -> float:
    """Failures in faults; those that need a larger change count 0.8."""
    worth = {name: 1.0 if name.split()[1] in ("15", "10", "half") else 0.8 for name in NAMES}
    return sum(group[0] * worth[name] for group, name in zip(groups, way, strict=True) if name)


def is_whole(groups: list[TriedGroup], way: list[str | None]) -> bool:
    """Whether no group is left out that a chosen change removes, and every fault was seen twice."""
    return all(
        _takes_all(groups, tuple(way), name) and _is_twice(groups, way, name) for name in {*way} - {None}
    )


def _is_twice(groups: list[TriedGroup], way: list[str | None], name: str | None) -> bool:
    count = sum(group[0] for group, own in zip(groups, way, strict=True) if own == name)
    return count >= 2 or len(groups) == 1


def _takes_all(groups: list[TriedGroup], way: list[str | None], name: str | None) -> bool:
    """Whether no group is left out that a chosen change removes: leaving out what disturbs is no fault."""
    return all(own is not None or not group[1][0][str(name)] for group, own in zip(groups, way, strict=True))


def test_what_no_change_sets_apart_belongs_to_no_fault() -> None:
    none = dict.fromkeys(NAMES, False)
    wide, both, near = none | {WIDER: True}, none | {WIDER: True, APART: True}, none | {APART: True}
    assert faults_by_remedy([]) == []
    assert faults_by_remedy([(3, (none,))]) == [None]
    assert faults_by_remedy([(9, (wide,)), (4, (near,))]) == [WIDER, APART]
    assert faults_by_remedy([(9, (wide,)), (9, (both,))]) == [WIDER, WIDER]
    # half of the failures of 'wider' disappear with 'apart', too, so that these are not two faults
    mixed = [(9, (wide,)), (9, (both,)), (4, (near,))]
    assert faults_by_remedy(mixed) == [WIDER, WIDER, None]
    assert faults_by_remedy([(9, (wide, wide, none))]) == [None], "too few disappear"
