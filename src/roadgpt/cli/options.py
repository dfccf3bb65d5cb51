"""Options and arguments of commands, the options that several commands share, and commands whose help lists
them in groups. ``roadgpt config show`` lists those that files can set; its help says which source precedes
which. The options of the World, the Setup, language models and simulators are made from rows of data, as are
the fields that they set: see ``roadgpt.settings``.

A working folder may come from somebody else. Therefore its files cannot specify a driver's file, a program, a
server or a plug-in that uses a language model: the user has to give such a value as an option."""

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import copy
from enum import StrEnum
from functools import cache, partial
from itertools import chain, takewhile
from math import inf, isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import click
from click.core import ParameterSource

from roadgpt import plugins
from roadgpt.cli.streams import warn
from roadgpt.errors import BriefError, UsageError, command_line
from roadgpt.settings import FOLDER, ROWS, Layer, Row, Setting, span
from roadgpt.settings import layers as all_layers

if TYPE_CHECKING:
    from roadgpt.campaign.gate import Gate
    from roadgpt.chat import ChatSettings
    from roadgpt.report import Drawing
    from roadgpt.road import World

OF_FOLDER, OF_USER, OF_ENVIRONMENT = "folder", "user", "environment"
YOURSELF = "a file of this folder cannot decide that; say it yourself with the option"
ENDINGS = (".json", ".jsonl", ".csv", ".tsv", ".sbft")  # of road files, beside those of maps
WHOLE_PATH = "give the whole path, from the root of the disk"
Guard = Callable[[str, str], str]
"""Takes a value and its source, such as ``OF_FOLDER``, and says why it is refused; empty if it is not."""


def driver_guard(value: str, place: str) -> str:
    """Refuses a driver's file that a file in the working folder names, or whose path is relative."""
    if "=" in value and place == OF_FOLDER:
        return YOURSELF
    if ".py" not in value:
        return ""
    if place == OF_FOLDER:
        return f"code is not run because a file names it; if you trust it, name it yourself: --driver {value}"
    return "" if Path(value.rpartition(".py")[0]).is_absolute() else WHOLE_PATH


def place_guard(value: str, place: str) -> str:
    """Refuses a value, such as a host, from a file in the working folder."""
    del value
    return YOURSELF if place == OF_FOLDER else ""


def path_guard(value: str, place: str) -> str:
    """Refuses every path from a file in the working folder, and relative paths from the user's own file."""
    if place == OF_USER and not Path(value).expanduser().is_absolute():
        return WHOLE_PATH
    return place_guard(value, place)


def ground_guard(value: str, place: str) -> str:
    """Refuses a file of heights where ``path_guard`` does."""
    is_file = Path(value).suffix or Path(value.rpartition("@")[0]).suffix
    return path_guard(value, place) if is_file else ""


def _plugin_guard(kind: str, value: str, place: str) -> str:
    from roadgpt.chat import asks_a_model

    name, colon, _ = value.partition(":")
    is_refused = place == OF_FOLDER and (colon or asks_a_model(plugins.find(kind, name)))
    return YOURSELF if is_refused else ""


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


# keys of click's Context.meta: the settings that a command takes from files, the function that reads all, and
# whether --help-all is answered
FROM_FILES, LAYERS, ALL = "roadgpt.from_files", "roadgpt.layers", "roadgpt.help_all"


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

    def converted(self, ctx: click.Context, setting: Setting) -> Any:
        """Returns the value of a setting, converted to the option's type."""
        with self._naming(setting.origin):
            return self.type_cast_value(ctx, setting.value)

    def found(self, layers: Sequence[Layer]) -> Setting | None:
        """Returns the Setting from the first of the layers that sets the option; None if none does."""
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


def number(kind: Any, low: float, high: float, of: str = "", above: bool = False) -> Callable[[str], Any]:
    """Returns the type of an option for a finite number of this ``kind`` from ``low`` to ``high``, or
    ``above`` ``low``; ``of`` is the unit, or what a whole number counts, such as 'the number of roads'."""
    name = "whole number" if kind is int else "number"
    what, unit = (f"{of}, " if of else "", "") if kind is int else ("", f" {of}".rstrip())
    lower = f"above {low:g}, up to" if above else f"from {low:g} to"
    bounds = f"{lower} {high:.15g}" if high < inf else lower.rpartition("," if above else " to")[0]
    advice = f"give {what}a {name} {bounds}{unit}"

    def number(value: str) -> Any:  # click shows this name in the help
        try:
            found = kind(value)
        except ValueError:
            raise click.BadParameter(f"'{value}' is no {name}; {advice}") from None
        if not (low <= found <= high and isfinite(found)) or (above and found == low):
            raise click.BadParameter(f"{value} is not possible; {advice}")
        return found

    return number


measure, whole = partial(number, float), partial(number, int)
HOW_MANY = whole(1, 1_000_000, "the number of roads")
SEED = whole(0, 2**63 - 1, "a seed")
PATH = click.Path(path_type=Path)
NUMBERS: dict[str, Any] = {"float": float, "int": int}
PICTURES = ("png", "svg", "pdf")  # as report.FORMATS has them, which would load matplotlib


def listed(clean: Callable[[str], str], skips_blanks: bool = False) -> Callable[[Any], tuple[str, ...]]:
    """Returns the type of an option for texts separated by commas; ``clean`` converts or refuses each, also
    blank ones unless others are given and ``skips_blanks`` is true."""

    def names(value: str | tuple[str, ...]) -> tuple[str, ...]:
        texts = value if isinstance(value, tuple) else value.split(",")
        given = [text.strip() for text in texts if text.strip() or not skips_blanks] or [""]
        return tuple(dict.fromkeys(map(clean, given)))

    return names


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


def scene(value: str) -> str:
    """Returns a scene in its normal form."""
    from roadgpt.brief.plan import read_scene, scene_plan

    try:
        return scene_plan(read_scene(value))
    except BriefError as error:
        raise click.BadParameter(str(error)) from None


def scenario(value: str) -> str:
    """Returns the name of a scenario with the parameters that are given."""
    if not value:
        return ""
    from roadgpt.brief.scenarios import scenario as of_catalogue

    return str(of_catalogue(value))


def folder(value: str) -> Path:
    """Converts the value of an option to the path of a folder that exists or can be created."""
    if not str(value).strip():
        raise click.BadParameter("a folder without a name; give its name, or '.' for this one")
    path = Path(value)
    there = next((place for place in (path, *path.parents) if place.exists()), path)
    if there.exists() and not there.is_dir():
        raise click.BadParameter(f"'{there}' is a file; give the name of a folder")
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
    """Returns the value of --driver; for a driver's file, makes its path absolute and permits its code, or
    settings that are texts."""
    if ".py" not in value and "=" not in value:
        return value
    from roadgpt.drive.loading import absolute_spec, permit

    permit(found := absolute_spec(value, Path.cwd()))
    return found


def recording(value: str) -> str:
    """Returns the value of --tracks as an absolute path, and permits the file to be read."""
    from roadgpt.drive.loading import RECORDINGS, permit

    if value and not value.endswith(RECORDINGS):
        raise click.BadParameter(
            f"'{value}' is no recording; give a table (.csv) or an OpenSCENARIO file (.xosc)"
        )
    if value:
        permit(value := str(Path(value).absolute()))
    return value


def ground(value: str) -> str:
    """Returns the value of --ground: a kind of land, or the name of land in a file, with its heights."""
    from roadgpt.ground.given import NAME
    from roadgpt.road.world import ground_in

    path, digest = found.groups() if (found := NAME.fullmatch(value)) else (value, "")
    if not Path(path).suffix:
        try:
            return ground_in(value, str)
        except ValueError as error:
            raise click.BadParameter(f"{error}, or a file of heights (.png, .asc, .npy, .tif)") from error
    from roadgpt.ground.files import read_ground

    made = read_ground(Path(path))
    if digest and not made.endswith(digest):
        raise click.BadParameter(f"{path} holds other land than '{value}'; leave '@{digest}' out to take it")
    return made


def drivers(value: str) -> tuple[str, ...]:
    """Returns the drivers in a value of --drivers, separated by commas, as ``driver`` does."""
    is_file = Path(f"{value.rpartition('.py')[0]}.py").is_file()  # whose path may have commas
    names = (value,) if is_file else re.split(r",(?!\s*\w+=)", value)  # a comma may separate settings
    return tuple(driver(name.strip()) for name in names)


def _road_format(name: str) -> str:
    if not name:
        raise click.BadParameter("no format is given; 'roadgpt config plugins' lists the exporters")
    return name


def _picture_format(name: str) -> str:
    if name.lower() not in PICTURES:
        raise click.BadParameter(f"'{name}' is no format of pictures; give {', '.join(PICTURES)}, or several")
    return name.lower()


def _gate_rule(text: str) -> str:
    rule = "".join(text.split()).upper()
    if not re.fullmatch(r"FAIL|INVALID|ERROR|(\d{1,2}(\.\d+)?|100)%", rule, re.ASCII):
        raise click.BadParameter(f"'{rule}' is not possible; give fail, invalid, error or N%, as 10%")
    return rule


def flat(ctx: click.Context, option: click.Parameter, given: Any) -> tuple[Any, ...]:
    """Returns the different values of a repeated option, each of which may list several."""
    del ctx, option
    return tuple(dict.fromkeys(chain.from_iterable(given)))


picture_formats = listed(_picture_format)
_files = partial(Option, heading=Heading.FILES)
GUARDS: dict[str, Any] = {
    "reader": reader_guard, "designer": designer_guard, "driver": driver_guard, "tracks": path_guard,
    "ground": ground_guard,
}  # fmt: skip
KINDS: dict[str, Any] = {
    "driver": driver, "tracks": recording, "lanes": lanes, "bank": bank, "scene": scene, "ground": ground,
    "scenario": scenario,
}  # fmt: skip
"""What refuses and what converts the values of fields, where their rows do not say it all."""
CHOICES: Sequence[Option]
"""The options that choose tests of a folder: failures, those of analyses, and the worst."""
AT_END: Sequence[Option]
"""The options with which commands that run many tests analyse them at the end."""


class Remarks(NamedTuple):
    """What a summary tells of an analysis."""

    headline: str = ""
    advice: str = ""  # what it can tell besides, with the command
    fields: Mapping[str, Any] = {}  # in JSON


def of_rows(
    rows: Mapping[str, Row], heading: Heading, table: str, stem: str = "", is_rare: bool = False, **more: Any
) -> Iterator[Option]:
    """Yields an option for each row of a file like ``roadgpt/options.toml``, by the names of the fields that
    they set; each is also a key in a table of settings files, and a line of ``roadgpt config show``."""
    for name, row in rows.items():
        usual, sentence, kind, guard = row.get("default"), row["help"], KINDS.get(name), GUARDS.get(name)
        what = row.get("kind", type(usual).__name__)
        if "choices" in row:
            kind = click.Choice(row["choices"])
        elif what == "folder":
            kind, guard = _whole_folder, path_guard
        elif what == "bool":
            kind = bool
        elif what in NUMBERS and kind is None:
            (low, high), said = span(row), re.search(r", (km/h|m)\b", sentence)
            kind = number(NUMBERS[what], low, high, said[1] if said else "", row.get("above") == low)
        if "[default:" in sentence or "open" in row:
            usual = None
        elif isinstance(usual, float) and usual.is_integer():
            usual = int(usual)
        yield Option(
            row.get("flag", f"--{stem}{name.replace('_', '-')}"), sentence, kind, usual,
            key=row.get("key", name), heading=Heading(row.get("heading", heading)), table=table,
            unit=row.get("unit", 1.0), is_rare=is_rare or "rare" in row, metavar=row.get("metavar"),
            guard=place_guard if "of_user" in row else guard, **more,
        )  # fmt: skip


@cache
def _of_analyses() -> dict[str, tuple[Option, ...]]:
    every: dict[str, GroupedCommand] = {
        name: plugins.find("commands", name) for name in plugins.names("analyses")
    }
    own = [Option(f"--{name}", its.choice, bool) for name, its in every.items()]
    return {
        "CHOICES": (FAILURES, *own, WORST),
        "AT_END": tuple(each for its in every.values() for each in its.at_end),
    }


def __getattr__(name: str) -> Any:
    if name in ("CHOICES", "AT_END"):
        return _of_analyses()[name]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


@cache
def simulator_options() -> tuple[Option, ...]:
    """Returns the options of all simulators that bring settings of their own, a plug-in ``settings``:
    ``--beamng-port`` for the row ``port`` of ``beamng``. Every field can be set in the environment, such as
    by ROADGPT_BEAMNG_PORT."""
    more: dict[str, Any] = {"is_rare": True, "expose_value": False, "callback": _keep}
    return tuple(
        each
        for name in plugins.names("settings")
        for each in of_rows(
            plugins.find("settings", name).options, Heading.SIMULATOR, name, f"{name}-", **more
        )
    )


WORLD = tuple(of_rows(ROWS["world"], Heading.SITE, "world"))
"""The options that set fields of the World."""
SETUP = tuple(of_rows(ROWS["run"], Heading.DESIGN, "run"))
"""The options that set fields of the Setup."""
CHAT = tuple(of_rows(ROWS["chat"], Heading.MODEL, ""))
"""The options that set fields of ChatSettings; ``roadgpt.chat.config`` looks up those that are not given."""

# fmt: off
AXES = _files(
    "--axes", "Axes of pictures: equal (to scale), or thesis (fixed ranges, as in RoadGPT's thesis: top "
    "view 220 m x 220 m; height profile 200 m long and 20 m high).", click.Choice(["equal", "thesis"]),
    "equal", is_rare=True, table="run",
)
FORMAT = _files("--format picture_formats", "Formats of pictures: png, svg, pdf.", picture_formats, ("png",),
                metavar="FORMAT,...", table="run")
NO_PLOT = _files("--no-plot", "Draw no pictures.", bool)
JUNIT = _files("--junit", "Also write the tests as JUnit XML.", file, metavar="FILE.xml", is_rare=True)
NO_DRIVE = Option("--no-drive", "Do not drive the roads.", bool, heading=Heading.DRIVE)
AGAIN = _files("--again", "Make all tests of the folder anew, for example with a changed driver. The earlier "
               "ones are moved into its subfolder before-1 (or 2, ...).", bool, is_rare=True)
DRIVER_AGAIN = Option(
    "--driver", "File of the driver. If the run used a driver's file, name it here again: for safety, "
    "RoadGPT does not run a file just because a run folder refers to it.", driver,
    metavar="FILE.py:CLASS", multiple=True, heading=Heading.DRIVE,
)

_output = partial(Option, kind=bool, heading=Heading.OUTPUT)
QUIET = _output("--quiet -q", "Print errors only.")
SCREEN = (
    _output("--json as_json", "Print one JSON line per road."),
    QUIET,
    _output("--verbose -v", "Print details: requirements of the roads, versions, times."),
)

FAILURES = Option("--failures", "From a folder, use only the roads on which the car failed.", bool)
WORST = Option("--worst", "From a folder, use only the road with the smallest margin to failure.", bool)
_work = partial(Option, heading=Heading.WORKERS)
WORKERS = (
    _work("-j --workers", "Number of tests run in parallel; use one per core.",
          whole(1, 4096, "the number of workers"), 1),
    _work("--executor", "Where workers run: 'processes' (here) or 'ray' (on a Ray cluster).", str,
          "processes"),
    _work("--address", "Address of a Ray cluster. [default: this machine]", str, ""),
)
PLAN = Option("--plan is_plan", "DESCRIPTION is a plan, such as 'turn left 90 r30; straight 40'.", bool,
              heading=Heading.DESIGN, is_rare=True)
OPEN = Option("--open opens", "Open the page in the browser.", bool)
WORDS = Argument(
    "words...", "DESCRIPTION", 'Say what road you want: roadgpt run "an uphill road with 3 turns"'
)
ROADS = Argument("files...", "ROAD...", "Name one or more road files, or folders of runs.")


def seed(sentence: str, default: int | None = None) -> Option:
    """Returns the option --seed; ``sentence`` is its text in the help."""
    return Option("--seed", sentence, SEED, default)


def out(sentence: str, **more: Any) -> Option:
    """Returns the option --out, which names a folder; ``sentence`` is its text in the help."""
    return Option("--out", sentence, folder, **more)


def json_option(sentence: str = "Print one JSON object.", **more: Any) -> Option:
    """Returns the option --json; ``sentence`` is its text in the help."""
    return Option("--json as_json", sentence, bool, **more)


def formats_option(names: str, sentence: str, **more: Any) -> Option:
    """Returns an option for formats of road files; users separate formats by commas, or repeat the option."""
    kind = listed(_road_format, skips_blanks=True)
    return Option(names, sentence, kind, metavar="FORMAT,...", multiple=True, callback=flat, **more)


EXPORT = formats_option(
    "--export formats", "Also write road files: opendrive, csv, ...", heading=Heading.FILES, table="run"
)
MAKING = (*SETUP[:6], *WORLD, *SETUP[6:], NO_DRIVE, NO_PLOT, AXES, FORMAT, EXPORT)
"""The options of ``roadgpt run`` that say how roads are made, driven, drawn and exported."""
_gate = partial(Option, heading=Heading.GATE, is_rare=True)
GATE = (
    _gate("--fail-on", "Exit status 6 if a road is FAIL, INVALID (or NOT TESTED) or ERROR, or if more than "
          "N % of the driven roads FAIL.", listed(_gate_rule), metavar="fail|invalid|error|N%,...",
          multiple=True, callback=flat),
    _gate("--baseline", "Exit status 6 if a road has a worse result than in this folder.", folder),
    _gate("--margin-loss", "Loss of margin that is not worse than the baseline, m. [default: 0.1]",
          measure(0, 100)),
)  # fmt: skip


def _whole_folder(value: str) -> Path:
    return folder(value).expanduser().absolute()  # workers may run in another folder


_whole_folder.__name__ = "folder"  # click shows it in the help


def _keep(ctx: click.Context, option: click.Parameter, value: Any) -> None:
    # the simulator and its workers read it in the environment
    assert isinstance(option, Option)
    if value not in (None, False) and ctx.get_parameter_source(option.field) is not ParameterSource.DEFAULT:
        os.environ[option.variable] = "1" if value is True else str(value)
    elif ctx.get_parameter_source(option.field) is ParameterSource.COMMANDLINE:
        os.environ.pop(option.variable, None)  # --no-headless


def settable() -> list[Option]:
    """Returns the options that configuration files can set, in the order of ``roadgpt run``."""
    return [each for each in (*MAKING, *simulator_options()) if each.table]


def layers() -> "Sequence[Layer]":
    """Reads all sources of settings, and returns them, highest precedence first; refuses unknown keys."""
    keys: dict[str, list[str]] = {}
    for each in settable():
        keys.setdefault(each.table, []).append(each.key)
    return all_layers(keys)


def typed(ctx: click.Context) -> set[str]:
    """Returns the names of the arguments that the user gave on the command line."""
    return {name for name in ctx.params if ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE}


def world_of(values: dict[str, Any]) -> "World":
    """Returns the World that option values describe, and removes them from ``values``; None is not set."""
    from roadgpt.road import World

    given = {each.field: each.read(values.pop(each.field)) for each in WORLD if each.field in values}
    source_of, usual = click.get_current_context().get_parameter_source, World().values()
    for name in {"lane_width", "speed_limit"} & {*given}:  # words may ask for others
        if source_of(name) is ParameterSource.DEFAULT and given[name] == usual[name]:
            del given[name]
    if "oracle" in given:  # what is typed precedes what files set, and this the default oracle
        from roadgpt.road.world import oracle_limits

        limits = oracle_limits()
        found = {name: given.pop(name) for name in ("oracle", *limits)}
        for source in (ParameterSource.DEFAULT, ParameterSource.DEFAULT_MAP, ParameterSource.COMMANDLINE):
            some = {name: found[name] for name in found if source_of(name) is source}
            some = {name: value for name, value in some.items() if value is not None}
            limits = oracle_limits(**some) if "oracle" in some else limits | some
        given |= limits
    world = World().changed(**{name: value for name, value in given.items() if value is not None})
    if "friction" in world.site.model_fields_set:
        from roadgpt.brief.beside import friction_of

        if friction_of(surfaces := world.scene.surfaces) not in (None, world.site.friction):
            warn(f"friction {world.site.friction:g} is set and goes before '{surfaces[0]}' of the scene")
    return world


def reader_of(values: dict[str, Any]) -> str:
    """Returns the name of the reader, which is "plan" with --plan; removes --plan from ``values``."""
    if not values.pop("is_plan"):
        return str(values["reader"])
    if "reader" in typed(click.get_current_context()) and values["reader"] != "plan":
        raise UsageError("--plan and --reader contradict each other; leave one of them out")
    return "plan"


def chat_values(values: dict[str, Any]) -> dict[str, Any]:
    """Returns the fields of ChatSettings that were given as options."""
    given = {each.field: each.read(values.get(each.field)) for each in CHAT}
    return {field: value for field, value in given.items() if value is not None}


def chat_of(values: dict[str, Any], reader: str = "", designer: str = "") -> "ChatSettings | None":
    """Returns the settings of the language model, or None if neither reader nor designer uses one; removes
    their options from ``values``."""
    told = chat_values(values)
    for each in CHAT:
        values.pop(each.field, None)
    from roadgpt.chat import asks_a_model

    shelves = (("readers", reader), ("designers", designer))
    if any(asks_a_model(plugins.find(shelf, name.partition(":")[0])) for shelf, name in shelves if name):
        from roadgpt.chat import configured

        return configured(told)
    if told:
        flag = next(each.flag for each in CHAT if each.field in told)
        raise UsageError(f"{flag} is for language models; give --reader chat as well")
    return None


def choice_of(values: dict[str, Any]) -> str | None:
    """Returns which of the ``CHOICES`` is given, if any; removes them from ``values``."""
    said = [each.field for each in _of_analyses()["CHOICES"] if values.pop(each.field)]
    if len(said) > 1:
        raise UsageError(f"--{said[0]} and --{said[1]} contradict each other; give one of them")
    return said[0] if said else None


def choices_said() -> str:
    """Returns the ``CHOICES`` as text, such as '--worst or --failures'."""
    last, *others = (each.flag for each in _of_analyses()["CHOICES"])
    return f"{', '.join(reversed(others))} or {last}"


def gate_of(values: dict[str, Any], folder: Path | None) -> "Gate":
    """Returns the gate that the options of ``GATE`` describe, and removes them from ``values``."""
    from roadgpt.campaign.gate import Gate

    return Gate(folder, *(values.pop(each.field) for each in GATE))


def drawing_of(formats: Any, axes: Any = "equal") -> "Drawing | None":
    """Returns a function that draws pictures of runs in these formats; None if there are no formats."""
    if not formats:
        return None
    from roadgpt.report import Drawing

    return Drawing(axes, formats)


def point(text: str) -> tuple[float, float]:
    """Returns the point that a text such as 120,45.5 names, in metres."""
    try:
        x, y = map(float, text.split(","))
    except ValueError as error:
        raise UsageError(f"'{text[:40]}' is no point; give x and y in metres, such as 120,45.5") from error
    if not (isfinite(x) and isfinite(y)):
        raise UsageError(f"'{text[:40]}' is not finite; give x and y in metres, such as 120,45.5")
    return x, y


def endings() -> tuple[str, ...]:
    """Returns the endings of road files; those of maps are the names of plug-ins."""
    return (*ENDINGS, *(f".{name}" for name in plugins.names("maps")))


def pictures_of(values: dict[str, Any]) -> Any:
    """Returns the formats of the pictures to draw, none with --no-plot; removes both from ``values``."""
    given = values.pop("picture_formats")
    return () if values.pop("no_plot") else given


def refuse_file(words: str, does: str, *command: str) -> None:
    """Raises UsageError for the name of a road file in place of a description; a command ``does`` what is
    meant."""
    if len(words.split()) == 1 and words.lower().endswith(endings()):
        raise UsageError(
            f"{words} is the name of a file, not a description; roadgpt import reads maps, and this {does} "
            f"the road in a file: {command_line(*command, words)}"
        )


@contextmanager
def dash_advice(ctx: click.Context, args: Sequence[str]) -> Iterator[None]:
    """Says where to put it, if an argument that click refuses looks like a description after a dash."""
    given = list(args)  # click takes them out of its list
    try:
        yield
    except click.UsageError as error:
        for at, word in enumerate(given[: given.index("--")] if "--" in given else given):
            is_number = re.match(r"-\d", word) and not (at and given[at - 1].startswith("-"))
            if is_number or re.match(r"-\s*[\w.,]+.*\s", word):
                words = [word, *takewhile(lambda each: not re.match("--?[a-z]", each), given[at + 1 :])]
                rest = [ctx.info_name if ctx.parent else "run", *given[:at], *given[at + len(words) :]]
                again = command_line(*rest, "--", " ".join(words))
                sentence = f"put words that begin with a dash last, after two dashes: {again}"
                raise click.UsageError(sentence, ctx) from error
        raise


WHOLE = 20  # a command with at most this many options lists all of them under --help


def _help_all(ctx: click.Context, parameter: click.Parameter, is_asked: bool) -> None:
    del parameter
    if is_asked and not ctx.resilient_parsing:
        _show_help(ctx, True)


def _show_help(ctx: click.Context, is_all: bool) -> None:
    ctx.meta[ALL] = is_all
    click.echo(ctx.get_help(), color=ctx.color)
    ctx.exit()


HELP_ALL = Option(
    "--help-all", "Show every option and exit.", bool, heading=Heading.OUTPUT, is_eager=True,
    expose_value=False, callback=_help_all,
)  # fmt: skip


class GroupedCommand(click.Command):
    """A command whose help lists options in groups. It also prints which settings come from files.

    ``heading`` is the heading of ``roadgpt --help`` under which a command of another package stands;
    ``has_simulators`` adds the options of simulators. If it analyses tests, ``choice`` is the help of the
    option with its name that chooses tests, and ``at_end`` are the options of commands that run many tests,
    with which they analyse them."""

    def __init__(
        self, *args: Any, heading: str = "", has_simulators: bool = False, choice: str = "",
        at_end: Sequence[Option] = (), **rest: Any,
    ) -> None:  # fmt: skip
        super().__init__(*args, **rest)
        self.heading, self.has_simulators = heading, has_simulators
        self.choice, self.at_end = choice, at_end
        self.params.append(HELP_ALL)

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        """Returns the parameters; those of simulators come last, unless a short help leaves them out."""
        found = super().get_params(ctx)
        is_short = len(found) > WHOLE and not ctx.meta.get(ALL, True)
        return [*found, *simulator_options()] if self.has_simulators and not is_short else found

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parses the arguments; says what to do with a description that begins with a dash."""
        if {*ctx.help_option_names} & {*takewhile("--".__ne__, args)} and not ctx.resilient_parsing:
            _show_help(ctx, False)
        ctx.meta.setdefault(LAYERS, cache(layers))
        if not any(parameter.name == "words" for parameter in self.get_params(ctx)):
            return super().parse_args(ctx, args)
        with dash_advice(ctx, args):
            return super().parse_args(ctx, args)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes the options that this help lists under their headings."""
        listed = [each for each in self.get_params(ctx) if isinstance(each, click.Option) and not each.hidden]
        rare = {each for each in listed if isinstance(each, Option) and each.is_rare}
        is_all = bool(ctx.meta.get(ALL))
        left_out = {HELP_ALL} if len(listed) <= WHOLE or not (rare or self.has_simulators) else rare
        shown: dict[Heading, list[tuple[str, str]]] = {heading: [] for heading in Heading}
        for option in listed:
            record = option.get_help_record(ctx)
            if record is not None and (is_all or option not in left_out):
                names = record[0] if is_all else record[0].partition(" / ")[0]
                # only click's own option --help is no Option
                heading = option.heading if isinstance(option, Option) else Heading.OUTPUT
                shown[heading].append((names, record[1]))
        for heading, records in shown.items():
            if records:
                with formatter.section(heading):
                    formatter.write_dl(records)

    def invoke(self, ctx: click.Context) -> Any:
        """Prints on standard error which options come from files or the environment, and runs the command."""
        told: dict[str, list[str]] = {}
        for option, setting in ctx.meta.get(FROM_FILES, {}).values():
            shown = ",".join(setting.value) if isinstance(setting.value, tuple) else setting.value
            told.setdefault(setting.origin.partition(" ")[0], []).append(f"{option.setting_name} = {shown}")
        if told and not ctx.params.get("quiet"):
            parts = "; ".join(f"{place} sets {', '.join(values)}" for place, values in told.items())
            warn(parts)
        return super().invoke(ctx)


class CommandGroup(click.Group):
    """A command with sub-commands; the help of each sub-command lists its options in groups."""

    command_class = GroupedCommand

    def __init__(self, *args: Any, heading: str = "", **rest: Any) -> None:
        super().__init__(*args, **rest)
        self.heading = heading

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Writes the sub-commands with the whole first sentence of their help."""
        with formatter.section("Commands"):
            formatter.write_dl(
                [(name, command.get_short_help_str(limit=200)) for name, command in self.commands.items()]
            )
