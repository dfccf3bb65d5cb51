"""What the planner reaches: valid roads that keep their words, no two alike, and how long one takes.

python benchmarks/bench_design.py [ROADS [FOLDER]]

FOLDER holds what judges from outside: ``referee.py``, which says whether a road keeps a truth, and prompts
with their truths in ``prompts/dev.jsonl``. Without it, nothing is told of them."""

import importlib.util
import json
import subprocess
import sys
import time
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from types import ModuleType
from typing import Any

import numpy as np
from scipy.linalg import orthogonal_procrustes

from roadgpt import check
from roadgpt.brief import Brief, read
from roadgpt.check.measures import measure
from roadgpt.design import draft
from roadgpt.road import Design, Road, World, build
from roadgpt_sbft.validator import sbft_verdict

EVALUATION = {  # the thesis' prompts, and what an outside referee asks of their roads
    "a road": {"turns": [1, None]},
    "an uphill road with 3 turns": {"turns": 3, "grade": "up"},
    "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn": {
        "turns": 3,
        "sequence": [
            {"kind": "turn", "grade": "up"},
            {"kind": "turn", "grade": "up"},
            {"kind": "straight", "grade": "down"},
            {"kind": "turn", "dir": "left"},
        ],
    },
}
WORLD = World()
ROADS = int(sys.argv[1]) if sys.argv[1:] else 100
JUDGES = Path(sys.argv[2]) if sys.argv[2:] else None
POINTS = 200  # per road, in the comparison of shapes
WHOLE_PROCESS = f"""
from roadgpt.brief import read
from roadgpt.design import draft
from roadgpt.road import World
brief, earlier = read("an uphill road with 3 turns"), []
for seed in range({ROADS}):
    earlier.append(draft(brief, World(), earlier=earlier, seed=seed))
"""


def main(seed: int = 7) -> None:
    """Print every figure beside its target."""
    referee = the_referee()
    radii: list[float] = []
    for words, truth in EVALUATION.items():
        radii += _campaign(words, truth, referee, seed)
    deciles = " ".join(f"{radius:.0f}" for radius in np.quantile(radii, np.linspace(0, 1, 11)))
    print(f"radii of {len(radii)} turns, least, deciles, largest (target 15 to 80 m): {deciles} m")
    _prompts(referee, seed)
    before = getrusage(RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-c", WHOLE_PROCESS], check=True)
    after = getrusage(RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    print(f"a process that drafts {ROADS} roads, start included: {cpu:.2f} s processor (target 5 s for 100)")


def _campaign(words: str, truth: dict[str, Any], referee: ModuleType | None, seed: int) -> list[float]:
    """A hundred roads of one prompt; their radii."""
    brief, designs, seconds = read(words), list[Design](), list[float]()
    for number in range(ROADS):
        begun = time.process_time()
        designs.append(draft(brief, WORLD, earlier=designs, seed=seed + number))
        seconds.append(time.process_time() - begun)
    roads = [build(design) for design in designs]
    valid = sum(_is_valid(road, brief) for road in roads)
    kept = "-" if referee is None else sum(is_kept(road, truth, referee) for road in roads)
    octants = np.bincount([int(design.theta // 45) for design in designs], minlength=8)
    took = 1000 * np.array(seconds)
    print(f"'{words}', {ROADS} roads:")
    print(f"    strictly valid and by the competition's rules {valid}, right by the referee {kept}")
    print(f"    nearest pair {_nearest(roads):.2f} m RMS (target 5 m); start headings by octant {octants}")
    print(f"    a draft, checked: median {np.median(took):.1f} ms, slowest {took.max():.1f} ms (target 5 ms)")
    return [turn.radius for road in roads for turn in measure(road.centreline()).turns]


def _is_valid(road: Road, brief: Brief) -> bool:
    fine = sbft_verdict(road.control_points(), WORLD.site.map_size)[0]
    return fine and not check.inspect(road, brief, WORLD)


def is_kept(road: Road, truth: dict[str, Any], referee: ModuleType) -> bool:
    return all(referee.check(road.centreline().round(4), truth)[0].values())


def _nearest(roads: Sequence[Road]) -> float:
    """The least RMS distance of any pair, at equal shares of length, after the best shift, turn, mirror."""
    shapes = []
    for road in roads:
        points = road.plan.at(np.linspace(0, road.length, POINTS))
        shapes.append(points - points.mean(axis=0))
    return min(_apart(one, other) for one, other in combinations(shapes, 2))


def _apart(one: np.ndarray, other: np.ndarray) -> float:
    turn, _ = orthogonal_procrustes(one, other)
    return float(np.sqrt(((one @ turn - other) ** 2).sum(axis=1).mean()))


def _prompts(referee: ModuleType | None, seed: int, roads: int = 10) -> None:
    """The development prompts, ten roads each."""
    if JUDGES is None:
        print("development prompts: not at hand")
        return
    text = (JUDGES / "prompts" / "dev.jsonl").read_text(encoding="utf-8")
    prompts = [json.loads(line) for line in text.splitlines()]
    perfect = 0
    for prompt in prompts:
        brief, earlier, right = read(prompt["prompt"]), list[Design](), 0
        for number in range(roads):
            earlier.append(draft(brief, WORLD, earlier=earlier, seed=seed + number))
            right += is_kept(build(earlier[-1]), prompt["truth"], referee)
        perfect += right == roads
        if right < roads:
            print(f"    {right}/{roads} right: '{prompt['prompt']}'")
    print(f"development prompts with {roads}/{roads} roads right: {perfect} of {len(prompts)} (target 20)")


def the_referee() -> ModuleType | None:
    if JUDGES is None:
        return None
    spec = importlib.util.spec_from_file_location("referee", JUDGES / "referee.py")
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


if __name__ == "__main__":
    main()
