"""Shows progress with the remaining time: as a bar on a terminal, otherwise as occasional lines."""

import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from roadgpt.cli.streams import warn

T = TypeVar("T")
EVERY = 10.0  # s between two lines where there is no terminal


@contextmanager
def progress(
    what: str, total: int | None, quiet: bool = False, has_lines: bool = True
) -> Iterator[Callable[..., None]]:
    """Shows on standard error, during a ``with`` block, how many steps are done and the remaining time.

    Yields a function; call this function with the number of finished steps. Its keyword arguments change the
    bar: ``total`` is a new total, and ``rate`` is a text to show after the numbers. ``what`` names the steps
    in the plural, such as 'faults'. ``total`` is None if the number of steps is unknown. If standard error
    is no terminal, lines are printed instead of a bar; nothing is printed if ``has_lines`` is False.
    """
    if quiet or not (has_lines or sys.stderr.isatty()):
        yield lambda *_, **__: None
    elif not sys.stderr.isatty():
        yield _Lines(what, total or 0)
    else:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        texts = TextColumn("{task.description}"), TextColumn("{task.fields[rate]}"), TextColumn("ETA")
        bar = Progress(
            *(texts[0], BarColumn(), MofNCompleteColumn(), *texts[1:], TimeRemainingColumn()),
            console=Console(stderr=True),
            # lines on standard output pass above the bar only if both are the terminal; a file must get them
            redirect_stdout=sys.stdout.isatty(),
            transient=True,
        )
        task = bar.add_task(what, total=total, rate="")
        with bar:
            yield lambda done, **more: bar.update(task, completed=done, **more)


class _Lines:
    """Prints a line every ten seconds."""

    def __init__(self, what: str, total: int) -> None:
        self._what, self._total = what, total
        self._first: tuple[float, int] | None = None
        self._told = time.monotonic()

    def __call__(self, done: int, total: int | None = None, **_: object) -> None:
        now, self._total = time.monotonic(), total or self._total
        if self._first is None:
            self._first = now, done  # the first step includes the start of the workers: others are faster
        elif now - self._told >= EVERY and self._first[1] < done < self._total:
            left = (now - self._first[0]) / (done - self._first[1]) * (self._total - done)
            steps = f"{done:,} of {self._total:,} {self._what}"
            warn(f"{steps}, about {duration(left)} to go")
            self._told = now


def watched(steps: Iterable[T], total: int, what: str, quiet: bool = False) -> Iterator[T]:
    """Yields each step when it is done, and shows how many are done and the remaining time."""
    with progress(what, total, quiet) as tell:
        for done, step in enumerate(steps, 1):
            tell(done)
            yield step


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
