"""Rows and screens: what is printed, where, and the table at the end."""

import json
import sys
from dataclasses import replace

import pytest

from roadgpt import stopping
from roadgpt.cli.result_row import COLOURS, Row, colour_of, metres, summary
from roadgpt.cli.screen import Screen
from roadgpt.cli.streams import apart
from roadgpt.verdict import graded

KEPT = Row("a.json", "PASS", "kept its lane", max_oob=0.0, margin_m=0.62, length_m=187.25, seconds=1.234567)
LEFT = Row(
    "b.json", "FAIL", "left its lane", cause="out of lane", max_oob=0.97, margin_m=-0.06, length_m=90.0
)
NEARLY = replace(KEPT, file="n.json", max_oob=0.62, beyond_m=1.1349)
WRONG = Row("c.json", "INVALID", "it is too sharp", is_valid=False, validation_message="it is too sharp")


def test_json_has_the_fields_that_were_promised_in_their_order() -> None:
    names = (
        "file is_valid validation_message findings test_outcome description max_oob beyond_m margin_m "
        "length_m own_share handed_to seconds"
    )
    assert [*json.loads(KEPT.to_json())] == names.split()
    assert json.loads(KEPT.to_json())["seconds"] == 1.2346
    assert json.loads(WRONG.to_json())["margin_m"] is None
    assert "\n" not in WRONG.to_json()


def test_json_has_no_infinities() -> None:
    assert json.loads(Row("a", "PASS", "", margin_m=float("inf")).to_json())["margin_m"] is None


def test_a_line_carries_the_cause_of_a_failure_and_the_sentence_of_a_rule() -> None:
    assert LEFT.to_line().startswith("FAIL (out of lane)")
    assert "margin -0.060 m" in LEFT.to_line()
    assert "margin -0.003 m" in replace(LEFT, margin_m=-0.0029).to_line()
    assert WRONG.to_line().endswith("it is too sharp")


def test_a_line_carries_what_the_rules_said_of_a_road_that_was_driven() -> None:
    assert "finding" not in KEPT.to_line()
    assert replace(KEPT, findings=("too tight",)).to_line().endswith("a.json  finding: too tight")
    two = replace(LEFT, findings=("too tight", "too steep"))
    assert two.to_line().endswith("finding: too tight and 1 more finding")
    assert replace(KEPT, findings=("a", "b", "c")).to_line().endswith("finding: a and 2 more findings")
    assert json.loads(two.to_json())["findings"] == ["too tight", "too steep"]


def test_the_summary_counts_each_outcome_and_finds_the_least_margin() -> None:
    closer = Row("d.json", "PASS", "kept its lane", margin_m=0.11)
    assert summary([LEFT, KEPT, WRONG, closer]) == [
        ("PASS", 2, "50 %", "+0.110 m", "inside"),
        ("FAIL (out of lane)", 1, "25 %", "-0.060 m", "97 % out"),
        ("INVALID", 1, "25 %", "-", "-"),
    ]


def test_a_pass_outside_the_lane_does_not_look_like_one_inside() -> None:
    assert NEARLY.to_line().startswith("PASS (62 % out, 1.13 m)")
    assert KEPT.to_line().startswith("PASS    ")
    assert replace(NEARLY, beyond_m=None).to_line().startswith("PASS (62 % out) ")
    assert replace(NEARLY, max_oob=1e-5).to_line().startswith("PASS (0.001 % out, ")
    slightly = replace(NEARLY, max_oob=0.2, beyond_m=0.3)
    assert len({colour_of(row.outcome) for row in (KEPT, slightly, NEARLY, LEFT, WRONG)}) == 5
    assert summary([NEARLY, KEPT, slightly, replace(NEARLY, max_oob=0.9, beyond_m=1.5)]) == [
        ("PASS", 1, "25 %", "+0.620 m", "inside"),
        ("PASS (partly outside)", 1, "25 %", "+0.620 m", "20 % out, 0.30 m"),
        ("PASS (mostly outside)", 2, "50 %", "+0.620 m", "90 % out, 1.50 m"),
    ]
    assert json.loads(NEARLY.to_json())["beyond_m"] == 1.1349
    grades = {graded("PASS", share) for share in (0.0, 0.2, 0.9)}
    assert grades <= {*COLOURS}


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


def test_a_line_of_a_driven_road_fits_into_80_columns() -> None:
    far = replace(LEFT, file="roadgpt-runs/a-very-long-description/test.0001.json", name="test.0001.json")
    assert far.to_line().endswith("  test.0001.json")
    assert len(f"1000/1000  {far.to_line()}") <= 80
    outside = replace(NEARLY, max_oob=0.9999, beyond_m=10.0, name="test.0001.json")
    assert len(f"1000/1000  {outside.to_line()}") <= 80
    assert json.loads(far.to_json())["file"] == far.file


def test_what_is_printed_while_a_step_is_made_goes_to_standard_error(
    capsys: pytest.CaptureFixture[str],
) -> None:
    def steps():  # type: ignore[no-untyped-def]
        for number in (1, 2):
            print("a driver says", number)
            yield number
        print("a driver says goodbye")

    for step in apart(steps()):
        print("row", step)
    assert capsys.readouterr() == (
        "row 1\nrow 2\n", "a driver says 1\na driver says 2\na driver says goodbye\n"
    )  # fmt: skip


def test_an_error_while_a_step_is_made_leaves_standard_output_where_it_was() -> None:
    def steps():  # type: ignore[no-untyped-def]
        yield 1
        raise KeyboardInterrupt

    before = sys.stdout
    with pytest.raises(KeyboardInterrupt):
        list(apart(steps()))
    assert sys.stdout is before


@pytest.mark.parametrize(
    ("margin", "told"),
    [(-1e-9, "below 0 m"), (-0.0006, "-0.001 m"), (0.0, "+0.000 m"), (0.25, "+0.250 m")],
)
def test_a_margin_that_is_hardly_negative_is_not_minus_nothing(margin: float, told: str) -> None:
    assert metres(margin) == told


@pytest.mark.parametrize(("status", "is_told"), [(143, True), (0, False)])
def test_what_is_finished_is_told_if_a_library_replaces_the_interrupt(
    status: int, is_told: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def work() -> None:
        with Screen(3) as screen:
            screen.row(KEPT)
            raise OSError("interrupted")

    monkeypatch.setattr(stopping, "status", lambda: status)
    with pytest.raises(OSError, match="interrupted"):
        work()
    assert ("stopped; 1 of 3 roads are finished" in capsys.readouterr().err) is is_told
