"""Iterates over pairs of neighbouring elements."""

from __future__ import annotations

from itertools import tee
from typing import Any, Iterable


def pairwise(iterable: Iterable[Any]) -> Any:
    """Returns an iterator over (first, second), (second, third), and so on."""
    ones, others = tee(iterable)
    next(others, None)
    return zip(ones, others)
