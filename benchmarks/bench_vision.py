"""How fast drivers that see may go, beside one that knows the road; and the environment's steps per second.

    python benchmarks/bench_vision.py                      a minute of processor time: `make bench`
    python benchmarks/bench_vision.py --minutes 5 --write  the figures of docs/explanation/vision.md

The roads are unseen: their seed and the last description are not those of the training. The flat roads and
the hilly ones are alike from above. All drivers have the same roads, car, world and speeds. Road after road
is driven until the time is over, each by all drivers at all speeds. A failure is put down to a change of
slope where the grade changes by more than 3 % from 5 m behind the car to 15 m ahead of it, in the last 2 s.
"""

import argparse
import os
import time
from collections import defaultdict
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

import roadgpt_gym  # noqa: F401  makes the environment known to Gymnasium
from roadgpt.drive import Drive, simulate
from roadgpt.drive.loading import load_driver
from roadgpt.road import ORACLES, Limits, Road, World
from roadgpt.run import Setup, brief_of, perform
from roadgpt.verdict import judge

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "explanation" / "vision.md"
BEGIN, END = "<!-- measured by benchmarks/bench_vision.py -->", "<!-- end of what was measured -->"

PROMPTS = (
    "a flat road with 3 turns, 200 m long",
    "a hilly road with 3 turns, 200 m long",
    "two hairpins",
)
SEEING = {
    "lane_finder": ROOT / "examples/vision/lane_finder.py:LaneFinder",
    "small_network": ROOT / "examples/vision/small_network.py:SmallNetwork",
}
NAMES = "reference", *SEEING
SPEEDS = 25, 35, 45, 55, 70  # km/h
SEED = 4321
BATCH = 2  # roads of each description, before the time is looked at
PLAIN = Setup(drives=False)
SECONDS = 3.0  # of processor time, for the steps of each environment


@dataclass
class DriveTally:
    """Drives of one driver on roads of one description at one speed."""

    drives: int = 0
    kept: int = 0
    slopes: int = 0
    """Failures where the slope changes."""
    aside: float = 0.0
    """m, the sum over kept drives of the farthest from the lane's middle."""

    def __add__(self, other: "DriveTally") -> "DriveTally":
        return DriveTally(
            self.drives + other.drives,
            self.kept + other.kept,
            self.slopes + other.slopes,
            self.aside + other.aside,
        )


def driven(name: str, kmh: int, road: Road) -> tuple[Drive, World]:
    world = World(limits=Limits(speed_limit=kmh / 3.6, **ORACLES["thesis"]))
    if name not in SEEING:
        return simulate(road, world, name), world
    os.environ["SPEED_KMH"] = str(kmh)
    return simulate(road, world, load_driver(str(SEEING[name]))), world


def added(cell: DriveTally, road: Road, drive: Drive, world: World) -> None:
    cell.drives += 1
    s, t = (np.asarray(drive.columns[name]) for name in ("s", "t"))
    if judge(road, drive, world).kept:
        cell.kept += 1
        cell.aside += float(np.abs(t + world.section.lane_width / 2).max())
        return
    last = s[-100:]  # 2 s
    around = np.clip(last[:, None] + np.arange(-5.0, 15.1, 1.0), 0.0, road.length)
    grades = road.grade(around.ravel()).reshape(around.shape)
    cell.slopes += bool(np.ptp(grades, axis=1).max() > 0.03)


def one(
    index: int, prompt: str, speeds: Sequence[int]
) -> tuple[dict[tuple[str, str, int], DriveTally], float]:
    """All drives on one road, and the seconds of processor time that they took."""
    begun = time.process_time()
    run = perform(brief_of(prompt, World(), PLAIN), SEED, World(), PLAIN, index)
    assert run.road is not None
    assert run.is_valid
    cells = {}
    for name in NAMES:
        for kmh in speeds:
            cell = cells[prompt, name, kmh] = DriveTally()
            added(cell, run.road, *driven(name, kmh, run.road))
    return cells, time.process_time() - begun


def driven_all(roads: int, minutes: float, jobs: int, speeds: Sequence[int]) -> list[str]:
    """The table; it is printed as it grows, for it takes a while."""
    cells: dict[tuple[str, str, int], DriveTally] = defaultdict(DriveTally)
    lines: list[str] = []
    used = 0.0
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for first in range(1, roads + 1, BATCH):
            last = min(first + BATCH - 1, roads)
            tasks = [(index, prompt, speeds) for index in range(first, last + 1) for prompt in PROMPTS]
            for made, seconds in pool.map(one, *zip(*tasks, strict=True)):
                used += seconds
                for key, cell in made.items():
                    cells[key] = cells[key] + cell
            lines = table(cells, last, speeds)
            print("\n".join([*lines, f"{used:.0f} s of processor time\n"]), flush=True)
            if used > 60 * minutes:
                break
    return lines


def table(cells: dict[tuple[str, str, int], DriveTally], count: int, speeds: Sequence[int]) -> list[str]:
    lines = [
        f"| roads ({count} each) | driver | " + " | ".join(f"{kmh} km/h" for kmh in speeds) + " |",
        "|---|---|" + "---|" * len(speeds),
    ]
    for prompt in PROMPTS:
        for name in NAMES:
            row = " | ".join(told(cells[prompt, name, kmh]) for kmh in speeds)
            lines.append(f"| {prompt} | `{name}` | {row} |")
    return lines


def told(cell: DriveTally) -> str:
    said = f"{cell.kept}"
    if cell.kept:
        said += f" ({cell.aside / cell.kept:.2f} m)"
    lost = cell.drives - cell.kept
    return f"{said}; {cell.slopes} of {lost} on a slope's change" if lost else said


def steps(observation: str) -> float:
    """Per second of processor time, resets counted."""
    env: Any = gymnasium.make("roadgpt/LaneKeeping-v0", prompt="a winding road", observation=observation)
    env.reset(seed=1)
    env.step(np.zeros(2, np.float32))
    count, begun = 0, time.process_time()
    action = np.array([0.0, 0.2], np.float32)
    while time.process_time() - begun < SECONDS:
        _, _, terminated, truncated, _ = env.step(action)
        count += 1
        if terminated or truncated:
            env.reset()
    return count / (time.process_time() - begun)


def main() -> None:
    parser = argparse.ArgumentParser(description="Drivers that see, at several speeds.")
    parser.add_argument("--roads", type=int, default=20, help="of each description, at most")
    parser.add_argument("--speeds", type=int, nargs="+", default=SPEEDS, metavar="KMH")
    parser.add_argument("--minutes", type=float, default=1.0, help="of processor time, after which it ends")
    parser.add_argument("-j", "--jobs", type=int, default=1)
    parser.add_argument("--write", action="store_true", help="put the tables into docs/explanation/vision.md")
    given = parser.parse_args()
    lines = driven_all(given.roads, given.minutes, given.jobs, given.speeds)
    rates = {name: steps(name) for name in ("state", "camera")}
    lines += [
        "",
        "## What a step costs",
        "",
        "| observation | steps (40 ms each) per second of one core |",
        "|---|---|",
    ]
    lines += [
        f"| `{name}` | {rate:,.0f}, {rate * 0.04:.0f} times real time |" for name, rate in rates.items()
    ]
    print("\n".join(lines))
    if given.write:
        before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
        after = rest.partition(END)[2]
        text = "\n".join([f"{before}{BEGIN}\n", *lines, f"\n{END}{after}"])
        PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
