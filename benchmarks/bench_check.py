"""How fast roads are checked, and whether the fast verdict is the competition's: prints two small tables."""

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import shapely

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from authorities import sbft_official_slow as slow
from authorities.sbft_roads import mutated, random_road
from roadgpt.check import inspect
from roadgpt.errors import UsageError
from roadgpt.road import Design, Road, Segment, Site, World, build
from roadgpt_sbft.validator import sbft_verdict

BARS = {
    100: 24,
    200: 69,
    400: 262,
    800: 718,
}  # ms, of the competition's own code as it was measured elsewhere


def main(roads: int = 10_000, seed: int = 1) -> None:
    print(f"{'road':>6} {'strict':>10} {'sbft':>10} {'slow sbft':>10} {'bar':>8}   (ms, median)")
    for length, bar in BARS.items():
        road, world = snake(length), World(site=Site(map_size=1000))
        points = road.control_points()
        assert inspect(road, None, world) == ()
        assert slow.verdict(points, 1000) == sbft_verdict(points, 1000) == (True, "")
        figures = (
            median_ms(lambda road=road, world=world: inspect(fresh(road), None, world)),
            median_ms(lambda points=points: sbft_verdict(points, 1000)),
            median_ms(lambda points=points: slow.verdict(points, 1000), rounds=3),
        )
        print(f"{length:4d} m " + " ".join(f"{figure:10.2f}" for figure in figures) + f" {bar:8d}")
    print(f"\n{roads:,} random and mutated roads, seed {seed}: {differences(roads, seed)}")


def snake(length: float) -> Road:
    """Straights and turns to either side, going uphill and down, of this length in all."""
    parts = max(2, round(length / 40))
    segments = [
        Segment(distance=length / parts, direction="straight", incline=4)
        if i % 2 == 0
        else Segment(
            distance=length / parts,
            direction="left" if i % 4 == 1 else "right",
            turn_degrees=60 if i % 4 == 1 else -60,
            incline=-5,
        )
        for i in range(parts)
    ]
    return build(Design(starting_point=(30, 30, 0), theta=10, segments=tuple(segments)))


def fresh(road: Road) -> Road:
    """The same road, not yet sampled: what a designer checks is new each time."""
    return Road(road.plan, road.elevation, road.nodes)


def median_ms(work: Callable[[], object], rounds: int = 200) -> float:
    work()
    took = []
    for _ in range(rounds):
        start = time.perf_counter()
        work()
        took.append(time.perf_counter() - start)
    return 1000 * sorted(took)[len(took) // 2]


def differences(roads: int, seed: int) -> str:
    """Fast against slow; where the competition's code stops with an error, ours must not pass the road."""
    rng = np.random.default_rng(seed)
    judged = stopped = valid = differ = 0
    seconds = [0.0, 0.0]
    for number in range(roads):
        points, map_size = random_road(rng)
        if number % 2:
            points = mutated(points, rng)
        begin = time.perf_counter()
        try:
            theirs: tuple[bool, str] | None = slow.verdict(points, map_size)
        except (ValueError, shapely.errors.GEOSException):
            theirs = None
        middle = time.perf_counter()
        try:
            ours = sbft_verdict(points, map_size)
        except UsageError:
            ours = False, "refused"
        seconds[0] += middle - begin
        seconds[1] += time.perf_counter() - middle
        judged += theirs is not None
        stopped += theirs is None
        valid += ours[0]
        differ += ours != theirs if theirs is not None else ours[0]
    return (
        f"{differ} differences ({judged:,} judged, {valid:,} valid; their code stops with an error at "
        f"{stopped:,}, each a difference if ours passes it); slow {seconds[0]:.1f} s, "
        f"fast {seconds[1]:.1f} s"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--roads", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    main(arguments.roads, arguments.seed)
