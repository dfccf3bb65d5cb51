"""Writes docs/reference/commands.md from the commands' own help."""

from pathlib import Path

import click

from roadgpt.cli.app import COMMANDS, app

PAGE = Path(__file__).parent / "reference" / "commands.md"


def help_of(command: click.Command, words: str) -> str:
    """The help of a command as a person sees it."""
    context = click.Context(command, info_name=words, terminal_width=100)
    return f"```\n{command.get_help(context)}\n```\n"


def page() -> str:
    """The whole page."""
    parts = ["# Commands\n", "Written by `make docs` from the commands' own help.\n", help_of(app, "roadgpt")]
    for name in COMMANDS:
        command = app.get_command(click.Context(app), name)
        if command is not None:
            parts += [f"## roadgpt {name}\n", help_of(command, f"roadgpt {name}")]
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
