"""Recordings: what a file says of others is what is replayed, or it is said what is not."""

import csv
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import interp1d

from exported import ROADS, WORLD
from roadgpt.errors import UsageError
from roadgpt.traffic import STEP
from roadgpt.traffic.recording import Recording, read_recording

HEADER = "time,id,kind,x,y,heading,speed"
ROW = "0,a,car,1,2,0.5,3"


def read(folder: Path, text: str, name: str = "others.csv") -> Recording:
    (folder / name).write_text(text)
    return read_recording(folder / name)


def test_between_rows_in_any_order_everybody_moves_evenly(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    made = {}
    for name, first in (("one", 0.35), ("two", 2.0)):
        time = first + np.cumsum(rng.uniform(0.02, 0.4, 30))
        made[name] = np.column_stack(
            [time, np.cumsum(rng.normal(size=(30, 2)), axis=0), 0.1 * time, time + 3]
        )
    rows = [[r[0], name, "van", *r[1:], 5.5] for name, own in made.items() for r in own.tolist()]
    with (tmp_path / "others.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([*HEADER.split(","), "length"])
        writer.writerows(rng.permutation(np.array(rows, object)).tolist())
    recording = read_recording(tmp_path / "others.csv")
    tracks = recording.on(ROADS["arcs"], WORLD)
    assert recording.remarks == ()
    for number, actor in enumerate(tracks.actors):
        own = made[actor.name]
        assert (actor.kind, actor.size.length) == ("van", 5.5)
        line = interp1d(own[:, 0], own[:, 1:], axis=0, bounds_error=False)  # NaN outside
        for sample, state in enumerate(tracks.states[:, number]):
            np.testing.assert_allclose(state[[0, 1, 3, 4]], line(sample * STEP), atol=6e-4)


def test_heights_are_those_of_the_road_and_who_stands_stays(tmp_path: Path) -> None:
    road = ROADS["arcs"]
    x, y, z = road.at(100.0, 3.0)
    text = f"{HEADER}\n1,still,adult,{x},{y},0,0\n1,gone,dog?,0,0,0,9\n".replace("dog?", "animal")
    tracks = read(tmp_path, f"{text}1.5,gone,animal,4,0,0,9\n").on(road, WORLD)
    assert len(tracks) == 16
    np.testing.assert_allclose(tracks.states[:, 0], [[x, y, z, 0, 0]] * 16, atol=1e-3)
    assert np.isnan(tracks.states[:10, 1]).all()
    assert not np.isnan(tracks.states[10:, 1]).any()


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "does not name the columns time, id, kind"),
        ("time,id,kind,x,y,speed\n", "columns heading"),
        (f"{HEADER}\n0,a,tank,1,2,0,3", "row 2: kind is 'tank'; give 'car', 'van'"),
        (f"{HEADER}\n{ROW}\n1,a,bus,1,2,0,3", "row 3: a is a bus and was a car"),
        (f"{HEADER}\n{ROW}\n0.0,a,car,1,2,0,3", "a has two rows at 0 s"),
        (f"{HEADER}\n0,a,car,nan,2,0,3", "row 2: x is 'nan'"),
        (f"{HEADER}\n0,a,car,1,2,0", "row 2: speed is ''"),
        (f"{HEADER}\n0,,car,1,2,0,3", "row 2: id is ''; give a text that is not empty"),
        (f"{HEADER},length\n{ROW},-1", "row 2: length is '-1'; give more than 0"),
        (
            f"{HEADER}\n0,Ego,car,1,2,0,3",
            "nobody in it can be replayed; not replayed, because it is the tested car: Ego",
        ),
        (f"{HEADER}\n{ROW}\n1e6,a,car,1,2,0,3", "too many"),
    ],
)
def test_a_wrong_table_costs_one_sentence(tmp_path: Path, text: str, why: str) -> None:
    with pytest.raises(UsageError) as error:
        read(tmp_path, text)
    assert why in str(error.value)
    assert str(tmp_path / "others.csv") in str(error.value)


def test_other_files_and_missing_ones_are_told_so(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"give a table \(\.csv\) or an OpenSCENARIO file"):
        read(tmp_path, "", "others.json")
    with pytest.raises(UsageError, match=r"cannot be read \(No such file"):
        read_recording(tmp_path / "missing.csv")
