"""Texts of the field tell a road and a scene; each network learns its part of them.

The network for scenes writes the scene, and the wishes for the road that stand among the story: its kind, its
design speed and where one comes from. The networks for roads and routes write the rest.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import SCENE, plan, read_plan
from roadgpt.brief.scene import Land, Scene
from roadgpt_training.mentions import names_in
from roadgpt_training.noise import noisy
from roadgpt_training.pair import Pair, grouped
from roadgpt_training.phrasebook import one_of

FIELD = "field/"
"""Prefix of the family names of all pairs of the field."""
OPEN = plan(normal(Brief()))
"""The plan of a text that tells nothing of its road."""
OF_SCENES = ("surroundings", "motorway", "comes_from", "speed", "scene")
"""The fields of a Brief that the network for scenes writes."""
NAMED: Mapping[str, Scene] = {
    "traffic": Scene(flow="medium"),
    "night": Scene(light="night"),
    "wet": Scene(surface="wet"),
    "snow": Scene(surface="snow"),
    "snowfall": Scene(surface="snow"),
    "ice": Scene(surface="ice"),
    "bridge": Scene(landscape=(Land(kind="bridge"),)),
    "tunnel": Scene(landscape=(Land(kind="tunnel"),)),
}
"""What a name in ``beside(...)`` of older pairs is as a scene."""
DOUBTFUL = frozenset(
    ["pedestrian", "cyclist", "animal", "trees", "buildings", "water", "landscape", "obstacle", "parking",
     "sun", "rain", "fog"]
)  # fmt: skip
"""Names in ``beside(...)`` of older pairs that do not tell which scene is meant."""
KEPT = 50_000
"""The largest number of plans whose parts are kept, because parting them takes longest."""
JOINTS = (". ", ". ", "\n", "; ", " - ")
LONGEST = 900
"""The most letters of two texts that are joined."""


def of_scene(pair: Pair) -> Pair | None:
    """Returns a pair with the part of its plan that the network for scenes writes; None if its plan does not
    tell that part.
    """
    part = _scene_of(pair.plan, pair.family.startswith(FIELD))
    return None if part is None else replace(pair, plan=part)


@lru_cache(maxsize=KEPT)
def _scene_of(line: str, is_of_field: bool) -> str | None:
    if line.startswith(("!nonsense", "!unclear")):
        return line
    if line.startswith("!"):
        return "" if not is_of_field else line if line == "!contradiction" else None
    brief = read_plan(line)
    if not is_of_field:
        names = [*names_in(line)]
        scenes = [NAMED[name] for name in names if name in NAMED]
        if len(scenes) > 1 or not DOUBTFUL.isdisjoint(names):
            return None
        brief = brief.model_copy(update={"scene": scenes[0] if scenes else Scene()})
    return plan(Brief(**{name: getattr(brief, name) for name in OF_SCENES}))


def of_road(pair: Pair) -> Pair | None:
    """Returns a pair of the field with the part of its plan that the networks for roads write; None if its
    plan does not tell that part.
    """
    part = _road_of(pair.plan)
    return None if part is None else replace(pair, plan=part)


@lru_cache(maxsize=KEPT)
def _road_of(line: str) -> str | None:
    if line.startswith("!"):
        return None if line == "!contradiction" else line
    brief = read_plan(line)
    free = {name: Brief.model_fields[name].get_default() for name in OF_SCENES}
    if brief.junctions or brief.map is not None:
        free.pop("motorway")
    return plan(normal(brief.model_copy(update=free)))


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
