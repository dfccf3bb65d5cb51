"""Makes descriptions impossible by adding a requirement that contradicts them or cannot be met."""

import json
import re
from importlib.resources import files

import numpy as np

from roadgpt.brief.readers.model.numerals import spell
from roadgpt.learn.noise import tidy

TURNING = re.compile(
    r"\b(?:turn|hairpin|switchback|u_turn|s_bend|chicane|slalom|serpentine|zigzag|winding)\b"
)
WORDS = json.loads((files("roadgpt.learn") / "words" / "spoilers.json").read_text(encoding="utf-8"))
CONFLICTS: dict[str, dict[str, list[str]]] = WORDS["conflicts"]
"""Maps a requirement of a plan to texts, by language, that contradict this requirement."""
BEYOND: dict[str, list[str]] = WORDS["beyond"]
"""Texts, by language, with requirements that no road can meet."""


CAUSES = {"turning": "turns", "many": "turns", "straight": "turns", "left": "sides", "right": "sides"}
"""The cause of a contradiction, by the requirement that is contradicted; for all others it is the slope."""
BEYOND_BY = {
    "{grade}": "grade", "{far}": "length", "{near}": "radius", "{much}": "turns", "vertical": "grade",
    "loop": "loop", "circle": "degrees",
}  # fmt: skip
"""The cause of an impossible requirement, by a part of its text."""


def contradicted(text: str, plan: str, language: str, rng: np.random.Generator) -> tuple[str, str] | None:
    """Returns the description with a contradicting requirement added, and the refusal that a reader should
    give as its answer; None if no suitable wording is available.
    """
    kinds = [kind for kind in _holds(plan) if language in CONFLICTS[kind]]
    if not kinds:
        return None
    kind = kinds[int(rng.integers(len(kinds)))]
    ways = CONFLICTS[kind][language]
    return _with(
        text, ways[int(rng.integers(len(ways)))], language, rng
    ), f"!contradiction {CAUSES.get(kind, 'slope')}"


def overdone(text: str, plan: str, language: str, rng: np.random.Generator) -> tuple[str, str] | None:
    """Returns the description with an impossible requirement added, and the refusal that a reader should
    give as its answer; None if no suitable wording is available.
    """
    if language not in BEYOND or plan.startswith("!"):
        return None
    ways = BEYOND[language]
    numbers = {
        "grade": int(rng.integers(18, 96)), "far": int(rng.integers(3, 60)),
        "near": int(rng.integers(2, 9)), "much": int(rng.integers(20, 99)),
    }  # fmt: skip
    said = {name: spell(n, language) if rng.random() < 0.3 else str(n) for name, n in numbers.items()}
    way = ways[int(rng.integers(len(ways)))]
    if (
        "radius" in way or "Radius" in way or "rayon" in way or "radio" in way or "raggio" in way
    ) and not TURNING.search(plan):
        return None
    cause = next(cause for part, cause in BEYOND_BY.items() if part in way)
    if "within {near}" in way:
        cause = "length"
    return _with(text, way.format(**said), language, rng), f"!impossible {cause}"


def _with(text: str, wish: str, language: str, rng: np.random.Generator) -> str:
    body = text.rstrip(" .!?")
    if rng.random() < 0.15:
        wish = re.sub(r"^(?:and|but|yet|aber|und|mais|et|pero|y|ma|e) ", "", wish)
        return tidy(f"{wish[:1].upper()}{wish[1:]}: {body}", language)
    return tidy(f"{body}{', ' if rng.random() < 0.7 else ' '}{wish}", language)


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
