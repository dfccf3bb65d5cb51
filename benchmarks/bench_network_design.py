"""How many routes with one to five junctions find a place on the usual map, and how long drafting one takes.

    python benchmarks/bench_network_design.py [ROUTES]

Every route has junctions of any kind, drawn by its seed, and roads of which nothing is required. Beside them,
single roads with three turns are drafted by the same planner. Times are of the processor.
"""

import sys
import time

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.brief.plan import read_plan
from roadgpt.check import inspect
from roadgpt.design.designers.planner import Planner
from roadgpt.errors import DesignError
from roadgpt.network import made_from
from roadgpt.road import World

KINDS = ("t_junction", "y_junction", "crossroads", "roundabout", "star")
WORLD = World()


def main(routes: int = 100) -> None:
    print("| roads | placed | valid and as asked | median | 95 % |")
    print("|---|---|---|---|---|")
    report("single roads with three turns", [read_plan("turn x3")] * routes)
    for count in range(1, 6):
        rng = np.random.default_rng(count)
        rows = [rng.choice(KINDS[:4] if count > 2 else KINDS, size=count) for _ in range(routes)]
        briefs = [read_plan(" // ".join(row)) for row in rows]
        report(f"routes with {count} junction{'s' if count > 1 else ''}", briefs)


def report(what: str, briefs: list[Brief]) -> None:
    """Drafts one road or route of each Brief and prints a row of the table."""
    took, placed, valid = [], 0, 0
    for seed, brief in enumerate(briefs):
        begun = time.process_time()
        try:
            design = Planner().draft(brief, WORLD, (), (), seed)
        except DesignError:
            continue
        finally:
            took.append(1000 * (time.process_time() - begun))
        placed += 1
        valid += not inspect(made_from(design, WORLD), brief, WORLD)
    median, slow = np.percentile(took, [50, 95])
    print(f"| {what} | {placed} of {len(briefs)} | {valid} | {median:.0f} ms | {slow:.0f} ms |")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
