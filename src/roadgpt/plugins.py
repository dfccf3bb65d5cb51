"""Finds parts by name: readers, designers, rules, simulators, drivers.

A part registers under the entry point ``roadgpt.<shelf>``; ours use the same door as a user's.
"""

from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from roadgpt.errors import PartError

SHELVES = ("readers", "designers", "rules", "simulators", "drivers")


@cache
def _registered(shelf: str) -> dict[str, EntryPoint]:
    return {part.name: part for part in entry_points(group=f"roadgpt.{shelf}")}


def names(shelf: str) -> list[str]:
    """Names of the parts on a shelf, sorted.

    Raises:
        PartError: the shelf is empty; no road passes for want of rules.
    """
    found = sorted(_registered(shelf))
    if not found:
        raise PartError(
            f"nothing is installed on the shelf '{shelf}'; say pip install --force-reinstall roadgpt"
        )
    return found


def find(shelf: str, name: str) -> Any:
    """The object that a part registered, imported now.

    Raises:
        PartError: no part of that name; or its own libraries are missing.
    """
    known = names(shelf)
    if name not in known:
        raise PartError(f"no {shelf.removesuffix('s')} called '{name}'; there are: {', '.join(known)}")
    try:
        return _registered(shelf)[name].load()
    except ImportError as error:
        raise PartError(f"the {shelf.removesuffix('s')} '{name}' cannot be loaded: {error}") from error


def origin(shelf: str, name: str) -> str:
    """Which distribution a part comes from, as 'name version'."""
    part = _registered(shelf)[name]
    return f"{part.dist.name} {part.dist.version}" if part.dist else "unknown"
