"""Writes docs/reference/commands.md from the commands' own help, in the order of the headings."""

from pathlib import Path

import click

from roadgpt.cli.app import app, headings
from roadgpt.cli.options import ALL

PAGE = Path(__file__).parent / "reference" / "commands.md"


def help_of(command: click.Command, name: str, parent: click.Context | None = None) -> str:
    """Returns the help of a command as ``--help-all`` prints it."""
    settings = command.context_settings | {"terminal_width": 100, "max_content_width": 100}
    context = click.Context(command, parent, name, **settings)
    context.meta[ALL] = True
    return f"```\n{command.get_help(context)}\n```\n"


def page() -> str:
    """Returns the whole page."""
    parts = [
        "# Commands\n",
        "Written by `make docs` from the commands' own help. `--help` lists the options that are used often, "
        "`--help-all` all of those\nbelow.\n",
        help_of(app, "roadgpt"),
    ]
    group = click.Context(app, info_name="roadgpt", **app.context_settings)
    for heading, commands in headings().items():
        parts.append(f"## {heading}\n")
        for name in commands:
            command = app.get_command(group, name)
            assert command is not None
            parts += [f"### roadgpt {name}\n", help_of(command, name, group)]
            if isinstance(command, click.Group):
                parts += inside(command, click.Context(command, group, name))
    return "\n".join(parts)


def inside(command: click.Group, context: click.Context) -> list[str]:
    """Returns the help of all commands in a group, groups in it included."""
    parts: list[str] = []
    for own, its in command.commands.items():
        parts.append(help_of(its, own, context))
        if isinstance(its, click.Group):
            parts += inside(its, click.Context(its, context, own))
    return parts


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
