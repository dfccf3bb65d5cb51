"""Defines ``Option``: a command-line option with its help text, default, and key in configuration files."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import copy
from enum import StrEnum
from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from roadgpt.cli.configuration import EARLIER_KEYS, OF_ENVIRONMENT, OF_FOLDER, OF_USER, Guard
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.chat.config import Layer, Setting


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
    BEAMNG = "BeamNG"
    OUTPUT = "Output and help"


# keys of click's Context.meta: the settings that a command takes from files, and the function that reads all
FROM_FILES, LAYERS = "roadgpt.from_files", "roadgpt.layers"


class Option(click.Option):
    """A command-line option that can also be set in files, and appears in the commands that RoadGPT prints.

    Several commands can share one Option. ``click.Option`` documents the other arguments.

    Args:
        names: The names of the option, separated by blanks, and the name of the function's argument if it
            differs.
        sentence: The option's text in the help.
        kind: A click type, or a function that converts the text; ``bool`` makes a switch.
        default: The value if the option is not given; the help shows it unless ``sentence`` states a default.
        heading: The heading under which the help lists the option.
        is_rare: Whether --help omits the option and only --help-all lists it; has no effect on commands with
            few options.
        table: The table of configuration files in which the option can be set; empty if files cannot set it.
            A switch that files can set also gets an opposite switch, like --no-lane-departure.
        key: The option's key in that table; empty if it is the option's first name.
        guard: A function that refuses values which a configuration file must not set.
        unit: Factor that converts the field's value to the option's value, such as 3.6 from m/s to km/h.
        advice: A sentence that says what to type if the option is required and missing.
    """

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
        """Returns a copy of this option with other attributes, such as ``default``. Both --help and
        --help-all list the copy."""
        twin = copy(self)
        vars(twin).update(is_rare=False, **values)
        return twin

    @property
    def field(self) -> str:
        """Name of the field that the option sets, such as a field of the Setup; also the name of the
        function's argument.
        """
        return str(self.name)

    def read(self, given: Any) -> Any:
        """Converts a value of the option to the unit of the field, such as km/h to m/s."""
        return given if given is None or isinstance(given, str) or self.unit == 1.0 else given / self.unit

    def written(self, value: Any, usual: Any = None, is_set: bool = False) -> list[str]:
        """Returns the command-line arguments that give the field a value. The default needs no arguments,
        except if a file or the environment sets the option (``is_set``). ``usual`` replaces the default.
        """
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
        """The option's name in ``roadgpt config show``: its key, with ``beamng_`` in front if its table is
        [beamng].
        """
        return f"beamng_{self.key}" if self.table == "beamng" else self.key

    def consume_value(self, ctx: click.Context, opts: Any) -> tuple[Any, ParameterSource]:
        """Returns the unconverted value and its source; a value on the command line takes precedence."""
        value, source = super().consume_value(ctx, opts)
        setting = self.found(ctx.meta[LAYERS]()) if self.table and source is ParameterSource.DEFAULT else None
        if setting is None:
            return value, source
        ctx.meta.setdefault(FROM_FILES, {})[self.name] = (self, setting)
        return setting.value, ParameterSource.DEFAULT_MAP

    def process_value(self, ctx: click.Context, value: Any) -> Any:
        """Returns the converted value.

        Raises:
            UsageError: A value from a file or the environment cannot be used; the message says where it is
                set.
        """
        own, setting = ctx.meta.get(FROM_FILES, {}).get(self.name, (None, None))
        if own is not self:
            return super().process_value(ctx, value)
        with self._naming(setting.origin):
            return super().process_value(ctx, value)

    def converted(self, ctx: click.Context, setting: "Setting") -> Any:
        """Returns the value of a setting, converted to the option's type.

        Raises:
            UsageError: The value cannot be used.
        """
        with self._naming(setting.origin):
            return self.type_cast_value(ctx, setting.value)

    def found(self, layers: "Sequence[Layer]") -> "Setting | None":
        """Returns the Setting from the first source that sets the option; None if no source sets the option.

        Args:
            layers: The environment and the configuration files, highest precedence first.

        Raises:
            UsageError: The value has the wrong type, or must not be set by that source.
        """
        from roadgpt.chat.config import FOLDER, Setting

        keys = (self.key, *(old for old, new in EARLIER_KEYS.items() if new == self.key))
        for layer in layers:
            table = layer.tables.get(self.table, {})
            said, where = next((table[key] for key in keys if key in table), None), f"[{self.table}]"
            if self.variable in layer.found:
                said, where = layer.found[self.variable], f"({self.variable})"
            if said is None:
                continue
            origin = f"{layer.name} {where}"
            with self._naming(origin):
                value = self._text(said)
            place = OF_FOLDER if layer.name in FOLDER else OF_USER if layer.tables else OF_ENVIRONMENT
            for one in value if isinstance(value, tuple) else (value,):
                if self.guard and (refusal := self.guard(str(one), place)):
                    raise UsageError(f"{origin} says {self.key} = {one}: {refusal}")
            return Setting(value, origin)
        return None

    def _text(self, value: Any) -> Any:
        """Converts a value from a TOML file to the text, or texts, that the user would give as an option."""
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
        """Context manager: adds to the error message about an invalid value where that value is set."""
        try:
            yield
        except click.BadParameter as error:
            why = error.message.rstrip(".")
            raise UsageError(f"the setting '{self.key}' from {origin} cannot be used: {why}") from None


class Argument(click.Argument):
    """An argument of a command, with advice for a user who left it out.

    Args:
        name: The name of the function's argument, followed by "..." if the argument takes several values.
        metavar: The name of the argument in the help.
        advice: A sentence that says what to type; empty if click's own message is enough.
        kind: A click type, or a function that converts the text.
        required: Whether the user must give the argument.
    """

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
    """Returns the command-line arguments that give options these values, by the names of the fields.

    Options without a value and options with their default value are left out. Defaults in ``usual`` replace
    the options' own defaults. ``told`` are the keys of options that configuration files or the environment
    set; these options are given even with their default value.
    """
    return [
        word
        for option in options
        for word in option.written(
            values.get(option.field), (usual or {}).get(option.field), option.key in told
        )
    ]


def _digits(value: float, unit: float) -> str:
    """Returns the shortest text of a number in the option's unit that is read as exactly this value."""
    texts = [f"{value * unit:.{digits}g}" for digits in range(6, 18)]
    return next((text for text in texts if float(text) / unit == value), texts[-1])
