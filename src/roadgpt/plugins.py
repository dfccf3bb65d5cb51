"""Finds plug-ins by name: providers, readers, designers, rules, exporters, simulators, and so on.

Of the kinds ``commands``, ``checks`` (of ``roadgpt doctor``), ``reports`` (of folders of other packages),
``chapters`` (of reports), ``analyses`` (of tests), ``tables`` (of folders of runs), ``settings`` (of
simulators) and ``recordings`` (of others on the road), there may be none.

Plug-ins are registered as entry points of the group ``roadgpt.<kind>``. The built-in plug-ins use the same
mechanism as those of users."""

from functools import cache
from importlib import metadata
from importlib.metadata import EntryPoint
from typing import Any

from roadgpt.errors import PartError

KINDS = (
    "providers", "readers", "designers", "rules", "exporters", "simulators", "drivers",
    "generators", "columns", "executors", "maps",
)  # fmt: skip


@cache
def _every() -> Any:
    return metadata.entry_points()  # to read those of one group alone takes as long


def entry_points(group: str) -> Any:
    """Returns the entry points of a group, such as 'roadgpt.rules'."""
    return _every().select(group=group)


@cache
def _registered(kind: str) -> dict[str, list[EntryPoint]]:
    """Returns the plug-ins of one kind by name; several if packages register different ones under a name."""
    found: dict[str, list[EntryPoint]] = {}
    for part in entry_points(group=f"roadgpt.{kind}"):
        same = found.setdefault(part.name, [])
        if part.value not in {other.value for other in same}:
            same.append(part)
    return found


def names(kind: str) -> list[str]:
    """Returns the sorted names of the plug-ins of one kind, such as "rules". Raises PartError if there are
    none of one of the ``KINDS``: without rules, every road would be accepted."""
    found = sorted(_registered(kind))
    if not found and kind in KINDS:
        raise PartError(f"no {kind} are installed; run pip install --force-reinstall roadgpt")
    return found


def find(kind: str, name: str) -> Any:
    """Imports a plug-in and returns the object that it registered. Raises PartError if there is none of this
    name or more than one, or it cannot be loaded."""
    known, one = names(kind), kind.removesuffix("s")
    if name not in known:
        raise PartError(f"no {one} called '{name}'; there are: {', '.join(known)}")
    part, *others = _registered(kind)[name]
    if others:
        raise PartError(
            f"{len(others) + 1} packages register a {one} called '{name}' ({origin(kind, name)}); uninstall "
            "all but one"
        )
    try:
        return part.load()
    except Exception as error:  # a plug-in of another package may fail in any way, and must not affect others
        raise PartError(
            f"the {one} '{name}' cannot be loaded ({type(error).__name__}: {error}); repair or uninstall "
            f"{origin(kind, name)}"
        ) from error


def module_of(kind: str, name: str) -> str:
    """Returns the name of the module that defines a plug-in, without importing it; empty if there is none."""
    return next((part.module for part in _registered(kind).get(name, ())), "")


def origin(kind: str, name: str) -> str:
    """Returns the distributions that provide a plug-in, each as 'name version'."""
    parts = _registered(kind)[name]
    return ", ".join(f"{part.dist.name} {part.dist.version}" if part.dist else "unknown" for part in parts)
