"""Pairs at the boundary: two roads that are nearly one, of which the car kept its lane on one only.

Two roads correspond where they have the same row of left turns, right turns and straights; then each number
of the one can be moved to that of the other, and a road half-way is driven next.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from roadgpt.campaign.genome import Genes, genes_of
from roadgpt.campaign.model import Result

LENGTHS, RADII, DEGREES, INCLINES = 10.0, 2.0, 10.0, 1.0
"""Metres, metres, degrees, percent: differences that weigh alike between two genes."""


@dataclass(frozen=True)
class Pair:
    """A road on which the car kept its lane, and its nearest relative on which it did not."""

    kept: int
    """Number of the test."""
    lost: int
    distance: float
    """Root of the sum of squared differences of all turns and straights: 10 m of a straight, 2 m of a radius
    or a clothoid, 10 degrees of a turn, 1 % of a slope are 1."""


def distance(one: Genes, other: Genes) -> float:
    """How far corresponding roads are apart; infinite where they do not correspond."""
    if [np.sign(gene.turn) for gene in one] != [np.sign(gene.turn) for gene in other]:
        return np.inf
    total = 0.0
    for a, b in zip(one, other, strict=True):
        total += ((a.incline - b.incline) / INCLINES) ** 2
        if a.turn:
            total += ((a.turn - b.turn) / DEGREES) ** 2
            total += ((a.radius - b.radius) / RADII) ** 2 + ((a.ramp - b.ramp) / RADII) ** 2
        else:
            total += ((a.length - b.length) / LENGTHS) ** 2
    return float(np.sqrt(total))


MEASURES = (
    ("turn", "angle", " degrees", DEGREES),
    ("radius", "radius", " m", RADII),
    ("ramp", "clothoid", " m", RADII),
    ("length", "length", " m", LENGTHS),
    ("incline", "grade", " %", INCLINES),
)
"""Fields of a gene: what people call them, their unit, and which difference weighs 1."""


def weightiest(kept: Genes, lost: Genes) -> str:
    """What weighs most between corresponding roads: 'turn 2: radius 15.4 m, then 14.9 m'; or nothing."""
    found = (0.0, "")
    turns = straights = 0
    for a, b in zip(kept, lost, strict=True):
        turns, straights = turns + bool(a.turn), straights + (not a.turn)
        what = f"turn {turns}" if a.turn else f"straight {straights}"
        for name, called, unit, scale in MEASURES:
            one, other = getattr(a, name), getattr(b, name)
            if one != other and (weight := abs(one - other) / scale) > found[0]:
                told = f"{what}: {called} {_figure(abs(one) if name == 'turn' else one)}{unit}"
                found = (weight, f"{told}, then {_figure(abs(other) if name == 'turn' else other)}{unit}")
    return found[1]


def _figure(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".").replace("-", "−")


def pairs_of(results: Sequence[Result]) -> list[Pair]:
    """For every failure its nearest relative that was kept, the nearest pairs first; each kept road once.

    Args:
        results: of one cell.
    """
    genes = {r.number: genes_of(r.design) for r in results if r.design and r.outcome in ("PASS", "FAIL")}
    kept = [r.number for r in results if r.outcome == "PASS" and r.number in genes]
    lost = [r.number for r in results if r.outcome == "FAIL" and r.number in genes]
    return paired(genes, kept, lost)


def paired(genes: dict[int, Genes], kept: Sequence[int], lost: Sequence[int]) -> list[Pair]:
    """The same, of roads by their numbers."""
    rows: dict[tuple[float, ...], list[int]] = {}
    for number in kept:
        rows.setdefault(_row(genes[number]), []).append(number)
    every = [
        Pair(other, number, distance(genes[other], genes[number]))
        for number in lost
        for other in rows.get(_row(genes[number]), ())
    ]
    out: list[Pair] = []
    used: set[int] = set()
    for pair in sorted(every, key=lambda pair: (pair.distance, pair.lost, pair.kept)):
        if pair.lost not in used and pair.kept not in used:
            out.append(pair)
            used |= {pair.lost, pair.kept}
    return out


def _row(genes: Genes) -> tuple[float, ...]:
    return tuple(float(np.sign(gene.turn)) for gene in genes)
