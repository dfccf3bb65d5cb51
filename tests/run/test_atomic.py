"""Whole or not at all."""

import csv
import json
import math
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from roadgpt.errors import UsageError
from roadgpt.run.atomic import (
    LOCK,
    alone_in,
    csv_text,
    json_text,
    sweep,
    whole_folder,
    write_lines,
    write_whole,
)


def test_a_file_is_replaced_whole(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    write_whole(path, "old")
    write_whole(path, b"new")
    assert path.read_text() == "new"
    assert [file.name for file in tmp_path.iterdir()] == ["a.txt"]


def test_a_write_that_fails_leaves_the_old_file_and_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.txt"
    write_whole(path, "old")

    def half(self: Path, data: bytes) -> int:
        with self.open("wb") as file:
            file.write(data[:2])
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "write_bytes", half)
    with pytest.raises(KeyboardInterrupt):
        write_whole(path, "newer")
    assert path.read_text() == "old"
    assert [file.name for file in tmp_path.iterdir()] == ["a.txt"]


def test_a_folder_takes_its_name_when_it_is_full(tmp_path: Path) -> None:
    place = tmp_path / "runs" / "0001"
    with whole_folder(place) as draft:
        (draft / "a").write_text("1")
        assert not place.exists()
    assert (place / "a").read_text() == "1"
    with whole_folder(place) as draft:
        (draft / "b").write_text("2")
    assert [file.name for file in place.iterdir()] == ["b"]


def test_a_folder_that_is_given_up_vanishes(tmp_path: Path) -> None:
    place = tmp_path / "0001"

    def give_up() -> None:
        with whole_folder(place) as draft:
            (draft / "a").write_text("1")
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError):
        give_up()
    assert not list(tmp_path.iterdir())


def test_what_a_killed_process_left_is_swept_away(tmp_path: Path) -> None:
    (tmp_path / "0002.4711.part").mkdir()
    (tmp_path / "0002.4711.part" / "road.json").write_text("{")
    (tmp_path / "a.json.4711.part").write_text("{")
    (tmp_path / "kept.json").write_text("{}")
    sweep(tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["kept.json"]


def test_half_a_letter_from_a_broken_terminal_is_kept(tmp_path: Path) -> None:
    words = b"a road \x80".decode("utf-8", "surrogateescape")
    write_whole(tmp_path / "a.json", json_text({"words": words}))
    assert json.loads((tmp_path / "a.json").read_text())["words"] == words


def test_numbers_that_are_not_finite_become_null() -> None:
    text = json_text({"a": math.inf, "b": [math.nan, 1.5, (2, -math.inf)], "c": "ü"})
    assert json.loads(text) == {"a": None, "b": [None, 1.5, [2, None]], "c": "ü"}


def test_a_lock_that_is_let_go_is_taken_by_one_only(tmp_path: Path) -> None:
    """One opens the file, the holder lets go, a third comes: it must meet the same file."""
    fcntl = pytest.importorskip("fcntl", reason="no locks on this platform")
    with alone_in(tmp_path):
        waiting = (tmp_path / LOCK).open("w")
    with waiting:
        fcntl.flock(waiting, fcntl.LOCK_EX | fcntl.LOCK_NB)
        with pytest.raises(UsageError, match="another process is at work"), alone_in(tmp_path):
            pass


def test_a_failure_under_the_lock_is_what_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As on Windows, where a file that is open cannot be removed."""

    def refuse(self: Path, missing_ok: bool = False) -> None:
        raise PermissionError(32, "the file is being used")

    monkeypatch.setattr(Path, "unlink", refuse)
    with pytest.raises(ZeroDivisionError), alone_in(tmp_path):
        _ = 1 / 0
    with alone_in(tmp_path):
        pass


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such locks")
def test_others_see_that_somebody_is_at_work(tmp_path: Path) -> None:
    with alone_in(tmp_path), pytest.raises(UsageError, match="another process"), alone_in(tmp_path):
        pass
    with alone_in(tmp_path):
        assert [path.name for path in tmp_path.iterdir()] == [LOCK]


def test_lines_are_written_whole_or_not_at_all(tmp_path: Path) -> None:
    def lines() -> Iterator[str]:
        yield "one\n"
        raise RuntimeError("enough")

    write_lines(tmp_path / "a.csv", ["old\n", "\udcff\n"])
    with pytest.raises(RuntimeError):
        write_lines(tmp_path / "a.csv", lines())
    assert (tmp_path / "a.csv").read_bytes() == b"old\n\\udcff\n"
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]


def test_no_text_of_a_table_is_computed_by_a_spreadsheet() -> None:
    rows = [["=1+1", "@SUM(A1)", "+cmd|' /C calc'!A0", "-HYPERLINK(B1)"], ["+1.750 m", "-0.5", "-", -2.5]]
    told = list(csv.reader(csv_text(("a", "=b", "c", "d"), rows).splitlines()))
    assert told == [
        ["a", "'=b", "c", "d"],
        ["'=1+1", "'@SUM(A1)", "'+cmd|' /C calc'!A0", "'-HYPERLINK(B1)"],
        ["+1.750 m", "-0.5", "-", "-2.5"],
    ]
