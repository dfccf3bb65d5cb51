"""Standard output and standard error: what fails there, progress, unexpected errors, and what users' drivers
print."""

import io
import logging
import os
import platform
import re
import sys
import tempfile
import time
import traceback
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, redirect_stdout, suppress
from pathlib import Path
from typing import TypeVar, cast

import click

from roadgpt import __version__
from roadgpt.errors import GivenUpError

T = TypeVar("T")
LETTERS = "backslashreplace"  # characters that the stream's encoding lacks are written as escapes
OWN = re.compile(r"(\x1b\[(?:[01]|3[1-6]|91)m)")  # what sets our colours; no text can hide itself by them
_TURNING = (*range(0x200E, 0x2010), *range(0x2028, 0x202F), *range(0x2066, 0x206A))
COMMANDS = {code: f"\\u{code:04x}" for code in (*range(9), *range(11, 32), *range(0x7F, 0xA0), *_TURNING)}
"""Characters that command a terminal, or turn text around, and how they are shown; as in JSON."""


class OutputError(Exception):
    """Raised if standard output cannot be written to. It is not an OSError, because click handles some
    OSErrors itself."""

    def __init__(self, cause: OSError) -> None:
        self.is_reader_gone = isinstance(cause, BrokenPipeError)
        super().__init__(
            f"cannot write to standard output ({cause.strerror or cause}); send it where there is room"
        )


def shown(text: str) -> str:
    """Returns text, as it may stand in anybody's file, as it is printed: characters that command a terminal
    stand as escapes, apart from our own colours."""
    parts = OWN.split(text)
    parts[::2] = (part.translate(COMMANDS) for part in parts[::2])
    return "".join(parts)


class _Shown(io.TextIOWrapper):
    def write(self, text: str) -> int:
        return super().write(shown(text))


class _Output(_Shown):
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
    """Makes both output streams accept every character, and show those that command a terminal; failed writes
    to standard output raise OutputError. A stream that was closed before is replaced by the null device."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it warns if it cannot keep its list of fonts
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:  # writing to standard output then fails, as to one that is closed
            opened = os.open(os.devnull, os.O_WRONLY if name == "stderr" else os.O_RDONLY)
            if opened != number:
                os.dup2(opened, number)
                os.close(opened)
            setattr(sys, name, os.fdopen(number, "r" if name == "stdin" else "w"))
    if isinstance(sys.stderr, io.TextIOWrapper):
        sys.stderr = _Shown(sys.stderr.detach(), sys.stderr.encoding, LETTERS, line_buffering=True)
    if isinstance(sys.stdout, io.TextIOWrapper):
        encoding, is_terminal = sys.stdout.encoding, sys.stdout.line_buffering
        sys.stdout = _Output(sys.stdout.detach(), encoding, LETTERS, line_buffering=is_terminal)


def drop_output() -> None:
    """Redirects standard output to the null device after a failed write: Python flushes it again at exit."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, sys.stdout.fileno())
    os.close(nothing)


def warn(sentence: object) -> None:
    """Prints a sentence on standard error, preceded by the name of the program."""
    click.echo(f"roadgpt: {shown(str(sentence))}", err=True)


@contextmanager
def resumable(advice: str) -> Iterator[None]:
    """After Ctrl-C, or if a simulator is given up, prints ``advice`` on how to continue."""
    try:
        yield
    except (KeyboardInterrupt, GivenUpError):
        warn(f"stopped; {advice}")
        raise


def is_coloured() -> bool:
    """Returns whether the variables NO_COLOR and TERM permit coloured output on a terminal."""
    return not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def apart(steps: Iterable[T]) -> Iterator[T]:
    """Yields the steps of an iterable. Text printed meanwhile, such as by a user's driver, goes to standard
    error, so that standard output holds only result rows."""
    made, ended = iter(steps), object()
    while True:
        with redirect_stdout(sys.stderr):
            step = next(made, ended)
        if step is ended:
            return
        yield cast(T, step)


EVERY = 10.0  # s between two lines where there is no terminal


@contextmanager
def progress(
    what: str, total: int | None, quiet: bool = False, has_lines: bool = True
) -> Iterator[Callable[..., None]]:
    """Shows on standard error how many steps are done and the remaining time: as a bar, or where there is no
    terminal as lines, or nothing if ``has_lines`` is False.

    Yields a function to call with the number of finished steps, and with ``total``, a new total, or ``rate``,
    a text after the numbers. ``what`` names the steps, such as 'failures'; a ``total`` of None is unknown."""
    if quiet or not (has_lines or sys.stderr.isatty()):
        yield lambda *_, **__: None
    elif not sys.stderr.isatty():
        yield _lines(what, total or 0)
    else:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        texts = TextColumn("{task.description}"), TextColumn("{task.fields[rate]}"), TextColumn("ETA")
        bar = Progress(
            *(texts[0], BarColumn(), MofNCompleteColumn(), *texts[1:], TimeRemainingColumn()),
            console=Console(file=os.fdopen(os.dup(sys.stderr.fileno()), "w", errors=LETTERS)),
            # lines on standard output pass above the bar only if both are the terminal; a file must get them
            redirect_stdout=sys.stdout.isatty(),
            transient=True,
        )
        task = bar.add_task(what, total=total, rate="")
        with bar:
            yield lambda done, **more: bar.update(task, completed=done, **more)


def _lines(what: str, total: int) -> Callable[..., None]:
    """Returns a function that prints a line every ten seconds."""
    first: list[float] = []  # the time of the first step, which includes the workers' start, and its number
    told = time.monotonic()

    def tell(done: int, total: int = total, **_: object) -> None:
        nonlocal told
        now = time.monotonic()
        if not first:
            first[:] = now, done
        elif now - told >= EVERY and first[1] < done < total:
            left = (now - first[0]) / (done - first[1]) * (total - done)
            warn(f"{done:,} of {total:,} {what}, about {duration(left)} to go")
            told = now

    return tell


def watched(steps: Iterable[T], total: int, what: str, quiet: bool = False) -> Iterator[T]:
    """Yields each step when it is done, and shows how many are done and the remaining time."""
    with progress(what, total, quiet) as tell:
        for done, step in enumerate(steps, 1):
            tell(done)
            yield step


def aligned(rows: Sequence[Sequence[str]], sides: str) -> list[str]:
    """Returns lines with columns as wide as their longest text; ``sides`` says for each column whether its
    texts are at the left (<) or at the right (>)."""
    wide = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(f"{text:{side}{w}}" for text, side, w in zip(row, sides, wide, strict=True)).rstrip()
        for row in rows
    ]


def duration(seconds: float) -> str:
    """Returns a duration as text: '42 s', '3 min 20 s', '2 h 05 min'."""
    whole_seconds = round(seconds)
    if whole_seconds < 60:
        return f"{seconds:.1f} s" if seconds < 10 else f"{whole_seconds} s"
    minutes, rest = divmod(whole_seconds, 60)
    if minutes < 60:
        return f"{minutes} min {rest:02d} s"
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min"


# The folder that the command has made; if there is none, tracebacks go to the system's temporary folder.
_folder: list[Path] = []


def crashes_go_to(folder: Path) -> None:
    """Sets the folder into which tracebacks are written."""
    _folder[:] = [folder]


def report_crash(error: Exception) -> str:
    """Writes the traceback to a file; returns a sentence that says what happened and where the file is."""
    head = f"roadgpt {__version__}, Python {platform.python_version()}, {platform.platform()}\n"
    head += f"arguments: {sys.argv[1:]}\n\n"
    text = head + "".join(traceback.format_exception(error))
    what = f"{type(error).__name__}: {error}".splitlines()[0][:200]
    report = f"an error that should not happen ({what}); please report it with"
    for folder in (*_folder, Path(tempfile.gettempdir())):
        with suppress(OSError):
            with tempfile.NamedTemporaryFile(
                "w", prefix="roadgpt-crash-", suffix=".txt", dir=folder, delete=False, encoding="utf-8",
                errors=LETTERS,
            ) as file:  # fmt: skip
                file.write(text)
            return f"{report} the file {file.name}"
    sys.stderr.write(text)
    return f"{report} the lines above"
