"""Whole drives: how they start, how each of them ends, and that they can be repeated."""

import hashlib
import math
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import roadgpt
from road_parts import road_of
from roadgpt.drive import COLUMNS, Command, Drive, Simulator, simulate
from roadgpt.drive.simulators.mujoco import ETK_LIKE, MujocoSimulator, Vehicle
from roadgpt.errors import PartError, SimulationError
from roadgpt.road import CrossSection, Limits, Road, World

WORLD = World()


class Follows:
    """Steers towards a point of its lane ahead, at a steady speed: enough to stay on any gentle road."""

    def __init__(self, speed=10.0, offset=-2.0):
        self.speed, self.offset = speed, offset

    def steer(self, view):
        x, y, _ = view.road.at(min(view.s + 7.0, view.road.length), self.offset).tolist()
        bearing = math.atan2(y - view.y, x - view.x) - view.heading
        off = math.remainder(bearing, math.tau)
        want = 0.4 * (self.speed - view.speed)
        return Command(math.atan(2 * 2.83 * math.sin(off) / 7.0), max(want, 0.0), max(-want, 0.0))


class Does:
    """The same command for ever."""

    def __init__(self, *command):
        self.command = Command(*command)

    def steer(self, view):
        return self.command


def drive(road, driver, world=WORLD, **options) -> Drive:
    return MujocoSimulator().simulate(road, world, driver, seed=3, **options)


BEND = road_of((30, 0, 5), (45, 60, -8), (35, 0, 12), (40, -55, 0), start=(60, 60, 5))


def test_the_simulator_keeps_its_protocol_and_is_found_by_name():
    assert isinstance(MujocoSimulator(), Simulator)
    done = simulate(BEND, WORLD, Follows(), seed=11)
    assert (done.driver, done.simulator, done.seed, done.ended) == ("Follows", "mujoco", 11, "goal")
    with pytest.raises(PartError, match="no simulator called 'chrono'"):
        simulate(BEND, WORLD, Follows(), simulator="chrono")


def test_it_starts_like_roadgpt():
    done = drive(BEND, Follows())
    x, y, z = BEND.at(2.5, -2.0)
    assert (done["x"][0], done["y"][0]) == (pytest.approx(x, abs=0.06), pytest.approx(y, abs=0.06))
    assert done["z"][0] == pytest.approx(z + ETK_LIKE.cg_height, abs=0.05)
    assert done["heading"][0] == pytest.approx(math.radians(20), abs=1e-3)
    assert done["pitch"][0] == pytest.approx(math.atan(0.05), abs=6e-3)
    assert done["speed"][0] < 1e-3
    assert done["outside"][0] == 0.0
    assert (done["time"][0], done["s"][0]) == (0.0, pytest.approx(2.5, abs=0.06))


def test_a_driver_that_follows_the_lane_arrives():
    done = drive(BEND, Follows())
    assert done.ended == "goal"
    end = BEND.at(BEND.length)
    assert math.hypot(done["x"][-1] - end[0], done["y"][-1] - end[1]) < 8.0
    assert math.hypot(done["x"][-2] - end[0], done["y"][-2] - end[1]) >= 8.0
    assert done.max_outside < 0.2
    # The pose and the road coordinates tell of the same places.
    s, t = BEND.locate(done["x"], done["y"])
    np.testing.assert_allclose(done["s"], s, atol=2e-3)
    np.testing.assert_allclose(done["t"], t, atol=2e-3)
    above = done["z"] - BEND.at(done["s"])[:, 2]
    assert above.min() > 0.45
    assert above.max() < 0.65
    np.testing.assert_allclose(np.diff(done["time"]), 0.02, atol=1e-9)
    assert list(done.columns) == list(COLUMNS)
    assert all(np.isfinite(done[name]).all() for name in COLUMNS)


def test_the_columns_agree_with_each_other():
    done = drive(BEND, Follows())
    heading = np.unwrap(done["heading"])
    np.testing.assert_allclose(np.gradient(heading, 0.02)[1:-1], done["yaw_rate"][1:-1], atol=0.03)
    way = np.stack([np.gradient(done[name], 0.02) for name in "xyz"])
    np.testing.assert_allclose(np.linalg.norm(way, axis=0)[1:-1], done["speed"][1:-1], atol=0.1)
    # Speeds along the car's own axes are the same speed, and turned by its attitude they tell the climb.
    own = np.stack([done[name] for name in ("vx", "vy", "vz")])
    np.testing.assert_allclose(np.linalg.norm(own, axis=0), done["speed"], atol=1e-9)
    pitch, roll = done["pitch"], done["roll"]
    climb = own[0] * np.sin(pitch) + np.cos(pitch) * (own[1] * np.sin(roll) + own[2] * np.cos(roll))
    np.testing.assert_allclose(climb[1:-1], np.gradient(done["z"], 0.02)[1:-1], atol=0.02)
    # The nose goes up where the road does, when it is driven at a steady speed.
    on_hill = (done["s"] > 92) & (done["s"] < 105)
    assert np.degrees(done["pitch"][on_hill]).mean() == pytest.approx(math.degrees(math.atan(0.12)), abs=1.0)


def test_who_never_steers_leaves_the_lane_and_the_drive_ends_there():
    done = drive(BEND, Does(0.0, 0.4))
    assert done.ended == "out_of_lane"
    assert done["outside"][-1] > WORLD.limits.oob_tolerance
    assert done["outside"][:-1].max() <= WORLD.limits.oob_tolerance
    loose = drive(BEND, Does(0.0, 0.4), World(limits=Limits(oob_tolerance=0.95)))
    assert done.duration < loose.duration


def test_keep_driving_goes_on_to_the_fall():
    done = drive(BEND, Does(0.0, 0.4), keep_driving=True)
    assert done.ended == "fell"
    assert done.max_outside == 1.0
    assert done["z"][-1] - BEND.at(done["s"][-1])[2] < 0.56 - 2.0 or abs(done["roll"][-1]) > math.radians(50)


def test_beyond_the_edge_the_car_falls_freely():
    vehicle = Vehicle.on(road_of((120, 0, 0)), World(section=CrossSection(shoulder=0.0)))
    vehicle.put(60.0, -8.0)  # 4 m beside the road: nothing there
    heights = [vehicle.see()["z"]]
    for _ in range(20):
        vehicle.move(0.0, 0.0, 0.0)
        heights.append(vehicle.see()["z"])
    # Level as it is, it moves towards its floor.
    seen = vehicle.see()
    assert seen["vz"] == pytest.approx((heights[-1] - heights[-2]) / 0.02 - 9.81 * 0.01, abs=0.02)
    assert math.hypot(seen["vx"], seen["vy"]) < 0.2
    fall = np.diff(heights, 2) / 0.02**2
    np.testing.assert_allclose(fall, -9.81, atol=0.06)  # air, and springs that still open
    assert vehicle.mishap


def test_a_roll_over_is_a_fall():
    vehicle = Vehicle.on(road_of((120, 0, 0)), World(section=CrossSection(shoulder=0.0)))
    vehicle.put(60.0, -4.3)  # the centre of gravity is beyond the edge
    for _ in range(200):
        vehicle.move(0.0, 0.0, 1.0)
        if vehicle.mishap:
            break
    assert vehicle.mishap


def test_who_does_not_move_is_stuck_after_10_s():
    done = drive(BEND, Does(0.0, 0.0, 1.0))
    assert done.ended == "stuck"
    assert done.duration == pytest.approx(10.0, abs=0.021)


def test_who_creeps_runs_out_of_time():
    road = road_of((40, 0, 0))
    done = drive(road, Follows(0.35))
    assert done.ended == "timeout"
    assert done.duration == pytest.approx(40 / 2 + 30, abs=0.05)


def test_a_road_that_ends_beside_its_start_has_to_be_driven():
    # SBFT ends such a drive at once, because the start is within 8 m of the end; we ask for the way round.
    loop = road_of((150, 345, 0), start=(120, 120, 0), theta=0)
    ring = Road.through(
        [(100 + 25 * math.cos(a), 100 + 25 * math.sin(a)) for a in np.linspace(0, math.tau * 0.98, 40)]
    )
    for road in (loop, ring):
        start, end = road.at(2.5, -2.0), road.at(road.length)
        assert math.dist(start[:2].tolist(), end[:2].tolist()) < 8.0
        done = drive(road, Follows(8.0), keep_driving=True)
        assert done.ended == "goal"
        assert done["s"][-1] > 0.8 * road.length


SCRIPT = """
import hashlib, sys
from pathlib import Path
sys.path[:0] = [{folder!r}, {folder!r} + "/.."]
from test_simulator import Follows, drive, road_of
done = drive(road_of((22, 0, 8), (14, 30, -6)), Follows(9.0))
print(hashlib.sha256(done.to_bytes()).hexdigest())
Path({path!r}).write_bytes(done.to_bytes())
"""


def in_another_process(path, **environment):
    script = SCRIPT.format(folder=str(Path(__file__).parent), path=str(path))
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | environment,
        timeout=240,
    )
    return done.stdout.strip(), Drive.load(path)


def test_without_numba_the_same_drive_comes_out(tmp_path):
    here = drive(road_of((22, 0, 8), (14, 30, -6)), Follows(9.0))
    _, plain = in_another_process(tmp_path / "plain.npz", ROADGPT_NO_NUMBA="1")
    assert plain.ended == here.ended
    assert len(plain) == len(here)
    for name in COLUMNS:
        np.testing.assert_allclose(plain[name], here[name], atol=1e-6)


def test_another_process_gives_the_same_bytes(tmp_path):
    there, done = in_another_process(tmp_path / "drive.npz")
    assert done.ended == "goal"
    here = drive(road_of((22, 0, 8), (14, 30, -6)), Follows(9.0))
    assert hashlib.sha256(here.to_bytes()).hexdigest() == there


HALVES = """
import numpy as np
from roadgpt.scene.shade import STEPS, to_screen
table, out = np.linspace(0, 255, STEPS).astype(np.uint8), np.zeros((1, 1, 3), np.uint8)
to_screen(np.full((1, 1, 3), 0.5, np.float32), table, out)
print(out.tolist(), len(to_screen.signatures))
"""


def test_where_no_cache_can_be_written_code_is_compiled_all_the_same(tmp_path):
    # A copy of the package in which files stand where numba would make its folders.
    source = Path(roadgpt.__file__).parent
    shutil.copytree(source, tmp_path / "src" / "roadgpt", ignore=shutil.ignore_patterns("__pycache__"))
    for folder in [f for f in (tmp_path / "src").rglob("*") if f.is_dir()]:
        (folder / "__pycache__").write_text("")
    (tmp_path / "home").write_text("")
    blocked = {name: str(tmp_path / "home") for name in ("HOME", "XDG_CACHE_HOME")}
    done = subprocess.run(
        [sys.executable, "-c", HALVES],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | blocked | {"PYTHONPATH": str(tmp_path / "src"), "NUMBA_CACHE_DIR": ""},
    )
    assert done.stdout == "[[[127, 127, 127]]] 1\n"


def test_a_car_that_makes_no_sense_is_told_so_and_leaves_no_log(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    broken = MujocoSimulator(replace(ETK_LIKE, drag_area=math.nan))
    with pytest.raises(SimulationError, match="the physics became unstable at"):
        broken.simulate(BEND, WORLD, Follows(), seed=0)
    assert not list(tmp_path.iterdir())


def test_the_view_shows_what_the_drive_records():
    seen = []

    class Looks(Follows):
        def steer(self, view):
            seen.append(view)
            return super().steer(view)

    done = drive(BEND, Looks())
    assert len(seen) == len(done) - 1
    for name in ("x", "y", "z", "heading", "speed", "yaw_rate", "s", "t", "steer", "vx", "vy"):
        np.testing.assert_array_equal([getattr(view, name) for view in seen], done[name][:-1])
    np.testing.assert_allclose([view.time for view in seen], done["time"][:-1], atol=1e-9)
    assert seen[0].road is BEND
    assert seen[0].world is WORLD
    assert seen[0].dt == 0.02
