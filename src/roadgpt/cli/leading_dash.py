"""A description that begins with a dash ("-5 % slope") passes for an option; here it is told what to do."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import click

from roadgpt.cli.option_groups import GroupedCommand


@contextmanager
def dash_advice(ctx: click.Context, args: Sequence[str]) -> Iterator[None]:
    """While click reads these words: where it cannot, and one is a description, say how to give it."""
    given = list(args)  # click takes them out of its list
    try:
        yield
    except click.UsageError as error:
        words = _description(given)
        if words is None:
            raise
        raise click.UsageError(
            f'a description that begins with a dash goes last, behind two: roadgpt run -- "{words}"', ctx
        ) from error


def _description(args: Sequence[str]) -> str | None:
    """The first of the words that looks like a description and not like an option or the value of one."""
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


class DescribedCommand(GroupedCommand):
    """A command that takes a description."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """What click makes of the words."""
        with dash_advice(ctx, args):
            return super().parse_args(ctx, args)
