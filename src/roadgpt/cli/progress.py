"""Shows progress with the remaining time: as a bar on a terminal, otherwise as occasional lines."""

import sys
import time
from collections.abc import Iterable, Iterator
from typing import TypeVar

import click

from roadgpt.cli.campaigns import duration
from roadgpt.cli.screen import new_bar

T = TypeVar("T")
EVERY = 10.0  # s between two lines where there is no terminal


def watched(steps: Iterable[T], total: int, what: str, quiet: bool = False) -> Iterator[T]:
    """Yields the steps, and shows on standard error how many are done and how long the rest will take.

    Args:
        steps: The steps; each is done when it is yielded.
        total: Number of steps.
        what: Name of the steps in the plural, such as 'faults'.
        quiet: Whether to show nothing.
    """
    if quiet:
        yield from steps
    elif sys.stderr.isatty():
        yield from _with_bar(steps, total, what)
    else:
        yield from _with_lines(steps, total, what)


def _with_bar(steps: Iterable[T], total: int, what: str) -> Iterator[T]:
    bar = new_bar()
    task = bar.add_task(what, total=total, rate="")
    with bar:
        for step in steps:
            bar.advance(task)
            yield step


def _with_lines(steps: Iterable[T], total: int, what: str) -> Iterator[T]:
    first = told = time.monotonic()
    for done, step in enumerate(steps, 1):
        now = time.monotonic()
        if done == 1:
            first = now  # the first waits for all to start, and tells nothing of the others
        elif now - told >= EVERY and done < total:
            left = (now - first) / (done - 1) * (total - done)
            click.echo(f"roadgpt: {done:,} of {total:,} {what}, about {duration(left)} to go", err=True)
            told = now
        yield step
