"""Returns the commands that repeat a Run: one makes its road from the description, one drives its road
file.
"""

import shlex
from collections.abc import Sequence
from pathlib import Path

from roadgpt.cli import options
from roadgpt.cli.configuration import keys_set
from roadgpt.cli.option import Option, named, words_of
from roadgpt.run.model import Request, Run

# What the command that drives a road which exists takes; the road's file says what its geometry is.
OF_DRIVES = named(options.SETUP, "driver", "simulator", "keep_driving", "rules")


def replay_lines(run: Run, folder: Path | None = None) -> list[str]:
    """Returns lines with the commands that repeat a Run: from its description, and from its road file."""
    lines = []
    request = run.request
    if run.words:
        lines.append(shlex.join(["roadgpt", "run", *request_words(request, run.index)]))
    if folder is not None and run.road is not None and request.setup.drives:
        again = ["roadgpt", "drive", str(folder / "road.json"), "--seed", str(run.seed)]
        lines.append(shlex.join(again + _written(request, OF_DRIVES)))
    return lines


def request_words(request: Request, roads: int) -> list[str]:
    """Returns the arguments after ``roadgpt run`` that make this many roads of a request."""
    rest = [
        "-n",
        str(roads),
        "--seed",
        str(request.seed),
        *_written(request, options.SETUP),
        *_asked(request),
    ]
    if not request.setup.drives:
        rest.append("--no-drive")
    # words that begin with a dash would pass for an option
    return [*rest, "--", request.words] if request.words.startswith("-") else [request.words, *rest]


def _asked(request: Request) -> list[str]:
    """Returns the options of the language model that differ from their defaults."""
    chat = request.setup.chat
    return words_of(options.CHAT, chat, chat and type(chat)())


def _written(request: Request, of_setup: Sequence[Option]) -> list[str]:
    """Returns the options that differ from their defaults, or that a file of settings would change."""
    told = keys_set()
    return [
        *words_of(of_setup, request.setup, told=told),
        *words_of(options.WORLD, request.world, told=told),
    ]
