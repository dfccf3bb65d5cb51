"""Descriptions in many styles, and what they ask for; written by hand from the meaning of the words."""

import json
from pathlib import Path
from typing import Any

import pytest

from roadgpt.brief import Brief, Clause, check, normal, outline, sentence
from roadgpt.brief.readers.grammar import GrammarReader

HERE = Path(__file__).parent
CASES = [json.loads(line) for line in (HERE / "descriptions.jsonl").read_text("utf-8").splitlines()]
AMOUNTS = (
    "count",
    "degrees",
    "radius",
    "length",
    "incline",
    "turns",
    "left",
    "right",
    "steepest",
    "climb",
    "hills",
)


def spelled_out(said: dict[str, Any]) -> dict[str, Any]:
    """The short form of the file (3, or [3, null]) as a Brief's JSON."""
    full: dict[str, Any] = {}
    for name, value in said.items():
        if name in AMOUNTS:
            lo, hi = value if isinstance(value, list) else (value, value)
            full[name] = {"lo": lo, "hi": hi}
        elif name == "clauses":
            full[name] = [spelled_out(clause) for clause in value]
        elif name in ("starts", "ends"):
            full[name] = spelled_out(value)
        else:
            full[name] = value
    return full


@pytest.mark.parametrize("case", CASES, ids=[case["words"][:50] for case in CASES])
def test_reads_what_is_meant(case: dict[str, Any]) -> None:
    expected = Brief.model_validate(spelled_out(case))
    read = GrammarReader().read(case["words"])
    assert normal(read) == normal(expected)
    assert read.unused == expected.unused
    assert read.words == case["words"]
    check(read)


@pytest.mark.parametrize("case", CASES, ids=[case["words"][:50] for case in CASES])
def test_says_it_again(case: dict[str, Any]) -> None:
    read = GrammarReader().read(case["words"])
    again = GrammarReader().read(sentence(read))
    assert normal(again) == normal(read), sentence(read)
    assert not again.unused
    assert outline(again) == outline(read)


def test_there_are_many_cases() -> None:
    assert len({case["words"] for case in CASES}) >= 150


def test_the_short_form_means_what_it_says() -> None:
    brief = Brief.model_validate(
        spelled_out({"words": "", "turns": [3, None], "clauses": [{"kind": "turn"}]})
    )
    assert brief.turns is not None
    assert (brief.turns.lo, brief.turns.hi) == (3, None)
    assert brief.clauses == (Clause(kind="turn"),)
