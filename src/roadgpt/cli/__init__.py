"""The command line: a door. It asks, shows and counts, and leaves the work to the rooms.

Verb: ``main``. Commands are imported when they are called, and import the rooms they need inside their
functions, so that ``roadgpt --help`` answers at once.
"""

from roadgpt import stopping
from roadgpt.cli.app import app
from roadgpt.cli.streams import make_ready


def main() -> None:
    """What the console script ``roadgpt`` runs; ends the process with the exit status."""
    stopping.install()
    make_ready()
    try:
        app(prog_name="roadgpt")
    finally:
        stopping.leave()


__all__ = ["app", "main"]
