"""Pairs of changes and contrasts: every label is a plan, and no text is one of a test."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from roadgpt.brief.change.plan import change_plan, read_change_plan
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.plan import PlanReader
from roadgpt.brief.refusal import refused
from roadgpt_training.near_duplicates import near_duplicates

DATA = Path(__file__).resolve().parents[1] / "data"
CHANGES = sorted((DATA / "changes" / "train").glob("*.jsonl"))
OF_SCENES = sorted(
    path for name in ("scenes", "scenes_validation") for path in (DATA / "changes" / name).glob("*.jsonl")
)
CONTRASTS = sorted((DATA / "descriptions" / "contrasts").glob("*.jsonl"))
FREE = sorted((DATA / "descriptions" / "free").glob("*.jsonl"))
FIELD = sorted(path for name in ("train", "validation") for path in (DATA / "field" / name).glob("*.jsonl"))
JUDGED = [
    *(DATA / "fresh").rglob("*.jsonl"),
    *(DATA / "descriptions" / "test").glob("*.jsonl"),
    *(DATA / "descriptions" / "exam").glob("*.jsonl"),
    *(DATA / "descriptions" / "contrasts_validation").glob("*.jsonl"),
    *(DATA / "descriptions" / "free_validation").glob("*.jsonl"),
    *(DATA / "changes" / "validation").glob("*.jsonl"),
    DATA.parents[1] / "tests" / "edit" / "edits.jsonl",
]


def rows(path: Path) -> list[dict[str, Any]]:
    """The lines of a file."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def letters(row: dict[str, Any]) -> str:
    """The words of a text, without signs and capitals."""
    return re.sub(r"\W+", " ", row.get("text", row.get("request", "")).lower()).strip()


@pytest.mark.parametrize(
    "path", [*CHANGES, *OF_SCENES, *CONTRASTS, *FREE, *FIELD], ids=lambda path: path.stem
)
def test_labels_are_in_the_language_of_plans(path: Path) -> None:
    """Of each file every thirtieth one; all together take two minutes."""
    for row in rows(path)[::30]:
        assert row.keys() == {"text", "plan", "family", "lang", *(["manner"] if path in FIELD else [])}
        assert row["family"] == path.stem
        if row["plan"].startswith("!"):
            assert "has no refusal" not in str(refused(row["plan"])), row
        elif path in CHANGES or path in OF_SCENES:
            line = change_plan(read_change_plan(row["plan"]))
            assert change_plan(read_change_plan(line)) == line
        else:
            brief = PlanReader().read(row["plan"])
            assert read_plan(plan(brief)).model_copy(update={"words": row["plan"]}) == brief


def test_there_are_as_many_as_the_pages_say() -> None:
    page = (DATA / "field" / "README.md").read_text(encoding="utf-8")
    said = dict(re.findall(r"^\| `(\w+)` \| (\d+) \|", page, re.MULTILINE))
    assert {path.stem: str(len(rows(path))) for path in FIELD} == said
    assert sum(len(rows(path)) for path in CHANGES) == 13055
    assert sum(len(rows(path)) for path in OF_SCENES) == 4445 + 378
    assert sum(len(rows(path)) for path in CONTRASTS) == 3299
    assert sum(len(rows(path)) for path in FREE) == 12740
    assert "4,445 lines" in (DATA / "changes" / "README.md").read_text(encoding="utf-8")
    assert "12,740 lines" in (DATA / "descriptions" / "README.md").read_text(encoding="utf-8")
    assert "13,055 pairs" in (DATA / "changes" / "README.md").read_text(encoding="utf-8")
    assert "3,299 lines" in (DATA / "descriptions" / "README.md").read_text(encoding="utf-8")


def test_no_text_is_one_of_a_test_or_stands_twice() -> None:
    judged = {letters(row) for path in JUDGED for row in rows(path)}
    for paths in (CHANGES, OF_SCENES, CONTRASTS, FREE):
        texts = [letters(row) for path in paths for row in rows(path)]
        assert len(texts) == len(set(texts))
        assert not judged & {*texts}


def test_no_free_text_comes_near_one_of_a_test() -> None:
    tested = [row["text"] for name in ("test", "exam") for row in split(name)]
    freely = [row["text"] for name in ("free", "free_validation") for row in split(name)]
    found = near_duplicates([*tested, *freely])
    assert [pair for pair in found if pair.first < len(tested) <= pair.second] == []


def split(name: str) -> Iterator[dict[str, Any]]:
    """The lines of one folder of descriptions."""
    for path in sorted((DATA / "descriptions" / name).glob("*.jsonl")):
        yield from rows(path)


@pytest.mark.parametrize(
    "folder", [DATA / "fresh", *sorted((DATA / "fresh" / "retired").iterdir())], ids=lambda path: path.name
)
def test_the_fresh_sentences_are_there_whole(folder: Path) -> None:
    counts = {path.stem: len(rows(path)) for path in folder.glob("*.jsonl")}
    refusals = 128 if folder.name == "fresh" else 130
    assert counts == {"descriptions": 200, "contrasts": 100, "changes": 100, "refusals": refusals}
    kept = [row for path in folder.glob("*.jsonl") for row in rows(path)]
    assert len({row["id"] for row in kept}) == 400 + refusals
    assert all({"truth", "lang"} <= row.keys() for row in kept)
