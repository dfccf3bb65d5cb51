"""Where no road failed, commands say what to try; they are typed here as they stand."""

import csv
import json
import re
import shlex
from pathlib import Path

import pytest

from command_line import roadgpt
from roadgpt.cli.repeat_commands import HEAD, WithoutFailure, next_steps
from roadgpt.road import Limits, Site, World
from roadgpt.run import Request

WORDS = ("turn x2", "--reader", "plan", "--seed", "5")
REQUEST = Request(words="a road", seed=3)


def commands(said: str) -> list[list[str]]:
    """What stands below the head, as a shell takes it."""
    lines = said.partition(HEAD)[2].splitlines()
    found = [shlex.split(line) for line in lines if line.startswith("    roadgpt ")]
    assert all(words[0] == "roadgpt" for words in found)
    return [words[1:] for words in found]


@pytest.mark.usefixtures("no_workers")
def test_a_run_without_failures_says_what_to_try_and_it_can_be_typed(tmp_path: Path) -> None:
    out = tmp_path / "quiet"
    words = [*WORDS, "--driver", "beamng_like", "--oracle", "thesis"]  # passes with the car outside
    said = roadgpt("run", *words, "-n", 5, "--no-plot", "--out", out).stdout
    found = commands(said)
    assert [words[0] for words in found] == ["run", "run", "run", "campaign"]
    flags = [re.findall(r"--(?!seed|reader|driver|oracle)[a-z-]+", " ".join(words)) for words in found]
    assert flags == [[], ["--friction"], ["--speed-limit"], ["--goal"]]
    oracles = [words[words.index("--oracle") + 1] for words in found]
    assert oracles == ["departure", "thesis", "thesis", "thesis"]
    assert all(words[words.index("--driver") + 1] == "beamng_like" for words in found)
    outcomes = []
    for number, words in enumerate(found):
        if words[0] == "campaign":
            assert words[words.index("-n") + 1] == "200"
            words[words.index("-n") + 1] = "1"  # 200 take a minute
            roadgpt(*words, "--out", f"c{number}", "--quiet")
            continue
        if number:  # it can be typed; the roads are asked about of the first only
            words = [*words]
            words[words.index("-n") + 1] = "1"
        told = roadgpt(*words, "--no-plot", "--out", f"r{number}", "--json")
        outcomes.append({json.loads(line)["test_outcome"] for line in told.stdout.splitlines()})
    assert all(each <= {"PASS", "FAIL"} for each in outcomes)
    assert "FAIL" in outcomes[0]  # the strict criterion finds what the tolerance lets pass
    # the same stands in the report of the folder
    roadgpt("report", out)
    with (out / "tables" / "next.csv").open(newline="") as file:
        rows = [row["command"] for row in csv.DictReader(file)]
    assert [shlex.split(row)[1:] for row in rows][:3] == found[:3]
    assert "What to try next" in (out / "report.html").read_text()


@pytest.mark.usefixtures("no_workers")
def test_a_campaign_without_failures_says_what_to_try(tmp_path: Path) -> None:
    out = tmp_path / "c"
    said = roadgpt(
        "campaign", *WORDS, "-n", 5, "--goal", "failures", "--driver", "reference", "--out", out
    ).stdout
    found = commands(said)
    assert found
    assert all(words[0] == "campaign" and "--driver" in words for words in found)
    assert found[-1][found[-1].index("--goal") + 1] == "hardest"
    assert all(words[words.index("--goal") + 1] == "failures" for words in found[:-1])
    assert commands(roadgpt("show", out).stdout) == found
    for number, words in enumerate(found[:2]):
        few = [*words]
        few[words.index("-n") + 1] = "1"
        roadgpt(*few, "--out", f"again{number}", "--quiet")
    roadgpt("report", out)
    with (out / "tables" / "next.csv").open(newline="") as file:
        assert [shlex.split(row["command"])[1:] for row in csv.DictReader(file)] == found


def test_what_is_set_already_is_not_proposed_again() -> None:
    hard = World(
        limits=Limits(lane_departure=True, oob_tolerance=0.4, speed_limit=200 / 3.6), site=Site(friction=0.3)
    )
    told = next_steps(WithoutFailure(REQUEST.model_copy(update={"world": hard}), 20, 20))
    assert [why for why, _ in told] == ["search for failures among such roads"]
    assert "--oracle departure:0.4" in told[0][1]
    wet = next_steps(
        WithoutFailure(REQUEST.model_copy(update={"world": World(site=Site(friction=0.6))}), 20, 20)
    )
    assert any("--friction 0.35" in command for why, command in wet if why == "snow")
    # what no option can say is not left out silently: there is no such command
    odd = REQUEST.model_copy(update={"world": World(limits=Limits(min_radius=30.0))})
    assert next_steps(WithoutFailure(odd, 20, 20)) == []
    assert next_steps(WithoutFailure(Request(), 20, 20)) == []
