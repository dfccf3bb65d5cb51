"""Decides which drivers may be run. If only a stored file, such as a run's ``run.json``, names a
driver's file, the driver's code is not run until the user names the driver or agrees.

Plug-ins need no permission, because the user has installed them."""

import shlex
from collections.abc import Iterable
from pathlib import Path

from roadgpt.errors import UsageError
from roadgpt.provenance import CODE, USER


def split_spec(spec: str) -> tuple[str, str]:
    """Splits PATH.py:CLASS into path and class; returns two empty strings for the name of a plug-in."""
    if spec.endswith(".py"):
        return spec, ""
    path, _, wanted = spec.rpartition(":")
    return (path, wanted) if path.endswith(".py") else ("", "")


def permit(spec: str) -> None:
    """Records that the user has named this driver; stored files may then name the driver, too.

    A run that was made on another machine names the driver by a path that does not exist on this machine.
    Drivers with the same file name and the same class therefore count as the same driver, and the file that
    the user named is run."""
    if split_spec(spec)[0]:
        CODE.add_from_user(_whole(spec))
        CODE.add_from_user(without_folder(spec), spec)


def driver_from_file(spec: str, file: object) -> str:
    """Returns the driver to use where a stored file names ``spec``. If the user has named a driver with the
    same file name and class, the result is the user's driver; otherwise the result is ``spec``."""
    if not split_spec(spec)[0] or CODE.given_as(_whole(spec)):
        return spec
    theirs = CODE.given_as(without_folder(spec))
    if theirs is None:
        CODE.add_from_file(_whole(spec), file)
    return theirs or spec


def require_permission(spec: str) -> None:
    """Permits a driver's file to be run. If the driver is named only in a stored file, the user is first
    asked for permission."""
    if not split_spec(spec)[0]:
        return
    file = CODE.untrusted_file(_whole(spec))
    if file is not None and not USER.ask(f"{file} names the driver {spec}. Run the code in that file?"):
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
    """Returns PATH.py:CLASS with an absolute path; the name of a plug-in is returned unchanged."""
    path, wanted = split_spec(spec)
    return f"{Path(path).absolute()}:{wanted}" if path else spec


def without_folder(spec: str) -> str:
    """Returns FILE.py:CLASS without the file's folder; the name of a plug-in is returned unchanged."""
    path, wanted = split_spec(spec)
    return f"{path.replace(chr(92), '/').rpartition('/')[2]}:{wanted}" if path else spec
