"""``roadgpt export``, ``run --export`` and ``import``, as they are typed."""

import json
from pathlib import Path

import numpy as np
import pytest

from command_line import invoke as said
from roadgpt.network import read_road

DESIGN = {
    "starting_point": [60, 60, 0],
    "theta": 30,
    "road_segment1": {"distance": 60, "direction": "left", "incline": 5, "turn_degrees": 60},
    "road_segment2": {"distance": 40, "direction": "straight", "incline": 0, "turn_degrees": 0},
}


@pytest.fixture
def here(tmp_path: Path) -> Path:
    Path("hill.json").write_text(json.dumps(DESIGN))
    return tmp_path


def test_a_road_goes_out_and_comes_back(here: Path) -> None:
    out = said("export", "hill.json", "--to", "opendrive,csv", "--lane-width", "3.5", "--speed-limit", "50")
    assert out.stdout.split() == ["exports/hill.route.json", "exports/hill.xodr", "exports/hill.csv"]
    back = said("import", "exports/hill.xodr")
    assert "road 1 (road): A 100 metre road with " in back.stdout
    assert "left turn of 60 degrees" in back.stdout
    assert back.stdout.splitlines()[-1] == "written to hill-1.json; drive it: roadgpt drive hill-1.json"
    world = json.loads(Path("hill-1.json").read_text())["world"]
    assert world["lane_width"] == 3.5
    assert world["speed_limit"] == pytest.approx(50 / 3.6)
    one, other = read_road("hill.json"), read_road("hill-1.json")
    s = np.linspace(0, one.length, 200)
    assert other.at(s) == pytest.approx(one.at(s), abs=1e-3)
    assert said("check", "exports/hill.xodr").exit_code == 0
    again = said("import", "exports/hill.xodr")
    assert "written to hill-1-2.json" in again.stdout


def test_a_road_off_the_map_is_moved_onto_it(here: Path) -> None:
    Path("far.json").write_text(json.dumps({**DESIGN, "starting_point": [5000, -900, 0]}))
    said("export", "far.json", "--to", "opendrive")
    moved = said("import", "exports/far.xodr", "--out", "near.json")
    assert "it is moved by (" in moved.stderr
    assert said("check", "near.json").exit_code == 0
    said("import", "exports/far.xodr", "--out", "kept/far.json", "--keep-place")
    assert read_road("kept/far.json").at(0)[:2] == pytest.approx([5000, -900])


def test_a_campaign_is_exported_as_it_goes_and_afterwards(here: Path) -> None:
    words = "run -n 2 --seed 3 --reader plan --no-plot --out camp --export opendrive --export csv"
    ran = said(*words.split(), "straight | turns=0")
    assert ran.exit_code == 0
    run = here / "camp" / "runs" / "0001"
    assert {"road.xodr", "road.csv", "road.drive.csv"} <= {path.name for path in run.iterdir()}
    out = said("export", "camp", "camp/runs/0001", "--to", "opendrive", "--speed-limit", "30")
    names = [f"exports/camp-000{n}.{suffix}" for n in (1, 2) for suffix in ("route.json", "xodr")]
    assert out.stdout.split() == names
    assert out.stderr == "roadgpt: runs keep their own lanes and limits; --speed-limit is for road files\n"
    assert (here / "exports" / "camp-0001.xodr").read_bytes() == (run / "road.xodr").read_bytes()
    test = said("export", "camp/test.0001.json", "--to", "csv")  # the run itself, with its drive
    assert test.stdout.split() == ["exports/test.0001.csv", "exports/test.0001.drive.csv"]
    assert (here / "exports" / "test.0001.csv").read_bytes() == (run / "road.csv").read_bytes()


def test_two_sources_of_one_name_and_one_source_twice(here: Path) -> None:
    Path("other").mkdir()
    Path("other/hill.json").write_text(json.dumps(DESIGN))
    out = said("export", "hill.json", "other/hill.json", "./hill.json", "--to", "opendrive")
    names = [f"exports/{name}.{suffix}" for name in ("hill", "hill-2") for suffix in ("route.json", "xodr")]
    assert out.stdout.split() == names


def test_opendrive_keeps_its_lanes_and_limits_on_its_way_through(here: Path) -> None:
    world = ["--lane-width", "3.25", "--shoulder", "1.5", "--speed-limit", "50", "--friction", "0.6"]
    said("export", "hill.json", "--to", "opendrive", *world)
    said("export", "exports/hill.xodr", "--to", "opendrive", "--out", "again")
    assert Path("again/hill.xodr").read_bytes() == Path("exports/hill.xodr").read_bytes()
    said("export", "exports/hill.xodr", "--to", "opendrive", "--out", "again", "--speed-limit", "70")
    told = Path("again/hill.xodr").read_text()
    assert 'max="70"' in told
    assert 'max="50"' not in told
    assert 'friction="0.6"' in told


@pytest.mark.parametrize(
    "words",
    [["export", "--to", "csv"], ["check"], ["drive"], ["view", "--format", "png"], ["view"], ["film"]],
    ids=lambda w: w[0],
)
def test_a_folder_without_a_road_is_told_of(words: list[str], here: Path) -> None:
    Path("empty").mkdir()
    result = said(*words, "empty")
    assert result.exit_code == 2
    assert result.stderr.startswith("roadgpt: empty is a folder without a road; give ")


def test_a_format_that_nobody_writes_is_told_of_before_any_work(here: Path) -> None:
    for words in (
        ["export", "hill.json", "--to", "gpx"],
        ["run", "a road", "--export", "gpx", "--out", "camp"],
    ):
        result = said(*words)
        assert result.exit_code == 2
        assert "no exporter called 'gpx'; there are:" in result.stderr
    assert not (here / "exports").exists()
    assert not (here / "camp").exists()


def test_one_file_that_cannot_be_read_does_not_stop_the_others(here: Path) -> None:
    result = said("export", "no.json", "hill.json", "--to", "csv")
    assert result.exit_code == 2
    assert result.stdout.split() == ["exports/hill.csv"]
    assert "cannot read no.json" in result.stderr
