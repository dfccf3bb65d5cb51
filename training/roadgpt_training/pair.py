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
    "019d204e8d61", "026c044fc007", "0505f6af207d", "05e1dd836324", "0b4c566e1598", "10a9ac3dd8d0",
    "14d5c8b27538", "14d658a51002", "160198ae5ca9", "1609e55772c5", "17aab1132e8c", "19e7f05b1585",
    "1cda9d23a5ef", "1d9fe96a58c0", "1ed1d033e7e0", "2049ec0770ea", "2332bed03499", "239ad59674a0",
    "2459887ad36e", "251e2a8f883d", "26fa1fc80574", "270c715ed85f", "27b4e9c2c302", "27dfa7a4c92b",
    "27e89d1e2523", "2877db9d59af", "28f263cebcc7", "2ca0f13d4d2d", "31afe8370df4", "3311bc146cda",
    "33a88e434ed5", "34e47e6fa326", "34fa78433c8e", "3594b9de1ac6", "3633099f7723", "3694562951cb",
    "384cd85da886", "3af1f4759d33", "4029441ad55f", "404d420ae39c", "427b527b771a", "45c87906c1f9",
    "475689f06e0e", "483b3dc67657", "4938c5aacf9a", "49dcc13ccfe5", "4df2f8705123", "4e9ee64d6982",
    "4ebf3aa6b12c", "4ef8a0a43b53", "51093fa701df", "52294f1072b9", "553b792daa62", "56191c81799a",
    "5a5143c4700a", "60a4f859fad2", "6219e1e95597", "62af4f3ac0f6", "666af6e273b2", "6744be957cad",
    "6814b72f8e22", "683332d359c9", "6cf105c8130a", "71aac9d7e3b7", "7304389e4311", "744b753e5307",
    "7458434b1556", "7593d0c100af", "7595cbc19004", "78972ca9a6f9", "7e0b41813bf4", "7eab13342f7b",
    "7f59b1d31452", "7fc048de77bf", "8028f90eee60", "825c50ec878a", "84acd3ed4332", "85b2817b71b6",
    "87b47907e873", "8852b0e065a0", "8a29cf9842af", "8aa5b9a46d35", "8ae0f1cbc7a0", "8b525e973489",
    "8bb6e8a2d2f5", "8ecef58c7e67", "955891d3ccee", "963cdb2d995b", "98148b447a7a", "9886b0cc856d",
    "996a44dc71bc", "9a778dc2c9e7", "9b7cc9230b79", "9cdcd1ddf8e6", "9d04d703fa89", "9ff622fc4c1e",
    "a02acbf0ec74", "a36154d7abb2", "a536c48d191a", "a6968fa9dd29", "aaa3473cda9a", "aadebe82ac34",
    "aba295fabb87", "accc07d8d3d6", "ae7587b6565b", "aeeb306ad615", "b1da5ba3541f", "b3073418746b",
    "b425f7b5dc77", "b4a0e1def6c6", "b6b5356dfa04", "b79af8156c34", "b86c81a3b903", "b8a56cb7937b",
    "b91743e1777a", "b9a08d39b15c", "ba5318cb6271", "bd13e78fcf5a", "c01bfe869d73", "c29b7a7ff2d0",
    "c3f760591d0e", "c4cf51b3909b", "c4d03983bf93", "c6836c65930c", "c73fc5974be3", "c7c570fd5988",
    "c7cf21dddac5", "c835218b45e6", "c943e89fe2b8", "cb346eba2928", "d2ab1df52c0b", "d3aab5b818ed",
    "d914637a8317", "dab185236ecd", "db78cec9158e", "dd15d342c028", "e18e6b759f17", "e4218c495c1a",
    "e508bb1330f4", "e63a8c9e1c0d", "e6844046d611", "e6b4eaac3dc2", "e6b53e71d29f", "e760edd314dc",
    "eae0b05845b2", "ecc92f4d865f", "ed2be0e5b34d", "ee67c880574f", "efc8e32de429", "f0bf3aea456c",
    "f102dab99c4b", "f105fad6d3c4", "f2c2a9229a1f", "f510591305b6", "f716955cddb2", "f843290abe2d",
    "fcdb998d4b4b", "fd3cd6666b05", "fdba58abb241",
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
