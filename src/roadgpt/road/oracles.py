"""The test oracles by name: when a drive fails because the car is out of its lane."""

from typing import Any

from roadgpt.errors import UsageError

ORACLES: dict[str, dict[str, Any]] = {
    "half": {"oob_tolerance": 0.5, "lane_departure": False},
    "sbft": {"oob_tolerance": 0.85, "lane_departure": False},
    "thesis": {"oob_tolerance": 0.95, "lane_departure": False},
    "departure": {"oob_tolerance": 0.5, "lane_departure": True},
}
"""The fields of Limits that each oracle sets; ``departure`` is that of UN Regulation No. 157."""


def oracle_limits(oracle: str = "half", **given: Any) -> dict[str, Any]:
    """Returns the fields of Limits that an oracle sets: one of ORACLES; or a share of the car such as "0.7";
    or "departure:0.7", where a front tyre beyond the marking fails the test as well.

    Raises:
        UsageError: there is no such oracle, or it contradicts a field of ``given``.
    """
    share = oracle.removeprefix("departure:")
    try:
        limits = ORACLES.get(oracle) or {"oob_tolerance": float(share), "lane_departure": share != oracle}
    except ValueError:
        limits = {"oob_tolerance": 0.0}
    if not 0 < limits["oob_tolerance"] <= 1:
        raise UsageError(f"there is no oracle '{oracle}'; give {', '.join(ORACLES)}, or a share from 0 to 1")
    if wrong := [f"{name} {value}".lower() for name, value in given.items() if value != limits[name]]:
        raise UsageError(f"oracle {oracle} and {wrong[0]} contradict each other; leave one of them out")
    return limits


def oracle_name(oob_tolerance: float, lane_departure: bool) -> str:
    """Returns the name of the oracle with these limits; ``oracle_limits`` returns them again."""
    limits = {"oob_tolerance": oob_tolerance, "lane_departure": lane_departure}
    other = f"{'departure:' * lane_departure}{oob_tolerance!r}"
    return next((name for name, own in ORACLES.items() if own == limits), other)


def oracle_in_words(oracle: str) -> str:
    """Returns "half: FAIL when more than half of the car is outside its lane", for the oracle "half"."""
    limits = oracle_limits(oracle)
    tyre = "a front tyre is over the marking, or " * limits["lane_departure"]
    share = share_in_words(limits["oob_tolerance"])
    return f"{oracle}: FAIL when {tyre}more than {share} is outside its lane"


def share_in_words(share: float) -> str:
    """Returns a share of the car in words: "half of the car" or "85 % of the car"."""
    return "half of the car" if share == 0.5 else f"{100 * share:g} % of the car"
