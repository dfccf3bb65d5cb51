"""Mutations of a road's elements: each mutation is a pure function of the elements and a random generator.

A mutation may violate the road's requirements; ``variation`` checks every mutated road afterwards.
"""

from collections.abc import Callable, Sequence
from math import exp
from typing import Any, Literal, NamedTuple

import numpy as np

from roadgpt.brief.element import Element, Elements
from roadgpt.road import World
from roadgpt.road.design import MAX_INCLINE

STRAIGHTS = (1.0, 150.0)  # m
TURNS = (12.0, 200.0)  # degrees
TRANSITIONS = (0.1, 16.0)  # m; at 0.1 m the curvature changes at once
OVER_LEAST_RADIUS = 1.03  # times the world's smallest radius: a spline through points 2 m apart is tighter
WIDEST = 120.0  # m, of a radius
STRETCH = 0.45  # standard deviation of the logarithm of a length, a radius, a transition
SWING = 22.0  # degrees, standard deviation
SLOPE = 2.5  # percent, standard deviation
CHANGED_TOO = 0.5  # probability that a crossover of two roads is mutated, too
MOST_ELEMENTS = 24  # of a road
PACKED = (0.05, 0.8)  # share of their lengths that straights keep when all are shortened
NEW_STRAIGHT = (3.0, 45.0)  # m, length of an inserted straight
NEW_TURN = (20.0, 120.0)  # degrees, of an inserted turn
ENLARGED = 0.25  # standard deviation of the logarithm by which a whole plan is scaled
REDRAWN = (0.1, 1.2)  # logarithm of the widest radius of redrawn turns over the smallest allowed one
SPARED = 0.5  # largest share of straights that a road with redrawn turns keeps
SHORT = 30.0  # m, longest of these straights
INTERPOLATED = Element._fields[: Element._fields.index("vertical_radius") + 1]

Rng = np.random.Generator
Make = Callable[[Elements, Rng, World], Elements]
Kind = Literal["turn", "straight", "any"]


class Mutation(NamedTuple):
    """A type of mutation, such as reversing the direction of a turn."""

    make: Make
    """A function that returns the mutated elements."""
    weight: float
    """How often this mutation is chosen, relative to the other mutations."""
    is_numeric: bool
    """True if the mutation keeps the sequence of turns and straights and changes only numbers."""


def mutated(elements: Elements, rng: Rng, world: World, numeric: float = 0.0) -> Elements:
    """Returns the elements after one to three random mutations, applied one after the other.

    ``numeric`` is the probability, 0 to 1, that only lengths, angles, radii and slopes change.
    """
    some = NUMERIC_ONES if rng.random() < numeric else [*MUTATIONS.values()]
    weights = np.array([one.weight for one in some])
    for number in rng.choice(len(some), size=1 + rng.integers(3), p=weights / weights.sum()):
        elements = some[int(number)].make(elements, rng, world)
    return elements


def crossed_over(one: Elements, other: Elements, rng: Rng) -> Elements:
    """Joins the first elements of one road to the last elements of another road; returns at most 24
    elements. Both roads are cut at random."""
    first, last = int(rng.integers(1, len(one) + 1)), int(rng.integers(len(other)))
    return (one[:first] + other[last:])[:MOST_ELEMENTS]


def interpolated(one: Elements, other: Elements, share: float) -> Elements | None:
    """Returns a road between two roads; ``share`` 0 gives the first road, 1 the second. Returns None if the
    roads' sequences of turns and straights differ."""
    if [np.sign(element.turn) for element in one] != [np.sign(element.turn) for element in other]:
        return None

    def between(a: Any, b: Any) -> Any:
        return a if a == b else (1 - share) * (a or 0.0) + share * (b or 0.0)

    out = []
    for pair in zip(one, other, strict=True):
        mixed = {name: between(*(getattr(each, name) for each in pair)) for name in INTERPOLATED}
        out.append(Element(**mixed | {"vertical_radius": mixed["vertical_radius"] or None}))
    return tuple(out)


def varied(parents: Sequence[Elements], rng: Rng, world: World, numeric: float, rounds: int = 1) -> Elements:
    """Returns a mutation of one parent, or a crossover of two parents; half of the crossovers are mutated.

    ``numeric`` is as for ``mutated``, which is applied ``rounds`` times.
    """
    elements = crossed_over(parents[0], parents[1], rng) if len(parents) > 1 else parents[0]
    if len(parents) > 1 and rng.random() >= CHANGED_TOO:
        return elements
    for _ in range(rounds):
        elements = mutated(elements, rng, world, numeric)
    return elements


def mirrored(elements: Elements) -> Elements:
    """Returns the road with every left turn replaced by a right turn, and every right turn by a left turn."""
    return tuple(element._replace(turn=-element.turn) if element.turn else element for element in elements)


def _longer(element: Element, rng: Rng, world: World) -> Element:
    return element._replace(straight=_scaled(element.straight, STRAIGHTS, rng))


def _tighter(element: Element, rng: Rng, world: World) -> Element:
    least = world.limits.min_radius * OVER_LEAST_RADIUS
    return element._replace(radius=_scaled(element.radius, (least, WIDEST), rng))


def _farther(element: Element, rng: Rng, world: World) -> Element:
    size = np.clip(abs(element.turn) + SWING * rng.standard_normal(), *TURNS)
    return element._replace(turn=float(np.copysign(size, element.turn)))


def _smoother(element: Element, rng: Rng, world: World) -> Element:
    return element._replace(transition=_transition(rng))


def _steeper(element: Element, rng: Rng, world: World) -> Element:
    most = min(100 * world.limits.max_grade, MAX_INCLINE) - 0.2
    return element._replace(
        incline=float(np.clip(element.incline + SLOPE * rng.standard_normal(), -most, most))
    )


def _swapped(elements: Elements, rng: Rng, world: World) -> Elements:
    i, j = (int(n) for n in rng.integers(len(elements), size=2))
    row = list(elements)
    row[i], row[j] = row[j], row[i]
    return tuple(row)


def _inserted(elements: Elements, rng: Rng, world: World) -> Elements:
    """Returns the elements with a new turn, followed by a new straight, at a random place."""
    if len(elements) >= MOST_ELEMENTS:
        return elements
    at = int(rng.integers(len(elements) + 1))
    incline = elements[min(at, len(elements) - 1)].incline
    turn = float(rng.choice((-1, 1)) * rng.uniform(*NEW_TURN))
    radius = min(world.limits.min_radius * OVER_LEAST_RADIUS * exp(float(rng.exponential(0.5))), WIDEST)
    new = Element(turn=turn, radius=radius, transition=_transition(rng), incline=incline)
    straight = Element(straight=float(rng.uniform(*NEW_STRAIGHT)), incline=incline)
    return (*elements[:at], new, straight, *elements[at:])


def _removed(elements: Elements, rng: Rng, world: World) -> Elements:
    at = int(rng.integers(len(elements)))
    return elements[:at] + elements[at + 1 :] if len(elements) > 1 else elements


def _cut_out(elements: Elements, rng: Rng, world: World) -> Elements:
    """Returns some successive elements only, at least one."""
    first, last = sorted(int(n) for n in rng.integers(len(elements) + 1, size=2))
    return elements[first:last] if last > first else elements


def _packed(elements: Elements, rng: Rng, world: World) -> Elements:
    """Shortens all straights by the same factor."""
    share = rng.uniform(*PACKED)
    return tuple(
        one if one.turn else one._replace(straight=max(one.straight * share, STRAIGHTS[0]))
        for one in elements
    )


def _wound(elements: Elements, rng: Rng, world: World) -> Elements:
    """Returns the elements with two tight turns to opposite sides, without a straight between them."""
    if len(elements) + 1 >= MOST_ELEMENTS:
        return elements
    at = int(rng.integers(len(elements) + 1))
    incline = elements[min(at, len(elements) - 1)].incline
    side = float(rng.choice((-1, 1)))
    radius = min(world.limits.min_radius * OVER_LEAST_RADIUS * exp(float(rng.exponential(0.2))), WIDEST)
    pair = tuple(
        Element(
            turn=hand * float(rng.uniform(*NEW_TURN)),
            radius=radius,
            transition=_transition(rng),
            incline=incline,
        )
        for hand in (side, -side)
    )
    return (*elements[:at], *pair, *elements[at:])


def _enlarged(elements: Elements, rng: Rng, world: World) -> Elements:
    """Scales the plan of the road: all straights and radii by the same factor."""
    factor = exp(ENLARGED * float(rng.standard_normal()))
    least = world.limits.min_radius * OVER_LEAST_RADIUS
    return tuple(
        one._replace(radius=float(np.clip(one.radius * factor, least, WIDEST)))
        if one.turn
        else one._replace(straight=float(np.clip(one.straight * factor, *STRAIGHTS)))
        for one in elements
    )


def redrawn(elements: Elements, rng: Rng, world: World) -> Elements:
    """Returns the road with new random turns in place of its turns. Most straights are left out; the other
    straights get new random lengths of at most 30 m."""
    least = world.limits.min_radius * OVER_LEAST_RADIUS
    most, spared = float(rng.uniform(*REDRAWN)), rng.uniform(0.0, SPARED)
    out = []
    for one in elements:
        if one.turn:
            turn = float(rng.choice((-1, 1)) * rng.uniform(*NEW_TURN))
            radius = least * exp(float(rng.uniform(0.0, most)))
            out.append(one._replace(turn=turn, radius=radius, transition=_transition(rng)))
        elif rng.random() < spared:
            out.append(one._replace(straight=float(rng.uniform(STRAIGHTS[0], SHORT))))
    return tuple(out) or elements


def _backwards(elements: Elements, rng: Rng, world: World) -> Elements:
    """Reverses the direction of driving: left turns become right turns, and climbs become descents."""
    radii = [None, *(element.vertical_radius for element in reversed(elements[1:]))]
    return tuple(
        element._replace(
            turn=-element.turn if element.turn else 0.0,
            incline=-element.incline + 0.0,
            vertical_radius=radius,
        )
        for element, radius in zip(reversed(elements), radii, strict=True)
    )


def _of_one(change: Callable[[Element, Rng, World], Element], kind: Kind) -> Make:
    """Returns a mutation that changes one random element of a kind, if there is any."""

    def make(elements: Elements, rng: Rng, world: World) -> Elements:
        found = [i for i, one in enumerate(elements) if kind in ("any", "turn" if one.turn else "straight")]
        if not found:
            return elements
        index = found[int(rng.integers(len(found)))]
        return (*elements[:index], change(elements[index], rng, world), *elements[index + 1 :])

    return make


MUTATIONS: dict[str, Mutation] = {
    "longer": Mutation(_of_one(_longer, "straight"), 3.0, True),
    "tighter": Mutation(_of_one(_tighter, "turn"), 3.0, True),
    "farther": Mutation(_of_one(_farther, "turn"), 3.0, True),
    "smoother": Mutation(_of_one(_smoother, "turn"), 1.0, True),
    "steeper": Mutation(_of_one(_steeper, "any"), 1.0, True),
    "other hand": Mutation(_of_one(lambda one, rng, world: one._replace(turn=-one.turn), "turn"), 1.0, False),
    "swapped": Mutation(_swapped, 1.0, False),
    "inserted": Mutation(_inserted, 1.5, False),
    "removed": Mutation(_removed, 1.0, False),
    "cut out": Mutation(_cut_out, 1.0, False),
    "packed": Mutation(_packed, 1.0, True),
    "wound": Mutation(_wound, 1.0, False),
    "enlarged": Mutation(_enlarged, 1.5, True),
    "redrawn": Mutation(redrawn, 0.5, False),
    "mirrored": Mutation(lambda elements, rng, world: mirrored(elements), 0.5, False),
    "backwards": Mutation(_backwards, 0.5, False),
}
NUMERIC_ONES = [one for one in MUTATIONS.values() if one.is_numeric]


def _transition(rng: Rng) -> float:
    """Draws the length of a clothoid in metres; lengths of every order of magnitude are equally likely."""
    return exp(float(rng.uniform(*np.log(TRANSITIONS))))


def _scaled(value: float, limits: tuple[float, float], rng: Rng) -> float:
    return float(np.clip(value * np.exp(STRETCH * rng.standard_normal()), *limits))
