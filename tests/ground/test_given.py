"""Land that a user gives: a World carries its heights, files hold only its name, and a folder of runs holds
the heights once. Nobody else's file makes the program open the file that a name says."""

import json
import pickle
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from roadgpt import read_source
from roadgpt.errors import UsageError
from roadgpt.ground.files import named, read_ground, save_ground, write_ground
from roadgpt.ground.given import BESIDE, GivenGround
from roadgpt.ground.relief import Relief
from roadgpt.network.landscape import ground_around
from roadgpt.road import Design, Segment, World, build
from roadgpt.run import Run, Setup, perform, read_run, write_run

ROWS, COLUMNS, CELL = 41, 51, 10.0
ON_PAPER = Setup(reader="plan", drives=False)
WATCHED: list[str] = []
IS_WATCHED = [False]


def _watch(event: str, told: tuple[Any, ...]) -> None:
    if event == "open" and IS_WATCHED[0]:
        WATCHED.append(str(told[0]))


sys.addaudithook(_watch)


@pytest.fixture
def opened() -> Iterator[list[str]]:
    """The files that are opened from here on."""
    WATCHED.clear()
    IS_WATCHED[0] = True
    yield WATCHED
    IS_WATCHED[0] = False


def land(seed: int = 0) -> Relief:
    """Land that is nowhere steep."""
    rng = np.random.default_rng(seed)
    heights = 200.0 + rng.normal(0.0, 0.05, (ROWS, COLUMNS)).cumsum(axis=0).cumsum(axis=1) / 10
    return Relief(0.0, 0.0, CELL, heights, np.full_like(heights, np.nan), np.empty((0, 3)))


def world(path: str = "x.npy", seed: int = 0) -> World:
    return World().changed(ground=named(path, land(seed)))


def heights_of(of: World) -> np.ndarray:
    assert isinstance(of.site.ground, GivenGround)
    return of.site.ground.relief.heights


def from_file(of: World) -> World:
    """The same World as a file has it: without heights."""
    return World.model_validate(json.loads(of.model_dump_json()))


def a_run(folder: Path, path: str = "x.npy", index: int = 1) -> Run:
    """A road of 120 m on land of its own, not driven, in a folder of runs."""
    run = perform("straight 120", 3, world(path, index - 1), ON_PAPER, index)
    write_run(run, folder)
    return run


def test_the_heights_go_along_wherever_the_world_goes() -> None:
    first = world()
    later = first.changed(friction=0.6, scene="medium")
    again = pickle.loads(pickle.dumps(later))
    for each in (first, later, again, first.model_copy(), again.changed(map_size=300)):
        assert heights_of(each).tolist() == land().heights.tolist()
    assert again == later
    assert hash(again) == hash(later)
    assert again.site.ground.relief.cell == CELL
    assert isinstance(again.site.ground, str)
    assert first != world(seed=1)
    assert first != world("y.npy")
    assert first.site.made_ground is None
    assert first.has_ground


def test_the_name_depends_on_the_heights_and_the_cell_alone() -> None:
    heights = land().heights
    wide = Relief(0.0, 0.0, 2 * CELL, heights, np.full_like(heights, np.nan), np.empty((0, 3)))
    names = [str(named("x.npy", each)) for each in (land(), land(), land(1), wide)]
    assert names[0] == names[1]
    assert len({*names}) == 3


def test_files_hold_the_name_and_a_digest() -> None:
    text = world("alps/x.npy").model_dump_json()
    name = json.loads(text)["ground"]
    assert name.partition("@")[0] == "alps/x.npy"
    assert len(name.partition("@")[2]) == 12
    assert int(name.partition("@")[2], 16) > 0
    assert len(text) < 1000
    assert from_file(world()) == world()


@pytest.mark.parametrize("path", ["deep/" * 70 + "x.npy", "ridge@home.npy", "Höhen, neu.npy"])
def test_any_path_is_read_again(path: str, tmp_path: Path) -> None:
    a_run(tmp_path, path)
    assert heights_of(read_run(tmp_path / "runs" / "0001").world).tolist() == land().heights.tolist()


def test_a_world_from_a_file_has_no_heights_and_says_how_to_give_them() -> None:
    bare = from_file(world())
    assert not isinstance(bare.site.ground, GivenGround)
    road = build(Design(
        starting_point=(50, 50, 200), theta=30,
        segments=(Segment(distance=80, direction="straight", incline=0),),
    ))  # fmt: skip
    with pytest.raises(UsageError, match=r"x\.npy@[0-9a-f]{12}' are not at hand; give .* --ground"):
        ground_around(road, bare)


def test_a_folder_gives_the_heights_back(tmp_path: Path) -> None:
    bare = from_file(world())
    assert bare.with_heights_in(tmp_path) is bare
    (tmp_path / BESIDE).write_bytes(save_ground(world().site.ground))  # type: ignore[arg-type]
    found = bare.with_heights_in(tmp_path / "elsewhere", tmp_path)
    assert heights_of(found).tolist() == land().heights.tolist()
    assert found == world()
    for usual in (World(), World().changed(ground="hilly:3")):
        assert usual.with_heights_in(tmp_path) is usual


def npz(**tables: Any) -> Callable[[Path], None]:
    return lambda path: np.savez(path, **tables)


def other_heights(path: Path) -> None:
    path.write_bytes(save_ground(named("x.npy", land(1))))


def cut_off(path: Path) -> None:
    path.write_bytes(save_ground(named("x.npy", land()))[:500])


def flipped(path: Path) -> None:
    content = bytearray(save_ground(named("x.npy", land())))
    content[400:420] = bytes(20)
    path.write_bytes(content)


def one_array(path: Path) -> None:
    with path.open("wb") as file:
        np.save(file, land().heights)


@pytest.mark.parametrize(
    ("write", "said"),
    [
        (other_heights, "holds other land than 'x.npy@"),
        (npz(heights=land().heights, cell=2 * CELL), "holds other land than 'x.npy@"),
        (npz(heights=land().heights), "is missing"),
        (npz(heights=land().heights, cell=[1.0, 2.0]), "is missing"),
        (npz(heights=np.array([["a", None]] * 2, object), cell=1.0), "is missing"),
        (lambda path: path.write_bytes(b""), "is missing"),
        (lambda path: path.write_text("no heights"), "is missing"),
        (cut_off, "is missing"),
        (flipped, "is missing"),
        (one_array, "is missing"),
    ],
    ids=[
        "other",
        "other cell",
        "no cell",
        "two cells",
        "objects",
        "empty",
        "text",
        "cut",
        "flipped",
        "array",
    ],
)
def test_what_a_folder_holds_instead_is_refused(
    write: Callable[[Path], object], said: str, tmp_path: Path
) -> None:
    write(tmp_path / BESIDE)
    with pytest.raises(UsageError, match=said) as caught:
        from_file(world()).with_heights_in(tmp_path)
    assert "\n" not in str(caught.value)


def test_a_run_is_read_again_with_its_heights(tmp_path: Path) -> None:
    run = a_run(tmp_path)
    assert [path.relative_to(tmp_path) for path in tmp_path.rglob("*.npz")] == [Path(BESIDE)]
    assert "relief" not in (tmp_path / "runs" / "0001" / "run.json").read_text()
    for path in (tmp_path / "runs" / "0001", tmp_path / "test.0001.json"):
        again = read_run(path)
        assert again.outcome == "VALID"
        assert again.request == run.request
        assert heights_of(again.world).tolist() == land().heights.tolist()
        assert again.road is not None
        middle = again.road.at(np.array([again.length / 2]), 0.0)
        found = ground_around(again.road, again.world).height(*middle[:, :2].T)
        assert found == pytest.approx(middle[:, 2], abs=0.01)
    source = read_source(tmp_path / "runs" / "0001" / "road.json")
    assert heights_of(World().changed(**source.world)).tolist() == land().heights.tolist()


def test_runs_on_different_land_in_one_folder_keep_their_own(tmp_path: Path) -> None:
    for index in (1, 2):
        a_run(tmp_path, index=index)
    for index in (1, 2):
        again = read_run(tmp_path / "runs" / f"{index:04d}")
        assert heights_of(again.world).tolist() == land(index - 1).heights.tolist()


def test_a_shared_run_never_makes_the_program_open_the_file_that_it_names(
    tmp_path: Path, opened: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    secret = tmp_path / "secret.npy"
    write_ground(land().heights, CELL, secret)
    read_ground(secret)
    assert str(secret) in opened  # the watch works
    run = a_run(tmp_path / "shared", str(secret))
    (tmp_path / "shared" / BESIDE).unlink()
    opened.clear()
    monkeypatch.chdir(tmp_path)
    again = read_run(tmp_path / "shared" / "runs" / "0001")
    assert again.request.world.site.ground == run.request.world.site.ground
    source = read_source(tmp_path / "shared" / "runs" / "0001" / "road.json")
    assert again.road is not None
    for shared in (again.world, World().changed(**source.world)):
        assert not isinstance(shared.site.ground, GivenGround)
        with pytest.raises(UsageError, match="not at hand"):
            ground_around(again.road, shared)
    assert any(path.endswith("run.json") for path in opened)
    assert not [path for path in opened if "secret" in path]
