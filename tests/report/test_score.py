"""The scores of scenarios: classes as Euro NCAP's rating calculator 2026 has them, and what is printed."""

from pathlib import Path

import pytest

from command_line import invoke
from roadgpt.brief.scenarios import CLASSES, scenario, scenarios

pytestmark = pytest.mark.usefixtures("no_workers")


@pytest.mark.parametrize(
    ("name", "impact", "beyond", "colour"),
    [
        # CCRs: what is left of the speed, by that of the tested car
        ("ncap:CCRs ego=10", None, 0.0, "green"),
        ("ncap:CCRs ego=20", 0.5, 0.0, "red"),
        ("ncap:CCRs ego=30", 9.9, 0.0, "brown"),
        ("ncap:CCRs ego=30", 10.0, 0.0, "red"),
        ("ncap:CCRs ego=40", 9.9, 0.0, "orange"),
        ("ncap:CCRs ego=40", 19.9, 0.0, "brown"),
        ("ncap:CCRs ego=50", 5.0, 0.0, "yellow"),
        ("ncap:CCRs ego=60", 10.0, 0.0, "orange"),
        ("ncap:CCRs ego=80", 29.9, 0.0, "brown"),
        ("ncap:CCRs ego=80", 30.0, 0.0, "red"),
        # crossing paths: avoided, or not
        ("ncap:CCCscp", 1.0, 0.0, "red"),
        ("ncap:CC_ELK_On", 1.0, 0.0, "red"),
        ("ncap:CC_ELK_On", None, 0.5, "green"),
        # head-on: how much slower the tested car has become, of 100 km/h that both close with
        ("ncap:CCFhos", 95.0, 0.0, "red"),
        ("ncap:CCFhos", 85.0, 0.0, "orange"),
        ("ncap:CCFhos", 75.0, 0.0, "green"),
        # following with cruise control: 60 km/h that it closes with
        ("ncap:ACC_CCRm", 46.0, 0.0, "red"),
        ("ncap:ACC_CCRm", 40.0, 0.0, "orange"),
        ("ncap:ELK_RE", None, -0.3, "green"),
        ("ncap:ELK_RE", None, 0.09, "green"),
        ("ncap:ELK_RE", None, 0.11, "red"),
        ("ncap:LKA", None, 0.29, "green"),
        ("ncap:LKA", None, 0.31, "red"),
        ("ncap:LKA", 3.0, -0.5, "red"),
    ],
)
def test_a_test_has_the_colour_of_its_class(
    name: str, impact: float | None, beyond: float, colour: str
) -> None:
    assert scenario(name).rated(impact, beyond)[0] == colour


def test_every_scenario_is_judged_by_one_of_the_classes() -> None:
    assert {each.judged for each in scenarios().values()} == {*CLASSES}


def test_scores_are_printed_and_stand_in_the_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    asked = ("scenarios", "--score", "ncap:CCRs ego=10,ncap:ELK_RE", "robot", "--out", "s")
    done = invoke(*asked)
    assert done.exit_code == 0, done.output
    assert " 10   R 10 " in done.output
    (away,) = [line for line in done.output.splitlines() if line.startswith(" 70   G +")]
    assert 0.2 < float(away.split("+")[1].removesuffix(" m").strip(" m")) < 0.5  # 1.75 - 0.9 - 0.5 and a bit
    page = Path("s/report.html").read_text()
    assert '<td class="rated red">' in page
    assert "Euro NCAP, Crash Avoidance Frontal Collisions" in page
    again = invoke(*asked)  # nothing is left to test
    assert again.exit_code == 0, again.output
    assert " 10   R 10 " in again.output
