"""`roadgpt run`: what it says, what it writes, how it ends."""

import json
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner, Result

import command_line
from roadgpt.campaign import single_test
from roadgpt.cli import app
from roadgpt.drive.isolation import proxy
from roadgpt.errors import DesignError
from roadgpt.run.folder import read_run
from rows import rows

WORDS = "an uphill road with 3 turns"


def invoke(*words: str) -> Result:
    return command_line.invoke("run", *words)


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


def test_with_json_the_talk_goes_to_standard_error_and_with_quiet_nowhere() -> None:
    words = (WORDS, "--seed", "1", "--no-drive", "--no-plot")
    loud = invoke(*words, "--json")
    assert loud.stdout.count("\n") == 1
    assert "I read this as: " in loud.stderr
    assert invoke(*words, "--json", "--quiet").stderr == ""
    quiet = invoke(*words, "--quiet")
    assert (quiet.stdout, quiet.stderr, quiet.exit_code) == ("", "", 0)


def test_without_a_seed_one_is_drawn_and_told() -> None:
    told = [invoke(WORDS, "--no-drive", "--no-plot").stdout.split("seed ")[1].split(",")[0] for _ in range(2)]
    assert told[0] != told[1]
    again = invoke(WORDS, "--no-drive", "--no-plot", "--seed", told[0], "--out", "again")
    assert again.exit_code == 0
    first = next(Path("roadgpt-runs").glob(f"*-{told[0]}"))
    assert (first / "test.0001.json").read_bytes() == Path("again", "test.0001.json").read_bytes()


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
    ("option", "width", "limit"),
    [([], 2.5, 30), (["--lane-width", "4"], 4, 30), (["--speed-limit", "70"], 2.5, 70)],
)
def test_widths_and_limits_of_a_plan_are_built_unless_an_option_gives_others(
    option: list[str], width: float, limit: float
) -> None:
    given = ["--plan", "--seed", "3", "--no-plot", *option]
    first = invoke("straight 200 | width=2.5 limit=30", *given, "-n", "1", "--out", "r")
    assert first.exit_code == 0
    assert ("is set and used" in first.output) == bool(option)
    assert invoke("straight 200 | width=2.5 limit=30", *given, "-n", "2", "--out", "r").exit_code == 0
    for number in ("0001", "0002"):
        world = read_run(Path(f"r/runs/{number}")).world
        assert world.section.lane_width == width
        assert world.limits.speed_limit == pytest.approx(limit / 3.6)


@pytest.mark.parametrize(("words", "options", "forward", "backward"), rows(__file__, "lanes_asked_for"))
def test_the_lanes_that_the_words_ask_for_are_built_unless_an_option_gives_others(
    words: str, options: list[str], forward: int, backward: int
) -> None:
    given = [
        "--plan", "--seed", "3", "--no-drive", "--no-plot", "--export", "opendrive", "--out", "r",
        *options,
    ]  # fmt: skip
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

    monkeypatch.setattr(single_test, "drafted", cannot)
    result = invoke(WORDS, "-n", "5", "--no-plot", "--out", "here")
    assert result.exit_code == 3
    assert "roadgpt: no road fits; ask for less" in result.stderr
    assert "ERROR" not in result.stdout
    assert not Path("here").exists()


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
    monkeypatch.setattr(proxy, "_idle", [])  # a driver's process that is begun here writes where we look
    driven = CliRunner().invoke(app, ["drive", road, "--json", *chatty])
    assert driven.exit_code == 0
    assert len([json.loads(line) for line in driven.stdout.splitlines()]) == 1
    written, warned = capfd.readouterr()
    assert written == ""
    assert "steering" in warned


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
    assert CliRunner().invoke(app, ["view", "--format", "png", "one"]).exit_code == 0
    assert CliRunner().invoke(app, ["view", "one"]).exit_code == 0
    invoke(WORDS, "-n", "2", "--seed", "7", "--no-drive", "--no-plot", "--out", "two")
    for command in (["view", "--format", "png"], ["view"]):
        result = CliRunner().invoke(app, [*command, "two"])
        assert result.exit_code == 2
        assert (
            result.stderr
            == "roadgpt: two holds 2 roads; name one, as two/1, or say --worst, --faults or --failures\n"
        )
