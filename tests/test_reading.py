"""Files that may be somebody else's: whatever lies there, reading ends soon, and in a sentence."""

import os
import re
import resource
import sqlite3
import time
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from click.testing import CliRunner

from roadgpt import reading
from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.model import Cell
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import STORE, Store
from roadgpt.campaign.traces import read_traces
from roadgpt.cli import app
from roadgpt.drive import Drive
from roadgpt.errors import UsageError
from roadgpt.ground.files import attached
from roadgpt.run import Request

SEGMENT = {"distance": 30, "direction": "left", "incline": 2, "turn_degrees": 40}


def test_a_file_is_read_whole(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(b'{"a": [1, 2.5, "\xc3\xa4"]}\r\n')
    assert reading.read_json(path) == {"a": [1, 2.5, "ä"]}
    assert reading.read_text(path).endswith("}\n")
    link = tmp_path / "link.json"
    link.symlink_to(path)
    assert reading.read_bytes(link) == path.read_bytes()


def test_what_is_no_file_is_refused_at_once(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    for path in (pipe, Path("/dev/zero"), Path("/dev/random")):
        begun = time.monotonic()
        with pytest.raises(UsageError, match=f"{path} is a pipe or a device, not a file"):
            reading.read_bytes(path)
        assert time.monotonic() - begun < 1
    with pytest.raises(IsADirectoryError):
        reading.read_bytes(tmp_path)
    with pytest.raises(FileNotFoundError):
        reading.read_bytes(tmp_path / "none")


def test_the_limit_is_said(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_bytes(b"a" * 1001)
    with pytest.raises(UsageError, match=r"a\.txt is larger than 1,000 bytes; that is not a plan"):
        reading.read_bytes(path, 1000, "a plan")
    assert len(reading.read_bytes(path, 1001)) == 1001
    huge = tmp_path / "huge.txt"
    with huge.open("wb") as file:
        file.truncate(10**12)  # of nothing: it takes no room on the disk
    with pytest.raises(UsageError, match="is larger than 50 MB"):
        reading.read_bytes(huge)


@pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="no files that tell no size")
def test_a_file_that_tells_no_size_is_bounded_as_well() -> None:
    with pytest.raises(UsageError, match="is larger than 10 bytes"):
        reading.read_bytes(Path("/proc/self/maps"), 10)


@pytest.mark.parametrize(
    "text",
    ["[" * 100_000, '{"a":' * 50_000, "9" * 100_000, "[" + "[]," * 3_000_000 + "0]", "[" + "0," * 7_000_000],
)
def test_json_that_would_break_the_machine_is_a_value_error(text: str) -> None:
    with pytest.raises(ValueError, match=r"nested|digits|parts"):
        reading.json_of(text)


@pytest.mark.parametrize("text", ["a = " + "[" * 5_000 + "]" * 5_000, "a = " + "9" * 5_000, "a = ["])
def test_toml_that_would_break_the_machine_is_told(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, words in (("plan.toml", ["campaign", "plan.toml"]), ("roadgpt.toml", ["config", "show"])):
        Path(name).write_text(text)
        done = CliRunner().invoke(app, words, prog_name="roadgpt")
        assert (done.exit_code, done.stdout) == (2, "")
        assert re.search(f"{name} (is|are) not TOML", done.stderr)
        Path(name).unlink()


@pytest.mark.timeout(60)
@pytest.mark.parametrize(
    "more",
    [
        "ALTER TABLE meta RENAME TO old; CREATE VIEW meta AS WITH RECURSIVE each(name) AS (SELECT 1 UNION "
        "ALL SELECT name + 1 FROM each) SELECT name, NULL AS value FROM each",
        "CREATE TRIGGER own AFTER INSERT ON tests BEGIN DELETE FROM tests; END",
        "UPDATE cells SET cell = zeroblob(300000000)",
    ],
    ids=["a view without end", "a trigger", "a large value"],
)
def test_a_record_of_others_runs_nothing_and_fills_no_memory(more: str, tmp_path: Path) -> None:
    cell = Cell("", Request(), None, "words", None, keeps_runs=True)
    Store.new(tmp_path, Plan.of(Request(), 1).model_dump_json(), [cell], {"": {}}).close()
    with sqlite3.connect(tmp_path / STORE) as db:
        db.executescript(more)
    db.close()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(UsageError, match=re.escape(str(tmp_path / STORE))), open_record(tmp_path) as record:
        record.cells()
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000


READERS = {
    "drive.npz": (("header", "x", "y"), 200, Drive.load),
    "ground.npz": (("heights", "cell"), 129, lambda path: attached("x.npy@0123456789ab", path.parent)),
    "1.npz": (("header", "c01/1", "c01/1/others"), 200, lambda path: read_traces(path, "c01", 1)),
}


@pytest.mark.parametrize(("name", "parts", "most", "read"), [(name, *row) for name, row in READERS.items()])
def test_an_archive_is_measured_before_it_is_unpacked(
    name: str, parts: tuple[str, ...], most: int, read: Callable[[Path], object], tmp_path: Path
) -> None:
    with zipfile.ZipFile(tmp_path / name, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as file:
        for part in parts:
            file.writestr(f"{part}.npy", bytes(100_000_000))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(UsageError, match=f"it unpacks to more than {most} MB"):
        read(tmp_path / name)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000


def test_whatever_unpacks_files_asks_the_guard() -> None:
    """Only these modules may open what is packed; of a .npy and a .png the size is known before."""
    unpacks = re.compile(
        r"np\.load\(|ZipFile\((?!\w+, \"w\")|Image\.open\(|\b(gzip|bz2|lzma|tarfile|unpack_archive)\b"
    )
    source = Path(reading.__file__).parents[1]
    found = {
        path.relative_to(source).as_posix(): [each.group() for each in unpacks.finditer(text)]
        for path in source.rglob("*.py")
        if unpacks.search(text := path.read_text(encoding="utf-8"))
    }
    assert found == {
        "roadgpt/reading.py": ["np.load("],
        "roadgpt/ground/files.py": ["Image.open(", "np.load("],
    }


@pytest.mark.timeout(60)
@pytest.mark.parametrize("name", ["fifo.json", "fifo.xodr", "fifo.csv", "fifo.toml"])
def test_no_command_waits_for_a_pipe(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / name)
    words = ["campaign"] if name.endswith("toml") else ["check"]
    done = CliRunner().invoke(app, [*words, str(tmp_path / name)], prog_name="roadgpt")
    assert done.exit_code == 2
    assert name in done.stderr
    assert "is a pipe or a device, not a file" in done.stderr


@pytest.mark.parametrize("words", ["check", "drive", "show", "view", "export --to csv", "compare", "edit"])
@pytest.mark.parametrize("name", ["n" * 300 + ".json", "d/" * 3000 + "x.json", "loop.json"])
def test_names_that_cannot_be_are_told(
    words: str, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("loop.json").symlink_to("loop.json")
    more = {"compare": [name], "edit": ["--plan", "road: length more"]}.get(words, [])
    result = CliRunner().invoke(app, [*words.split(), name, *more], prog_name="roadgpt")
    assert result.exit_code in (1, 2), result.output
    assert "should not happen" not in result.stderr
    assert name[:60] in result.stderr


def design(**changes: object) -> dict[str, object]:
    """A design of one segment with these changes; None takes a field away."""
    place = {name: changes.pop(name) for name in ("starting_point", "theta") if name in changes}
    segment = {name: value for name, value in {**SEGMENT, **changes}.items() if value is not None}
    return {"starting_point": [9, 9, 0], "theta": 0, **place, "road_segment1": segment}


@dataclass(frozen=True)
class Thing:
    """Something that a file tells of."""

    number: float
    name: str
    places: tuple[int, ...] = ()


def test_a_value_of_a_file_has_the_types_that_it_says() -> None:
    assert reading.strictly(Thing, {"number": 1, "name": "a", "places": [1, 2]}) == Thing(1.0, "a", (1, 2))
    for data in (
        {"number": "1", "name": "a"},
        {"number": True, "name": "a"},
        {"number": float("nan"), "name": "a"},
        {"number": 1, "name": None},
        {"number": 1},
        {"number": 1, "name": "a", "places": "12"},
        [1, "a"],
        None,
    ):
        with pytest.raises(ValueError):  # noqa: PT011 - pydantic's, or json's
            reading.strictly(Thing, data)
