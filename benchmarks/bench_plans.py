"""How many plans of practice the designer can do, and how much processor time each takes.

    python benchmarks/bench_plans.py [SECONDS [WORD]]

``plans_of_practice.jsonl`` holds 200 plans that somebody of the trade might type: from handbooks of road
design, test tracks, mountain passes and motorways. Each is designed with the seeds 1 and 2 on a map that may
grow, and checked by the rules; a design that takes more than SECONDS of the processor (60) counts as failed.
With a WORD, only plans whose text, kind or source contains it are designed.
"""

import json
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from roadgpt.errors import RoadGPTError
from roadgpt.road import World
from roadgpt.run import Run, Setup, brief_of, perform

PLANS = Path(__file__).with_name("plans_of_practice.jsonl")
SEEDS = (1, 2)
DESIGN = Setup(reader="plan", drives=False)
TEN_KM = """
winding | len=10000
| len=10000
| len=10000 motorway
turn x14 | len=10000 r=300..900 steepest=..5.5
turn x8 | len=10000
turn x20 alternating | len=10000
turn x40 | len=10000 r=40..200
hairpin x20 up | len=10000
| len=10000 up
| len=10000 hills=6
winding down | len=10000 steepest=..8
| turns=25 len=10000
| turns=10.. len=10000 lanes=2 against=2
turn x12 | lanes=2 against=2 divided len=10000 r=400..1500
straight 4000; turn left 90 r300; straight 5500
straight 10000
turn x30 up | len=10000 climb=600
serpentine | len=10000
turn x6 alternating | len=10000 r=800..2500
zigzag | len=10000
"""


def plans(word: str = "") -> list[dict[str, Any]]:
    rows = (json.loads(line) for line in PLANS.read_text(encoding="utf-8").splitlines())
    return [row for row in rows if word in " ".join((row["plan"], row["kind"], row["source"]))]


def designed(row: dict[str, Any], seed: int) -> Run:
    """The Run of one plan, which ends before the drive."""
    world = World.model_validate(row.get("world", {}))
    return perform(brief_of(row["plan"], world, DESIGN), seed, world, DESIGN)


def main(seconds: float = 60.0, word: str = "") -> None:
    signal.signal(signal.SIGPROF, _give_up)
    _report(plans(word), seconds)
    if not word:
        _report([{"plan": line} for line in TEN_KM.strip().splitlines()], seconds)


def _report(rows: list[dict[str, Any]], seconds: float) -> None:
    took, failed = list[float](), dict[str, list[str]]()
    for row in rows:
        for seed in SEEDS:
            begun = time.process_time()
            problem = "; ".join(_problems(row, seed, seconds))
            took.append(time.process_time() - begun)
            if problem:
                failed.setdefault(row["plan"], []).append(problem)
                print(f"    {row['plan']}, seed {seed}, {took[-1]:.1f} s: {problem}", flush=True)
    median, slow, slowest = np.percentile(took, [50, 95, 100])
    print(f"{len(rows) - len(failed)} of {len(rows)} plans designed with seeds {SEEDS}; ", end="")
    print(f"processor seconds: median {median:.2f}, 95 % {slow:.2f}, slowest {slowest:.2f}")


def _problems(row: dict[str, Any], seed: int, seconds: float) -> Iterator[str]:
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        run = designed(row, seed)
        yield from (finding.sentence for finding in run.findings)
    except RoadGPTError as error:
        yield str(error)
    except Exception as error:  # a breakdown is one plan's
        yield f"breakdown: {error!r}"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def _give_up(*_: object) -> None:
    raise TimeoutError


if __name__ == "__main__":
    main(*map(float, sys.argv[1:2]), *sys.argv[2:])
