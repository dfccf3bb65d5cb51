"""On how many roads the standard drivers leave their lane, to which side, and how fast they are in bends.

    python benchmarks/bench_drivers.py [ROADS]

Dry asphalt, 70 km/h, tolerance 0.85, a map of 200 m: valid roads of the field's random walk, and drafts of
"a road". The parameters of ``lane_centring`` were chosen so that it fails on 5 to 25 % of the walk's roads
and on at most 15 % of the drafts, before any search was tuned with it.
"""

import itertools
import sys
from collections import Counter
from collections.abc import Sequence

import numpy as np
from scipy.signal import find_peaks

from bench_search import WORLD, walks
from roadgpt import plugins
from roadgpt.design import draft
from roadgpt.drive import simulate
from roadgpt.road import Road, build
from roadgpt.run import Setup, brief_of
from roadgpt.verdict import judge

DRIVERS = ("beamng_like", "lane_centring")
SEED = 101  # of the walk; searches are never run with it
BEND = 0.02  # 1/m: where the curvature is largest, and above this


def rows(kind: str, roads: Sequence[Road]) -> None:
    """Prints a line for each driver."""
    for name in DRIVERS:
        sides: Counter[str] = Counter()
        lateral: list[float] = []
        for road in roads:
            drive = simulate(road, WORLD, plugins.find("drivers", name)(), seed=0)
            verdict = judge(road, drive, WORLD)
            if not verdict.kept:
                sides[str(verdict.side)] += 1
            s, speed = np.array(drive["s"]), np.array(drive["speed"])
            bend = np.abs(road.curvature(s))
            peaks, _ = find_peaks(bend, height=BEND, distance=20)
            lateral += (speed[peaks] ** 2 * bend[peaks]).tolist()
        fails = sum(sides.values())
        print(
            f"{name}, {kind}: {fails} of {len(roads)} fail ({100 * fails / len(roads):.1f} %), "
            f"{sides['left']} to the left, {sides['right']} to the right; lateral acceleration in "
            f"{len(lateral)} bends {np.median(lateral):.2f} m/s2 (median), {np.max(lateral):.2f} (largest); "
            f"{100 * np.mean(np.array(lateral) > 1.9):.0f} % above 1.9"
        )


def main(number: int = 200) -> None:
    """Prints both tables."""
    brief = brief_of("a road", WORLD, Setup())
    rows("walk", list(itertools.islice(walks(SEED), number)))
    rows("a road", [WORLD.lay(build(draft(brief, WORLD, seed=seed))) for seed in range(number)])


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
