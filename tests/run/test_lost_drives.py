"""When a simulator is given up: three losses in a row, and none that healed."""

import json
import pickle
from collections.abc import Iterator
from pathlib import Path

import pytest

from command_line import invoke
from roadgpt.errors import GivenUpError
from roadgpt.run import Request, Run
from roadgpt.run.model import given_up


def test_drive_gives_up_at_the_third_in_a_row_and_says_from_where_to_go_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lost: Iterator[bool] = iter((True, True, False, True, True, True, False))
    for number in range(1, 8):
        (tmp_path / f"{number}.json").write_text(json.dumps([[20, 20], [40, 20]]))
    monkeypatch.setattr(
        "roadgpt.run.prove",
        lambda *_, **__: Run(Request(), 1, 1, "ERROR", "no answer", is_lost=next(lost)),
    )
    done = invoke("drive", *(tmp_path / f"{number}.json" for number in range(1, 8)), "--json")
    assert done.exit_code == GivenUpError.exit_status
    assert "3 times in a row and is given up (no answer)" in done.stderr
    assert f"from {tmp_path / '4.json'} on again" in done.stderr
    assert len(done.stdout.splitlines()) == 5
    assert next(lost) is False


def test_its_sentence_travels_between_processes() -> None:
    error = pickle.loads(pickle.dumps(given_up("it is gone", "say it again")))
    assert isinstance(error, GivenUpError)
    assert str(error) == "the simulator failed 3 times in a row and is given up (it is gone); say it again"
