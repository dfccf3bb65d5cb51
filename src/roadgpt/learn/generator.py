"""Generates any number of descriptions and their plans, discards those that make no sense, and adds typing
errors.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.plan import read_plan
from roadgpt.errors import BriefError, EditError
from roadgpt.learn.compositions import composed
from roadgpt.learn.grammar import Discarded, Speaker, grammar_of
from roadgpt.learn.held_out import is_held_out
from roadgpt.learn.negative_examples import contradicted, overdone
from roadgpt.learn.noise import noisy, tidy
from roadgpt.learn.standard import makes_sense, standard

SPOILED = 0.045
"""Share of valid descriptions that are made contradictory or impossible on purpose."""
COMPOSED = {"en": 0.6, "de": 0.15, "fr": 0.15, "es": 0.15, "it": 0.15}
"""Share of the pairs that come from ``compositions`` instead of a grammar, by language. Other languages than
English only have lists of turns there. A quarter of the English compositions are such lists: 0.15 as well.
"""
SHARES = {"en": 0.62, "de": 0.10, "fr": 0.10, "es": 0.09, "it": 0.09}
EVEN = {"en": 0.44, "de": 0.14, "fr": 0.14, "es": 0.14, "it": 0.14}
"""Shares of the languages in pairs that are hard to read in every language: contrasts, detailed descriptions
and changes."""
WISH = re.compile(r"\|\s*(?:(?:starts|ends|beside)\([^()]*\)|[^\s;|]+)")
REFUSAL = re.compile(r"![a-z]+(?: +[a-z_]+)*")
KIND = re.compile(
    r"straight|crest|dip|turn|hairpin|switchback|u_turn|s_bend|chicane|slalom|serpentine|zigzag|winding"
)


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


def pairs(seed: int, languages: dict[str, float] | None = None) -> Iterator[Pair]:
    """Yields an endless series of pairs; the same seed gives the same pairs. ``languages`` gives the share of
    each language by its code; the default is ``SHARES``.
    """
    rng = np.random.default_rng(seed)
    while True:
        code = drawn_language(languages or SHARES, rng)
        pair = _composed(code, rng) if rng.random() < COMPOSED[code] else draw(code, rng)
        if pair:
            yield sometimes_spoiled(pair, rng)


def contrasted(seed: int) -> Iterator[Pair]:
    """Yields an endless series of descriptions that deny, exchange, limit or compare something."""
    rng = np.random.default_rng([seed, 1])
    while True:
        pair = draw(drawn_language(EVEN, rng), rng, "contrast", "contrasts")
        if pair:
            yield pair


def specified(seed: int) -> Iterator[Pair]:
    """Yields an endless series of detailed descriptions: several numbers per turn, straights between turns,
    values that all turns share, and heights."""
    rng = np.random.default_rng([seed, 3])
    while True:
        pair = draw(drawn_language(EVEN, rng), rng, "specs", "specs")
        if pair:
            yield sometimes_spoiled(pair, rng)


def changed(seed: int) -> Iterator[Pair]:
    """Yields an endless series of change requests."""
    rng = np.random.default_rng([seed, 2])
    while True:
        pair = draw_change(drawn_language(EVEN, rng), rng)
        if pair:
            yield pair


def drawn_language(shares: dict[str, float], rng: np.random.Generator) -> str:
    """Returns the code of a random language; ``shares`` gives the share of each language by its code."""
    codes, weights = list(shares), np.cumsum(list(shares.values()))
    return codes[int(np.searchsorted(weights, rng.random() * weights[-1], side="right"))]


def sometimes_spoiled(pair: Pair, rng: np.random.Generator) -> Pair:
    """Returns the pair; in a few percent of the cases, a requirement is added that makes the description
    impossible to satisfy, and the plan becomes a refusal.
    """
    way = rng.random()
    spoil = contradicted if way < SPOILED / 2 else overdone if way < SPOILED else None
    found = spoil(pair.text, pair.plan, pair.lang, rng) if spoil else None
    return Pair(*found, pair.family, pair.lang) if found else pair


def draw(language: str, rng: np.random.Generator, symbol: str = "top", phrases: str = "") -> Pair | None:
    """Returns a random description and its plan, made with a grammar; None if they make no sense, or if the
    description is held out or has more than 500 characters.

    Args:
        language: code of the language, such as "en".
        rng: source of randomness.
        symbol: the symbol of the grammar to begin with.
        phrases: name of further phrases for the grammar, such as "contrasts".
    """
    try:
        text, raw = Speaker(grammar_of(language, phrases), rng).say(symbol)
        plan = assembled(raw)
    except (Discarded, BriefError):
        return None
    if plan is None or not 1 <= len(text) <= 500:
        return None
    text = tidy(text, language)
    typed = noisy(text, language, rng)
    if is_held_out(text) or is_held_out(typed):
        return None
    return Pair(typed, plan, f"generated-{language}", language)


def draw_change(language: str, rng: np.random.Generator) -> Pair | None:
    """Returns a random change request and its plan; None if they do not fit together, or if the request has
    more than 500 characters."""
    try:
        text, raw = Speaker(grammar_of(language, "changes"), rng).say("top")
        plan = " ".join(raw.split())
        if not plan.startswith("!"):
            plan = change_plan(read_change_plan(plan))
    except (Discarded, EditError):
        return None
    text = noisy(tidy(text, language), language, rng)
    return Pair(text, plan, f"changes-{language}", language, True) if 1 <= len(text) <= 500 else None


def _composed(language: str, rng: np.random.Generator) -> Pair | None:
    said = composed(rng, language)
    if said is None or is_held_out(said.text):
        return None
    return Pair(said.text, said.plan, f"composed-{language}", language)


def assembled(raw: str) -> str | None:
    """Returns the standard form of the plan that the grammar rules wrote; None if the plan makes no sense.

    If the plan contains a refusal, only the refusal is returned.

    Raises:
        Discarded: a clause of the plan names no kind of element, such as "turn" or "straight", or several.
        BriefError: the plan cannot be read.
    """
    refusal = REFUSAL.search(raw)
    if refusal:
        return refusal[0]
    brief = read_plan(road_of(raw))
    return standard(brief) if makes_sense(brief) else None


def road_of(raw: str) -> str:
    """Returns the plan of a road with its parts in the usual order; grammar rules write them in any order.

    Raises:
        Discarded: a clause of the plan names no kind of element, such as "turn" or "straight", or several.
    """
    wishes = [wish.lstrip("| ").replace("straight_", "straight ") for wish in WISH.findall(raw)]
    clauses = [_kind_first(part) for part in WISH.sub(" ", raw).split(";")]
    line = "; ".join(part for part in clauses if part)
    wishes = [_placed(wish) for wish in dict.fromkeys(wishes)]
    if line and "turns=1.." in wishes:
        wishes.remove("turns=1..")
    return f"{line} | {' '.join(wishes)}" if wishes else line


def _placed(wish: str) -> str:
    place = re.fullmatch(r"(starts|ends)\((.*)\)", wish)
    return f"{place[1]}({_kind_first(place[2])})" if place else wish


def _kind_first(clause: str) -> str:
    """Returns a clause with its kind of element in front, without empty modifiers such as 'len='."""
    words = [word for word in clause.split() if not word.endswith("=")]
    kinds = [word for word in words if KIND.fullmatch(word)]
    if not words:
        return ""
    if len(kinds) != 1:
        raise Discarded
    return " ".join([kinds[0], *(word for word in dict.fromkeys(words) if word != kinds[0])])
