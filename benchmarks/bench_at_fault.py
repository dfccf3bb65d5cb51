"""Drives many different routes among others, and counts collisions and whose fault they were.

python benchmarks/bench_at_fault.py 500                     reference, also with closed eyes
python benchmarks/bench_at_fault.py 100 --drivers lane_centring --flow light"""

import argparse
import time
from collections import Counter

from drawn_routes import drawn_routes
from roadgpt.drive import Command, View, simulate
from roadgpt.drive.drivers.reference import Reference
from roadgpt.errors import RoadGPTError
from roadgpt.verdict import judge


class Blind(Reference):
    """Drives as ``reference`` would alone on the road."""

    def steer(self, view: View) -> Command:
        return super().steer(view._replace(others=(), lights=()))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("count", nargs="?", type=int, default=100)
    parser.add_argument("--drivers", default="reference,blind")
    parser.add_argument("--flow", default="medium")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    drivers = asked.drivers.split(",")
    counts = {driver: Counter[str]() for driver in drivers}
    begun = time.process_time()
    for number, drawn in enumerate(drawn_routes(asked.count, asked.seed)):
        world = drawn.world.changed(scene=asked.flow, speed_limit=50 / 3.6)
        for driver, count in counts.items():
            try:
                drive = simulate(drawn.route, world, Blind() if driver == "blind" else driver, number)
            except RoadGPTError as error:
                count["no drive"] += 1
                print(f"{driver}: {drawn.plan}: {error}", flush=True)
                continue
            verdict = judge(drawn.route, drive, world)
            hits = [each.contact for each in verdict.incidents or () if each.contact is not None]
            count["driven"] += 1
            count[f"{verdict.outcome} {verdict.cause or ''}".strip()] += 1
            count["collision"] += bool(hits)
            count["collision at fault"] += bool(verdict.is_at_fault)
            if hits and driver != "blind":
                print(f"{driver}, seed {number}: {drawn.plan}: {verdict.description}", flush=True)
    for driver, count in counts.items():
        print(driver, dict(count))
    print(f"{time.process_time() - begun:.0f} s of processor time")


if __name__ == "__main__":
    main()
