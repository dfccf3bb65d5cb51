"""Builds the commands that repeat a Run, and that continue the present command."""

import os
from collections.abc import Sequence, Set
from pathlib import Path

import click
from click.core import ParameterSource

from roadgpt.brief.model import Brief
from roadgpt.campaign.folder_record import open_record
from roadgpt.cli import options
from roadgpt.cli.options import Option, named, words_of
from roadgpt.errors import command_line
from roadgpt.road import World
from roadgpt.road.world import oracle_limits
from roadgpt.run.model import Request, Run, Setup

# The options of ``roadgpt drive`` that set fields of the Setup; the road's file determines the geometry.
OF_DRIVES = named(options.SETUP, "driver", "simulator", "keep_driving", "tracks", "scenario", "rules")


def replay_lines(run: Run, folder: Path | None = None) -> list[str]:
    """Returns lines with the commands that repeat a Run: from its description, and from its road file."""
    lines, request = list[str](), run.request
    if run.words:
        lines.append(command_line("run", *request_words(request, run.index, run.brief)))
    if folder is not None and run.road is not None and request.setup.drives:
        words = option_words(request.setup, request.world, OF_DRIVES, asks=False)
        lines.append(command_line("drive", folder / "road.json", "--seed", run.seed, *words))
    return lines


def request_words(request: Request, roads: int, brief: Brief | None) -> list[str]:
    """Returns the arguments with which ``roadgpt run`` makes the first ``roads`` roads of a request."""
    # where the words name a surface, the friction is always told
    told = {"friction"} if brief is not None and brief.friction is not None else set[str]()
    rest = ["-n", str(roads), "--seed", str(request.seed)]
    rest += option_words(request.setup, request.world, also=told)
    if not request.setup.drives:
        rest.append("--no-drive")
    # words that begin with a dash would pass for an option
    return [*rest, "--", request.words] if request.words.startswith("-") else [request.words, *rest]


def option_words(
    setup: Setup, world: World, of_setup: Sequence[Option] | None = None, asks: bool = True,
    also: Set[str] = frozenset(),
) -> list[str]:  # fmt: skip
    """Returns the arguments for options that differ from their defaults, that configuration files or the
    environment set, or whose keys are in ``also``. ``of_setup`` are those of the command that set fields of
    the Setup, of all if it is None; ``asks`` says whether it has options for language models."""
    layers = options.layers()
    told = {each.key for each in options.settable() if each.found(layers) is not None} | also
    words = words_of(of_setup or options.SETUP, dict(setup), told=told)
    told |= {"oracle"} if told & {*oracle_limits()} else set()
    values = world.values() | dict.fromkeys(oracle_limits()) | {"oracle": world.limits.oracle}
    words += words_of(options.WORLD, values, World().values(), told)
    if asks and setup.chat:
        words += words_of(options.CHAT, dict(setup.chat), dict(type(setup.chat)()))
    return words


def to_resume(folder: Path) -> str:
    """Returns the command that continues the tests in a folder, with what the user typed in this command."""
    root = click.get_current_context().find_root()
    resume = root.command.get_command(root, "resume") if isinstance(root.command, click.Group) else None
    with open_record(folder) as record:
        return record.to_resume(*typed_words(resume) if resume else ())


def typed_words(command: click.Command) -> list[str]:
    """Returns the arguments with which the user gave options of ``command`` in the present command, without
    permissions."""
    ctx, words = click.get_current_context(), list[str]()
    for each in command.get_params(ctx):
        is_typed = ctx.get_parameter_source(str(each.name)) is ParameterSource.COMMANDLINE
        if isinstance(each, Option) and is_typed and each.field not in ("driver", "base_url"):
            value = ctx.params.get(each.field, os.environ.get(each.variable))
            words += each.written(bool(value) if each.is_flag else value, is_set=True)
    return words
