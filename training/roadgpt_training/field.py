"""Texts of the field, which tell a road and a scene: how their plans are parted, and more of them."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import SCENE, plan, read_plan
from roadgpt.brief.readers.model.vocabulary import WISHES
from roadgpt_training.noise import noisy
from roadgpt_training.pair import Pair, grouped
from roadgpt_training.phrasebook import one_of

FIELD = "field/"
"""Prefix of the family names of all pairs of the field."""
OPEN = plan(normal(Brief()))
"""The plan of a text that tells nothing of its road."""
TOLD = ("surroundings", "motorway", "comes_from", "speed", "scene")
"""The fields of a Brief that stand behind its road in the tokens of the networks."""
KEPT = 50_000
"""The largest number of plans whose parts are kept, because parting them takes longest."""
JOINTS = (". ", ". ", "\n", "; ", " - ")
LONGEST = 900
"""The most letters of two texts that are joined."""


@lru_cache(maxsize=KEPT)
def parted(line: str) -> tuple[str, str]:
    """Returns the plan of a road, and what is told beside it, in the order of the tokens: first, behind ':',
    the wishes that do not shape the road, then the scene.
    """
    if line.startswith("!"):
        return line, ""
    brief = read_plan(line)
    of_told = {name: getattr(brief, name) for name in TOLD}
    free = {name: Brief.model_fields[name].get_default() for name in TOLD}
    if brief.junctions or brief.map is not None:
        of_told.pop("motorway")
        free.pop("motorway")
    told = plan(Brief(**of_told))
    return plan(normal(brief.model_copy(update=free))), told.replace("|", WISHES, 1) if told[
        :1
    ] == "|" else told


def composed(pairs: Sequence[Pair], roads: Sequence[Pair], rng: np.random.Generator) -> Iterator[Pair]:
    """Yields texts of one road and one scene without end, each joined of one of ``roads`` without a scene
    and one of ``pairs`` that has nothing else, in the same language.
    """
    only_scenes = [pair for pair in pairs if pair.plan.startswith(f"{OPEN} {SCENE}")]
    scenes = grouped(only_scenes, lambda pair: pair.lang)
    plain = [
        pair for pair in roads if not pair.is_refusal and "beside(" not in pair.plan and pair.lang in scenes
    ]
    while True:
        road = one_of(plain, rng)
        scene = one_of(scenes[road.lang], rng)
        if len(road.text) + len(scene.text) > LONGEST or SCENE in road.plan or "ego lane" in scene.plan:
            continue
        both = [road.text.rstrip(" ."), scene.text.rstrip(" .")]
        first, second = both if rng.random() < 0.6 else both[::-1]
        text = f"{first}{one_of(JOINTS, rng)}{second}."
        yield replace(
            road, text=text, plan=f"{road.plan} {scene.plan.removeprefix(OPEN)}", family=f"{FIELD}composed"
        )


def varied(pairs: Sequence[Pair], rng: np.random.Generator) -> Iterator[Pair]:
    """Yields random pairs without end, some of them with typing errors."""
    while True:
        pair = one_of(pairs, rng)
        is_noisy = rng.random() < 0.3 and pair.lang in ("en", "de", "fr", "es", "it")
        yield replace(pair, text=noisy(pair.text, pair.lang, rng)) if is_noisy else pair
