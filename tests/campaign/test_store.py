"""What goes into the store comes out as it was; what is damaged is told; drives keep their numbers."""

import json
import math
import sqlite3
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from campaign.quick import a_design, plan
from roadgpt.brief.model import Brief
from roadgpt.campaign.model import Proposal, Result
from roadgpt.campaign.record import STORE, Record, Store
from roadgpt.campaign.single_test import FinishedTest
from roadgpt.campaign.traces import STEPS, drive_of, read_traces, trace_of, write_traces
from roadgpt.chat import Spent, Usage
from roadgpt.drive import COLUMNS, Box, Columns, Drive
from roadgpt.errors import RoadGPTError, UsageError
from roadgpt.traffic import SIZES, Actor, Tracks
from roadgpt.traffic.actor import rounded

BRIEFS = {"hairpin x2": Brief(words="hairpin x2")}
numbers = st.floats(allow_nan=False, allow_infinity=True, width=64)
maybe = st.none() | numbers
texts = st.text(st.characters(codec="utf-8"), max_size=20)


@st.composite
def proposals(draw: st.DrawFn) -> Proposal:
    design = draw(st.none() | st.integers(0, 1000).map(a_design))
    return Proposal(design, draw(st.integers(0, 2**63 - 1)), draw(texts))


@st.composite
def results(draw: st.DrawFn, number: int, proposal: Proposal) -> Result:
    failed = draw(st.booleans())
    return Result(
        number=number,
        batch=0,
        proposal=proposal,
        outcome=draw(st.sampled_from(["PASS", "FAIL", "INVALID", "ERROR", "VALID"])),
        description=draw(texts),
        design=proposal.design or draw(st.none() | st.integers(0, 1000).map(a_design)),
        length=draw(st.floats(0, 1e6)),
        margin=draw(maybe),
        max_oob=draw(maybe),
        beyond=draw(maybe),
        at_s=draw(maybe),
        side="left" if failed else None,
        cause="stuck" if failed else None,
        own_share=draw(maybe),
        handed_to=draw(st.none() | texts),
        features=draw(st.dictionaries(texts, st.floats(allow_nan=False, allow_infinity=False), max_size=4)),
    )


def a_store(folder: Path) -> Store:
    made = plan(99)
    return Store.new(folder, made.model_dump_json(), made.cells(BRIEFS), {"any": {"python": "3"}})


@settings(max_examples=8)
@given(st.data())
def test_results_cells_and_proposals_come_out_as_they_went_in(data: st.DataObject) -> None:
    asked = data.draw(st.lists(proposals(), min_size=1, max_size=4))
    done = [data.draw(results(number, made)) for number, made in enumerate(asked, 1)]
    kept = data.draw(st.integers(0, len(done)))
    with TemporaryDirectory() as name, a_store(Path(name)) as store:
        store.begin_session(1)
        store.add_batch("c01", 0, 1, asked)
        assert [task.proposal for task in store.waiting("c01")] == asked
        store.keep([("c01", FinishedTest(result)) for result in done[:kept]], None, {"c01": 1.5})
        with Record.opened(Path(name)) as record:
            assert [*record.results("c01")] == done[:kept]
            assert [task.number for task in record.waiting("c01")] == [*range(kept + 1, len(done) + 1)]
            assert record.batches("c01")[0].left == len(done) - kept
            assert record.cells() == plan(99).cells(BRIEFS)
            assert record.feature_names() == sorted({name for one in done[:kept] for name in one.features})


def test_a_batch_is_there_whole_or_not_at_all(tmp_path: Path) -> None:
    with a_store(tmp_path) as store:
        store.begin_session(1)
        store.add_batch("c01", 0, 1, [Proposal(None, 1, "draft")] * 3)
        with pytest.raises(RoadGPTError, match="cannot write"):
            store.add_batch("c01", 1, 3, [Proposal(None, 1, "draft")] * 3)  # number 3 is taken
        assert len(store.batches("c01")) == 1
        assert len(store.waiting("c01")) == 3
        with pytest.raises(UsageError, match="no result of test 2 of c01"):
            store.result("c01", 2)
        with pytest.raises(UsageError, match=r"there is no cell 'c9'.*cells are c01"):
            store.cell("c9")


def test_numbers_that_are_none_are_left_out(tmp_path: Path) -> None:
    made = Proposal(None, 1, "draft")
    broken = Result(
        1, 0, made, "FAIL", "x", margin=math.nan, features={"A": math.nan, "B": math.inf, "C": 1.0}
    )
    with a_store(tmp_path) as store:
        store.begin_session(1)
        store.add_batch("c01", 0, 1, [made])
        spent = Spent(usage=Usage(prompt=3, completion=4), cost=0.5)
        store.keep([("c01", FinishedTest(broken, spent=spent))])
        store.spend(Spent(usage=Usage(prompt=1), cost=0.25))
        found = store.result("c01", 1)
        assert found.margin is None
        assert found.features == {"C": 1.0}
        assert store.spent() == (8, 0.75)


def test_a_store_that_also_says_who_is_at_work_is_continued(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As those of earlier versions did, in a table of their own."""
    a_store(tmp_path).close()
    with sqlite3.connect(tmp_path / STORE) as db:
        db.execute("CREATE TABLE leases(cell TEXT, number INTEGER, worker TEXT, until REAL) ")
        db.execute("INSERT INTO leases VALUES ('c01', 1, 'worker 1 (4711)', 9e9)")
    db.close()
    monkeypatch.setattr("roadgpt.campaign.record._checked", set())
    with Store.opened(tmp_path) as store:
        store.begin_session(1)
        store.add_batch("c01", 0, 1, [made := Proposal(None, 1, "draft")])
        store.keep([("c01", FinishedTest(Result(1, 0, made, "VALID", "valid, not driven")))])
    with Record.opened(tmp_path) as there:
        assert [one.outcome for one in there.results("c01")] == ["VALID"]


def test_what_is_no_store_is_told(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="there is no campaign in"):
        Record.opened(tmp_path)
    (tmp_path / STORE).write_bytes(b"no database at all, but quite long enough to be one" * 50)
    with pytest.raises(UsageError, match=r"cannot be read .*name another folder"):
        Record.opened(tmp_path)
    (tmp_path / STORE).unlink()
    a_store(tmp_path).close()
    with sqlite3.connect(tmp_path / STORE) as db:
        db.execute("PRAGMA user_version = 99")
    db.close()
    with pytest.raises(UsageError, match="another version of roadgpt"):
        Store.opened(tmp_path)


def a_drive(steps: int, rng: np.random.Generator) -> Drive:
    columns = {name: np.cumsum(rng.normal(size=steps)) for name in COLUMNS} | {
        "time": np.arange(steps) * 0.02
    }
    return Drive("me", "mine", 7, Columns(columns), "goal", Box(4.5, 1.8, 0.1, 0.55))


def test_a_drive_comes_back_to_half_a_step(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    drives = [a_drive(steps, rng) for steps in (1, 700, 30)]
    named: Sequence[tuple[str, int]] = [("c01", 3), ("c02", 3), ("c01", 12)]
    written = [(cell, number, trace_of(drive)) for (cell, number), drive in zip(named, drives, strict=True)]
    name = write_traces(tmp_path, 5, written)
    for (cell, number), drive in zip(named, drives, strict=True):
        found = read_traces(tmp_path / "traces" / name, cell, number)
        assert (found.driver, found.simulator, found.seed) == ("me", "mine", 7)
        assert (found.ended, found.car) == (drive.ended, drive.car)
        assert np.array_equal(found["time"], np.arange(len(drive)) / 50)
        for column in COLUMNS:
            assert np.abs(found[column] - drive[column]).max() <= 0.5 * STEPS[column] * (1 + 1e-9)
    with pytest.raises(UsageError, match="holds no drive of test 4 of c01"):
        read_traces(tmp_path / "traces" / name, "c01", 4)
    (tmp_path / "traces" / name).write_bytes(b"PK not")
    with pytest.raises(UsageError, match="drive it again"):
        read_traces(tmp_path / "traces" / name, "c01", 3)


def test_the_same_drives_give_the_same_bytes(tmp_path: Path) -> None:
    drives = [("c01", number, trace_of(a_drive(80, np.random.default_rng(number)))) for number in (1, 2)]
    one, other = ((tmp_path / "traces" / write_traces(tmp_path, n, drives)).read_bytes() for n in (1, 2))
    assert one == other


def test_numpy_alone_reads_the_file_of_drives(tmp_path: Path) -> None:
    """As docs/how-to/run-campaigns.md says."""
    drive = a_drive(50, np.random.default_rng(2))
    name = write_traces(tmp_path, 1, [("c01", 1, trace_of(drive))])
    file = np.load(tmp_path / "traces" / name)
    header = json.loads(str(file["header"]))
    columns = file["c01/1"].cumsum(axis=1).cumsum(axis=1) * np.array(header["steps"])[:, None]
    assert columns[header["columns"].index("x")] == pytest.approx(drive["x"], abs=6e-4)


def test_a_bomb_is_not_unpacked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    name = write_traces(tmp_path, 1, [("c01", 1, trace_of(a_drive(5000, np.random.default_rng(2))))])
    monkeypatch.setattr("roadgpt.campaign.traces.UNPACKED", 100_000)
    with pytest.raises(UsageError, match=r"unpacks to more than 0\.1 MB"):
        read_traces(tmp_path / "traces" / name, "c01", 1)


@pytest.mark.parametrize(
    "spoil",
    [
        lambda header, rows: (header | {"format": 3}, rows),
        lambda header, rows: (header | {"columns": ["x"]}, rows),
        lambda header, rows: (header | {"drives": []}, rows),
        lambda header, rows: (header, rows.astype(float)),
        lambda header, rows: (header, rows[1:]),
        lambda header, rows: (header, rows[:, :0]),
        lambda header, rows: (header, rows.astype(object)),
    ],
)
def test_what_is_no_trace_is_refused_in_a_sentence(tmp_path: Path, spoil: Any) -> None:
    path = (
        tmp_path
        / "traces"
        / write_traces(tmp_path, 1, [("c01", 1, trace_of(a_drive(9, np.random.default_rng(1))))])
    )
    with np.load(path) as file:
        header, rows = spoil(json.loads(str(file["header"])), file["c01/1"])
    with path.open("wb") as out:
        np.savez(out, **{"header": np.array(json.dumps(header)), "c01/1": rows})
    with pytest.raises(UsageError, match=r"holds no drive of test 1 of c01 \(.+\); drive it again"):
        read_traces(path, "c01", 1)


def test_what_is_no_number_and_what_is_far_away_stay_so(tmp_path: Path) -> None:
    columns = {name: np.array([0.0, math.nan, 1e9, -math.inf]) for name in COLUMNS}
    trace = trace_of(Drive("me", "mine", 7, Columns(columns), "fell", Box(4.5, 1.8)))
    found = drive_of(trace)
    kept = read_traces(tmp_path / "traces" / write_traces(tmp_path, 1, [("c01", 1, trace)]), "c01", 1)
    assert all(np.array_equal(kept[name], found[name], equal_nan=True) for name in COLUMNS)
    assert np.isnan(found["x"]).tolist() == [False, True, False, False]
    assert found["x"][2] == -found["x"][3] == pytest.approx((2**31 - 1) / 1000)


def test_the_others_of_a_stored_drive_are_exactly_those_of_the_drive(tmp_path: Path) -> None:
    count = 60
    columns = {name: np.linspace(0.0, 1.18, count) for name in COLUMNS}
    states = np.full((13, 2, 5), np.nan)
    states[:, 0] = rounded(np.random.default_rng(1).uniform(-500, 500, (13, 5)))
    states[4:9, 1] = rounded(np.random.default_rng(2).uniform(-500, 500, (5, 5)))
    others = Tracks((Actor("car 1", "car", SIZES["car"]), Actor("child 1", "child", SIZES["child"])), states)
    drive = Drive(
        "me", "mujoco", 1, Columns(columns), "goal", Box(4.7, 1.86), (), others, True, ("it never happened",)
    )
    alone = Drive("me", "mujoco", 1, Columns(columns), "goal", Box(4.7, 1.86))
    name = write_traces(tmp_path, 1, [("c1", 7, trace_of(drive)), ("c1", 8, trace_of(alone))])
    stored = read_traces(tmp_path / "traces" / name, "c1", 7)
    assert (stored.lights, stored.missed) == (True, ("it never happened",))
    found = stored.others
    assert found is not None
    assert found.actors == others.actors
    assert np.array_equal(found.states, states, equal_nan=True)
    assert read_traces(tmp_path / "traces" / name, "c1", 8).others is None
