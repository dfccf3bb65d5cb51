"""Options of BeamNG: what they say goes into the environment, where the simulator and its workers find it."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from roadgpt.cli import options
from roadgpt.cli.flags import measure, whole
from roadgpt.cli.options import Decorator, together

PREFIX = "ROADGPT_BEAMNG_"  # as roadgpt.drive.simulators.beamng.settings has it
Into = Callable[[click.Context, click.Parameter, Any], None]


def _into(name: str) -> Into:
    """What keeps an option's value in the environment."""

    def keep(ctx: click.Context, param: click.Parameter, value: Any) -> None:
        if value not in (None, False):
            os.environ[PREFIX + name] = "1" if value is True else str(value)

    return keep


def _option(flag: str, name: str, help_: str, kind: Any = None) -> Decorator:
    rest: dict[str, Any] = {"is_flag": True} if kind is None else {"type": kind, "default": None}
    return click.option(flag, expose_value=False, callback=_into(name), help=help_, **rest)


def folder(value: str) -> Path:
    """The type of an option that takes a folder; kept whole, since workers may stand elsewhere."""
    return options.folder(value).expanduser().absolute()


beamng_options = together(
    _option("--beamng-home", "HOME", "BeamNG.tech's folder: start it. For --simulator beamng.", folder),
    _option("--beamng-user", "USER", "Its user folder; further workers get folders beside it.", folder),
    _option("--beamng-host", "HOST", "Where a BeamNG runs that is not to be started.", str),
    _option("--beamng-port", "PORT", "Of BeamNG. [default: 25252]", whole(1, 65535, "a port")),
    _option("--beamng-level", "LEVEL", "Where roads are laid. [default: tig, or a flat one]", str),
    _option("--beamng-aggression", "AGGRESSION", "Of BeamNG's AI, 0.3 to 1. [default: 0.7]", measure(0.3, 1)),
    _option(
        "--beamng-recycle",
        "RECYCLE",
        "Roads after which BeamNG is started anew. [default: 100]",
        whole(1, 1_000_000, "a number of roads"),
    ),
    _option("--headless", "HEADLESS", "BeamNG without a window."),
    _option("--nogpu", "NOGPU", "BeamNG without drawing anything."),
    _option("--gfx", "GFX", "What BeamNG draws with.", click.Choice(["dx11", "vk"])),
)
