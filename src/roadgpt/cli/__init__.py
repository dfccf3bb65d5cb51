"""The command line: a door. It asks, shows and counts, and leaves the work to the rooms.

Verb: ``main``. Commands are imported when they are called, and import the rooms they need inside their
functions, so that ``roadgpt --help`` answers at once.
"""

import signal
from types import FrameType

from roadgpt.cli.app import app
from roadgpt.cli.streams import make_ready


def main() -> None:
    """What the console script ``roadgpt`` runs; ends the process with the exit status."""
    make_ready()
    if signal.getsignal(signal.SIGTERM) is signal.SIG_DFL:
        signal.signal(signal.SIGTERM, _stop)
    app(prog_name="roadgpt")


def _stop(number: int, frame: FrameType | None) -> None:
    """Whoever ends the program politely gets what Ctrl-C gives: whole files, the table, status 130."""
    raise KeyboardInterrupt


__all__ = ["app", "main"]
