"""Failures that a campaign looks into: distinct faults, then one of each; what status and report say."""

import csv
import json
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from page_words import words_of
from roadgpt.campaign.folder_record import kept_run, run_again
from roadgpt.campaign.model import NumberedTest
from roadgpt.campaign.workers import InProcess
from roadgpt.cli import app
from roadgpt.errors import UsageError
from roadgpt.run import Run
from roadgpt_search.faults import fault as fault_module
from roadgpt_search.faults import fault_log, remedy
from roadgpt_search.faults.failures import failures_of, reason_of
from roadgpt_search.faults.fault import faults_in
from roadgpt_search.faults.fault_log import FailureAnalysis
from roadgpt_search.faults.minimise import Simplest
from roadgpt_search.faults.remedy import REMEDIES, Removed
from roadgpt_search.faults.stability import Repeated, Stability, disturbance_of

CUTS = ["--driver", "beamng_like", "--oracle", "thesis"]  # cuts the inside of bends
WORDS = ["zigzag x3 | down", "-n", 2, "--friction", 0.4, "--seed", 3, "--reader", "plan", *CUTS]


def roadgpt(*words: object) -> Result:
    done = CliRunner().invoke(app, [str(word) for word in words])
    assert done.exit_code == 0, done.output
    return done


def table(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as file:
        return [*csv.DictReader(file)]


def failed_again(run: Run, times: int) -> Stability:
    """What disturbed drives of a stable failure give, without driving."""
    drives = (Repeated(number, disturbance_of(run.seed, number), True, -0.1, 9.0) for number in range(times))
    return Stability(tuple(drives))


@pytest.fixture(scope="module", autouse=True)
def campaigns_run_here() -> Iterator[None]:
    """As with ``no_workers``, for the fixtures of this file as well."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("roadgpt.campaign.executors.processes.Processes", InProcess)
        yield


@pytest.fixture(scope="module")
def looked(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign whose roads fail, and were looked into when it was done."""
    folder = tmp_path_factory.mktemp("looked") / "c"
    done = roadgpt("campaign", *WORDS, "--out", folder, "--faults", "--repeat", 2, "--json")
    (line,) = done.stdout.splitlines()
    assert json.loads(line)["outcomes"] == {"FAIL": 2}
    assert "2 failures in 2 groups of similar failures; no small change accounts for them" in done.stderr
    return folder


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign with more failures than faults; a genetic algorithm finds the same again and again."""
    folder = tmp_path_factory.mktemp("many") / "c"
    words = ["| flat turns=1..", "--goal", "failures", "-n", 40, "--seed", 7, "--reader", "plan", "-q"]
    genetic = ["--generator", "genetic", "--map-size", 200, "--driver", "beamng_like", "--oracle", "half"]
    roadgpt("campaign", *words, *genetic, "--out", folder)
    return folder


@pytest.fixture(scope="module")
def reported(looked: Path, many: Path) -> tuple[Path, Path]:
    """Both, with their reports."""
    for folder in (looked, many):
        roadgpt("report", folder)
    return looked, many


def test_a_campaign_looks_into_its_failures_when_it_is_done(looked: Path) -> None:
    found = faults_in(looked)
    rows = table(looked / "faults" / "faults.csv")
    assert [int(row["failures"]) for row in rows] == [len(fault.members) for fault in found.them]
    assert {row["drives"] for row in rows} == {"2"}
    failures = table(looked / "faults" / "failures.csv")
    assert [row["test"] for row in failures] == ["c01/1", "c01/2"]
    assert {row["fault"] for row in failures} == {row["fault"] for row in rows}
    assert found.failures == found.compared == 2


def test_every_column_of_failures_is_that_of_the_verdict(many: Path, tmp_path: Path) -> None:
    """And of the bend that the lane's middle takes there, measured by its heading; every column of faults is
    that of the analysis, in the unit of its name.
    """
    folder = shutil.copytree(many, tmp_path / "c")
    every = faults_in(folder)
    groups = (*every.them, *every.alone)
    half = len(groups) // 2
    them = tuple(replace(group, number=number) for number, group in enumerate(groups[:half], 1))
    found = replace(every, them=them, alone=tuple(replace(group, number=0) for group in groups[half:]))
    assert found.them
    assert found.alone
    analyses = {}
    for fault in found.them:
        run = kept_run(folder, *fault.names[0])
        stability = Stability(
            tuple(replace(each, failed=each.number > 1) for each in failed_again(run, 8).drives)
        )
        analyses[fault.number] = FailureAnalysis(fault.names[0], reason_of(run), stability, "a simple road")
    fault_log.write_tables(found, analyses, folder)
    fault_of = {each.name: str(fault.number) for fault in found.them for each in fault.members}
    fault_of |= {each.name: "" for group in found.alone for each in group.members}
    rows = table(folder / "faults" / "failures.csv")
    assert [row["test"] for row in rows] == [str(name) for name in sorted(fault_of)]
    assert len(rows) > 20
    for row, name in zip(rows, sorted(fault_of), strict=True):
        run = kept_run(folder, *name)
        verdict, road = run.verdict, run.road
        assert verdict is not None
        assert road is not None
        assert (verdict.outcome, row["fault"]) == ("FAIL", fault_of[name])
        assert float(row["station_m"]) == pytest.approx(verdict.at_s, abs=0.0501)
        assert float(row["max_oob"]) == pytest.approx(verdict.max_oob, abs=0.000501)
        assert float(row["beyond_m"]) == pytest.approx(verdict.beyond, abs=0.000501)
        s = np.arange(max(verdict.at_s - 25, 0.0), min(verdict.at_s + 5, road.length), 0.1)
        x, y, _ = road.at(s, -run.world.section.lane_width / 2).T
        heading = np.unwrap(np.arctan2(np.diff(y), np.diff(x)))
        turning = np.diff(heading) / np.hypot(np.diff(x), np.diff(y))[1:]
        tightest = int(np.abs(turning).argmax())
        if verdict.cause in ("stuck", "timeout"):
            wanted = {"stuck": "stopped", "timeout": "late"}[verdict.cause], ""
        elif not row["radius_m"]:
            wanted = "off", ""
            assert np.abs(turning).max() < 1 / 150
        else:
            side = "left" if turning[tightest] > 0 else "right"
            wanted = ("inside" if verdict.side == side else "wide"), side
            radius = 1 / abs(float(road.curvature(s[tightest + 1])))
            assert float(row["radius_m"]) == pytest.approx(radius, rel=0.02, abs=0.06)
        assert (row["way"], row["side"]) == wanted
    for row, fault in zip(table(folder / "faults" / "faults.csv"), found.them, strict=True):
        reason = analyses[fault.number].reason
        assert (row["test"], row["failures"]) == (str(fault.names[0]), str(len(fault.members)))
        assert (row["failed_again"], row["drives"], row["share"]) == ("6", "8", "0.750")
        assert (row["way"], row["side"]) == (reason.way, reason.side or "")
        assert (row["reason"], row["simplest"], row["removed_by"]) == (reason.sentence, "a simple road", "")
        for column, value in (
            ("fault", fault.number),
            ("radius_m", reason.radius),
            ("entered_kmh", reason.entered * 3.6),
            ("needed_g", reason.needed),
            ("grade", reason.grade),
            ("station_m", reason.station),
        ):
            step = 0.0501 if column.endswith(("_m", "kmh")) else 0.000501
            assert (
                row[column] == "" if value is None else float(row[column]) == pytest.approx(value, abs=step)
            )


def test_pictures_of_faults_are_written_in_every_format_asked_for(looked: Path, tmp_path: Path) -> None:
    """What was driven again is not driven again for a picture, and the report links to what is there."""
    folder = shutil.copytree(looked, tmp_path / "c")
    there = {path.stem for path in (folder / "faults").rglob("*.png")}
    assert there
    pages = {path: path.stat().st_mtime_ns for path in (folder / "faults" / "c01").glob("*.json")}
    done = roadgpt("faults", folder, "--repeat", 2, "--format", "svg,pdf")
    assert {path.stem for path in (folder / "faults").rglob("*.svg")} == there
    assert {path.stem for path in (folder / "faults").rglob("*.pdf")} == there
    assert f"{folder / 'faults' / 'c01'}/*.pdf" in done.stdout
    assert pages == {path: path.stat().st_mtime_ns for path in pages}
    for path in (folder / "faults").rglob("*.png"):
        path.unlink()
    roadgpt("report", folder)
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert all(f'href="faults/c01/{name}.svg"' in page for name in there)


def test_only_a_typical_failure_of_each_fault_is_driven_again(
    many: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On 154 failures in minutes: what is alike is found first, from what is kept."""
    folder = shutil.copytree(many, tmp_path / "c")
    driven: list[int] = []
    monkeypatch.setattr(
        fault_log, "repeated", lambda run, times: driven.append(run.index) or failed_again(run, times)
    )
    found = faults_in(folder)
    assert len(found.them) < found.failures / 2
    assert not driven
    roadgpt("faults", folder, "--groups", "--repeat", 1, "--no-plot", "-q")
    assert not (folder / "faults" / "remedies").exists()
    most = sum(min(len(fault.members), 3) for fault in found.them)
    assert len(found.them) <= len(driven) <= most < found.failures
    mates = [{each.name.number for each in fault.members} for fault in found.them]
    for row, its in zip(table(folder / "faults" / "faults.csv"), mates, strict=True):
        assert int(row["test"].removeprefix("c01/")) in its
    before = [*driven]
    roadgpt("faults", folder, "--groups", "--repeat", 1, "--no-plot", "-q")
    assert driven == before, "what was done is not done again"


def test_what_is_done_is_kept_when_it_is_stopped(
    many: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = shutil.copytree(many, tmp_path / "c")
    asked: list[int] = []

    def stopped(run: Run, times: int) -> object:
        asked.append(run.index)
        if len(asked) == 2:
            raise KeyboardInterrupt
        return failed_again(run, times)

    monkeypatch.setattr(fault_log, "repeated", stopped)
    done = CliRunner().invoke(app, ["faults", str(folder), "--groups", "--repeat", "1", "--no-plot"])
    assert done.exit_code == 130
    assert f"continue with: roadgpt faults {folder} --repeat 1 --groups --no-plot" in done.output
    roadgpt("faults", folder, "--groups", "--repeat", 1, "--no-plot", "-q")
    assert asked.count(asked[0]) == 1
    assert asked.count(asked[1]) == 2


def test_where_the_most_typical_failure_is_a_fluke_others_are_tried(
    many: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = shutil.copytree(many, tmp_path / "c")
    largest = faults_in(folder).them[0]
    first, second = largest.names[:2]

    class GivenStability:
        def __init__(self, run: Run) -> None:
            self.share = 0.1 if run.index == first.number else 0.9
            self.is_stable = self.share >= 0.5
            self.sentence, self.drives = "", ()

    monkeypatch.setattr(fault_log, "repeated", lambda run, times: GivenStability(run))
    _, found = fault_log.analyse(folder, 1, False, (), (1, largest.names))
    assert found.name == second
    monkeypatch.setattr(fault_log, "repeated", lambda run, times: pytest.fail("no more drives are needed"))


def test_status_and_screen_count_faults_before_failures(many: Path) -> None:
    found = faults_in(many)
    said = roadgpt("show", many).output
    groups = f"{found.failures} failures in {len(found.them)} groups of similar failures"
    assert f"{groups}: the car cut the inside" in said
    assert said.index(groups) < said.index(f"{found.failures} FAIL")
    assert f"how many faults these are, why, how often again, and pictures: roadgpt faults {many}" in said
    told = json.loads(roadgpt("show", many, "--json").stdout)["distinct"]
    count = found.failures
    assert told == {"faults": None, "groups": len(found.them), "failures": count, "compared": count}


def test_failures_that_one_small_change_removes_are_one_fault(
    many: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The car cuts the inside of tight right bends, on all sorts of roads; of each group one is tested, then
    two more of the fault, with half of the kinds of changes.
    """
    few = tuple(each for each in remedy.REMEDIES if each.kind in ("wider", "eased", "apart", "slower"))
    monkeypatch.setattr(remedy, "REMEDIES", few)
    monkeypatch.setattr(fault_module, "MOST_FIRST", 1)
    monkeypatch.setattr(fault_module, "CHECKED", 2)
    folder = shutil.copytree(many, tmp_path / "c")
    news = roadgpt("faults", folder, "--repeat", 1, "--no-plot").stderr
    assert ["round 1:" in news, "round 2:" in news] == [True, True], "each round is announced"
    found = faults_in(folder)
    (first,) = [fault for fault in found.them if fault.remedy]
    assert str(first.remedy).split()[0] in ("wider", "eased"), "both make the bend less tight"
    assert len(first.members) > found.failures / 2
    said = roadgpt("show", folder).output
    assert f"1 distinct fault in {found.failures} failures" in said
    sampled = faults_in(folder, 9)
    assert (sampled.sentence, sampled.compared) == (found.sentence, found.failures)
    told = json.loads(roadgpt("show", folder, "--json").stdout)["distinct"]
    assert (told["faults"], told["groups"]) == (1, len(found.alone))
    roadgpt("report", folder)
    text = words_of(folder)
    assert "## Distinct faults" in text
    assert f"Disappears with {first.removed_by}." in text
    rows = table(folder / "faults" / "faults.csv")
    assert [row["removed_by"] for row in rows] == [first.remedy], "groups without a fault are not exported"
    faults = {row["fault"] for row in table(folder / "faults" / "failures.csv")}
    assert faults == ({"1", ""} if found.alone else {"1"})


def test_a_fault_is_tested_on_twelve_more_failures_and_those_that_stay_leave_it(
    many: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without drives: a larger radius removes all failures but the first of the further ones."""
    tested: dict[NumberedTest, Removed] = {}
    stays: set[NumberedTest] = set()
    none = {remedy.name: False for remedy in REMEDIES}
    monkeypatch.setattr(fault_module, "has_remedies", lambda folder: bool(tested))
    monkeypatch.setattr(fault_module, "stored_remedies", lambda folder, each: tested.get(each.name))
    found = faults_in(many)
    first = len(found.to_test)
    assert found.to_come == first + 12, "what is announced"
    while found.to_test:
        assert not found.is_tested
        assert not any(each.name in tested for each in found.to_test), "no failure is tested twice"
        if len(tested) == first:
            stays = {found.to_test[0].name}
        for each in found.to_test:
            tested[each.name] = none | {"wider 15": each.name not in stays}
        found = faults_in(many)
    assert found.is_tested
    (its,) = [each for each in found.them if each.remedy]
    inside = {each.name for each in its.members}
    assert len(tested) == first + 12 + len(stays)
    assert len(tested) < found.failures, "a fault is known before all its failures are tested"
    assert stays
    assert not stays & inside
    assert sum(len(each.members) for each in (*found.them, *found.alone)) == found.failures


def test_of_very_many_failures_an_even_sample_is_compared(many: Path) -> None:
    (every, count), (some, their_count) = failures_of(many), failures_of(many, 9)
    assert len(every) == count == their_count
    assert len(some) == 9
    assert [each.name for each in some][::8] == [every[0].name, every[-1].name]
    found = faults_in(many, 9)
    groups = f"at least {len(found.them)} groups of similar failures"
    assert found.sentence == f"{count} failures in {groups} (9 of them compared)"


def test_the_report_begins_with_the_faults(reported: tuple[Path, Path]) -> None:
    for folder in reported:
        found = faults_in(folder)
        text = words_of(folder)
        assert text.index("groups of similar failures") < text.index(" FAIL")
        heads = [line.removeprefix("## ") for line in text.splitlines() if line.startswith("## ")]
        assert heads[0] == "Groups of similar failures"
        assert heads[1:3] == ["At a glance", "Outcomes"]
        page = (folder / "report.html").read_text(encoding="utf-8")
        (groups,) = [part for part in page.split("<h2")[1:] if ">Groups of similar failures<" in part]
        assert groups.count("<article>") == min(len(found.them), 24)
        rows = table(folder / "tables" / "faults.csv")
        assert [int(row["tests"]) for row in rows] == [len(fault.members) for fault in found.them]


def test_the_simplest_road_is_looked_for_once(looked: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []

    def quick(run: Run) -> Simplest:
        asked.append(run.index)
        return Simplest(run, 1, 1, True)

    monkeypatch.setattr(fault_log, "simplest", quick)
    for _ in range(2):
        roadgpt("resume", looked, "--minimise", "--repeat", 2, "--quiet")
    rows = table(looked / "faults" / "faults.csv")
    assert len(asked) == len(rows)
    for row, number in zip(rows, asked, strict=True):
        assert row["test"] == f"c01/{number}"
        assert row["simplest"].startswith("1 segment -> ")
        assert (looked / "faults" / "simplest" / "c01" / "runs" / f"{number:04d}" / "run.json").is_file()


def test_what_somebody_spoilt_is_told(looked: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(looked, tmp_path / "c")
    for page in (folder / "faults" / "c01").glob("*.json"):
        page.write_text('{"seed": 1')
    for command in ("report", "faults"):
        done = CliRunner().invoke(app, [command, str(folder)])
        assert isinstance(done.exception, UsageError) or done.exit_code == 2
        assert "cannot be read" in f"{done.output} {done.exception}"
        assert "remove it, and it is made again" in " ".join(f"{done.output} {done.exception}".split())


def test_a_test_as_it_was_kept_is_the_test_as_it_is_driven_again(looked: Path) -> None:
    for number in (1, 2):
        kept, (again, _) = kept_run(looked, "c01", number), run_again(looked, "c01", number)
        assert kept.drive is not None
        assert kept.verdict is not None
        assert again.drive is not None
        assert again.verdict is not None
        for name in ("outcome", "description", "seed", "design", "request", "findings", "length"):
            assert getattr(kept, name) == getattr(again, name)
        for name in ("outcome", "cause", "side", "margin", "at_s", "max_oob", "oob_counter"):
            assert getattr(kept.verdict, name) == getattr(again.verdict, name)
        assert kept.verdict.at_xy == pytest.approx(again.verdict.at_xy, abs=0.001)
        assert np.abs(kept.drive["x"] - again.drive["x"]).max() <= 0.00051
        assert len(kept.drive) == len(again.drive)


def test_a_report_goes_on_without_a_drive_that_cannot_be_read(looked: Path, tmp_path: Path) -> None:
    folder = shutil.copytree(looked, tmp_path / "c")
    shutil.rmtree(folder / "faults")
    for trace in (folder / "traces").iterdir():
        trace.write_bytes(b"spoilt")
    roadgpt("report", folder)
    text = words_of(folder)
    assert faults_in(folder).sentence in text
    assert "Left its lane to the" in text
    done = CliRunner().invoke(app, ["view", f"{folder}/c01/1", "--out", str(tmp_path / "v.html")])
    assert done.exit_code == 2
    assert "holds no drive of test 1 of c01" in done.output
