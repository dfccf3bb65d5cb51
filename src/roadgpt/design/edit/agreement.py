"""Makes the steps of several changes of one element agree: each sets only what its own change is about.

Alone, "tighter" keeps the angle of a turn, and "sharper" its radius. In one request they must not.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from roadgpt.brief.change.request import Change, What
from roadgpt.brief.ranges import Range
from roadgpt.design.edit.placing import PlacedChange
from roadgpt.design.edit.steps import Adjust, EditCandidate, EditStep, Wanted

YIELDS: Mapping[What, Mapping[str, frozenset[What]]] = {
    "angle": {"radius": frozenset({"radius", "shape"})},
    "radius": {"degrees": frozenset({"angle", "shape"})},
    "shape": {"radius": frozenset({"radius"})},
    "side": {"degrees": frozenset({"angle", "shape"}), "radius": frozenset({"radius", "shape"})},
    "mirror": {"degrees": frozenset({"angle", "shape"}), "radius": frozenset({"radius", "shape"})},
}
"""For each change, the values that its steps set beside its own, and the changes that have these values as
their own; where an element has such a change, the step leaves the value to it.
"""
LEAST_SEEN = 0.03  # of a value: a smaller change is hardly seen
NEAR = 0.02  # of a limit: what a value at the limit may miss
VALUES: Mapping[What, str] = {"angle": "degrees", "radius": "radius", "length": "length"}


def agreed(
    changes: Sequence[PlacedChange], ways: Sequence[tuple[EditCandidate, ...]]
) -> list[tuple[EditCandidate, ...]]:
    """Returns the candidates of all changes, with steps that leave other values to the other changes of the
    same element, and stay within its limits ("tighter, but at least 25 m").
    """
    asked = defaultdict[str, list[Change]](list)
    for placed in changes:
        for element in placed.elements:
            asked[element.name].append(placed.change)

    def own(step: EditStep, placed: PlacedChange) -> EditStep:
        if not isinstance(step, Adjust):
            return step
        change, is_one_of_several = placed.change, len(placed.elements) > 1
        others = [other for other in asked[step.element.name] if other is not change]
        step = _yielding(step, change, others)
        return _within_limits(step, change, others, is_one_of_several) if _is_open(change) else step

    return [
        tuple(tuple(own(step, placed) for step in way) for way in its)
        for placed, its in zip(changes, ways, strict=True)
    ]


def _is_open(change: Change) -> bool:
    """Returns whether a change gives only a direction, such as "tighter", and no number."""
    return change.more != 0 and change.by is None


def _yielding(step: Adjust, change: Change, others: Sequence[Change]) -> Adjust:
    whats = {other.what for other in others}
    owned = YIELDS.get(change.what, {})
    left: dict[str, Any] = {name: None for name in owned if not whats.isdisjoint(owned[name])}
    # of a hairpin the angle is its own; of a gentle or sharp turn another change may set it
    if change.what == "shape" and change.kind is None and "angle" in whats:
        left["degrees"] = None
    degrees, seen = step.degrees, step.element.seen
    if change.what == "angle" and _is_open(change) and "radius" in left and degrees and seen:
        # alone, a small change of angle may become one of the radius
        left["degrees"] = Wanted.towards(seen.degrees, degrees.aim)
    return replace(step, **left)


def _within_limits(step: Adjust, change: Change, others: Sequence[Change], is_one_of_several: bool) -> Adjust:
    """Returns the step of a change without a number ("tighter") with its value inside the limits that other
    changes set, or at the limit if that is a smaller change than usual. A value that is at the limit already
    stays, if other elements change as well; otherwise the step is unchanged, and breaks the limit.
    """
    name = VALUES.get(change.what, "")
    wanted: Wanted | None = getattr(step, name, None)
    bounds = {
        side: [other.to for other in others if (other.what, other.bound) == (change.what, side) and other.to]
        for side in (1, -1)
    }
    if wanted is None or not (bounds[1] or bounds[-1]):
        return step
    low, high = max([wanted.room.lo, *bounds[1]]), min([wanted.room.hi, *bounds[-1]])
    if low <= high:
        aim = min(max(wanted.aim, low), high)
        return _with(step, name, Wanted(aim, Range(low, high)))
    now = getattr(step.element.seen, name)
    limit = low if change.more < 0 else high
    change_left = (limit / now - 1) * change.more
    if change_left > LEAST_SEEN:
        return _with(step, name, Wanted.near(limit, NEAR * limit))
    is_there = is_one_of_several and change_left >= -NEAR
    return _with(step, name, Wanted.near(now, NEAR * now)) if is_there else step


def _with(step: Adjust, name: str, wanted: Wanted) -> Adjust:
    values: dict[str, Any] = {name: wanted}
    return replace(step, **values)
