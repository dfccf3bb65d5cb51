"""An error that nobody foresaw ends in one sentence, a file with the traceback, and exit status 70."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from roadgpt.cli import app, streams
from roadgpt.cli.commands import set_up


def broken() -> None:
    raise ZeroDivisionError("nobody foresaw this\nor that")


def test_the_traceback_goes_to_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(set_up, "installed", broken)
    monkeypatch.setattr(streams, "_folder", [tmp_path])
    result = CliRunner().invoke(app, ["config", "plugins"])
    assert result.exit_code == 70
    (file,) = tmp_path.iterdir()
    assert str(file) in result.stderr
    assert "ZeroDivisionError: nobody foresaw this" in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert "in broken" in file.read_text()
