"""The page on descriptions: what it says can be said is read in full, and what it says cannot is not."""

import re
from pathlib import Path

import pytest

from roadgpt.brief import read
from roadgpt.errors import BriefError

PAGE = (Path(__file__).parents[2] / "docs" / "how-to" / "describe-a-road.md").read_text("utf-8")
EXAMPLES = [
    line for block in re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL) for line in block.splitlines()
]
ROWS = [
    tuple(cell.strip() for cell in line.strip("|").split("|"))
    for line in PAGE.splitlines()
    if line.startswith("| ") and not line.startswith("| not understood")
]


@pytest.mark.parametrize("words", EXAMPLES)
def test_examples_are_read_in_full(words: str) -> None:
    assert read(words, "grammar").unused == ()


@pytest.mark.parametrize(("words", "instead"), ROWS, ids=[row[0] for row in ROWS])
def test_limits_are_told_and_the_way_around_is_read(words: str, instead: str) -> None:
    try:
        told = bool(read(words, "grammar").unused)
    except BriefError:
        told = True
    assert told
    assert read(instead, "grammar").unused == ()


def test_there_are_examples_and_limits() -> None:
    assert len(EXAMPLES) >= 25
    assert len(ROWS) >= 8
