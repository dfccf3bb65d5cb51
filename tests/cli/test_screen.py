"""Rows and screens: what is printed, where, and the table at the end."""

import json
from dataclasses import replace

import pytest

from roadgpt import stopping
from roadgpt.cli.screen import COLOURS, Row, Screen, colour_of, metres, summary
from roadgpt.cli.streams import apart
from roadgpt.verdict import graded

KEPT = Row("a.json", "PASS", "kept its lane", max_oob=0.0, margin_m=0.62, length_m=187.25, seconds=1.234567)
LEFT = Row(
    "b.json", "FAIL", "left its lane", cause="out of lane", max_oob=0.97, margin_m=-0.06, length_m=90.0
)
NEARLY = replace(KEPT, file="n.json", max_oob=0.62, beyond_m=1.1349)
WRONG = Row("c.json", "INVALID", "it is too sharp", is_valid=False, validation_message="it is too sharp")


def test_collisions_and_what_never_happened_are_told_on_the_line() -> None:
    hit = Row("d.json", "FAIL", "hit car 1", cause="collision", at_fault=True)
    assert hit.to_line().endswith("d.json  hit car 1")
    never = replace(KEPT, description="kept its lane; it never happened that car 1 brakes")
    assert never.to_line().endswith("car 1 brakes")
    assert KEPT.to_line().endswith("a.json")


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
    assert replace(NEARLY, max_oob=1e-5).to_line().startswith("PASS (<0.1 % out, ")
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


@pytest.mark.parametrize(
    ("margin", "told"), [(-1e-9, "below 0 m"), (-0.0006, "-0.001 m"), (0.0, "+0.000 m"), (0.25, "+0.250 m")]
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
