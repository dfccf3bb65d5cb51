"""Looks up each setting in options, the environment, .env and TOML files, in this order, and notes where it
was found.

    option        --model gpt-5-mini
    environment   ROADGPT_MODEL=gpt-5-mini       also OPENAI_BASE_URL and OPENAI_API_KEY
    .env          the same names, in the working folder
    TOML          roadgpt.toml in the working folder, then the user's config.toml: model under [chat]

The plan file of a campaign (its table [chat]) comes between the options and the environment. An API key is
not a setting: it has no option, is not part of ChatSettings, and is only shown masked. The user's key is sent
to OpenAI, and to servers that the user names by an option, in the environment or in the user's own settings
file. If a server is named only in some other file, the key is not sent there, because somebody else may have
written the file. ``key_for`` has the exact rules."""

import os
import re
import tomllib
from collections.abc import Collection, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from pydantic import ValidationError

from roadgpt.chat.model import ChatSettings, origin_of
from roadgpt.chat.secret import Key, usable
from roadgpt.errors import ChatError, UsageError
from roadgpt.provenance import SERVERS
from roadgpt.reading import read_text

FIELDS = tuple(ChatSettings.model_fields)
KEY = "api_key"
DEFAULT = "default"
DOTENV = ".env"
PROJECT = "roadgpt.toml"
FOLDER = (DOTENV, PROJECT)
"""Files in the working folder, which may have been written by somebody else."""
LOOPBACK = ("localhost", "127.0.0.1", "::1")
LINE = re.compile(r"\s*(?:export\s+)?([A-Za-z_]\w*)\s*=\s*(.*?)\s*")
PREFIXES = ("ROADGPT_", "OPENAI_", "AZURE_OPENAI_")
"""The beginnings of the names of all variables that set something."""
OF_OTHERS = "ROADGPT_NO_NUMBA"  # used in the hallway: compiled.py
MOST_BYTES = 1_000_000  # of a settings file


FAULTS = {
    **dict.fromkeys(("float_parsing", "float_type", "finite_number"), "it is not a number"),
    **dict.fromkeys(("int_parsing", "int_type", "int_from_float"), "it is not a whole number"),
    "string_type": "it is not text",
    "literal_error": "use {expected}",
    "greater_than": "give a number above {gt:g}",
    "greater_than_equal": "give {ge:g} or more",
    "less_than_equal": "give {le:g} or less",
}
"""What is wrong with a value, or what to give instead, by the type of pydantic's error."""


class Setting(NamedTuple):
    """The value of a setting and where it was found."""

    value: Any
    origin: str


class Layer(NamedTuple):
    """One source of settings, such as the environment or a file."""

    name: str
    found: dict[str, Any]  # the values, keyed by field name or, for the environment, by name of the variable
    tables: Mapping[str, Any] = MappingProxyType({})
    """All tables of a TOML file, by name; ``roadgpt.cli.options`` reads those other than ``[chat]``."""


def configured(flags: Mapping[str, Any] | None = None, plan: Layer | None = None) -> ChatSettings:
    """Returns the current settings. If several sources have a setting, the one with the highest precedence
    applies.

    Args:
        flags: the command-line options, keyed by field name; a value of None means that the option was not
            given.
        plan: the settings in a plan file, which may have been written by somebody else.

    Raises:
        UsageError: a value is not valid; the message says where it was found."""
    return settings_from(settings_with_origin(flags, plan))


def settings_with_origin(
    flags: Mapping[str, Any] | None = None, plan: Layer | None = None
) -> dict[str, Setting]:
    """Returns the value and the origin of every setting, from the source with the highest precedence. Raises
    UsageError if a settings file cannot be read, or has a setting that does not exist."""
    flags = flags or {}
    if flags.get("base_url"):
        SERVERS.add_from_user(str(origin_of(str(flags["base_url"]))))
    places = [_looked_up(layer) for layer in ([plan] if plan else []) + layers()]
    found = {name: Setting(field.default, DEFAULT) for name, field in ChatSettings.model_fields.items()}
    for place in reversed(places):
        found |= place
    given = {name: value for name, value in flags.items() if name in FIELDS and value is not None}
    return found | {name: Setting(each, f"--{name.replace('_', '-')}") for name, each in given.items()}


def settings_from(found: Mapping[str, Setting]) -> ChatSettings:
    """Returns the ChatSettings with these values. Raises UsageError if a value is not valid; the message says
    where the value was found."""
    try:
        return ChatSettings.model_validate({name: setting.value for name, setting in found.items()})
    except ValidationError as error:
        problem = error.errors(include_url=False, include_input=False)[0]  # the input may be a key
        name = str(problem["loc"][0])
        fault = FAULTS.get(problem["type"], "").format(**problem.get("ctx", {}))
        said = fault or str(problem["msg"]).removeprefix("Value error, ")
        raise UsageError(f"the setting '{name}' from {found[name].origin} cannot be used: {said}") from None


def key_for(base_url: str | None) -> Key | None:
    """Returns the API key for a server; None if there is none.

    A server that is named only in a file of the working folder gets only a key from such a file; if the
    server runs on this computer, it may get any key. A server that is named only in a plan, a campaign or a
    run gets no key. The reason for both rules is that somebody else may have written these files.

    Raises:
        UsageError: a settings file cannot be read.
        ChatError: the key contains invalid characters, or must not be sent to this server, because only a
            file names the server."""
    host = origin_of(base_url)[1]
    names = ["ROADGPT_API_KEY", "OPENAI_API_KEY"]
    if host.endswith(".azure.com"):
        names.insert(1, "AZURE_OPENAI_API_KEY")
    keys = [
        Key(str(value), f"{layer.name} ({name})")
        for layer in layers()
        for name in (*names, KEY)
        if (value := layer.found.get(name))
    ]
    place = untrusted_source(base_url)
    if place and keys and (place not in FOLDER or host not in LOOPBACK):
        keys = [key for key in keys if place in FOLDER and key.origin.startswith(FOLDER)]
        if not keys and host not in LOOPBACK:
            where = f"{place} of this folder" if place in FOLDER else place
            raise ChatError(
                f"the server {host} is named in {where}, so your own key is not sent there; if you trust it, "
                f"say so in your environment: OPENAI_BASE_URL={base_url}"
            )
    return usable(keys[0]) if keys else None


def trust_server(base_url: str, wanted: str | None, place: object) -> None:
    """Allows a server to receive the user's key if the user (``base_url``) and a file (``wanted``) name this
    server. Raises UsageError if the two differ. ``place`` is the file, or its folder, for the message."""
    if wanted is None or origin_of(base_url) != origin_of(wanted):
        told = wanted or "no server of its own"
        raise UsageError(f"{place} names {told}, and not {base_url}; name that one, or leave out --base-url")
    SERVERS.add_from_user(str(origin_of(base_url)))


def untrusted_source(base_url: str | None) -> str:
    """Returns the file that names this server, if another person may have written the file: a file of the
    working folder, a plan, a campaign or a run.

    Returns an empty text if the user named the server too, if no file names it, and for OpenAI's server."""
    if not base_url:
        return ""
    wanted = origin_of(base_url)
    naming = [
        layer.name
        for layer in layers()
        if (said := _looked_up(layer).get("base_url")) and origin_of(str(said.value)) == wanted
    ]
    if wanted == origin_of(None) or any(name not in FOLDER for name in naming):
        return ""
    if SERVERS.given_as(str(wanted)):
        return ""
    return SERVERS.untrusted_file(str(wanted)) or next(iter(naming), "")


def layers() -> list[Layer]:
    """Returns all sources of settings except options and plan files, beginning with the highest precedence.
    Raises UsageError if a file cannot be read, or its table ``[chat]`` has an unknown key."""
    tables = {str(path): _toml(path) for path in (Path(PROJECT), user_file())}
    return [
        Layer("environment", {name: value for name, value in os.environ.items() if _is_ours(name, value)}),
        Layer(DOTENV, _dotenv(Path(DOTENV))),
        *(Layer(place, _chat_table(whole, place), whole) for place, whole in tables.items()),
    ]


def user_file() -> Path:
    """Returns the path of the user's own settings file, whether or not it exists."""
    home = os.environ.get("XDG_CONFIG_HOME") or os.environ.get("APPDATA")
    return (Path(home) if home else Path("~/.config").expanduser()) / "roadgpt" / "config.toml"


def _looked_up(layer: Layer) -> dict[str, Setting]:
    found: dict[str, Setting] = {}
    for name in FIELDS:
        variables = (f"ROADGPT_{name.upper()}", *(["OPENAI_BASE_URL"] if name == "base_url" else []))
        for key in (*variables, name):
            if key in layer.found:
                origin = layer.name if key == name else f"{layer.name} ({key})"
                found.setdefault(name, Setting(layer.found[key], origin))
    return found


def _read(path: Path) -> str:
    try:
        if not path.is_file():
            return ""
        return read_text(path, MOST_BYTES, "a file of settings", "utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or "it is not UTF-8"
        raise UsageError(
            f"the settings in {path} cannot be read: {why}; correct or remove the file"
        ) from None


def _dotenv(path: Path) -> dict[str, Any]:
    """Returns the variables in lines NAME=VALUE that are meant for RoadGPT; all other lines are ignored."""
    found: dict[str, Any] = {}
    for line in _read(path).splitlines():
        match = LINE.fullmatch(line)
        if match and _is_ours(match[1], value := _unquoted(match[2])):
            found[match[1]] = value
    return found


def _is_ours(name: str, value: str) -> bool:
    return name.startswith(PREFIXES) and bool(value.strip())


def _unquoted(text: str) -> str:
    if len(text) >= 2 and text[0] in "\"'" and text[0] in text[1:]:
        return text[1 : text.index(text[0], 1)]
    return re.split(r"\s#", text)[0].strip()


def _toml(path: Path) -> dict[str, Any]:
    text = _read(path)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        # the library's message may quote the line, which may contain a key
        place = re.search(r"at line \d+", str(error))
        where = place.group() if place else "somewhere"
        raise UsageError(f"the settings in {path} are not TOML ({where}); correct them") from None


def _chat_table(whole: Mapping[str, Any], path: str) -> dict[str, Any]:
    """Returns the table ``[chat]``; raises UsageError if it has an unknown key or is not a table."""
    outside = next((name for name in (*FIELDS, KEY) if name in whole), None)
    if outside:
        raise UsageError(
            f"the setting '{outside}' in {path} is outside of a table; put it below a line [chat]"
        )
    table = whole.get("chat", {})
    if not isinstance(table, dict):
        raise UsageError(f'the settings in {path} need a table [chat], with lines like model = "gpt-5-mini"')
    for name in table:
        if name not in (*FIELDS, KEY):
            raise unknown_key(path, "chat", name, (*FIELDS, KEY))
    return dict(table)


def unknown_key(path: str, table: str, key: str, keys: Sequence[str]) -> UsageError:
    """Returns the error for a key that a table of settings in a file cannot have; ``keys`` are the keys that
    the table can have."""
    near = get_close_matches(key, keys, 1)
    advice = f"did you mean '{near[0]}'?" if near else f"there are: {', '.join(keys)}"
    return UsageError(f"the settings in {path} have no '{key[:40]}' under [{table}]; {advice}")


def unknown_variables(others: Collection[str] = ()) -> list[str]:
    """Returns the variables whose names begin with ``ROADGPT_`` but are unknown, as texts such as
    "ROADGPT_MODLE in .env"; ``others`` are known variables that do not concern language models."""
    known = {f"ROADGPT_{name.upper()}" for name in (*FIELDS, KEY)} | {OF_OTHERS, *others}
    places = (("the environment", os.environ), (DOTENV, _dotenv(Path(DOTENV))))
    return [
        f"{name} in {place}"
        for place, names in places
        for name in sorted(names)
        if name.startswith("ROADGPT_") and name not in known
    ]
