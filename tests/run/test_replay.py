"""Recorded tracks in a Setup: driven among, recorded with a digest, and read only if the user names them."""

import json
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

from exported import ROADS
from roadgpt import provenance
from roadgpt.drive import simulate
from roadgpt.drive.loading import permit
from roadgpt.errors import UsageError
from roadgpt.road import Site, World
from roadgpt.run import Run, Setup, prove, read_run, write_run
from roadgpt.run.model import permissions
from roadgpt.run.versions import still

TABLE = "time,id,kind,x,y,heading,speed\n0,cow,animal,40,70,0,0\n5,cow,animal,45,75,0,1\n"


@pytest.fixture
def file(tmp_path: Path) -> Iterator[Path]:
    provenance.CODE.forget()
    (path := tmp_path / "cows.csv").write_text(TABLE)
    yield path
    provenance.CODE.forget()


def proved(file: Path) -> Run:
    return prove(ROADS["arcs"], 3, World(), Setup(driver="pure_pursuit", tracks=str(file)))


def test_a_run_is_driven_among_the_recorded_and_says_which(file: Path, tmp_path: Path) -> None:
    run = proved(file)
    assert run.drive is not None
    alone = simulate(ROADS["arcs"], World(), "pure_pursuit", 3, replay=file)
    assert run.drive.to_bytes() == alone.to_bytes()
    assert [actor.name for actor in run.drive.others.actors] == ["cow"]  # type: ignore[union-attr]
    assert run.versions["tracks cows.csv"] == sha256(TABLE.encode()).hexdigest()[:16]
    file.write_text(TABLE.replace("45", "46"))
    with pytest.raises(UsageError, match=r"has changed: tracks cows\.csv \(was "):
        still(run.versions, proved(file).versions, "pure_pursuit", tmp_path)


def test_a_file_names_recorded_tracks_only_for_a_user_who_names_them_too(file: Path, tmp_path: Path) -> None:
    place = write_run(proved(file), tmp_path / "out")
    provenance.CODE.forget()
    setup = read_run(place).request.setup
    with pytest.raises(UsageError, match=r"run\.json names the recorded tracks .*cows\.csv, which are not"):
        prove(ROADS["arcs"], 3, World(site=Site(friction=0.9)), setup)
    (moved := tmp_path / "elsewhere").mkdir()
    (moved / "cows.csv").write_text(TABLE)
    permit(str(moved / "cows.csv"))
    setup = read_run(place).request.setup
    assert setup.tracks == str(moved / "cows.csv")
    again = prove(ROADS["arcs"], 3, World(), setup)
    np.testing.assert_array_equal(again.drive["x"], read_run(place).drive["x"])  # type: ignore[index]
    assert permissions([setup], replays=True) == ["--tracks", str(moved / "cows.csv")]


def test_without_recorded_tracks_the_files_say_nothing_of_them() -> None:
    dumped = Setup().model_dump(mode="json")
    assert "tracks" not in dumped
    assert "tracks" not in Setup().model_dump_json()
    assert Setup.model_validate_json(json.dumps(dumped)) == Setup()
    assert Setup.model_validate(Setup(tracks="a.csv").model_dump()).tracks == "a.csv"
