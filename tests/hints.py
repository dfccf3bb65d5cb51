"""Commands that commands print: each is parsed, and every kind of those that only read is typed, too.

Every command line that ``roadgpt`` prints in a test is looked at (``conftest.py`` sees to it), right after
the command that printed it: the command line must take it, and what it names must be there. Commands in
``CHEAP`` are typed as well, the first of each kind in all processes, which is the command with the names of
its options: in a copy of the folders as they are then, and as a new process would, which knows of no driver
and no server. The others drive roads; ``cli/test_hints.py`` types those.
"""

import os
import re
import shlex
import shutil
from collections.abc import Sequence
from pathlib import Path

import click
import pytest
from click.testing import CliRunner, Result

from page_words import words_of
from roadgpt import provenance
from roadgpt.campaign.selection import selection_of
from roadgpt.campaign.workers import InProcess
from roadgpt.cli import app
from roadgpt.cli.app import commands
from roadgpt.cli.options import GroupedCommand
from roadgpt.errors import UsageError

LINE = re.compile(rf"(?:^|: |  |`)(roadgpt (?:{'|'.join(commands())})\b[^`\n]*)", re.MULTILINE)
CHEAP = ("check", "export", "import", "show", "view")
WRONG = {2, 70}  # what was typed cannot be used; an internal error


def hints_in(text: str) -> list[list[str]]:
    """The commands in what was printed, as the shell splits them: each ends its line, or is in backticks."""
    told = "\n".join(line for line in text.splitlines() if not line.startswith("Usage: "))
    return [shlex.split(line) for line in LINE.findall(told)]


def kind_of(words: Sequence[str]) -> str:
    """The command and the names of its options."""
    verbs = [verb for verb in words[1 : 4 if words[1] == "study" else 2] if verb.isalpha()]
    return " ".join([*verbs, *sorted({word for word in words if re.match("--?[a-z]", word)})])


class HintCollector:
    """Looks at what commands print. ``seen`` is a folder with the kinds that any process has typed; folders
    in ``base`` are copied."""

    def __init__(self, seen: Path, base: Path) -> None:
        self.seen, self.base = seen, base
        self.printed: list[list[str]] = []
        self._invoke = CliRunner.invoke
        self._is_typing = False

    def look(self, args: Sequence[str], printed: Result) -> None:
        """Types or parses what a command printed. Raises AssertionError if that command cannot be used."""
        if self._is_typing or {"--help", "--help-all", "-h"} & {*args}:
            return
        text = printed.output
        if args[:1] == ["report"] and printed.exit_code == 0:
            text += words_of(Path(printed.stdout.splitlines()[-1]).parent)
        for words in hints_in(text):
            self.printed.append(words)
            said = f"{shlex.join(['roadgpt', *args])}\nprints\n{shlex.join(words)}\n"
            done = self.parse(words[1:], args)
            mistaken = {word for word in words if "/" in word and word in args and not Path(word).exists()}
            # a report may be of results that a test made up; what is typed writes into a copy of this folder
            can_be = not mistaken and args[:1] != ["report"] and self.base in Path.cwd().parents
            if done.exit_code == 0 and can_be and words[1] in CHEAP and self._is_new(kind_of(words)):
                done = self.type(words[1:])
            assert done.exit_code not in WRONG, f"{said}which ends with {done.exit_code}:\n{done.output}"

    def _is_new(self, kind: str) -> bool:
        try:
            (self.seen / re.sub(r"[^\w-]", "_", kind)[:200]).touch(exist_ok=False)
        except FileExistsError:
            return False
        return True

    def type(self, words: Sequence[str]) -> Result:
        """Runs a command in copies of the folders of tests, in which its paths lead."""
        here, copies = Path.cwd(), dict[str, str]()
        for folder in [str(here), *words]:
            for place in self.base.iterdir():
                if place.is_dir() and f"{place}/" in f"{folder}/" and str(place) not in copies:
                    copies[str(place)] = str(self.seen.parent / f"typed-{len(copies)}-{os.getpid()}")
                    shutil.copytree(place, copies[str(place)], symlinks=True)
        try:
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr("roadgpt.campaign.executors.processes.Processes", InProcess)
                patch.setattr("roadgpt_study.survey.serving.serve", lambda *given: None)
                patch.chdir(replaced(str(here), copies))
                return self._typed([replaced(word, copies) for word in words])
        finally:
            for copy in copies.values():
                shutil.rmtree(copy, ignore_errors=True)

    def parse(self, words: Sequence[str], given: Sequence[str] = ()) -> Result:
        """Lets the command line read a command, which only looks for what its arguments name, except for what
        the user has ``given``."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(GroupedCommand, "invoke", lambda _, ctx: look_for_arguments(ctx, given))
            return self._typed(words)

    def _typed(self, words: Sequence[str]) -> Result:
        self._is_typing = True
        try:
            with pytest.MonkeyPatch.context() as patch:
                for each in (provenance.CODE, provenance.SERVERS):
                    patch.setattr(each, "_named", {})
                    patch.setattr(each, "_files", {})
                patch.setattr(os, "environ", os.environ.copy())
                return self._invoke(CliRunner(), app, [*words], "roadgpt")
        finally:
            self._is_typing = False


def look_for_arguments(ctx: click.Context, given: Sequence[str]) -> None:
    """Raises UsageError if a file, a folder or a test that a command names is not there."""
    for parameter in ctx.command.params:
        if isinstance(parameter, click.Argument) and parameter.name in ("files", "folder", "place", "run"):
            value = ctx.params[parameter.name]
            for name in value if isinstance(value, tuple) else (value,):
                is_there = str(name) in given or Path(name).exists() or selection_of(str(name))
                if not is_there:
                    raise UsageError(f"there is no {name}")


def replaced(word: str, copies: dict[str, str]) -> str:
    """A word with the folder of a test replaced by its copy."""
    for place, copy in copies.items():
        if f"{place}/" in f"{word}/":
            return word.replace(place, copy)
    return word


def shortened(words: Sequence[str]) -> list[str]:
    """The same command for one new road or test, without pictures, which takes a second and not minutes."""
    many = () if "--out" in words else ("-n", "--roads")
    short = ["1" if before in many else word for before, word in zip(["", *words], words, strict=False)]
    if words[0] == "faults":
        short += ["--repeat", "2"]
    if words[0] in ("run", "faults") or "--again" in words:
        short.insert(1, "--no-plot")
    return short
