"""Loads the names that a room offers when they are first used, so that who needs one of them waits for no
other."""

from collections.abc import Mapping
from importlib import import_module
from typing import Any


def names_of(offered: Mapping[str, str]) -> list[str]:
    """Returns the names in a table that has them, divided by blanks, by the modules that define them."""
    return sorted(name for names in offered.values() for name in names.split())


def load(room: str, offered: Mapping[str, str], name: str) -> Any:
    """Returns what a name of such a table stands for; raises AttributeError if the room does not offer it."""
    for module, names in offered.items():
        if name in names.split():
            return getattr(import_module(f"{room}.{module}"), name)
    raise AttributeError(f"{room} has no '{name}'; it offers {', '.join(names_of(offered))}")
