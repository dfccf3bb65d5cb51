"""Where settings come from: flags, the environment, .env, TOML files, in this order; each with its origin.

    flag          --model gpt-5-mini
    environment   ROADGPT_MODEL=gpt-5-mini       also OPENAI_BASE_URL and OPENAI_API_KEY
    .env          the same names, in the working folder
    TOML          roadgpt.toml in the working folder, then config.toml in the user's own: model under [chat]

A key is never a setting: it has no flag, is not part of ChatSettings, and is shown masked.
"""

import os
import re
import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import urlsplit

from pydantic import ValidationError

from roadgpt.chat.model import ChatSettings
from roadgpt.chat.secret import Key, usable
from roadgpt.errors import ChatError, UsageError

FIELDS = tuple(ChatSettings.model_fields)
KEY = "api_key"
DEFAULT = "default"
DOTENV = ".env"
PROJECT = "roadgpt.toml"
FOLDER = (DOTENV, PROJECT)
"""Files that come along with a working folder, and so may be somebody else's."""
LOOPBACK = ("localhost", "127.0.0.1", "::1")
LINE = re.compile(r"\s*(?:export\s+)?([A-Za-z_]\w*)\s*=\s*(.*?)\s*")
OF_OTHERS = "ROADGPT_NO_NUMBA"  # the room drive heeds it
MOST_BYTES = 1_000_000  # of a file of settings


class Setting(NamedTuple):
    """A value, and where it was found."""

    value: Any
    origin: str


class Layer(NamedTuple):
    """One place in which settings are looked for."""

    name: str
    found: dict[str, Any]
    """By field, or by the name of a variable where it is one of the environment's."""


def configured(flags: Mapping[str, Any] | None = None) -> ChatSettings:
    """The settings of this moment; a flag that is None was not given.

    Raises:
        UsageError: a value that cannot be; the sentence says where it stands.
    """
    return settings_from(gathered(flags))


def gathered(flags: Mapping[str, Any] | None = None) -> dict[str, Setting]:
    """Every setting with its origin; the first place that has it counts.

    Raises:
        UsageError: a file of settings cannot be read, or holds a name that is none.
    """
    places = [_looked_up(layer) for layer in _layers()]
    found: dict[str, Setting] = {}
    for name in FIELDS:
        given = (flags or {}).get(name)
        if given is not None:
            found[name] = Setting(given, f"--{name.replace('_', '-')}")
            continue
        offers = (place[name] for place in places if name in place)
        found[name] = next(offers, Setting(ChatSettings.model_fields[name].default, DEFAULT))
    return found


def settings_from(found: Mapping[str, Setting]) -> ChatSettings:
    """The ChatSettings of what was gathered.

    Raises:
        UsageError: a value that cannot be.
    """
    try:
        return ChatSettings.model_validate({name: setting.value for name, setting in found.items()})
    except ValidationError as error:
        problem = error.errors(include_url=False, include_input=False)[0]  # the input may be a key
        name = str(problem["loc"][0])
        said = _fault_in(problem)
        raise UsageError(f"the setting '{name}' from {found[name].origin} cannot be used: {said}") from None


def _fault_in(problem: Mapping[str, Any]) -> str:
    """What is wrong with a value, in our words."""
    bounds = problem.get("ctx", {})
    match problem["type"]:
        case "float_parsing" | "float_type" | "finite_number":
            return "it is no number"
        case "int_parsing" | "int_type" | "int_from_float":
            return "it is no whole number"
        case "string_type":
            return "it is no text"
        case "literal_error":
            return f"say {bounds['expected']}"
        case "greater_than":
            return f"give a number above {bounds['gt']:g}"
        case "greater_than_equal":
            return f"give {bounds['ge']:g} or more"
        case "less_than_equal":
            return f"give {bounds['le']:g} or less"
        case _:
            return str(problem["msg"]).removeprefix("Value error, ")


def key_for(base_url: str | None) -> Key | None:
    """The key for a server; None where there is none.

    A server that a file of the working folder names gets only a key from there: the folder may be somebody
    else's.

    Raises:
        UsageError: a file of settings cannot be read.
        ChatError: the key holds what no key has, or belongs to the user and the server to the folder.
    """
    host = urlsplit(base_url or "").hostname or ""
    names = ["ROADGPT_API_KEY", "OPENAI_API_KEY"]
    if host.endswith(".azure.com"):
        names.insert(1, "AZURE_OPENAI_API_KEY")
    keys = [
        Key(str(value), f"{layer.name} ({name})")
        for layer in _layers()
        for name in (*names, KEY)
        if (value := layer.found.get(name))
    ]
    place = _folder_naming(base_url)
    if place and keys and host not in LOOPBACK:
        keys = [key for key in keys if key.origin.startswith(FOLDER)]
        if not keys:
            raise ChatError(
                f"the server {host} is named in {place} of this folder, so your own key is not sent there; "
                f"if you trust it, say so in your environment: OPENAI_BASE_URL={base_url}"
            )
    return usable(keys[0]) if keys else None


def _folder_naming(base_url: str | None) -> str:
    """The file of the working folder that names this server, where the user does not."""
    if not base_url:
        return ""
    for layer in _layers():
        said = _looked_up(layer).get("base_url")
        if said and said.value == base_url:
            return layer.name if layer.name in FOLDER else ""
    return ""


def _layers() -> list[Layer]:
    return [
        Layer("environment", {name: value for name, value in os.environ.items() if value.strip()}),
        Layer(DOTENV, _dotenv(Path(DOTENV))),
        *(Layer(str(path), _toml(path)) for path in (Path(PROJECT), user_file())),
    ]


def user_file() -> Path:
    """The user's own file of settings, whether it is there or not."""
    home = os.environ.get("XDG_CONFIG_HOME") or os.environ.get("APPDATA")
    return (Path(home) if home else Path("~/.config").expanduser()) / "roadgpt" / "config.toml"


def _looked_up(layer: Layer) -> dict[str, Setting]:
    """The fields that a layer sets, whatever they are called there."""
    found: dict[str, Setting] = {}
    for name in FIELDS:
        variables = (f"ROADGPT_{name.upper()}", *(["OPENAI_BASE_URL"] if name == "base_url" else []))
        for variable in variables:
            if variable in layer.found:
                found.setdefault(name, Setting(layer.found[variable], f"{layer.name} ({variable})"))
        if name in layer.found:
            found.setdefault(name, Setting(layer.found[name], layer.name))
    return found


def _read(path: Path) -> str:
    """The text of a file of settings; empty where there is none."""
    try:
        if not path.is_file():
            return ""
        with path.open("rb") as file:
            return file.read(MOST_BYTES).decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or "it is not UTF-8"
        raise UsageError(f"the settings in {path} cannot be read: {why}; mend or remove the file") from None


def _dotenv(path: Path) -> dict[str, Any]:
    """The lines NAME=VALUE that are meant for us; others may stand there for other programs."""
    found: dict[str, Any] = {}
    for line in _read(path).splitlines():
        match = LINE.fullmatch(line)
        if not match or not match[1].startswith(("ROADGPT_", "OPENAI_", "AZURE_OPENAI_")):
            continue
        value = _unquoted(match[2])
        if value:
            found[match[1]] = value
    return found


def _unquoted(text: str) -> str:
    if len(text) >= 2 and text[0] in "\"'" and text[0] in text[1:]:
        return text[1 : text.index(text[0], 1)]
    return re.split(r"\s#", text)[0].strip()


def _toml(path: Path) -> dict[str, Any]:
    text = _read(path)
    try:
        whole = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        # the message of the library may show what stands there, and that may be a key
        place = re.search(r"at line \d+", str(error))
        where = place.group() if place else "somewhere"
        raise UsageError(f"the settings in {path} are not TOML ({where}); mend them") from None
    outside = next((name for name in (*FIELDS, KEY) if name in whole), None)
    if outside:
        raise UsageError(
            f"the setting '{outside}' in {path} stands outside of a table; put it below a line [chat]"
        )
    table = whole.get("chat", {})
    if not isinstance(table, dict):
        raise UsageError(f'the settings in {path} need a table [chat], with lines like model = "gpt-5-mini"')
    for name in table:
        if name not in (*FIELDS, KEY):
            near = get_close_matches(name, (*FIELDS, KEY), 1)
            advice = f"did you mean '{near[0]}'?" if near else f"there are: {', '.join((*FIELDS, KEY))}"
            raise UsageError(f"the settings in {path} have no '{name[:40]}' under [chat]; {advice}")
    return dict(table)


def strangers() -> list[str]:
    """Variables that look like settings of ours and are none, with the place where they stand."""
    known = {f"ROADGPT_{name.upper()}" for name in (*FIELDS, KEY)} | {OF_OTHERS}
    places = (("the environment", os.environ), (DOTENV, _dotenv(Path(DOTENV))))
    return [
        f"{name} in {place}"
        for place, names in places
        for name in sorted(names)
        if name.startswith("ROADGPT_") and name not in known
    ]
