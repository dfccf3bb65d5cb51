"""Rows for parametrised tests whose neighbours in a full grid could not fail alone."""

from collections.abc import Sequence
from typing import Any


def pairs(one: Sequence[Any], other: Sequence[Any], *more: Sequence[Any]) -> list[tuple[Any, ...]]:
    """Each value of the first with each of the second; those of all others take turns, so that each of them
    meets each of the first two as well where there are enough rows."""
    return [
        (a, b, *(values[(i + j) % len(values)] for values in more))
        for i, a in enumerate(one)
        for j, b in enumerate(other)
    ]


def diagonal(*axes: Sequence[Any], rows: int = 0) -> list[tuple[Any, ...]]:
    """Each value at least once; those of shorter axes take turns."""
    return [tuple(values[n % len(values)] for values in axes) for n in range(rows or max(map(len, axes)))]
