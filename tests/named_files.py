"""The files that a command names: whatever path it prints as written is there when it is done."""

import os
import re
import tempfile
from functools import wraps
from glob import glob
from typing import Any

from click.testing import CliRunner, Result

PATH = re.compile(re.escape(tempfile.gettempdir()) + r"/pytest-[^\s\"'`,;()<>|\\\x1b]+")
WRITTEN = re.compile(r"\bwritten (?:to|into) (?!an? )([^\s,;]+)")
CLASS = re.compile(r"(?<=\.py):\w+(:\w+=.*)?$")  # of a driver, PATH.py:CLASS:key=value
TEST = re.compile(r"/c\d+(/\d+)?$")  # a cell or a test of a campaign is no file
HINT = re.compile(r"\broadgpt [a-z].*|--[a-z-]+ \S+")  # commands to come may name what they will make

EXEMPT = ("test_top_fits_every_screen", "test_the_command_on_the_card")  # cut paths; a campaign in name only


def lacking(output: str) -> list[str]:
    """The paths below the folder of tests in what a command printed, but not in its hints, at which nothing
    is; a pattern with * has to fit a file."""
    told = HINT.sub("", output)
    found = [*PATH.findall(told), *WRITTEN.findall(told)]
    paths = (CLASS.sub("", each.rstrip(".:")) for each in found)
    paths = (path for path in paths if not TEST.search(path))
    return [path for path in paths if not (glob(path) or glob(f"{path} *"))]  # noqa: PTH207 - of text


def watch_commands() -> None:
    """From now on, a command that ends well and names a file that is not there fails its test."""
    invoke = CliRunner.invoke

    @wraps(invoke)
    def watched(*given: Any, **named: Any) -> Result:
        done = invoke(*given, **named)
        is_told = "Usage: " not in done.output  # the help names no files that are there
        if done.exit_code == 0 and is_told and not any(map(os.environ["PYTEST_CURRENT_TEST"].count, EXEMPT)):
            gone = lacking(done.output)
            assert not gone, f"the command names {', '.join(gone)}, which is not there"
        return done

    CliRunner.invoke = watched  # type: ignore[method-assign]
