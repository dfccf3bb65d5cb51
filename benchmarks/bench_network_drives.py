"""Which share of routes through junctions the drivers keep, by speed limit and friction, and how fast it is.

    python benchmarks/bench_network_drives.py [ROUTES] [DRIVER ...] [--drawn]

The routes have one to four T- and Y-junctions, crossroads, stars and roundabouts; they are those designs of
``tests/network/random_designs.py`` whose roads do not overlap. With ``--drawn`` they are drawn from the
grammars of descriptions instead, with lanes, ramps, signs, grades and traffic on the left. Speed is simulated
time per CPU time of the whole drive, with all that is prepared for it.
"""

import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import combinations, count
from pathlib import Path

import numpy as np
import shapely

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from drawn_routes import drawn_routes
from network.random_designs import random_design
from roadgpt.drive import simulate
from roadgpt.network import Network, Route, build_route
from roadgpt.network.paved import ribbon
from roadgpt.road import World, read_design
from roadgpt.verdict import judge

DRIVERS = ("reference", "beamng_like")
LIMITS, FRICTIONS, ORACLE = (50.0, 70.0), (1.0, 0.6), "thesis"
TOUCH = 1.0  # m^2, that two roads which meet at a junction may share


def overlaps(network: Network) -> bool:
    """Returns whether roads or junctions of a network that do not belong together lie on each other."""
    parts = [ribbon(each.road) for each in network.plain_roads if each.id not in network.roundabout_of]
    for _, junctions in network.nodes:
        ways = [network.road(way.road).road for each in junctions for way in each.connections]
        ring = network.roundabout_of.get(junctions[0].id)
        ways += [] if ring is None else [network.road(number).road for number in ring.ring]
        parts.append(shapely.union_all([ribbon(way).buffer(0) for way in ways]))
    return any(not part.is_valid for part in parts) or any(
        one.intersection(other).area > TOUCH for one, other in combinations(parts, 2)
    )


def routes(number: int) -> Iterator[Route]:
    """Yields this many routes, always the same."""
    for seed in count():
        if not number:
            return
        route = build_route(read_design(random_design(seed))[0], World())
        if not overlaps(route.network):
            number -= 1
            yield route.on_ground()


def drive_all(them: Sequence[tuple[Route, World]], driver: str, limit: float, friction: float) -> None:
    """Prints how many routes a driver keeps under one speed limit and friction."""
    causes: Counter[str] = Counter()
    incidents: Counter[str] = Counter()
    speeds, rings = [], []
    for n, (route, usual) in enumerate(them):
        world = usual.changed(speed_limit=limit / 3.6, friction=friction, oracle=ORACLE)
        begun = time.process_time()
        drive = simulate(route, world, driver)
        speeds.append(drive.duration / (time.process_time() - begun))
        for way in route.passages:
            inside = (drive["s"] > way.start) & (drive["s"] < way.end)
            if way.entered.kind == "roundabout" and inside.any():
                rings.append(3.6 * drive["speed"][inside].min())
        verdict = judge(route, drive, world)
        causes[verdict.cause or "kept"] += 1
        incidents.update({each.kind for each in verdict.incidents or ()})
        if verdict.cause and "-v" in sys.argv:
            print(f"  {n}: {route}: {verdict.description}")
    kept = causes.pop("kept", 0)
    slowest = f"{min(rings):.1f} km/h (median {np.median(rings):.1f})" if rings else "-"
    print(
        f"{driver}, {limit:g} km/h, friction {friction:g}, oracle {ORACLE}: {kept} of {len(them)} kept "
        f"({100 * kept / len(them):.1f} %), fails: {dict(causes)}; routes with incidents: "
        f"{dict(sorted(incidents.items()))}; least speed in {len(rings)} rings {slowest}; "
        f"{np.median(speeds):.0f} times real time per core",
        flush=True,
    )


def main(number: int = 500, *drivers: str) -> None:
    """Prints a line for each driver, speed limit and friction."""
    drawn = ((each.route.on_ground(), each.world) for each in drawn_routes(number, seed=1))
    them = list(drawn if "--drawn" in sys.argv else ((route, World()) for route in routes(number)))
    kinds = Counter(kind for route, _ in them for kind, _ in route.network.nodes)
    lengths = [route.length for route, _ in them]
    print(f"{number} routes, {np.median(lengths):.0f} m (median), junctions: {dict(kinds.most_common())}")
    simulate(*them[0], "reference")  # compiles
    for driver in drivers or DRIVERS:
        for limit in LIMITS:
            for friction in FRICTIONS:
                drive_all(them, driver, limit, friction)


if __name__ == "__main__":
    given = [each for each in sys.argv[1:] if each not in ("-v", "--drawn")]
    main(*map(int, given[:1]), *given[1:])
