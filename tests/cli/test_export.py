"""``roadgpt export``, ``run --export`` and ``import``, as they are typed."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from roadgpt.cli import app
from roadgpt.road import read_road

DESIGN = {
    "starting_point": [60, 60, 0],
    "theta": 30,
    "road_segment1": {"distance": 60, "direction": "left", "incline": 5, "turn_degrees": 60},
    "road_segment2": {"distance": 40, "direction": "straight", "incline": 0, "turn_degrees": 0},
}


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("hill.json").write_text(json.dumps(DESIGN))
    return tmp_path


def said(*words: str) -> Result:
    return CliRunner().invoke(app, list(words))


def test_a_road_goes_out_and_comes_back(here: Path) -> None:
    out = said("export", "hill.json", "--to", "opendrive,csv", "--lane-width", "3.5", "--speed-limit", "50")
    assert out.stdout.split() == ["exports/hill.xodr", "exports/hill.csv"]
    back = said("import", "exports/hill.xodr")
    assert "road 1 (road): A 100 metre road with " in back.stdout
    assert "left turn of 60 degrees" in back.stdout
    assert back.stdout.splitlines()[-1] == (
        "written to hill-1.json; drive it: roadgpt drive hill-1.json --speed-limit 50 --lane-width 3.5"
    )
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
    said("import", "exports/far.xodr", "--out", "kept.json", "--keep-place")
    assert read_road("kept.json").at(0)[:2] == pytest.approx([5000, -900])


def test_a_campaign_is_exported_as_it_goes_and_afterwards(here: Path) -> None:
    words = "run -n 2 --seed 3 --reader grammar --no-plot --out camp --export opendrive --export csv"
    ran = said(*words.split(), "a straight road")
    assert ran.exit_code == 0
    run = here / "camp" / "runs" / "0001"
    assert {"road.xodr", "road.csv", "road.drive.csv"} <= {path.name for path in run.iterdir()}
    out = said("export", "camp", "camp/runs/0001", "--to", "opendrive")
    assert out.stdout.split() == ["exports/0001.xodr", "exports/0002.xodr", "exports/0001-2.xodr"]
    assert (here / "exports" / "0001.xodr").read_bytes() == (run / "road.xodr").read_bytes()


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


def test_an_opendrive_file_that_cannot_be_read_is_one_sentence(here: Path) -> None:
    Path("bad.xodr").write_text("<OpenDRIVE><road")
    result = said("import", "bad.xodr")
    assert result.exit_code == 2
    assert result.stderr.startswith("roadgpt: bad.xodr: it is no well-formed XML")
    assert result.stderr.count("\n") == 1
