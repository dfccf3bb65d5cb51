"""`roadgpt run`: what it says, what it writes, how it ends."""

import csv
import json
import subprocess
import sys
from collections import Counter
from pathlib import Path
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner, Result

from roadgpt.campaign import single_test
from roadgpt.cli import app
from roadgpt.drive.isolation import process
from roadgpt.errors import DesignError

WORDS = "an uphill road with 3 turns"


@pytest.fixture(autouse=True)
def in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def invoke(*words: str) -> Result:
    result = CliRunner().invoke(app, ["run", *words], prog_name="roadgpt")
    assert "Traceback" not in result.output
    assert result.exit_code != 70, result.output
    return result


def test_it_says_what_it_understood_before_the_first_road_and_ends_with_the_place_of_the_pictures() -> None:
    result = invoke("a flurbed uphill road with 3 turns", "-n", "2", "--seed", "7", "--out", "here")
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    assert lines[0].startswith("I read this as: ")
    assert "3 turns" in lines[0]
    assert "not used: " in lines[0]
    assert "flurbed" in lines[0]
    assert [line[:3] for line in lines if line[1:3] == "/2"] == ["1/2", "2/2"]
    assert "pictures: " in lines[-1]
    for number in ("0001", "0002"):
        pictures = [*Path("here", "runs", number).glob("*.png")]
        assert len(pictures) >= 3
        assert all(picture.read_bytes()[:4] == b"\x89PNG" for picture in pictures)


def test_the_campaign_folder_has_what_the_competition_has() -> None:
    result = invoke(WORDS, "-n", "2", "--seed", "7", "--out", "here", "--no-plot", "--json")
    rows = [json.loads(line) for line in result.stdout.splitlines()]
    assert [row["file"] for row in rows] == [str(Path("here", f"test.000{i}.json")) for i in (1, 2)]
    for row in rows:
        test = json.loads(Path(row["file"]).read_text())
        assert test["test_outcome"] == row["test_outcome"]
        assert row["is_valid"] is test["is_valid"] is True
        assert row["seconds"] > 0
        assert row["length_m"] > 20
    with Path("here", "generation_stats.csv").open() as file:
        (stats,) = csv.DictReader(file)
    outcomes = Counter(row["test_outcome"] for row in rows)
    counted = {"passed": "PASS", "failed": "FAIL", "in_error": "ERROR"}
    assert {name: int(stats[f"test_{name}"]) for name in counted} == {
        name: outcomes[outcome] for name, outcome in counted.items()
    }
    assert (stats["test_generated"], stats["test_valid"], stats["test_invalid"]) == ("2", "2", "0")
    drives = [json.loads(Path(row["file"]).read_text())["execution_data"] for row in rows]
    simulated = sum(records[-1][0] for records in drives)
    assert float(stats["simulated_time_execution"]) == pytest.approx(simulated, abs=0.1)
    spent = float(stats["real_time_generation"]) + float(stats["real_time_execution"])
    assert spent == pytest.approx(sum(row["seconds"] for row in rows), abs=0.3)
    with Path("here", "oob_stats.csv").open() as file:
        (sides,) = csv.DictReader(file)
    assert int(sides["total_oob"]) == int(sides["left_oob"]) + int(sides["right_oob"]) == outcomes["FAIL"]
    with Path("here", "experiment_description.csv").open() as file:
        (settings,) = csv.DictReader(file)
    assert (settings["description"], settings["roads"], settings["seed"]) == (WORDS, "2", "7")


def test_with_json_the_talk_goes_to_standard_error_and_with_quiet_nowhere() -> None:
    words = (WORDS, "--seed", "1", "--no-drive", "--no-plot")
    loud = invoke(*words, "--json")
    assert loud.stdout.count("\n") == 1
    assert "I read this as: " in loud.stderr
    assert invoke(*words, "--json", "--quiet").stderr == ""
    quiet = invoke(*words, "--quiet")
    assert (quiet.stdout, quiet.stderr, quiet.exit_code) == ("", "", 0)


def test_the_same_seed_gives_the_same_files() -> None:
    for out in ("first", "second"):
        invoke(WORDS, "-n", "2", "--seed", "11", "--no-plot", "--quiet", "--out", out)
    names = sorted(p.relative_to("first") for p in Path("first").rglob("*") if p.is_file())
    assert any(name.suffix == ".npz" for name in names)
    for name in names:
        if name.name not in ("seconds.json", "generation_stats.csv"):  # they tell the time
            assert Path("first", name).read_bytes() == Path("second", name).read_bytes(), name


def test_without_a_seed_one_is_drawn_and_told() -> None:
    told = [invoke(WORDS, "--no-drive", "--no-plot").stdout.split("seed ")[1].split(",")[0] for _ in range(2)]
    assert told[0] != told[1]
    again = invoke(WORDS, "--no-drive", "--no-plot", "--seed", told[0], "--out", "again")
    assert again.exit_code == 0
    first = next(Path("roadgpt-runs").glob(f"*-{told[0]}"))
    assert (first / "test.0001.json").read_bytes() == Path("again", "test.0001.json").read_bytes()


def test_no_drive_ends_as_valid() -> None:
    result = invoke(WORDS, "--no-drive", "--no-plot", "--json")
    (row,) = (json.loads(line) for line in result.stdout.splitlines())
    assert (row["test_outcome"], row["max_oob"], row["margin_m"]) == ("VALID", None, None)


def test_words_need_no_quotes() -> None:
    result = invoke(*WORDS.split(), "--no-drive", "--no-plot")
    assert result.exit_code == 0
    assert "3 turns" in result.stdout


@pytest.mark.parametrize(
    "words",
    [
        "",
        "   ",
        "asdf qwer zxcv",
        "three turns but no turns",
        "a road climbing 40 %",
        "500 hairpins",
        "a" * 20_000,
    ],
    ids=lambda words: words[:20],
)
def test_words_that_cannot_be_a_road_get_one_sentence(words: str) -> None:
    result = invoke(words, "-n", "2")
    assert result.exit_code in (2, 3)
    assert result.stderr.startswith("roadgpt: ")
    assert len(result.stderr) < 600
    assert not Path("roadgpt-runs").exists()


@pytest.mark.parametrize(
    ("words", "options", "forward", "backward"),
    [
        ("straight len=60 | lanes=3 oneway", [], 3, 0),
        ("turn right | lanes=2 against=1", [], 2, 1),
        ("straight len=60 | lanes=3 oneway", ["--lanes", "1+1"], 1, 1),
        ("straight len=60", [], 1, 1),
    ],
)
def test_the_lanes_that_the_words_ask_for_are_built_unless_an_option_gives_others(
    words: str, options: list[str], forward: int, backward: int
) -> None:
    given = [
        "--plan",
        "--seed",
        "3",
        "--no-drive",
        "--no-plot",
        "--export",
        "opendrive",
        "--out",
        "r",
        *options,
    ]
    result = invoke(words, *given)
    assert result.exit_code == 0
    assert ("--lanes 1+1 is set and used" in result.output) == bool(options)
    (file,) = Path("r").rglob("*.xodr")
    driving = {
        int(lane.get("id", "0"))
        for lane in ElementTree.parse(file).iter("lane")
        if lane.get("type") == "driving"
    }
    assert driving == {*range(-forward, 0), *range(1, backward + 1)}
    ((road, lane),) = json.loads(file.with_suffix(".route.json").read_text())["route"]
    assert road == int(ElementTree.parse(file).getroot().findall("road")[0].get("id", "0"))
    assert lane in driving
    assert lane < 0


def test_a_route_through_a_map_is_named_and_said_back() -> None:
    result = invoke(
        "a grid of 2 by 2 blocks", "--route", "left, right", "--seed", "2", "--no-drive", "--no-plot"
    )
    assert result.exit_code == 0
    assert "a grid of 2 by 2 blocks; the route goes left, right" in result.output


@pytest.mark.parametrize(
    ("words", "route", "said"),
    [
        ("a winding road", "left", "leave --route out"),
        ("a T-junction, turn right", "left", "leave --route out"),
        ("a grid of 2 by 2 blocks", "up", "the route 'up' through a map cannot be read"),
        ("a grid of 2 by 2 blocks", ",", "cannot be read"),
        ("a grid of 2 by 2 blocks", "left," * 13, "give 1 to 12 of left, right, straight"),
    ],
)
def test_a_route_that_cannot_be_named_is_refused_before_anything_is_made(
    words: str, route: str, said: str
) -> None:
    result = invoke(words, "--route", route)
    assert result.exit_code == 2
    assert said in result.stderr
    assert not Path("roadgpt-runs").exists()


def test_nothing_that_could_be_designed_ends_with_3(monkeypatch: pytest.MonkeyPatch) -> None:
    def cannot(*_: object, **__: object) -> None:
        raise DesignError("no road fits; ask for less")

    monkeypatch.setattr(single_test, "perform", cannot)
    result = invoke(WORDS, "-n", "5", "--no-plot", "--out", "here")
    assert result.exit_code == 3
    assert "roadgpt: no road fits; ask for less" in result.stderr
    assert "ERROR" not in result.stdout
    assert not Path("here").exists()


def test_one_road_that_could_not_be_designed_does_not_stop_the_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    honest = single_test.perform

    def sometimes(words, seed, world, setup, index, *rest):  # type: ignore[no-untyped-def]
        if index == 2:
            raise DesignError("no road fits; ask for less")
        return honest(words, seed, world, setup, index, *rest)

    monkeypatch.setattr(single_test, "perform", sometimes)
    result = invoke(WORDS, "-n", "3", "--no-plot", "--no-drive", "--json")
    assert result.exit_code == 0
    outcomes = [json.loads(line)["test_outcome"] for line in result.stdout.splitlines()]
    assert outcomes == ["VALID", "ERROR", "VALID"]


def test_an_interrupted_campaign_is_complete_as_far_as_it_went_and_goes_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    honest = single_test.perform

    def stopped(words, seed, world, setup, index, *rest):  # type: ignore[no-untyped-def]
        if index == 3:
            raise KeyboardInterrupt
        return honest(words, seed, world, setup, index, *rest)

    words = (WORDS, "-n", "4", "--seed", "3", "--no-drive", "--no-plot", "--out", "here")
    with monkeypatch.context() as patched:
        patched.setattr(single_test, "perform", stopped)
        result = invoke(*words)
    assert result.exit_code == 130
    assert "roadgpt: stopped; 2 of 4 roads are finished and complete" in result.stderr
    assert "\nroadgpt: continue with: roadgpt resume here\n" in result.stderr
    assert "2 of 4 roads in " in result.stdout
    tests = sorted(Path("here").glob("test.*.json"))
    assert [test.name for test in tests] == ["test.0001.json", "test.0002.json"]
    assert all(json.loads(test.read_text())["is_valid"] for test in tests)
    before = [test.read_bytes() for test in tests]

    result = invoke(*words)
    assert result.exit_code == 0
    assert "2 roads were finished before" in result.stdout
    assert len([*Path("here").glob("test.*.json")]) == 4
    assert [test.read_bytes() for test in tests] == before


def test_a_finished_campaign_is_not_written_over() -> None:
    words = (WORDS, "--seed", "3", "--no-drive", "--no-plot", "--out", "here")
    assert invoke(*words).exit_code == 0
    before = {path: path.read_bytes() for path in Path("here").rglob("*") if path.is_file()}
    for other in (("a flat road", *words[1:]), (WORDS, "--seed", "4", *words[3:])):
        result = invoke(*other)
        assert result.exit_code == 2
        assert "name another folder" in result.stderr
        assert result.stdout == ""
    for same in (words, (WORDS, *words[3:])):  # without --seed as well
        result = invoke(*same)
        assert result.exit_code == 0
        assert "all 1 roads are there" in result.stdout
        assert "1/1  VALID" in result.stdout
    assert {path: path.read_bytes() for path in Path("here").rglob("*") if path.is_file()} == before


def test_without_a_seed_an_interrupted_campaign_goes_on_with_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    words = (WORDS, "-n", "2", "--no-drive", "--no-plot", "--out", "here")
    with monkeypatch.context() as patched:
        patched.setattr(single_test, "perform", stopped)
        first = invoke(*words)
    assert first.exit_code == 130
    again = invoke(*words)
    assert again.exit_code == 0
    seeds = [result.stdout.split("seed ")[1].split(",")[0] for result in (first, again)]
    assert seeds[0] == seeds[1]
    assert len([*Path("here").glob("test.*.json")]) == 2


def test_what_was_understood_is_said_when_nothing_stands_in_the_way() -> None:
    for more in (("--driver", "nobody"), ("--driver", "none.py:Nobody"), ("--out", "taken")):
        Path("taken").mkdir(exist_ok=True)
        Path("taken", "thesis.docx").write_text("")
        result = invoke(WORDS, *more)
        assert (result.exit_code, result.stdout) == (2, "")


def test_lines_name_the_test_and_not_its_folder() -> None:
    result = invoke(WORDS, "--seed", "1", "--no-drive", "--no-plot", "--out", "a-folder")
    (line,) = [line for line in result.stdout.splitlines() if line.startswith("1/1")]
    assert line.endswith("  test.0001.json")
    assert "a-folder" not in line


def test_a_driver_that_prints_spoils_no_json(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("chatty.py").write_text(
        "from roadgpt.drive import Command\n\nprint('loaded')\n\n\nclass Chatty:\n"
        "    def steer(self, view):\n        print('steering')\n        return Command(0.0, throttle=0.3)\n"
    )
    start = [sys.executable, "-m", "roadgpt", "run"]  # the driver sits in a process of its own
    words = ["straight len=40", "--plan", "--no-plot", "--json", "--out", "here"]
    chatty = ["--driver", "chatty.py:Chatty"]
    result = subprocess.run([*start, *words, *chatty], capture_output=True, text=True, check=True)
    assert len([json.loads(line) for line in result.stdout.splitlines()]) == 1
    assert "steering" in result.stderr
    assert "loaded" in result.stderr
    road = str(Path("here", "runs", "0001", "road.json"))
    monkeypatch.setattr(process, "_idle", [])  # a driver's process that is begun here writes where we look
    driven = CliRunner().invoke(app, ["drive", road, "--json", *chatty])
    assert driven.exit_code == 0
    assert len([json.loads(line) for line in driven.stdout.splitlines()]) == 1
    written, warned = capfd.readouterr()
    assert written == ""
    assert "steering" in warned


def test_show_tells_of_a_run_and_of_its_campaign() -> None:
    invoke(WORDS, "--seed", "7", "--no-plot", "--out", "here")
    for place in ("here", "here/runs/0001", "here/test.0001.json"):
        result = CliRunner().invoke(app, ["show", place])
        assert result.exit_code == 0
        assert WORDS in result.stdout
    again = next(line for line in result.stdout.splitlines() if "roadgpt drive" in line)
    assert "runs/0001/road.json" in again


def test_show_of_a_campaign_tells_the_cause_of_a_failure() -> None:
    Path("asleep.py").write_text(
        "from roadgpt.drive import Command\n\n\nclass Asleep:\n    def steer(self, view):\n"
        "        return Command(0.0, throttle=0.3 if view.speed < 8 else 0.0)\n"
    )
    invoke(WORDS, "--driver", "asleep.py:Asleep", "--no-plot", "--out", "here", "--seed", "7")
    shown = CliRunner().invoke(app, ["show", "here"]).stdout
    assert "FAIL (out of lane)" in shown


@pytest.mark.parametrize("command", ["drive", "check"])
def test_the_folder_of_a_campaign_stands_for_its_roads(command: str) -> None:
    invoke(WORDS, "-n", "2", "--seed", "7", "--no-drive", "--no-plot", "--out", "here")
    result = CliRunner().invoke(app, [command, "here", "--json"])
    rows = [json.loads(line) for line in result.stdout.splitlines()]
    assert [row["file"] for row in rows] == ["here/1", "here/2"]
    single = json.loads(CliRunner().invoke(app, [command, "here/runs/0002", "--json"]).stdout)
    assert {**rows[1], "file": "", "seconds": 0} == {**single, "file": "", "seconds": 0}


def test_pictures_of_a_campaign_of_one_road_are_of_that_road_and_of_more_are_refused() -> None:
    invoke(WORDS, "--seed", "7", "--no-drive", "--no-plot", "--out", "one")
    assert CliRunner().invoke(app, ["plot", "one"]).exit_code == 0
    assert CliRunner().invoke(app, ["view", "one"]).exit_code == 0
    invoke(WORDS, "-n", "2", "--seed", "7", "--no-drive", "--no-plot", "--out", "two")
    for command in (["view", "--format", "png"], ["view"]):
        result = CliRunner().invoke(app, [*command, "two"])
        assert result.exit_code == 2
        assert (
            result.stderr
            == "roadgpt: two holds 2 roads; name one, as two/1, or say --worst, --faults or --failures\n"
        )


def test_show_of_a_file_that_is_no_test_names_it() -> None:
    Path("points.json").write_text("[[1, 2]]")
    result = CliRunner().invoke(app, ["show", "points.json"])
    assert result.exit_code == 2
    assert "points.json belongs to no run; give a folder like DIR/runs/0001" in result.stderr
