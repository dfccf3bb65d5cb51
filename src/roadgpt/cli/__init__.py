"""The command line: reads options, calls the other rooms, and prints what they return.

Verb: ``main``. Commands are imported when they are called, and import the rooms they need inside their
functions, so that ``roadgpt --help`` answers at once.
"""

from roadgpt import stopping
from roadgpt.cli.app import app
from roadgpt.cli.streams import make_ready


def main() -> None:
    """Runs the console script ``roadgpt`` and ends the process with its exit status."""
    stopping.install()
    make_ready()
    try:
        app(prog_name="roadgpt")
    finally:
        stopping.leave()


__all__ = ["app", "main"]
