"""How long networks take to build, to pave and to write on one core: prints median and slowest of each.

    python benchmarks/bench_networks.py [--networks N] [--profile STEP]

The designs are those of the tests: one to four junctions of all kinds. Times are of the processor, with
Python's garbage collector at its defaults, as in a run of many networks. A collection before each step would
empty the caches of the processor and add up to half of the time. A step that is named with --profile (build,
paved or opendrive) is profiled, and its dearest functions are printed.
"""

import argparse
import cProfile
import pstats
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "network"))
from random_designs import random_design

from roadgpt.errors import UsageError
from roadgpt.export.exporters.opendrive import document
from roadgpt.network import Route, build_route
from roadgpt.road import Design, World, read_design

SHOWN = 25  # functions of a profile


def main(networks: int = 200, profile: str | None = None) -> None:
    world = World()
    designs = [read_design(random_design(seed))[0] for seed in range(networks)]
    routes = [route for design in designs if (route := built(design, world)) is not None]
    roads = np.array([len(route.network.roads) for route in routes])
    print(f"{len(routes)} networks of {np.median(roads):.0f} roads (median; at most {roads.max()})")
    steps: dict[str, tuple[Callable[[int], object], int]] = {
        "build": (lambda n: built(designs[n], world), networks),
        "paved": (lambda n: routes[n].network.paved, len(routes)),
        "opendrive": (lambda n: document(routes[n], world).to_text(), len(routes)),
    }
    for name, (step, count) in steps.items():
        profiler = cProfile.Profile() if name == profile else None
        took = 1000 * np.array([timed(step, n, profiler) for n in range(count)])
        print(f"{name}: median {np.median(took):.2f} ms, slowest {took.max():.1f} ms")
        if profiler is not None:
            pstats.Stats(profiler).sort_stats("tottime").print_stats(SHOWN)
    size = np.array([len(document(route, world).to_text()) for route in routes])
    print(f"OpenDRIVE files: median {np.median(size) / 1e3:.0f} kB")


def built(design: Design, world: World) -> Route | None:
    """The route of a design; None where its arms do not fit."""
    try:
        return build_route(design, world)
    except UsageError:
        return None


def timed(step: Callable[[int], object], number: int, profiler: cProfile.Profile | None) -> float:
    """Seconds of processor time of one step."""
    begun = time.process_time()
    if profiler is None:
        step(number)
    else:
        profiler.runcall(step, number)
    return time.process_time() - begun


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--networks", type=int, default=200)
    parser.add_argument("--profile", choices=("build", "paved", "opendrive"), default=None)
    main(**vars(parser.parse_args()))
