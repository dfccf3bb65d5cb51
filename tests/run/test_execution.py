"""Execution data on a drive written by hand."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from roadgpt.drive import COLUMNS, Box, Columns, Drive
from roadgpt.road import Road, World
from roadgpt.run.execution import FIELDS, records_of

WORLD = World()
ROAD = Road.through([[0, 0], [100, 0]])
STEPS = 101  # 2 s


def drive(**given: np.ndarray) -> Drive:
    columns = {name: np.zeros(STEPS) for name in COLUMNS} | {"time": 0.02 * np.arange(STEPS)} | given
    return Drive("by hand", "paper", 0, Columns(columns), "goal", Box(4.7, 1.86))


def test_a_record_has_the_competition_s_17_fields_in_their_order() -> None:
    assert (
        *("timer", "pos", "dir", "vel", "steering", "steering_input", "brake", "brake_input"),
        *("throttle", "throttle_input", "wheelspeed", "vel_kmh"),
        *("is_oob", "oob_counter", "max_oob_percentage", "oob_distance", "oob_percentage"),
    ) == FIELDS


def test_every_field_is_that_of_its_step() -> None:
    """On columns that all differ; direction and velocity are turned by scipy."""
    rng = np.random.default_rng(7)
    given = {name: rng.normal(0.0, 0.4, STEPS) for name in COLUMNS if name not in ("time", "s")}
    given |= {name: rng.uniform(0, 1, STEPS) for name in ("brake", "throttle", "outside")}
    given |= {"speed": rng.uniform(0, 30, STEPS), "s": np.linspace(10, 90, STEPS)}
    driven = replace(drive(**given), car=Box(4.7, 1.86, 0.0, 0.62), ended="timeout")
    world = WORLD.changed(oob_tolerance=0.6)
    records = records_of(ROAD, driven, world)
    assert len(records) > 20
    worst, count, was_out = 0.0, 0, False
    for step in range(STEPS):
        at = {name: float(driven[name][step]) for name in COLUMNS}
        is_out = at["outside"] > 0.6
        count += is_out and not was_out
        worst = at["outside"] if is_out and not was_out else max(worst, at["outside"]) if count else 0.0
        was_out = is_out
        found = [record for record in records if record.timer == pytest.approx(at["time"], abs=1e-6)]
        if not found:
            continue
        turned = Rotation.from_euler("ZYX", [at["heading"], -at["pitch"], at["roll"]])
        wanted = {
            "timer": at["time"],
            "pos": [at["x"], at["y"], at["z"]],
            "dir": turned.apply([1, 0, 0]),
            "vel": turned.apply([at["vx"], at["vy"], at["vz"]]),
            "steering": 15 * np.degrees(at["steer"]),
            "steering_input": min(max(at["steer"] / 0.62, -1), 1),
            "brake": at["brake"],
            "brake_input": at["brake"],
            "throttle": at["throttle"],
            "throttle_input": at["throttle"],
            "wheelspeed": abs(at["vx"]),
            "vel_kmh": round(at["speed"] * 3.6),
            "is_oob": is_out,
            "oob_counter": count,
            "max_oob_percentage": worst,
            "oob_distance": 2.0 - abs(at["t"] + 2.0),
            "oob_percentage": at["outside"],
        }
        assert tuple(wanted) == FIELDS
        for name, value in wanted.items():
            assert getattr(found[0], name) == pytest.approx(value, abs=1e-4), name


def test_ten_records_a_second_and_the_last_step() -> None:
    timers = [record.timer for record in records_of(ROAD, drive(), WORLD)]
    assert timers == pytest.approx([0.1 * i for i in range(21)])
    shorter = drive(time=0.02 * np.arange(STEPS) * 0.99)
    assert records_of(ROAD, shorter, WORLD)[-1].timer == pytest.approx(1.98)


def test_the_step_that_leaves_the_lane_is_recorded_though_it_lies_between() -> None:
    outside = np.zeros(STEPS)
    outside[53:60] = 0.97
    outside[88:] = 1.0
    records = records_of(ROAD, drive(outside=outside), WORLD)
    first = next(record for record in records if record.is_oob)
    assert first.timer == pytest.approx(1.06)
    assert [record.timer for record in records] == sorted({record.timer for record in records})
    assert [record.oob_counter for record in records][-1] == 2
    assert records[0].oob_percentage == 0.0
    assert records[-1].max_oob_percentage == 1.0


def test_directions_and_speeds_in_space() -> None:
    heading, pitch = np.full(STEPS, np.pi / 2), np.full(STEPS, 0.1)
    records = records_of(
        ROAD,
        drive(
            heading=heading,
            pitch=pitch,
            vx=np.full(STEPS, 10.0),
            vy=np.full(STEPS, 1.0),
            speed=np.full(STEPS, 10.05),
        ),
        WORLD,
    )
    assert records[3].dir == pytest.approx([0.0, np.cos(0.1), np.sin(0.1)], abs=1e-4)
    assert records[3].vel == pytest.approx([-1.0, 10 * np.cos(0.1), 10 * np.sin(0.1)], abs=1e-3)
    assert records[3].wheelspeed == 10.0
    assert records[3].vel_kmh == 36


def test_a_car_that_falls_moves_down() -> None:
    rng = np.random.default_rng(4)
    heading, pitch, roll = (np.full(STEPS, angle) for angle in (2.0, -0.7, 0.5))
    vx, vy, vz = rng.normal(0, 5, (3, STEPS))
    record = records_of(ROAD, drive(heading=heading, pitch=pitch, roll=roll, vx=vx, vy=vy, vz=vz), WORLD)[0]
    turned = Rotation.from_euler("ZYX", [2.0, 0.7, 0.5])  # scipy's pitch is positive nose down
    assert record.vel == pytest.approx(turned.apply([vx[0], vy[0], vz[0]]), abs=1e-4)
    assert record.dir == pytest.approx(turned.apply([1, 0, 0]), abs=1e-4)
    sinking = records_of(ROAD, drive(vz=np.full(STEPS, -9.81)), WORLD)[0]
    assert sinking.vel == [0.0, 0.0, -9.81]


def test_steering_is_told_at_the_wheel_in_degrees_and_as_a_share_of_the_car_s_lock() -> None:
    steer = np.full(STEPS, 0.31)
    steer[10:] = -0.7
    turning = replace(drive(steer=steer), car=Box(4.7, 1.86, 0.0, 0.62))
    first, *_, last = records_of(ROAD, turning, WORLD)
    assert first.steering == pytest.approx(15 * 17.7617, abs=1e-3)
    assert first.steering_input == pytest.approx(0.5)
    assert last.steering_input == -1.0


def test_the_distance_to_the_edge_of_the_lane() -> None:
    offset = np.linspace(-2.0, -4.5, STEPS)  # from the middle of the lane to half a metre off the road
    records = records_of(ROAD, drive(t=offset), WORLD)
    assert records[0].oob_distance == pytest.approx(2.0)
    assert records[-1].oob_distance == pytest.approx(-0.5)


def test_records_are_plain_json() -> None:
    text = json.dumps(records_of(ROAD, drive(x=np.linspace(0, 1 / 3, STEPS), t=np.full(STEPS, -0.0)), WORLD))
    assert "-0.0" not in text
    record = json.loads(text)[-1]
    assert record[1] == [0.3333, 0.0, 0.0]
    assert type(record[11]) is type(record[13]) is int
    assert type(record[12]) is bool
