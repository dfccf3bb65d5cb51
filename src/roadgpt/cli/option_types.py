"""Converts and checks the texts of options: numbers within bounds, folders, files, drivers and formats."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import click

N = TypeVar("N", int, float)
PICTURES = ("png", "svg", "pdf")  # as report.FORMATS has them, which would load matplotlib


def measure(low: float, high: float, unit: str = "", above: bool = False) -> Callable[[str], float]:
    """Returns the type of an option that takes a finite number from ``low`` to ``high``. If ``above`` is
    True, ``low`` itself is not allowed. Messages show the unit.
    """
    bounds = f"above {low:g}, up to {high:g}" if above else f"from {low:g} to {high:g}"
    return _number(float, "number", low, high, f"give a number {bounds}{unit and ' ' + unit}", above)


def whole(low: int, high: int, what: str) -> Callable[[str], int]:
    """Returns the type of an option that takes a whole number within bounds, which are included.

    ``what`` says in messages what the number is or counts, such as 'a seed' or 'metres'.
    """
    return _number(int, "whole number", low, high, f"give {what}, a whole number from {low} to {high}")


def _number(
    kind: Callable[[str], N], name: str, low: N, high: N, advice: str, above: bool = False
) -> Callable[[str], N]:
    def number(value: str) -> N:  # click shows this name in the help
        try:
            found = kind(value)
        except ValueError:
            raise click.BadParameter(f"'{value}' is no {name}; {advice}") from None
        if not low <= found <= high or (above and found == low):
            raise click.BadParameter(f"{value} is not possible; {advice}")
        return found

    return number


def lanes(value: str) -> str:
    """Checks a text such as '2+1': the number of lanes along the road, and the number of oncoming lanes."""
    from roadgpt.road.world import lanes_in

    try:
        return lanes_in(value)
    except ValueError as error:
        raise click.BadParameter(f"'{value}' is not possible; {error}") from None


def bank(value: str) -> str | float:
    """Converts a superelevation to a number in percent; returns "none" and "auto" unchanged."""
    text = str(value).strip().removesuffix("%").strip()
    if text in ("none", "auto"):
        return text
    try:
        return measure(0, 12, "percent")(text)
    except click.BadParameter as error:
        raise click.BadParameter(f"{error.message}, or none, or auto") from None


ROADS = whole(1, 1_000_000, "the number of roads")
SEED = whole(0, 2**63 - 1, "a seed")
PATH = click.Path(path_type=Path)


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


def file(value: str) -> Path:
    """Converts the value of an option to the path of a file that can be written."""
    path = Path(value)
    if not str(value).strip() or path.is_dir():
        raise click.BadParameter(f"'{value}' is a folder; give the name of a file, such as roads.xml")
    if not path.absolute().parent.is_dir():
        raise click.BadParameter(f"there is no folder {path.absolute().parent}; make it first")
    return path


def driver(value: str) -> str:
    """Returns the value of --driver; of a driver's file with an absolute path, so that it is found from any
    folder, and permits its code to be run."""
    if ".py" not in value:
        return value
    from roadgpt.drive.loading import absolute_spec
    from roadgpt.drive.permission import permit

    permit(found := absolute_spec(value, Path.cwd()))
    return found


def drivers(value: str) -> tuple[str, ...]:
    """Returns the drivers in a value of --drivers, separated by commas, as ``driver`` does."""
    is_file = Path(f"{value.rpartition('.py')[0]}.py").is_file()  # whose path may have commas
    return tuple(driver(name.strip()) for name in ((value,) if is_file else value.split(",")))


def formats(value: str | tuple[str, ...]) -> tuple[str, ...]:
    """Converts comma-separated names of road formats to a tuple of names."""
    if isinstance(value, tuple):
        return value
    names = tuple(name.strip() for name in value.split(",") if name.strip())
    if not names:
        raise click.BadParameter("no format is given; 'roadgpt config plugins' lists the exporters")
    return names


def gate_rules(value: str | tuple[str, ...]) -> tuple[str, ...]:
    """Converts comma-separated rules, such as 'error,10%', to a tuple."""
    rules = value if isinstance(value, tuple) else tuple("".join(value.split()).upper().split(","))
    for rule in rules:
        if not re.fullmatch(r"FAIL|INVALID|ERROR|(\d{1,2}(\.\d+)?|100)%", rule, re.ASCII):
            raise click.BadParameter(f"'{rule}' is not possible; give fail, invalid, error or N%, as 10%")
    return rules


def picture_formats(value: str | tuple[str, ...]) -> tuple[str, ...]:
    """Converts comma-separated names of picture formats to a tuple of names."""
    names = value if isinstance(value, tuple) else tuple(name.strip().lower() for name in value.split(","))
    for name in names:
        if name not in PICTURES:
            raise click.BadParameter(
                f"'{name}' is no format of pictures; give {', '.join(PICTURES)}, or several"
            )
    return tuple(dict.fromkeys(names))
