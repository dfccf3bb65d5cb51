"""Execution data on a drive written by hand."""

import json

import numpy as np
import pytest

from roadgpt.drive import COLUMNS, Box, Columns, Drive
from roadgpt.road import World
from roadgpt.run.execution import FIELDS, LOCK, STEERING_RATIO, Record, records_of

WORLD = World()
STEPS = 101  # 2 s


def drive(**given: np.ndarray) -> Drive:
    columns = {name: np.zeros(STEPS) for name in COLUMNS} | {"time": 0.02 * np.arange(STEPS)} | given
    return Drive("by hand", "paper", 0, Columns(columns), "goal", Box(4.7, 1.86))


def test_a_record_has_the_competition_s_17_fields_in_their_order() -> None:
    assert Record._fields == FIELDS
    assert len(FIELDS) == 17
    assert FIELDS[:4] == ("timer", "pos", "dir", "vel")
    assert FIELDS[-5:] == (
        "is_oob",
        "oob_counter",
        "max_oob_percentage",
        "oob_distance",
        "oob_percentage",
    )


def test_ten_records_a_second_and_the_last_step() -> None:
    timers = [record.timer for record in records_of(drive(), WORLD)]
    assert timers == pytest.approx([0.1 * i for i in range(21)])
    shorter = drive(time=0.02 * np.arange(STEPS) * 0.99)
    assert records_of(shorter, WORLD)[-1].timer == pytest.approx(1.98)


def test_the_step_that_leaves_the_lane_is_recorded_though_it_lies_between() -> None:
    outside = np.zeros(STEPS)
    outside[53:60] = 0.97
    outside[88:] = 1.0
    records = records_of(drive(outside=outside), WORLD)
    first = next(record for record in records if record.is_oob)
    assert first.timer == pytest.approx(1.06)
    assert [record.timer for record in records] == sorted({record.timer for record in records})
    assert [record.oob_counter for record in records][-1] == 2
    assert records[0].oob_percentage == 0.0
    assert records[-1].max_oob_percentage == 1.0


def test_directions_and_speeds_in_space() -> None:
    heading, pitch = np.full(STEPS, np.pi / 2), np.full(STEPS, 0.1)
    records = records_of(
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


def test_the_steering_wheel_turns_more_than_the_wheels() -> None:
    record = records_of(drive(steer=np.radians(np.full(STEPS, 6.0))), WORLD)[0]
    assert record.steering == pytest.approx(6.0 * STEERING_RATIO)
    assert record.steering_input == pytest.approx(6.0 / LOCK)


def test_the_distance_to_the_edge_of_the_lane() -> None:
    offset = np.linspace(-2.0, -4.5, STEPS)  # from the middle of the lane to half a metre off the road
    records = records_of(drive(t=offset), WORLD)
    assert records[0].oob_distance == pytest.approx(2.0)
    assert records[-1].oob_distance == pytest.approx(-0.5)


def test_records_are_plain_json() -> None:
    text = json.dumps(records_of(drive(x=np.linspace(0, 1 / 3, STEPS), t=np.full(STEPS, -0.0)), WORLD))
    assert "-0.0" not in text
    record = json.loads(text)[-1]
    assert record[1] == [0.3333, 0.0, 0.0]
    assert type(record[11]) is type(record[13]) is int
    assert type(record[12]) is bool
