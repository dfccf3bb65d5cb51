"""Options that can also be set in a configuration file or the environment; ``roadgpt config show`` lists
them.

A value on the command line takes precedence, then the environment (``ROADGPT_FRICTION``), then ``.env`` and
``roadgpt.toml`` in the working folder, then the user's ``config.toml``. The tables are ``[run]``, ``[world]``
and ``[beamng]``; ``[chat]`` is for language models.

A working folder may come from somebody else. Therefore its files cannot specify a driver's file, a program, a
server or a plug-in that uses a language model: such a value is refused, and the user has to give it as an
option.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.chat.config import Layer

TABLES = ("run", "world", "beamng")
CHAT_TABLE = "chat"
EARLIER_KEYS = {"verge": "shoulder"}
"""Maps earlier keys, which campaign plans still use, to present keys; configuration files may use both."""

OF_FOLDER, OF_USER, OF_ENVIRONMENT = "folder", "user", "environment"
YOURSELF = "a file of this folder cannot decide that; say it yourself with the option"
WHOLE_PATH = "give the whole path, from the root of the disk"
Guard = Callable[[str, str], str]
"""A function that takes a value and the kind of its source, such as ``OF_FOLDER``. It returns the reason why
the value is refused, or an empty text if the value is accepted.
"""


def read_layers(keys: Mapping[str, Sequence[str]]) -> "Sequence[Layer]":
    """Reads all sources of settings, and returns them, highest precedence first. ``keys`` are the known keys
    of each table.

    Raises:
        UsageError: A file cannot be read, or has an unknown table or key.
    """
    from roadgpt.chat.config import layers as all_layers
    from roadgpt.chat.config import unknown_key

    layers = all_layers()
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
                if EARLIER_KEYS.get(key, key) not in keys[name]:
                    raise unknown_key(layer.name, name, key, keys[name])
    return layers


def driver_guard(value: str, place: str) -> str:
    """A Guard that refuses a driver's file if a configuration file in the working folder names it, or if its
    path is relative.
    """
    if ".py" not in value:
        return ""
    if place == OF_FOLDER:
        return f"code is not run because a file names it; if you trust it, name it yourself: --driver {value}"
    path = value.rpartition(".py")[0]
    return "" if Path(path).is_absolute() else WHOLE_PATH


def place_guard(value: str, place: str) -> str:
    """A Guard for values that only the user may set, such as a host: refuses a value from a configuration
    file in the working folder."""
    del value
    return YOURSELF if place == OF_FOLDER else ""


def path_guard(value: str, place: str) -> str:
    """A Guard for paths: refuses every path from a configuration file in the working folder, and relative
    paths from the user's ``config.toml``."""
    if place == OF_USER and not Path(value).expanduser().is_absolute():
        return WHOLE_PATH
    return place_guard(value, place)


def _plugin_guard(kind: str, value: str, place: str) -> str:
    """Refuses a plug-in that a configuration file in the working folder names, if the plug-in is given with a
    path or uses a language model."""
    from roadgpt import plugins
    from roadgpt.chat import asks_a_model

    name, colon, _ = value.partition(":")
    if place == OF_FOLDER and (colon or asks_a_model(plugins.find(kind, name))):
        return YOURSELF
    return ""


reader_guard, designer_guard = partial(_plugin_guard, "readers"), partial(_plugin_guard, "designers")
