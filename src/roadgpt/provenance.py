"""What came with a file, and what the user named: code and servers that only a file names are not trusted.

A run, a campaign, a plan or a folder may be somebody else's. Whoever reads one says here which drivers and
servers it names (``came_with``), and whoever takes an option from the user says so as well (``name``). Before
a driver's file is run, or a key is sent to a server, ``stranger`` tells which file names it and the user does
not. What a program in Python names itself came with no file, and is no stranger.
"""

from collections.abc import Callable


class Names:
    """Names of one kind, in one process: those that the user gave, and those that came with files."""

    def __init__(self) -> None:
        self._named: dict[str, str] = {}
        self._files: dict[str, str] = {}

    def name(self, key: str, name: str = "") -> None:
        """The user names this; ``name`` is how, where that is not the key."""
        self._named[key] = name or key

    def named(self, key: str) -> str | None:
        """How the user named what has this key; None where they did not."""
        return self._named.get(key)

    def came_with(self, key: str, file: object) -> None:
        """A file names this; the first that does is told of."""
        self._files.setdefault(key, str(file))

    def stranger(self, key: str) -> str | None:
        """The file that names this, where the user does not."""
        return None if key in self._named else self._files.get(key)

    def join(self, others: "Names") -> None:
        """Know what another process knew."""
        self._named.update(others._named)
        self._files.update(others._files)

    def forget(self) -> None:
        """Begin anew, as a new process does."""
        self._named.clear()
        self._files.clear()


def _nobody(question: str) -> bool:
    return False


class Asker:
    """Whoever can be asked for a yes; nobody can, unless a program says so."""

    def __init__(self) -> None:
        self.ask: Callable[[str], bool] = _nobody


CODE = Names()
"""Drivers in files, by the absolute path of the file and the name of the class."""
SERVERS = Names()
"""Of language models, by scheme, host and port."""
USER = Asker()


def known() -> tuple[Names, Names]:
    """All that this process knows, to be handed to one that works for it."""
    return CODE, SERVERS


def join(names: tuple[Names, Names]) -> None:
    """Know what the process knew that this one works for."""
    for ours, theirs in zip((CODE, SERVERS), names, strict=True):
        ours.join(theirs)
