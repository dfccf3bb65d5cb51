"""``roadgpt`` without a command: asks for a description and a number of roads, makes the roads, asks for
changes, and asks again."""

import re
import sys
from contextlib import suppress

import click

from roadgpt import brief as reading
from roadgpt import plugins, stopping
from roadgpt.brief.plan import plan, read_plan
from roadgpt.cli.asking import asked, made_clear
from roadgpt.cli.commands import make
from roadgpt.cli.options import HOW_MANY
from roadgpt.cli.screen import Screen
from roadgpt.cli.streams import warn
from roadgpt.errors import RoadGPTError

USUAL_ROADS = 3

CHANGES = """\
Say what to change, for example:
  make the second turn sharper and the end downhill
  add a left turn after the first straight, 60 degrees
  remove the last turn
If there are several roads, start with the number of the road; otherwise the first road
is changed. The original road is kept. An empty line leads to the next description."""

HELLO = """Describe a road, for example: an uphill road with 3 turns
'help' explains more, 'exit' or an empty line leaves. Ctrl-C stops the roads that are being made."""

EXPLAINED = """\
Describe the road in plain words: how many turns, their direction and sharpness,
how long and how steep the road is. For example:
  two hairpins, then a long straight
  a winding road downhill, 300 m long, with 5 turns, the last one to the left
  a flat road with four sharp left turns
Then say how many roads you want. Words that were not used are listed before
the first road is made.
Here all options have their defaults, or what your settings say. 'roadgpt run' takes options:
  roadgpt run "a winding road downhill" -n 20 --seed 7 --friction 0.6
'roadgpt run --help' lists them."""


def converse() -> None:
    """Asks for descriptions, makes roads from them and changes roads on request, until the user quits."""
    if sys.stdin.isatty():
        with suppress(ImportError):
            import readline  # noqa: F401  importing it switches on arrow keys and history
    click.echo(f"{HELLO}\n")
    with suppress(EOFError):
        while words := asked("description> ", EXPLAINED):
            try:
                meant = _understood(words)  # reports what cannot be read, before it asks for a number
                if meant is None:
                    continue
                screen = Screen(_how_many())
                given = make.usual_values(meant or words, screen.total, is_plan=bool(meant))
                make.carry_out(screen, meant or words, **given)
                _change([row.file for row in screen.rows])
            except RoadGPTError as error:
                warn(error)
            except KeyboardInterrupt:
                stopping.forget()  # what was finished has been said; ask for the next description
            click.echo()


def _understood(words: str) -> str | None:
    """Returns the plan to build instead of the words, "" to build the words, and None if the user wants to
    say it in other words. If the reader is not sure, asks which of two readings is meant."""
    try:
        brief = reading.read(words, is_map_fixed=False)
    except reading.AnotherRoadError as error:
        click.echo(f"{error.offer}: {make.reading(error.brief)}")
        answer = asked("1 to build that, or an empty line to say it in other words> ")
        return error.plan if answer == "1" else None
    meant = brief.model_copy(update={"other": ""})
    if brief.other:
        other = read_plan(brief.other)
        click.echo(f"I am not sure what is meant:\n  1  {make.reading(brief)}\n  2  {make.reading(other)}")
        if (answer := asked("1, 2, or an empty line to say it in other words> ")) not in ("1", "2"):
            return None
        meant = meant if answer == "1" else other
    clear = made_clear(meant, of_numbers=False)
    return "" if plan(clear) == plan(brief) else plan(clear)


def _how_many() -> int:
    while True:
        answer = asked(f"how many roads [{USUAL_ROADS}]> ", EXPLAINED)
        try:
            return HOW_MANY(answer) if answer else USUAL_ROADS
        except click.BadParameter as error:
            warn(error.message)


def _change(roads: list[str]) -> None:
    if "edit" not in plugins.names("commands"):
        return  # the package that brings it is not installed
    edit: click.Command = plugins.find("commands", "edit")
    question = "change it? > " if len(roads) == 1 else "change one? (2: make the last turn sharper) > "
    while roads and (answer := asked(question, CHANGES)):
        match = re.match(r"(?:road\s+)?(\d+)\s*[:,]?\s+(.*)", answer, re.IGNORECASE | re.DOTALL)
        is_numbered = match is not None and 1 <= int(match[1]) <= len(roads)
        number, words = (int(match[1]) - 1, match[2]) if match and is_numbered else (0, answer)
        try:
            context = edit.make_context("edit", ["--", roads[number], words])
            roads[number] = str(edit.invoke(context))
        except RoadGPTError as error:
            warn(error)
