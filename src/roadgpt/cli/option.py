"""Options of commands: their texts, kinds of values, defaults, and keys in configuration files and the
environment; ``roadgpt config show`` lists those, and its help says which source precedes which.

A working folder may come from somebody else. Therefore its files cannot specify a driver's file, a program, a
server or a plug-in that uses a language model: the user has to give such a value as an option."""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import copy
from enum import StrEnum
from functools import partial
from math import inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.chat.config import Layer, Setting

OF_FOLDER, OF_USER, OF_ENVIRONMENT = "folder", "user", "environment"
YOURSELF = "a file of this folder cannot decide that; say it yourself with the option"
WHOLE_PATH = "give the whole path, from the root of the disk"
Guard = Callable[[str, str], str]
"""Takes a value and its source, such as ``OF_FOLDER``, and says why it is refused; empty if it is not."""


def driver_guard(value: str, place: str) -> str:
    """Refuses a driver's file that a file in the working folder names, or whose path is relative."""
    if ".py" not in value:
        return ""
    if place == OF_FOLDER:
        return f"code is not run because a file names it; if you trust it, name it yourself: --driver {value}"
    path = value.rpartition(".py")[0]
    return "" if Path(path).is_absolute() else WHOLE_PATH


def place_guard(value: str, place: str) -> str:
    """Refuses a value, such as a host, from a file in the working folder."""
    del value
    return YOURSELF if place == OF_FOLDER else ""


def path_guard(value: str, place: str) -> str:
    """Refuses every path from a file in the working folder, and relative paths from the user's own file."""
    if place == OF_USER and not Path(value).expanduser().is_absolute():
        return WHOLE_PATH
    return place_guard(value, place)


def _plugin_guard(kind: str, value: str, place: str) -> str:
    from roadgpt import plugins
    from roadgpt.chat import asks_a_model

    name, colon, _ = value.partition(":")
    if place == OF_FOLDER and (colon or asks_a_model(plugins.find(kind, name))):
        return YOURSELF
    return ""


reader_guard, designer_guard = partial(_plugin_guard, "readers"), partial(_plugin_guard, "designers")


class Heading(StrEnum):
    """The headings under which the help lists options, in the order of the help."""

    FIRST = "Options"
    DESIGN = "Design and check"
    SITE = "World"
    DRIVE = "Drive and verdict"
    AGAIN = "Tests of a campaign"
    FILES = "Files"
    FAILURES = "Failures"
    WORKERS = "Workers"
    GATE = "Continuous integration"
    MODEL = "Language model"
    SIMULATOR = "Simulators"
    OUTPUT = "Output and help"


# keys of click's Context.meta: the settings that a command takes from files, and the function that reads all
FROM_FILES, LAYERS = "roadgpt.from_files", "roadgpt.layers"


class Option(click.Option):
    """A command-line option that can also be set in files, and appears in the commands that RoadGPT prints.
    Several commands can share one Option.

    Args:
        names: The names of the option, separated by blanks, and the name of the function's argument if it
            differs.
        sentence: The option's text in the help.
        kind: A click type, or a function that converts the text; ``bool`` makes a switch.
        default: The value if the option is not given; the help shows it unless ``sentence`` states a default.
        heading: The heading under which the help lists the option.
        is_rare: Whether only --help-all lists the option, of a command with many.
        table: The table of configuration files in which the option can be set; empty if files cannot set it.
            A switch that files can set also gets an opposite switch, like --no-lane-departure.
        key: The option's key in that table; empty if it is the option's first name.
        guard: A function that refuses values which a configuration file must not set.
        unit: Factor that converts the field's value to the option's value, such as 3.6 from m/s to km/h.
        advice: A sentence that says what to type if the option is required and missing."""

    def __init__(
        self, names: str, sentence: str, kind: Any = None, default: Any = None, *,
        heading: Heading = Heading.FIRST, is_rare: bool = False, table: str = "", key: str = "",
        guard: Guard | None = None, unit: float = 1.0,
        advice: str = "", **rest: Any,
    ) -> None:  # fmt: skip
        first, *others = names.split()
        if kind is bool:
            kind, default, rest["is_flag"] = None, False, True
            names = " ".join([f"{first}/--no-{first[2:]}" if table else first, *others])
        shows = default not in (None, "") and default is not False and "[default:" not in sentence
        usual = {} if rest.get("required") else {"default": default}
        super().__init__(names.split(), help=sentence, type=kind, **usual, **{"show_default": shows, **rest})
        self.flag = next((name for name in self.opts if name.startswith("--")), first)
        self.heading, self.is_rare, self.table = heading, is_rare, table
        self.key, self.guard, self.unit = key or self.flag[2:].replace("-", "_"), guard, unit
        self.advice = advice

    def but(self, **values: Any) -> "Option":
        """Returns a copy of this option, which is not rare, with other attributes."""
        twin = copy(self)
        vars(twin).update(is_rare=False, **values)
        return twin

    @property
    def field(self) -> str:
        """Name of the field that the option sets, and of the function's argument."""
        return str(self.name)

    def read(self, given: Any) -> Any:
        """Converts a value of the option to the unit of the field, such as km/h to m/s."""
        return given if given is None or isinstance(given, str) or self.unit == 1.0 else given / self.unit

    def written(self, value: Any, usual: Any = None, is_set: bool = False) -> list[str]:
        """Returns the arguments that give the field a value. The default (or ``usual`` in its place) needs
        none, except if a file or the environment sets the option (``is_set``)."""
        default = self.read(self.default) if usual is None else usual
        if value is None or (value == default and not is_set):
            return []
        if isinstance(value, bool):
            return [self.flag if value else f"--no-{self.flag[2:]}"]
        if isinstance(value, tuple):
            texts = value if self.multiple else [",".join(value)]
            return [word for text in texts for word in (self.flag, text)]
        return [self.flag, _digits(value, self.unit) if isinstance(value, float) else str(value)]

    @property
    def variable(self) -> str:
        """The name of the option's environment variable."""
        return f"ROADGPT_{self.setting_name.upper()}"

    @property
    def setting_name(self) -> str:
        """The option's name in ``roadgpt config show``: its key, after the name of a simulator."""
        return self.key if self.table in ("", "run", "world") else f"{self.table}_{self.key}"

    def consume_value(self, ctx: click.Context, opts: Any) -> tuple[Any, ParameterSource]:
        """Returns the unconverted value and its source; a value on the command line takes precedence."""
        value, source = super().consume_value(ctx, opts)
        setting = self.found(ctx.meta[LAYERS]()) if self.table and source is ParameterSource.DEFAULT else None
        if setting is None:
            return value, source
        ctx.meta.setdefault(FROM_FILES, {})[self.name] = (self, setting)
        return setting.value, ParameterSource.DEFAULT_MAP

    def process_value(self, ctx: click.Context, value: Any) -> Any:
        """Returns the converted value."""
        own, setting = ctx.meta.get(FROM_FILES, {}).get(self.name, (None, None))
        if own is not self:
            return super().process_value(ctx, value)
        with self._naming(setting.origin):
            return super().process_value(ctx, value)

    def converted(self, ctx: click.Context, setting: "Setting") -> Any:
        """Returns the value of a setting, converted to the option's type."""
        with self._naming(setting.origin):
            return self.type_cast_value(ctx, setting.value)

    def found(self, layers: "Sequence[Layer]") -> "Setting | None":
        """Returns the Setting from the first of the layers that sets the option; None if none does."""
        from roadgpt.chat.config import FOLDER, Setting

        for layer in layers:
            setting = layer.find(self.table, self.key, self.variable)
            if setting is None:
                continue
            with self._naming(setting.origin):
                value = self._text(setting.value)
            place = OF_FOLDER if layer.name in FOLDER else OF_USER if layer.tables else OF_ENVIRONMENT
            for one in value if isinstance(value, tuple) else (value,):
                if self.guard and (refusal := self.guard(str(one), place)):
                    raise UsageError(f"{setting.origin} says {self.key} = {one}: {refusal}")
            return Setting(value, setting.origin)
        return None

    def _text(self, value: Any) -> Any:
        if self.is_flag:
            if isinstance(value, bool | str):
                return value
            raise click.BadParameter("give true or false")
        listed = value if isinstance(value, list) else [value]
        if any(isinstance(each, bool) or not isinstance(each, str | int | float) for each in listed):
            raise click.BadParameter("give a text or a number")
        if len(listed) > 1 and not self.multiple and self.key != "format":
            raise click.BadParameter("give one value")
        texts = tuple(str(each) for each in listed)
        return texts if self.multiple else ",".join(texts)

    @contextmanager
    def _naming(self, origin: str) -> Iterator[None]:
        try:
            yield
        except click.BadParameter as error:
            why = error.message.rstrip(".")
            raise UsageError(f"the setting '{self.key}' from {origin} cannot be used: {why}") from None


class Argument(click.Argument):
    """An argument of a command, with ``advice`` for a user who left it out. ``name`` is that of the
    function's argument, followed by "..." if the argument takes several values."""

    def __init__(
        self, name: str, metavar: str, advice: str = "", kind: Any = None, required: bool = True
    ) -> None:
        own = name.removesuffix("...")
        many = -1 if own != name else 1
        super().__init__([own], nargs=many, required=required, metavar=metavar, type=kind)
        self.advice = advice


def named(options: Sequence[Option], *fields: str) -> list[Option]:
    """Returns the options that set these fields, in the order of the fields."""
    by_field = {option.field: option for option in options}
    return [by_field[field] for field in fields]


def words_of(
    options: Sequence[Option],
    values: Mapping[str, Any],
    usual: Mapping[str, Any] | None = None,
    told: Sequence[str] | set[str] = (),
) -> list[str]:
    """Returns the arguments that give options these values, by the names of the fields. Those with their
    default, or that in ``usual``, are left out, unless ``told`` has the option's key."""
    return [
        word
        for option in options
        for word in option.written(
            values.get(option.field), (usual or {}).get(option.field), option.key in told
        )
    ]


def _digits(value: float, unit: float) -> str:
    """Returns the shortest text of a number that is read as exactly this value."""
    texts = [f"{value * unit:.{digits}g}" for digits in range(6, 18)]
    return next((text for text in texts if float(text) / unit == value), texts[-1])


PICTURES = ("png", "svg", "pdf")  # as report.FORMATS has them, which would load matplotlib


def measure(low: float, high: float, unit: str = "", above: bool = False) -> Callable[[str], float]:
    """Returns the type of an option for a finite number from ``low`` to ``high``, or ``above`` ``low``."""
    return number(float, low, high, above, unit=unit)


def whole(low: int, high: int, what: str) -> Callable[[str], int]:
    """Returns the type of an option for a whole number within bounds; ``what`` it is, such as 'a seed'."""
    return number(int, low, high, what=f"{what}, ")


def number(
    kind: Any, low: float, high: float, is_above: bool = False, what: str = "", unit: str = ""
) -> Callable[[str], Any]:
    """Returns the type of an option for a number of this ``kind`` within bounds, of which infinite ones are
    left out; with ``is_above``, the lower bound itself is not possible."""
    name = "whole number" if kind is int else "number"
    lower = f"above {low:g}, up to" if is_above else f"from {low:g} to"
    bounds = f"{lower} {high:.15g}" if high < inf else lower.rpartition("," if is_above else " to")[0]
    advice = f"give {what}a {name} {bounds}{unit and ' ' + unit}"

    def number(value: str) -> Any:  # click shows this name in the help
        try:
            found = kind(value)
        except ValueError:
            raise click.BadParameter(f"'{value}' is no {name}; {advice}") from None
        if not (low <= found <= high and isfinite(found)) or (is_above and found == low):
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
    from roadgpt.road.world import STEEPEST, bank_in

    text = str(value).strip().removesuffix("%").strip()
    try:
        return bank_in(text if text in ("none", "auto") else float(text), 100 * STEEPEST, "a percentage")
    except ValueError:
        raise click.BadParameter(
            f"'{value}' is not possible; give none, auto or a percentage from 0 to {100 * STEEPEST:g}"
        ) from None


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
    """Returns the value of --driver; for a driver's file, makes its path absolute and permits its code."""
    if ".py" not in value:
        return value
    from roadgpt.drive.loading import absolute_spec, permit

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
