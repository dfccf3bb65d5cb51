"""Mutations of a road's genes: each is a pure function that draws from a given random generator.

A mutation does not look at what was asked for: ``variation`` checks every road afterwards.
"""

from collections.abc import Callable
from math import exp
from typing import NamedTuple

import numpy as np

from roadgpt.campaign.genome import Gene, Genes
from roadgpt.road import World
from roadgpt.road.design import MAX_INCLINE

STRAIGHTS = (1.0, 150.0)  # m
TURNS = (12.0, 200.0)  # degrees
RAMPS = (2.0, 16.0)  # m
OVER_LEAST_RADIUS = 1.03  # of the world's least: a spline through points 2 m apart loses so much
WIDEST = 120.0  # m, of a radius
STRETCH = 0.45  # standard deviation of the logarithm of a length, a radius, a ramp
SWING = 22.0  # degrees, standard deviation
SLOPE = 2.5  # percent, standard deviation
MOST_GENES = 24  # of a road
NEW_STRAIGHT = (3.0, 45.0)  # m, of one that is put in
NEW_TURN = (20.0, 120.0)  # degrees

Rng = np.random.Generator


class Mutation(NamedTuple):
    """A kind of mutation, and how often it is drawn relative to the others."""

    make: Callable[[Genes, Rng, World], Genes]
    weight: float
    is_numeric: bool
    """True if it keeps the sequence of turns and straights and changes numbers only."""


def mutated(genes: Genes, rng: Rng, world: World, numeric: float = 0.0) -> Genes:
    """Applies one to three mutations, one after the other.

    Args:
        genes: of a road.
        rng: the random generator.
        world: gives the limits of radii and grades.
        numeric: probability that only lengths, angles, radii and slopes change.
    """
    names = [name for name, change in MUTATIONS.items() if change.is_numeric]
    if rng.random() >= numeric:
        names = list(MUTATIONS)
    weights = np.array([MUTATIONS[name].weight for name in names])
    for number in rng.choice(len(names), size=1 + rng.integers(3), p=weights / weights.sum()):
        genes = MUTATIONS[names[int(number)]].make(genes, rng, world)
    return genes


def crossed_over(one: Genes, other: Genes, rng: Rng) -> Genes:
    """Returns the start of one road followed by the end of another, each cut at a random gene."""
    first, last = int(rng.integers(1, len(one) + 1)), int(rng.integers(len(other)))
    return (one[:first] + other[last:])[:MOST_GENES]


def interpolated(one: Genes, other: Genes, share: float) -> Genes | None:
    """Returns the road between two whose turns and straights correspond; None where they do not.

    Args:
        one: the road at share 0.
        other: the road at share 1.
        share: 0 to 1.
    """
    if [np.sign(gene.turn) for gene in one] != [np.sign(gene.turn) for gene in other]:
        return None

    def between(a: float, b: float) -> float:
        return a if a == b else (1 - share) * a + share * b

    return tuple(Gene(*map(between, a, b)) for a, b in zip(one, other, strict=True))


def mirrored(genes: Genes, rng: Rng, world: World) -> Genes:
    """Turns every left turn into a right one, and every right one into a left one."""
    del rng, world
    return tuple(gene._replace(turn=-gene.turn) if gene.turn else gene for gene in genes)


def _longer(genes: Genes, rng: Rng, world: World) -> Genes:
    del world
    return _with(
        genes, _any(genes, rng, is_turn=False), lambda g: g._replace(length=_scaled(g.length, STRAIGHTS, rng))
    )


def _tighter(genes: Genes, rng: Rng, world: World) -> Genes:
    limits = (world.min_radius * OVER_LEAST_RADIUS, WIDEST)
    return _with(
        genes, _any(genes, rng, is_turn=True), lambda g: g._replace(radius=_scaled(g.radius, limits, rng))
    )


def _farther(genes: Genes, rng: Rng, world: World) -> Genes:
    del world

    def turn(gene: Gene) -> Gene:
        size = np.clip(abs(gene.turn) + SWING * rng.standard_normal(), *TURNS)
        return gene._replace(turn=float(np.copysign(size, gene.turn)))

    return _with(genes, _any(genes, rng, is_turn=True), turn)


def _smoother(genes: Genes, rng: Rng, world: World) -> Genes:
    del world
    return _with(
        genes, _any(genes, rng, is_turn=True), lambda g: g._replace(ramp=_scaled(g.ramp, RAMPS, rng))
    )


def _steeper(genes: Genes, rng: Rng, world: World) -> Genes:
    most = min(100 * world.max_grade, MAX_INCLINE) - 0.2

    def slope(gene: Gene) -> Gene:
        return gene._replace(
            incline=float(np.clip(gene.incline + SLOPE * rng.standard_normal(), -most, most))
        )

    return _with(genes, int(rng.integers(len(genes))), slope)


def _other_hand(genes: Genes, rng: Rng, world: World) -> Genes:
    del world
    return _with(genes, _any(genes, rng, is_turn=True), lambda g: g._replace(turn=-g.turn))


def _swapped(genes: Genes, rng: Rng, world: World) -> Genes:
    del world
    i, j = (int(n) for n in rng.integers(len(genes), size=2))
    row = list(genes)
    row[i], row[j] = row[j], row[i]
    return tuple(row)


def _inserted(genes: Genes, rng: Rng, world: World) -> Genes:
    if len(genes) >= MOST_GENES:
        return genes
    at = int(rng.integers(len(genes) + 1))
    incline = genes[min(at, len(genes) - 1)].incline
    return (*genes[:at], *_new(rng, world, incline), *genes[at:])


def _new(rng: Rng, world: World, incline: float) -> Genes:
    """Draws a turn and a straight behind it."""
    least = world.min_radius * OVER_LEAST_RADIUS
    turn = float(rng.choice((-1, 1)) * rng.uniform(*NEW_TURN))
    radius = min(least * exp(float(rng.exponential(0.5))), WIDEST)
    return (
        Gene(turn=turn, radius=radius, ramp=float(rng.uniform(*RAMPS)), incline=incline),
        Gene(length=float(rng.uniform(*NEW_STRAIGHT)), incline=incline),
    )


def _removed(genes: Genes, rng: Rng, world: World) -> Genes:
    del world
    at = int(rng.integers(len(genes)))
    return genes[:at] + genes[at + 1 :] if len(genes) > 1 else genes


def _backwards(genes: Genes, rng: Rng, world: World) -> Genes:
    """Reverses the direction of driving: left turns become right turns, and climbs become descents."""
    del rng, world
    radii = [0.0, *(gene.vertical_radius for gene in reversed(genes[1:]))]
    return tuple(
        gene._replace(
            turn=-gene.turn if gene.turn else 0.0, incline=-gene.incline + 0.0, vertical_radius=radius
        )
        for gene, radius in zip(reversed(genes), radii, strict=True)
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


def _any(genes: Genes, rng: Rng, is_turn: bool) -> int | None:
    """Draws the index of a turn, or of a straight; None where there is none."""
    found = [index for index, gene in enumerate(genes) if bool(gene.turn) == is_turn]
    return found[int(rng.integers(len(found)))] if found else None


def _with(genes: Genes, index: int | None, change: Callable[[Gene], Gene]) -> Genes:
    return genes if index is None else (*genes[:index], change(genes[index]), *genes[index + 1 :])


def _scaled(value: float, limits: tuple[float, float], rng: Rng) -> float:
    return float(np.clip(value * np.exp(STRETCH * rng.standard_normal()), *limits))
