"""Pairs of a description and its plan: their standard form, which plans make sense, and which texts are held
out from training.
"""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from hashlib import sha256

from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.feasible import is_possible
from roadgpt.brief.model import Brief, exactly
from roadgpt.brief.normal import normal, total
from roadgpt.brief.plan import plan
from roadgpt.brief.readers.model.number_words import plain
from roadgpt_training.phrasebook import Thing

MOST_TURNS = 12
HELD_OUT = frozenset((
    "019d204e8d61", "026c044fc007", "17aab1132e8c", "1cda9d23a5ef", "27e89d1e2523", "3633099f7723",
    "4ebf3aa6b12c", "666af6e273b2", "683332d359c9", "71aac9d7e3b7", "7f59b1d31452", "8aa5b9a46d35",
    "8b525e973489", "9886b0cc856d", "9b7cc9230b79", "aadebe82ac34", "ba5318cb6271", "c835218b45e6",
    "db78cec9158e", "dd15d342c028", "e18e6b759f17", "e6b53e71d29f", "ed2be0e5b34d", "f510591305b6",
))  # fmt: skip
"""The development prompts of the project, on which nothing is trained: the first 12 hexadecimal digits of the
SHA-256 hash of each text, in the form that ``is_held_out`` gives it.
"""


@dataclass(frozen=True, slots=True)
class Pair:
    """A description, or a change request, and its plan."""

    text: str
    plan: str
    family: str
    """Name of the source of the pair, such as "generated-en"."""
    lang: str
    """Code of the language, such as "en"."""
    is_change: bool = False
    """True for a change request."""

    @property
    def is_refusal(self) -> bool:
        """True if the plan is a refusal: the text asks for no road that can be built."""
        return self.plan.startswith("!")


def grouped(things: Iterable[Thing], key: Callable[[Thing], str]) -> dict[str, list[Thing]]:
    """Returns the things, such as pairs, of each group, such as a language; ``key`` gives the group."""
    groups: dict[str, list[Thing]] = {}
    for each in things:
        groups.setdefault(key(each), []).append(each)
    return groups


def standard(brief: Brief) -> str:
    """Brings a Brief into normal form and returns its plan."""
    return plan(normal(brief))


def normal_change(plan: str) -> str:
    """Brings a plan of changes into standard form."""
    return change_plan(read_change_plan(plan))


def makes_sense(brief: Brief) -> bool:
    """Returns True if the Brief asks for a road that a map of 250 m can hold, with at most 12 turns.

    A Brief makes no sense if it requires nothing, or if it excludes turns but states their sharpness, angle
    or radius.
    """
    said = normal(brief)
    shapes = said.sharpness or said.degrees or said.radius
    if brief == Brief() or (said.turns == exactly(0) and shapes):
        return False
    turns = max(each.lo or 0 for each in (total(said.clauses), said.turns) if each)
    return turns <= MOST_TURNS and is_possible(brief)


def is_held_out(text: str) -> bool:
    """Returns whether a text is a held-out description, regardless of capitals, accents and punctuation."""
    bare = " ".join(re.findall(r"[^\W_]+", plain(text)))
    return sha256(bare.encode()).hexdigest()[:12] in HELD_OUT
