"""The guide to studies: its code runs, its prompt is one, and its table names every key of a truth."""

import json
import re
from pathlib import Path

import pytest

from roadgpt.check.truth import Truth
from roadgpt_study.plan import Prompt

GUIDE = (Path(__file__).resolve().parents[2] / "docs" / "how-to" / "evaluate-roads.md").read_text(
    encoding="utf-8"
)


def block(language: str) -> str:
    (code,) = re.findall(rf"^```{language}\n(.*?)^```", GUIDE, flags=re.MULTILINE | re.DOTALL)
    return str(code)


def test_the_python_runs(capsys: pytest.CaptureFixture[str]) -> None:
    exec(compile(block("python"), "evaluate-roads.md", "exec"), {})
    assert 0 < float(capsys.readouterr().out) < 1


def test_the_prompt_is_one() -> None:
    prompt = Prompt.model_validate(json.loads(block("json")))
    assert prompt.truth is not None
    assert prompt.truth.given() == ("left", "sequence")


def test_every_key_is_told() -> None:
    rows = re.findall(r"^\| (`.*?`) \|", GUIDE, flags=re.MULTILINE)
    told = {key for row in rows for key in re.findall(r"`(\w+)`", row)}
    assert told == set(Truth.model_fields)
