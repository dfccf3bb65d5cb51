"""Commands on this installation: ``roadgpt config`` and ``doctor``."""

import inspect
import json
import platform
import re
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from importlib.metadata import PackageNotFoundError, version
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

import click

from roadgpt import __version__, plugins
from roadgpt.cli import options
from roadgpt.cli.options import CommandGroup, Option
from roadgpt.cli.streams import aligned, warn
from roadgpt.errors import PartError, RoadGPTError
from roadgpt.settings import unknown_variables

PLUGIN = ("shelf", "name", "origin", "about", "works")


def installed() -> list[tuple[str, str, str, str, bool]]:
    """Returns every installed plug-in: its kind (such as readers), name, package, what it does (or why it
    cannot be loaded), and whether it can be."""
    found = []
    for shelf in plugins.KINDS:
        for name in plugins.names(shelf):
            try:
                about, works = _first_sentence(plugins.find(shelf, name)), True
            except PartError as error:
                about, works = str(error), False
            found.append((shelf, name, plugins.origin(shelf, name), about, works))
    return found


def _first_sentence(part: Any) -> str:
    text = inspect.getdoc(part) or inspect.getdoc(inspect.getmodule(part)) or "It has no description."
    paragraph = " ".join(text.strip().split("\n\n")[0].replace("``", "").split())
    return re.split(r"(?<=[.;:]) ", paragraph)[0].rstrip(".;:")


@click.group(cls=CommandGroup)
def config() -> None:
    """Show all settings and where each comes from; list plug-ins."""


@config.command(
    params=[
        Option("--origin with_origin", "With --json: also print where each setting comes from.", bool),
        options.json_option(),
        *options.CHAT,
    ]
)
def show(with_origin: bool, as_json: bool, **values: Any) -> None:
    """Show all settings that options, environment variables or files can set, and where each comes from.

    An option on the command line takes precedence; then an environment variable, such as ROADGPT_FRICTION;
    then the file .env in this folder; then roadgpt.toml in this folder; then roadgpt/config.toml in the
    configuration folder of your user account. The tables of the TOML files are [run], [world], [chat] and
    [beamng]. API keys are masked.

    A folder may come from somebody else. For safety, .env and roadgpt.toml cannot name a driver's file, a
    program, a server that gets your API key, or a plug-in that asks a language model."""
    shown = [*_of_options(), *_of_chat(values)]
    if as_json:
        told = {name: {"value": value, "origin": origin} for _, name, value, origin in shown}
        plain = {name: value for _, name, value, _ in shown}
        click.echo(json.dumps(told if with_origin else plain, indent=2))
        return
    lines = aligned([(name, _text(value), origin) for _, name, value, origin in shown], "<<<")
    for under in dict.fromkeys(table for table, *_ in shown):
        click.secho(f"[{under}]", bold=True)
        click.echo("\n".join(line for (table, *_), line in zip(shown, lines, strict=True) if table == under))
    for name in unknown_variables({option.variable for option in options.settable()}):
        warn(f"{name} is not a setting; the settings are listed above")


def _text(value: Any) -> str:
    return "-" if value is None else str(value).lower() if isinstance(value, bool) else str(value)


def _of_options() -> Iterator[tuple[str, str, Any, str]]:
    """Yields table, name, value and origin of all settings but those of language models."""
    context = click.Context(click.Command(None), resilient_parsing=True)
    layers = options.layers()
    for option in options.settable():
        setting = option.found(layers)
        value = option.converted(context, setting) if setting else option.get_default(context)
        if isinstance(value, tuple):
            value = ",".join(",".join(each) if isinstance(each, tuple) else str(each) for each in value)
        elif not isinstance(value, int | float):
            value = str(value) if isinstance(value, str | Path) else None
        yield option.table, option.setting_name, value, setting.origin if setting else "default"


def _of_chat(values: dict[str, Any]) -> Iterator[tuple[str, str, Any, str]]:
    """Yields the settings of language models, and the masked key of their server."""
    from roadgpt.chat.config import key_for, settings_from, settings_with_origin

    found = settings_with_origin(options.chat_values(values))
    settings = settings_from(found)
    for name, setting in found.items():
        yield "chat", name, getattr(settings, name), setting.origin
    key = key_for(settings.base_url)
    yield "chat", "api_key", str(key) if key else None, key.origin if key else "nowhere"


@config.command("plugins", params=[options.json_option("Print one JSON list.")])
def plugins_command(as_json: bool) -> None:
    """List the plug-ins: readers, designers, rules, exporters, simulators, drivers and others.

    Each line shows the name to use in options, the package that provides the plug-in, and what it does."""
    parts = installed()
    if as_json:
        click.echo(json.dumps([dict(zip(PLUGIN, part, strict=True)) for part in parts], indent=2))
        return
    wide = max(len(name) for _, name, *_ in parts)
    for shelf, its in groupby(parts, key=itemgetter(0)):
        click.secho(shelf, bold=True)
        for _, name, origin, about, works in its:
            click.secho(f"  {name:<{wide}}  {origin:<16}  {about}", fg=None if works else "red")


LIBRARIES = ("numpy", "scipy", "numba", "mujoco-core", "matplotlib", "shapely", "pydantic", "click", "rich")
TEST_ROAD = [[40.0, 100.0], [60.0, 100.0], [80.0, 100.0]]  # m; a straight, driven in a few seconds
CHECK = ("about", "is_fine", "sentence")
Checked = tuple[str, bool, str]


def examined() -> Iterator[Checked]:
    """Yields for each check what was looked at, whether it is fine, and a sentence; a failed check is a
    result, not an exception."""
    from roadgpt.chat.client import diagnose

    yield ("roadgpt", True, f"{__version__} in {Path(__file__).resolve().parents[2]}")
    fits = sys.version_info >= (3, 11)
    yield ("Python", fits, f"{platform.python_version()} on {platform.platform()}")
    for name in LIBRARIES:
        yield _tried(name, partial(_library, name))
    try:
        parts = installed()
    except RoadGPTError as error:
        yield ("plug-ins", False, str(error))
    else:
        broken = [part for part in parts if not part[-1]]
        for shelf, name, _, about, _ in broken:
            yield (f"{shelf}: {name}", False, about)
        told = f"{len(parts) - len(broken)} of {len(parts)} can be used (roadgpt config plugins)"
        yield ("parts", not broken, told)
    yield _tried("model", diagnose)  # fine if none is configured
    yield _tried("numba", _numba)
    yield _tried("test drive", _drive)
    for place in (Path.cwd(), Path(tempfile.gettempdir())):
        yield _tried(f"folder {place}", partial(_writable, place))


def _tried(about: str, look: Callable[[], str]) -> Checked:
    try:
        return (about, True, look())
    except Exception as error:
        kind = "" if isinstance(error, RoadGPTError) else f"{type(error).__name__}: "
        return (about, False, f"{kind}{error}")


def _library(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        raise RoadGPTError(f"is missing: python -m pip install {name}") from None


def _numba() -> str:
    from roadgpt.compiled import COMPILES, WHY_NOT

    return "compiles the inner loop" if COMPILES else f"is not used ({WHY_NOT}): drives work, but far slower"


def _drive() -> str:
    from roadgpt.drive import simulate
    from roadgpt.road import Road, World
    from roadgpt.verdict import judge

    road, world = Road.through(TEST_ROAD), World()
    for each in (world, world.changed(scene="medium")):
        simulate(road, each, "reference")  # compiles what drives alone and among others need
    begun = time.perf_counter()
    drive = simulate(road, world, "reference")
    took = time.perf_counter() - begun
    verdict = judge(road, drive, world)
    if not verdict.kept:
        raise RoadGPTError(f"the car left a straight road ({verdict.description}); please report this")
    return f"{drive.duration:.1f} s simulated in {took:.2f} s, {drive.duration / took:.0f} times real time"


def _writable(folder: Path) -> str:
    with tempfile.TemporaryFile(dir=folder):
        return "can be written to"


@click.group(
    cls=CommandGroup, invoke_without_command=True, params=[options.json_option("Print one JSON list.")]
)
@click.pass_context
def doctor(ctx: click.Context, /, as_json: bool) -> None:
    """Check this installation: versions, plug-ins, compiler, a test drive, folders.

    The exit status is 0 if no check finds a problem."""
    if ctx.invoked_subcommand is not None:
        return
    answers = []
    for about, is_fine, sentence in examined():
        answers.append((about, is_fine, sentence))
        if not as_json:
            mark = click.style("ok     ", fg="green") if is_fine else click.style("PROBLEM", fg="red")
            click.echo(f"{mark}  {about:<14} {sentence}")
    if as_json:
        click.echo(json.dumps([dict(zip(CHECK, answer, strict=True)) for answer in answers], indent=2))
    problems = sum(not is_fine for _, is_fine, _ in answers)
    if problems:
        raise RoadGPTError(f"{problems} of {len(answers)} checks found a problem; see those marked above")
    if not as_json:
        click.echo("all is well")


for name in plugins.names("checks"):
    doctor.add_command(plugins.find("checks", name), name)
