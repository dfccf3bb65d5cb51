"""The watch over commands in conftest: it notices a file that is named and is not there."""

from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from named_files import lacking


@click.command()
@click.argument("path")
def tells(path: str) -> None:
    click.echo(f"the report is {path}.")


def test_a_command_that_names_a_file_that_is_not_there_fails_its_test(tmp_path: Path) -> None:
    gone = tmp_path / "report.md"
    with pytest.raises(AssertionError, match=r"report\.md, which is not there"):
        CliRunner().invoke(tells, [str(gone)])
    gone.write_text("here")
    assert CliRunner().invoke(tells, [str(gone)]).exit_code == 0


def test_patterns_relative_names_and_names_with_spaces_are_looked_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert lacking(f"pictures: {tmp_path}/*.pdf") == [f"{tmp_path}/*.pdf"]
    (tmp_path / "one.pdf").touch()
    (tmp_path / "two words.md").touch()
    told = f"pictures: {tmp_path}/*.pdf, and '{tmp_path}/two words.md'; written to one.pdf: 3 roads"
    assert lacking(told) == []
    assert lacking("written to two.pdf; drive it") == ["two.pdf"]
    assert lacking(f"continue with: roadgpt show {tmp_path}/later") == []
