"""Loads a driver, a plug-in by its name or a class in a user's own file such as ``my_driver.py:MyDriver``,
and decides which may be run. Settings may follow, as in ``lane_centring:lag=0.4,headway=1.5``: arguments of
the driver's constructor. If only a stored file, such as a run's ``run.json``, names a driver's file, the
driver's code is not run until the user names the driver or agrees. The same holds for the file of recorded
tracks of others: it is not read.

Plug-ins need no permission, because the user has installed them, unless a setting is a text: it may name a
file that the driver loads."""

import hashlib
import importlib.util
import inspect
import re
import shlex
import sys
import traceback
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from math import isfinite
from pathlib import Path
from types import ModuleType
from typing import Any

from roadgpt import plugins
from roadgpt.errors import UsageError
from roadgpt.provenance import CODE, USER

# suffixes of files with recorded tracks
RECORDINGS = (".csv", *(f".{name}" for name in plugins.names("recordings")))
WRITTEN = "written by the driver"
"""Stands for the content of a file that the driver also writes, so that it differs at any time."""
WITH_SETTINGS = re.compile(r"(.+\.py(?::\w+)?|[^:]+):(\w+=.*)", re.DOTALL)
READERS: Mapping[str, Callable[[str], Any]] = {
    "bool": {"true": True, "false": False}.__getitem__,
    "None": {"none": None}.__getitem__,
    "int": int,
    "float": float,
    "str": str,
}
"""What reads a setting, by the name of its type."""
GIVE = {
    "bool": "true or false",
    "None": "none",
    "int": "a whole number",
    "float": "a number",
    "str": "a text",
}


def without_settings(spec: str) -> tuple[str, str]:
    """Splits NAME:key=value,key=value into the driver and its settings; they are empty if there are none."""
    found = WITH_SETTINGS.fullmatch(spec)
    return (found[1], found[2]) if found else (spec, "")


def split_spec(spec: str) -> tuple[str, str]:
    """Splits PATH.py:CLASS into path and class, without settings; returns two empty strings for the name of a
    plug-in. Recorded tracks have a path and no class."""
    spec, _ = without_settings(spec)
    if spec.endswith((".py", *RECORDINGS)):
        return spec, ""
    path, _, wanted = spec.rpartition(":")
    return (path, wanted) if path.endswith(".py") else ("", "")


def folder_of(spec: str) -> Path:
    """Returns the folder of a driver's file, relative to which its files are named. A plug-in has none: it is
    recorded with its package."""
    return Path(split_spec(spec)[0]).resolve().parent


def needs_permission(spec: str) -> bool:
    """Returns whether the user has to name this driver, or these recorded tracks, before they are used."""
    texts = [each.partition("=")[2] for each in without_settings(spec)[1].split(",")]
    return bool(split_spec(spec)[0]) or any(_converted(text, READERS) == text for text in texts if text)


def permit(spec: str) -> None:
    """Records that the user has named this driver; stored files may then name the driver, too.

    A run that was made on another machine names the driver by a path that does not exist on this machine.
    Drivers with the same file name and the same class therefore count as the same driver, and the file that
    the user named is run."""
    if needs_permission(spec):
        CODE.add_from_user(_whole(spec))
        CODE.add_from_user(without_folder(spec), spec)


def driver_from_file(spec: str, file: object) -> str:
    """Returns the driver to use where a stored file names ``spec``. If the user has named a driver with the
    same file name and class, the result is the user's driver; otherwise the result is ``spec``."""
    if not needs_permission(spec) or CODE.given_as(_whole(spec)):
        return spec
    theirs = CODE.given_as(without_folder(spec))
    if theirs is None:
        CODE.add_from_file(_whole(spec), file)
    return theirs or spec


def require_permission(spec: str) -> None:
    """Permits a driver's file to be run, or recorded tracks to be read. If it is named only in a stored file,
    the user is first asked for permission."""
    if not needs_permission(spec):
        return
    file = CODE.untrusted_file(_whole(spec))
    if file is not None and spec.endswith(RECORDINGS):
        if not USER.ask(f"{file} names the recorded tracks {spec}. Read that file?"):
            raise UsageError(
                f"{file} names the recorded tracks {spec}, which are not read because a file says so; agree "
                f"in a terminal, or drive the road with {shlex.join(['--tracks', spec])}"
            )
    elif file is not None and not USER.ask(f"{file} names the driver {spec}. Run the code in that file?"):
        raise UsageError(
            f"{file} names the driver {spec}, and code is not run because a file says so; if you trust it, "
            f"name it yourself: {shlex.join(['--driver', spec])}"
        )
    CODE.add_from_user(_whole(spec))  # files that are read from now on may name it as well


def check_named_drivers(specs: Iterable[str], drivers: set[str], place: object) -> None:
    """Raises UsageError if a driver given with ``--driver`` is not among those of the run or campaign."""
    for spec in specs:
        if _whole(spec) not in {*map(_whole, drivers)}:
            told = ", ".join(sorted(drivers)) or "nobody"
            raise UsageError(
                f"{place} is driven by {told}, not by {spec}; name that driver, or leave out --driver"
            )


def _whole(spec: str) -> str:
    path, wanted = split_spec(spec)
    return f"{Path(path).absolute()}:{wanted}{_behind(spec)}" if path else spec


def _behind(spec: str) -> str:
    driver, settings = without_settings(spec)
    return spec[len(driver) :] if settings else ""


def without_folder(spec: str) -> str:
    """Returns FILE.py:CLASS without the file's folder; the name of a plug-in is returned unchanged."""
    path, wanted = split_spec(spec)
    return f"{path.replace(chr(92), '/').rpartition('/')[2]}:{wanted}{_behind(spec)}" if path else spec


def load_driver(spec: str) -> Any:
    """Creates the driver that a user named, in this process, and returns it.

    If only a stored file (of a run, a campaign or a plan) names a driver's file, the driver runs only after
    the user has agreed (see ``drive.loading``). Use ``isolation.driver_of`` to run a user's driver in a
    separate process. ``spec`` is the name of a driver plug-in, or PATH.py:CLASS."""
    require_permission(spec)
    path, wanted = split_spec(spec)
    if not path:
        return _made(plugins.find("drivers", without_settings(spec)[0]), spec)
    module = _run(Path(path))
    return _made(_class(module, wanted, path), spec)


def absolute_spec(spec: str, folder: Path) -> str:
    """Makes the path in a driver's specification absolute, so that the driver is found from any folder.

    A relative path starts from ``folder``. The name of a plug-in is returned unchanged."""
    path, wanted = split_spec(spec)
    if not path:
        return spec
    whole = (folder / path).absolute()
    return f"{whole}:{wanted}{_behind(spec)}" if wanted else f"{whole}{_behind(spec)}"


def _run(path: Path) -> ModuleType:
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
    if not callable(getattr(driver, "steer", None)):
        raise UsageError(f"the driver {spec} has no method steer(self, view): add it")
    settings = _settings(driver, *without_settings(spec))
    if inspect.isclass(driver):
        try:
            driver = driver(**settings)
        except (Exception, SystemExit) as error:
            how = "with these settings" if settings else "without arguments"
            raise UsageError(
                f"the driver {spec} cannot be made {how}: {_said(error)}; give its parameters defaults"
            ) from error
    try:
        inspect.signature(driver.steer).bind(None)
    except TypeError as error:
        raise UsageError(f"the driver {spec}: steer must take one argument, the view ({error})") from error
    return driver


def _settings(driver: Any, name: str, said: str) -> dict[str, Any]:
    """Returns settings by name, each with a type that the driver's constructor names, or that of its default.
    Raises UsageError if there is no such setting, or it cannot have this value."""
    if not said:
        return {}
    found, kinds = dict[str, Any](), dict[str, list[str]]()
    for each in inspect.signature(driver).parameters.values() if inspect.isclass(driver) else ():
        kind = type(each.default) if each.annotation is each.empty else each.annotation
        words = re.findall(r"\w+", kind if isinstance(kind, str) else inspect.formatannotation(kind))
        if own := [kind for kind in READERS if kind in words]:
            kinds[each.name] = own
    for key, _, text in (each.strip().partition("=") for each in said.split(",")):
        if key not in kinds:
            there = f"it has {', '.join(kinds)}" if kinds else "it has none"
            raise UsageError(f"the driver {name} has no setting '{key}'; {there}")
        try:
            found[key] = _converted(text, kinds[key])
        except ValueError:
            what = " or ".join(GIVE[kind] for kind in kinds[key])
            raise UsageError(f"the driver {name} cannot have {key}={text}; give {what}") from None
    return found


def _converted(text: str, kinds: Iterable[str]) -> Any:
    """Returns a text as the first of these types that it fits; raises ValueError if it fits none."""
    for kind in kinds:
        with suppress(KeyError, ValueError):
            value = READERS[kind](text)
            if not isinstance(value, float) or isfinite(value):
                return value
    raise ValueError(text)


def _said(error: BaseException) -> str:
    text = str(error)
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _line(error: BaseException, path: Path) -> str:
    lines = [
        frame.lineno for frame in traceback.extract_tb(error.__traceback__) if Path(frame.filename) == path
    ]
    return f", line {lines[-1]}" if lines else ""
