"""Pairs at the boundary: two roads that are nearly one, of which the car kept its lane on one only.

Two roads correspond where they have the same row of left turns, right turns and straights; then each number
of the one can be moved to that of the other, and a road half-way is driven next.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from roadgpt.campaign.genome import Gene, Genes, genes_of
from roadgpt.campaign.model import Result


class Measure(NamedTuple):
    """A number of a gene, by which two of them differ."""

    field: str
    called: str
    unit: str
    scale: float
    """Which difference weighs 1."""


GRADE = Measure("incline", "grade", " %", 1.0)
OF_TURN = (
    GRADE,
    Measure("turn", "angle", " degrees", 10.0),
    Measure("radius", "radius", " m", 2.0),
    Measure("ramp", "clothoid", " m", 2.0),
)
OF_STRAIGHT = (GRADE, Measure("length", "length", " m", 10.0))


@dataclass(frozen=True)
class BoundaryPair:
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
        for measure in OF_TURN if a.turn else OF_STRAIGHT:
            total += _weight(measure, a, b) ** 2
    return float(np.sqrt(total))


def weightiest(kept: Genes, lost: Genes) -> str:
    """What weighs most between corresponding roads: 'turn 2: radius 15.4 m, then 14.9 m'; or nothing."""
    most, found = 0.0, ""
    turns = straights = 0
    for a, b in zip(kept, lost, strict=True):
        turns, straights = turns + bool(a.turn), straights + (not a.turn)
        what = f"turn {turns}" if a.turn else f"straight {straights}"
        for measure in OF_TURN if a.turn else OF_STRAIGHT:
            weight = abs(_weight(measure, a, b))
            if weight > most:
                then = f"{_figure(a, measure)}, then {_figure(b, measure)}"
                most, found = weight, f"{what}: {measure.called} {then}"
    return found


def _weight(measure: Measure, a: Gene, b: Gene) -> float:
    difference: float = getattr(a, measure.field) - getattr(b, measure.field)
    return difference / measure.scale


def _figure(gene: Gene, measure: Measure) -> str:
    value = getattr(gene, measure.field)
    size = abs(value) if measure.field == "turn" else value
    return f"{size:.2f}".rstrip("0").rstrip(".").replace("-", "−") + measure.unit


def pairs_of(results: Sequence[Result]) -> list[BoundaryPair]:
    """For every failure its nearest relative that was kept, the nearest pairs first; each kept road once.

    Args:
        results: of one cell.
    """
    genes = {r.number: genes_of(r.design) for r in results if r.design and r.outcome in ("PASS", "FAIL")}
    kept = [r.number for r in results if r.outcome == "PASS" and r.number in genes]
    lost = [r.number for r in results if r.outcome == "FAIL" and r.number in genes]
    return paired(genes, kept, lost)


def paired(genes: dict[int, Genes], kept: Sequence[int], lost: Sequence[int]) -> list[BoundaryPair]:
    """The same, of roads by their numbers."""
    rows: dict[tuple[float, ...], list[int]] = {}
    for number in kept:
        rows.setdefault(_row(genes[number]), []).append(number)
    every = [
        BoundaryPair(other, number, distance(genes[other], genes[number]))
        for number in lost
        for other in rows.get(_row(genes[number]), ())
    ]
    out: list[BoundaryPair] = []
    used: set[int] = set()
    for pair in sorted(every, key=lambda pair: (pair.distance, pair.lost, pair.kept)):
        if pair.lost not in used and pair.kept not in used:
            out.append(pair)
            used |= {pair.lost, pair.kept}
    return out


def _row(genes: Genes) -> tuple[float, ...]:
    return tuple(float(np.sign(gene.turn)) for gene in genes)
