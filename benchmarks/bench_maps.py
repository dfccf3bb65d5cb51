"""How whole maps of other tools are read: a folder of OpenDRIVE files, against a second, slow reader.

    python benchmarks/bench_maps.py FOLDER                  every .xodr below it
    python benchmarks/bench_maps.py FOLDER --routes 20      and so many drives on random routes of each map

For each map: how far the reference lines lie from those of the second reader, which steps of traffic from
lane to lane only one of both knows, and how many random routes the driver ``reference`` keeps at 50 km/h. No
map comes with this benchmark.
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))

from shapely import LineString, points

from roadgpt import World, judge, simulate
from roadgpt.errors import UsageError
from roadgpt.network import ImportedMap, Route, read_map
from roadgpt.network.lanes import Lanes, lanes_of
from roadgpt.network.routing import random_routes
from slow_opendrive import Movement, SlowMap

AT = 0.2  # m between the places of a line that are compared
SAME = 0.1  # m, between the ends of the same step of traffic


def away(read: ImportedMap, slow: SlowMap) -> list[float]:
    """For each road of the file, how far its line is from that of the second reader at most, in metres."""
    found = []
    for name, numbers in read.roads.items():
        line = LineString(slow.lines[name][:, 1:3])
        worst = 0.0
        for number in numbers:
            plan = read.network.road(number).road.plan
            s = np.linspace(0.0, plan.length, max(3, int(plan.length / AT)))
            worst = max(worst, float(line.distance(points(plan.at(s))).max()))
        found.append(worst)
    return found


def movements(lanes: Lanes, read: ImportedMap) -> list[Movement]:
    """The steps of traffic of a network, as those of the second reader: not those from one part of a road of
    the file to the next part of it."""
    found = []
    file_of = {number: name for name, numbers in read.roads.items() for number in numbers}
    for lane in lanes:
        if lane.member.junction is not None:
            continue
        for each in lane.successors:
            goals = [each] if lanes[each].member.junction is None else lanes[each].successors
            for goal in goals:
                parts = read.roads[file_of[lane.id.road]]
                onwards = parts.index(lane.id.road) + (1 if lane.is_along else -1)
                if 0 <= onwards < len(parts) and goal.road == parts[onwards]:
                    continue
                ends = lane.at(lane.length)[:2].tolist(), lanes[goal].at(0.0)[:2].tolist()
                found.append(Movement(*(tuple(each) for each in ends)))
    return found


def unlike(one: list[Movement], other: list[Movement]) -> int:
    """How many steps of ``one`` are none of ``other``."""
    if not one or not other:
        return len(one)
    a, b = (np.array([(*each.before, *each.after) for each in some]) for some in (one, other))
    return sum(float(np.abs(b - row).max(axis=1).min()) > SAME for row in a)


def drives(read: ImportedMap, lanes: Lanes, count: int) -> tuple[int, list[str]]:
    """How many of the random routes are kept, and what is said of the others."""
    world, kept, failed = World().changed(speed_limit=50 / 3.6), 0, []
    for legs in random_routes(lanes, count, 1):
        try:
            route = Route.along(read.network, legs).on_ground()
        except UsageError as error:
            failed.append(str(error))
            continue
        verdict = judge(route, simulate(route, world, "reference", seed=1), world)
        kept += verdict.kept
        if not verdict.kept:
            failed.append(f"{verdict.description}; {tightest(route, verdict.at_s or 0.0)}")
    return kept, failed


def tightest(route: Route, station: float) -> str:
    """What bends the most within 10 m of a station: the least radius of the line, the largest step aside."""
    s = np.arange(max(station - 10, 0), min(station + 10, route.length), 0.01)
    radius = 1 / max(np.abs(route.curvature(s)).max(), 1e-9)
    aside = np.abs(np.diff(route.profile.edges(s).left)).max()
    return f"the least radius there is {radius:.2f} m, and the lane's edge steps aside by {aside:.2f} m"


def main() -> None:
    """Prints one line for each map, and the sums."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("folder", type=Path, nargs="?")
    options.add_argument("--routes", type=int, default=0)
    given = options.parse_args()
    if given.folder is None:
        print("no maps here: give their folder", file=sys.stderr)
        return
    if not (paths := sorted(given.folder.rglob("*.xodr"))):
        sys.exit(f"no map (.xodr) in {given.folder} or below it")
    lines, whole, same, maps, kept, driven = [], 0, 0, 0, 0, 0
    for path in paths:
        begin = time.perf_counter()
        try:
            read = read_map(path)
        except UsageError as error:
            print(f"{path.name}: refused: {error}")
            continue
        seconds = time.perf_counter() - begin
        lanes, slow = lanes_of(read.network), SlowMap(path)
        far, own, others = away(read, slow), movements(lanes, read), [*slow.movements()]
        lacking, more = unlike(others, own), unlike(own, others)
        lines += far
        maps += 1
        whole += lacking == 0
        same += lacking == more == 0
        said = f"{path.name}: {len(far)} roads, {len(lanes)} lanes, {seconds:.1f} s"
        said += f"; lines {1000 * max(far):.2f} mm; steps {len(others)}, lacking {lacking}, more {more}"
        if given.routes and read.network.junctions:
            good, failed = drives(read, lanes, given.routes)
            kept, driven = kept + good, driven + good + len(failed)
            said += f"; kept {good} of {good + len(failed)}" + "".join(f"\n    {each}" for each in failed)
        print(said, flush=True)
    shares = [f"{100 * np.mean(np.array(lines) <= most / 1000):.1f} % within {most} mm" for most in (1, 2)]
    print(f"{maps} maps, {len(lines)} roads: {', '.join(shares)}")
    print(f"all steps on {whole} maps, and no others on {same}")
    if driven:
        print(f"kept {kept} of {driven} routes")


if __name__ == "__main__":
    main()
