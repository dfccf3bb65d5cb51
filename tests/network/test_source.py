"""Roads from files that people have."""

import json
from pathlib import Path

import numpy as np
import pytest

from roadgpt.errors import UsageError
from roadgpt.network import read_road, read_source
from roadgpt.road import Road, build, read_design
from tables import rows

DESIGN = {
    "starting_point": [20, 20, 0],
    "theta": 30,
    "road_segment1": {"distance": 60, "direction": "left", "incline": 5, "turn_degrees": 40},
    "road_segment2": {"distance": 40, "direction": "straight", "incline": 0, "turn_degrees": 0},
}
POINTS = [[10.0, 20.0], [60.0, 20.0], [100.0, 60.0], [150.0, 60.0]]


def written(folder: Path, data: object) -> Path:
    path = folder / "road.json"
    path.write_text(json.dumps(data))
    return path


@pytest.mark.parametrize("data", [POINTS, {"road_points": POINTS}, {"nodes": POINTS}])
def test_points_alone_or_in_an_sbft_test(tmp_path: Path, data: object) -> None:
    road = read_road(written(tmp_path, data))
    assert road.control_points().tolist() == POINTS
    assert road.at(road.length)[:2] == pytest.approx([150, 60], abs=1e-6)


def test_a_test_with_heights_gives_them_back(tmp_path: Path) -> None:
    ours = build(read_design(DESIGN)[0])
    dense = np.round(ours.centreline(), 4).tolist()
    control = np.round(ours.control_points(), 5).tolist()
    road = read_road(written(tmp_path, {"road_points": control, "interpolated_points": dense}))
    assert road.control_points().tolist() == control
    assert Road.from_json(road.to_json()).control_points().tolist() == control
    s = np.linspace(0, min(road.length, ours.length), 100)
    assert road.at(s) == pytest.approx(ours.at(s), abs=2e-3)


def test_points_that_were_edited_win_over_those_interpolated_from_others(tmp_path: Path) -> None:
    dense = build(read_design(DESIGN)[0]).centreline().tolist()
    path = written(tmp_path, {"road_points": POINTS, "interpolated_points": dense})
    road, remarks, *_ = read_source(path)
    assert isinstance(road, Road)
    assert road.at(road.length) == pytest.approx([150, 60, 0], abs=1e-6)
    assert "road_points are used" in remarks[0]


def test_a_design_and_a_run_folder(tmp_path: Path) -> None:
    ours = build(read_design(DESIGN)[0])
    assert read_road(written(tmp_path, DESIGN)).length == pytest.approx(100)
    written(tmp_path, ours.to_json())
    assert read_road(tmp_path).centreline().tobytes() == ours.centreline().tobytes()


@pytest.mark.parametrize(
    ("text", "hint"),
    rows(__file__, "files_without_a_road_get_one_sentence"),
)
def test_files_without_a_road_get_one_sentence(tmp_path: Path, text: str, hint: str) -> None:
    path = tmp_path / "bad.json"
    path.write_text(text)
    with pytest.raises(UsageError, match=hint) as caught:
        read_road(path)
    assert str(path) in str(caught.value)


def test_missing_files_and_folders(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="cannot read"):
        read_road(tmp_path / "nowhere.json")
    with pytest.raises(UsageError, match="cannot read"):
        read_road(tmp_path)
