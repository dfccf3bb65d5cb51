"""Reports unexpected errors: writes the traceback to a file, and returns a sentence for the user."""

import platform
import sys
import tempfile
import traceback
from pathlib import Path

from roadgpt import __version__

# The folder that the command has made; if there is none, tracebacks go to the system's temporary folder.
_folder: list[Path] = []


def crashes_go_to(folder: Path) -> None:
    """Sets the folder into which tracebacks are written."""
    _folder[:] = [folder]


def report_crash(error: Exception) -> str:
    """Writes the traceback to a file; returns a sentence that says what happened and where the file is."""
    head = f"roadgpt {__version__}, Python {platform.python_version()}, {platform.platform()}\n"
    head += f"arguments: {sys.argv[1:]}\n\n"
    text = head + "".join(traceback.format_exception(error))
    what = f"{type(error).__name__}: {error}".splitlines()[0][:200]
    try:
        path = _write(text)
    except OSError:
        sys.stderr.write(text)
        return f"an error that should not happen ({what}); please report it with the lines above"
    return f"an error that should not happen ({what}); please report it with the file {path}"


def _write(text: str) -> Path:
    """Writes the text into the first folder that can be written to; returns the file."""
    for folder in (*_folder, Path(tempfile.gettempdir())):
        try:
            with tempfile.NamedTemporaryFile(
                "w", prefix="roadgpt-crash-", suffix=".txt", dir=folder, delete=False, encoding="utf-8",
                errors="backslashreplace",
            ) as file:  # fmt: skip
                file.write(text)
        except OSError:
            continue
        return Path(file.name)
    raise OSError("no folder to write to")
