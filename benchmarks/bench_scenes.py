"""Exports drives among others as OpenSCENARIO, asks ASAM's checker about them, lets esmini play them, and
says how far everybody is from where the drive had them.

    python benchmarks/bench_scenes.py [count] [--esmini PATH]

esmini 3.6 was built from its sources beside RoadGPT; without it only the checker is asked."""

import argparse
import logging
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from bench_traffic import JUNCTIONS, ROADS, SIGNALS
from exported import asam_says
from roadgpt.drive import Drive
from roadgpt.export import save
from roadgpt.run import Setup, perform
from roadgpt.run.exporting import poses_of
from roadgpt.traffic.actor import HEADING, X, Y

PLANS = [plan for plan in (*SIGNALS, *JUNCTIONS, *ROADS) if not plan.startswith("map")]
DRIVERS = ("reference", "lane_centring", "beamng_like")
STEP = 0.05  # s between two of esmini's poses
REAR_AXLE = (-1.47, 0.0, -0.56)  # m, of the tested car on the ground, from its centre of gravity
SHARE = 0.3  # of a vehicle's length, from its middle to its rear axle
ROLLS = ("car", "van", "truck", "bus", "motorcycle", "bicycle")
PLACE = 11  # columns from a name to x


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("count", nargs="?", type=int, default=30)
    parser.add_argument("--esmini", default=shutil.which("esmini"))
    asked = parser.parse_args()
    logging.disable(logging.INFO)  # ASAM's checker tells of every rule
    issues, own, others, people, ended = 0, [], [], 0, 0
    for number in range(asked.count):
        plan = f"{PLANS[number % len(PLANS)]} && {('medium', 'light')[number % 2]}"
        setup = Setup(reader="plan", driver=DRIVERS[number % len(DRIVERS)])
        run = perform(plan, number + 1, setup=setup)
        if run.drive is None or run.drive.others is None or run.road is None:
            print(f"{plan}: {run.description}")
            continue
        people += len(run.drive.others.actors)
        with tempfile.TemporaryDirectory() as folder:
            save(run.road, folder, ["openscenario"], run.world, "scene", poses_of(run.drive))
            file = Path(folder, "scene.drive.xosc")
            found, ends = asam_says(file)
            issues += len(found) + (ends != {"completed": 17})
            if asked.esmini is None:
                continue
            rows = played(asked.esmini, file)
        last = run.drive["time"][-1]
        ended += max(row[0] for row in rows["Ego"]) >= last - STEP
        off = {name: farthest(run.drive, name, np.array(places)) for name, places in rows.items()}
        own.append(off.pop("Ego"))
        others += off.values()
        print(f"{own[-1] * 100:5.1f} cm  {max(off.values(), default=0) * 100:5.1f} cm  {plan}", flush=True)
    told = f"{ended} played to the end" if asked.esmini else "none played, as esmini is not here"
    print(f"{asked.count} scenes, {people} others: {issues} issues, {told}")
    for who, off in (("tested car", own), ("others", others)):
        if off:
            print(
                f"{who}: at most {max(off) * 100:.1f} cm off, {sum(each > 0.05 for each in off)} above 5 cm"
            )


def played(esmini: str, file: Path) -> dict[str, list[tuple[float, float, float]]]:
    """Time, x and y of the reference point of everybody, by name, as esmini logs them."""
    log = file.with_suffix(".csv")
    play = [esmini, "--osc", str(file), "--headless", "--fixed_timestep", str(STEP), "--disable_stdout"]
    subprocess.run(
        [*play, "--csv_logger", str(log), "--logfile_path", str(file.with_suffix(".log"))],
        check=True, capture_output=True, cwd=file.parent, timeout=600,
    )  # fmt: skip
    found: dict[str, list[tuple[float, float, float]]] = {}
    for line in log.read_text().splitlines()[7:]:
        cells = [cell.strip() for cell in line.split(",")]
        for n, cell in enumerate(cells):
            if re.match(r"[A-Za-z]", cell) and cell not in ("nan", "inf"):
                found.setdefault(cell, []).append(
                    (float(cells[1]), float(cells[n + PLACE]), float(cells[n + PLACE + 1]))
                )
    return found


def farthest(drive: Drive, name: str, rows: np.ndarray) -> float:
    """The largest distance in metres in plan while the drive lasts."""
    time, at = rows[:, 0], rows[:, 1:]
    if name == "Ego":
        angles = [np.unwrap(drive["heading"]), -drive["pitch"], drive["roll"]]
        columns = (np.interp(time, drive["time"], each) for each in (drive["x"], drive["y"], *angles))
        x, y, *angles = columns
        turn = Rotation.from_euler("ZYX", np.stack(angles, -1))
        place = np.stack([x, y], -1) + turn.apply(REAR_AXLE)[:, :2]
    else:
        assert drive.others is not None
        number = next(n for n, each in enumerate(drive.others.actors) if each.name == name.split(",")[0])
        actor, state = drive.others.actors[number], drive.others.at(time)[:, number]
        back = SHARE * actor.size.length if actor.kind in ROLLS else 0.0
        way = np.stack([np.cos(state[:, HEADING]), np.sin(state[:, HEADING])], -1)
        place = state[:, [X, Y]] - back * way
    off = np.hypot(*(at - place).T)[time <= drive["time"][-1] + 1e-6]
    return float(np.nanmax(off)) if np.isfinite(off).any() else 0.0


if __name__ == "__main__":
    main()
