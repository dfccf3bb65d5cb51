"""Records whether drivers and servers were named by the user or only by a file. A driver or server is trusted
only if the user named it, because a run, a campaign, a plan or a folder may come from somebody else. Code
that reads such a file records what the file names (``add_from_file``), and code that reads the user's options
what the user names (``add_from_user``). Before the code of a driver is run, or a key is sent to a server,
``untrusted_file`` tells whether only a file named it. What the user's own Python program names is trusted."""

from collections.abc import Callable


class NameOrigins:
    """Names of drivers or of servers that were recorded in this process, from the user and from files."""

    def __init__(self) -> None:
        self._named: dict[str, str] = {}
        self._files: dict[str, str] = {}

    def add_from_user(self, key: str, name: str = "") -> None:
        """Records that the user named a driver or server; ``name`` is the spelling, if it is not ``key``."""
        self._named[key] = name or key

    def given_as(self, key: str) -> str | None:
        """Returns the user's spelling; None if the user did not name it."""
        return self._named.get(key)

    def add_from_file(self, key: str, file: object) -> None:
        """Records that a file names a driver or server; only the first such file is kept."""
        self._files.setdefault(key, str(file))

    def untrusted_file(self, key: str) -> str | None:
        """Returns the file that names a driver or server; None if no file, or the user, too, names it."""
        return None if key in self._named else self._files.get(key)

    def join(self, others: "NameOrigins") -> None:
        """Adds the names that were recorded in another process."""
        self._named.update(others._named)
        self._files.update(others._files)

    def forget(self) -> None:
        """Removes all names, as in a new process."""
        self._named.clear()
        self._files.clear()


class Confirmation:
    """Asks the user to confirm something; without a program that sets ``ask``, the answer is always no."""

    def __init__(self) -> None:
        self.ask: Callable[[str], bool] = lambda question: False


CODE = NameOrigins()
"""Drivers defined in Python files; keys are the absolute path of the file and the name of the class."""
SERVERS = NameOrigins()
"""Known servers of language models, by scheme, host and port."""
USER = Confirmation()


def known() -> tuple[NameOrigins, NameOrigins]:
    """Returns all names that this process has recorded, so that they can be passed to a worker process."""
    return CODE, SERVERS


def join(names: tuple[NameOrigins, NameOrigins]) -> None:
    """Adds all names recorded by the parent process to the names of this worker process."""
    for ours, theirs in zip((CODE, SERVERS), names, strict=True):
        ours.join(theirs)
