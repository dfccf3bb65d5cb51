"""The law of a campaign: its table follows from its plan, whatever the workers, orders and interruptions."""

import csv
import sqlite3
from collections import Counter
from collections.abc import Collection
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaign import quick
from campaign.quick import Inline, Search, a_design, plan, put_on_shelves
from roadgpt.campaign import scheduler
from roadgpt.campaign.executors import WorkerConfig
from roadgpt.campaign.lifecycle import begin, work
from roadgpt.campaign.model import Cell, CellBudget, Proposal
from roadgpt.campaign.record import Record, Store
from roadgpt.campaign.single_test import FinishedTest, Task
from roadgpt.errors import GivenUpError, RoadGPTError, UsageError


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    put_on_shelves(monkeypatch.setattr)
    Search.told.clear()


def worked(folder: Path, workers: int = 1, order: int = 0, **rest: Any) -> bytes:
    """The table of a campaign that was worked off at once."""
    Inline.rng = np.random.default_rng(order)
    begin(plan(**rest), folder)
    for _ in work(folder, workers, "inline"):
        pass
    return (folder / "results.csv").read_bytes()


@settings(max_examples=6)
@given(
    order=st.integers(0, 10**6),
    workers=st.integers(1, 9),
    stops=st.lists(st.integers(1, 12), max_size=5),
    cells=st.integers(1, 3),
)
def test_the_table_does_not_depend_on_who_worked_and_who_was_interrupted(
    order: int, workers: int, stops: list[int], cells: int
) -> None:
    with TemporaryDirectory() as once, TemporaryDirectory() as often:
        expected = worked(Path(once) / "c", tests=33, cells=cells)
        folder = Path(often) / "c"
        Inline.rng = np.random.default_rng(order)
        begin(plan(33, cells), folder)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("roadgpt.campaign.record.Store.group_seconds", 0.0)  # keep each group at once
            for stop in stops:
                steps = work(folder, workers, "inline")
                for _, _ in zip(range(stop), steps, strict=False):
                    pass
                steps.close()  # as a kill: what has not been kept is lost
            for _ in work(folder, workers + 1, "inline"):
                pass
        assert (folder / "results.csv").read_bytes() == expected
        assert len(list(csv.reader(expected.decode().splitlines()))) > 33 * cells


def losing(monkeypatch: pytest.MonkeyPatch, lost: Collection[tuple[str, int]]) -> None:
    """From now on the simulator fails in these tests."""

    def made(task: Task, cell: Cell, *earlier: Any) -> FinishedTest:
        ended, name = quick.made(task, cell, *earlier), (cell.name, task.number)
        if name not in lost:
            return ended
        said = f"no answer in {cell.name}/{task.number}"
        return replace(ended, result=replace(ended.result, outcome="ERROR", description=said), is_lost=True)

    monkeypatch.setattr(Store, "run_test", staticmethod(made))


def test_three_lost_in_a_row_by_number_end_it_and_its_table_does_not_depend_on_the_workers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Test 2 stays as it is; 11 to 13 and all that is lost after them is as if it had not been begun."""
    tables = set()
    for workers, order in ((1, 1), (3, 2), (9, 3), (9, 4)):
        folder = tmp_path / f"{workers}-{order}"
        losing(monkeypatch, [("c01", number) for number in (2, 4, 11, 12, 13, 14, 17)])
        with pytest.raises(GivenUpError, match=r"3 times in a row .*no answer in c01/1[34]\); fix it"):
            worked(folder, workers, order, tests=33)
        with Record.opened(folder) as record:
            lost = [result.number for result in record.results() if "no answer" in result.description]
        assert lost == [2, 4]
        losing(monkeypatch, ())
        tables.add(worked(folder, workers, order, tests=33))
    assert len(tables) == 1


def test_a_lost_test_before_an_unfinished_one_is_reopened_with_the_three_after_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Test 12 ends last; one worker alone would have given up at 13, with 11 and 12 lost."""

    def all_but_one(executor: Inline) -> None:
        slow = [job for job in executor.jobs if job.number == 12]
        for job in [job for job in executor.jobs if job not in slow] or slow:
            executor.jobs.remove(job)
            executor.end(job)

    tables = set()
    for workers in (1, 9):
        folder = tmp_path / str(workers)
        losing(monkeypatch, [("c01", number) for number in range(11, 16)])
        with monkeypatch.context() as patch:
            if workers > 1:
                patch.setattr(Inline, "some", all_but_one)
            with pytest.raises(GivenUpError, match="3 times in a row"):
                worked(folder, workers, tests=33)
        losing(monkeypatch, ())
        tables.add(worked(folder, workers, tests=33))
    assert len(tables) == 1


def test_lost_tests_that_only_end_one_after_another_are_not_in_a_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    losing(monkeypatch, [("c01", number) for number in range(34) if number % 3])
    worked(tmp_path / "c", workers=9, order=5, tests=33)
    losing(monkeypatch, [(cell, number) for cell in ("c01", "c03") for number in (1, 2)])
    worked(tmp_path / "d", workers=9, order=6, tests=2, cells=3)


def test_the_first_test_of_a_cell_follows_the_last_of_the_cell_before(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    losing(monkeypatch, [("c01", 2), ("c02", 1), ("c02", 2)])
    with pytest.raises(GivenUpError, match="no answer in c02/2"):
        worked(tmp_path / "c", workers=9, order=7, tests=2, cells=3)


class Threads(ThreadPoolExecutor):
    """An executor of Python's own, which knows nothing of campaigns."""

    def __init__(self, staff: WorkerConfig) -> None:
        super().__init__(staff.workers)


def test_any_executor_of_python_will_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = worked(tmp_path / "inline", tests=33)
    with monkeypatch.context() as patch:
        patch.setattr(quick, "Inline", Threads)
        put_on_shelves(patch.setattr)
        assert worked(tmp_path / "threads", workers=3, tests=33) == expected


def test_a_generator_is_told_all_batches_but_the_last_two_in_order(tmp_path: Path) -> None:
    worked(tmp_path / "c", workers=4, order=3, tests=32)
    asked = [step for step in Search.told if step[0] == "ask"]
    assert [batch for _, batch, _ in asked] == [*range(7)]
    before: list[int] = []
    for kind, batch, numbers in Search.told:
        if kind == "tell":
            assert numbers == [*range(5 * batch + 1, 5 * batch + 6)]
            before.append(batch)
        else:
            assert before == [*range(batch - 1)]


def test_a_draft_knows_the_designs_of_batches_that_were_told_and_forgets_the_oldest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(scheduler, "REMEMBERED", 20)
    monkeypatch.setattr(scheduler, "STRIDE", 10)
    worked(tmp_path / "c", tests=80)
    with Record.opened(tmp_path / "c") as record:
        results = [*record.results("c01")]
    drafted = [result for result in results if result.proposal.design is None]
    assert len(drafted) > 10
    for result in drafted:
        told = 5 * max(result.batch - 1, 0)
        known = int(result.description.split()[1])
        # the ten oldest go at once when there are more than twenty; what else is told is known
        assert known == (told if told <= 20 else told - 10 * -(-(told - 20) // 10))
        assert known <= 20 or told <= 20


def test_a_cell_ends_when_its_generator_has_nothing_more_to_ask(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ask = Search.ask
    monkeypatch.setattr(
        Search, "ask", lambda self, batch, *rest: ask(self, batch, *rest)[: 3 if batch < 2 else 0]
    )
    worked(tmp_path / "c", tests=30)
    with Record.opened(tmp_path / "c") as record:
        assert [result.number for result in record.results()] == [1, 2, 3, 4, 5, 6]
        assert record.query("SELECT closed FROM cells") == [("the generator had nothing left to propose",)]


def test_a_generator_that_asks_for_too_much_or_without_words_is_told_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        Search, "ask", lambda self, batch, first, n, pool: [Proposal(a_design(1), 1, "x")] * (n + 1)
    )
    with pytest.raises(RoadGPTError, match="proposed 6 tests, although 5 were asked for"):
        worked(tmp_path / "a", tests=30)
    monkeypatch.setattr(Search, "ask", lambda self, batch, first, n, pool: [Proposal(None, 1, "draft")] * n)
    begin(plan(5).model_copy(update={"prompts": ("",)}), tmp_path / "b")
    with pytest.raises(RoadGPTError, match="give a description"):
        [*work(tmp_path / "b", 1, "inline")]


def test_time_closes_a_cell_and_what_is_asked_is_finished(tmp_path: Path) -> None:
    begin(plan(1).model_copy(update={"budget": CellBudget(seconds=0.05)}), tmp_path / "c")
    steps = [*work(tmp_path / "c", 1, "inline")]
    with Record.opened(tmp_path / "c") as record:
        ((closed, seconds),) = record.query("SELECT closed, seconds FROM cells")
        waiting = record.query("SELECT count(*) FROM tests WHERE outcome IS NULL")
    assert closed == "its time limit was reached"
    assert seconds >= 0.05
    assert waiting == [(0,)]
    assert steps[-1].total() % 5 == 0
    assert steps[-1].total() > 0


def test_another_plan_in_the_same_folder_is_refused_and_the_same_goes_on(tmp_path: Path) -> None:
    table = worked(tmp_path / "c", tests=10)
    assert begin(plan(10), tmp_path / "c")
    with pytest.raises(UsageError, match=r"another campaign \(different number of tests"):
        begin(plan(11), tmp_path / "c")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "letter.txt").write_text("mine")
    with pytest.raises(UsageError, match="holds no campaign"):
        begin(plan(11), tmp_path / "other")
    (tmp_path / "c" / "results.csv").unlink()  # as if killed between the last result and the tables
    [*work(tmp_path / "c", 1, "inline")]
    assert (tmp_path / "c" / "results.csv").read_bytes() == table


def test_a_second_process_in_the_same_folder_is_refused(tmp_path: Path) -> None:
    begin(plan(40), tmp_path / "c")
    steps = work(tmp_path / "c", 1, "inline")
    next(steps)
    with pytest.raises(UsageError, match="another process is at work"):
        next(work(tmp_path / "c", 1, "inline"))
    with pytest.raises(UsageError, match="another process is at work"):
        begin(plan(40), tmp_path / "c")
    steps.close()
    for _ in work(tmp_path / "c", 1, "inline"):
        pass


def test_a_full_disk_is_told_and_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    expected = worked(tmp_path / "whole", tests=60)
    folder = tmp_path / "c"
    begin(plan(60), folder)
    connect = sqlite3.connect

    def full(*args: Any, **rest: Any) -> sqlite3.Connection:
        db = connect(*args, **rest)
        pages = db.execute("PRAGMA page_count").fetchone()[0] + 3  # of 4 kB: some of the tests fit
        db.execute(f"PRAGMA max_page_count = {pages}")
        return db

    with monkeypatch.context() as patch:
        patch.setattr("roadgpt.campaign.record.sqlite3.connect", full)
        with pytest.raises(
            RoadGPTError, match=r"cannot write into .*full; make room there, then say: roadgpt resume"
        ):
            [*work(folder, 1, "inline")]
    with Record.opened(folder) as record:
        kept = Counter(outcome is None for (outcome,) in record.query("SELECT outcome FROM tests"))
    assert 0 < kept.total() < 60
    [*work(folder, 1, "inline")]
    assert (folder / "results.csv").read_bytes() == expected


@pytest.mark.parametrize("share", [0.0, 0.13, 0.37, 0.5, 0.71, 0.94, 1.0])
def test_a_power_cut_loses_whole_transactions_that_are_done_again(tmp_path: Path, share: float) -> None:
    """SQLite's log is cut off anywhere, as when the last writes never came to the disk."""
    expected = worked(tmp_path / "whole", tests=60)
    folder = tmp_path / "c"
    begin(plan(60), folder)
    steps = work(folder, 3, "inline")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("roadgpt.campaign.record.Store.group_seconds", 0.0)
        for _ in zip(range(8), steps, strict=False):
            pass
    store, log = (folder / name for name in ("campaign.sqlite", "campaign.sqlite-wal"))
    files = {path.name: path.read_bytes() for path in (store, log)}
    steps.close()
    after = tmp_path / "after"
    after.mkdir()
    (after / store.name).write_bytes(files[store.name])
    whole = files[log.name]
    (after / log.name).write_bytes(whole[: int(share * len(whole))])
    if share:
        with Record.opened(after) as record:
            rows = record.query(
                "SELECT n, (SELECT count(*) FROM tests WHERE tests.batch = batches.batch),"
                " (SELECT count(*) FROM tests WHERE tests.batch = batches.batch AND outcome IS NULL), left"
                " FROM batches ORDER BY batch"
            )
        assert all(n == there and waiting == left for n, there, waiting, left in rows)
        assert all(earlier[3] == 0 for earlier, _ in pairwise(rows[:-1]))
    [*work(after, 2, "inline")]
    assert (after / "results.csv").read_bytes() == expected
