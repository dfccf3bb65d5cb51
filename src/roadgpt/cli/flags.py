"""The options of a World, a Setup and a language model: commands take them, and replays write them."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import click


def measure(low: float, high: float, unit: str = "", above: bool = False) -> Callable[[str], float]:
    """The type of an option that takes a finite number within bounds; above: the lower bound is excluded."""
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
    """The type of an option that takes a whole number within bounds."""
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
    """The type of an option that names a driver: whoever types it may have its code run."""
    if ".py" in value:
        from roadgpt.drive.trust import named

        named(value)
    return value


def driver_again(value: str) -> str:
    """The same, for what a file names: as a path that holds from anywhere."""
    from pathlib import Path

    from roadgpt.drive.custom import located

    return driver(located(value, Path.cwd()))


@dataclass(frozen=True)
class Flag:
    """One option for one field of a World, a Setup or ChatSettings; a default of False makes a switch."""

    flag: str
    field: str
    default: Any
    help: str
    kind: Any = str
    """What click makes of its value."""
    unit: float | None = None
    """How many of the option's unit one unit of the field is; None where it is no number."""

    def option(self) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
        """As a decorator of a command."""
        if self.default is False:
            return click.option(self.flag, self.field, is_flag=True, help=self.help)
        return click.option(
            self.flag, self.field, type=self.kind, default=self.default, show_default=True, help=self.help
        )

    def read(self, given: Any) -> Any:
        """The field's value for what the option was given."""
        return given if self.unit is None or given is None else given / self.unit

    def written(self, value: Any, usual: Any = None) -> list[str]:
        """The words of the command line that set the field; none where it is as usual."""
        if value is None or value == (self.read(self.default) if usual is None else usual):
            return []
        if value is True:
            return [self.flag]
        return [self.flag, str(value) if self.unit is None else _digits(value, self.unit)]


def _digits(value: float, unit: float) -> str:
    """The shortest number, in the option's unit, that is read as this very value."""
    texts = [f"{value * unit:.{digits}g}" for digits in range(6, 18)]
    return next((text for text in texts if float(text) / unit == value), texts[-1])


WORLD = (
    Flag(
        "--map-size", "map_size", 250, "Side of the square map, metres.", measure(50, 10_000, "metres"), 1.0
    ),
    Flag("--speed-limit", "speed_limit", 70, "For the driver, km/h.", measure(5, 300, "km/h"), 3.6),
    Flag(
        "--oob-tolerance",
        "oob_tolerance",
        0.95,
        "Share of the car that may be outside its lane.",
        measure(0, 1, above=True),
        1.0,
    ),
    Flag(
        "--lane-departure",
        "lane_departure",
        False,
        "Fail, too, where the outer edge of a front tyre passes the outer edge of a lane marking (UN R157).",
    ),
    Flag(
        "--lane-width",
        "lane_width",
        4,
        "Of each of the two lanes, metres.",
        measure(2, 10, "metres"),
        1.0,
    ),
    Flag(
        "--verge",
        "verge",
        3,
        "Firm ground beside the road, metres; 0: a floating mesh, as in RoadGPT.",
        measure(0, 100, "metres"),
        1.0,
    ),
    Flag(
        "--friction",
        "friction",
        1.0,
        "Of the road: dry 1.0, wet 0.6, snow 0.35.",
        measure(0, 2, above=True),
        1.0,
    ),
)

SETUP = (
    Flag("--reader", "reader", "model", "What reads the description: model, or grammar, by rules."),
    Flag("--designer", "designer", "planner", "What designs the roads."),
    Flag("--driver", "driver", "beamng_like", "Who drives: a name, or FILE.py:CLASS.", driver),
    Flag("--simulator", "simulator", "mujoco", "What simulates the car."),
    Flag(
        "--keep-driving",
        "keep_driving",
        False,
        "Go on after the car has left its lane, to the end of the road.",
    ),
    Flag(
        "--geometry",
        "geometry",
        "arcs",
        "What a design becomes: lines, arcs and clothoids, or RoadGPT's spline through hops.",
        click.Choice(["arcs", "spline"]),
    ),
    Flag(
        "--rules",
        "rules",
        "strict",
        "Is the road sound, or what would the SBFT tool competition's validator say?",
        click.Choice(["strict", "sbft"]),
    ),
)

# Where one is not given, the environment, .env or a file of settings may say it: roadgpt.chat.config.
CHAT = (
    Flag("--model", "model", None, "Language model, as its server calls it."),
    Flag("--base-url", "base_url", None, "Of the server, up to /v1. [default: OpenAI's]"),
    Flag("--provider", "provider", None, "How the server is spoken to. [default: openai]"),
    Flag(
        "--api",
        "api",
        None,
        "Chat Completions, or Responses with a conversation kept by the server. [default: chat]",
        click.Choice(["chat", "responses"]),
    ),
    Flag("--temperature", "temperature", None, "Of the model. [default: its own]", measure(0, 2), 1.0),
    Flag(
        "--timeout",
        "timeout",
        None,
        "Seconds for an answer. [default: 60]",
        measure(0, 86_400, "s", above=True),
        1.0,
    ),
    Flag("--retries", "retries", None, "When the server fails. [default: 3]", whole(0, 20, "retries")),
    Flag(
        "--max-completion",
        "max_completion",
        None,
        "Tokens of one answer. [default: 4096]",
        whole(16, 1_000_000, "tokens"),
    ),
    Flag(
        "--max-tokens",
        "max_tokens",
        None,
        "Of all roads together; then it stops.",
        whole(1, 10**12, "tokens"),
    ),
    Flag(
        "--max-cost",
        "max_cost",
        None,
        "USD, of all roads together; then it stops.",
        measure(0, 1e6, "USD", above=True),
        1.0,
    ),
    Flag("--price", "price", None, "USD per million tokens asked/answered, as 0.15/0.60. [default: a table]"),
    Flag("--record", "record", None, "Folder in which every exchange is kept."),
    Flag("--replay", "replay", None, "Folder whose exchanges are taken instead of asking."),
    Flag("--rounds", "rounds", None, "Questions for one road, at most. [default: 3]", whole(1, 20, "rounds")),
    Flag(
        "--repair",
        "repair",
        None,
        "Of the model's roads: none; move and turn them; also change lengths and angles. [default: full]",
        click.Choice(["none", "place", "full"]),
    ),
    Flag(
        "--strategy",
        "strategy",
        None,
        "Ask for the whole road, or segment by segment. [default: whole]",
        click.Choice(["whole", "stepwise"]),
    ),
)
