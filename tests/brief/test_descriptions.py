"""Descriptions in many styles, and what they ask for; written by hand from the meaning of the words."""

import json
from pathlib import Path
from typing import Any

from roadgpt.brief import Brief, check, normal
from roadgpt.brief.plan import plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.errors import BriefError

SHARE = 0.72
HERE = Path(__file__).parent
CASES = [json.loads(line) for line in (HERE / "descriptions.jsonl").read_text("utf-8").splitlines()]
AMOUNTS = ["count", "degrees", "radius", "length", "incline", "turns", "left", "right", "steepest", "climb"]
AMOUNTS += ["hills"]


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


def expected_of(case: dict[str, Any]) -> Brief:
    expected = Brief.model_validate(spelled_out(case))
    check(expected)
    return expected


def test_most_are_read_as_they_are_meant() -> None:
    """Their Briefs were written by hand for rules; where the guide of labels decides otherwise, they miss."""
    reader, missed = ModelReader(), []
    sample = CASES[::8]
    for case in sample:
        expected = expected_of(case)
        try:
            got = reader.read(case["words"])
        except BriefError as error:
            missed.append(f"{case['words']}: {error}")
            continue
        assert got.words == case["words"]
        if normal(got).model_copy(update={"beside": ()}) != normal(expected):
            missed.append(f"{case['words']}: {plan(got)}")
    assert len(missed) <= (1 - SHARE) * len(sample), "\n".join(missed)
