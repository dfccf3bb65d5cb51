"""Makes descriptions impossible by adding a requirement that contradicts them or cannot be met."""

import re
from dataclasses import replace

import numpy as np

from roadgpt_training.noise import tidy
from roadgpt_training.pair import Pair
from roadgpt_training.phrasebook import one_of, phrases_of
from roadgpt_training.spelling import spell

TURNING = re.compile(
    r"\b(?:turn|hairpin|switchback|u_turn|s_bend|chicane|slalom|serpentine|zigzag|winding)\b"
)
WORDS = phrases_of("spoilers")
CONFLICTS: dict[str, dict[str, list[str]]] = WORDS["conflicts"]
"""Maps a requirement of a plan to texts, by language, that contradict this requirement."""
BEYOND: dict[str, list[str]] = WORDS["beyond"]
"""Texts, by language, with requirements that no road can meet."""
OF_RADIUS = re.compile("[rR]adius|rayon|radio|raggio")
CAUSES = {"turning": "turns", "many": "turns", "straight": "turns", "left": "sides", "right": "sides"}
"""Maps a contradicted requirement to the cause of the refusal; for all others, the cause is "slope"."""
BEYOND_BY = {
    "within {near}": "length", "{near}": "radius", "{far}": "length", "{grade}": "grade", "vertical": "grade",
    "{much}": "turns", "loop": "loop", "circle": "degrees",
}  # fmt: skip
"""Maps a part of an impossible requirement's text to the cause; the first part found in the text counts."""


def contradicted(pair: Pair, rng: np.random.Generator) -> Pair | None:
    """Returns the description with a contradicting requirement added, and the refusal that a reader should
    give as its answer; None if no suitable wording is available.
    """
    kinds = [kind for kind in _holds(pair.plan) if pair.lang in CONFLICTS[kind]]
    if not kinds:
        return None
    kind = one_of(kinds, rng)
    text = _with(pair, one_of(CONFLICTS[kind][pair.lang], rng), rng)
    return replace(pair, text=text, plan=f"!contradiction {CAUSES.get(kind, 'slope')}")


def overdone(pair: Pair, rng: np.random.Generator) -> Pair | None:
    """Returns the description with an impossible requirement added, and the refusal that a reader should
    give as its answer; None if no suitable wording is available.
    """
    if pair.lang not in BEYOND or pair.is_refusal:
        return None
    numbers = {
        "grade": int(rng.integers(18, 96)), "far": int(rng.integers(3, 60)),
        "near": int(rng.integers(2, 9)), "much": int(rng.integers(20, 99)),
    }  # fmt: skip
    said = {name: spell(n, pair.lang) if rng.random() < 0.3 else str(n) for name, n in numbers.items()}
    way = one_of(BEYOND[pair.lang], rng)
    if OF_RADIUS.search(way) and not TURNING.search(pair.plan):
        return None
    cause = next(cause for part, cause in BEYOND_BY.items() if part in way)
    text = _with(pair, way.format(**said), rng)
    return replace(pair, text=text, plan=f"!impossible {cause}")


def _with(pair: Pair, wish: str, rng: np.random.Generator) -> str:
    body = pair.text.rstrip(" .!?")
    if rng.random() < 0.15:
        wish = re.sub(r"^(?:and|but|yet|aber|und|mais|et|pero|y|ma|e) ", "", wish)
        return tidy(f"{wish[:1].upper()}{wish[1:]}: {body}", pair.lang)
    return tidy(f"{body}{', ' if rng.random() < 0.7 else ' '}{wish}", pair.lang)


def _holds(plan: str) -> list[str]:
    """Returns those requirements of a plan that can be contradicted, as keys of CONFLICTS."""
    if plan.startswith("!"):
        return []
    clauses, _, wishes = plan.partition("|")
    found = []
    if TURNING.search(clauses):
        found.append("turning")
        found += [side for side in ("left", "right") if re.search(rf"\b{side}\b", clauses)]
        if any(int(n) > 2 for n in re.findall(r"\bx(\d+)(?!\d*\.\.)", clauses)) or clauses.count(";") > 3:
            found.append("many") if "straight" not in clauses else None
    found += [
        way
        for way in ("up", "down", "flat")
        if re.search(rf"(?:^|[\s_]){way}\b", wishes) and "ends(" not in wishes
    ]
    if clauses.strip() == "straight" and re.search(r"\bturns=0\b", wishes):
        found.append("straight")
    return found
