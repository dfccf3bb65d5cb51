"""Mutations of a road's elements: each is a pure function that draws from a given random generator.

A mutation may violate the road's requirements; ``variation`` checks every mutated road afterwards.
"""

from collections.abc import Callable
from math import exp
from typing import NamedTuple

import numpy as np

from roadgpt.brief.element import Element, Elements
from roadgpt.road import World
from roadgpt.road.design import MAX_INCLINE

STRAIGHTS = (1.0, 150.0)  # m
TURNS = (12.0, 200.0)  # degrees
TRANSITIONS = (2.0, 16.0)  # m
OVER_LEAST_RADIUS = 1.03  # of the world's least: a spline through points 2 m apart loses so much
WIDEST = 120.0  # m, of a radius
STRETCH = 0.45  # standard deviation of the logarithm of a length, a radius, a transition
SWING = 22.0  # degrees, standard deviation
SLOPE = 2.5  # percent, standard deviation
MOST_ELEMENTS = 24  # of a road
NEW_STRAIGHT = (3.0, 45.0)  # m, of one that is put in
NEW_TURN = (20.0, 120.0)  # degrees

Rng = np.random.Generator


class Mutation(NamedTuple):
    """A kind of mutation, and how often it is drawn relative to the others."""

    make: Callable[[Elements, Rng, World], Elements]
    weight: float
    is_numeric: bool
    """True if the mutation keeps the sequence of turns and straights and changes only numbers."""


def mutated(elements: Elements, rng: Rng, world: World, numeric: float = 0.0) -> Elements:
    """Returns the elements after one to three random mutations, applied one after the other.

    Args:
        elements: the turns and straights of a road.
        rng: the random generator.
        world: determines the limits of radii and grades.
        numeric: probability, 0 to 1, that only lengths, angles, radii and slopes change.
    """
    names = [name for name, change in MUTATIONS.items() if change.is_numeric]
    if rng.random() >= numeric:
        names = list(MUTATIONS)
    weights = np.array([MUTATIONS[name].weight for name in names])
    for number in rng.choice(len(names), size=1 + rng.integers(3), p=weights / weights.sum()):
        elements = MUTATIONS[names[int(number)]].make(elements, rng, world)
    return elements


def crossed_over(one: Elements, other: Elements, rng: Rng) -> Elements:
    """Returns the start of one road followed by the end of another, each cut at a random element."""
    first, last = int(rng.integers(1, len(one) + 1)), int(rng.integers(len(other)))
    return (one[:first] + other[last:])[:MOST_ELEMENTS]


def interpolated(one: Elements, other: Elements, share: float) -> Elements | None:
    """Returns a road between two roads; None unless their sequences of turns and straights correspond.

    Args:
        one: the road that is returned for share 0.
        other: the road that is returned for share 1.
        share: position between the two roads, 0 to 1.
    """
    if [np.sign(element.turn) for element in one] != [np.sign(element.turn) for element in other]:
        return None

    def between(a: float, b: float) -> float:
        return a if a == b else (1 - share) * a + share * b

    return tuple(
        Element(
            between(a.straight, b.straight),
            between(a.turn, b.turn),
            between(a.radius, b.radius),
            between(a.transition, b.transition),
            between(a.incline, b.incline),
            between(a.vertical_radius or 0.0, b.vertical_radius or 0.0) or None,
        )
        for a, b in zip(one, other, strict=True)
    )


def mirrored(elements: Elements, rng: Rng, world: World) -> Elements:
    """Returns the road with every left turn replaced by a right turn, and every right turn by a left turn."""
    del rng, world
    return tuple(element._replace(turn=-element.turn) if element.turn else element for element in elements)


def _longer(elements: Elements, rng: Rng, world: World) -> Elements:
    del world
    return _one(elements, rng, False, lambda e: e._replace(straight=_scaled(e.straight, STRAIGHTS, rng)))


def _tighter(elements: Elements, rng: Rng, world: World) -> Elements:
    limits = (world.min_radius * OVER_LEAST_RADIUS, WIDEST)
    return _one(elements, rng, True, lambda e: e._replace(radius=_scaled(e.radius, limits, rng)))


def _farther(elements: Elements, rng: Rng, world: World) -> Elements:
    del world

    def turn(element: Element) -> Element:
        size = np.clip(abs(element.turn) + SWING * rng.standard_normal(), *TURNS)
        return element._replace(turn=float(np.copysign(size, element.turn)))

    return _one(elements, rng, True, turn)


def _smoother(elements: Elements, rng: Rng, world: World) -> Elements:
    del world

    def change(element: Element) -> Element:
        return element._replace(transition=_scaled(element.transition, TRANSITIONS, rng))

    return _one(elements, rng, True, change)


def _steeper(elements: Elements, rng: Rng, world: World) -> Elements:
    most = min(100 * world.max_grade, MAX_INCLINE) - 0.2

    def slope(element: Element) -> Element:
        return element._replace(
            incline=float(np.clip(element.incline + SLOPE * rng.standard_normal(), -most, most))
        )

    return _with(elements, int(rng.integers(len(elements))), slope)


def _other_hand(elements: Elements, rng: Rng, world: World) -> Elements:
    del world
    return _one(elements, rng, True, lambda e: e._replace(turn=-e.turn))


def _swapped(elements: Elements, rng: Rng, world: World) -> Elements:
    del world
    i, j = (int(n) for n in rng.integers(len(elements), size=2))
    row = list(elements)
    row[i], row[j] = row[j], row[i]
    return tuple(row)


def _inserted(elements: Elements, rng: Rng, world: World) -> Elements:
    if len(elements) >= MOST_ELEMENTS:
        return elements
    at = int(rng.integers(len(elements) + 1))
    incline = elements[min(at, len(elements) - 1)].incline
    return (*elements[:at], *_new(rng, world, incline), *elements[at:])


def _new(rng: Rng, world: World, incline: float) -> Elements:
    """Draws a turn and a straight behind it."""
    least = world.min_radius * OVER_LEAST_RADIUS
    turn = float(rng.choice((-1, 1)) * rng.uniform(*NEW_TURN))
    radius = min(least * exp(float(rng.exponential(0.5))), WIDEST)
    return (
        Element(turn=turn, radius=radius, transition=float(rng.uniform(*TRANSITIONS)), incline=incline),
        Element(straight=float(rng.uniform(*NEW_STRAIGHT)), incline=incline),
    )


def _removed(elements: Elements, rng: Rng, world: World) -> Elements:
    del world
    at = int(rng.integers(len(elements)))
    return elements[:at] + elements[at + 1 :] if len(elements) > 1 else elements


def _backwards(elements: Elements, rng: Rng, world: World) -> Elements:
    """Reverses the direction of driving: left turns become right turns, and climbs become descents."""
    del rng, world
    radii = [None, *(element.vertical_radius for element in reversed(elements[1:]))]
    return tuple(
        element._replace(
            turn=-element.turn if element.turn else 0.0,
            incline=-element.incline + 0.0,
            vertical_radius=radius,
        )
        for element, radius in zip(reversed(elements), radii, strict=True)
    )


MUTATIONS: dict[str, Mutation] = {
    "longer": Mutation(_longer, 3.0, True),
    "tighter": Mutation(_tighter, 3.0, True),
    "farther": Mutation(_farther, 3.0, True),
    "smoother": Mutation(_smoother, 1.0, True),
    "steeper": Mutation(_steeper, 1.0, True),
    "other hand": Mutation(_other_hand, 1.0, False),
    "swapped": Mutation(_swapped, 1.0, False),
    "inserted": Mutation(_inserted, 1.5, False),
    "removed": Mutation(_removed, 1.0, False),
    "mirrored": Mutation(mirrored, 0.5, False),
    "backwards": Mutation(_backwards, 0.5, False),
}


def _one(elements: Elements, rng: Rng, is_turn: bool, change: Callable[[Element], Element]) -> Elements:
    """Applies a change to a random turn, or to a random straight; none where there is none."""
    found = [index for index, element in enumerate(elements) if bool(element.turn) == is_turn]
    return _with(elements, found[int(rng.integers(len(found)))], change) if found else elements


def _with(elements: Elements, index: int, change: Callable[[Element], Element]) -> Elements:
    return (*elements[:index], change(elements[index]), *elements[index + 1 :])


def _scaled(value: float, limits: tuple[float, float], rng: Rng) -> float:
    return float(np.clip(value * np.exp(STRETCH * rng.standard_normal()), *limits))
