"""Records where names come from. Code and servers that are named only by a file are not trusted.

A run, a campaign, a plan or a folder may have been made by somebody else. Code that reads one records which
drivers and servers it names (``add_from_file``), and code that takes an option from the user records that too
(``add_from_user``). Before a driver's file is run, or a key is sent to a server, ``untrusted_file`` returns
the file that names it where the user has not. Names that are given in a Python program came with no file, and
are trusted.
"""

from collections.abc import Callable


class NameOrigins:
    """Names of one kind in one process: those that the user gave, and those that came with files."""

    def __init__(self) -> None:
        self._named: dict[str, str] = {}
        self._files: dict[str, str] = {}

    def add_from_user(self, key: str, name: str = "") -> None:
        """Records that the user gave this key; ``name`` is the user's wording, if it differs from the key."""
        self._named[key] = name or key

    def given_as(self, key: str) -> str | None:
        """Returns the user's wording for this key; None where the user did not give it."""
        return self._named.get(key)

    def add_from_file(self, key: str, file: object) -> None:
        """Records that a file names this key. Only the first file is kept."""
        self._files.setdefault(key, str(file))

    def untrusted_file(self, key: str) -> str | None:
        """Returns the file that names this key, where the user did not give it; else None."""
        return None if key in self._named else self._files.get(key)

    def join(self, others: "NameOrigins") -> None:
        """Adds the names that another process has recorded."""
        self._named.update(others._named)
        self._files.update(others._files)

    def forget(self) -> None:
        """Removes all names, as in a new process."""
        self._named.clear()
        self._files.clear()


def _nobody(question: str) -> bool:
    return False


class Confirmation:
    """Asks the user to confirm something. Unless a program sets ``ask``, the answer is no."""

    def __init__(self) -> None:
        self.ask: Callable[[str], bool] = _nobody


CODE = NameOrigins()
"""Drivers in files, by the absolute path of the file and the name of the class."""
SERVERS = NameOrigins()
"""Servers of language models, by scheme, host and port."""
USER = Confirmation()


def known() -> tuple[NameOrigins, NameOrigins]:
    """Returns all names that this process has recorded, to be handed to a process that works for it."""
    return CODE, SERVERS


def join(names: tuple[NameOrigins, NameOrigins]) -> None:
    """Adds the names that were recorded by the process that this one works for."""
    for ours, theirs in zip((CODE, SERVERS), names, strict=True):
        ours.join(theirs)
