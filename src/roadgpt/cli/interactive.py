"""``roadgpt`` without a command: asks for a description and a number of roads, again and again."""

import re
import sys

import click

from roadgpt import stopping
from roadgpt.cli import edit_job
from roadgpt.cli.options import ROADS
from roadgpt.cli.run_job import carry_out
from roadgpt.cli.screen import Screen
from roadgpt.errors import RoadGPTError

USUAL_ROADS = 3
ENOUGH = {"exit", "quit", "bye", "q"}

HELP = {"help", "?", "hilfe"}

CHANGE = "change it? > "
CHANGE_ONE = "change one? (2: make the last turn sharper) > "
CHANGES = """\
Say what is to be different, for example:
  make the second turn sharper and the end downhill
  add a left turn after the first straight, 60 degrees
  remove the last turn
Of several roads the first one is meant, unless a number stands in front. The road
as it was is kept. An empty line goes on to the next description."""

HELLO = """Describe a road, for example: an uphill road with 3 turns
Leave with 'exit' or an empty line, ask with 'help'; Ctrl-C stops the roads that are being made."""

EXPLAINED = """\
Say in plain words how the road goes: how many turns, which way, how sharp,
how long, how steep. For example:
  two hairpins, then a long straight
  a winding road downhill, 300 m long, with 5 turns, the last one to the left
  a flat road with four sharp left turns
Then say how many roads you want. What was not understood is listed before the
first road is made.
Here all options have their usual values. Options belong to 'roadgpt run', for example:
  roadgpt run "a winding road downhill" -n 20 --seed 7 --friction 0.6
'roadgpt run --help' lists them."""


def converse() -> None:
    """Ask, work off, show; until the user has had enough."""
    from roadgpt.brief import read
    from roadgpt.cli.commands.run import usual_job

    _enable_editing()
    click.echo(f"{HELLO}\n")
    while (words := _asked("description> ")) and words.lower() not in ENOUGH:
        if _wants_help(words):
            continue
        try:
            read(words)  # what cannot be read is told before a number is asked for
            roads = _how_many()
            if roads is None:
                break
            screen = Screen(roads)
            carry_out(usual_job(words, roads), screen)
            if not _changed(screen):
                break
        except RoadGPTError as error:
            click.echo(f"roadgpt: {error}", err=True)
        except KeyboardInterrupt:
            stopping.forget()  # what was finished has been said; ask for the next description
        click.echo()


def _changed(screen: Screen) -> bool:
    """Change the roads that were made for as long as the user wants; False where they have had enough."""
    from roadgpt.road import World

    roads = [row.file for row in screen.rows]
    while roads:
        answer = _asked(CHANGE if len(roads) == 1 else CHANGE_ONE)
        if not answer:
            return True
        if answer.lower() in ENOUGH:
            return False
        if answer.lower() in HELP:
            click.echo(f"{CHANGES}\n")
            continue
        number, words = _numbered(answer, len(roads))
        try:
            job = edit_job.EditJob(roads[number], words, None, "planner", World())
            roads[number] = str(edit_job.edit_road(job, Screen(1)))
        except RoadGPTError as error:
            click.echo(f"roadgpt: {error}", err=True)
    return True


def _numbered(answer: str, roads: int) -> tuple[int, str]:
    """Which of the roads, from 0, and what is to be changed: '2: make the last turn sharper'."""
    match = re.match(r"(?:road\s+)?(\d+)\s*[:,]?\s+(.*)", answer, re.IGNORECASE | re.DOTALL)
    if match and 1 <= int(match[1]) <= roads:
        return int(match[1]) - 1, match[2]
    return 0, answer


def _asked(question: str) -> str:
    """The answer without blanks around it; an empty one where there is no more input."""
    try:
        return input(question).strip()
    except EOFError:
        click.echo()
        return ""


def _wants_help(answer: str) -> bool:
    """Was help asked for? It is given then."""
    if answer.lower() not in HELP:
        return False
    click.echo(f"{EXPLAINED}\n")
    return True


def _how_many() -> int | None:
    """The number of roads; None where the user has had enough."""
    while True:
        answer = _asked(f"how many roads [{USUAL_ROADS}]> ")
        if answer.lower() in ENOUGH:
            return None
        if not answer:
            return USUAL_ROADS
        if _wants_help(answer):
            continue
        try:
            return ROADS(answer)
        except click.BadParameter as error:
            click.echo(f"roadgpt: {error.message}", err=True)


def _enable_editing() -> None:
    """Arrow keys and history, where the platform has them."""
    if sys.stdin.isatty():
        try:
            import readline  # noqa: F401  importing it is what switches it on
        except ImportError:
            return
