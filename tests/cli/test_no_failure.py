"""Where no road failed, one sentence says what searches for failures; it can be typed."""

import shlex
from html import unescape
from pathlib import Path

import pytest

from command_line import roadgpt
from roadgpt.campaign.model import NO_FAILURE, no_failure

WORDS = ("turn x2", "--reader", "plan", "--seed", "5")


def test_it_is_said_of_five_passed_roads_and_of_none_that_failed() -> None:
    assert no_failure({"PASS": 5}) == no_failure({"PASS": 5, "INVALID": 2}) == [NO_FAILURE]
    assert no_failure({"PASS": 4}) == no_failure({"VALID": 9}) == no_failure({"PASS": 9, "FAIL": 1}) == []


@pytest.mark.usefixtures("no_workers")
@pytest.mark.parametrize("verb", ["run", "campaign"])
def test_summaries_and_reports_say_it_once(tmp_path: Path, verb: str) -> None:
    out = tmp_path / verb
    said = roadgpt(verb, *WORDS, "-n", 5, *["--no-plot"] * (verb == "run"), "--out", out).stdout
    assert said.count(NO_FAILURE) == 1
    if verb == "campaign":
        assert roadgpt("show", out).stdout.count(NO_FAILURE) == 1
    roadgpt("report", out)
    assert unescape((out / "report.html").read_text(encoding="utf-8")).count(NO_FAILURE) == 1
    search = shlex.split(NO_FAILURE.split("'")[1])[1:]
    roadgpt(*search, *WORDS, "-n", 1, "--out", tmp_path / "search", "--quiet")
