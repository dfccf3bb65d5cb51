"""Reads the phrases in the folder ``words``, and chooses among things at random."""

import json
from bisect import bisect
from collections.abc import Sequence
from importlib.resources import files
from typing import Any, TypeVar

import numpy as np

Thing = TypeVar("Thing")


def phrases_of(name: str) -> Any:
    """Returns the content of ``words/NAME.json``."""
    return json.loads((files("roadgpt_training") / "words" / f"{name}.json").read_text(encoding="utf-8"))


def one_of(things: Sequence[Thing], rng: np.random.Generator) -> Thing:
    """Returns one of the things; each is equally likely."""
    return things[int(rng.integers(len(things)))]


def weighted(sums: Sequence[float], rng: np.random.Generator) -> int:
    """Returns a random index; ``sums`` are the cumulative weights of the indices."""
    return bisect(sums, rng.random() * sums[-1])
