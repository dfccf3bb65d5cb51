"""``roadgpt config``: which language model is asked, and which file or variable says so."""

import json
from typing import Any

import click

from roadgpt.cli.flags import CHAT
from roadgpt.cli.options import chat_options


@click.group()
def command() -> None:
    """Tell which language model is asked, and where each setting comes from."""


@command.command()
@click.option("--origin", "with_origin", is_flag=True, help="Also where each setting was found.")
@click.option("--json", "as_json", is_flag=True, help="As one JSON object.")
@chat_options
def show(with_origin: bool, as_json: bool, **values: Any) -> None:
    """Show the settings that hold now; keys are masked.

    What is given as an option counts most, then the environment (ROADGPT_MODEL and so on, OPENAI_BASE_URL,
    OPENAI_API_KEY), then a file .env in this folder, then roadgpt.toml in this folder, then the user's own
    roadgpt/config.toml.
    """
    from roadgpt.chat.config import key_for, settings_from, settings_with_origin, unknown_variables

    found = settings_with_origin({flag.field: flag.read(values[flag.field]) for flag in CHAT})
    settings = settings_from(found)
    key = key_for(settings.base_url)
    rows = [(name, getattr(settings, name), setting.origin) for name, setting in found.items()]
    rows.append(("api_key", str(key) if key else None, key.origin if key else "nowhere"))
    if as_json:
        told = {
            name: {"value": value, "origin": origin} if with_origin else value for name, value, origin in rows
        }
        click.echo(json.dumps(told, indent=2))
        return
    wide = max(len(name) for name, _, _ in rows)
    far = max(len(str(value)) for _, value, _ in rows)
    for name, value, origin in rows:
        shown = "-" if value is None else str(value)
        click.echo(f"{name:<{wide}}  {shown:<{far}}  {origin}" if with_origin else f"{name:<{wide}}  {shown}")
    for name in unknown_variables():
        click.echo(f"roadgpt: {name} is no setting; there are those above", err=True)
