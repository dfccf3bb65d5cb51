"""Finds contradictions between the lanes of a route's roads and the lane changes and ramps between them."""

from typing import TYPE_CHECKING

from roadgpt.brief.amount import meets, span
from roadgpt.brief.junctions import RAMPS, JunctionClause
from roadgpt.brief.ranges import Range
from roadgpt.errors import BriefError

if TYPE_CHECKING:
    from roadgpt.brief.model import Brief

STEPS = {"lane_drop": -1, "lane_gain": 1, "lane_change": 0}
"""The number of lanes of the road behind a place where lanes change, minus that of the road before it."""
LEAST_BESIDE_RAMP = 28.0  # m; source: the rule ``ramp_too_short``
LEAST_LANE = 17.0  # m, before the taper; with the wide part of a taper of 60 m, these are the required 28 m
WIDE_IN_TAPER = 0.196  # of the taper: the share in which the lane is still wider than 0.9 of its full width


def check_lane_sequence(brief: "Brief") -> None:
    """Checks how the number of lanes changes along a route, and how long the additional lanes at ramps are.

    Raises:
        BriefError: The numbers of lanes contradict each other, or the acceleration or deceleration lane of a
            merge or an exit is too short; the message says what to change.
    """
    for n, place in enumerate(brief.junctions):
        before, after = brief.stretches[n : n + 2]
        step = 0 if place.take == "main" else STEPS.get(place.kind)
        if step is not None:
            _check_step(place, before, after, step)
        if place.kind in RAMPS and span(place.length).hi < LEAST_BESIDE_RAMP:
            raise BriefError(
                f"the additional lane of a {place.name} is {LEAST_BESIDE_RAMP:g} m long or longer, not "
                f"{place.length} m; change it"
            )
        least = LEAST_LANE + WIDE_IN_TAPER / (1 - WIDE_IN_TAPER) * max(span(place.taper).lo, 0.0)
        if place.taper is not None and span(place.length).hi < least:
            raise BriefError(
                f"with a taper of {place.taper} m, the additional lane of a {place.name} is {least:.0f} m "
                f"long or longer, not {place.length} m; change one of them"
            )


def _check_step(place: JunctionClause, before: "Brief", after: "Brief", step: int) -> None:
    if before.lanes is None or after.lanes is None:
        return
    own = span(before.lanes)
    if not meets(after.lanes, Range(own.lo + step, own.hi + step)):
        what = {-1: "one lane fewer", 0: "as many lanes", 1: "one lane more"}[step]
        raise BriefError(
            f"behind a {place.name} the road has {what}, but the road before it has {before.lanes} and the "
            f"one behind it {after.lanes}; change one of them"
        )
