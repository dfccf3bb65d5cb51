"""Computes the edit distance between two sequences of points."""

from __future__ import annotations

from typing import List, Sequence, Tuple

from roadgpt_inside import ask

AngleLength = Tuple[float, float]
ListOfAngleLength = List[AngleLength]
Point = Tuple[float, float]
ListOfPoints = List[Point]


def iterative_levenshtein(s: Sequence[Sequence[float]], t: Sequence[Sequence[float]]) -> float:
    """Returns the competition's weighted Levenshtein distance between two sequences of points (x, y) in
    metres. It compares the change of direction and the length of each step from point to point.
    """
    return float(ask("distance", one=[p[:2] for p in s], other=[p[:2] for p in t]))
