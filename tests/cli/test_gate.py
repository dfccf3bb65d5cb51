"""The gate for continuous integration: what makes a command end with exit status 6, and what does not."""

import json
import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import pytest
from click.testing import Result
from hypothesis import given
from hypothesis import strategies as st

from command_line import invoke
from roadgpt import provenance
from roadgpt.campaign.gate import Gate
from roadgpt.errors import GateError, UsageError
from roadgpt.road import Road, World
from roadgpt.run import Request, Run, Setup, prove, write_run
from roadgpt.verdict import JUDGEMENT

STRAIGHT = [[60, 100], [100, 100], [140, 100]]
BEND = [[60, 100], [90, 100], [100, 110], [100, 140]]
LONG = [[20, 100], [100, 100], [200, 100]]
SHORT = [[60, 100], [70, 100]]
STRAIGHT_ON = """
from roadgpt.drive import Command
class Mine:
    def start(self, road, world, seed):
        self.length = road.length
    def steer(self, view):
        if self.length > 150:
            raise RuntimeError("too long for me")
        return Command(0.0, 0.5 if view.speed < 9 else 0.0, 0.0)
"""
MINE = ("--driver", "mine.py:Mine")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Road files of which the driver beside them passes one, fails one and crashes on one; one is invalid."""
    folder = tmp_path_factory.mktemp("gate")
    (folder / "mine.py").write_text(STRAIGHT_ON)
    (folder / "roads").mkdir()
    roads = {"a-straight": STRAIGHT, "b-bend": BEND, "c-long": LONG, "d-short": SHORT}
    for name, points in roads.items():
        (folder / "roads" / f"{name}.json").write_text(json.dumps(points))
    (folder / "roads" / "notes.txt").write_text("no road")
    (folder / "roads" / "b-bend.drive.csv").write_text("s,t")
    before = Path.cwd()
    os.chdir(folder)
    try:
        done = invoke("drive", "roads", *MINE, "--out", "first")
    finally:
        os.chdir(before)
    assert done.exit_code == 0, done.output
    assert [line.split()[1] for line in done.stdout.splitlines() if "/4 " in line[:5]] == [
        "PASS", "FAIL", "ERROR", "INVALID"
    ]  # fmt: skip
    assert done.stderr == "roadgpt: roads: left out, as without a road: notes.txt\n"
    provenance.CODE.forget()
    return folder


@pytest.fixture
def here(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    shutil.copytree(made, tmp_path / "here")
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


def said(done: Result) -> str:
    """What the gate says: the last line of standard error."""
    return done.stderr.splitlines()[-1].removeprefix("roadgpt: ")


def test_a_driven_folder_fails_with_status_6_when_all_is_written(here: Path) -> None:
    words = ("drive", "roads", *MINE, "--fail-on", "fail", "--fail-on", "invalid,75%")
    done = invoke(*words, "--junit", "tests.xml", "--json", "--out", "again")
    assert done.exit_code == 6
    assert said(done) == "1 of 4 roads FAIL; 1 of 4 roads INVALID"
    assert len(done.stdout.splitlines()) == 4
    assert len([*Path("again").glob("test.*.json")]) == 4
    assert ElementTree.parse("tests.xml").getroot()[0].get("failures") == "1"


@pytest.mark.parametrize("rule", ["", "fails", "-1%", "101%", "10", "%", "1e1%", "fail,,error", "nan%"])
def test_a_rule_that_is_none_is_refused(rule: str) -> None:
    done = invoke("drive", "a.json", "--fail-on", rule)
    assert done.exit_code == 2
    assert "give fail, invalid, error or N%" in done.stderr


OUTCOMES = st.lists(st.sampled_from(["PASS", "FAIL", "NOT TESTED", "INVALID", "ERROR", "VALID"]), max_size=30)


@given(OUTCOMES, st.sets(st.sampled_from(["FAIL", "INVALID", "ERROR"])), st.none() | st.integers(0, 1000))
def test_the_gate_fails_exactly_as_the_guide_defines(
    outcomes: list[str], named: set[str], per_mille: int | None
) -> None:
    rules = tuple(named) + (() if per_mille is None else (f"{per_mille / 10:g}%",))
    gate = Gate(None, rules)
    for number, outcome in enumerate(outcomes):
        gate.add(str(number), Run(Request(), number, 0, outcome))  # type: ignore[arg-type]
    driven = [outcome for outcome in outcomes if outcome in ("PASS", "FAIL")]
    is_broken = "INVALID" in named and "NOT TESTED" in outcomes
    is_broken |= bool(named & {*outcomes}) or (not driven and ("FAIL" in named or per_mille is not None))
    if per_mille is not None and driven:
        is_broken |= Fraction(driven.count("FAIL"), len(driven)) > Fraction(per_mille, 1000)
    if is_broken:
        with pytest.raises(GateError) as raised:
            gate.close()
        assert raised.value.exit_status == 6
    else:
        gate.close()


def a_run(
    folder: Path | None = None, points: list[list[float]] = STRAIGHT, number: int = 1, margin: float = 1.0,
    outcome: str = "PASS", world: World | None = None, setup: Setup | None = None,
) -> Run:  # fmt: skip
    """A Run whose verdict has this margin and outcome, in a folder of runs."""
    run = replace(driven(), index=number, road=Road.through(points), outcome=outcome)
    assert run.verdict is not None
    judged = replace(run.verdict, margin=margin, outcome=outcome)
    run = replace(run, verdict=judged if outcome not in ("INVALID", "ERROR", "VALID") else None)
    request = Request(world=world or World(), setup=setup or Setup())
    run = replace(run, request=request)
    if folder is not None:
        write_run(run, folder)
    return run


@cache
def driven() -> Run:
    return prove(Road.through(STRAIGHT), 1)


def test_a_road_is_compared_with_itself_whatever_its_number(tmp_path: Path) -> None:
    a_run(tmp_path, BEND, 1, margin=2.0)
    a_run(tmp_path, STRAIGHT, 2, margin=1.0)
    found = Gate(None, (), tmp_path)
    assert found.add("it", (a_run(points=STRAIGHT, margin=0.95))) == ""
    assert found.add("it", (a_run(points=BEND, margin=0.95))) == "margin +0.950 m, in the baseline +2.000 m"
    assert found.add("it", (a_run(points=BEND, outcome="FAIL"))) == "FAIL, in the baseline PASS"
    assert found.remark == f"3 of 3 roads compared with {tmp_path}"


@pytest.mark.parametrize(("change", "is_same"), [(0.0, True), (1e-4, True), (0.002, False), (1.0, False)])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_road_that_differs_by_more_than_a_millimetre_is_another(
    tmp_path: Path, axis: int, change: float, is_same: bool
) -> None:
    points = [[*point, 3.0] for point in BEND]
    a_run(tmp_path, points)
    moved = [[*point] for point in points]
    moved[2][axis] += change
    found = Gate(None, (), tmp_path)
    assert found.add("it", (a_run(points=moved, margin=0.0))) == ("" if not is_same else (
        "margin +0.000 m, in the baseline +1.000 m"
    ))  # fmt: skip
    others = "; 1 road not there; 1 road of it not here"
    assert found.remark == f"{int(is_same)} of 1 road compared with {tmp_path}{others * (not is_same)}"


def test_every_form_of_a_road_is_that_road() -> None:
    """The folder of the run, its test in the format of SBFT, and what is exported and read again."""
    words = ("turn right 60; straight 60 up", "--reader", "plan", "--seed", "3", "--no-plot")
    assert invoke("run", *words, "--out", "base", "-q").exit_code == 0
    assert invoke("export", "base/1", "--to", "opendrive,sbft,csv", "--out", "other").exit_code == 0
    Path("other/base-0001.drive.csv").unlink(missing_ok=True)
    done = invoke("drive", "base", "base/test.0001.json", "base/runs/0001", "other", "--baseline", "base")
    assert done.exit_code == 0, done.output
    assert "6 of 6 roads compared with base" in done.stdout


@pytest.mark.parametrize(
    ("before", "after", "is_worse"),
    [
        ("PASS", "FAIL", True), ("PASS", "INVALID", True), ("PASS", "ERROR", True), ("FAIL", "ERROR", True),
        ("FAIL", "PASS", False), ("ERROR", "FAIL", False), ("FAIL", "FAIL", False), ("PASS", "VALID", True),
        ("PASS", "NOT TESTED", True), ("UNAVOIDABLE", "NOT TESTED", True), ("NOT TESTED", "PASS", False),
        ("NOT TESTED", "FAIL", True), ("FAIL", "NOT TESTED", False),
    ],
)  # fmt: skip
def test_worse_outcomes_are_worse(tmp_path: Path, before: str, after: str, is_worse: bool) -> None:
    a_run(tmp_path, margin=1.0, outcome=before)
    worse = Gate(None, (), tmp_path).add("it", (a_run(outcome=after, margin=0.0)))
    assert worse == (f"{after}, in the baseline {before}" if is_worse else "")


@pytest.mark.parametrize("drives_on", [True, False])
def test_margins_of_failures_count_only_where_drives_go_on(tmp_path: Path, drives_on: bool) -> None:
    setup = Setup(keep_driving=drives_on)
    a_run(tmp_path, margin=-0.1, outcome="FAIL", setup=setup)
    worse = Gate(None, (), tmp_path).add("it", (a_run(outcome="FAIL", margin=-0.9, setup=setup)))
    assert bool(worse) is drives_on


@pytest.mark.usefixtures("no_workers")
def test_of_several_tests_of_a_road_that_with_the_same_driver_counts() -> None:
    words = ("turn left 60", "--reader", "plan", "--seed", "3", "-n", "1")
    drivers = ("reference", "lane_centring", "beamng_like")
    named = [word for driver in drivers for word in ("--driver", driver)]
    assert invoke("campaign", *words, *named, "--out", "c").exit_code == 0
    for driver in drivers:
        done = invoke("drive", "c/c01/1", "--driver", driver, "--baseline", "c", "--margin-loss", "0.002")
        assert done.exit_code == 0, done.output
        assert "1 of 1 road compared with c\n" in done.stdout


def test_roads_that_only_one_has_are_counted(here: Path) -> None:
    Path("roads/b-bend.json").unlink()
    Path("roads/e-other.json").write_text(json.dumps([[60, 50], [140, 50]]))
    done = invoke("drive", "roads", *MINE, "--baseline", "first", "--json")
    assert done.exit_code == 0
    (told,) = [line for line in done.stderr.splitlines() if "compared with" in line]
    assert told == "3 of 4 roads compared with first; 1 road not there; 1 road of it not here"


def test_a_baseline_without_a_common_road_fails(here: Path) -> None:
    Path("alone.json").write_text(json.dumps([[60, 50], [140, 50]]))
    done = invoke("drive", "alone.json", "--baseline", "first", "--json")
    assert done.exit_code == 6
    assert said(done) == "no road is in the baseline first, so nothing was compared with it"
    assert json.loads(done.stdout)["test_outcome"] == "PASS"


def test_a_baseline_that_is_none_is_refused_before_anything_is_driven(here: Path) -> None:
    for words in (
        ("drive", "roads", "--baseline", "nowhere"), ("drive", "roads", "--baseline", "roads"),
        ("run", "a road", "--out", "first", "--baseline", "first"), ("drive", "roads", "--margin-loss", "1"),
    ):  # fmt: skip
        done = invoke(*words)
        assert (done.exit_code, done.stdout) == (2, ""), done.output


def test_what_is_worse_is_told_in_rows_and_in_junit(here: Path) -> None:
    Path("mine.py").write_text(STRAIGHT_ON.replace("> 150", "< 85"))
    words = ("drive", "roads", *MINE, "--baseline", "first", "--junit", "tests.xml")
    done = invoke(*words, "--json")
    assert done.exit_code == 6
    assert said(done).startswith("2 roads worse than in first: roads/a-straight.json (ERROR, in the bas")
    rows = {Path(row["file"]).stem: row.get("worse") for row in map(json.loads, done.stdout.splitlines())}
    assert rows["a-straight"] == "ERROR, in the baseline PASS"
    assert rows["b-bend"] == "ERROR, in the baseline FAIL"
    assert rows["c-long"] is rows["d-short"] is None
    suite = ElementTree.parse("tests.xml").getroot()[0]
    assert suite.get("errors") == "2"
    messages = [each.get("message", "") for each in suite.iter("error")]
    assert all(each.startswith("worse than in the baseline: ERROR") for each in messages)


@pytest.mark.usefixtures("no_workers")
def test_run_campaign_resume_and_repeated_tests_have_the_gate() -> None:
    words = ("turn left 80 r=20", "--reader", "plan", "--seed", "3", "-n", "2")
    slow, fast = ("--driver", "reference"), ("--driver", "mine.py:Mine")
    Path("mine.py").write_text(STRAIGHT_ON.replace("> 150", "> 1000"))
    assert (
        invoke("run", *words, *slow, "--no-plot", "--out", "good", "--fail-on", "fail,error").exit_code == 0
    )
    done = invoke(
        "run", *words, *fast, "--no-plot", "--out", "bad", "--fail-on", "fail", "--baseline", "good"
    )
    assert done.exit_code == 6, done.output
    assert said(done).startswith("2 of 2 roads FAIL; 2 roads worse than in good: test.0001.json (FAIL, in")
    assert "driver reference (here mine.py:Mine)" in done.stdout
    assert invoke("resume", "bad", "--fail-on", "100%").exit_code == 0
    assert said(invoke("resume", "bad", "--fail-on", "99%")) == "2 of 2 driven roads FAIL, more than 99 %"
    done = invoke("resume", "bad", "--baseline", "good", "--json", "--junit", "tests.xml")
    assert done.exit_code == 6
    told = json.loads(done.stdout)
    assert told["worse"] == {f"bad/{n}": "FAIL, in the baseline PASS" for n in (1, 2)}
    assert told["gate"] == said(done)
    failures = [*ElementTree.parse("tests.xml").getroot().iter("failure")]
    assert [each.get("message", "")[:30] for each in failures] == ["worse than in the baseline: FA"] * 2
    again = ("drive", "--again", "bad", "1", "--no-plot")
    assert invoke(*again, "--fail-on", "fail").exit_code == 6
    assert invoke(*again, "--baseline", "good").exit_code == 6
    assert invoke(*again, "--baseline", "bad", "--fail-on", "error").exit_code == 0
    done = invoke("campaign", *words, *fast, "--out", "c", "--fail-on", "fail", "--json")
    assert (done.exit_code, json.loads(done.stdout)["gate"]) == (6, "2 of 2 roads FAIL")
    assert invoke("campaign", *words, *fast, "--out", "c", "--fail-on", "error").exit_code == 0
    done = invoke("drive", "c", *slow, "--baseline", "c")
    assert done.exit_code == 0
    assert "2 of 2 roads compared with c; it was driven with driver mine.py:Mine (here" in done.stdout


def a_test(
    folder: Path | None = None, number: int = 1, outcome: str = "PASS", seed: int = 1, scenario: str = "",
    scene: str = "", cause: str | None = None, margin: float = 1.75, keep_driving: bool = False,
) -> Run:  # fmt: skip
    """A Run on always the same road, of a scenario whose scene is known."""
    setup = Setup(scenario=scenario, keep_driving=keep_driving)
    made = a_run(margin=margin, outcome=outcome, world=World().changed(scene=scene), setup=setup)
    made = replace(made, index=number, seed=seed)
    if made.verdict is not None:
        made = replace(made, verdict=replace(made.verdict, cause=cause))
    if folder is not None:
        write_run(made, folder)
    return made


TESTS = (
    ("ncap:CCRs", "ego v=50; car ahead v=0 impact=50", 1),
    ("ncap:CCRs", "ego v=50; car ahead v=0 impact=25", 1),
    ("ncap:CCRm", "ego v=50; car ahead v=20 impact=50", 1),
    ("", "light", 1),
    ("", "light", 2),
    ("", "", 1),
)


def test_tests_on_one_road_are_paired_by_scenario_parameters_scene_and_seed(tmp_path: Path) -> None:
    """Every second one failed before: unchanged, nothing is worse; and each that fails anew is found."""
    for number, (scenario, scene, seed) in enumerate(TESTS, 1):
        a_test(tmp_path, number, ("PASS", "FAIL")[number % 2], seed, scenario, scene)
    for changed in (None, 2, 4, 6):
        found = Gate(None, (), tmp_path)
        for number, (scenario, scene, seed) in enumerate(TESTS, 1):
            outcome = "FAIL" if number == changed else ("PASS", "FAIL")[number % 2]
            worse = found.add(str(number), a_test(None, number, outcome, seed, scenario, scene))
            assert worse == ("FAIL, in the baseline PASS" if number == changed else "")
        assert found.remark == f"6 of 6 roads compared with {tmp_path}"
    other = Gate(None, (), tmp_path)
    assert other.add("it", a_test(seed=3, scene="light", outcome="FAIL")) == ""
    assert other.remark.startswith("0 of 1 road compared")
    # a road alone is the same test whatever its seed, and of several the one that passed counts
    a_test(tmp_path, 7, "FAIL")
    assert Gate(None, (), tmp_path).add("it", a_test(seed=9, outcome="FAIL")) == "FAIL, in the baseline PASS"


def test_a_margin_is_nothing_to_go_by_at_a_collision(tmp_path: Path) -> None:
    scene = "car ahead v=0"
    a_test(tmp_path, outcome="FAIL", scene=scene, cause="collision", keep_driving=True)
    worse = a_test(outcome="FAIL", scene=scene, cause="collision", margin=0.5, keep_driving=True)
    assert Gate(None, (), tmp_path).add("it", worse) == ""


def test_a_baseline_that_was_judged_by_another_criterion_is_refused_by_name(tmp_path: Path) -> None:
    scene = "car ahead v=0"
    write_run(a_test(scene=scene), tmp_path)
    setup = Setup(scenario="r157:cut_in")
    assert setup.staged(World(), left_hand=False).limits.avoidable == "r157"
    assert setup.staged(World().changed(avoidable="any"), left_hand=False).limits.avoidable == "any"
    other = a_run(outcome="FAIL", world=World().changed(scene=scene, avoidable="rss"), setup=Setup())
    with pytest.raises(UsageError, match=r"the criterion of its kind in the baseline .* by rss in it"):
        Gate(None, (), tmp_path).add("it", replace(other, index=1, seed=1))
    alone = a_run(outcome="FAIL", world=World().changed(avoidable="rss"), setup=Setup())
    write_run(a_test(), tmp_path / "alone")
    assert Gate(None, (), tmp_path / "alone").add("it", replace(alone, seed=1)).startswith("FAIL")


def test_a_baseline_that_was_judged_by_other_rules_is_told(tmp_path: Path) -> None:
    before = a_run()
    versions = {name: value for name, value in before.versions.items() if name != "judgement"}
    write_run(replace(before, versions=versions), tmp_path)
    found = Gate(None, (), tmp_path)
    assert found.add("it", before) == ""
    assert found.remark.endswith(f"; it was driven with rules of judgement 1 (here {JUDGEMENT})")
