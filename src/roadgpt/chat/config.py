"""Where settings come from: flags, the environment, .env, TOML files, in this order; each with its origin.

    flag          --model gpt-5-mini
    environment   ROADGPT_MODEL=gpt-5-mini       also OPENAI_BASE_URL and OPENAI_API_KEY
    .env          the same names, in the working folder
    TOML          roadgpt.toml in the working folder, then config.toml in the user's own: model under [chat]

A plan of a campaign (its table [chat]) comes between the flags and the environment. A key is never a setting:
it has no flag, is not part of ChatSettings, and is shown masked. It goes to servers that the user names, by a
flag, the environment or their own file; whatever else names one may be somebody else's.
"""

import os
import re
import tomllib
from collections.abc import Mapping
from difflib import get_close_matches
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import ValidationError

from roadgpt.chat.address import origin_of
from roadgpt.chat.model import ChatSettings
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


def configured(flags: Mapping[str, Any] | None = None, plan: Layer | None = None) -> ChatSettings:
    """The settings of this moment; a flag that is None was not given.

    Args:
        flags: what the user gave as options.
        plan: what a file says that the user gave, and maybe did not write.

    Raises:
        UsageError: a value that cannot be; the sentence says where it stands.
    """
    return settings_from(settings_with_origin(flags, plan))


def settings_with_origin(
    flags: Mapping[str, Any] | None = None, plan: Layer | None = None
) -> dict[str, Setting]:
    """Every setting with its origin; the first place that has it counts.

    Raises:
        UsageError: a file of settings cannot be read, or holds a name that is none.
    """
    if (flags or {}).get("base_url"):
        SERVERS.name(str(origin_of(str((flags or {})["base_url"]))))
    places = [_looked_up(layer) for layer in ([plan] if plan else []) + _layers()]
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

    A server that only a file of the working folder names gets only a key from there; one that only a plan, a
    campaign or a run names gets none. They may be somebody else's.

    Raises:
        UsageError: a file of settings cannot be read.
        ChatError: the key holds what no key has, or belongs to the user and the server to a file.
    """
    host = origin_of(base_url)[1]
    names = ["ROADGPT_API_KEY", "OPENAI_API_KEY"]
    if host.endswith(".azure.com"):
        names.insert(1, "AZURE_OPENAI_API_KEY")
    keys = [
        Key(str(value), f"{layer.name} ({name})")
        for layer in _layers()
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


def name_server(base_url: str, wanted: str | None, place: object) -> None:
    """The user names the server that a file names: it may have their key.

    Raises:
        UsageError: the file names another.
    """
    if wanted is None or origin_of(base_url) != origin_of(wanted):
        told = wanted or "no server of its own"
        raise UsageError(f"{place} names {told}, and not {base_url}; name that one, or leave out --base-url")
    SERVERS.name(str(origin_of(base_url)))


def untrusted_source(base_url: str | None) -> str:
    """The file that names this server, where the user does not; empty where they do, or nobody does."""
    if not base_url:
        return ""
    wanted = origin_of(base_url)
    naming = [
        layer.name
        for layer in _layers()
        if (said := _looked_up(layer).get("base_url")) and origin_of(str(said.value)) == wanted
    ]
    if wanted == origin_of(None) or any(name not in FOLDER for name in naming):
        return ""
    if SERVERS.named(str(wanted)):
        return ""
    return SERVERS.stranger(str(wanted)) or next(iter(naming), "")


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
        return read_text(path, MOST_BYTES, "a file of settings", "utf-8-sig")
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


def unknown_variables() -> list[str]:
    """Variables that look like settings of ours and are none, with the place where they stand."""
    known = {f"ROADGPT_{name.upper()}" for name in (*FIELDS, KEY)} | {OF_OTHERS}
    places = (("the environment", os.environ), (DOTENV, _dotenv(Path(DOTENV))))
    return [
        f"{name} in {place}"
        for place, names in places
        for name in sorted(names)
        if name.startswith("ROADGPT_") and name not in known
    ]
