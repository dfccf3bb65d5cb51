"""Finds parts by name: providers, readers, designers, rules, exporters, simulators, drivers.

A part registers under the entry point ``roadgpt.<shelf>``; ours use the same door as a user's.
"""

from functools import cache
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from roadgpt.errors import PartError

SHELVES = (
    "providers",
    "readers",
    "designers",
    "rules",
    "exporters",
    "simulators",
    "drivers",
    "generators",
    "executors",
)


@cache
def _registered(shelf: str) -> dict[str, list[EntryPoint]]:
    """Parts by name; more than one of a name where packages disagree about it."""
    found: dict[str, list[EntryPoint]] = {}
    for part in entry_points(group=f"roadgpt.{shelf}"):
        same = found.setdefault(part.name, [])
        if part.value not in {other.value for other in same}:
            same.append(part)
    return found


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
        PartError: no part of that name, or more than one; or it cannot be loaded.
    """
    known = names(shelf)
    if name not in known:
        raise PartError(f"no {shelf.removesuffix('s')} called '{name}'; there are: {', '.join(known)}")
    part, *others = _registered(shelf)[name]
    if others:
        raise PartError(
            f"{len(others) + 1} packages bring a {shelf.removesuffix('s')} called '{name}' "
            f"({origin(shelf, name)}); uninstall all but one"
        )
    try:
        return part.load()
    except Exception as error:  # a part of another package may fail in any way, and costs only itself
        raise PartError(
            f"the {shelf.removesuffix('s')} '{name}' cannot be loaded ({type(error).__name__}: {error}); "
            f"mend or uninstall {origin(shelf, name)}"
        ) from error


def module_of(shelf: str, name: str) -> str:
    """The module that a part comes from, which is not imported for it; empty where there is no such part."""
    return next((part.module for part in _registered(shelf).get(name, ())), "")


def origin(shelf: str, name: str) -> str:
    """Which distribution a part comes from, as 'name version'; all of them, where it is more than one."""
    parts = _registered(shelf)[name]
    return ", ".join(f"{part.dist.name} {part.dist.version}" if part.dist else "unknown" for part in parts)
