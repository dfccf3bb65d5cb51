"""Adds phrases to descriptions: things that plans list in ``beside(...)`` ("in the rain"), denials of such
things ("no traffic"), and small talk. Denials and small talk do not change the plan.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from roadgpt.brief.plan import ALIKE, read_plan
from roadgpt.brief.plan import plan as plan_of
from roadgpt.brief.readers.model.before import TOLD_ON_ROUTES
from roadgpt_training.mirror import is_of_junctions
from roadgpt_training.noise import tidy
from roadgpt_training.pair import Pair
from roadgpt_training.phrasebook import one_of, phrases_of

Phrases = Mapping[str, Mapping[str, Mapping[str, Sequence[str]]]]
WORDS = phrases_of("beside")
SAID: Phrases = WORDS["said"]
"""Phrases that can stand "before" or "after" a description, by language and then by the names that plans list
for them."""
DENIED: Phrases = WORDS["denied"]
DENIED_ON_ROUTES: Phrases = {
    language: {names: ways for names, ways in its.items() if TOLD_ON_ROUTES.isdisjoint(names.split(", "))}
    for language, its in DENIED.items()
}
"""The phrases of ``DENIED`` for routes: without those that deny a part of a route, such as a junction."""
TALK: Mapping[str, Mapping[str, Sequence[str]]] = phrases_of("talk")
"""Greetings, reasons and the like that can stand "before" or "after" a text, by language."""
NAMED = re.compile(r" ?beside\(([^()]*)\)")
MOST_NAMES = 4
BEFORE = 0.25
NUMBERS = {"lanes": (2, 6), "lane_width": (2, 5), "speed": (20, 120)}
"""The range of the number in a phrase for each of these names; for all other names it is 2 to 9."""


def with_mention(pair: Pair, rng: np.random.Generator) -> Pair | None:
    """Returns the pair with a mention ("in the rain") or a denial ("no traffic") added. Returns None for a
    refusal, for a language without phrases, and for a plan that already lists the thing mentioned or denied,
    or would list too many names.
    """
    is_said = rng.random() < 0.7
    denied = DENIED_ON_ROUTES if is_of_junctions(pair.plan) else DENIED
    table = (SAID if is_said else denied).get(pair.lang)
    if pair.is_refusal or not table:
        return None
    names = one_of(list(table), rng)
    there = names_in(pair.plan)
    new = [name.strip() for name in names.split(",")]
    if {*there} & {*new} or len(there) + len(new) > MOST_NAMES:
        return None
    is_before = rng.random() < BEFORE and bool(table[names]["before"])
    phrase = _numbered(one_of(table[names]["before" if is_before else "after"], rng), new[0], rng)
    text = preceded(phrase, pair.text, pair.lang) if is_before else _after(pair, phrase, rng)
    if not is_said:
        return replace(pair, text=text)
    plan = with_names(pair.plan, [*new, *there] if is_before else [*there, *new])
    return replace(pair, text=text, plan=plan)


def with_talk(text: str, language: str, rng: np.random.Generator) -> str:
    """Returns the text with small talk, such as a greeting or a reason, before it, after it, or both."""
    told = TALK.get(language, TALK["en"])
    way = rng.random()
    if way < 2 / 3:
        text = preceded(one_of(told["before"], rng), text, language)
    if way > 1 / 3:
        text = followed(text, one_of(told["after"], rng))
    return text


def names_in(plan: str) -> list[str]:
    """Returns the names that a plan lists in ``beside(...)``, and "alike" if it has this flag."""
    found = NAMED.search(plan)
    flags = [ALIKE] if ALIKE in NAMED.sub("", plan).split() else []
    return [*([name.strip() for name in found[1].split(",")] if found else []), *flags]


def with_names(plan: str, names: Sequence[str]) -> str:
    """Returns the plan with these names in ``beside(...)`` instead of those that were there. In the plan
    of a single road, the name "alike" becomes the flag "alike".
    """
    bare = re.sub(rf" ?\b{ALIKE}\b", "", NAMED.sub("", plan)).rstrip(" |")
    whole = "||" if is_of_junctions(plan) else "|"
    joint = " " if whole in bare else f" {whole} "
    line = f"{bare}{joint}beside({', '.join(names)})".strip()
    return plan_of(read_plan(line)) if ALIKE in names and whole == "|" else line


def _numbered(phrase: str, name: str, rng: np.random.Generator) -> str:
    low, high = NUMBERS.get(name, (2, 9))
    number = int(rng.integers(low, high + 1))
    return phrase.replace("{n}", str(number // 10 * 10 if name == "speed" else number))


def preceded(phrase: str, text: str, language: str) -> str:
    """Returns the text with a phrase before it."""
    is_open = phrase.rstrip()[-1:] in ",:"
    return tidy(f"{phrase} {text if is_open else text[:1].upper() + text[1:]}", language)


def followed(text: str, phrase: str) -> str:
    """Returns the text with a phrase after it; one that begins with a comma goes on with the sentence."""
    if phrase.startswith(","):
        return f"{text.rstrip(' .!?')}{phrase}"
    return f"{text if text[-1:] in '.!?' else f'{text}.'} {phrase}"


def _after(pair: Pair, phrase: str, rng: np.random.Generator) -> str:
    body = pair.text.rstrip(" .")
    if phrase[:1].isupper() and phrase.endswith("."):
        return tidy(f"{body}. {phrase}", pair.lang)
    stop = "." if pair.text.endswith(".") else ""
    return tidy(f"{body}{', ' if rng.random() < 0.5 else ' '}{phrase}", pair.lang) + stop
