"""Compares the four reference drivers with the program of the European Commission's Joint Research Centre, or
lists the avoidable collisions of a driver in scenarios of the catalogue.

    git clone https://github.com/ec-jrc/JRC-FSM
    python benchmarks/bench_avoidable.py JRC-FSM
    python benchmarks/bench_avoidable.py --driver lane_centring --scenarios '*' --points 6

The cells are those of UN R157's cut-in grid: the tested car drives 20 to 60 km/h by 10, the other 10 to 50
km/h less, 0 to 60 m ahead by 10, and comes sideways with 0.5 to 3.0 m/s by 0.5; cells in which the other
would go backwards are left out. In each cell both programs say whether the two collide. The other's motion
is that of the Joint Research Centre's program, which also lets the careful driver begin when the other
reaches into its lane; the last column counts collisions if it begins as the regulation's text says, 0.4 s
after the other has come 0.375 m out of the middle of its lane. All this is also done with the step of
verdicts, 0.01 s; theirs stays at 0.1 s.
"""

import argparse
import itertools
import sys
import warnings
from collections import Counter
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

from roadgpt.brief.scenarios import LANE_WIDTH, chosen
from roadgpt.road import World
from roadgpt.run import Setup, perform
from roadgpt.verdict.avoidable import FINE
from roadgpt.verdict.careful import DRIVERS, DriverModel, Moment, drive_on

STEP, LENGTH, WIDTH, BESIDE = 0.1, 4.3, 1.9, 3.5  # s, m; the other begins in the middle of the next lane
WANDERS, EVALUATED = 0.375, 0.4  # m, s
THEIRS = {"careful driver": "CC_human_driver"}
CHECKS = {"careful driver": "CC_check_safety_cut_in", "Reg157": "Reg157_check_safety_cut_in"}
Cell = tuple[float, float, float, float]


def cells() -> list[Cell]:
    """Own speed and its speed in m/s, gap in m, speed sideways in m/s."""
    grid = itertools.product(range(20, 61, 10), range(10, 51, 10), range(0, 61, 10), range(1, 7))
    return [(own / 3.6, (own - less) / 3.6, gap, n / 2) for own, less, gap, n in grid if less <= own]


def theirs(driver: DriverModel, cell: Cell, models: Any, movement: Any) -> tuple[bool, Any]:
    """Whether the car of the other program collides, and how the other moved in it."""
    own, its, gap, lateral = cell
    steps, often = 350, 10
    other = movement.create_profile_cutting_in([gap + LENGTH, BESIDE], its, -lateral, steps, often)
    car = movement.create_profile_cutting_in([0, 0], own, 0, steps, often)
    for each in (car, other):
        each.length, each.width = LENGTH, WIDTH
    name = THEIRS.get(driver.said, driver.said)
    check = getattr(models, CHECKS.get(driver.said, f"{name}_check_safety"))
    react = getattr(models, f"{name.split('_')[0]}_react")
    car.cfs = car.pfs = 0
    for i in range(steps - 1):
        movement.control(car, other, often, check, react, i)
    return bool(car.crash), other


def ours(driver: DriverModel, own: float, other: Any, as_text: bool = False, step: float = STEP) -> bool:
    """Whether our driver collides with the other, who moved so; ``as_text``: perceived as R157 says. Between
    the other's steps it moves evenly."""
    names = ("pos_profile_long", "pos_profile_lat", "speed_profile_long", "speed_profile_lat")
    profiles = [np.asarray(getattr(other, name), float) for name in names]
    fine = np.arange(0.0, len(profiles[0]) - 1 + 1e-9, step / STEP)
    along, aside, pace, drift = (np.interp(fine, np.arange(len(each)), each).tolist() for each in profiles)
    wanders = next((i for i, t in enumerate(aside) if t <= BESIDE - WANDERS), len(aside))

    def seen(i: int, place: float, speed: float, gained: float) -> Moment:
        clearance = abs(aside[i]) - WIDTH
        is_perceived = i >= wanders + EVALUATED / step if as_text else clearance <= 0
        return Moment(
            along[i] - place - LENGTH, clearance, 2 * LENGTH, speed, gained, pace[i], -drift[i], is_perceived
        )

    places, _ = drive_on(driver, seen, [own] * len(along), step, own * STEP)
    return any(
        abs(t) < WIDTH and abs(x - place) < LENGTH
        for x, t, place in zip(along[:-1], aside[:-1], places[:-1], strict=True)
    )


def list_avoidable(driver: str, scenarios: str, count: int) -> None:
    """Prints a row for each avoidable collision that is the driver's, and the counts. Each scenario is driven
    with its values as they are named, and at ``count`` points of its standard grid, on its nominal road."""
    counts, drawn = Counter[str](), Random(1)
    print("| scenario | who would have avoided it | verdict |\n|---|---|---|")
    for one in chosen(scenarios):
        points = [each for each in one.points("standard", with_road=True) if not each.fault] if count else []
        for each in {str(point): point for point in [one, *drawn.sample(points, min(count, len(points)))]}:
            setup = Setup(driver=driver, reader="plan", scenario=each)
            run = perform(chosen(each)[0].plan, 1, World().changed(lane_width=LANE_WIDTH), setup)
            by = (run.verdict and run.verdict.avoided_by) or ()
            is_own = run.outcome == "FAIL" and bool(by) and run.verdict and not run.verdict.handed_to
            counts["avoidable" if is_own else run.outcome] += 1
            if is_own:
                print(f"| `{each}` | {', '.join(by)} | {run.description} |", flush=True)
    print(dict(counts))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("checkout", type=Path, nargs="?", help="folder of ec-jrc/JRC-FSM")
    parser.add_argument("--driver", help="list the avoidable collisions of this driver instead")
    parser.add_argument("--scenarios", default="*", help="of the catalogue, as for roadgpt campaign")
    parser.add_argument("--points", type=int, default=0, help="of each scenario's standard grid, drawn")
    given = parser.parse_args()
    if given.driver:
        list_avoidable(given.driver, given.scenarios, given.points)
        return
    if given.checkout is None:
        print("no program of the JRC here: give the folder of ec-jrc/JRC-FSM, or a --driver", file=sys.stderr)
        return
    sys.path.insert(0, str(given.checkout))
    warnings.simplefilter("ignore")  # of its divisions by zero
    from utility import models, movement

    grid = cells()
    print(f"{len(grid)} cells\n{'driver':<16} step   collisions theirs  ours  agree   by the text of R157")
    for driver, step in itertools.product(DRIVERS, (STEP, FINE)):
        told = [theirs(driver, cell, models, movement) for cell in grid]
        moved = [(cell[0], other) for cell, (_, other) in zip(grid, told, strict=True)]
        found = [ours(driver, own, other, step=step) for own, other in moved]
        text = sum(ours(driver, own, other, True, step) for own, other in moved)
        same = [one == each for one, (each, _) in zip(found, told, strict=True)]
        hits = sum(each for each, _ in told)
        print(f"{driver.said:<16} {step:g} s {hits:>17} {sum(found):>5}  {sum(same)} {text:>12} collide")
        for cell, agrees, hit in zip(grid, same, found, strict=True):
            if not agrees:
                own, its, gap, lateral = cell
                said = f"{own * 3.6:.0f} and {its * 3.6:.0f} km/h, {gap:.0f} m, {lateral:g} m/s sideways"
                print(f"    {said}: only {'ours' if hit else 'theirs'} collides")


if __name__ == "__main__":
    main()
