"""The test oracles: what each name means is written down here a second time, by hand."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.errors import UsageError
from roadgpt.road import ORACLES, Limits, World
from roadgpt.road.world import oracle_in_words, oracle_limits, oracle_name

MEANT = {"half": (0.5, False), "sbft": (0.85, False), "thesis": (0.95, False), "departure": (0.5, True)}


def test_each_name_means_what_is_said() -> None:
    assert {name: tuple(limits.values()) for name, limits in ORACLES.items()} == MEANT
    for name, (tolerance, departure) in MEANT.items():
        for world in (
            World().changed(oracle=name),
            World.model_validate({"oracle": name, "friction": 0.6}),
            World(limits=Limits(**ORACLES[name])),
        ):
            assert (world.limits.oob_tolerance, world.limits.lane_departure) == (tolerance, departure)
            assert world.limits.oracle == name
    assert World().limits.oracle == "half"


@given(st.floats(0, 1, exclude_min=True), st.booleans())
def test_a_name_leads_back_to_its_limits(tolerance: float, departure: bool) -> None:
    limits = Limits(oob_tolerance=tolerance, lane_departure=departure)
    assert oracle_limits(limits.oracle) == {"oob_tolerance": tolerance, "lane_departure": departure}
    assert World().changed(oracle=limits.oracle).limits == limits


@pytest.mark.parametrize(
    "name", ["", "Half ", "0", "-0.5", "1.01", "nan", "inf", "departure:", "departure:2", "x"]
)
def test_what_is_no_oracle_is_refused(name: str) -> None:
    with pytest.raises(UsageError, match="there is no oracle"):
        oracle_limits(name or " ")


def test_a_contradiction_is_refused_in_one_sentence() -> None:
    assert oracle_limits("thesis", oob_tolerance=0.95) == ORACLES["thesis"]
    with pytest.raises(UsageError, match=r"thesis and oob_tolerance 0\.5 contradict each other; leave one"):
        oracle_limits("thesis", oob_tolerance=0.5)
    with pytest.raises(UsageError, match="oracle half and lane_departure true contradict each other"):
        World.model_validate({"oracle": "half", "lane_departure": True})
    # a change replaces the oracle that was there before
    strict = World().changed(oob_tolerance=0.9, lane_departure=True, friction=0.6).changed(oracle="half")
    assert (strict.limits.oracle, strict.site.friction) == ("half", 0.6)


def test_an_oracle_is_told_in_words() -> None:
    assert oracle_in_words("half") == "half: FAIL when more than half of the car is outside its lane"
    assert oracle_in_words("0.7") == "0.7: FAIL when more than 70 % of the car is outside its lane"
    assert oracle_in_words("departure") == (
        "departure: FAIL when a front tyre is over the marking, or more than half of the car is outside its "
        "lane"
    )
    assert oracle_name(0.95, True) == "departure:0.95"
