"""Lets traffic drive on many networks, and counts collisions among the others, who leave again, and who is
stuck.

    python benchmarks/bench_traffic.py --hours 1000                light and medium on 50 networks
    python benchmarks/bench_traffic.py --hours 100 --flow dense    dense on 20 networks without unsignalled
    junctions
    python benchmarks/bench_traffic.py --speed                     speed of drives among others, on one core

Collisions are found by shapely on the boxes of everybody, every 0.1 s. Stuck is who has stood at one place,
first in line, for 30 s with no light against it and nobody in the junction ahead. These are added up over
reds, as no green lasts 30 s."""

import argparse
import itertools
import sys
import time
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import shapely
from scipy.spatial import cKDTree

from roadgpt.drive import simulate
from roadgpt.geometry.boxes import corners
from roadgpt.run import Setup, perform
from roadgpt.traffic import Stage
from roadgpt.traffic.following import RED
from roadgpt.traffic.idm import IdmMover

ROADS = [
    "| len=400",
    "turn x3 | len=500",
    "| lanes=2 against=2 len=500",
    "turn left r100; straight 200; turn right r80 | lanes=2 against=2",
    "| lanes=3 oneway len=600 motorway",
]
JUNCTIONS = [
    "straight 100 // crossroads left // straight 100",
    "straight 100 // crossroads straight priority // straight 100",
    "straight 100 // crossroads right stop // straight 100",
    "straight 100 // crossroads left stop all_way // straight 100",
    "straight 100 // crossroads straight yield skew // straight 100",
    "straight 100 // t_junction left // straight 100",
    "straight 100 // t_junction right stop // straight 100",
    "straight 100 // t_junction straight priority // straight 100",
    "straight 100 // t_junction left yield // straight 100",
    "straight 100 // y_junction left // straight 100",
    "straight 100 // star arms=5 left // straight 100",
    "straight 100 // roundabout exit=2 // straight 100",
    "straight 100 // roundabout exit=1 arms=3 // straight 100",
    "straight 100 // roundabout mini exit=3 arms=4 // straight 100",
    "straight 100 // roundabout exit=2 large lanes=2 // straight 100",
    "straight 80 // crossroads left // straight 60 // t_junction right // straight 60",
    "straight 80 // t_junction left // straight 60 // roundabout exit=2 // straight 60",
    "straight 80 // crossroads left || left_hand",
    "straight 80 // roundabout exit=2 || left_hand",
    "| lanes=2 len=300 motorway // diverge ramp len=100",
    "merge ramp // | lanes=2 len=400 motorway",
    "merge main // | lanes=2 len=400 motorway // diverge main // | len=200",
    "| lanes=2 len=200 // lane_drop // straight 150",
    "straight 150 // lane_gain // | len=200",
    "map columns=2 rows=2",
    "map columns=3 rows=2 stop",
    "map junction x4 dead_ends=4",
    "map t_junction x3 dead_ends=3",
    "straight 100 // crossroads left crosswalk // straight 100",
    "turn left r60 // crossroads straight // turn right r60",
]
SIGNALS = [
    "straight 100 // crossroads left lights // straight 100",
    "straight 100 // crossroads straight lights crosswalk // straight 100",
    "straight 100 // t_junction left lights // straight 100",
    "straight 100 // star arms=5 left lights // straight 100",
    "straight 80 // crossroads left lights // straight 60 // t_junction right lights // straight 60",
    "crossroads left lights turn_lane=left // straight 100",
    "| lanes=2 against=2 len=150 // crossroads straight lights // | lanes=2 against=2 len=150",
    "map columns=2 rows=2 lights",
    "map columns=3 rows=3 lights",
    "| lanes=2 len=300 motorway // diverge main len=150",
    "| lanes=2 against=2 len=150 // crossroads left lights // | lanes=2 against=2 len=150",
    "straight 100 // y_junction left lights // straight 100",
    "straight 100 // crossroads right lights || left_hand",
    "turn x2 // crossroads left lights // turn x2",
    "straight 100 // roundabout exit=2 lights // straight 100",
]
OPEN_DENSE = [*ROADS, *SIGNALS]
FLOWING = [*ROADS, *JUNCTIONS, *SIGNALS]
NEAR = 12.5  # m, between the middles of boxes that may overlap: the longest diagonal
INFLOW, EMPTYING, PATIENCE = 1800, 900, 30.0  # s


def hits(states, sizes):
    """Pairs of boxes that overlap."""
    there = np.flatnonzero(~np.isnan(states[:, 0]))
    pairs = cKDTree(states[there, :2]).query_pairs(NEAR, output_type="ndarray") if len(there) > 1 else []
    if not len(pairs):
        return set()
    own = np.unique(pairs)
    rows = there[own]
    outlines = corners(states[rows, :2], states[rows, 3], np.array([sizes[n] for n in rows]).reshape(-1, 3))
    boxes = dict(zip(own, shapely.polygons(outlines), strict=True))
    meet = shapely.intersects([boxes[a] for a, _ in pairs], [boxes[b] for _, b in pairs])
    return {(int(there[a]), int(there[b])) for a, b in pairs[meet]}


def waits_without_reason(mover):
    """The rows of those who stand first in line with no light against them and nobody in the junction
    ahead."""
    f = sys.modules["roadgpt.traffic.following"]
    whole, numbers, ways, lanes = mover._whole, mover._numbers, mover._ways, mover.lanes
    rows = [row for row in range(1, len(whole)) if whole[row, f.STATE] == f.DRIVES]
    inside = {int(lanes.junction[ways[row, whole[row, f.AT]]]) for row in rows}
    found = []
    for row in rows:
        lane = int(ways[row, whole[row, f.AT]])
        left = lanes.length[lane] - numbers[row, f.S]
        ahead = any(
            other != row
            and ways[other, whole[other, f.AT]] == lane
            and numbers[other, f.S] > numbers[row, f.S]
            for other in rows
        )
        onward = lanes.onward[lanes.onward_of[lane] : lanes.onward_of[lane + 1]]
        junctions = {int(lanes.junction[each]) for each in onward}
        if numbers[row, f.V] < f.STANDING and left < 12 and not ahead and not junctions & inside:
            found.append(row)
    return found


def drive(job):
    plan, flow, seed, seconds = job
    run = perform(plan, seed, setup=Setup(reader="plan", drives=False))
    if run.road is None or run.findings:
        return plan, flow, 0.0, [], [], 0, 0, run.description
    mover = IdmMover(Stage(run.road, run.world, seed), flow)
    states = mover.start(None)
    hours, found, stood, stuck, spent = 0.0, [], {}, [], 0.0
    nobody = np.zeros((0, 7))
    for tick in itertools.count():
        at = tick * 0.1
        mover.comes_in = at < seconds
        begun = time.process_time()
        states = mover.move(at, None, nobody)
        spent += time.process_time() - begun
        hours += mover.vehicles / 36000
        for a, b in hits(states, [each.size for each in mover.actors]):
            found.append((round(at, 1), mover.actors[a].name, mover.actors[b].name))
        if tick % 10 == 0:
            lights = [mover.lights.shown(end, at) for end in mover._ends]
            rows = mover._rows.tolist()
            red = {row for row in rows if lights[mover._ways[row, mover._whole[row, 0]]] == RED}
            there = {*waits_without_reason(mover)} - red
            places = {row: (mover._whole[row, 0], round(mover._numbers[row, 0], 1)) for row in rows}
            stood = {
                (row, place): stood.get((row, place), 0) + (row in there)
                for row, place in places.items()
                if row in there or row in red
            }
            stuck += [(round(at), row) for row in there if stood[row, places[row]] == PATIENCE]
        if (at > seconds and not mover.vehicles) or at > seconds + EMPTYING:
            break
    return (
        plan,
        flow,
        hours,
        found,
        stuck,
        mover.vehicles,
        spent,
        f"{len(mover.actors)} came, {sum(mover.waits.values())} wait",
    )


def speed(seed):
    """Drives on a road of 1 km with 2+2 lanes, alone and among others: the best of six, in processor time."""
    for flow in ("none", "light", "medium", "dense"):
        plan = "| lanes=2 against=2 len=1000" + f" && {flow}" * (flow != "none")
        run = perform(plan, seed, setup=Setup(reader="plan", drives=False))
        best = np.inf
        for _ in range(7):  # the first one may compile
            begun = time.process_time()
            one = simulate(run.road, run.world, "pure_pursuit", seed=seed)
            best = min(best, time.process_time() - begun)
        there = 0.0 if one.others is None else (~np.isnan(one.others.states[..., 0])).sum(axis=1).mean()
        print(f"{flow:6} {there:5.1f} others: {one.duration / best:4.0f} times real time", flush=True)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--hours", type=float, default=100.0, help="vehicle hours")
    parser.add_argument("--flow", choices=("dense",), help="dense instead of light and medium")
    parser.add_argument("--seconds", type=float, default=INFLOW)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--speed", action="store_true", help="only how fast drives among others are")
    args = parser.parse_args()
    if args.speed:
        speed(args.seed)
        return
    plans = OPEN_DENSE if args.flow else FLOWING
    flows = [args.flow] if args.flow else ["light", "medium"]
    jobs = ((p, f, s, args.seconds) for s in itertools.count(args.seed) for p in plans for f in flows)
    hours = collisions = caught = left = 0
    with ProcessPoolExecutor(args.jobs) as pool:
        while hours < args.hours:
            for plan, flow, own, found, stuck, there, spent, said in pool.map(
                drive, itertools.islice(jobs, len(plans) * len(flows))
            ):
                hours, left = hours + own, left + there
                collisions, caught = collisions + len(found), caught + len(stuck)
                told = f"{len(found)} hits {len(stuck)} stuck {there} left {spent:6.1f} s {said}"
                print(f"{own:7.2f} h {flow:6} {told}: {plan} {found[:3]} {stuck[:3]}", flush=True)
    told = f"{collisions} collisions, {caught} stuck, {left} not left after 15 minutes"
    print(f"{hours:.0f} vehicle hours: {told}")


if __name__ == "__main__":
    main()
