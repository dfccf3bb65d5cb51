"""Builds the commands that repeat a Run, and those that continue or change the present command."""

import os
from collections.abc import Sequence, Set
from pathlib import Path

import click
from click.core import ParameterSource

from roadgpt.brief.model import Brief
from roadgpt.cli import options
from roadgpt.cli.option import Option, named, words_of
from roadgpt.errors import command_line
from roadgpt.road import World
from roadgpt.road.oracles import oracle_limits
from roadgpt.run.model import Request, Run, Setup

# The options of ``roadgpt drive`` that set fields of the Setup; the road's file determines the geometry.
OF_DRIVES = named(options.SETUP, "driver", "simulator", "keep_driving", "rules")


def replay_lines(run: Run, folder: Path | None = None) -> list[str]:
    """Returns lines with the commands that repeat a Run: from its description, and from its road file."""
    lines = []
    request = run.request
    if run.words:
        lines.append(command_line("run", *request_words(request, run.index, run.brief)))
    if folder is not None and run.road is not None and request.setup.drives:
        words = option_words(request.setup, request.world, OF_DRIVES, asks=False)
        lines.append(command_line("drive", folder / "road.json", "--seed", run.seed, *words))
    return lines


def request_words(request: Request, roads: int, brief: Brief | None) -> list[str]:
    """Returns the arguments with which ``roadgpt run`` makes the first ``roads`` roads of a request. If the
    Brief, which was read from the words, names a surface, the arguments always give the friction.
    """
    told = {"friction"} if brief is not None and brief.friction is not None else set[str]()
    rest = ["-n", str(roads), "--seed", str(request.seed)]
    rest += option_words(request.setup, request.world, also=told)
    if not request.setup.drives:
        rest.append("--no-drive")
    # words that begin with a dash would pass for an option
    return [*rest, "--", request.words] if request.words.startswith("-") else [request.words, *rest]


def option_words(
    setup: Setup,
    world: World,
    of_setup: Sequence[Option] = options.SETUP,
    asks: bool = True,
    also: Set[str] = frozenset(),
) -> list[str]:
    """Returns the command-line arguments for three kinds of options: options that differ from their defaults,
    options that configuration files or the environment set, and options with keys in ``also``.

    ``of_setup`` are the command's options that set fields of the Setup. ``asks`` says whether the command
    has options for language models.

    Raises:
        UsageError: A configuration file cannot be used.
    """
    layers = options.layers()
    told = {each.key for each in options.SETTABLE if each.found(layers) is not None} | also
    words = words_of(of_setup, dict(setup), told=told)
    told |= {"oracle"} if told & {*oracle_limits()} else set()
    values = world.values() | dict.fromkeys(oracle_limits()) | {"oracle": world.limits.oracle}
    words += words_of(options.WORLD, values, World().values(), told)
    if asks and setup.chat:
        words += words_of(options.CHAT, dict(setup.chat), dict(type(setup.chat)()))
    return words


def to_resume(folder: Path) -> str:
    """Returns the command that continues the tests in a folder, with what the user typed in this command."""
    from roadgpt.campaign.folder_record import open_record

    root = click.get_current_context().find_root()
    resume = root.command.get_command(root, "resume") if isinstance(root.command, click.Group) else None
    with open_record(folder) as record:
        return record.to_resume(*typed_words(resume.params if resume else ()))


def typed_words(own: Sequence[click.Parameter]) -> list[str]:
    """Returns the arguments with which the user gave these options in this command, without permissions."""
    ctx, words = click.get_current_context(), list[str]()
    for each in own:
        is_typed = ctx.get_parameter_source(str(each.name)) is ParameterSource.COMMANDLINE
        if isinstance(each, Option) and is_typed and each.field not in ("driver", "base_url"):
            value = ctx.params.get(each.field, os.environ.get(each.variable))
            words += each.written(bool(value) if each.is_flag else value, is_set=True)
    return words
