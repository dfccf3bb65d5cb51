"""Prompts with truths: a reading is right if all roads made of it meet the truth."""

import json
from pathlib import Path

import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.errors import LearnError
from roadgpt.learn.told_prompts import is_right, told_prompts
from roadgpt.study.truth import Truth

DATA = Path(__file__).parents[2] / "data" / "outsiders"
TWO_LEFTS = Truth.model_validate({"turns": 2, "left": 2, "right": 0})


def test_a_plan_that_leaves_the_asked_side_open_is_not_right_for_all_seeds() -> None:
    assert is_right(read_plan("turn x2 left"), TWO_LEFTS)
    assert not is_right(read_plan("turn x2"), TWO_LEFTS)
    assert not is_right(read_plan("turn x3 left"), TWO_LEFTS)


def test_a_road_that_cannot_be_made_is_not_right() -> None:
    assert not is_right(read_plan("turn x2 left | len=30"), TWO_LEFTS)


def test_prompts_that_must_be_refused_have_no_truth(tmp_path: Path) -> None:
    lines = [
        {"id": "a", "prompt": "two lefts", "truth": {"left": 2}},
        {"id": "b", "prompt": "x", "refuse": True},
    ]
    path = tmp_path / "prompts.jsonl"
    path.write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
    (prompt,) = told_prompts(path)
    assert prompt.text == "two lefts"
    assert prompt.truth.left == (2, 2)


@pytest.mark.parametrize(
    "line", ["{", "[]", '{"truth": {"left": 2}}', '{"prompt": "x", "truth": {"lefts": 2}}']
)
def test_a_line_that_is_no_prompt_is_named(tmp_path: Path, line: str) -> None:
    path = tmp_path / "prompts.jsonl"
    path.write_text(f'{{"prompt": "a", "truth": {{"left": 1}}}}\n{line}\n', encoding="utf-8")
    with pytest.raises(LearnError, match="line 2"):
        told_prompts(path)


@pytest.mark.parametrize("path", sorted(DATA.rglob("*.jsonl")), ids=lambda path: path.stem)
def test_every_line_of_the_outsiders_is_whole(path: Path) -> None:
    rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    assert len({row["id"] for row in rows}) == len(rows)
    if "changes" in path.stem:
        assert all({"road", "request", "truth", "need"} <= set(row) for row in rows)
        return
    assert len(told_prompts(path)) == sum("refuse" not in row for row in rows)
