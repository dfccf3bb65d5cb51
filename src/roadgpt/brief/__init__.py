"""The room of the Brief: words in, what was asked for out.

A reader is a part on the shelf ``readers``: an object, or a class of objects without arguments, with

    read(words: str) -> Brief

It raises BriefError, with one sentence of advice, where the words make no Brief: they are empty, not about
a road, in contradiction with each other or ask for the impossible. It lists the words that it did not
understand in ``Brief.unused``. What the words mean is one table for all readers: ``words.py``.
"""

from typing import Protocol

from roadgpt import plugins
from roadgpt.brief.feasible import check
from roadgpt.brief.model import (
    Amount,
    Brief,
    Clause,
    Kind,
    Sharpness,
    Side,
    Size,
    Slope,
    at_least,
    at_most,
    between,
    exactly,
)
from roadgpt.brief.normal import normal
from roadgpt.brief.outline import Feature, Group, Outline, outline
from roadgpt.brief.sentence import sentence
from roadgpt.brief.words import LEAST_RADIUS, STEEPEST, Range

__all__ = [
    "Amount",
    "Brief",
    "Clause",
    "Feature",
    "Group",
    "Kind",
    "Outline",
    "Range",
    "Reader",
    "Sharpness",
    "Side",
    "Size",
    "Slope",
    "at_least",
    "at_most",
    "between",
    "check",
    "exactly",
    "normal",
    "outline",
    "read",
    "sentence",
]


class Reader(Protocol):
    """A part that reads descriptions."""

    def read(self, words: str) -> Brief:
        """The Brief of a description; BriefError where there is none."""
        ...


def read(
    words: str,
    reader: str = "grammar",
    map_size: float | None = 250.0,
    min_radius: float = LEAST_RADIUS,
    max_grade: float = STEEPEST / 100,
) -> Brief:
    """What a description asks for.

    Args:
        words: up to 2,000 characters.
        reader: name of a part on the shelf ``readers``.
        map_size: metres along one side of the map on which the road shall fit; None: do not ask.
        min_radius: metres, of the tightest turn that the world allows.
        max_grade: ratio, of the steepest slope that it allows.

    Raises:
        BriefError: no road can be read out of the words; says what to change.
        PartError: no such reader.
    """
    part = plugins.find("readers", reader)
    words = words.encode("utf-8", "replace").decode()  # half letters from a broken terminal fit into no file
    brief: Brief = (part() if isinstance(part, type) else part).read(words)
    check(brief, map_size, min_radius, max_grade)
    return brief
