"""The command line: a door. It asks, shows and counts, and leaves the work to the rooms.

Verb: ``main``. Commands are imported when they are called, and import the rooms they need inside their
functions, so that ``roadgpt --help`` answers at once.
"""

import io
import sys

from roadgpt.cli.app import app


def main() -> None:
    """What the console script ``roadgpt`` runs; ends the process with the exit status."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # letters that the other end has not are written as escapes
            stream.reconfigure(errors="backslashreplace")
    app(prog_name="roadgpt")


__all__ = ["app", "main"]
