"""Campaigns: one folder, whatever happens on the way."""

import csv
import json
import os
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from campaign.folder_worker import REQUEST, Deadly, LargeDrawing, perform
from roadgpt import children
from roadgpt.brief.model import Brief, Clause, exactly
from roadgpt.campaign import campaign
from roadgpt.campaign.folder_record import open_record
from roadgpt.campaign.record import Store
from roadgpt.campaign.run_folder import Campaign, seed_in, work_in, write_runs
from roadgpt.campaign.scheduler import GIVE_UP
from roadgpt.errors import DesignError, RoadGPTError, UsageError
from roadgpt.road import Design, Road, World
from roadgpt.run import Request, Run, Setup, brief_of, read_run, seed_of
from run.doubles import FreshDesigner, Unable, a_design, folder_of, put_on_shelf

TESTS = Path(__file__).resolve().parents[1]
BRIEF = Brief(words="A road with a turn!")
NO_DRIVE = Setup(designer="double", drives=False)
ON_THE_CLOCK = {"seconds.json", "generation_stats.csv", "campaign.sqlite"}  # the last one holds the first


def contents(folder: Path) -> dict[str, bytes]:
    """All files but those that another day changes."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name not in ON_THE_CLOCK
    }


def is_finished(folder: Path) -> bool:
    with closing(sqlite3.connect(folder / "campaign.sqlite")) as db:
        ((said,),) = db.execute("SELECT value FROM meta WHERE name = 'finished'")
    return bool(said)


def table(folder: Path, name: str) -> dict[str, str]:
    (row,) = csv.DictReader((folder / name).open())
    return row


@pytest.fixture
def designer(monkeypatch: pytest.MonkeyPatch) -> FreshDesigner:
    double = FreshDesigner()
    put_on_shelf(monkeypatch, double=double)
    return double


def test_every_run_is_on_the_disk_when_it_is_handed_out(designer: FreshDesigner, tmp_path: Path) -> None:
    work = campaign(BRIEF, 4, 7, setup=NO_DRIVE, out=tmp_path / "c", draw=LargeDrawing())
    assert work.folder == tmp_path / "c"
    for number, run in enumerate(work, 1):
        assert run.index == number
        assert read_run(work.folder / "runs" / f"{number:04d}").design == run.design
        assert json.loads((work.folder / f"test.{number:04d}.json").read_text())["id"] == number
        assert table(work.folder, "generation_stats.csv")["test_generated"] == str(number)
    assert [earlier for _, earlier, _ in designer.calls] == [0, 1, 2, 3]
    assert len({run_seed for _, _, run_seed in designer.calls}) == 4
    assert (work.folder / "overview.png").is_file()
    assert is_finished(work.folder)


def test_without_a_folder_a_new_one_is_made(
    designer: FreshDesigner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    names = []
    for _ in range(2):
        work = campaign(BRIEF, 1, 7, setup=NO_DRIVE)
        list(work)
        names.append(str(work.folder))
    assert names == ["roadgpt-runs/a-road-with-a-turn-7", "roadgpt-runs/a-road-with-a-turn-7-2"]


def test_the_same_seed_gives_the_same_files_and_another_does_not(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    put_on_shelf(monkeypatch, double=FreshDesigner())
    setup = Setup(designer="double")
    for name, seed in (("a", 3), ("b", 3), ("c", 4)):
        assert len(list(campaign(BRIEF, 2, seed, setup=setup, out=tmp_path / name))) == 2
    one, other, third = (contents(tmp_path / name) for name in "abc")
    assert one == other
    assert "runs/0001/drive.npz" in one
    assert one["runs/0001/road.json"] != third["runs/0001/road.json"]


def test_a_campaign_that_was_left_goes_on(designer: FreshDesigner, tmp_path: Path) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    list(campaign(BRIEF, 5, 7, setup=NO_DRIVE, out=whole, draw=LargeDrawing()))
    for run in campaign(BRIEF, 5, 7, setup=NO_DRIVE, out=parts, draw=LargeDrawing()):
        if run.index == 2:
            break
    again = campaign(BRIEF, 5, 7, setup=NO_DRIVE, out=parts, draw=LargeDrawing())
    assert again.kept == (1, 2)
    assert not again.is_complete
    assert seed_in(parts) == 7
    assert [run.index for run in again.all_runs()] == [1, 2, 3, 4, 5]
    assert contents(whole) == contents(parts)
    assert table(parts, "generation_stats.csv")["test_generated"] == "5"


def test_roads_whose_files_were_taken_away_are_made_again(designer: FreshDesigner, tmp_path: Path) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    for place, n in ((whole, 4), (parts, 3)):
        list(campaign(BRIEF, n, 7, setup=NO_DRIVE, out=place))
    (parts / "test.0002.json").unlink()
    shutil.rmtree(parts / "runs" / "0003")
    again = campaign(BRIEF, 4, 7, setup=NO_DRIVE, out=parts)
    assert [run.index for run in again] == [2, 3, 4]
    assert contents(whole) == contents(parts)


def test_without_the_record_a_folder_is_shown_but_not_continued(
    designer: FreshDesigner, tmp_path: Path
) -> None:
    made = list(campaign(BRIEF, 2, 7, setup=NO_DRIVE, out=tmp_path))
    (tmp_path / "campaign.sqlite").unlink()
    before = contents(tmp_path)
    for is_again in (False, True):
        with pytest.raises(UsageError, match=r"has no campaign\.sqlite, .* make them anew in another folder"):
            campaign(BRIEF, 3, 7, setup=NO_DRIVE, out=tmp_path, again=is_again)
    assert contents(tmp_path) == before
    with open_record(tmp_path) as record:
        assert [record.run("", number).design for number in (1, 2)] == [run.design for run in made]


@pytest.mark.parametrize("damage", [b"", b"no database", b"SQLite format 3\0" + b"\xff" * 4000])
def test_a_record_that_is_damaged_is_told_in_a_sentence(
    designer: FreshDesigner, tmp_path: Path, damage: bytes
) -> None:
    list(campaign(BRIEF, 2, 7, setup=NO_DRIVE, out=tmp_path))
    (tmp_path / "campaign.sqlite").write_bytes(damage)
    told = r"campaign\.sqlite (cannot be read|is damaged|was written by another)"
    with pytest.raises(UsageError, match=told):
        campaign(BRIEF, 3, 7, setup=NO_DRIVE, out=tmp_path)
    (tmp_path / "campaign.sqlite").unlink()
    with open_record(tmp_path) as record:
        assert len(record.tests()) == 2


def test_a_record_of_others_reads_and_writes_nothing_outside_its_runs(
    designer: FreshDesigner, tmp_path: Path
) -> None:
    place = tmp_path / "runs-of-others"
    list(campaign(BRIEF, 1, 7, setup=NO_DRIVE, out=place))
    changes = ("number = -1", "number = 99999999999", "cell = '../../evil'", "number = '../evil'")
    for number, change in enumerate(changes):
        spoilt = shutil.copytree(place, tmp_path / str(number))
        with closing(sqlite3.connect(spoilt / "campaign.sqlite")) as db, db:
            db.execute(f"UPDATE tests SET {change}")
        with pytest.raises(UsageError, match=r"campaign\.sqlite is damaged"):
            list(write_runs(spoilt, tmp_path / "copy"))
    (place / "campaign.sqlite").rename(tmp_path / "mine.sqlite")
    (place / "campaign.sqlite").symlink_to(tmp_path / "mine.sqlite")
    with pytest.raises(UsageError, match=r"campaign\.sqlite is a link to somewhere else"):
        list(campaign(BRIEF, 2, 7, setup=NO_DRIVE, out=place))


def test_a_test_has_ended_when_its_row_is_there(
    designer: FreshDesigner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The process is killed right behind the row, and right before it."""
    keep = Store.keep
    for place, is_behind, left in ((tmp_path / "a", True, []), (tmp_path / "b", False, [2])):
        with monkeypatch.context() as patched:

            def killed(self: Store, ended: Any, *rest: Any, is_behind: bool = is_behind) -> None:
                numbers = [one.result.number for _, one in ended]
                if numbers != [2] or is_behind:
                    keep(self, ended, *rest)
                if numbers == [2]:
                    raise KeyboardInterrupt

            patched.setattr(Store, "keep", killed)
            with pytest.raises(KeyboardInterrupt):
                list(campaign(BRIEF, 2, 7, setup=NO_DRIVE, out=place))
        again = campaign(BRIEF, 2, 7, setup=NO_DRIVE, out=place)
        assert [run.index for run in again] == left
    assert contents(tmp_path / "a") == contents(tmp_path / "b")


def test_a_finished_campaign_is_not_made_again_but_can_grow(designer: FreshDesigner, tmp_path: Path) -> None:
    list(campaign(BRIEF, 2, 7, setup=NO_DRIVE, out=tmp_path))
    before = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*") if path.name != "campaign.lock"}
    again = campaign(BRIEF, 2, 7, setup=NO_DRIVE, out=tmp_path)
    assert again.is_complete
    assert list(again) == []
    assert [run.index for run in again.all_runs()] == [1, 2]
    assert all(path.stat().st_mtime_ns == time for path, time in before.items())
    assert [run.index for run in campaign(BRIEF, 3, 7, setup=NO_DRIVE, out=tmp_path)] == [3]


def test_a_folder_with_something_else_is_left_alone(designer: FreshDesigner, tmp_path: Path) -> None:
    (tmp_path / "thesis.docx").write_text("three years of work")
    with pytest.raises(UsageError, match="not empty"):
        campaign(BRIEF, 1, setup=NO_DRIVE, out=tmp_path)
    with pytest.raises(UsageError, match="name another folder"):
        campaign(BRIEF, 1, setup=NO_DRIVE, out=tmp_path / "thesis.docx")
    assert contents(tmp_path) == {"thesis.docx": b"three years of work"}


@pytest.mark.parametrize("setup", [Setup(designer="gtp"), Setup(simulator="beam"), Setup(driver="no.py:X")])
def test_a_missing_part_is_told_before_a_folder_is_made(setup: Setup, tmp_path: Path) -> None:
    with pytest.raises(UsageError):
        campaign(BRIEF, 1, setup=setup, out=tmp_path / "c")
    assert not list(tmp_path.iterdir())


def test_a_road_that_cannot_be_designed_costs_one_error(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    bad = {seed_of(7, 2)}
    put_on_shelf(monkeypatch, double=Unable(lambda seed: seed not in bad))
    runs = list(campaign(BRIEF, 3, 7, setup=NO_DRIVE, out=tmp_path, draw=LargeDrawing()))
    assert [run.outcome for run in runs] == ["VALID", "ERROR", "VALID"]
    assert "9 hairpins" in runs[1].description
    assert table(tmp_path, "generation_stats.csv")["test_in_error"] == "1"


@pytest.mark.parametrize(("asked", "tried"), [(1, 1), (2, 2), (50, GIVE_UP)])
def test_where_no_road_can_be_designed_the_campaign_ends(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, asked: int, tried: int
) -> None:
    seeds: list[int] = []
    put_on_shelf(monkeypatch, double=Unable(lambda seed: bool(seeds.append(seed))))
    with pytest.raises(DesignError, match="9 hairpins"):
        list(campaign(BRIEF, asked, 7, setup=NO_DRIVE, out=tmp_path))
    assert len(seeds) == tried


@pytest.mark.parametrize("out", [None, "new", "new/within", "empty"])
def test_where_no_road_can_be_designed_nothing_is_left_behind(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, out: str | None
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("empty").mkdir()
    put_on_shelf(monkeypatch, double=Unable())
    with pytest.raises(DesignError, match="9 hairpins"):
        list(campaign(BRIEF, 5, 7, setup=NO_DRIVE, out=out, draw=LargeDrawing()))
    assert [str(path) for path in Path().rglob("*")] == ["empty"]


def test_roads_that_could_not_be_designed_are_written_once_one_could(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    put_on_shelf(monkeypatch, double=Unable(lambda seed: seed not in {seed_of(7, 1), seed_of(7, 2)}))
    outcomes = []
    for run in campaign(BRIEF, 4, 7, setup=NO_DRIVE, out=tmp_path):
        outcomes.append(run.outcome)
        # the third is the first with a road, and the two before it are written with it
        assert table(tmp_path, "generation_stats.csv")["test_generated"] == str(max(run.index, 3))
    assert outcomes == ["ERROR", "ERROR", "VALID", "VALID"]
    assert len(list(tmp_path.glob("test.*.json"))) == 4


def start(folder: Path, roads: int, *more: str) -> subprocess.Popen[str]:
    worker = TESTS / "campaign" / "folder_worker.py"
    command = [sys.executable, str(worker), str(folder), str(roads), *more]
    paths = os.pathsep.join(map(str, (TESTS, TESTS.parent / "src")))
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={"PYTHONPATH": paths}
    )


def look(folder: Path) -> int:
    """How many roads are there: all whole, and told of by the tables but for the last one at most."""
    tests = sorted(folder.glob("test.*.json"))
    for number, path in enumerate(tests, 1):
        assert json.loads(path.read_text())["id"] == number
        run = read_run(path)
        assert run.index == number
        assert run.design is not None
        assert (folder / "runs" / f"{number:04d}" / "birds_eye.png").stat().st_size == 1_024_000
    if tests:
        stats = folder / "generation_stats.csv"
        told = int(table(folder, stats.name)["test_generated"]) if stats.exists() else 0
        assert told in (len(tests) - 1, len(tests))
        assert len(list(csv.DictReader((folder / "experiment_description.csv").open()))) == 1
    return len(tests)


def test_kill_9_at_random_moments_loses_at_most_the_road_in_flight(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    endless, folder, whole = 1_000_000, tmp_path / "killed", tmp_path / "whole"
    clock = random.Random(1)
    before = 0
    for _ in range(2):
        process = start(folder, endless)
        assert process.stdout is not None
        process.stdout.readline()  # it has begun to work
        time.sleep(clock.uniform(0, 0.15))
        process.kill()
        said = process.communicate()[0].split()
        assert process.returncode == -signal.SIGKILL
        there = look(folder)
        assert there > before
        if said:
            assert there >= int(said[-1])  # what was said to be done is there
        before = there
    roads = before + 2
    for place in (folder, whole):
        assert list(folder_of(REQUEST, roads, place, perform, LargeDrawing(), monkeypatch.setattr))
    assert look(folder) == roads
    assert contents(folder) == contents(whole)


def test_ctrl_c_leaves_a_campaign_that_is_told_of_completely(tmp_path: Path) -> None:
    process = start(tmp_path, 500, "--slow")
    assert process.stdout is not None
    process.stdout.readline()
    time.sleep(0.3)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=30)
    assert process.returncode != 0
    count = look(tmp_path)
    assert 1 <= count < 500
    assert table(tmp_path, "generation_stats.csv")["test_generated"] == str(count)
    assert not list(tmp_path.rglob("*.part"))
    assert not (tmp_path / "overview.png").exists()


def test_two_processes_do_not_work_in_one_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    process = start(tmp_path, 500, "--slow")
    assert process.stdout is not None
    process.stdout.readline()
    second = folder_of(REQUEST, 500, tmp_path, perform, LargeDrawing(), monkeypatch.setattr)
    with pytest.raises(RoadGPTError, match="another process is at work"):
        next(iter(second.all_runs()))  # not even the roads that are finished
    assert process.poll() is None
    process.kill()
    process.communicate()
    rest = folder_of(REQUEST, look(tmp_path) + 1, tmp_path, perform, LargeDrawing(), monkeypatch.setattr)
    assert len(list(rest)) == 1


def test_a_full_disk_is_told_in_a_sentence_and_leaves_whole_runs(
    designer: FreshDesigner, tmp_path: Path
) -> None:
    class Full(LargeDrawing):
        def of_run(self, run, folder):  # type: ignore[no-untyped-def]
            if run.index == 2:
                raise OSError(28, "No space left on device")

    with pytest.raises(RoadGPTError, match="No space left on device; make room"):
        list(campaign(BRIEF, 3, 7, setup=NO_DRIVE, out=tmp_path, draw=Full()))
    assert [path.name for path in (tmp_path / "runs").iterdir()] == ["0001"]
    assert len(list(campaign(BRIEF, 3, 7, setup=NO_DRIVE, out=tmp_path))) == 2


@pytest.mark.parametrize(("n", "seed"), [(0, 1), (-3, 1), (1, -1)])
def test_impossible_numbers_are_told(designer: FreshDesigner, tmp_path: Path, n: int, seed: int) -> None:
    with pytest.raises(UsageError, match=r"ask for 1 or more|no seed"):
        list(campaign(BRIEF, n, seed, setup=NO_DRIVE, out=tmp_path))


def test_roads_whose_files_were_damaged_are_made_again(designer: FreshDesigner, tmp_path: Path) -> None:
    whole, parts, copy = tmp_path / "whole", tmp_path / "parts", tmp_path / "copy"
    for place in (whole, parts):
        list(campaign(BRIEF, 3, 7, setup=NO_DRIVE, out=place))
    (parts / "runs" / "0001" / "road.json").write_text("{")
    (parts / "runs" / "0003" / "run.json").write_text((parts / "runs" / "0002" / "run.json").read_text())
    (parts / "oob_stats.csv").unlink()
    again = campaign(BRIEF, 3, 7, setup=NO_DRIVE, out=parts)
    assert again.kept == (2,)
    assert [run.index for run in again] == [1, 3]
    assert contents(whole) == contents(parts)
    assert len(list(write_runs(parts, copy))) == 3
    of_store = {"results.csv", "cells.csv", "campaign.lock"}
    assert contents(copy).items() >= {n: t for n, t in contents(whole).items() if n not in of_store}.items()
    with pytest.raises(UsageError, match="holds runs already"):
        list(write_runs(parts, copy))


def test_a_campaign_cannot_shrink_below_the_roads_that_are_there(
    designer: FreshDesigner, tmp_path: Path
) -> None:
    for run in campaign(BRIEF, 9, 7, setup=NO_DRIVE, out=tmp_path):
        if run.index == 5:
            break
    with pytest.raises(UsageError, match="holds road 5 already; ask for at least"):
        campaign(BRIEF, 3, 7, setup=NO_DRIVE, out=tmp_path)
    assert [run.index for run in campaign(BRIEF, 6, 7, setup=NO_DRIVE, out=tmp_path)] == [6]


def test_what_another_process_made_since_the_folder_was_opened_is_not_made_again(
    designer: FreshDesigner, tmp_path: Path
) -> None:
    first, second = (campaign(BRIEF, 3, 7, setup=NO_DRIVE, out=tmp_path) for _ in range(2))
    assert len(list(first)) == 3
    assert list(second) == []
    assert second.kept == (1, 2, 3)
    assert table(tmp_path, "generation_stats.csv")["test_generated"] == "3"


def test_a_campaign_that_was_stopped_before_it_had_a_road_can_begin_again(
    designer: FreshDesigner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(self: Path, data: bytes) -> int:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patched:
        patched.setattr(Path, "write_bytes", full)
        with pytest.raises(RoadGPTError, match="No space left"):
            list(campaign(BRIEF, 1, 7, setup=NO_DRIVE, out=tmp_path))
    assert len(list(campaign(BRIEF, 1, 7, setup=NO_DRIVE, out=tmp_path))) == 1


def test_earlier_designs_come_in_their_order_also_when_a_gap_is_filled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    request = Request(words="a road", seed=1, setup=Setup(drives=False))
    road = Road.through([[40, 100], [90, 100], [140, 100]])
    seen: dict[int, list[int]] = {}

    def one(index: int, earlier: Sequence[Design]) -> Run:
        seen[index] = [round(design.theta) for design in earlier]  # which is the seed
        return Run(request, index, index, design=a_design(index), road=road)

    list(folder_of(request, 4, tmp_path, one, patch=monkeypatch.setattr))
    (tmp_path / "test.0002.json").unlink()
    list(folder_of(request, 5, tmp_path, one, patch=monkeypatch.setattr))
    assert seen == {1: [], 2: [1], 3: [1, 2], 4: [1, 2, 3], 5: [1, 2, 3, 4]}


def made_of(home: Path, workers: int, roads: int = 4) -> dict[str, bytes]:
    """The files of two folders, of roads that real workers design; or those of this process, without any."""
    setup = Setup(reader="plan", drives=False)
    words = {"one": "turn x2", "other": "hairpin; straight"}
    briefs = {name: brief_of(text, setup=setup) for name, text in words.items()}
    folders = {
        name: Campaign.opened(Request(words=text, seed=3, setup=setup), briefs[name], roads, home / name)
        for name, text in words.items()
    }
    seen, before = [], {*children._running}
    for name, number, run in work_in(home, folders, workers):
        seen.append((name, number))
        assert (home / name / f"test.{number:04d}.json").is_file()
        assert (run is None) == (workers > 1)
        if workers > 1 and len(seen) == 2:
            os.kill(({*children._running} - before).pop().pid, signal.SIGKILL)
            (left := home / name / "runs" / "0004.1.part").mkdir()  # as one that is killed while it writes
            (left / "brief.json").touch()
    for name in words:
        assert sorted(number for each, number in seen if each == name) == [*range(1, roads + 1)]
        assert is_finished(home / name)
    assert {*children._running} <= before
    return {name: data for name, data in contents(home).items() if not name.startswith("workers.log")}


def test_folders_do_not_depend_on_workers_nor_on_the_death_of_one(tmp_path: Path) -> None:
    alone = made_of(tmp_path / "alone", 1)
    assert len([name for name in alone if name.endswith("road.json")]) == 8
    assert made_of(tmp_path / "killed", 2) == alone


def test_a_folder_that_no_road_fits_is_removed_and_the_others_are_made(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    put_on_shelf(monkeypatch, double=Unable(lambda seed: seed in {seed_of(7, n) for n in range(1, 5)}))
    folders = {
        name: Campaign.opened(
            Request(words=name, seed=seed, setup=NO_DRIVE), Brief(words=name), 4, tmp_path / name
        )
        for name, seed in (("able", 7), ("unable", 8))
    }
    tests = [name for name, _, _ in work_in(tmp_path, folders)]
    assert tests == ["able"] * 4
    assert folders["able"].failure == ""
    assert "9 hairpins" in folders["unable"].failure
    assert [path.name for path in tmp_path.iterdir()] == ["able"]


def test_workers_that_die_over_a_road_leave_one_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Here the first that dies is enough; that it is three is a matter of the executor."""
    monkeypatch.setattr("roadgpt.campaign.workers.MOST_DEATHS", 1)
    setup = Setup(reader="plan", drives=False)
    request = Request(words="straight | turns=0", seed=1, setup=setup)
    folder = Campaign.opened(
        request, brief_of(request.words, setup=setup), 2, tmp_path / "c", draw=Deadly(), workers=2
    )
    ended = {run.index: run for run in folder}
    assert {number: run.outcome for number, run in ended.items()} == {1: "VALID", 2: "ERROR"}
    assert "given up: 1 workers ended over it" in ended[2].description


def test_a_brief_that_was_written_by_hand_is_enough(tmp_path: Path) -> None:
    """It has no words; its roads are drafted all the same, and continued."""
    brief = Brief(clauses=(Clause(kind="turn", count=exactly(2)),))
    made = list(campaign(brief, 2, 3, World(), Setup(drives=False), tmp_path / "out"))
    assert [run.outcome for run in made] == ["VALID", "VALID"]
    shutil.rmtree(tmp_path / "out" / "runs" / "0002")
    again = list(campaign(brief, 2, 3, World(), Setup(drives=False), tmp_path / "out"))
    assert [run.design for run in again] == [made[1].design]
