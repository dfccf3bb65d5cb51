"""Settles changes of the same property: a part of the road keeps its own wish, and opposites are refused."""

from collections.abc import Hashable, Sequence
from dataclasses import replace
from itertools import combinations

from roadgpt.brief.change.request import Change, What
from roadgpt.design.edit.placing import PlacedChange
from roadgpt.errors import EditError

VALUED: frozenset[What] = frozenset({"angle", "radius", "length"})
TOGGLES: frozenset[What] = frozenset({"mirror", "swap", "alternate"})
"""Changes of which the second one would undo the first, or do nothing."""


def settled(changes: Sequence[PlacedChange]) -> tuple[PlacedChange, ...]:
    """Returns the changes, each without the elements that another change of the same property names alone,
    and what would undo itself, such as "mirror", only once.

    "All turns by 10 degrees, turn 2 by 20" turns turn 2 by 20 degrees only. Limits hold for all their
    elements but those that get a value inside them. ``search`` lays slopes of parts over those of more of
    the road.

    Raises:
        EditError: two changes ask for opposite things of the same elements.
    """
    once = [*changes]
    for one, other in combinations(changes, 2):
        if _place(one) != _place(other) or not are_opposites(one.change, other.change):
            continue
        if replace(one.change, words="") != replace(other.change, words=""):
            said = f"'{one.change.words}' and '{other.change.words}'"
            raise EditError(f"{said} contradict each other; leave one of them out")
        once = [placed for placed in once if placed is not other]
    return tuple(_without_parts(placed, changes) for placed in once)


def are_opposites(one: Change, other: Change) -> bool:
    """Returns whether two changes of the same elements cannot both be meant."""
    if one.what != other.what:
        return False
    if one.what in TOGGLES or (one.what == "side" and (one.side is None or one.side != other.side)):
        return True
    if one.what == "shape":
        return _differ(one.kind, other.kind) or _differ(one.sharpness, other.sharpness)
    if one.is_state and other.is_state:
        return _differ(one.way, other.way) or _differ(one.to, other.to)
    if one.bound or other.bound:
        return _are_apart(one, other)
    return _direction(one) * _direction(other) < 0


def _differ(one: object, other: object) -> bool:
    return one is not None and other is not None and one != other


def _are_apart(one: Change, other: Change) -> bool:
    """Returns whether a limit excludes a value, or two limits leave no value between them."""
    if one.to is None or other.to is None or one.bound == other.bound:
        return False
    return (other.bound != 0 or other.is_state) and (
        one.is_outside(other.to) if one.bound else other.is_outside(one.to)
    )


def _direction(change: Change) -> float:
    """Returns a number above 0 if a change makes a value larger, below 0 if smaller, and 0 if neither."""
    factor = change.times - 1 if change.times is not None and change.times > 0 else 0.0
    return change.more or factor


def _place(placed: PlacedChange) -> Hashable:
    """Returns what is equal for two changes of the same place: the whole road, or the same parts of the same
    elements, such as their first half or what climbs of them.
    """
    target = placed.change.target
    if target is None:
        return None
    return frozenset(each.name for each in placed.elements), placed.stretch, target.way


def _without_parts(placed: PlacedChange, changes: Sequence[PlacedChange]) -> PlacedChange:
    own = placed.change
    if own.what not in VALUED or own.is_of_road:
        return placed
    others = [other for other in changes if other.change.what == own.what and not other.change.bound]
    if not own.bound:
        return placed.without(others)
    values = [other for other in others if other.change.is_state and other.change.to is not None]
    within = [other for other in values if not own.is_outside(other.change.to or 0.0)]
    valued = {each.name for other in within for each in other.elements}
    return placed._replace(elements=tuple(each for each in placed.elements if each.name not in valued))
