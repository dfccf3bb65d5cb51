"""Help with options in named groups: ``--help`` lists common options, ``--help-all`` lists every option."""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import click

from roadgpt.cli.command_table import renamed_options
from roadgpt.cli.configuration import tell_settings

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]

FIRST, LAST = "Options", "Output and help"  # the first is for options that are in no other
ORDER = (
    FIRST, "Design and check", "World", "Drive and verdict", "Tests of a campaign", "Files",
    "Failures", "Workers", "Language model", "BeamNG", LAST,
)  # fmt: skip
WHOLE = 20  # a command with at most this many options lists all of them under --help
ALL = "roadgpt.help_all"  # key of click's Context.meta while --help-all is answered


class Listing(NamedTuple):
    """The heading under which the help lists an option, and whether the option is rare."""

    heading: str = FIRST
    is_rare: bool = False
    """Whether ``--help`` leaves the option out if the command has many options."""


_LISTINGS: "WeakKeyDictionary[click.Parameter, Listing]" = WeakKeyDictionary()


def under(heading: str, *decorators: Decorator, rare: bool = False) -> Decorator:
    """Returns one decorator that adds several options, which the help lists under a heading.

    Args:
        heading: One of ``ORDER``.
        decorators: Each adds one or more options to a function, as ``click.option`` does.
        rare: Whether only ``--help-all`` lists the options if a command has many options.
    """

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        before = len(getattr(function, "__click_params__", ()))
        for decorator in reversed(decorators):
            function = decorator(function)
        for parameter in getattr(function, "__click_params__", ())[before:]:
            _LISTINGS[parameter] = Listing(heading, rare)
        return function

    return decorate


def _help_all(ctx: click.Context, parameter: click.Parameter, is_asked: bool) -> None:
    """Prints the whole help and ends the command."""
    del parameter
    if is_asked and not ctx.resilient_parsing:
        ctx.meta[ALL] = True
        click.echo(ctx.get_help(), color=ctx.color)
        ctx.exit()


class GroupedCommand(click.Command):
    """A command whose help lists its options in groups, and that prints which settings come from files."""

    def __init__(self, *args: Any, **rest: Any) -> None:
        super().__init__(*args, **rest)
        flag = click.Option(
            ["--help-all"], is_flag=True, is_eager=True, expose_value=False, callback=_help_all,
            help="Show every option and exit.",
        )  # fmt: skip
        _LISTINGS[flag] = Listing(LAST)
        self.params.append(flag)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parses the arguments; an earlier name of an option is accepted, and the present name is printed."""
        known = [name for parameter in self.params for name in parameter.opts]
        words, told = renamed_options(args, known)
        for sentence in () if ctx.resilient_parsing else told:
            click.echo(f"roadgpt: {sentence}", err=True)
        return super().parse_args(ctx, words)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes the options under their headings."""
        shown = [*self._shown(ctx)]
        for heading in ORDER:
            records = [record for its, record in shown if its == heading]
            if records:
                with formatter.section(heading):
                    formatter.write_dl(records)

    def invoke(self, ctx: click.Context) -> Any:
        """Prints on standard error which options are set by configuration files, then runs the command."""
        tell_settings(ctx)
        return super().invoke(ctx)

    def _options(self, ctx: click.Context) -> list[click.Option]:
        return [each for each in self.get_params(ctx) if isinstance(each, click.Option) and not each.hidden]

    def _is_whole(self, ctx: click.Context) -> bool:
        """Returns whether this help lists every option."""
        options = self._options(ctx)
        is_short = len(options) <= WHOLE
        return bool(ctx.meta.get(ALL)) or is_short or not any(_listing(each).is_rare for each in options)

    def _shown(self, ctx: click.Context) -> Iterator[tuple[str, tuple[str, str]]]:
        is_whole = self._is_whole(ctx)
        for option in self._options(ctx):
            listing = _listing(option)
            if listing.is_rare and not is_whole:
                continue
            if option.opts == ["--help-all"] and is_whole and not ctx.meta.get(ALL):
                continue
            record = option.get_help_record(ctx)
            if record is None:
                continue
            names = record[0] if ctx.meta.get(ALL) else record[0].partition(" / ")[0]
            yield listing.heading, (names, record[1])


def _listing(option: click.Option) -> Listing:
    if "--help" in option.opts:
        return Listing(LAST)
    return _LISTINGS.get(option, Listing())


class CommandGroup(click.Group):
    """A command with sub-commands whose help lists their options in groups."""

    command_class = GroupedCommand

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes the sub-commands with the whole first sentence of their help."""
        with formatter.section("Commands"):
            formatter.write_dl(
                [(name, command.get_short_help_str(limit=200)) for name, command in self.commands.items()]
            )
