"""The options that describe a World and a Setup, in one table: commands take them, and replays write them."""

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


@dataclass(frozen=True)
class Flag:
    """One option that sets one field of the World or of the Setup; a default of False makes a switch."""

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
        return given if self.unit is None else given / self.unit

    def written(self, value: Any) -> list[str]:
        """The words of the command line that set the field; none where the default does."""
        if value == self.read(self.default):
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
    Flag("--driver", "driver", "beamng_like", "Who drives: a name, or FILE.py:CLASS."),
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
