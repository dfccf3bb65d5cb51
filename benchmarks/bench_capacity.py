"""Compares the capacity of a lane with that of SUMO, with the same parameters of the Intelligent Driver
Model: how many vehicles an hour pass a place 160 m ahead of a queue that begins to move.

    python benchmarks/bench_capacity.py SUMO NETCONVERT    the paths of SUMO's programs"""

import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from roadgpt.run import Setup, perform
from roadgpt.traffic import Stage
from roadgpt.traffic import following as f
from roadgpt.traffic.actor import STEP
from roadgpt.traffic.idm import IdmMover

QUEUE, PLACE, LENGTH, SPACING = 60, 600.0, 4.7, 6.7  # vehicles, m, m, m
PLAN = "straight 950 | lanes=1 against=1 map_size=1000"


def flow(times):
    """Vehicles an hour, without the first 10, which still speed up at the place."""
    times = sorted(times)[10:]
    return 3600.0 * (len(times) - 1) / (times[-1] - times[0])


def ours():
    """The flow of our vehicles, and the speed limit."""
    run = perform(PLAN, 1, setup=Setup(reader="plan", drives=False))
    mover = IdmMover(Stage(run.road, run.world, 1), "light", is_filled=False)
    mover.comes_in = False
    mover.start(None)
    lane = int(mover.lanes.begins.nonzero()[0][0])
    for n in range(QUEUE):
        mover.enter(lane, 20.0 + n * SPACING, 0.0)
    rows = mover._rows
    mover._numbers[rows, f.LENGTH : f.BRAKES + 1] = LENGTH, 1.8, 1.0, 50.0, 1.5, 1.5, 2.0
    passed, tick, before = [], 0, mover._numbers[rows, f.S].copy()
    while len(passed) < QUEUE:
        mover.move(tick * STEP, None, np.zeros((0, 7)))
        tick += 1
        now = np.full(QUEUE, np.inf)
        is_there = np.isin(rows, mover._rows)
        now[is_there] = mover._numbers[rows[is_there], f.S]
        passed += [tick * STEP] * int(((before < PLACE) & (now >= PLACE)).sum())
        before = now
    return flow(passed), float(mover.lanes.limit[lane])


def sumos(sumo, netconvert, limit):
    """The flow of SUMO's vehicles."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "n.xml").write_text('<nodes><node id="a" x="0" y="0"/><node id="b" x="950" y="0"/></nodes>')
        (folder / "e.xml").write_text(
            f'<edges><edge id="e" from="a" to="b" numLanes="1" speed="{limit}"/></edges>'
        )
        kind = (
            f'<vType id="c" carFollowModel="IDM" tau="1.5" accel="1.5" decel="2.0" delta="4" minGap="2.0" '
            f'length="{LENGTH}" speedFactor="1" speedDev="0" maxSpeed="50"/><route id="r" edges="e"/>'
        )
        first = f'<stop lane="e_0" endPos="{20.0 + QUEUE * SPACING}" until="400"/>'  # until all have queued
        of = 'type="c" route="r" departSpeed="10"'
        cars = "".join(
            f'<vehicle id="{n}" {of} depart="{4 * n}">{first * (n == 0)}</vehicle>' for n in range(QUEUE)
        )
        (folder / "r.xml").write_text(f"<routes>{kind}{cars}</routes>")
        loop = f'<instantInductionLoop id="d" lane="e_0" pos="{PLACE}" file="d.xml"/>'
        (folder / "a.xml").write_text(f"<additional>{loop}</additional>")
        subprocess.run([netconvert, "-n", "n.xml", "-e", "e.xml", "-o", "net.xml"], cwd=folder, check=True)
        files = ["-n", "net.xml", "-r", "r.xml", "-a", "a.xml", "--step-length", str(STEP), "--end", "900"]
        subprocess.run([sumo, *files, "--time-to-teleport", "-1"], cwd=folder, check=True)
        seen = ET.parse(folder / "d.xml").getroot().iter("instantOut")
        return flow([float(each.get("time")) for each in seen if each.get("state") == "enter"])


def main():
    own, limit = ours()
    if len(sys.argv) < 3:
        print(f"at {limit * 3.6:.0f} km/h: ours {own:.0f} vehicles an hour; without paths SUMO is not asked")
        return
    other = sumos(*sys.argv[1:3], limit)
    told = f"ours {own:.0f}, SUMO's {other:.0f} vehicles an hour: {own / other - 1:+.1%}"
    print(f"at {limit * 3.6:.0f} km/h: {told}")


if __name__ == "__main__":
    main()
