"""The page on descriptions: its examples are read as the plans that stand here, written by hand."""

import re
from pathlib import Path

import pytest

from roadgpt.brief import normal, read
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.plan import PlanReader
from tables import rows

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "describe-a-road.md").read_text("utf-8")
EXAMPLES = [
    line for block in re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL) for line in block.splitlines()
]
MEANT = dict(rows(__file__, "meant"))
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
