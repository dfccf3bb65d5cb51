"""Help is short, grouped and whole: six headings, at most 20 commands, every option under --help-all."""

import re

import click
import pytest
from click.testing import CliRunner

from roadgpt.cli import app
from roadgpt.cli.app import commands

NARROW = {"COLUMNS": "80"}


def help_of(*words: str) -> list[str]:
    result = CliRunner(env=NARROW).invoke(app, [*words], prog_name="roadgpt", terminal_width=80)
    assert result.exit_code == 0, result.output
    return result.stdout.splitlines()


def sections(lines: list[str]) -> dict[str, list[str]]:
    """The lines under each heading."""
    found: dict[str, list[str]] = {}
    heading = ""
    for line in lines:
        if re.fullmatch(r"[A-Z][\w ]*:", line):
            heading = line[:-1]
        elif heading and line.startswith("  "):
            found.setdefault(heading, []).append(line)
    return found


def test_the_help_has_six_headings_and_at_most_twenty_three_commands() -> None:
    found = sections(help_of("--help"))
    headings = ["Make", "Look", "Search", "Evaluate", "Exchange", "Set up"]
    assert [*found] == ["Options", *headings]
    names = [line.split()[0] for name in headings for line in found[name] if re.match(r"  \S", line)]
    names.remove("First")  # the line below the last heading
    assert len(names) <= 23
    assert sorted(names) == sorted(commands())


def test_the_help_of_run_fits_on_60_lines_of_80_columns() -> None:
    lines = help_of("run", "--help")
    assert len(lines) <= 60
    assert max(map(len, lines)) <= 80


def every_command() -> list[tuple[str, ...]]:
    def inside(command: click.Command, words: tuple[str, ...]) -> list[tuple[str, ...]]:
        if not isinstance(command, click.Group):
            return [words]
        return [each for name, its in command.commands.items() for each in inside(its, (*words, name))]

    context = click.Context(app, **app.context_settings)
    every = {name: app.get_command(context, name) for name in commands()}
    return [each for name, its in every.items() if its is not None for each in inside(its, (name,))]


def command_of(words: tuple[str, ...]) -> click.Command:
    command = app.get_command(click.Context(app, **app.context_settings), words[0])
    for word in words[1:]:
        assert isinstance(command, click.Group)
        command = command.commands[word]
    assert command is not None
    return command


@pytest.mark.parametrize("words", every_command(), ids=" ".join)
def test_every_option_is_listed_under_help_all_and_has_a_sentence(words: tuple[str, ...]) -> None:
    text = "\n".join(help_of(*words, "--help-all"))
    for option in command_of(words).params:
        if isinstance(option, click.Option) and not option.hidden:
            assert option.help, option.name
            for name in (*option.opts, *option.secondary_opts):
                assert re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", text), name


@pytest.mark.parametrize("words", every_command(), ids=" ".join)
def test_help_says_how_to_see_the_options_that_it_leaves_out(words: tuple[str, ...]) -> None:
    short, whole = help_of(*words, "--help"), help_of(*words, "--help-all")
    listed = [[line for line in lines if re.match(r"  +-", line)] for lines in (short, whole)]
    assert len(listed[0]) <= len(listed[1])
    if len(listed[0]) < len(listed[1]) - 1:
        assert any("--help-all" in line for line in short)
    assert sum(map(len, sections(short).values())) > 0
