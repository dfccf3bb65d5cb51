"""Loads a driver: a plug-in by its name, or a class in a user's own file, such as
``my_driver.py:MyDriver``."""

import hashlib
import importlib.util
import inspect
import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import Any

from roadgpt import plugins
from roadgpt.drive.permission import require_permission, split_spec
from roadgpt.errors import UsageError


def load_driver(spec: str) -> Any:
    """Creates the driver that a user named, in this process, and returns it.

    If only a stored file (of a run, a campaign or a plan) names a driver's file, the driver runs only after
    the user has agreed (see ``drive.permission``). Use ``isolation.driver_of`` to run a user's driver in a
    separate process.

    Args:
        spec: the name of a driver plug-in, or PATH.py:CLASS."""
    require_permission(spec)
    path, wanted = split_spec(spec)
    if not path:
        return _made(plugins.find("drivers", spec), spec)
    module = _run(Path(path))
    return _made(_class(module, wanted, path), spec)


def absolute_spec(spec: str, folder: Path) -> str:
    """Makes the path in a driver's specification absolute, so that the driver is found from any folder.

    A relative path starts from ``folder``. The name of a plug-in is returned unchanged."""
    path, wanted = split_spec(spec)
    if not path:
        return spec
    whole = (folder / path).absolute()
    return f"{whole}:{wanted}" if wanted else str(whole)


def _run(path: Path) -> ModuleType:
    """Imports the user's file as a module; the file can import other files in its folder."""
    if not path.is_file():
        raise UsageError(f"there is no file {path}: check the path of your driver")
    whole = path.resolve()
    name = f"{path.stem}_{hashlib.sha256(str(whole).encode()).hexdigest()[:8]}"
    described = importlib.util.spec_from_file_location(name, whole)
    if described is None or described.loader is None:
        raise UsageError(f"{path} cannot be imported: check its name and its rights")
    module = importlib.util.module_from_spec(described)
    sys.modules[name] = module  # dataclasses and pickle look up their module there
    sys.path.insert(0, str(whole.parent))
    try:
        described.loader.exec_module(module)
    except SyntaxError as error:
        del sys.modules[name]
        raise UsageError(
            f"{error.filename or path}, line {error.lineno}: {error.msg}; correct the file"
        ) from error
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise UsageError(f"{path}{_line(error, whole)}: {_said(error)}; correct the file") from error
    finally:
        sys.path.remove(str(whole.parent))
    return module


def _class(module: ModuleType, wanted: str, path: str) -> Any:
    own = [
        name
        for name, value in vars(module).items()
        if inspect.isclass(value) and value.__module__ == module.__name__
    ]
    if wanted and hasattr(module, wanted):
        return getattr(module, wanted)
    there = f"it has {', '.join(own)}" if own else "it has none"
    if not wanted:
        example = own[0] if own else "MyDriver"
        raise UsageError(f"say which class of {path} drives, like {path}:{example}; {there}")
    raise UsageError(f"{path} has no class '{wanted}'; {there}")


def _made(driver: Any, spec: str) -> Any:
    """Returns an instance with a method ``steer(view)``."""
    if inspect.isclass(driver):
        if not callable(getattr(driver, "steer", None)):
            raise UsageError(f"the driver {spec} has no method steer(self, view): add it")
        try:
            driver = driver()
        except (Exception, SystemExit) as error:
            raise UsageError(
                f"the driver {spec} cannot be made without arguments: {_said(error)}; "
                "give its parameters defaults"
            ) from error
    if not callable(getattr(driver, "steer", None)):
        raise UsageError(f"the driver {spec} has no method steer(self, view): add it")
    try:
        inspect.signature(driver.steer).bind(None)
    except TypeError as error:
        raise UsageError(f"the driver {spec}: steer must take one argument, the view ({error})") from error
    return driver


def _said(error: BaseException) -> str:
    text = str(error)
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _line(error: BaseException, path: Path) -> str:
    """Returns the innermost line of the user's file in the traceback, as text."""
    lines = [
        frame.lineno for frame in traceback.extract_tb(error.__traceback__) if Path(frame.filename) == path
    ]
    return f", line {lines[-1]}" if lines else ""
