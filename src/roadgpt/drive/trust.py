"""Whose code is run: a driver's file that only another file names waits until the user names it.

Parts on the shelf are not asked about: the user installed them. A file that came with others may name them,
and no more than that.
"""

from pathlib import Path

from roadgpt.errors import UsageError
from roadgpt.provenance import CODE, USER


def parted(spec: str) -> tuple[str, str]:
    """Path and class of a driver in a file; no path where it is the name of one on the shelf."""
    if spec.endswith(".py"):
        return spec, ""
    path, _, wanted = spec.rpartition(":")
    return (path, wanted) if path.endswith(".py") else ("", "")


def named(spec: str) -> None:
    """The user names this driver: it may be run, also where files name it.

    A file that was written elsewhere names it by a path that is not here, so the name of its file and its
    class are enough; the user's file is then the one that is run.
    """
    if parted(spec)[0]:
        CODE.add_from_user(_whole(spec))
        CODE.add_from_user(_short(spec), spec)


def came_with(spec: str, file: object) -> str:
    """A file names this driver; gives back the one that is meant: the user's, where they named it."""
    if not parted(spec)[0] or CODE.given_as(_whole(spec)):
        return spec
    theirs = CODE.given_as(_short(spec))
    if theirs is None:
        CODE.add_from_file(_whole(spec), file)
    return theirs or spec


def admit(spec: str) -> None:
    """Let a driver's file be run, or ask the user, where there is somebody to be asked.

    Raises:
        UsageError: only a file names it, and the user does not say yes.
    """
    if not parted(spec)[0]:
        return
    file = CODE.untrusted_file(_whole(spec))
    if file is not None and not USER.ask(f"{file} names the driver {spec}. Run the code in that file?"):
        raise UsageError(
            f"{file} names the driver {spec}, and code is not run because a file says so; if you trust it, "
            f"name it yourself: --driver {spec}"
        )
    CODE.add_from_user(_whole(spec))  # files that are read from now on may name it as well


def expect(spec: str | None, drivers: set[str], place: object) -> None:
    """What the user names with --driver is to be what drives there.

    Raises:
        UsageError: it is not.
    """
    if spec is not None and spec not in drivers:
        told = ", ".join(sorted(drivers)) or "nobody"
        raise UsageError(
            f"{place} is driven by {told}, not by {spec}; name that driver, or leave out --driver"
        )


def _whole(spec: str) -> str:
    path, wanted = parted(spec)
    return f"{Path(path).absolute()}:{wanted}"


def _short(spec: str) -> str:
    path, wanted = parted(spec)
    return f"{path.replace(chr(92), '/').rpartition('/')[2]}:{wanted}"
