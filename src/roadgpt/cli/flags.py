"""The options that set fields of a World, a Setup or ChatSettings, and the reverse: the options that
repeat such values.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import click

from roadgpt.cli.configuration import Guard, SettableOption, designer_guard, driver_guard, reader_guard
from roadgpt.cli.option_groups import Decorator, under


def measure(low: float, high: float, unit: str = "", above: bool = False) -> Callable[[str], float]:
    """Returns the type of an option that takes a finite number within bounds.

    Args:
        low, high: The bounds, inclusive.
        unit: Unit of the number, for messages.
        above: Whether the lower bound is excluded.
    """
    bounds = f"above {low:g}, up to {high:g}" if above else f"from {low:g} to {high:g}"
    advice = f"give a number {bounds}{unit and ' ' + unit}"

    def number(value: str) -> float:
        try:
            found = float(value)
        except ValueError:
            raise click.BadParameter(f"'{value}' is no number; {advice}") from None
        if not math.isfinite(found) or not low <= found <= high or (above and found == low):
            raise click.BadParameter(f"{value} is not possible; {advice}")
        return found

    return number


def whole(low: int, high: int, what: str) -> Callable[[str], int]:
    """Returns the type of an option that takes a whole number within bounds."""
    advice = f"give {what}, a whole number from {low} to {high}"

    def number(value: str) -> int:
        try:
            found = int(value)
        except ValueError:
            raise click.BadParameter(f"'{value}' is no whole number; {advice}") from None
        if not low <= found <= high:
            raise click.BadParameter(f"{value} is not possible; {advice}")
        return found

    return number


def driver(value: str) -> str:
    """Returns the value of --driver; if it names a file, permits the file's code to be run."""
    if ".py" in value:
        from roadgpt.drive.permission import permit

        permit(value)
    return value


def driver_again(value: str) -> str:
    """Returns the value of --driver with an absolute path, so that it can be compared with a folder's
    driver.
    """
    from pathlib import Path

    from roadgpt.drive.loading import absolute_spec

    return driver(absolute_spec(value, Path.cwd()))


DESIGN, SITE, DRIVE, MODEL = "Design and check", "World", "Drive and verdict", "Language model"


@dataclass(frozen=True)
class Flag:
    """An option that sets one field of a World, a Setup or ChatSettings; a default of False makes it a
    switch.
    """

    flag: str
    field: str
    default: Any
    help: str
    kind: Any = str
    """The type with which click converts the option's value."""
    unit: float | None = None
    """Factor from the field's unit to the option's unit, such as 3.6 for m/s to km/h; None if the value is
    not a number.
    """
    heading: str = MODEL
    """The heading under which the help lists the option."""
    table: str = ""
    """The option's table in configuration files; empty for the settings of language models."""
    key: str = ""
    """The option's key in that table, if it differs from the option's name."""
    is_rare: bool = False
    """Whether only --help-all lists the option if a command has many options."""
    guard: Guard | None = None
    """Refuses values that a configuration file must not set."""

    def option(self) -> Decorator:
        """Returns a decorator that adds the option to a command's function."""
        names = [self.flag, self.field]
        rest: dict[str, Any] = {"type": self.kind, "default": self.default, "show_default": True}
        if self.default is False:
            names[0] += f"/--no-{self.flag[2:]}"
            rest = {"is_flag": True, "default": False}
        if self.table:
            rest |= {"cls": SettableOption, "table": self.table, "key": self.name, "guard": self.guard}
        return under(self.heading, click.option(*names, help=self.help, **rest), rare=self.is_rare)

    @property
    def name(self) -> str:
        """The option's key in configuration files."""
        return self.key or self.flag[2:].replace("-", "_")

    def read(self, given: Any) -> Any:
        """Returns the field's value for an option's value, converted to the field's unit."""
        return given if self.unit is None or given is None else given / self.unit

    def written(self, value: Any, usual: Any = None, is_set: bool = False) -> list[str]:
        """Returns the command-line arguments that set the field to a value; empty if the value is the
        default.

        Args:
            value: The field's value.
            usual: The field's default, if that is not the option's.
            is_set: Whether a configuration file sets the option, so that even the default has to be written
                out.
        """
        default = self.read(self.default) if usual is None else usual
        if value is None or (value == default and not is_set):
            return []
        if isinstance(value, bool):
            return [self.flag if value else f"--no-{self.flag[2:]}"]
        return [self.flag, str(value) if self.unit is None else _digits(value, self.unit)]


def _digits(value: float, unit: float) -> str:
    """Returns the shortest number, in the option's unit, that is read as exactly this value."""
    texts = [f"{value * unit:.{digits}g}" for digits in range(6, 18)]
    return next((text for text in texts if float(text) / unit == value), texts[-1])


def _of_world(flag: str, field: str, default: Any, help_: str, *rest: Any, **more: Any) -> Flag:
    return Flag(flag, field, default, help_, *rest, **{"heading": SITE, "table": "world", **more})


def _of_run(flag: str, field: str, default: Any, help_: str, *rest: Any, **more: Any) -> Flag:
    return Flag(flag, field, default, help_, *rest, **{"heading": DESIGN, "table": "run", **more})


WORLD = (
    _of_world(
        "--map-size", "map_size", 250, "Side of the square map, m.", measure(50, 10_000, "metres"), 1.0
    ),
    _of_world(
        "--speed-limit",
        "speed_limit",
        70,
        "Speed limit, km/h.",
        measure(5, 300, "km/h"),
        3.6,
        heading=DRIVE,
        key="speed_limit_kmh",
    ),
    _of_world(
        "--oob-tolerance",
        "oob_tolerance",
        0.95,
        "Share of the car that may be outside its lane.",
        measure(0, 1, above=True),
        1.0,
        heading=DRIVE,
    ),
    _of_world(
        "--lane-departure",
        "lane_departure",
        False,
        "Also fail if a front tyre crosses the lane marking.",
        heading=DRIVE,
    ),
    _of_world(
        "--lane-width", "lane_width", 4, "Width of each of the two lanes, m.", measure(2, 10, "metres"), 1.0
    ),
    _of_world(
        "--shoulder",
        "verge",
        3,
        "Width of the firm ground along each side of the road, m; 0: none.",
        measure(0, 100, "metres"),
        1.0,
        is_rare=True,
    ),
    _of_world(
        "--friction",
        "friction",
        1.0,
        "Friction: dry 1.0, wet 0.6, snow 0.35.",
        measure(0, 2, above=True),
        1.0,
    ),
)

SETUP = (
    _of_run(
        "--reader", "reader", "model", "What reads descriptions: model, grammar or chat.", guard=reader_guard
    ),
    _of_run(
        "--designer",
        "designer",
        "planner",
        "What designs roads: planner, chat or thesis.",
        guard=designer_guard,
    ),
    _of_run(
        "--driver",
        "driver",
        "beamng_like",
        "Name of a driver, or FILE.py:CLASS.",
        driver,
        heading=DRIVE,
        guard=driver_guard,
    ),
    _of_run("--simulator", "simulator", "mujoco", "What simulates the car.", heading=DRIVE),
    _of_run(
        "--keep-driving",
        "keep_driving",
        False,
        "Continue to the end after the car leaves its lane.",
        heading=DRIVE,
    ),
    _of_run(
        "--geometry",
        "geometry",
        "arcs",
        "How a design becomes a road: lines, arcs and clothoids (arcs), or the thesis' spline.",
        click.Choice(["arcs", "spline"]),
        is_rare=True,
    ),
    _of_run(
        "--rules",
        "rules",
        "strict",
        "Which rules a road must satisfy: RoadGPT's own (strict), or those of the SBFT tool competition.",
        click.Choice(["strict", "sbft"]),
        is_rare=True,
    ),
)

# Where one is not given, the environment, .env or a file of settings may say it: roadgpt.chat.config.
CHAT = (
    Flag("--model", "model", None, "Name of the model on its server."),
    Flag("--base-url", "base_url", None, "Address of the server, including /v1. [default: OpenAI's]"),
    Flag("--provider", "provider", None, "Protocol of the server. [default: openai]", is_rare=True),
    Flag(
        "--api",
        "api",
        None,
        "Chat Completions, or Responses, where the server keeps the conversation. [default: chat]",
        click.Choice(["chat", "responses"]),
        is_rare=True,
    ),
    Flag(
        "--temperature",
        "temperature",
        None,
        "Sampling temperature. [default: the server's]",
        measure(0, 2),
        1.0,
        is_rare=True,
    ),
    Flag(
        "--timeout",
        "timeout",
        None,
        "Seconds to wait for an answer. [default: 60]",
        measure(0, 86_400, "s", above=True),
        1.0,
        is_rare=True,
    ),
    Flag(
        "--retries",
        "retries",
        None,
        "Further attempts when the server fails. [default: 3]",
        whole(0, 20, "retries"),
        is_rare=True,
    ),
    Flag(
        "--max-completion",
        "max_completion",
        None,
        "Maximum number of tokens in one answer. [default: 4096]",
        whole(16, 1_000_000, "tokens"),
        is_rare=True,
    ),
    Flag(
        "--max-tokens",
        "max_tokens",
        None,
        "Stop when all roads together have used this many tokens.",
        whole(1, 10**12, "tokens"),
        is_rare=True,
    ),
    Flag(
        "--max-cost",
        "max_cost",
        None,
        "Stop when the language model has cost this many USD in all.",
        measure(0, 1e6, "USD", above=True),
        1.0,
    ),
    Flag(
        "--price",
        "price",
        None,
        "USD per million input and output tokens, such as 0.15/0.60. [default: from a table]",
        is_rare=True,
    ),
    Flag("--record", "record", None, "Save every exchange with the server in this folder.", is_rare=True),
    Flag("--replay", "replay", None, "Use the answers saved in this folder; ask no server.", is_rare=True),
    Flag(
        "--rounds",
        "rounds",
        None,
        "Maximum number of requests to the model for one road. [default: 3]",
        whole(1, 20, "rounds"),
        is_rare=True,
    ),
    Flag(
        "--repair",
        "repair",
        None,
        "How a road from a language model may be changed to become valid: none, not at all; place, only "
        "moved and turned; full, also its lengths and angles. [default: full]",
        click.Choice(["none", "place", "full"]),
        is_rare=True,
    ),
    Flag(
        "--strategy",
        "strategy",
        None,
        "Ask for the whole road, or for one segment at a time. [default: whole]",
        click.Choice(["whole", "stepwise"]),
        is_rare=True,
    ),
)
