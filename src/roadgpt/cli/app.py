"""The top-level command group ``roadgpt``: imports commands when they are called, and reports errors as
one sentence."""

import errno
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from importlib import import_module
from typing import Any

import click

from roadgpt import __version__, plugins, stopping
from roadgpt.cli.options import dash_advice
from roadgpt.cli.streams import OutputError, drop_output, is_coloured, report_crash, warn
from roadgpt.errors import PartError, RoadGPTError, command_line
from roadgpt.provenance import USER

# The help line of each command is here, so that `roadgpt --help` need not import the commands. Those under
# one heading are in one module, roadgpt.cli.commands.make and so on.
HEADINGS = {
    "Make": {
        "run": "Make roads from a description: design, check, drive and judge them.",
        "read": "Show how RoadGPT interprets a description, and how confident it is.",
        "drive": "Drive roads from files, or repeat tests of a campaign.",
    },
    "Look": {
        "show": "Summarise a run, a folder of runs or a campaign.",
        "view": "View a road in 3-D with a replay of its drive, or draw pictures.",
        "compare": "Measure how similar two roads are, and draw both.",
        "scenarios": "List the scenarios of regulations and typologies, or show some whole.",
    },
    "Search": {
        "campaign": "Search for failures, or make thousands of roads, with parallel workers.",
        "resume": "Continue a campaign or a run that was interrupted.",
    },
    "Evaluate": {
        "check": "Check roads against the rules.",
        "report": "Write a report on a folder of runs, a campaign or a study.",
    },
    "Exchange": {
        "export": "Write roads for other tools: OpenDRIVE, OpenSCENARIO and others.",
        "ground": "Make land from words, or read heights from a file, for roads to lie in.",
    },
    "Set up": {
        "config": "Show all settings and where each comes from; list plug-ins.",
        "doctor": "Check this installation, or an installed BeamNG.tech.",
    },
}

OURS = [name for commands in HEADINGS.values() for name in commands]
OTHERS = "Of other packages"
INTERRUPTED = 130  # exit status if the user broke off the input; after a signal, that of ``stopping.status``
NO_READER = 141  # exit status if the reader of the output has gone; as in shells: 128 + SIGPIPE
REFUSED = 1  # exit status if the output or a file cannot be written
OF_FILES = {
    errno.ENAMETOOLONG, errno.ELOOP, errno.EACCES, errno.EPERM, errno.ENOTDIR, errno.EISDIR, errno.ENOSPC,
    errno.EROFS, errno.EDQUOT if hasattr(errno, "EDQUOT") else errno.ENOSPC,
}  # fmt: skip
"""``errno`` values of file system errors that the user can fix, such as a full disk; other errors are
reported as crashes."""
INTERNAL = 70  # EX_SOFTWARE of sysexits.h


def commands() -> list[str]:
    """Returns the names of all commands; those of other packages are last."""
    return [*OURS, *(name for name in plugins.names("commands") if name not in OURS)]


def headings() -> dict[str, dict[str, str]]:
    """Returns the names and help lines of all commands under their headings, with those of other packages.

    The ``short_help`` of their click command is the help line, and its ``heading``, if it has one, the
    heading. Such a module should import nothing but click and ``roadgpt.cli`` at first."""
    every = {heading: {**commands} for heading, commands in HEADINGS.items()}
    for name in commands()[len(OURS) :]:
        heading = ""
        try:
            command = plugins.find("commands", name)
            heading = getattr(command, "heading", "")
            line = command.short_help or command.get_short_help_str(100)
        except PartError as error:
            line = str(error)
        every.setdefault(heading or OTHERS, {})[name] = line
    return every


class Commands(click.Group):
    """Imports a command when it is called, and reports errors as sentences instead of tracebacks."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Returns the names of all commands, in the order of the help."""
        return commands()

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        """Imports the command ``name``; returns None if there is none of that name."""
        heading = next((heading for heading, under in HEADINGS.items() if name in under), "")
        found: click.Command | None = None
        if heading:
            module = import_module(f"roadgpt.cli.commands.{heading.lower().replace(' ', '_')}")
            found = getattr(module, name)
        elif name in commands():
            found = plugins.find("commands", name)
        return found

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes all commands and their help lines under headings, without importing ours."""
        every = headings()
        wide = max(len(name) for under in every.values() for name in under)
        for heading, under in every.items():
            with formatter.section(heading):
                formatter.write_dl([(f"{name:<{wide}}", line) for name, line in under.items()])

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Returns the name of the command, the command and its arguments."""
        name, known, say = args[0], commands(), command_line("run", *args)
        if name in known or (name.startswith("-") and " " not in name.strip()):
            return super().resolve_command(ctx, args)
        if " " in name.strip():
            raise click.UsageError(f"to make roads from a description, say: {say}", ctx)
        if near := get_close_matches(name.lower(), known, 1):
            raise click.UsageError(f"No such command '{name}'. Did you mean '{near[0]}'?", ctx)
        there = f"No such command '{name}'; there are: {', '.join(known)}"
        raise click.UsageError(f"{there}. Is it a description? Say: {say}", ctx)

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parses the arguments after ``roadgpt``."""
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
        self, args: Sequence[str] | None = None, prog_name: str | None = None,
        complete_var: str | None = None, standalone_mode: bool = True, **extra: Any,
    ) -> Any:  # fmt: skip
        """Runs a command; in standalone mode, reports errors as sentences and ends the process with an
        exit status."""
        USER.ask = _confirm
        if not standalone_mode:
            return super().main(args, prog_name, complete_var, False, **extra)
        try:
            status = super().main(args, prog_name, complete_var, False, **extra)
            sys.stdout.flush()
        except OutputError as error:
            drop_output()
            status = NO_READER if error.is_reader_gone else REFUSED
            if not error.is_reader_gone:
                warn(error)
        except click.ClickException as error:
            if isinstance(error, click.MissingParameter):
                advice = getattr(error.param, "advice", "")
                error = click.UsageError(f"{error.format_message()} {advice}".strip(), error.ctx)
            error.show()
            status = error.exit_code
        except RoadGPTError as error:
            warn(error)
            status = stopping.status() or error.exit_status
        except (KeyboardInterrupt, click.Abort):
            status = stopping.status() or INTERRUPTED
        except Exception as error:  # last resort: users must not see a traceback
            status = stopping.status()  # an error in a program that is being stopped is not reported
            if not status and isinstance(error, OSError) and error.errno in OF_FILES and error.filename:
                name = str(error.filename)
                shown = name if len(name) <= 200 else f"{name[:80]}...{name[-40:]}"
                warn(f"cannot use {shown}: {error.strerror}; name another file or folder")
                status = REFUSED
            elif not status:
                warn(report_crash(error))
                status = INTERNAL
        stopping.finish()
        sys.exit(status if isinstance(status, int) else 0)


def _confirm(question: str) -> bool:
    """Asks at the terminal; returns False without waiting if there is no terminal."""
    if not (sys.stdin and sys.stdin.isatty() and sys.stderr.isatty()):
        return False
    return click.confirm(f"roadgpt: {question}", default=False, err=True)


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
    the car kept its lane. Without a command it asks for descriptions, one after another."""
    if not is_coloured():
        ctx.color = False
    if ctx.invoked_subcommand is None:
        from roadgpt.cli.interactive import converse

        converse()
