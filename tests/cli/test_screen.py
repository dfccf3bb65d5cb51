"""Rows and screens: what is printed, where, and the table at the end."""

import json

import pytest

from roadgpt.cli.rows import Row, summary
from roadgpt.cli.screen import Screen

KEPT = Row("a.json", "PASS", "kept its lane", max_oob=0.2, margin_m=0.62, length_m=187.25, seconds=1.234567)
LEFT = Row(
    "b.json", "FAIL", "left its lane", cause="out of lane", max_oob=0.97, margin_m=-0.06, length_m=90.0
)
WRONG = Row("c.json", "INVALID", "it is too sharp", is_valid=False, validation_message="it is too sharp")


def test_json_has_the_fields_that_were_promised_in_their_order() -> None:
    names = "file is_valid validation_message test_outcome description max_oob margin_m length_m seconds"
    assert [*json.loads(KEPT.to_json())] == names.split()
    assert json.loads(KEPT.to_json())["seconds"] == 1.2346
    assert json.loads(WRONG.to_json())["margin_m"] is None
    assert "\n" not in WRONG.to_json()


def test_json_has_no_infinities() -> None:
    assert json.loads(Row("a", "PASS", "", margin_m=float("inf")).to_json())["margin_m"] is None


def test_a_line_carries_the_cause_of_a_failure_and_the_sentence_of_a_rule() -> None:
    assert LEFT.to_line().startswith("FAIL (out of lane)")
    assert "-0.06 m" in LEFT.to_line()
    assert WRONG.to_line().endswith("it is too sharp")


def test_the_summary_counts_each_outcome_and_finds_the_least_margin() -> None:
    closer = Row("d.json", "PASS", "kept its lane", margin_m=0.11)
    assert summary([LEFT, KEPT, WRONG, closer]) == [
        ("PASS", 2, "50 %", "+0.11 m"),
        ("FAIL (out of lane)", 1, "25 %", "-0.06 m"),
        ("INVALID", 1, "25 %", "-"),
    ]


def show(**how: bool) -> None:
    with Screen(3, **how) as screen:
        screen.say("understood: a road")
        screen.detail("seed 7")
        for row in (KEPT, LEFT, WRONG):
            screen.row(row)
        screen.close()


def test_plain_lines_end_with_a_table(capsys: pytest.CaptureFixture[str]) -> None:
    show()
    said = capsys.readouterr()
    lines = said.out.splitlines()
    assert lines[0] == "understood: a road"
    assert lines[1].startswith("1/3  PASS")
    assert "\x1b" not in said.out
    assert lines[-1].startswith("3 of 3 roads in ")
    assert said.err == ""


def test_verbose_tells_details(capsys: pytest.CaptureFixture[str]) -> None:
    show(verbose=True)
    assert "seed 7\n" in capsys.readouterr().out


def test_json_stands_alone_on_standard_output(capsys: pytest.CaptureFixture[str]) -> None:
    show(as_json=True)
    said = capsys.readouterr()
    assert [json.loads(line)["file"] for line in said.out.splitlines()] == ["a.json", "b.json", "c.json"]
    assert said.err == "understood: a road\n"


def test_quiet_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    show(quiet=True, verbose=True)
    assert capsys.readouterr() == ("", "")
