"""Finds out which files decide what a driver does, so that results can say which driver gave them.

These are the modules that it loads and the files that it opens in the folder of its file or below, and those
that its class lists in ``uses``. Packages that are installed there, as in a virtual environment, and files
that compiled code opens by itself are not seen."""

# ruff: noqa: PTH100, PTH118 (pathlib has nothing that leaves links as they are)

import importlib
import os
import sys
from collections.abc import Iterable
from contextlib import suppress
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import source_from_cache
from pathlib import Path
from typing import Any

from roadgpt.drive.loading import folder_of, split_spec
from roadgpt.errors import UsageError

COMPILED = tuple(EXTENSION_SUFFIXES)
OPENING = {"open": 0, "import": 1, "ctypes.dlopen": 0, "os.rename": 1}
"""Python's audit events that concern a file, and the number of the argument that is its path."""


class DriverFiles:
    """Notes the files that the driver of this process uses; a process makes one object, which stays."""

    def __init__(self, spec: str) -> None:
        self._folder = os.path.join(folder_of(spec), "")
        places = sys.prefix, os.path.realpath(sys.prefix), sys.base_prefix, str(Path(__file__).parents[1])
        self._installed = tuple(each + os.sep for each in places if each.startswith(self._folder))
        self._used, self._written = set[str](), set[str]()
        self._is_file = bool(split_spec(spec)[0])
        sys.addaudithook(self._note)

    def begin(self) -> bool:
        """Begins a new driver, which has to open its files and load its modules anew; returns False if one
        was loaded that can be loaded only once in a process, since it is compiled."""
        self._used.clear()
        importlib.invalidate_caches()
        loaded = [name for name, module in [*sys.modules.items()] if any(map(self._is_own, _places(module)))]
        dropped = [sys.modules.pop(name) for name in loaded if name != "__main__"]
        return not any(str(getattr(each, "__file__", "")).endswith(COMPILED) for each in dropped)

    def add(self, listed: str | Path | Iterable[str | Path]) -> None:
        """Adds what the driver's class lists in ``uses``; raises UsageError if it is missing."""
        for each in [listed] if isinstance(listed, str | Path) else listed:
            path = Path(self._folder, each)
            if not path.exists():
                raise UsageError(f"the class lists '{each}' in uses, and there is no {path}; correct it")
            self._used.add(os.path.relpath(path, self._folder).replace(os.sep, "/"))

    def told(self) -> dict[str, bool]:
        """Returns the names of the files that this driver has used so far, and whether drivers wrote them."""
        return {name: name in self._written for name in sorted(self._used)}

    def _note(self, event: str, given: tuple[Any, ...]) -> None:
        """Notes a file that is opened; Python calls this for every event that can be audited."""
        if event not in OPENING:
            return
        with suppress(OSError, TypeError, ValueError):  # raised here, it would be an error of the driver
            path = os.path.abspath(os.fsdecode(given[OPENING[event]]))  # a TypeError for the number of a file
            path = source_from_cache(path) if path.endswith(".pyc") else path
            for each in {path, os.path.realpath(path)}:
                if self._is_own(each) and "__pycache__" not in each and not Path(each).is_dir():
                    self._used.add(name := each[len(self._folder) :].replace(os.sep, "/"))
                    if event == "os.rename" or (event == "open" and given[2] & (os.O_WRONLY | os.O_RDWR)):
                        self._written.add(name)

    def _is_own(self, path: str) -> bool:
        return self._is_file and path.startswith(self._folder) and not path.startswith(self._installed)


def _places(module: Any) -> list[str]:
    """Returns the file of a module, and the folders of a package."""
    with suppress(Exception):  # anything may stand in sys.modules
        places = (*getattr(module, "__path__", ()), getattr(module, "__file__", None))
        return [os.path.realpath(each) for each in places if each]
    return []
