"""Neighbours in a row."""

from __future__ import annotations

from itertools import tee
from typing import Any, Iterable

from roadgpt_inside import elsewhere


def pairwise(iterable: Iterable[Any]) -> Any:
    """(first, second), (second, third), and so on."""
    ones, others = tee(iterable)
    next(others, None)
    return zip(ones, others)


def __getattr__(name: str) -> Any:
    return elsewhere.other(__name__, name)
