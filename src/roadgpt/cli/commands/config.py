"""``roadgpt config``: lists all settings with their origin, and all plug-ins."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import click

from roadgpt.cli import options
from roadgpt.cli.configuration import TABLES, read_layers
from roadgpt.cli.installed_plugins import plugins_command
from roadgpt.cli.option import Option
from roadgpt.cli.option_groups import CommandGroup
from roadgpt.cli.streams import warn

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
    layers = read_layers(options.settable_keys())
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

    found = settings_with_origin({flag.field: flag.read(values[flag.field]) for flag in options.CHAT})
    settings = settings_from(found)
    for name, setting in found.items():
        yield ShownSetting("chat", name, getattr(settings, name), setting.origin)
    key = key_for(settings.base_url)
    yield ShownSetting("chat", "api_key", str(key) if key else None, key.origin if key else "nowhere")


command.add_command(plugins_command)
