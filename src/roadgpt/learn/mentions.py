"""Adds phrases to descriptions: things that plans list in ``beside(...)`` ("in the rain"), denials of such
things ("no traffic"), and small talk. Denials and small talk do not change the plan.
"""

import json
import re
from collections.abc import Mapping, Sequence
from importlib.resources import files

import numpy as np

from roadgpt.brief.plan import ALIKE, read_plan
from roadgpt.brief.plan import plan as plan_of
from roadgpt.brief.readers.model.mirror import is_of_junctions
from roadgpt.brief.readers.model.route_words import TOLD_ON_ROUTES
from roadgpt.learn.noise import tidy

Phrases = Mapping[str, Mapping[str, Mapping[str, Sequence[str]]]]
WORDS = json.loads((files("roadgpt.learn") / "words" / "beside.json").read_text(encoding="utf-8"))
SAID: Phrases = WORDS["said"]
"""Phrases that can stand "before" or "after" a description, by language and then by the names that plans list
for them."""
DENIED: Phrases = WORDS["denied"]
DENIED_ON_ROUTES: Phrases = {
    language: {names: ways for names, ways in its.items() if TOLD_ON_ROUTES.isdisjoint(names.split(", "))}
    for language, its in DENIED.items()
}
"""The phrases of ``DENIED`` that do not deny what a route consists of."""
TALK: Mapping[str, Mapping[str, Sequence[str]]] = json.loads(
    (files("roadgpt.learn") / "words" / "talk.json").read_text(encoding="utf-8")
)
"""Greetings, reasons and the like that can stand "before" or "after" a text, by language."""
NAMED = re.compile(r" ?beside\(([^()]*)\)")
MOST_NAMES = 4
BEFORE = 0.25
NUMBERS = {"lanes": (2, 6), "lane_width": (2, 5), "speed": (20, 120)}
"""The range of the number in a phrase for each of these names; for all other names it is 2 to 9."""


def with_mention(text: str, plan: str, language: str, rng: np.random.Generator) -> tuple[str, str] | None:
    """Returns the text and plan with a mention ("in the rain") or a denial ("no traffic") added.

    Returns None if the plan is a refusal, already lists what would be mentioned or denied, or would list too
    many names, or if there are no phrases in the language.
    """
    is_said = rng.random() < 0.7
    denied = DENIED_ON_ROUTES if is_of_junctions(plan) else DENIED
    table = (SAID if is_said else denied).get(language)
    if plan.startswith("!") or not table:
        return None
    names = list(table)[int(rng.integers(len(table)))]
    there = names_in(plan)
    new = [name.strip() for name in names.split(",")]
    if {*there} & {*new} or len(there) + len(new) > MOST_NAMES:
        return None
    is_before = rng.random() < BEFORE and bool(table[names]["before"])
    ways = table[names]["before" if is_before else "after"]
    phrase = _numbered(ways[int(rng.integers(len(ways)))], new[0], rng)
    told = _before(phrase, text, language) if is_before else _after(text, phrase, language, rng)
    if not is_said:
        return told, plan
    return told, with_names(plan, [*new, *there] if is_before else [*there, *new])


def with_talk(text: str, language: str, rng: np.random.Generator) -> str:
    """Returns the text with small talk, such as a greeting or a reason, before it, after it, or both."""
    told = TALK.get(language, TALK["en"])
    way = rng.random()
    if way < 2 / 3:
        before = told["before"][int(rng.integers(len(told["before"])))]
        text = _before(before, text, language)
    if way > 1 / 3:
        after = told["after"][int(rng.integers(len(told["after"])))]
        text = f"{text if text[-1:] in '.!?' else f'{text}.'} {after}"
    return text


def names_in(plan: str) -> list[str]:
    """Returns the names that a plan lists in ``beside(...)``, and "alike" if it has this flag."""
    found = NAMED.search(plan)
    flags = [ALIKE] if ALIKE in NAMED.sub("", plan).split() else []
    return [*([name.strip() for name in found[1].split(",")] if found else []), *flags]


def with_names(plan: str, names: Sequence[str]) -> str:
    """Returns the plan with these names in ``beside(...)``, which replace the names that were there.

    On a single road, "alike" becomes the flag of that name.
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


def _before(phrase: str, text: str, language: str) -> str:
    is_open = phrase.rstrip()[-1:] in ",:"
    return tidy(f"{phrase} {text if is_open else text[:1].upper() + text[1:]}", language)


def _after(text: str, phrase: str, language: str, rng: np.random.Generator) -> str:
    is_sentence = phrase[:1].isupper() and phrase.endswith(".")
    if is_sentence:
        return tidy(f"{text.rstrip(' .')}. {phrase}", language)
    stop = "." if text.endswith(".") else ""
    return tidy(f"{text.rstrip(' .')}{', ' if rng.random() < 0.5 else ' '}{phrase}", language) + stop
