"""The command line: reads options, calls the other packages, and prints what they return.

``main`` is the entry point. Commands are imported when they are called, and import other packages inside
their functions, so that ``roadgpt --help`` answers at once."""

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
