"""Generates any number of descriptions and their plans, discards those that make no sense, and adds typing
errors.
"""

import re
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from itertools import accumulate

import numpy as np

from roadgpt.brief.plan import read_plan
from roadgpt.errors import BriefError, EditError
from roadgpt_training.compositions import composed
from roadgpt_training.grammar import Discarded, Speaker, grammar_of
from roadgpt_training.negative_examples import contradicted, overdone
from roadgpt_training.noise import noisy, tidy
from roadgpt_training.pair import Pair, is_held_out, makes_sense, normal_change, standard
from roadgpt_training.phrasebook import weighted

LONGEST = 500  # letters of a text
SPOILED = 0.045
"""Share of valid descriptions that are made contradictory or impossible on purpose."""
COMPOSED = {"en": 0.6, "de": 0.15, "fr": 0.15, "es": 0.15, "it": 0.15}
"""Share of the pairs that come from ``compositions`` instead of a grammar, by language. In languages
other than English, all compositions are lists of turns. In English, a quarter of the compositions are lists
of turns; their share of the pairs is 0.15 as well.
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


def pairs(seed: int, languages: Mapping[str, float] = SHARES) -> Iterator[Pair]:
    """Yields an endless series of pairs; the same seed gives the same pairs. ``languages`` gives the share of
    each language by its code.
    """
    rng = np.random.default_rng(seed)
    while True:
        code = drawn_language(languages, rng)
        pair = composed(rng, code) if rng.random() < COMPOSED[code] else draw(code, rng)
        if pair:
            yield sometimes_spoiled(pair, rng)


def series(
    seed: int, number: int, drawn: Callable[[str, np.random.Generator], Pair | None]
) -> Iterator[Pair]:
    """Yields an endless series of pairs that ``drawn`` makes, each in a random language. ``number``
    distinguishes the series that have the same seed.
    """
    rng = np.random.default_rng([seed, number])
    while True:
        if pair := drawn(drawn_language(EVEN, rng), rng):
            yield pair


def drawn_language(shares: Mapping[str, float], rng: np.random.Generator) -> str:
    """Returns the code of a random language; ``shares`` gives the share of each language by its code."""
    return list(shares)[weighted(tuple(accumulate(shares.values())), rng)]


def sometimes_spoiled(pair: Pair, rng: np.random.Generator) -> Pair:
    """Returns the pair; in a few percent of the cases, a requirement is added that makes the description
    impossible to satisfy, and the plan becomes a refusal.
    """
    way = rng.random()
    spoil = contradicted if way < SPOILED / 2 else overdone if way < SPOILED else None
    return (spoil(pair, rng) if spoil else None) or pair


def assembled(raw: str) -> str | None:
    """Returns the plan that the grammar rules wrote, in standard form. If the rules wrote a refusal, returns
    only the refusal. Returns None if the plan makes no sense.

    Raises:
        Discarded: as ``road_of`` does.
        BriefError: the plan cannot be read.
    """
    if refusal := REFUSAL.search(raw):
        return refusal[0]
    brief = read_plan(road_of(raw))
    return standard(brief) if makes_sense(brief) else None


def road_of(raw: str) -> str:
    """Returns the plan of a road with its parts in the usual order; grammar rules write them in any order.

    Raises:
        Discarded: a clause of the plan does not name exactly one kind of element, such as "turn".
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


def draw(
    language: str,
    rng: np.random.Generator,
    symbol: str = "top",
    phrases: str = "",
    plan_of: Callable[[str], str | None] = assembled,
    family: str = "generated",
    is_change: bool = False,
) -> Pair | None:
    """Returns a random text for a symbol of a grammar, and the plan that ``plan_of`` makes from what the
    grammar rules wrote. ``phrases`` names the phrases of the grammar (see ``grammar_of``). Returns None if
    the plan makes no sense, or if the text is empty, is held out or has more than 500 characters.
    """
    speaker = Speaker(grammar_of(language, phrases), rng)
    try:
        said, raw = speaker.say(symbol)
        plan = plan_of(raw)
    except (Discarded, BriefError, EditError):
        return None
    if plan is None:
        return None
    text = tidy(said, language)
    typed = noisy(text, language, rng)
    if not 1 <= len(text) <= LONGEST or is_held_out(text) or is_held_out(typed):
        return None
    return Pair(typed, plan, f"{family}-{language}", language, is_change)


def draw_specified(language: str, rng: np.random.Generator) -> Pair | None:
    """Draws a detailed description: several numbers per turn, straights between turns, values that all turns
    share, and heights.
    """
    pair = draw(language, rng, "specs", "specs")
    return sometimes_spoiled(pair, rng) if pair else None


def _changes_of(raw: str) -> str:
    plan = " ".join(raw.split())
    return plan if plan.startswith("!") else normal_change(plan)


draw_change = partial(draw, phrases="changes", plan_of=_changes_of, family="changes", is_change=True)
"""Draws a change request."""
