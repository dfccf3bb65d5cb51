"""Options that commands share, and types of values whose complaints are advice."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from roadgpt.road import World

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]

MOST_ROADS = 1_000_000


def measure(low: float, high: float, unit: str = "", above: bool = False) -> Callable[[str], float]:
    """The type of an option that takes a finite number within bounds; above: the lower bound is excluded."""
    start = "more than" if above else "from"
    advice = f"give a number {start} {low:g} to {high:g}{unit and ' ' + unit}"

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


def folder(value: str) -> Path:
    """The type of an option that takes a folder which exists or can be made."""
    path = Path(value)
    for place in (path, *path.parents):
        if place.is_dir():
            break
        if place.exists():
            raise click.BadParameter(f"'{place}' is a file; give the name of a folder")
    return path


ROADS = whole(1, MOST_ROADS, "the number of roads")
SEED = whole(0, 2**63 - 1, "a seed")


@dataclass(frozen=True)
class Setting:
    """One option that sets one field of the World."""

    flag: str
    field: str
    kind: Callable[[str], float]
    default: float
    help: str
    divisor: float = 1.0
    """How many of the option's unit one unit of the field is."""


WORLD = (
    Setting("--map-size", "map_size", measure(50, 10_000, "metres"), 250, "Side of the square map, metres."),
    Setting(
        "--speed-limit", "speed_limit", measure(5, 300, "km/h"), 70, "For the driver, km/h.", divisor=3.6
    ),
    Setting(
        "--oob-tolerance",
        "oob_tolerance",
        measure(0, 1, above=True),
        0.95,
        "Share of the car that may be outside its lane.",
    ),
    Setting(
        "--verge",
        "verge",
        measure(0, 100, "metres"),
        3,
        "Firm ground beside the road, metres; 0: a floating mesh, as in RoadGPT.",
    ),
    Setting(
        "--friction",
        "friction",
        measure(0, 2, above=True),
        1.0,
        "Of the road: dry 1.0, wet 0.6, snow 0.35.",
    ),
)


def together(*decorators: Decorator) -> Decorator:
    """Several options as one decorator, listed in help in this order."""
    return lambda function: reduce(lambda made, decorate: decorate(made), reversed(decorators), function)


def world_options(*fields: str) -> Decorator:
    """Options that set fields of the World, all of them where none is named."""
    return together(
        *(
            click.option(s.flag, s.field, type=s.kind, default=s.default, show_default=True, help=s.help)
            for s in WORLD
            if not fields or s.field in fields
        )
    )


def world_of(values: dict[str, Any]) -> "World":
    """The World that the options describe; takes them out of ``values``."""
    from roadgpt.road import World

    return World(**{s.field: values.pop(s.field) / s.divisor for s in WORLD if s.field in values})


def part_option(shelf: str, default: str, text: str) -> Decorator:
    """An option that names a part on a shelf."""
    return click.option(f"--{shelf.removesuffix('s')}", default=default, show_default=True, help=text)


drive_options = together(
    part_option("drivers", "beamng_like", "Who drives: a name, or FILE.py:CLASS."),
    part_option("simulators", "mujoco", "What simulates the car."),
    click.option(
        "--keep-driving", is_flag=True, help="Go on after the car has left its lane, to the end of the road."
    ),
)

geometry_option = click.option(
    "--geometry",
    type=click.Choice(["arcs", "spline"]),
    default="arcs",
    show_default=True,
    help="What a design becomes: lines, arcs and clothoids, or RoadGPT's spline through hops.",
)

rules_option = click.option(
    "--rules",
    type=click.Choice(["strict", "sbft"]),
    default="strict",
    show_default=True,
    help="Is the road sound, or what would the SBFT tool competition's validator say?",
)

axes_option = click.option(
    "--axes",
    type=click.Choice(["equal", "thesis"]),
    default="equal",
    show_default=True,
    help="Of the pictures: to scale, or RoadGPT's fixed 220 m by 220 m and 200 m by 20 m.",
)

screen_options = together(
    click.option("--json", "as_json", is_flag=True, help="One JSON line per road on standard output."),
    click.option("--quiet", "-q", is_flag=True, help="Say nothing but errors."),
    click.option("--verbose", "-v", is_flag=True, help="Say more: brief, versions, times."),
)

files_argument = click.argument("files", nargs=-1, required=True, metavar="ROAD.json...")
