"""Finds out which files decide what a driver does, so that results can say which driver gave them.

These are the modules that it loads and the files that it opens in the folder of its file or below, and those
that its class lists in ``uses``. Packages that are installed there, as in a virtual environment, and files
that compiled code opens by itself are not seen."""

# ruff: noqa: PTH100, PTH118 (pathlib has nothing that leaves links as they are)

import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from importlib.machinery import all_suffixes
from importlib.util import source_from_cache
from pathlib import Path
from typing import Any

from roadgpt.drive.permission import split_spec
from roadgpt.errors import UsageError

WRITTEN = "written by the driver"
"""Stands for the content of a file that the driver also writes, so that it differs at any time."""
MODULES = tuple(all_suffixes())
OPENING = {"open": 0, "import": 1, "ctypes.dlopen": 0, "os.rename": 1}
"""Python's audit events that concern a file, and the number of the argument that is its path."""


def folder_of(spec: str) -> Path:
    """Returns the folder of a driver's file, relative to which its files are named. A plug-in has none: it is
    recorded with its package."""
    return Path(split_spec(spec)[0]).resolve().parent


class DriverFiles:
    """Notes the files that the driver of this process uses; a process makes one object, which stays."""

    def __init__(self, spec: str) -> None:
        self._folder = os.path.join(folder_of(spec), "")
        places = sys.prefix, os.path.realpath(sys.prefix), sys.base_prefix, str(Path(__file__).parents[1])
        self._installed = tuple(each + os.sep for each in places if each.startswith(self._folder))
        self._used, self._written, self._now, self._early = (set[str]() for _ in range(4))
        if split_spec(spec)[0]:
            sys.addaudithook(self._note)

    def begin(self) -> None:
        """Begins a new driver: modules stay loaded, other files have to be opened anew."""
        self._now, self._early = set(), {name for name in self._early if name.endswith(MODULES)}

    def add(self, listed: str | Path | Iterable[str | Path]) -> None:
        """Adds what the driver's class lists in ``uses``; raises UsageError if it is missing."""
        for each in [listed] if isinstance(listed, str | Path) else listed:
            path = Path(self._folder, each)
            if not path.exists():
                raise UsageError(f"the class lists '{each}' in uses, and there is no {path}; correct it")
            self._now.add(os.path.relpath(path, self._folder).replace(os.sep, "/"))

    def told(self, is_early: bool = True) -> dict[str, list[str]]:
        """Returns the names of all files that were used so far, of those that were written, and of those that
        this driver has used until its ``start`` ended, which is ``early``."""
        self._used |= self._now
        self._early |= self._now if is_early else set()
        return {"used": [*self._used], "written": [*self._written], "early": sorted(self._early)}

    def _note(self, event: str, given: tuple[Any, ...]) -> None:
        """Notes a file that is opened; Python calls this for every event that can be audited."""
        if event not in OPENING:
            return
        with suppress(OSError, TypeError, ValueError):  # raised here, it would be an error of the driver
            path = os.path.abspath(os.fsdecode(given[OPENING[event]]))  # a TypeError for the number of a file
            path = source_from_cache(path) if path.endswith(".pyc") else path
            for each in {path, os.path.realpath(path)}:
                is_own = each.startswith(self._folder) and not each.startswith(self._installed)
                if is_own and "__pycache__" not in each and not Path(each).is_dir():
                    self._now.add(name := each[len(self._folder) :].replace(os.sep, "/"))
                    if event == "os.rename" or (event == "open" and given[2] & (os.O_WRONLY | os.O_RDWR)):
                        self._written.add(name)
