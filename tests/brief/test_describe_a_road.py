"""The page on descriptions: its examples are read as the plans that stand here, written by hand."""

import re
from pathlib import Path

import pytest

from roadgpt.brief import normal, read
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.plan import PlanReader

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "describe-a-road.md").read_text("utf-8")
EXAMPLES = [
    line for block in re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL) for line in block.splitlines()
]
MEANT = {
    "three turns": "turn x3",
    "5 turns, at least 3 to the left": "turn x5 | lefts=3..",
    "no more than 3 bends, all gentle": "turn x..3 gentle",
    "two left turns and three sharp right turns": "turn x2 left; turn x3 right sharp",
    "four gentle curves alternating between left and right": "turn x4 gentle alternating",
    "four turns, the last one a hairpin": "turn x3; hairpin",
    "5 turns, all left except the third": "turn x2 left; turn right; turn x2 left",
    "a right-hand hairpin between two gentle left bends": "turn left gentle; hairpin right; turn left gentle",
    "first a hairpin to the left, then a chicane, finally a right turn": "hairpin left; chicane; turn right",
    "a winding road with 7 turns": "turn x7",
    "a road that turns left 90 degrees, runs straight for 60 metres and turns right 45 degrees": (
        "turn left 90; straight 60; turn right 45"
    ),
    "two bends of 45 and 90 degrees": "turn 45; turn 90",
    "three turns; 270 degrees of turning in all": "turn x3 | turning=270",
    "two right-hand curves, the first of 30 m radius, the second of twice that": (
        "turn right r=30; turn right r=60"
    ),
    "four identical left turns, 180 degrees in all": "turn x4 left | alike turning=180",
    "six turns, no bend under 60 degrees": "turn x6 | deg=60..",
    "a straight flat road": "straight | flat",
    "a long straight followed by a sharp right turn": "straight long; turn right sharp",
    "the first 100 m are flat, then two turns": "straight flat 100; turn x2",
    "a 300 metre road with 6 turns": "turn x6 | len=300",
    "a road at least 400 m long": "| turns=1.. len=400..",
    "an uphill road with 3 turns": "turn x3 | up",
    "a downhill road, nowhere steeper than 8 %": "| turns=1.. down steepest=..8",
    "a straight road climbing at 6 %": "straight | up pct=6",
    "a road going uphill for 3 turns and downhill for 2 turns": "turn x3 up; turn x2 down",
    "flat for 100 m, then a steep climb, then flat again": (
        "straight flat 100; straight steeply_up; straight flat | turns=0"
    ),
    "a hilly road with 2 turns": "turn x2 | hills=3..",
    "a straight of 120 m that rises 6 m, then a hairpin to the left": (
        "straight up len=120 climb=6; hairpin left"
    ),
    "four turns, first half uphill, second half downhill": "turn x2 up; turn x2 down",
    "a road that is hard for a lane keeper, with at least 4 turns": "turn x4.. | hard",
    "eine bergauf führende Straße mit drei Kurven": "turn x3 | up",
}
ROWS = [
    tuple(cell.strip() for cell in line.strip("|").split("|"))
    for line in PAGE.splitlines()
    if line.startswith("| ") and not line.startswith("| write")
]


@pytest.mark.parametrize("words", EXAMPLES)
def test_examples_are_read_as_they_are_meant(words: str) -> None:
    wanted = normal(PlanReader().read(MEANT[words]))
    assert normal(read_plan(plan(normal(read(words))))) == normal(read_plan(plan(wanted)))


@pytest.mark.parametrize(("words", "other"), ROWS, ids=[row[0] for row in ROWS])
def test_what_to_write_instead_is_read_in_full(words: str, other: str) -> None:
    brief = read(words)
    assert brief.unused == ()
    assert brief.beside == ()


def test_there_are_examples_and_limits() -> None:
    assert {*EXAMPLES} == {*MEANT}
    assert len(ROWS) >= 5
