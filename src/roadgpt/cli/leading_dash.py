"""Advice for descriptions that begin with a dash, such as "-5 % slope", which look like an option."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import click


@contextmanager
def dash_advice(ctx: click.Context, args: Sequence[str]) -> Iterator[None]:
    """Turns click's error into advice if one of the words is a description with a leading dash."""
    given = list(args)  # click takes them out of its list
    try:
        yield
    except click.UsageError as error:
        words = _description(given)
        if words is None:
            raise
        raise click.UsageError(
            f'put a description that begins with a dash last, after two dashes: roadgpt run -- "{words}"', ctx
        ) from error


def _description(args: Sequence[str]) -> str | None:
    """Returns the first word that looks like a description rather than an option or its value; else None."""
    before = ""
    for word in args:
        if word == "--":
            break
        if re.match(r"-+\s*[\w.,]+.*\s", word) and not word.startswith("--"):
            return word
        if re.match(r"-\d", word) and not before.startswith("-"):
            return f"{word} ..."
        before = word
    return None
