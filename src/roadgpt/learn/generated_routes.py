"""Generates descriptions of routes with junctions and of maps, with their plans, from grammars.

The grammars ``networks_*.txt`` use the symbols of the grammars for roads. In the plan of a rule, ``//``
separates roads and junctions. Three kinds of requirements may occur anywhere: ``|flat`` applies to the road
between two ``//``, ``@flat`` to every road of the route, and ``||left_hand`` to the route as a whole.
"""

import re
from collections.abc import Iterator

import numpy as np

from roadgpt.brief.feasible import check
from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model.mirror import is_of_junctions
from roadgpt.errors import RoadGPTError
from roadgpt.learn.generator import EVEN, REFUSAL, Pair, drawn_language, road_of
from roadgpt.learn.grammar import Discarded, Speaker, grammar_of
from roadgpt.learn.held_out import is_held_out
from roadgpt.learn.noise import noisy, tidy
from roadgpt.learn.standard import standard

OF_ALL = re.compile(r"\|\|\s*(beside\([^()]*\)|[^\s;|]+)")
OF_EVERY_ROAD = re.compile(r"@([^\s;|@]+)")
LONGEST = 500  # letters of a description
MOST_JUNCTIONS = 6


def generated_routes(seed: int) -> Iterator[Pair]:
    """Yields an endless series of routes and maps; the same seed gives the same pairs."""
    rng = np.random.default_rng([seed, 6])
    while True:
        if pair := draw_route(drawn_language(EVEN, rng), rng):
            yield pair


def draw_route(language: str, rng: np.random.Generator, symbol: str = "networks") -> Pair | None:
    """Returns a random description of a route or map and its plan; None if they make no sense, or if the
    description is too long or held out.

    Args:
        language: code of the language, such as "en".
        rng: source of randomness.
        symbol: the symbol of the grammar to begin with.
    """
    try:
        said, raw = Speaker(grammar_of(language, "networks"), rng).say(symbol)
        plan = assembled_route(raw)
    except (Discarded, RoadGPTError):
        return None
    text = tidy(said, language)
    typed = noisy(text, language, rng)
    if not 1 <= len(text) <= LONGEST or is_held_out(text) or is_held_out(typed):
        return None
    return Pair(typed, plan, f"networks/generated-{language}", language)


def assembled_route(raw: str) -> str:
    """Returns the standard form of the plan that the grammar rules wrote.

    If the plan contains a refusal, only the refusal is returned.

    Raises:
        Discarded: the plan has more than six junctions, a part between two ``//`` names several kinds of
            junction, or a clause of a road names no kind of element, or several.
        RoadGPTError: the plan cannot be read, or demands something impossible.
    """
    if refusal := REFUSAL.search(raw):
        return refusal[0]
    of_all, rest = OF_ALL.findall(raw), OF_ALL.sub(" ", raw)
    everywhere, rest = OF_EVERY_ROAD.findall(rest), OF_EVERY_ROAD.sub(" ", rest)
    parts = [part for part in (_part(each) for each in rest.split("//")) if part]
    if everywhere:
        parts = _on_every_road(parts, everywhere)
    line = " // ".join(parts)
    brief = read_plan(f"{line} || {' '.join(dict.fromkeys(of_all))}" if of_all else line)
    check(brief, map_size=None)
    if len(brief.junctions) > MOST_JUNCTIONS:
        raise Discarded
    return standard(brief)


def _part(raw: str) -> str:
    """Returns a road or a junction in the order of words in which plans are written."""
    words = [word for word in raw.split() if not word.endswith("=")]
    if words[:1] == ["map"]:
        return " ".join(words)
    kinds = [word for word in words if is_of_junctions(word)]
    if not kinds:
        return road_of(raw)
    if len(kinds) > 1:
        raise Discarded
    return " ".join(dict.fromkeys([*kinds, *words]))


def _on_every_road(parts: list[str], wishes: list[str]) -> list[str]:
    """Adds requirements to every road, also to those of which the text says nothing else."""
    added = " ".join(dict.fromkeys(wishes))
    out: list[str] = []
    is_road = False
    for part in parts:
        if is_of_junctions(part):
            out += [part] if is_road else [f"| {added}", part]
        else:
            out.append(f"{part} {added}" if "|" in part else f"{part} | {added}")
        is_road = not is_of_junctions(part)
    return out if is_road else [*out, f"| {added}"]
