"""The verb ``inspect``: rule sets, their order, the shelf."""

import math
from collections.abc import Iterator

import pytest

from roadgpt import check, plugins
from roadgpt.brief.model import Brief
from roadgpt.check import Finding, inspect
from roadgpt.errors import PartError, UsageError
from roadgpt.geometry import GradeProfile, Piece, PieceCurve
from roadgpt.network import Network
from roadgpt.road import Road, Site, World

WORLD = World(site=Site(map_size=200))


@pytest.fixture(autouse=True)
def _fresh_rule_sets() -> Iterator[None]:
    check.rules_of.cache_clear()
    yield
    check.rules_of.cache_clear()


def road(x: float = 50.0, length: float = 100.0, grade: float = 0.0, radius: float = math.inf) -> Road:
    plan = PieceCurve(x, 100.0, 0.0, (Piece(length, 1 / radius, 1 / radius),))
    return Road(plan, GradeProfile(0.0, (0.0, length), (grade, grade)))


def test_all_objections_are_listed_in_the_order_of_the_set() -> None:
    found = inspect(road(x=150, grade=0.3, radius=8, length=18), None, WORLD)
    assert [finding.rule for finding in found] == ["too_short", "too_steep", "too_tight"]


def test_a_road_without_numbers_is_not_measured_further() -> None:
    found = inspect(road(x=math.nan), None, WORLD)
    assert [finding.rule for finding in found] == ["finite"]


def test_far_outside_is_valid_to_sbft_and_invalid_to_us() -> None:
    """The competition's precedence of 'and' over 'or' lets a road pass that lies wholly beside the map."""
    outside = Road.through([[300, 50], [350, 60], [390, 90], [400, 140]])
    assert inspect(outside, None, WORLD, rules="sbft") == ()
    assert inspect(outside, None, WORLD)[0].rule == "inside_map"


def test_an_unknown_rule_set_is_answered_with_the_known_ones() -> None:
    with pytest.raises(UsageError, match="no rule set called 'lax'; there are: strict, sbft"):
        inspect(road(), None, WORLD, rules="lax")


def test_an_empty_shelf_lets_no_road_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plugins, "_registered", lambda shelf: {})
    with pytest.raises(PartError, match="no rules are installed"):
        inspect(road(), None, WORLD)


def test_rules_of_other_packages_join_the_end_of_strict(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_straights(
        network: Network, route: Road | None, brief: Brief | None, world: World
    ) -> tuple[Finding, ...]:
        (member,) = network.roads
        return (Finding("no_straights", f"the road is straight for {member.road.length:.0f} m"),)

    names, find = plugins.names, plugins.find
    monkeypatch.setattr(plugins, "names", lambda shelf: sorted([*names(shelf), "no_straights"]))
    monkeypatch.setattr(
        plugins, "find", lambda shelf, name: no_straights if name == "no_straights" else find(shelf, name)
    )
    found = inspect(road(grade=0.2), None, WORLD)
    assert [finding.rule for finding in found] == ["too_steep", "no_straights"]
    assert inspect(road(), None, WORLD, rules="sbft") == ()
