"""Declares the options that several commands share, and converts their values to objects such as the World.

Those of the World, the Setup, language models and simulators are made from the models of their values.
"""

import os
import re
from collections.abc import Iterator, Sequence
from functools import cache, partial
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args, get_origin

import click
from click.core import ParameterSource

from roadgpt import plugins
from roadgpt.cli.option import (
    SEED,
    Argument,
    Heading,
    Option,
    bank,
    designer_guard,
    driver,
    driver_guard,
    file,
    folder,
    formats,
    gate_rules,
    lanes,
    measure,
    named,
    number,
    path_guard,
    picture_formats,
    place_guard,
    reader_guard,
    whole,
)
from roadgpt.errors import UsageError

if TYPE_CHECKING:
    from roadgpt.campaign.gate import Gate
    from roadgpt.campaign.selection import Choice
    from roadgpt.chat import ChatSettings
    from roadgpt.chat.config import Layer
    from roadgpt.report import Drawing
    from roadgpt.road import World

_files = partial(Option, heading=Heading.FILES)
GUARDS: dict[str, Any] = {"reader": reader_guard, "designer": designer_guard, "driver": driver_guard}
KINDS: dict[str, Any] = {"driver": driver, "lanes": lanes, "bank": bank}
"""What refuses and what converts the values of fields, where their types do not say it all."""
ORACLE = Option(
    "--oracle",
    "FAIL when more of the car than this is outside its lane: half, sbft (85 %), thesis (95 %), 0.7 ...; "
    "departure: a front tyre over the marking.",
    str, "half", metavar="ORACLE", heading=Heading.DRIVE, table="world",
)  # fmt: skip
"""Stands for the two fields of the Limits that are options of their own."""
WORLD: Sequence[Option]
"""The options that set fields of the World; made, as all of models, when they are first used."""
SETUP: Sequence[Option]
"""The options that set fields of the Setup."""
CHAT: Sequence[Option]
"""The options that set fields of ChatSettings; ``roadgpt.chat.config`` looks up those that are not given."""
MAKING: Sequence[Option]
"""The options of ``roadgpt run`` that say how roads are made, driven, drawn and exported."""


def of_model(
    model: Any, heading: Heading, table: str = "", stem: str = "", is_rare: bool = False, **more: Any
) -> Iterator[Option]:
    """Yields the options of a pydantic model: one for each field with a ``description``, which is also a key
    in a table of settings files, and a line of ``roadgpt config show``.

    The field's type, bounds and default are those of the option; its ``json_schema_extra`` may have the
    ``heading``, ``rare``, ``unit`` (the factor to the option's value), ``within`` (narrower bounds than the
    model's, in its unit), ``key``, ``flag``, ``open`` (no default: it means that nothing was asked for), and
    ``of_user``, for what no file of the working folder sets; nor does such a file set folders."""
    for name, field in model.model_fields.items():
        if field.description is None:
            continue
        kinds, extra = get_args(field.annotation) or (field.annotation,), field.json_schema_extra or {}
        unit, usual, kind = extra.get("unit", 1.0), field.default, KINDS.get(name)
        guard = place_guard if extra.get("of_user") else GUARDS.get(name)
        if "[default:" in field.description or extra.get("open"):
            usual = None
        elif isinstance(usual, float):
            usual = round(usual * unit, 9)
            usual = int(usual) if usual.is_integer() else usual
        if kind is None and (get_origin(kinds[0]) is Literal or isinstance(kinds[0], str)):
            kind = click.Choice([*(kinds if isinstance(kinds[0], str) else get_args(kinds[0]))])
        elif kinds[0] is Path:
            kind, guard = _whole_folder, path_guard
        elif kinds[0] is bool:
            kind = bool
        elif kind is None and kinds[0] in (int, float):
            kind = _within(kinds[0], field, extra.get("within"), unit)
        yield Option(
            extra.get("flag", f"--{stem}{name.replace('_', '-')}"), field.description, kind, usual,
            key=extra.get("key", name), heading=Heading(extra.get("heading", heading)), table=table,
            is_rare=is_rare or "rare" in extra, guard=guard, unit=unit, **more,
        )  # fmt: skip


def _within(kind: type, field: Any, within: tuple[float, float] | None, unit: float) -> Any:
    found = {
        name: getattr(each, name)
        for each in field.metadata
        for name in ("gt", "ge", "le")
        if getattr(each, name, None) is not None
    }
    said = re.search(r", (km/h|m)\b", field.description)
    low, high = within or (found.get("ge", found.get("gt", -inf)), found.get("le", inf))
    low, high = round(low * unit, 9), round(high * unit, 9)
    return number(
        kind, low, high, is_above="gt" in found and low == found["gt"] * unit, unit=said[1] if said else ""
    )


@cache
def _of_models() -> dict[str, tuple[Option, ...]]:
    from roadgpt.chat.model import ChatSettings
    from roadgpt.road.world import CrossSection, Limits, Parts, Site

    of_world = [
        each for part in (Site, CrossSection, Limits) for each in of_model(part, Heading.SITE, "world")
    ]
    order = (
        "map_size", "speed_limit", "oracle", "oob_tolerance", "lane_departure", "lanes", "lane_width",
        "lane_width_end", "bank", "shoulder", "friction",
    )  # fmt: skip
    world = tuple(named([ORACLE, *of_world], *order))
    names = ("reader", "designer", "driver", "simulator", "keep_driving", "geometry", "rules")
    setup = tuple(named([*of_model(Parts, Heading.DESIGN, "run")], *names))
    making = (*setup[:5], *world, *setup[5:], NO_DRIVE, NO_PLOT, AXES, FORMAT, EXPORT)
    chat = tuple(of_model(ChatSettings, Heading.MODEL))
    return {"WORLD": world, "SETUP": setup, "CHAT": chat, "MAKING": making}


def __getattr__(name: str) -> Any:
    if name in ("WORLD", "SETUP", "CHAT", "MAKING"):
        return _of_models()[name]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


@cache
def simulator_options() -> tuple[Option, ...]:
    """Returns the options of all simulators that bring a model of their settings, a plug-in ``settings``:
    ``--beamng-port`` for the field ``port`` of ``beamng``. Every field can be set in the environment, such as
    by ROADGPT_BEAMNG_PORT."""
    more: dict[str, Any] = {"is_rare": True, "expose_value": False, "callback": _keep}
    return tuple(
        each
        for name in plugins.names("settings")
        for each in of_model(plugins.find("settings", name), Heading.SIMULATOR, name, f"{name}-", **more)
    )


# fmt: off
AXES = _files(
    "--axes", "Axes of pictures: equal (to scale), or thesis (fixed ranges, as in RoadGPT's thesis: top "
    "view 220 m x 220 m; height profile 200 m long and 20 m high).", click.Choice(["equal", "thesis"]),
    "equal", is_rare=True, table="run",
)
FORMAT = _files("--format picture_formats", "Formats of pictures: png, svg, pdf.", picture_formats, ("png",),
                metavar="FORMAT,...", table="run")
NO_PLOT = _files("--no-plot", "Draw no pictures.", bool)
JUNIT = _files("--junit", "Also write the tests as JUnit XML.", file, metavar="FILE.xml")
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

CHOICES = (
    Option("--failures", "From a folder, use only the roads on which the car failed.", bool),
    Option("--faults", "Use only one typical failure of each distinct fault in a folder.", bool),
    Option("--worst", "From a folder, use only the road with the smallest margin to failure.", bool),
)
_work = partial(Option, heading=Heading.WORKERS)
WORKERS = (
    _work("-j --workers", "Number of tests run in parallel; use one per core.",
          whole(1, 4096, "the number of workers"), 1),
    _work("--executor", "Where workers run: 'processes' (here) or 'ray' (on a Ray cluster).", str,
          "processes"),
    _work("--address", "Address of a Ray cluster. [default: this machine]", str, ""),
)
# fmt: on
PLAN = Option(
    "--plan is_plan",
    "DESCRIPTION is a plan, such as 'turn left 90 r30; straight 40'.",
    bool,
    heading=Heading.DESIGN,
    is_rare=True,
)  # fmt: skip
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
    return Option(
        names, sentence, formats, metavar="FORMAT,...", multiple=True,
        callback=lambda ctx, param, given: tuple(dict.fromkeys(name for some in given for name in some)),
        **more,
    )  # fmt: skip


EXPORT = formats_option(
    "--export formats", "Also write road files: opendrive, csv, ...", heading=Heading.FILES, table="run"
)
_gate = partial(Option, heading=Heading.GATE, is_rare=True)
GATE = (
    _gate("--fail-on", "Exit status 6 if a road is FAIL, INVALID or ERROR, or if more than N % of the driven "
          "roads FAIL.", gate_rules, metavar="fail|invalid|error|N%,...", multiple=True,
          callback=EXPORT.callback),
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
    return [each for each in (*_of_models()["MAKING"], *simulator_options()) if each.table]


def layers() -> "Sequence[Layer]":
    """Reads all sources of settings, and returns them, highest precedence first; refuses unknown keys."""
    from roadgpt.chat.config import layers as all_layers

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

    of_world = _of_models()["WORLD"]
    given = {each.field: each.read(values.pop(each.field)) for each in of_world if each.field in values}
    if "oracle" in given:  # what is typed precedes what files set, and this the default oracle
        from roadgpt.road.world import oracle_limits

        limits, source_of = oracle_limits(), click.get_current_context().get_parameter_source
        found = {name: given.pop(name) for name in ("oracle", *limits)}
        for source in (ParameterSource.DEFAULT, ParameterSource.DEFAULT_MAP, ParameterSource.COMMANDLINE):
            some = {name: found[name] for name in found if source_of(name) is source}
            some = {name: value for name, value in some.items() if value is not None}
            limits = oracle_limits(**some) if "oracle" in some else limits | some
        given |= limits
    return World().changed(**{name: value for name, value in given.items() if value is not None})


def reader_of(values: dict[str, Any]) -> str:
    """Returns the name of the reader, which is "plan" with --plan; removes --plan from ``values``."""
    if not values.pop("is_plan"):
        return str(values["reader"])
    if "reader" in typed(click.get_current_context()) and values["reader"] != "plan":
        raise UsageError("--plan and --reader contradict each other; leave one of them out")
    return "plan"


def chat_values(values: dict[str, Any]) -> dict[str, Any]:
    """Returns the fields of ChatSettings that were given as options."""
    given = {each.field: each.read(values.get(each.field)) for each in _of_models()["CHAT"]}
    return {field: value for field, value in given.items() if value is not None}


def chat_of(values: dict[str, Any], reader: str = "", designer: str = "") -> "ChatSettings | None":
    """Returns the settings of the language model, or None if neither reader nor designer uses one; removes
    their options from ``values``."""
    told = chat_values(values)
    for each in _of_models()["CHAT"]:
        values.pop(each.field, None)
    from roadgpt.chat import asks_a_model, configured

    shelves = (("readers", reader), ("designers", designer))
    if any(asks_a_model(plugins.find(shelf, name.partition(":")[0])) for shelf, name in shelves if name):
        return configured(told)
    if told:
        flag = next(each.flag for each in _of_models()["CHAT"] if each.field in told)
        raise UsageError(f"{flag} is for language models; give --reader chat as well")
    return None


def choice_of(values: dict[str, Any]) -> "Choice | None":
    """Returns which of --failures, --faults and --worst is given, if any; removes them from ``values``."""
    choices: tuple[Choice, ...] = ("failures", "faults", "worst")
    said = [name for name in choices if values.pop(name)]
    if len(said) > 1:
        raise UsageError(f"--{said[0]} and --{said[1]} contradict each other; give one of them")
    return said[0] if said else None


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


def pictures_of(values: dict[str, Any]) -> Any:
    """Returns the formats of the pictures to draw, none with --no-plot; removes both from ``values``."""
    given = values.pop("picture_formats")
    return () if values.pop("no_plot") else given
