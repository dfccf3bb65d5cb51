"""Writes ``data/``: what outside judges say of a few roads, so that a checkout alone has their answers.

    cd tests && python -m authorities.freeze

The judges themselves lie beside the checkout where the project is built (see ``data/README.md``).
"""

import gzip
import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from authorities.test_referee import drawn_truth
from outside_judge import load_referee
from roadgpt.brief import read
from roadgpt.check.measures import measure
from roadgpt.design.designers.planner import Planner
from roadgpt.road import Design, Segment, World, build

HERE = Path(__file__).resolve().parent
PROMPTS = (
    "a road",
    "an uphill road with 3 turns",
    "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn",
    "a hilly road",
    "a flat road with a hairpin, then a long straight",
    "a steep downhill road with 4 alternating turns",
    "an S-bend, then a short straight uphill, then a gentle right turn",
    "a crest, then two sharp left turns",
)
PER_PROMPT, AT_RANDOM, TRUTHS = 2, 14, 6
VERDICTS = 30  # of each message


def random_design(rng: np.random.Generator) -> Design:
    """Segments as a person or a language model writes them: most such roads are not valid."""
    segments = []
    for _ in range(rng.integers(2, 8)):
        turn = float(rng.integers(-70, 71)) if rng.random() < 0.6 else 0.0
        direction = "straight" if turn == 0 else "left" if turn > 0 else "right"
        segments.append(
            Segment(
                distance=round(float(rng.uniform(15, 80)), 1),
                direction=direction,
                turn_degrees=turn,
                incline=float(rng.integers(-15, 16)),
            )
        )
    x, y, z = (round(float(v), 1) for v in rng.uniform(20, 120, 3))
    return Design(starting_point=(x, y, z), theta=float(rng.integers(360)), segments=tuple(segments))


def measured_roads() -> list[dict[str, Any]]:
    referee, planner, rng = load_referee(), Planner(), np.random.default_rng(20)
    designs: list[Design] = []
    for words in PROMPTS:
        designs += [planner.draft(read(words), World(), (), designs, seed) for seed in range(PER_PROMPT)]
    designs += [random_design(rng) for _ in range(AT_RANDOM)]
    out = []
    for design in designs:
        points = build(design).centreline().round(4)
        ours = measure(points)
        truths = [drawn_truth(rng, ours) for _ in range(TRUTHS)]
        judged = [{"truth": truth, "holds": referee.check(points, truth)[0]} for truth in truths]
        out.append({"design": design.to_json(), "measures": referee.measure(points), "truths": judged})
    return out


def verdicts() -> list[str]:
    """Some of every message, the shortest ones."""
    by_message: dict[str, list[str]] = defaultdict(list)
    with gzip.open(HERE.parents[2] / "shared" / "data" / "sbft_verdicts.jsonl.gz", "rt") as lines:
        for line in lines:
            by_message[json.loads(line)["validation_message"]].append(line.strip())
    return [line for some in by_message.values() for line in sorted(some, key=len)[5 : 5 + VERDICTS]]


def rounded(value: Any) -> Any:
    """Floats to six decimals."""
    if isinstance(value, dict):
        return {key: rounded(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [rounded(v) for v in value]
    return round(value, 6) if isinstance(value, float) else value


if __name__ == "__main__":
    roads = [json.dumps(rounded(road), separators=(",", ":"), default=float) for road in measured_roads()]
    (HERE / "data" / "referee.jsonl").write_text("\n".join(roads) + "\n", encoding="utf-8")
    (HERE / "data" / "sbft_verdicts.jsonl").write_text("\n".join(verdicts()) + "\n", encoding="utf-8")
