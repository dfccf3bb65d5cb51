"""The hand-written data set keeps what its card says."""

import json
import shutil
from collections import Counter
from functools import cache
from pathlib import Path

import pytest
from click.testing import CliRunner

from roadgpt_training import labels
from roadgpt_training.__main__ import command
from roadgpt_training.labels import read_pairs
from roadgpt_training.near_duplicates import report

HAND = Path(__file__).parents[1] / "data" / "descriptions"
Splits = dict[str, list[dict[str, str]]]
SPLITS = ("train", "validation", "test", "exam")


@pytest.fixture(scope="module")
def splits() -> Splits:
    """All lines."""
    files = {split: sorted((HAND / split).glob("*.jsonl")) for split in SPLITS}
    return {
        split: [json.loads(line) for path in paths for line in path.read_text("utf-8").splitlines()]
        for split, paths in files.items()
    }


def test_every_pair_can_be_used(tmp_path: Path) -> None:
    """Of those to train on every tenth one; a plan that many have is brought into standard form once."""
    for path in sorted((HAND / "train").glob("*.jsonl")):
        (tmp_path / path.name).write_text("\n".join(path.read_text("utf-8").splitlines()[::10]), "utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(labels, "_standard", cache(labels._standard))
        for folder in (tmp_path, *(HAND / split for split in SPLITS[1:])):
            assert read_pairs(folder.glob("*.jsonl"))[1] == []


def test_there_are_enough_in_five_languages(splits: Splits) -> None:
    assert sum(map(len, splits.values())) >= 17_000
    assert len(splits["test"]) >= 500
    for pairs in splits.values():
        assert {pair["lang"] for pair in pairs} >= {"en", "de", "fr"}
    assert {pair["lang"] for pair in splits["train"]} == {"en", "de", "fr", "es", "it"}
    refusals = sum(pair["plan"].startswith("!") for pair in splits["exam"])
    assert refusals >= 200
    assert len(splits["exam"]) - refusals >= 200


def test_no_family_of_phrasing_is_on_two_sides(splits: Splits) -> None:
    families = [{pair["family"] for pair in pairs} for pairs in splits.values()]
    assert sum(map(len, families)) == len(set.union(*families))


def test_every_description_was_written_for_itself(splits: Splits) -> None:
    assert report({name: [pair["text"] for pair in pairs] for name, pairs in splits.items()}) == []


def test_some_must_be_refused_for_each_reason(splits: Splits) -> None:
    for pairs in splits.values():
        plans = Counter(pair["plan"] for pair in pairs)
        assert all(plans[reason] >= 5 for reason in ("!nonsense", "!contradiction", "!impossible"))


def test_the_command_checks_and_generates(tmp_path: Path) -> None:
    hand = tmp_path / "hand"
    for split, name in (("train", "v_de.de"), ("validation", "v_it.it"), ("test", "test_tutti.it")):
        (hand / split).mkdir(parents=True)
        shutil.copy(next(HAND.glob(f"*/{name}.jsonl")), hand / split)
    done = CliRunner().invoke(command, ["data", str(tmp_path / "made"), "--hand", str(hand), "-n", "60"])
    assert done.exit_code == 0, done.output
    for split in ("train", "validation", "test"):
        number = sum(len(path.read_text("utf-8").splitlines()) for path in (hand / split).iterdir())
        assert f"{number} pairs by hand for {split}" in done.output
    lines = (tmp_path / "made" / "generated.jsonl").read_text(encoding="utf-8").splitlines()
    assert len({json.loads(line)["text"].lower() for line in lines}) == 60


def test_a_reader_gets_its_row(tmp_path: Path) -> None:
    (tmp_path / "test").mkdir()
    pairs = [("three turns", "turn x3"), ("a left bend", "turn right"), ("what a lovely day", "!nonsense")]
    lines = [json.dumps({"text": text, "plan": plan, "family": "f", "lang": "en"}) for text, plan in pairs]
    (tmp_path / "test" / "f.jsonl").write_text("\n".join(lines), encoding="utf-8")
    asked = ["evaluate", "--hand", str(tmp_path), "--split", "test", "--misses", "5"]
    done = CliRunner().invoke(command, asked)
    assert done.exit_code == 0, done.output
    assert "| model | 3 | 66.7 |" in done.output
    assert "'a left bend'" in done.output
