"""How long 1,000 OpenDRIVE files take on one core, to write and to read back: prints one line for each."""

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

from roadgpt.brief import read
from roadgpt.design import draft
from roadgpt.export import save
from roadgpt.road import Road, World, build, in_hops, read_opendrive

WORDS = (
    "an uphill road with 3 turns",
    "a winding road downhill",
    "two hairpins, then a long straight",
    "a flat road with 4 left turns",
    "an S-bend",
)
SPLINES = 5  # every so many roads is a spline


def main(roads: int = 1_000, seed: int = 1) -> None:
    world, made = World(map_size=400.0), []
    briefs = [read(words, "grammar", world.map_size) for words in WORDS]
    for number in range(roads):
        design = draft(briefs[number % len(briefs)], world, seed=seed + number)
        is_spline = number % SPLINES == 0
        made.append(build(in_hops(design), "spline") if is_spline else build(design))
    with tempfile.TemporaryDirectory() as folder:
        begun = time.process_time()
        for number, road in enumerate(made):
            save(road, folder, ["opendrive"], world, f"{number:04d}")
        wrote = time.process_time() - begun
        begun = time.process_time()
        back = [read_opendrive(path).road for path in sorted(Path(folder).glob("*.xodr"))]
        took = time.process_time() - begun
        size = sum(path.stat().st_size for path in Path(folder).iterdir()) / 1e6
    worst = max(apart(one, other) for one, other in zip(made, back, strict=True))
    splines = -(-roads // SPLINES)
    print(f"{roads:,} roads, {splines} of them splines: {wrote:.1f} s processor time, {size:.1f} MB")
    print(f"read back: {took:.1f} s processor time; never farther away than {1000 * worst:.3f} mm")


def apart(one: Road, other: Road) -> float:
    """Metres between the same stations of two roads, at most."""
    s = np.linspace(0, min(one.length, other.length), 200)
    return float(np.abs(one.at(s) - other.at(s)).max())


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--roads", type=int, default=1_000)
    parser.add_argument("--seed", type=int, default=1)
    main(**vars(parser.parse_args()))
