"""Files of prompts: what they may hold, and what is said of those that hold something else."""

import json
from pathlib import Path

import pytest

from roadgpt.errors import UsageError
from roadgpt_study.plan import read_prompts
from tables import rows


def written(folder: Path, *lines: object) -> Path:
    file = folder / "prompts.jsonl"
    file.write_text("\n".join(line if isinstance(line, str) else json.dumps(line) for line in lines) + "\n")
    return file


def test_a_truth_is_optional_and_so_is_an_id(tmp_path: Path) -> None:
    file = written(
        tmp_path, {"prompt": "a road"}, "", {"id": 7, "prompt": "x", "truth": {"turns": [1, None]}}
    )
    one, other = read_prompts(file)
    assert (one.id, one.truth) == ("1", None)
    assert other.id == "7"
    assert other.truth is not None
    assert other.truth.turns == (1, None)


@pytest.mark.parametrize(("line", "says"), rows(__file__, "a_wrong_line_is_named"))
def test_a_wrong_line_is_named(tmp_path: Path, line: object, says: str) -> None:
    file = written(tmp_path, {"prompt": "a road"}, line)
    with pytest.raises(UsageError, match="line 2") as error:
        read_prompts(file)
    assert says in str(error.value)


def test_files_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="cannot read"):
        read_prompts(tmp_path / "no.jsonl")
    (tmp_path / "b.jsonl").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(UsageError, match="UTF-8"):
        read_prompts(tmp_path / "b.jsonl")
    with pytest.raises(UsageError, match="holds no prompt"):
        read_prompts(written(tmp_path, ""))
    with pytest.raises(UsageError, match="twice"):
        read_prompts(written(tmp_path, {"id": "a", "prompt": "x"}, {"id": "a", "prompt": "y"}))
