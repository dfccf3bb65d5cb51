"""Options of ``roadgpt learn`` that would have no effect are refused."""

from click.testing import CliRunner

from roadgpt.cli import app


def test_only_an_installed_reader_can_be_deepened(tmp_path) -> None:
    words = ["learn", "train", str(tmp_path / "out"), "--weights", str(tmp_path), "--encoder-layers", "12"]
    found = CliRunner().invoke(app, words)
    assert found.exit_code != 0
    assert "add --installed or --second" in f"{found.output}{found.exception}"
