"""Options that several commands share, and the functions that convert their values."""

from functools import reduce
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from roadgpt.cli.configuration import SettableOption
from roadgpt.cli.flags import CHAT, DRIVE, SETUP, WORLD, driver_again, measure
from roadgpt.cli.flags import whole as whole
from roadgpt.cli.option_groups import FIRST, LAST, Decorator, under
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.chat import ChatSettings
    from roadgpt.road import World

MOST_ROADS = 1_000_000
FILES, OUTPUT = "Files", LAST  # headings of help


def folder(value: str) -> Path:
    """Converts the value of an option to the path of a folder that exists or can be created."""
    if not str(value).strip():
        raise click.BadParameter("a folder without a name; give its name, or '.' for this one")
    path = Path(value)
    for place in (path, *path.parents):
        if place.is_dir():
            break
        if place.exists():
            raise click.BadParameter(f"'{place}' is a file; give the name of a folder")
    return path


ROADS = whole(1, MOST_ROADS, "the number of roads")
SEED = whole(0, 2**63 - 1, "a seed")


def together(*decorators: Decorator) -> Decorator:
    """Returns one decorator that adds several options, which the help lists in this order."""
    return lambda function: reduce(lambda made, decorate: decorate(made), reversed(decorators), function)


def world_options(*fields: str) -> Decorator:
    """Returns a decorator that adds the options for these fields of the World; without names, for all
    fields.
    """
    return together(*(flag.option() for flag in WORLD if not fields or flag.field in fields))


def world_of(values: dict[str, Any]) -> "World":
    """Returns the World that option values describe, and removes these options from ``values``."""
    from roadgpt.road import World

    return World(**{f.field: f.read(values.pop(f.field)) for f in WORLD if f.field in values})


def competition_options(oob_tolerance: float, speed_limit_kmh: float) -> Decorator:
    """Returns a decorator that adds the options --oob-tolerance and --speed-limit with a competition's own
    defaults.
    """
    return under(
        DRIVE,
        click.option(
            "--oob-tolerance",
            type=measure(0, 1, above=True),
            default=oob_tolerance,
            show_default=True,
            help="Share of the car that may be outside its lane.",
        ),
        click.option(
            "--speed-limit",
            type=measure(10, 300, "km/h"),
            default=speed_limit_kmh,
            show_default=True,
            help="Speed limit, km/h.",
        ),
    )


def setup_options(*fields: str) -> Decorator:
    """Returns a decorator that adds the options for these fields of the Setup, in this order."""
    known = {flag.field: flag for flag in SETUP}
    return together(*(known[field].option() for field in fields))


driver_again_option = under(
    DRIVE,
    click.option(
        "--driver",
        "driver",
        type=driver_again,
        metavar="FILE.py:CLASS",
        default=None,
        help="The driver's file. Give it again if the run used a driver from a file: for safety, code "
        "that only a folder names is never run.",
    ),
)


def chat_options_but(*fields: str) -> Decorator:
    """Returns a decorator that adds all options of language models except those for the given fields."""
    return together(*(flag.option() for flag in CHAT if flag.field not in fields))


chat_options = chat_options_but()


def chat_of(values: dict[str, Any], reader: str = "", designer: str = "") -> "ChatSettings | None":
    """Returns the settings of the language model, and removes their options from ``values``.

    Returns None if neither the reader nor the designer uses a language model.

    Raises:
        UsageError: An option of language models is given but no language model is used, or a setting is
            invalid.
    """
    given = {flag: flag.read(values.pop(flag.field, None)) for flag in CHAT}
    told = {flag.field: value for flag, value in given.items() if value is not None}
    from roadgpt import plugins
    from roadgpt.chat import asks_a_model, configured

    shelves = (("readers", reader), ("designers", designer))
    if any(asks_a_model(plugins.find(shelf, name.partition(":")[0])) for shelf, name in shelves if name):
        return configured(told)
    if told:
        flag = next(flag for flag, value in given.items() if value is not None)
        advice = " or ".join(
            f"--{part} chat" for part, name in (("designer", designer), ("reader", reader)) if name
        )
        raise UsageError(f"{flag.flag} is for language models; give {advice} as well")
    return None


def formats(value: str | tuple[str, ...]) -> tuple[str, ...]:
    """Converts comma-separated names of formats to a tuple of names."""
    if isinstance(value, tuple):
        return value
    names = tuple(name.strip() for name in value.split(",") if name.strip())
    if not names:
        raise click.BadParameter("no format is given; 'roadgpt config plugins' lists the exporters")
    return names


def formats_option(flag: str, required: bool = False, is_settable: bool = False) -> Decorator:
    """Returns a decorator that adds an option for formats of road files, which can be comma-separated or
    repeated.
    """
    settable: dict[str, Any] = {"cls": SettableOption, "table": "run", "key": flag[2:]} if is_settable else {}
    return under(
        FILES if is_settable else FIRST,
        click.option(
            flag,
            "formats",
            type=formats,
            metavar="FORMAT,...",
            multiple=True,
            required=required,
            callback=lambda ctx, param, given: tuple(dict.fromkeys(name for some in given for name in some)),
            help="Also write road files: opendrive, csv, ..."
            if is_settable
            else "Formats to write: opendrive, csv, ...; 'roadgpt config plugins' lists them.",
            **settable,
        ),
    )


PICTURES = ("png", "svg", "pdf")  # as report.FORMATS has them, which would load matplotlib


def picture_formats(value: str | tuple[str, ...]) -> tuple[str, ...]:
    """Converts comma-separated names of picture formats to a tuple of names."""
    names = value if isinstance(value, tuple) else tuple(name.strip().lower() for name in value.split(","))
    for name in names:
        if name not in PICTURES:
            raise click.BadParameter(
                f"'{name}' is no format of pictures; give {', '.join(PICTURES)}, or several"
            )
    return tuple(dict.fromkeys(names))


format_option = under(
    FILES,
    click.option(
        "--format",
        "picture_formats",
        type=picture_formats,
        default=("png",),
        metavar="FORMAT,...",
        help="Formats of pictures: png, svg, pdf. [default: png]",
        cls=SettableOption,
        table="run",
        key="format",
    ),
)

axes_option = under(
    FILES,
    click.option(
        "--axes",
        type=click.Choice(["equal", "thesis"]),
        default="equal",
        show_default=True,
        help="Axes of pictures: equal, to scale; or thesis, with the ranges of RoadGPT's thesis: 220 m by "
        "220 m seen from above, 200 m by 20 m for the height.",
        cls=SettableOption,
        table="run",
        key="axes",
    ),
    rare=True,
)
pictures_options = together(axes_option, format_option)
no_drive_option = under(DRIVE, click.option("--no-drive", is_flag=True, help="Do not drive the roads."))
no_plot_option = under(FILES, click.option("--no-plot", is_flag=True, help="Draw no pictures."))
quiet_option = under(OUTPUT, click.option("--quiet", "-q", is_flag=True, help="Print errors only."))

screen_options = under(
    OUTPUT,
    click.option("--json", "as_json", is_flag=True, help="Print one JSON line per road."),
    click.option("--quiet", "-q", is_flag=True, help="Print errors only."),
    click.option("--verbose", "-v", is_flag=True, help="Print details: requirements, versions, times."),
)

files_argument = click.argument("files", nargs=-1, required=True, metavar="ROAD...")
