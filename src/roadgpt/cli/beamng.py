"""The options of BeamNG; they set environment variables that the simulator and its workers read."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from roadgpt.cli import options
from roadgpt.cli.configuration import Guard, SettableOption, path_guard, place_guard
from roadgpt.cli.flags import measure, whole
from roadgpt.cli.option_groups import Decorator, under

PREFIX = "ROADGPT_BEAMNG_"  # as roadgpt.drive.simulators.beamng.settings has it
Into = Callable[[click.Context, click.Parameter, Any], None]


def _into(name: str) -> Into:
    """Returns a callback that puts an option's value into the environment."""

    def keep(ctx: click.Context, param: click.Parameter, value: Any) -> None:
        if value not in (None, False):
            os.environ[PREFIX + name] = "1" if value is True else str(value)
        elif ctx.get_parameter_source(str(param.name)) is ParameterSource.COMMANDLINE:
            os.environ.pop(PREFIX + name, None)  # --no-headless

    return keep


def _option(flag: str, name: str, help_: str, kind: Any = None, guard: Guard | None = None) -> Decorator:
    names = [flag] if kind is not None else [f"{flag}/--no-{flag[2:]}"]
    rest: dict[str, Any] = (
        {"is_flag": True, "default": False} if kind is None else {"type": kind, "default": None}
    )
    rest |= {"cls": SettableOption, "table": "beamng", "key": name.lower(), "guard": guard}
    return click.option(*names, expose_value=False, callback=_into(name), help=help_, **rest)


def folder(value: str) -> Path:
    """Converts the value of an option to the absolute path of a folder, since workers may run in another
    folder.
    """
    return options.folder(value).expanduser().absolute()


beamng_options = under(
    "BeamNG",
    _option(
        "--beamng-home", "HOME", "Start the BeamNG.tech in this folder (for --simulator beamng).", folder,
        path_guard,
    ),
    _option(
        "--beamng-user", "USER", "BeamNG's user folder; other workers get folders next to it.", folder,
        path_guard,
    ),
    _option("--beamng-host", "HOST", "Host of a BeamNG that is already running.", str, place_guard),
    _option(
        "--beamng-port", "PORT", "Port of BeamNG. [default: 25252]", whole(1, 65535, "a port"), place_guard
    ),
    _option("--beamng-level", "LEVEL", "Level in which roads are placed. [default: tig, or a flat one]", str),
    _option(
        "--beamng-aggression", "AGGRESSION", "Aggression of BeamNG's AI, 0.3 to 1. [default: 0.7]",
        measure(0.3, 1),
    ),
    _option(
        "--beamng-recycle", "RECYCLE", "Restart BeamNG after this many roads. [default: 100]",
        whole(1, 1_000_000, "a number of roads"),
    ),
    _option("--headless", "HEADLESS", "Run BeamNG without a window."),
    _option("--nogpu", "NOGPU", "Run BeamNG without rendering."),
    _option("--gfx", "GFX", "Graphics API that BeamNG uses.", click.Choice(["dx11", "vk"])),
    rare=True,
)  # fmt: skip
