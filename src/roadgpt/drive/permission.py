"""Decides whose code is run: a driver's file that only another file names is not run until the user names it.

Installed plug-ins need no permission, because the user installed them. A file that came from elsewhere may
name them, but nothing else.
"""

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
    """Records that the user names this driver: it may be run, also where files name it.

    A file that was written elsewhere names the driver by a path that does not exist here. The file's own name
    and the class are therefore enough to match; the user's file is then the one that is run.
    """
    if split_spec(spec)[0]:
        CODE.add_from_user(_whole(spec))
        CODE.add_from_user(_short(spec), spec)


def driver_from_file(spec: str, file: object) -> str:
    """Returns the driver to use for one that a file names: the user's own, if the user named it."""
    if not split_spec(spec)[0] or CODE.given_as(_whole(spec)):
        return spec
    theirs = CODE.given_as(_short(spec))
    if theirs is None:
        CODE.add_from_file(_whole(spec), file)
    return theirs or spec


def require_permission(spec: str) -> None:
    """Allows a driver's file to be run, asking the user if somebody can be asked.

    Raises:
        UsageError: only a file names the driver, and the user does not agree.
    """
    if not split_spec(spec)[0]:
        return
    file = CODE.untrusted_file(_whole(spec))
    if file is not None and not USER.ask(f"{file} names the driver {spec}. Run the code in that file?"):
        raise UsageError(
            f"{file} names the driver {spec}, and code is not run because a file says so; if you trust it, "
            f"name it yourself: --driver {spec}"
        )
    CODE.add_from_user(_whole(spec))  # files that are read from now on may name it as well


def check_named_driver(spec: str | None, drivers: set[str], place: object) -> None:
    """Checks that the driver of the option ``--driver`` is one of those that drive in this folder.

    Raises:
        UsageError: it is not.
    """
    if spec is not None and spec not in drivers:
        told = ", ".join(sorted(drivers)) or "nobody"
        raise UsageError(
            f"{place} is driven by {told}, not by {spec}; name that driver, or leave out --driver"
        )


def _whole(spec: str) -> str:
    path, wanted = split_spec(spec)
    return f"{Path(path).absolute()}:{wanted}"


def _short(spec: str) -> str:
    path, wanted = split_spec(spec)
    return f"{path.replace(chr(92), '/').rpartition('/')[2]}:{wanted}"
