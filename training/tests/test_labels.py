"""Hand-written pairs: read, checked for originality, and readers held against them."""

import json
from pathlib import Path
from typing import ClassVar

import pytest

from roadgpt.brief.model import Brief
from roadgpt.brief.plan import read_plan
from roadgpt.errors import BriefError, UsageError
from roadgpt_training.evaluate import HEAD, confusion, readings, score, worst
from roadgpt_training.labels import read_pair, read_pairs
from roadgpt_training.near_duplicates import masked, near_duplicates, report
from roadgpt_training.pair import Pair


def line(text: str, plan: str, family: str = "f") -> str:
    return json.dumps({"text": text, "plan": plan, "family": family, "lang": "en"})


def test_a_pair_gets_its_plan_in_standard_form() -> None:
    assert read_pair(line("three turns", "| turns=3")).plan == "turn x3"
    assert read_pair(line("hello", "!nonsense")).plan == "!nonsense"


@pytest.mark.parametrize(
    "bad", ["no json", "{}", line("", "turn"), line("x", "turn sideways"), line("y" * 3000, "turn")]
)
def test_a_bad_line_is_told(bad: str) -> None:
    with pytest.raises(UsageError):
        read_pair(bad)


def test_files_are_read_with_a_sentence_for_each_bad_line(tmp_path: Path) -> None:
    lines = [
        line("a left", "turn left"),
        line("A  LEFT", "turn left"),
        line("z", "turn what"),
        line("a road", "| turns=1.."),
    ]
    (tmp_path / "a.jsonl").write_text("\n".join(lines), encoding="utf-8")
    good, problems = read_pairs(tmp_path.glob("*.jsonl"))
    assert [pair.text for pair in good] == ["a left"]
    assert [problem.split(":")[1] for problem in problems] == ["2", "3", "4"]


def test_templates_with_other_words_are_found() -> None:
    texts = [
        "please build a road with three left turns and then a hairpin",
        "please build a street with five right bends and then a hairpin",
        "the goat path zigzagged off the ridge and nobody followed it down",
    ]
    assert masked(texts[0])[:4] == ("please", "build", "A", "R")
    assert [(pair.first, pair.second) for pair in near_duplicates(texts)] == [(0, 1)]
    assert len(report({"train": texts[:1], "test": texts[1:]})) == 1


def test_short_texts_of_the_bare_vocabulary_are_no_twins() -> None:
    assert near_duplicates(["two left bends", "three right turns"]) == []


class ParrotReader:
    """Reads what it was told, refuses the rest."""

    known: ClassVar = {"three turns": "turn x3", "two left": "turn x2 right", "uphill left": "turn left"}

    def read(self, words: str) -> Brief:
        if words not in self.known:
            raise BriefError("no")
        return read_plan(self.known[words])


def test_a_reader_is_scored_whole_and_by_parts() -> None:
    pairs = [
        Pair("three turns", "turn x3", "f", "en"), Pair("two left", "turn x2 left", "f", "en"),
        Pair("uphill left", "turn left | up", "f", "en"), Pair("hello", "!nonsense", "f", "en"),
        Pair("four turns", "turn x4", "f", "en"),
    ]  # fmt: skip
    found = readings(pairs, ParrotReader().read)
    result = score(found)
    assert result.exact == pytest.approx(2 / 5)
    assert result.turns == pytest.approx(3 / 4)
    assert result.slope == pytest.approx(2 / 4)
    assert result.order_and_side == pytest.approx(2 / 4)
    assert (result.refused_rightly, result.refused_wrongly) == (1.0, 0.25)
    assert confusion(found)["left", "right"] == 1
    assert {reading.pair.text for reading in worst(found)} == {"two left", "uphill left", "four turns"}
    assert HEAD.splitlines()[0].count("|") == result.row("x").count("|")
