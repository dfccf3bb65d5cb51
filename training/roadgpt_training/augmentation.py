"""Varies hand-written pairs of description and plan: swaps left and right, changes a number, joins two
pairs, or adds a requirement.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.number_words import plain
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.errors import BriefError
from roadgpt_training.generator import assembled, sometimes_spoiled
from roadgpt_training.grammar import Discarded, Speaker, grammar_of
from roadgpt_training.mirror import is_of_junctions, mirrored
from roadgpt_training.noise import noisy, tidy
from roadgpt_training.pair import Pair, makes_sense, standard
from roadgpt_training.phrasebook import one_of
from roadgpt_training.spelling import spell

LANGUAGES = frozenset({"en", "de", "fr", "es", "it"})
JOINTS = {
    "en": (". ", "; ", ", and ", ", then ", "\n", ". Also, "),
    "de": (". ", "; ", ", und ", ", dann ", "\n"),
    "fr": (". ", "; ", ", et ", ", puis ", "\n"),
    "es": (". ", "; ", ", y ", ", luego ", "\n"),
    "it": (". ", "; ", ", e ", ", poi ", "\n"),
}
"""Texts that join two change requests, by language."""
COUNT = re.compile(r"(?:\bx|turns=)(\d+)(?![\d.])")
LONGEST = 420  # letters of a joined text


def augmented(pair: Pair, others: Mapping[str, Sequence[Pair]], rng: np.random.Generator) -> Pair:
    """Returns a hand-written pair, in most cases with random variations. ``others`` are hand-written pairs by
    language; a random pair from ``others`` in the same language may be joined to the pair.
    """
    if rng.random() < 0.5 and (seen := mirrored(pair.text, pair.plan)):
        pair = replace(pair, text=seen[0], plan=seen[1])
    same_language = others.get(pair.lang)
    other = one_of(same_language, rng) if same_language else None
    if is_of_junctions(pair.plan):
        if rng.random() < 0.4:
            pair = recounted(pair, rng) or pair
    elif pair.is_change:
        if other and rng.random() < 0.2:
            pair = both_changes(pair, other, rng) or pair
    else:
        pair = _description(pair, other, rng)
    if rng.random() < 0.35:
        language = pair.lang if pair.lang in LANGUAGES else "en"
        pair = replace(pair, text=noisy(pair.text, language, rng))
    return pair


def _description(pair: Pair, other: Pair | None, rng: np.random.Generator) -> Pair:
    if rng.random() < 0.4:
        pair = recounted(pair, rng) or pair
    way = rng.random()
    if way < 0.18 and other:
        pair = joined(pair, other, rng) or pair
    elif way < 0.28:
        pair = with_requirement(pair, rng) or pair
    return sometimes_spoiled(pair, rng)


def both_changes(one: Pair, other: Pair, rng: np.random.Generator) -> Pair | None:
    """Returns one pair that joins two change requests; None if a plan is a refusal, or if the joined text
    would be too long.
    """
    if one.is_refusal or other.is_refusal or len(one.text + other.text) > LONGEST:
        return None
    joint = one_of(JOINTS.get(one.lang, JOINTS["en"]), rng)
    second = other.text if joint.endswith((". ", "\n")) else f"{other.text[:1].lower()}{other.text[1:]}"
    text = f"{one.text.rstrip(' .!')}{joint}{second}"
    return replace(one, text=text, plan=f"{one.plan}; {other.plan}")


def recounted(pair: Pair, rng: np.random.Generator) -> Pair | None:
    """Returns the pair with a new, random count of turns, 2 to 9. Returns None if the plan
    has no count from 2 to 10, has several counts, or has the same number elsewhere. Also returns None if the
    count is not the only number in the text, or occurs there twice.
    """
    counts = COUNT.findall(pair.plan)
    if len(counts) != 1 or not 2 <= int(counts[0]) <= 10:
        return None
    (count,) = counts
    if len(re.findall(rf"(?<![\d.]){count}\b", pair.plan)) != 1:
        return None
    numbers = [word for word in slotted(pair.text).words if word.text.isdigit()]
    if [word.text for word in numbers] != [count] or pair.text.count(numbers[0].written) != 1:
        return None
    new, word = int(rng.integers(2, 10)), numbers[0].written
    language = pair.lang if pair.lang in LANGUAGES else "en"
    if not word.isdigit() and plain(word) != plain(spell(int(count), language)):
        return None
    text = pair.text.replace(word, str(new) if word.isdigit() else spell(new, pair.lang))
    plan = COUNT.sub(lambda found: found[0].replace(count, str(new)), pair.plan)
    return replace(pair, text=text, plan=plan)


def joined(one: Pair, other: Pair, rng: np.random.Generator) -> Pair | None:
    """Returns a pair that joins the roads of two pairs into one road. Neither pair may be a refusal, or
    have junctions or requirements for the whole road. Returns None for such a pair, for a language without
    phrases, for texts that are too long together, and for a joined road that makes no sense.
    """
    if one.lang not in LANGUAGES:
        return None
    if any("|" in pair.plan or pair.is_refusal or is_of_junctions(pair.plan) for pair in (one, other)):
        return None
    if len(one.text) + len(other.text) > LONGEST:
        return None
    try:
        link, _ = Speaker(grammar_of(one.lang), rng).say("link")
        brief = read_plan(f"{one.plan}; {other.plan}")
    except (BriefError, Discarded, KeyError):
        return None
    if not makes_sense(brief):
        return None
    first, second = one.text.rstrip(" .!"), other.text
    if second[:1].isupper() and not second[1:2].isupper() and one.lang != "de":
        second = second[:1].lower() + second[1:]
    return replace(one, text=tidy(f"{first} {link} {second}", one.lang), plan=standard(brief))


def with_requirement(pair: Pair, rng: np.random.Generator) -> Pair | None:
    """Returns the pair with one more requirement for the whole road; None if none can be added."""
    if "|" in pair.plan or pair.is_refusal or pair.lang not in LANGUAGES:
        return None
    try:
        tail, wish = Speaker(grammar_of(pair.lang), rng).say("tailwish")
        plan = assembled(f"{pair.plan} {wish}")
    except (BriefError, Discarded):
        return None
    text = tidy(f"{pair.text.rstrip(' .!')} {tail}", pair.lang)
    return replace(pair, text=text, plan=plan) if plan else None
