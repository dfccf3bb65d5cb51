"""How long 1,000 OpenDRIVE files take on one core, to write and to read back: prints one line for each.

    python benchmarks/bench_export.py [--roads N] [--folder DIR]

DIR keeps the files for readers that are not ours: docs/reference/export-formats.md has their answers.
"""

import argparse
import contextlib
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from roadgpt.brief import read
from roadgpt.design import draft
from roadgpt.errors import DesignError
from roadgpt.export import save
from roadgpt.network import read_opendrive
from roadgpt.road import CrossSection, Limits, Road, Site, World, build, in_short_segments

PLANS = (
    "turn x3 | up",
    "hairpin x2",
    "winding | down",
    "straight | turns=0",
    "s_bend; straight long",
    "turn x4 left | flat",
    "serpentine | up",
    "turn left gentle deg=60",
    "| turns=1.. hills=3..",
    "u_turn right",
    "straight long; chicane",
    "zigzag",
    "crest; dip | turns=0..",
    "turn x5 sharp alternating",
    "hairpin steeply_up; straight steeply_down",
)
MAPS = (250.0, 250.0, 400.0, 600.0)
FRICTIONS = (1.0, 0.6, 0.35)
LIMITS = (70 / 3.6, 50 / 3.6, 100 / 3.6, 30 / 3.6)
VERGES = (3.0, 0.0, 1.5)
SPLINES = 5  # every so many roads is a spline, drawn in hops as `roadgpt run --geometry spline` does


def main(roads: int = 1_000, folder: Path | None = None) -> None:
    made = [each for each, _ in zip(drawn(), range(roads), strict=False)]
    with contextlib.ExitStack() as stack:
        place = folder or Path(stack.enter_context(tempfile.TemporaryDirectory()))
        begun = time.process_time()
        files = [
            path
            for number, (road, world, kind) in enumerate(made)
            for path in save(road, place, ["opendrive"], world, f"{number:04d}{kind}")
            if path.suffix == ".xodr"
        ]
        wrote = time.process_time() - begun
        begun = time.process_time()
        back = [read_opendrive(path).road for path in files]
        took = time.process_time() - begun
        size = sum(path.stat().st_size for path in files) / 1e6
    worst = max(apart(one, other) for (one, _, _), other in zip(made, back, strict=True))
    splines = sum(kind == "s" for _, _, kind in made)
    print(f"{roads:,} roads, {splines} of them splines: {wrote:.1f} s processor time, {size:.1f} MB")
    print(f"read back: {took:.1f} s processor time; never farther away than {1000 * worst:.3f} mm")


def drawn() -> Iterator[tuple[Road, World, str]]:
    """Roads without end, each with its world and "s" for a spline or "a" for arcs."""
    number = 0
    while True:
        line, map_size = PLANS[number % len(PLANS)], MAPS[number // len(PLANS) % len(MAPS)]
        speed_limit, verge = LIMITS[number % len(LIMITS)], VERGES[number % len(VERGES)]
        friction = FRICTIONS[number % len(FRICTIONS)]
        world = World(
            site=Site(map_size=map_size, friction=friction),
            limits=Limits(speed_limit=speed_limit),
            section=CrossSection(shoulder=verge),
        )
        number += 1
        try:
            design = draft(read(line, "plan"), world, seed=number)
        except DesignError:
            continue
        is_spline = number % SPLINES == 0
        road = build(in_short_segments(design), "spline") if is_spline else build(design)
        yield road, world, "s" if is_spline else "a"


def apart(one: Road, other: Road) -> float:
    """Metres between the same stations of two roads, at most."""
    s = np.linspace(0, min(one.length, other.length), 200)
    return float(np.abs(one.at(s) - other.at(s)).max())


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--roads", type=int, default=1_000)
    parser.add_argument("--folder", type=Path, default=None)
    main(**vars(parser.parse_args()))
