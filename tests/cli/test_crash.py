"""An error that nobody foresaw ends in one sentence, a file with the traceback, and exit status 70."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from roadgpt.cli import app, crash
from roadgpt.cli.commands import config


def broken() -> None:
    raise ZeroDivisionError("nobody foresaw this\nor that")


def test_the_traceback_goes_to_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(config, "installed", broken)
    monkeypatch.setattr(crash, "_folder", [tmp_path])
    result = CliRunner().invoke(app, ["config", "plugins"])
    assert result.exit_code == 70
    (file,) = tmp_path.iterdir()
    assert str(file) in result.stderr
    assert "ZeroDivisionError: nobody foresaw this" in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert "in broken" in file.read_text()


def test_where_no_file_can_be_written_the_traceback_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(text: str) -> Path:
        raise OSError("the disk is full")

    monkeypatch.setattr(config, "installed", broken)
    monkeypatch.setattr(crash, "_write", full)
    result = CliRunner().invoke(app, ["config", "plugins"])
    assert result.exit_code == 70
    assert "in broken" in result.stderr


def test_a_folder_that_cannot_be_written_to_is_passed_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = crash.tempfile.NamedTemporaryFile

    def only_here(*args, **more):  # type: ignore[no-untyped-def]
        if more["dir"] != tmp_path:
            raise PermissionError(13, "Permission denied")
        return whole(*args, **more)

    monkeypatch.setattr(config, "installed", broken)
    monkeypatch.setattr(crash, "_folder", [tmp_path.parent])
    monkeypatch.setattr(crash.tempfile, "gettempdir", lambda: str(tmp_path))
    monkeypatch.setattr(crash.tempfile, "NamedTemporaryFile", only_here)
    result = CliRunner().invoke(app, ["config", "plugins"])
    (file,) = tmp_path.iterdir()
    assert str(file) in result.stderr
    assert len(result.stderr.splitlines()) == 1
