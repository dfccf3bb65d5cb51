"""Declares the options that several commands share, and converts their values to objects such as the World.

Each entry in ``WORLD`` or ``SETUP`` defines four things: an option of ``roadgpt run``, ``campaign`` and
others, a key in configuration files, a line of ``roadgpt config show``, and an argument in printed commands.
"""

import os
from collections.abc import Iterator, Sequence
from functools import cache, partial
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

CHAT_TABLE = "chat"
_world = partial(Option, heading=Heading.SITE, table="world")
_judged = partial(_world, heading=Heading.DRIVE)
_run = partial(Option, heading=Heading.DESIGN, table="run")
_chat = partial(Option, heading=Heading.MODEL)
_rare = partial(Option, heading=Heading.MODEL, is_rare=True)
_files = partial(Option, heading=Heading.FILES)

# fmt: off
WORLD = (
    _world("--map-size", "Side of the map, m. [default: 250, more if needed]",
           measure(50, 40_000, "metres")),
    _judged("--speed-limit", "Speed limit, km/h.", measure(5, 300, "km/h"), 70, unit=3.6,
            key="speed_limit_kmh"),
    _judged("--oracle", "FAIL when more of the car than this is outside its lane: half, sbft (85 %), thesis "
            "(95 %), 0.7 ...; departure: a front tyre over the marking.", str, "half", metavar="ORACLE"),
    _judged("--oob-tolerance", "Share of the car that may be outside its lane. [default: that of --oracle]",
            measure(0, 1, above=True), is_rare=True),
    _judged("--lane-departure", "Also fail if a front tyre crosses the lane marking.", bool, is_rare=True),
    _world("--lanes", "Own + oncoming lanes. [default: 1+1, or as described]",
           lanes),
    _world("--lane-width", "Width of every lane, m.", measure(2, 10, "metres"), 4),
    _world("--lane-width-end", "Lane width at the road's end, m, reached gradually. [default: the same]",
           measure(2, 10, "metres"), is_rare=True),
    _world("--bank", "Bank of bends: none, auto, or in %.", bank, "none", unit=100.0),
    _world("--shoulder", "Width of the firm ground along each side of the road, m; 0: none.",
           measure(0, 100, "metres"), 3, is_rare=True),
    _world("--friction", "Friction coefficient: dry 1, wet 0.6, snow 0.35.",
           measure(0, 2, above=True)),
)
"""The options that set fields of the World."""

SETUP = (
    _run("--reader", "Reads the description: model (neural networks), chat (a language model), plan (plans "
         "only).", str, "model", guard=reader_guard),
    _run("--designer", "Designs roads: planner (a search), or thesis (a language model, as in RoadGPT's "
         "thesis).", str, "planner", guard=designer_guard),
    _run("--driver", "A name, or FILE.py:CLASS.", driver, "lane_centring", heading=Heading.DRIVE,
         guard=driver_guard),
    _run("--simulator", "What simulates the car.", str, "mujoco", heading=Heading.DRIVE),
    _run("--keep-driving", "Continue to the end after the car leaves its lane.", bool, heading=Heading.DRIVE),
    _run("--geometry",
         "How a design becomes a road: arcs (lines, arcs, clothoids), or spline (as in RoadGPT's "
         "thesis).",
         click.Choice(["arcs", "spline"]), "arcs", is_rare=True),
    _run("--rules", "Which rules a road must satisfy: RoadGPT's own (strict), or those of the SBFT tool "
         "competition.", click.Choice(["strict", "sbft"]), "strict", is_rare=True),
)
"""The options that set fields of the Setup."""

CHAT = (
    _chat("--model", "Name of the model on its server."),
    _chat("--base-url", "Address of the server, including /v1. [default: OpenAI's]"),
    _rare("--provider", "Protocol of the server. [default: openai]"),
    _rare("--temperature", "Sampling temperature. [default: the server's]", measure(0, 2)),
    _rare("--timeout", "Seconds to wait for an answer. [default: 60]", measure(0, 86_400, "s", above=True)),
    _rare("--retries", "Further attempts when the server fails. [default: 3]", whole(0, 20, "retries")),
    _rare("--max-completion", "Maximum number of tokens in one answer. [default: 4096]",
          whole(16, 1_000_000, "tokens")),
    _rare("--max-tokens", "Stop when all roads together have used this many tokens.",
          whole(1, 10**12, "tokens")),
    _chat("--max-cost", "Stop when the language model has cost this many USD.",
          measure(0, 1e6, "USD", above=True)),
    _rare("--price",
          "USD per million input and output tokens, such as 0.15/0.60. [default: OpenAI's prices]"),
    _rare("--record", "Save every exchange with the server in this folder."),
    _rare("--replay", "Use the answers saved in this folder; ask no server."),
    _rare("--rounds", "Maximum number of requests to the model for one description. [default: 3]",
          whole(1, 20, "rounds")),
)
"""The options that set fields of ChatSettings; ``roadgpt.chat.config`` looks up those that are not given."""
# fmt: on


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
MAKING = (
    *named(SETUP, "reader", "designer", "driver", "simulator", "keep_driving"),
    *WORLD,
    *named(SETUP, "geometry", "rules"),
    *(NO_DRIVE, NO_PLOT, AXES, FORMAT, EXPORT),
)
"""The options of ``roadgpt run`` that say how roads are made, driven, drawn and exported."""


@cache
def simulator_options() -> tuple[Option, ...]:
    """Returns the options of all simulators that bring a model of their settings, a plug-in ``settings``.

    A field that has a ``description`` becomes an option, a key in the simulator's table of configuration
    files, and a line of ``roadgpt config show``; every field can be set in the environment, such as
    ROADGPT_BEAMNG_PORT for ``port`` of ``beamng``. The option is called ``--beamng-port``, or as the field's
    ``flag`` says. Folders, and fields with ``of_user``, are not taken from files of the working folder."""
    names = plugins.names("settings")
    return tuple(each for name in names for each in _options(name, plugins.find("settings", name)))


def _options(simulator: str, model: Any) -> Iterator[Option]:
    for name, field in model.model_fields.items():
        if field.description is None:
            continue
        kinds, more = get_args(field.annotation) or (field.annotation,), field.json_schema_extra or {}
        low = next((each.ge for each in field.metadata if hasattr(each, "ge")), 0)
        high = next((each.le for each in field.metadata if hasattr(each, "le")), 1_000_000)
        kind: Any = None
        guard = place_guard if more.get("of_user") else None
        if get_origin(kinds[0]) is Literal or isinstance(kinds[0], str):
            kind = click.Choice([*(kinds if isinstance(kinds[0], str) else get_args(kinds[0]))])
        elif kinds[0] is Path:
            kind, guard = _whole_folder, path_guard
        elif kinds[0] is bool:
            kind = bool
        elif kinds[0] is int:
            kind = whole(low, high, "a number")
        elif kinds[0] is float:
            kind = measure(low, high)
        yield Option(
            more.get("flag", f"--{simulator}-{name.replace('_', '-')}"), field.description, kind, key=name,
            heading=Heading.SIMULATOR, table=simulator, is_rare=True, guard=guard, expose_value=False,
            callback=_keep,
        )  # fmt: skip


def _whole_folder(value: str) -> Path:
    return folder(value).expanduser().absolute()  # workers may run in another folder


_whole_folder.__name__ = "folder"  # click shows it in the help


def _keep(ctx: click.Context, option: click.Parameter, value: Any) -> None:
    # the simulator and its workers read it in the environment
    assert isinstance(option, Option)
    if value not in (None, False):
        os.environ[option.variable] = "1" if value is True else str(value)
    elif ctx.get_parameter_source(option.field) is ParameterSource.COMMANDLINE:
        os.environ.pop(option.variable, None)  # --no-headless


def settable() -> list[Option]:
    """Returns the options that configuration files can set, in the order of ``roadgpt run``."""
    return [each for each in (*MAKING, *simulator_options()) if each.table]


def layers() -> "Sequence[Layer]":
    """Reads all sources of settings, and returns them, highest precedence first; refuses unknown keys."""
    from roadgpt.chat.config import layers as all_layers
    from roadgpt.chat.config import unknown_key

    keys: dict[str, list[str]] = {}
    for each in settable():
        keys.setdefault(each.table, []).append(each.key)
    found = all_layers()
    for layer in found:
        for name, table in layer.tables.items():
            if name == CHAT_TABLE:
                continue  # roadgpt.chat.config checks it
            if name not in keys:
                there = ", ".join(f"[{each}]" for each in (*keys, CHAT_TABLE))
                raise UsageError(
                    f"the settings in {layer.name} have no table [{name[:40]}]; there are: {there}"
                )
            if not isinstance(table, dict):
                raise UsageError(f"the settings in {layer.name} need a table [{name}]")
            for key in table:
                if key not in keys[name]:
                    raise unknown_key(layer.name, name, key, keys[name])
    return found


def typed(ctx: click.Context) -> set[str]:
    """Returns the names of the arguments that the user gave on the command line."""
    return {name for name in ctx.params if ctx.get_parameter_source(name) is ParameterSource.COMMANDLINE}


def world_of(values: dict[str, Any]) -> "World":
    """Returns the World that option values describe, and removes them from ``values``; None is not set."""
    from roadgpt.road import World

    given = {each.field: each.read(values.pop(each.field)) for each in WORLD if each.field in values}
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
    given = {each.field: each.read(values.get(each.field)) for each in CHAT}
    return {field: value for field, value in given.items() if value is not None}


def chat_of(values: dict[str, Any], reader: str = "", designer: str = "") -> "ChatSettings | None":
    """Returns the settings of the language model, or None if neither reader nor designer uses one; removes
    their options from ``values``."""
    told = chat_values(values)
    for each in CHAT:
        values.pop(each.field, None)
    from roadgpt.chat import asks_a_model, configured

    shelves = (("readers", reader), ("designers", designer))
    if any(asks_a_model(plugins.find(shelf, name.partition(":")[0])) for shelf, name in shelves if name):
        return configured(told)
    if told:
        flag = next(each.flag for each in CHAT if each.field in told)
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
