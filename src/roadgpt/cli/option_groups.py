"""Makes help texts that list options in groups: ``--help`` lists common options, ``--help-all`` lists all."""

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from itertools import takewhile
from typing import Any

import click

from roadgpt.cli import options
from roadgpt.cli.option import FROM_FILES, LAYERS, Heading, Option
from roadgpt.cli.streams import warn
from roadgpt.errors import command_line


@contextmanager
def dash_advice(ctx: click.Context, args: Sequence[str]) -> Iterator[None]:
    """Says where to put it, if an argument that click refuses looks like a description after a dash."""
    given = list(args)  # click takes them out of its list
    try:
        yield
    except click.UsageError as error:
        for at, word in enumerate(given[: given.index("--")] if "--" in given else given):
            is_number = re.match(r"-\d", word) and not (at and given[at - 1].startswith("-"))
            if is_number or re.match(r"-\s*[\w.,]+.*\s", word):
                words = [word, *takewhile(lambda each: not re.match("--?[a-z]", each), given[at + 1 :])]
                rest = [ctx.info_name if ctx.parent else "run", *given[:at], *given[at + len(words) :]]
                again = command_line(*rest, "--", " ".join(words))
                sentence = f"put words that begin with a dash last, after two dashes: {again}"
                raise click.UsageError(sentence, ctx) from error
        raise


WHOLE = 20  # a command with at most this many options lists all of them under --help
ALL = "roadgpt.help_all"  # key of click's Context.meta while --help-all is answered


def _help_all(ctx: click.Context, parameter: click.Parameter, is_asked: bool) -> None:
    del parameter
    if is_asked and not ctx.resilient_parsing:
        ctx.meta[ALL] = True
        click.echo(ctx.get_help(), color=ctx.color)
        ctx.exit()


HELP_ALL = Option(
    "--help-all", "Show every option and exit.", bool, heading=Heading.OUTPUT, is_eager=True,
    expose_value=False, callback=_help_all,
)  # fmt: skip


class GroupedCommand(click.Command):
    """A command whose help lists options in groups. It also prints which settings come from files.

    ``heading`` is the heading of ``roadgpt --help`` under which a command of another package stands;
    ``has_simulators`` adds the options of simulators. ``makes`` returns further parameters; it is called when
    they are first used, since options of models load the models."""

    def __init__(
        self, *args: Any, heading: str = "", has_simulators: bool = False,
        makes: Callable[[], Sequence[click.Parameter]] = tuple, **rest: Any,
    ) -> None:  # fmt: skip
        super().__init__(*args, **rest)
        self.heading, self.has_simulators, self._makes = heading, has_simulators, makes
        self.params.append(HELP_ALL)

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """Returns the parameters; those of simulators come last."""
        self.params[-1:-1], self._makes = self._makes(), tuple
        found = super().get_params(ctx)
        return [*found, *options.simulator_options()] if self.has_simulators else found

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parses the arguments; says what to do with a description that begins with a dash."""
        ctx.meta.setdefault(LAYERS, cache(options.layers))
        if not any(parameter.name == "words" for parameter in self.get_params(ctx)):
            return super().parse_args(ctx, args)
        with dash_advice(ctx, args):
            return super().parse_args(ctx, args)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes the options that this help lists under their headings."""
        listed = [each for each in self.get_params(ctx) if isinstance(each, click.Option) and not each.hidden]
        rare = {each for each in listed if isinstance(each, Option) and each.is_rare}
        is_all = bool(ctx.meta.get(ALL))
        left_out = {HELP_ALL} if not rare or len(listed) <= WHOLE else rare
        shown: dict[Heading, list[tuple[str, str]]] = {heading: [] for heading in Heading}
        for option in listed:
            record = option.get_help_record(ctx)
            if record is not None and (is_all or option not in left_out):
                names = record[0] if is_all else record[0].partition(" / ")[0]
                # only click's own option --help is no Option
                heading = option.heading if isinstance(option, Option) else Heading.OUTPUT
                shown[heading].append((names, record[1]))
        for heading, records in shown.items():
            if records:
                with formatter.section(heading):
                    formatter.write_dl(records)

    def invoke(self, ctx: click.Context) -> Any:
        """Prints on standard error which options come from files or the environment, and runs the command."""
        told: dict[str, list[str]] = {}
        for option, setting in ctx.meta.get(FROM_FILES, {}).values():
            shown = ",".join(setting.value) if isinstance(setting.value, tuple) else setting.value
            told.setdefault(setting.origin.partition(" ")[0], []).append(f"{option.setting_name} = {shown}")
        if told and not ctx.params.get("quiet"):
            parts = "; ".join(f"{place} sets {', '.join(values)}" for place, values in told.items())
            warn(parts)
        return super().invoke(ctx)


class CommandGroup(click.Group):
    """A command with sub-commands; the help of each sub-command lists its options in groups."""

    command_class = GroupedCommand

    def __init__(self, *args: Any, heading: str = "", **rest: Any) -> None:
        super().__init__(*args, **rest)
        self.heading = heading

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes the sub-commands with the whole first sentence of their help."""
        with formatter.section("Commands"):
            formatter.write_dl(
                [(name, command.get_short_help_str(limit=200)) for name, command in self.commands.items()]
            )
