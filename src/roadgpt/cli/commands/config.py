"""``roadgpt config``: lists all settings with their origin, and all plug-ins."""

import inspect
import json
import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple

import click

from roadgpt import plugins
from roadgpt.cli import options
from roadgpt.cli.configuration import TABLES
from roadgpt.cli.option import Option
from roadgpt.cli.option_groups import CommandGroup, GroupedCommand
from roadgpt.cli.streams import warn
from roadgpt.errors import PartError


@dataclass(frozen=True)
class InstalledPlugin:
    """An installed plug-in: its kind (such as reader or driver), the package that provides it, and what it
    does.
    """

    shelf: str
    name: str
    origin: str
    about: str
    works: bool


def installed() -> list[InstalledPlugin]:
    """Returns every installed plug-in; if a plug-in cannot be loaded, its description gives the reason."""
    return [_part(shelf, name) for shelf in plugins.KINDS for name in plugins.names(shelf)]


def _part(shelf: str, name: str) -> InstalledPlugin:
    try:
        about, works = _first_sentence(plugins.find(shelf, name)), True
    except PartError as error:
        about, works = str(error), False
    return InstalledPlugin(shelf, name, plugins.origin(shelf, name), about, works)


def _first_sentence(part: Any) -> str:
    """Returns the first sentence of a plug-in's docstring, or of its module's."""
    text = inspect.getdoc(part) or inspect.getdoc(inspect.getmodule(part)) or "It has no description."
    paragraph = " ".join(text.strip().split("\n\n")[0].replace("``", "").split())
    return re.split(r"(?<=[.;:]) ", paragraph)[0].rstrip(".;:")


@click.command("plugins", cls=GroupedCommand, params=[options.json_option("Print one JSON list.")])
def plugins_command(as_json: bool) -> None:
    """List the plug-ins: readers, designers, rules, exporters, simulators, drivers and others.

    Each line shows the name to use in options, the package that provides the plug-in, and what it does.
    """
    parts = installed()
    if as_json:
        click.echo(json.dumps([asdict(part) for part in parts], indent=2))
        return
    wide = max(len(part.name) for part in parts)
    for shelf in plugins.KINDS:
        click.secho(shelf, bold=True)
        for part in parts:
            if part.shelf == shelf:
                line = f"  {part.name:<{wide}}  {part.origin:<16}  {part.about}"
                click.secho(line, fg=None if part.works else "red")


DEFAULT = "default"


@click.group(cls=CommandGroup)
def command() -> None:
    """Show all settings and where each comes from; list plug-ins."""


class ShownSetting(NamedTuple):
    """One line of ``roadgpt config show``."""

    table: str
    name: str
    value: Any
    origin: str


OPTIONS = (
    Option("--origin with_origin", "With --json: also print where each setting comes from.", bool),
    options.json_option(),
    *options.CHAT,
)


@command.command(params=[*OPTIONS])
def show(with_origin: bool, as_json: bool, **values: Any) -> None:
    """Show all settings that options, environment variables or files can set, and where each comes from.

    An option on the command line takes precedence; then an environment variable, such as ROADGPT_FRICTION;
    then the file .env in this folder; then roadgpt.toml in this folder; then roadgpt/config.toml in the
    configuration folder of your user account. The tables of the TOML files are [run], [world], [chat] and
    [beamng]. API keys are masked.

    A folder may come from somebody else. For safety, .env and roadgpt.toml cannot name a driver's file, a
    program, a server that gets your API key, or a plug-in that asks a language model.
    """
    from roadgpt.chat.config import unknown_variables

    shown = [*_of_options(), *_of_chat(values)]
    if as_json:
        told = {
            each.name: {"value": each.value, "origin": each.origin} if with_origin else each.value
            for each in shown
        }
        click.echo(json.dumps(told, indent=2))
        return
    wide = max(len(each.name) for each in shown)
    far = max(len(_text(each.value)) for each in shown)
    for table in (*TABLES, "chat"):
        click.secho(f"[{table}]", bold=True)
        for each in shown:
            if each.table == table:
                click.echo(f"{each.name:<{wide}}  {_text(each.value):<{far}}  {each.origin}")
    for name in unknown_variables({option.variable for option in options.SETTABLE}):
        warn(f"{name} is not a setting; the settings are listed above")


def _text(value: Any) -> str:
    return "-" if value is None else str(value).lower() if isinstance(value, bool) else str(value)


def _of_options() -> Iterator[ShownSetting]:
    """Yields the settings of options other than those of language models.

    Raises:
        UsageError: A setting cannot be used, or must not be set by the source that sets it.
    """
    context = click.Context(click.Command(None), resilient_parsing=True)
    layers = options.layers()
    for option in options.SETTABLE:
        setting = option.found(layers)
        value = option.converted(context, setting) if setting else option.get_default(context)
        origin = setting.origin if setting else DEFAULT
        yield ShownSetting(option.table, option.setting_name, _plain(value), origin)


def _plain(value: Any) -> Any:
    """Converts a value to text, unless it is a number, a truth value or None."""
    if isinstance(value, tuple):
        return ",".join(",".join(each) if isinstance(each, tuple) else str(each) for each in value)
    if isinstance(value, bool | int | float):
        return value
    return str(value) if isinstance(value, str | Path) else None


def _of_chat(values: dict[str, Any]) -> Iterator[ShownSetting]:
    """Yields the settings of language models, and the masked key of their server."""
    from roadgpt.chat.config import key_for, settings_from, settings_with_origin

    found = settings_with_origin(options.chat_values(values))
    settings = settings_from(found)
    for name, setting in found.items():
        yield ShownSetting("chat", name, getattr(settings, name), setting.origin)
    key = key_for(settings.base_url)
    yield ShownSetting("chat", "api_key", str(key) if key else None, key.origin if key else "nowhere")


command.add_command(plugins_command)
