"""Handles errors of standard output, and keeps the output of users' drivers out of standard output."""

import io
import logging
import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, redirect_stdout
from typing import TypeVar

import click

from roadgpt.errors import GivenUpError

Step = TypeVar("Step")
LETTERS = "backslashreplace"  # characters that the stream's encoding lacks are written as escapes


class OutputError(Exception):
    """Raised if standard output cannot be written to. It is not an OSError, because click handles some
    OSErrors itself."""

    def __init__(self, cause: OSError) -> None:
        self.is_reader_gone = isinstance(cause, BrokenPipeError)
        super().__init__(
            f"cannot write to standard output ({cause.strerror or cause}); send it where there is room"
        )


class _Output(io.TextIOWrapper):
    """Standard output that raises OutputError if it cannot be written to."""

    def write(self, text: str) -> int:
        try:
            return super().write(text)
        except OSError as error:
            raise OutputError(error) from error

    def flush(self) -> None:
        try:
            super().flush()
        except OSError as error:
            raise OutputError(error) from error


def make_ready() -> None:
    """Makes both output streams accept every character; failed writes to standard output raise OutputError.

    A stream that was closed before the program began is replaced by the null device. What matplotlib says of
    a HOME where it cannot keep its list of fonts is not shown.
    """
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    if sys.stdin is None:
        sys.stdin = os.fdopen(_nothing(0, os.O_RDONLY))
    if sys.stdout is None:
        sys.stdout = os.fdopen(_nothing(1, os.O_RDONLY), "w")  # writing fails, as to one that is closed
    if sys.stderr is None:
        sys.stderr = os.fdopen(_nothing(2, os.O_WRONLY), "w")
    if isinstance(sys.stderr, io.TextIOWrapper):
        sys.stderr.reconfigure(errors=LETTERS)
    if isinstance(sys.stdout, io.TextIOWrapper):
        encoding, is_terminal = sys.stdout.encoding, sys.stdout.line_buffering
        sys.stdout = _Output(sys.stdout.detach(), encoding, LETTERS, line_buffering=is_terminal)


def _nothing(number: int, mode: int) -> int:
    """Opens the null device under a file number, so that no other file gets this number."""
    opened = os.open(os.devnull, mode)
    if opened != number:
        os.dup2(opened, number)
        os.close(opened)
    return number


def drop_output() -> None:
    """Redirects standard output to the null device after a write to it has failed. Python flushes standard
    output once more at exit, and this would fail, too.
    """
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, sys.stdout.fileno())
    os.close(nothing)


def warn(sentence: object) -> None:
    """Prints a sentence on standard error, preceded by the name of the program."""
    click.echo(f"roadgpt: {sentence}", err=True)


@contextmanager
def resumable(advice: str) -> Iterator[None]:
    """Context manager: after Ctrl-C, or if a simulator is given up, prints ``advice`` on how to continue."""
    try:
        yield
    except (KeyboardInterrupt, GivenUpError):
        warn(f"stopped; {advice}")
        raise


def is_coloured() -> bool:
    """Returns whether the variables NO_COLOR and TERM permit coloured output on a terminal."""
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def apart(steps: Iterable[Step]) -> Iterator[Step]:
    """Yields the steps of an iterable. Text printed meanwhile, such as by a user's driver, goes to standard
    error, so that standard output holds only result rows.
    """
    made = iter(steps)
    while True:
        with redirect_stdout(sys.stderr):
            try:
                step = next(made)
            except StopIteration:
                return
        yield step
