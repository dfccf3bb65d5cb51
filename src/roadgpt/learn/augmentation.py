"""Varies hand-written pairs of description and plan: swaps left and right, changes a number, joins two
pairs, or adds a requirement.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.mirror import is_of_junctions, mirrored
from roadgpt.brief.readers.model.numerals import plain, spell
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.errors import BriefError
from roadgpt.learn.generator import Pair, assembled, sometimes_spoiled
from roadgpt.learn.grammar import Discarded, Speaker, grammar_of
from roadgpt.learn.noise import noisy, tidy
from roadgpt.learn.standard import makes_sense, standard

LANGUAGES = frozenset({"en", "de", "fr", "es", "it"})
JOINTS = {
    "en": (". ", "; ", ", and ", ", then ", "\n", ". Also, "),
    "de": (". ", "; ", ", und ", ", dann ", "\n"),
    "fr": (". ", "; ", ", et ", ", puis ", "\n"),
    "es": (". ", "; ", ", y ", ", luego ", "\n"),
    "it": (". ", "; ", ", e ", ", poi ", "\n"),
}
"""Texts that join two change requests, by language."""
LONGEST = 420  # letters of a joined text


def augmented(pair: Pair, others: Mapping[str, Sequence[Pair]], rng: np.random.Generator) -> Pair:
    """Returns a hand-written pair, in most cases with random variations.

    Args:
        pair: the pair of a description and its plan.
        others: hand-written pairs, grouped by language; one of them may be joined to ``pair``.
        rng: source of randomness.
    """
    if rng.random() < 0.5:
        pair = _made(pair, mirrored(pair.text, pair.plan))
    other = _one_of(others.get(pair.lang, ()), rng)
    if is_of_junctions(pair.plan):
        pair = _made(pair, recounted(pair, rng)) if rng.random() < 0.4 else pair
    elif pair.is_change:
        pair = _made(pair, both_changes(pair, other, rng)) if other and rng.random() < 0.2 else pair
    else:
        pair = _description(pair, other, rng)
    if rng.random() < 0.35:
        language = pair.lang if pair.lang in LANGUAGES else "en"
        pair = _made(pair, (noisy(pair.text, language, rng), pair.plan))
    return pair


def _description(pair: Pair, other: Pair | None, rng: np.random.Generator) -> Pair:
    if rng.random() < 0.4:
        pair = _made(pair, recounted(pair, rng))
    way = rng.random()
    if way < 0.18 and other:
        pair = _made(pair, joined(pair, other, rng))
    elif way < 0.28:
        pair = _made(pair, with_requirement(pair, rng))
    return sometimes_spoiled(pair, rng)


def both_changes(one: Pair, other: Pair, rng: np.random.Generator) -> tuple[str, str] | None:
    """Returns one text and one plan that join two change requests; None if a plan is a refusal, or if the
    joined text would be too long.
    """
    if any(pair.plan.startswith("!") for pair in (one, other)) or len(one.text + other.text) > LONGEST:
        return None
    joints = JOINTS[one.lang if one.lang in JOINTS else "en"]
    joint = joints[int(rng.integers(len(joints)))]
    second = other.text if joint.endswith((". ", "\n")) else f"{other.text[:1].lower()}{other.text[1:]}"
    return f"{one.text.rstrip(' .!')}{joint}{second}", f"{one.plan}; {other.plan}"


def _one_of(pairs: Sequence[Pair], rng: np.random.Generator) -> Pair | None:
    return pairs[int(rng.integers(len(pairs)))] if pairs else None


def _made(pair: Pair, new: tuple[str, str] | None) -> Pair:
    return replace(pair, text=new[0], plan=new[1]) if new else pair


def recounted(pair: Pair, rng: np.random.Generator) -> tuple[str, str] | None:
    """Returns the text and plan with a new, random count of turns, 2 to 9. Returns None unless the original
    count, 2 to 10, occurs exactly once in the text and once in the plan.
    """
    counts = re.findall(r"(?:\bx|turns=)(\d+)(?![\d.])", pair.plan)
    if (
        len(counts) != 1
        or not 2 <= int(counts[0]) <= 10
        or len(re.findall(rf"(?<![\d.]){counts[0]}\b", pair.plan)) != 1
    ):
        return None
    said = [word for word in slotted(pair.text).words if word.text == counts[0]]
    numbers = [word for word in slotted(pair.text).words if word.text.isdigit()]
    if len(said) != 1 or len(numbers) != 1 or pair.text.count(said[0].written) != 1:
        return None
    new = int(rng.integers(2, 10))
    word = said[0].written
    if not (
        word.isdigit()
        or plain(word) == plain(spell(int(counts[0]), pair.lang if pair.lang in LANGUAGES else "en"))
    ):
        return None
    text = pair.text.replace(word, str(new) if word.isdigit() else spell(new, pair.lang))
    plan = re.sub(rf"((?:\bx|turns=)){counts[0]}(?![\d.])", rf"\g<1>{new}", pair.plan)
    return text, plan


def joined(one: Pair, other: Pair, rng: np.random.Generator) -> tuple[str, str] | None:
    """Returns a text and plan that join the roads of two pairs into one road; None if the pairs cannot be
    joined.

    Pairs with refusals, with requirements for the whole road or with junctions cannot be joined.
    """
    if any(
        "|" in pair.plan or pair.plan.startswith("!") or is_of_junctions(pair.plan) for pair in (one, other)
    ):
        return None
    if len(one.text) + len(other.text) > LONGEST:
        return None
    try:
        link, _ = Speaker(grammar_of(one.lang), rng).say("link")
        brief = read_plan(f"{one.plan}; {other.plan}")
    except (BriefError, Discarded, KeyError, ModuleNotFoundError):
        return None
    if not makes_sense(brief):
        return None
    first, second = one.text.rstrip(" .!"), other.text
    if second[:1].isupper() and not second[1:2].isupper() and one.lang != "de":
        second = second[:1].lower() + second[1:]
    return tidy(f"{first} {link} {second}", one.lang), standard(brief)


def with_requirement(pair: Pair, rng: np.random.Generator) -> tuple[str, str] | None:
    """Returns the text and plan with one more requirement for the whole road; None if none can be added."""
    if "|" in pair.plan or pair.plan.startswith("!") or pair.lang not in LANGUAGES:
        return None
    try:
        tail, wish = Speaker(grammar_of(pair.lang), rng).say("tailwish")
        plan = assembled(f"{pair.plan} {wish}")
    except (BriefError, Discarded):
        return None
    return (tidy(f"{pair.text.rstrip(' .!')} {tail}", pair.lang), plan) if plan else None
