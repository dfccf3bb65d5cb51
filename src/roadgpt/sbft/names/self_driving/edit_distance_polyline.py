"""How much two rows of points differ."""

from __future__ import annotations

from typing import Any, List, Sequence, Tuple

from roadgpt_inside import elsewhere
from roadgpt_inside.asking import ask

AngleLength = Tuple[float, float]
ListOfAngleLength = List[AngleLength]
Point = Tuple[float, float]
ListOfPoints = List[Point]


def iterative_levenshtein(s: Sequence[Sequence[float]], t: Sequence[Sequence[float]]) -> float:
    """The weighted Levenshtein distance of two rows of steps: change of direction, and length."""
    return float(ask("distance", one=[p[:2] for p in s], other=[p[:2] for p in t]))


def __getattr__(name: str) -> Any:
    return elsewhere.other(__name__, name)
