"""Options that can also be set in a configuration file or the environment; ``roadgpt config show`` lists
them.

Sources and precedence are those of ``roadgpt.chat.config``: the command line first, then the environment
(``ROADGPT_FRICTION``), then ``.env`` and ``roadgpt.toml`` in the working folder, then the user's
``config.toml``. The tables are ``[run]``, ``[world]`` and ``[beamng]``; ``[chat]`` is for language models.

A working folder may come from somebody else. Therefore its files cannot name a driver's file, a program, a
server or a plug-in that asks a language model: such a value is refused, and the user has to give it as an
option.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.chat.config import Layer, Setting

TABLES = ("run", "world", "beamng")
CHAT_TABLE = "chat"
EARLIER_KEYS = {"verge": "shoulder"}
"""Keys of campaign plans whose name in configuration files differs, with that name."""
LAYERS, FROM_FILES = "roadgpt.layers", "roadgpt.from_files"  # keys of click's Context.meta

OF_FOLDER, OF_USER, OF_ENVIRONMENT = "folder", "user", "environment"
YOURSELF = "a file of this folder cannot decide that; say it yourself with the option"
WHOLE_PATH = "give the whole path, from the root of the disk"
Guard = Callable[[str, str], str]
"""A function of a value and its kind of source, such as ``OF_FOLDER``, that returns why the value is
refused; empty if it is accepted.
"""


class SettableOption(click.Option):
    """An option that can also be set in a configuration file or the environment.

    Args:
        table: The option's table in configuration files.
        key: The option's key in that table; the environment variable is ``ROADGPT_`` and the key in capitals.
        guard: Refuses values that a configuration file must not set.
    """

    def __init__(self, *args: Any, table: str, key: str, guard: Guard | None = None, **rest: Any) -> None:
        super().__init__(*args, **rest)
        self.table, self.key, self.guard = table, key, guard

    @property
    def variable(self) -> str:
        """The name of the option's environment variable."""
        middle = "BEAMNG_" if self.table == "beamng" else ""
        return f"ROADGPT_{middle}{self.key.upper()}"

    @property
    def setting_name(self) -> str:
        """The option's name in a list of the settings of all tables."""
        return f"beamng_{self.key}" if self.table == "beamng" else self.key

    def consume_value(self, ctx: click.Context, opts: Any) -> tuple[Any, ParameterSource]:
        """Returns the unconverted value and its source; a value on the command line takes precedence."""
        value, source = super().consume_value(ctx, opts)
        if source is not ParameterSource.DEFAULT:
            return value, source
        setting = self.found(layers_of(ctx))
        if setting is None:
            return value, source
        ctx.meta.setdefault(FROM_FILES, {})[self.name] = (self, setting)
        return setting.value, ParameterSource.DEFAULT_MAP

    def process_value(self, ctx: click.Context, value: Any) -> Any:
        """Returns the converted value.

        Raises:
            UsageError: A value from a file or the environment cannot be used; the message says where it is.
        """
        own, setting = ctx.meta.get(FROM_FILES, {}).get(self.name, (None, None))
        if own is not self:
            return super().process_value(ctx, value)
        with self._as_setting(setting):
            return super().process_value(ctx, value)

    def converted(self, ctx: click.Context, setting: "Setting") -> Any:
        """Returns the value of a setting, converted to the option's type.

        Raises:
            UsageError: The value cannot be used.
        """
        with self._as_setting(setting):
            return self.type_cast_value(ctx, setting.value)

    @contextmanager
    def _as_setting(self, setting: "Setting") -> Iterator[None]:
        try:
            yield
        except click.BadParameter as error:
            said = error.message.rstrip(".")
            raise UsageError(
                f"the setting '{self.key}' from {setting.origin} cannot be used: {said}"
            ) from None

    def found(self, layers: "Sequence[Layer]") -> "Setting | None":
        """Returns the value from the environment or a file with the highest precedence; None if there is
        none.

        Raises:
            UsageError: The value must not come from that source.
        """
        from roadgpt.chat.config import Setting

        for layer in layers:
            table = layer.tables.get(self.table, {})
            names = (self.key, *(old for old, new in EARLIER_KEYS.items() if new == self.key))
            said = next((table[name] for name in names if name in table), None)
            where = f"{layer.name} [{self.table}]"
            if self.variable in layer.found:
                said, where = layer.found[self.variable], f"{layer.name} ({self.variable})"
            if said is None:
                continue
            value = self._text(said, where)
            self._refuse(value, layer, where)
            return Setting(value, where)
        return None

    def _refuse(self, value: Any, layer: "Layer", where: str) -> None:
        from roadgpt.chat.config import FOLDER

        place = OF_FOLDER if layer.name in FOLDER else OF_USER if layer.tables else OF_ENVIRONMENT
        for one in value if isinstance(value, tuple) else (value,):
            refusal = self.guard(str(one), place) if self.guard else ""
            if refusal:
                raise UsageError(f"{where} says {self.key} = {one}: {refusal}")

    def _text(self, value: Any, where: str) -> Any:
        """Returns a value of TOML as the command line would have it."""
        if self.is_flag:
            if isinstance(value, bool | str):
                return value
            raise UsageError(f"the setting '{self.key}' from {where} cannot be used: give true or false")
        listed = value if isinstance(value, list) else [value]
        if any(isinstance(each, bool) or not isinstance(each, str | int | float) for each in listed):
            raise UsageError(f"the setting '{self.key}' from {where} cannot be used: give a text or a number")
        if len(listed) > 1 and not self.multiple and self.key != "format":
            raise UsageError(f"the setting '{self.key}' from {where} cannot be used: give one value")
        texts = tuple(str(each) for each in listed)
        return texts if self.multiple else ",".join(texts)


def layers_of(ctx: click.Context | None = None) -> "Sequence[Layer]":
    """Returns all sources of settings, highest precedence first; they are read once per command.

    Raises:
        UsageError: A file cannot be read, or has an unknown table or key.
    """
    from roadgpt.chat.config import layers

    if ctx is None:
        return _known(layers())
    if LAYERS not in ctx.meta:
        ctx.meta[LAYERS] = _known(layers())
    found: Sequence[Layer] = ctx.meta[LAYERS]
    return found


def settable_options() -> list[SettableOption]:
    """Returns every option that a configuration file can set, in the order of ``roadgpt run``."""
    from roadgpt.cli.commands import run

    return [each for each in run.command.params if isinstance(each, SettableOption)]


def keys_set() -> set[str]:
    """Returns the keys of all options that the environment or a file sets.

    Raises:
        UsageError: A configuration file cannot be used.
    """
    layers = layers_of()
    return {each.key for each in settable_options() if each.found(layers) is not None}


def tell_settings(ctx: click.Context) -> None:
    """Prints a line on standard error that lists the options set by configuration files or the
    environment.
    """
    found: dict[str, tuple[SettableOption, Setting]] = ctx.meta.get(FROM_FILES, {})
    if not found or ctx.params.get("quiet"):
        return
    told: dict[str, list[str]] = {}
    for option, setting in found.values():
        shown = ",".join(setting.value) if isinstance(setting.value, tuple) else setting.value
        told.setdefault(setting.origin.partition(" ")[0], []).append(f"{option.setting_name} = {shown}")
    parts = "; ".join(f"{place} sets {', '.join(values)}" for place, values in told.items())
    click.echo(f"roadgpt: {parts}", err=True)


def _known(layers: "Sequence[Layer]") -> "Sequence[Layer]":
    """Returns the layers again, if all their tables and keys are known."""
    if not any(layer.tables for layer in layers):
        return layers
    keys: dict[str, list[str]] = {table: [] for table in TABLES}
    for option in settable_options():
        keys[option.table].append(option.key)
    for layer in layers:
        for name, table in layer.tables.items():
            if name == CHAT_TABLE:
                continue  # roadgpt.chat.config checks it
            if name not in keys:
                there = ", ".join(f"[{each}]" for each in (*TABLES, CHAT_TABLE))
                raise UsageError(
                    f"the settings in {layer.name} have no table [{name[:40]}]; there are: {there}"
                )
            if not isinstance(table, dict):
                raise UsageError(f"the settings in {layer.name} need a table [{name}]")
            for key in table:
                if key not in keys[name] and EARLIER_KEYS.get(key) not in keys[name]:
                    near = get_close_matches(key, keys[name], 1)
                    advice = f"did you mean '{near[0]}'?" if near else f"there are: {', '.join(keys[name])}"
                    raise UsageError(
                        f"the settings in {layer.name} have no '{key[:40]}' under [{name}]; {advice}"
                    )
    return layers


def driver_guard(value: str, place: str) -> str:
    """Refuses a driver's file if the working folder names it, or if its path depends on that folder."""
    if ".py" not in value:
        return ""
    if place == OF_FOLDER:
        return f"code is not run because a file names it; if you trust it, name it yourself: --driver {value}"
    path = value.rpartition(".py")[0]
    return "" if Path(path).is_absolute() else WHOLE_PATH


def place_guard(value: str, place: str) -> str:
    """Refuses a value that only the user may set, such as a host, if a file of the working folder sets it."""
    del value
    return YOURSELF if place == OF_FOLDER else ""


def path_guard(value: str, place: str) -> str:
    """Refuses paths as ``place_guard`` does, and relative paths in the user's own configuration file."""
    if place == OF_USER and not Path(value).expanduser().is_absolute():
        return WHOLE_PATH
    return place_guard(value, place)


def reader_guard(value: str, place: str) -> str:
    """Refuses a reader that has a path or asks a language model if a file of the working folder names it."""
    return _plugin_refusal("readers", value, place)


def designer_guard(value: str, place: str) -> str:
    """Refuses a designer that asks a language model if a file of the working folder names it."""
    return _plugin_refusal("designers", value, place)


def _plugin_refusal(shelf: str, value: str, place: str) -> str:
    from roadgpt import plugins
    from roadgpt.chat import asks_a_model

    name, colon, _ = value.partition(":")
    if place == OF_FOLDER and (colon or asks_a_model(plugins.find(shelf, name))):
        return YOURSELF
    return ""
