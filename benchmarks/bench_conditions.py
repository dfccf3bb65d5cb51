"""Drives the same scenes under different conditions, and counts in which the tested car touches somebody.

    python benchmarks/bench_conditions.py --scenes 200

Each scene has one road, one seed and one way of the others before they meet the tested car; only the
conditions differ. Who stands behind something that cannot be passed has failed, but touched nobody."""

import argparse
import time
from concurrent.futures import ProcessPoolExecutor

from roadgpt.errors import RoadGPTError
from roadgpt.road import World
from roadgpt.run import Setup, perform

CONDITIONS = [
    "",
    "fog 60",
    "fog 30",
    "fog 15",
    "night",
    "rain 5",
    "low_sun",
    "fog 30; rain 5",
    "night; snow",
    "snow",
]
STRAIGHT = "| len=400"
BENT = "straight 80; turn left 60 r=120; straight 80; turn right 50 r=150; straight 60 | len=400..500"
WIDE = "| lanes=2 against=2 len=500"
SCENES = [
    (STRAIGHT, "barrier ahead gap=150..250"),
    (STRAIGHT, "lost_load ahead gap=150..250"),
    (BENT, "car ahead gap=180..250 v=0"),
    (BENT, "ego v=60; cones ahead gap=150..200"),
    (STRAIGHT, "ego v=50; adult crossing right v=5 impact=50: cross"),
    (STRAIGHT, "adult crossing left v=8 impact=50: cross"),
    (STRAIGHT, "ego v=50; child crossing right v=5 impact=50: cross"),
    (BENT, "ego v=60; animal crossing left v=15 impact=25..75: cross"),
    (STRAIGHT, "animal crossing right v=20 impact=25..75: cross"),
    (STRAIGHT, "ego v=50; bicycle crossing right v=15 impact=50: cross"),
    (STRAIGHT, "car ahead thw=1.5 v=70: brake 6 to=0"),
    (BENT, "ego v=60; truck ahead thw=1 v=60: brake 5 to=10"),
    (WIDE, "car lane left gap=15 dv=-20: cut_in lat=1.5"),
    (WIDE, "car ahead gap=60 v=50; barrier ahead gap=260; medium"),
    (WIDE, "medium"),
    (BENT, "dense"),
    ("straight 100 // crossroads left lights // straight 100", "medium"),
    ("straight 100 // crossroads straight priority // straight 100", "medium"),
    ("straight 100 // roundabout exit=2 // straight 100", "light"),
    ("straight 80 // t_junction right stop // straight 100", "light"),
]


def drive(job):
    """What came of one scene under a condition: whether the car touched somebody, and whether it failed; None
    if it was not driven."""
    number, condition, driver, speed = job
    road, scene = SCENES[number % len(SCENES)]
    plan = f"{road} && {'; '.join(filter(None, [scene, condition]))}"
    try:
        seed, setup = 1 + number // len(SCENES), Setup(reader="plan", driver=driver)
        run = perform(plan, seed, World().changed(speed_limit=speed / 3.6), setup)
    except RoadGPTError as error:
        return number, condition, None, str(error)
    if run.drive is None:
        return number, condition, None, f"{run.outcome}: {run.description}"
    return number, condition, (run.drive.ended == "collision", run.outcome == "FAIL"), run.description


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scenes", type=int, default=len(SCENES))
    parser.add_argument("--driver", default="lane_centring")
    parser.add_argument("--speed", type=float, default=70.0, help="speed limit and first speed, km/h")
    parser.add_argument("--conditions", nargs="*", default=CONDITIONS[1:])
    parser.add_argument("--jobs", type=int, default=2)
    args = parser.parse_args()
    conditions = ["", *args.conditions]
    jobs = [(n, condition, args.driver, args.speed) for n in range(args.scenes) for condition in conditions]
    begun, found = time.perf_counter(), {}
    with ProcessPoolExecutor(args.jobs) as pool:
        for number, condition, came, said in pool.map(drive, jobs):
            found[number, condition] = came
            print(f"{number:3} {condition or 'clear day':14} {came} {said[:100]}", flush=True)
    told = f"{args.scenes} scenes, {args.driver}, {args.speed:g} km/h, {time.perf_counter() - begun:.0f} s"
    print(
        f"\n{told}\n| conditions | driven | touched | here, not on a clear day | the other way round | FAIL |"
    )
    print("|---|---|---|---|---|---|")
    for condition in conditions:
        both = [(found[n, ""], found[n, condition]) for n in range(args.scenes)]
        both = [pair for pair in both if None not in pair]
        hits = [(day[0], here[0]) for day, here in both]
        counts = len(both), sum(hit for _, hit in hits), hits.count((False, True)), hits.count((True, False))
        fails = sum(here[1] for _, here in both)
        print(f"| {condition or 'clear day'} | {' | '.join(map(str, counts))} | {fails} |")


if __name__ == "__main__":
    main()
