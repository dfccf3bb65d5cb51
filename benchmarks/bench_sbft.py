"""Tests per second of `roadgpt sbft`, and how many roads of ours their validator takes.

    python benchmarks/bench_sbft.py [TESTS]

Wall time of a machine that does other things beside says little; processor time of this process (validating,
driving, judging, writing) and of the generator's is given beside it.
"""

import os
import sys
import tempfile
import time
from collections import Counter
from itertools import islice
from pathlib import Path

from roadgpt_sbft import Experiment, RoadGPTTestGenerator, compete
from roadgpt_sbft.validator import sbft_verdict

EXAMPLES = Path(__file__).resolve().parents[1] / "examples" / "sbft"
TESTS = int(sys.argv[1]) if sys.argv[1:] else 200
ROADS = 3 * TESTS // 2
PIPELINE = 33.0  # s a test, of the competition's own with BeamNG, at best
WORDS = (
    "a road",
    "an uphill road with 3 turns",
    "a road going uphill for 2 turns, followed by a straight downhill segment, ending in a left turn",
    RoadGPTTestGenerator.description,
)


def let_loose(module: str, name: str, tests: int) -> str:
    """A line on one generator; its start is not counted."""
    experiment = Experiment(module_name=module, class_name=name, module_path=str(EXAMPLES), test_budget=tests)
    before = os.times().children_user + os.times().children_system
    with tempfile.TemporaryDirectory() as folder:
        work = iter(compete(experiment, out=Path(folder, "out")))
        outcomes = Counter([next(work).outcome])
        wall, own = time.perf_counter(), time.process_time()
        outcomes.update(run.outcome for run in work)
        wall, own = time.perf_counter() - wall, time.process_time() - own
        children = os.times().children_user + os.times().children_system - before
    per_core = (tests - 1) / own
    said = ", ".join(f"{count} {outcome}" for outcome, count in outcomes.most_common())
    clock = (tests - 1) / wall
    return (
        f"{name:14s} {per_core:5.1f} tests per second of processor time, {clock:5.1f} on the clock "
        f"({PIPELINE * per_core:,.0f} times the competition's pipeline); {said}; generators {children:.1f} s"
    )


def main() -> None:
    for module, name in (
        ("curvature_walk", "CurvatureWalk"),
        ("random_points", "RandomPoints"),
        ("simple_ga", "SimpleGA"),
    ):
        print(let_loose(module, name, TESTS))
    for words in WORDS:
        generator = RoadGPTTestGenerator(map_size=200)
        generator.description, generator.search = words, False
        begun = time.process_time()
        roads = list(islice(generator.roads(), ROADS))
        each = 1000 * (time.process_time() - begun) / ROADS
        valid = sum(sbft_verdict(points, 200)[0] for points in roads)
        most = max(map(len, roads))
        print(
            f"{valid} of {ROADS} valid on a map of 200 m, {each:.1f} ms each, at most {most} points: {words}"
        )


if __name__ == "__main__":
    main()
