"""The top-level command group ``roadgpt``: imports commands when they are called, and reports errors as
one sentence.
"""

import errno
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module
from keyword import iskeyword
from typing import Any

import click

from roadgpt import __version__, stopping
from roadgpt.cli.command_table import COMMANDS, EARLIER, HEADINGS, renamed
from roadgpt.cli.crash import report_crash
from roadgpt.cli.option_groups import dash_advice
from roadgpt.cli.streams import OutputError, drop_output, is_coloured, warn
from roadgpt.errors import RoadGPTError, command_line
from roadgpt.provenance import USER

INTERRUPTED = 130  # exit status if the user broke off the input; after a signal, that of ``stopping.status``
NO_READER = 141  # exit status if the reader of the output has gone; as in shells: 128 + SIGPIPE
REFUSED = 1  # exit status if the output or a file cannot be written
OF_FILES = {
    errno.ENAMETOOLONG, errno.ELOOP, errno.EACCES, errno.EPERM, errno.ENOTDIR, errno.EISDIR, errno.ENOSPC,
    errno.EROFS, errno.EDQUOT if hasattr(errno, "EDQUOT") else errno.ENOSPC,
}  # fmt: skip
"""``errno`` values of file system errors that the user can fix, such as a full disk; other errors are
reported as crashes.
"""
INTERNAL = 70  # EX_SOFTWARE of sysexits.h


class Commands(click.Group):
    """A command group that imports its commands lazily and reports errors as sentences instead of
    tracebacks.
    """

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Returns the names of all commands, in the order of the help."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Imports the command ``name`` and returns the command; returns None if ``name`` is unknown."""
        if name not in COMMANDS:
            return None
        module = f"{name}_" if iskeyword(name) else name
        command: click.Command = import_module(f"roadgpt.cli.commands.{module}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes all commands with their one-line descriptions under headings, without importing a
        command.
        """
        wide = max(map(len, COMMANDS))
        for heading, commands in HEADINGS.items():
            with formatter.section(heading):
                formatter.write_dl([(f"{name:<{wide}}", line) for name, line in commands.items()])

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Returns the name of the command, the command and its arguments; earlier names of commands work too.

        Raises:
            click.UsageError: There is no such command; the message says what to type instead.
        """
        args, told = renamed(args)
        if told and not ctx.resilient_parsing:
            warn(told)
        name = args[0]
        if name in COMMANDS or (name.startswith("-") and " " not in name.strip()):
            return super().resolve_command(ctx, args)
        near = get_close_matches(name.lower(), [*COMMANDS, *(words[0] for words in EARLIER)], 1)
        advice = f"No such command '{name}'; there are: {', '.join(COMMANDS)}. Is it a description? Say:"
        if " " in name.strip():
            advice = "to make roads from a description, say:"
        elif near:
            raise click.UsageError(f"No such command '{name}'. Did you mean '{near[0]}'?", ctx)
        raise click.UsageError(f"{advice} {command_line('run', *args)}", ctx)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parses the arguments after ``roadgpt``.

        Raises:
            click.UsageError: An option is unknown or misplaced; the message says what to type.
        """
        try:
            with dash_advice(ctx, args):
                return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            raise click.UsageError(
                f"No such option '{error.option_name}' here. Options follow the command that they belong to, "
                f"for example: {command_line('run', 'an uphill road with 3 turns', '--seed', 7)}",
                ctx,
            ) from error

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        **extra: Any,
    ) -> Any:
        """Runs a command; in standalone mode, reports errors as sentences and ends the process with an
        exit status.
        """
        USER.ask = _confirm
        if not standalone_mode:
            return super().main(args, prog_name, complete_var, standalone_mode=False, **extra)
        try:
            status = super().main(args, prog_name, complete_var, standalone_mode=False, **extra)
            sys.stdout.flush()
        except OutputError as error:
            drop_output()
            status = NO_READER if error.is_reader_gone else REFUSED
            if not error.is_reader_gone:
                warn(error)
        except click.ClickException as error:
            _with_advice(error).show()
            status = error.exit_code
        except RoadGPTError as error:
            warn(error)
            status = stopping.status() or error.exit_status
        except OSError as error:
            status = stopping.status() or _refused(error)
        except (KeyboardInterrupt, click.Abort):
            status = stopping.status() or INTERRUPTED
        except Exception as error:  # last resort: users must not see a traceback
            status = stopping.status()
            if not status:  # an error in a program that is being stopped is not reported
                warn(report_crash(error))
                status = INTERNAL
        stopping.finish()
        sys.exit(status if isinstance(status, int) else 0)


def _refused(error: OSError) -> int:
    """Says that a file cannot be used, and returns the exit status; reports any other error as a crash."""
    if error.errno not in OF_FILES or not error.filename:
        warn(report_crash(error))
        return INTERNAL
    name = str(error.filename)
    shown = name if len(name) <= 200 else f"{name[:80]}...{name[-40:]}"
    warn(f"cannot use {shown}: {error.strerror}; name another file or folder")
    return REFUSED


def _confirm(question: str) -> bool:
    """Asks at the terminal; returns False without waiting if there is no terminal."""
    if not (sys.stdin and sys.stdin.isatty() and sys.stderr.isatty()):
        return False
    return click.confirm(f"roadgpt: {question}", default=False, err=True)


def _with_advice(error: click.ClickException) -> click.ClickException:
    """Extends the message about a missing argument by advice on what to type."""
    if not isinstance(error, click.MissingParameter):
        return error
    advice = getattr(error.param, "advice", "")
    return click.UsageError(f"{error.format_message()} {advice}".strip(), error.ctx)


@click.group(
    cls=Commands,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
    epilog='First time? Try: roadgpt run "an uphill road with 3 turns" -n 3',
)
@click.version_option(__version__, message="roadgpt %(version)s")
@click.pass_context
def app(ctx: click.Context) -> None:
    """Turn words into tested roads.

    RoadGPT designs 3-D roads that match a description, drives a simulated car along them, and says whether
    the car kept its lane. Without a command it asks for descriptions, one after another.
    """
    if not is_coloured():
        ctx.color = False
    if ctx.invoked_subcommand is None:
        from roadgpt.cli.interactive import converse

        converse()
