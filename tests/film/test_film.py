"""Films: what PyAV reads back, what stands in the frames, and sentences where there can be none."""

import hashlib
import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from click.testing import CliRunner
from scipy.interpolate import interp1d

from road_parts import design_of, named
from roadgpt.cli import app
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.road import Design
from roadgpt.run import Run, Setup, prove, write_run
from roadgpt_film.film import HOLD, SEAM, TURN_LAG, Film, Settings, Trip, write, write_film

SMALL = Settings(160, 96, 10)


def design(turn: float) -> Design:
    return design_of((30, 0, 5), (30, turn, 0))


@pytest.fixture(scope="module")
def driven() -> Run:
    return named(prove(design(40), 7), "a short road with one turn ⛰")


@pytest.fixture(scope="module")
def other() -> Run:
    return named(prove(design(25), 7), "another one")


@pytest.fixture(scope="module")
def alone() -> Run:
    return replace(prove(design(40), setup=Setup(drives=False)), source="alone.json")


def read(path: Path) -> tuple[list[np.ndarray], av.VideoStream, float]:
    with av.open(str(path)) as file:
        stream = file.streams.video[0]
        frames = [frame.to_ndarray(format="rgb24") for frame in file.decode(stream)]
        return frames, stream, float(file.duration or 0) / 1e6


def test_a_film_has_its_frames_its_duration_and_its_size(driven: Run, tmp_path: Path) -> None:
    path = write([driven], tmp_path / "new" / "film.mp4", "chase", SMALL)
    frames, stream, duration = read(path)
    assert driven.drive is not None
    expected = int(driven.drive.duration * 10 + 1e-6) + HOLD * 10
    assert len(frames) == expected
    assert duration == pytest.approx(expected / 10, abs=0.02)
    assert {frame.shape for frame in frames} == {(96, 160, 3)}
    assert stream.average_rate == Fraction(10)
    assert stream.codec_context.name == "h264"
    assert stream.codec_context.pix_fmt == "yuv420p"  # what every browser plays
    data = path.read_bytes()
    assert data.index(b"moov") < data.index(b"mdat")  # it plays while it loads
    assert list(path.parent.iterdir()) == [path]
    film = Film.of([driven], "chase", SMALL)
    for n in (0, 17, len(film) - 1):
        away = np.abs(frames[n].astype(int) - film.frame(n))
        assert away.mean() < 6


def test_the_same_run_gives_the_same_frames_whatever_the_threads(driven: Run) -> None:
    settings = replace(SMALL, begin=1.0, seconds=1.0)

    def all_of(threads: int) -> list[str]:
        film = Film.of([driven], "both", settings)
        assert len(film) == 10
        return [hashlib.sha256(frame.tobytes()).hexdigest() for frame in film.frames(threads)]

    one = all_of(1)
    assert all_of(3) == one
    assert len(set(one)) == 10


def test_two_drives_stand_side_by_side_and_two_views_one_above_the_other(
    driven: Run, other: Run, tmp_path: Path
) -> None:
    settings = replace(SMALL, seconds=0.3)
    frames, _, _ = read(write([driven, other], tmp_path / "split.mp4", "bonnet", settings))
    assert len(frames) == 3
    assert frames[0].shape == (96, 2 * 160 + SEAM, 3)
    single = [Film.of([run], "bonnet", settings).frame(2) for run in (driven, other)]
    split = Film.of([driven, other], "bonnet", settings).frame(2)
    np.testing.assert_array_equal(split[:, :160], single[0])
    np.testing.assert_array_equal(split[:, 160 + SEAM :], single[1])
    four = Film.of([driven, other], "both", settings).frame(2)
    assert four.shape == (2 * 96 + SEAM, 2 * 160 + SEAM, 3)
    np.testing.assert_array_equal(four[96 + SEAM :, :160], single[0])
    assert Film.of([driven], "both", settings).frame(0).shape == (96, 2 * 160 + SEAM, 3)


def test_a_trip_is_the_drive_and_its_camera_lags(driven: Run) -> None:
    drive = driven.drive
    assert drive is not None
    trip = Trip.of(driven)
    for step in (0, 40, len(drive) - 1):
        car = trip.car(float(drive["time"][step]))
        for name in ("x", "y", "z", "pitch", "roll", "steer", "speed", "brake"):
            assert getattr(car, name) == pytest.approx(drive[name][step], abs=1e-9)
    between = (drive["time"][60] + drive["time"][61]) / 2
    assert trip.car(between).x == pytest.approx(float(interp1d(drive["time"], drive["x"])(between)))
    rolled = trip.car(trip.duration).wheel * 0.33
    way = np.hypot(np.diff(drive["x"]), np.diff(drive["y"])).sum()
    assert rolled == pytest.approx(way, rel=0.02)
    late = drive["heading"][0]
    for heading in np.unwrap(drive["heading"]):
        late += (heading - late) * 0.02 / TURN_LAG
    assert trip.follower(trip.duration).heading == pytest.approx(late, abs=1e-6)
    assert trip.follower(0.0).heading == pytest.approx(drive["heading"][0])


def test_along_a_road_that_nobody_drove_the_camera_rides_alone(alone: Run) -> None:
    film = Film.of([alone], "chase", SMALL)
    assert alone.road is not None
    trip = film.rows[0][0].trip
    first, last = trip.car(0.0), trip.car(trip.duration)
    assert alone.road.locate(first.x, first.y)[0] == pytest.approx(2.5, abs=0.01)
    assert alone.road.locate(last.x, last.y)[0] == pytest.approx(alone.road.length - 8, abs=0.5)
    assert alone.road.locate(last.x, last.y)[1] == pytest.approx(-2.0, abs=0.01)
    frame = film.frame(0)
    blue = (frame[..., 2].astype(int) - frame[..., 0] > 70) & (frame[..., 1] < 120)
    assert not blue.any()  # no car


def test_what_cannot_be_filmed_is_told(driven: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(UsageError, match="chase, bonnet, both"):
        write([driven], tmp_path / "a.mp4", "roof")
    with pytest.raises(UsageError, match="3 are given"):
        Film.of([driven] * 3)
    with pytest.raises(UsageError, match="no road to film"):
        write([replace(driven, road=None)], tmp_path / "a.mp4")
    with pytest.raises(UsageError, match="over after"):
        write([driven], tmp_path / "a.mp4", settings=replace(SMALL, begin=1000.0))
    (tmp_path / "file").touch()
    with pytest.raises(RoadGPTError, match="cannot write"):
        write([driven], tmp_path / "file" / "a.mp4", settings=replace(SMALL, seconds=0.1))
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(UsageError, match=r"pip install (-e '\.|'roadgpt)\[film\]'"):
        write([driven], tmp_path / "a.mp4")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file"]


def test_a_film_that_is_interrupted_leaves_nothing(
    driven: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    old = tmp_path / "a.mp4"
    old.write_bytes(b"old")

    def stopped(frames: Iterator[np.ndarray]) -> Iterator[np.ndarray]:
        yield next(frames)
        raise KeyboardInterrupt

    frames = Film.of([driven], "chase", SMALL).frames()
    with pytest.raises(KeyboardInterrupt):
        write_film(stopped(frames), old, 10)
    frames.close()
    assert old.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [old]


def test_the_command_films_a_run_two_runs_and_a_campaign(
    driven: Run, other: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.chdir(tmp_path)
    folders = [write_run(replace(run, index=n), tmp_path) for n, run in ((1, driven), (2, other))]
    more = ["--size", "64x64", "--fps", "5", "--seconds", "1:2"]

    def asked(*words: object) -> str:
        done = CliRunner().invoke(app, ["film", *map(str, words), *more])
        assert done.exception is None or done.exit_code == 2, done.exception
        return f"{done.exit_code} {done.stdout}"  # how far a slow machine is stands on stderr

    assert asked(folders[0], "--view", "hood") == "0 roadgpt-film.mp4\n"
    assert len(read(Path("roadgpt-film.mp4"))[0]) == 5
    assert asked(*folders, "--out", "two.mp4", "-q") == "0 "
    assert read(Path("two.mp4"))[0][0].shape == (64, 128 + SEAM, 3)
    assert len(asked(tmp_path, "--all").splitlines()) == 2
    kept = (folders[0] / "chase.mp4").stat().st_mtime_ns
    (folders[1] / "chase.mp4").unlink()
    assert len(asked(tmp_path, "--all").splitlines()) == 1
    assert (folders[0] / "chase.mp4").stat().st_mtime_ns == kept
    (folders[1] / "chase.mp4").unlink()
    assert asked(tmp_path, "--all", "-q") == "0 "
    assert (folders[1] / "chase.mp4").exists()
    for words, said in (
        ((folders[0], "--out", "a.txt"), "end in .mp4"),
        ((folders[0], "--out", tmp_path), "is a folder"),
        ((folders[0],) * 3, "3 are given"),
        ((folders[0], "--all"), "holds no runs"),
        ((tmp_path,), "holds 2 roads"),
        ((folders[0], "--size", "big"), "such as 640x360"),
        ((folders[0], "--seconds", "3:1"), "ends before it begins"),
        ((folders[0], "--seconds=-3"), "'-3' is no part of a drive"),
        ((folders[0], "--seconds", "nan"), "'nan' is no part of a drive"),
    ):
        done = CliRunner().invoke(app, ["film", *map(str, words)])
        assert done.exit_code != 0
        assert said in done.output + str(done.exception)


def test_the_code_of_the_guide_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    guide = (Path(__file__).parents[2] / "docs" / "how-to" / "film-a-drive.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"^```python\n(.*?)^```", guide, flags=re.MULTILINE | re.DOTALL)
    monkeypatch.setenv("DISPLAY", "")
    exec(compile(code, "film-a-drive.md", "exec"), {})
