"""``roadgpt config plugins``: lists the installed plug-ins."""

import inspect
import json
import re
from dataclasses import asdict, dataclass
from typing import Any

import click

from roadgpt import plugins
from roadgpt.cli import options
from roadgpt.cli.option_groups import GroupedCommand
from roadgpt.errors import PartError


@dataclass(frozen=True)
class InstalledPlugin:
    """An installed plug-in: its kind (such as reader or driver), the package that provides it, and what it
    does.
    """

    shelf: str
    name: str
    origin: str
    about: str
    works: bool


def installed() -> list[InstalledPlugin]:
    """Returns every installed plug-in; if a plug-in cannot be loaded, its description gives the reason."""
    return [_part(shelf, name) for shelf in plugins.KINDS for name in plugins.names(shelf)]


def _part(shelf: str, name: str) -> InstalledPlugin:
    try:
        about, works = _first_sentence(plugins.find(shelf, name)), True
    except PartError as error:
        about, works = str(error), False
    return InstalledPlugin(shelf, name, plugins.origin(shelf, name), about, works)


def _first_sentence(part: Any) -> str:
    """Returns the first sentence of a plug-in's docstring, or of its module's."""
    text = inspect.getdoc(part) or inspect.getdoc(inspect.getmodule(part)) or "It has no description."
    paragraph = " ".join(text.strip().split("\n\n")[0].replace("``", "").split())
    return re.split(r"(?<=[.;:]) ", paragraph)[0].rstrip(".;:")


@click.command("plugins", cls=GroupedCommand, params=[options.json_option("Print one JSON list.")])
def plugins_command(as_json: bool) -> None:
    """List the plug-ins: readers, designers, rules, exporters, simulators, drivers and others.

    Each line shows the name to use in options, the package that provides the plug-in, and what it does.
    """
    parts = installed()
    if as_json:
        click.echo(json.dumps([asdict(part) for part in parts], indent=2))
        return
    wide = max(len(part.name) for part in parts)
    for shelf in plugins.KINDS:
        click.secho(shelf, bold=True)
        for part in parts:
            if part.shelf == shelf:
                line = f"  {part.name:<{wide}}  {part.origin:<16}  {part.about}"
                click.secho(line, fg=None if part.works else "red")
