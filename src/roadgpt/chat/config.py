"""The settings of language models, and the API keys of their servers.

Settings come from options, and then from the sources that ``roadgpt.settings`` reads. The plan file of a
campaign (its table [chat]) comes between the two. An API key is not a setting: it has no option, is not part
of ChatSettings, and is only shown masked. The user's key is sent to OpenAI, and to servers that the user
names by an option, in the environment or in the user's own settings file. If a server is named only in some
other file, the key is not sent there, because somebody else may have written the file. ``key_for`` has the
exact rules."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from pydantic import ValidationError

from roadgpt.chat.model import ChatSettings, origin_of
from roadgpt.errors import ChatError, UsageError, advice_on
from roadgpt.provenance import SERVERS
from roadgpt.settings import API_KEY, CHAT, FOLDER, Layer, Setting, layers

DEFAULT = "default"
LOOPBACK = ("localhost", "127.0.0.1", "::1")


@dataclass(frozen=True)
class Key:
    """An API key and its origin. As text it is masked: its length and, if it is long, its first 3 letters."""

    value: str = field(repr=False)
    origin: str

    def __str__(self) -> str:
        head = self.value[:3] if len(self.value) >= 20 else ""
        return f"{head}... ({len(self.value)} letters)"


NO_KEY = Key("none", "nowhere")
"""A placeholder for servers that need no key: the library always requires a key."""
GONE = "(key)"
# What looks like a key, also one that a server abbreviated: sk-..., sk-proj-ab****yz; "Bearer ...".
LOOKS_LIKE_A_KEY = re.compile(r"\b(?:sk|rk|pk)-[\w*.\-]{6,}|(?i:\bbearer\s+)[\w~+/=.\-]{8,}")
SHORTEST = 8  # characters of a key that is searched for in texts; shorter ones would match ordinary words


def redacted(value: Any, key: Key) -> Any:
    """Removes the key, and everything that looks like a key, from a text or from all texts in lists and
    dictionaries."""
    if isinstance(value, str):
        if len(key.value) >= SHORTEST and key.value in value:
            value = value.replace(key.value, GONE)
        return LOOKS_LIKE_A_KEY.sub(GONE, value)
    if isinstance(value, dict):
        return {redacted(name, key): redacted(item, key) for name, item in value.items()}
    if isinstance(value, list):
        return [redacted(item, key) for item in value]
    return value


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
    places = ([plan] if plan else []) + layers()
    found = {}
    for name, each in ChatSettings.model_fields.items():
        setting = next(_in_order(places, name), Setting(each.default, DEFAULT))
        if flags.get(name) is not None:
            setting = Setting(flags[name], f"--{name.replace('_', '-')}")
        found[name] = setting
    return found


def _in_order(places: Sequence[Layer], name: str) -> Iterator[Setting]:
    variables = (f"ROADGPT_{name.upper()}", *(["OPENAI_BASE_URL"] if name == "base_url" else []))
    return (setting for place in places if (setting := place.find(CHAT, name, *variables)))


def settings_from(found: Mapping[str, Setting]) -> ChatSettings:
    """Returns the ChatSettings with these values. Raises UsageError if a value is not valid; the message says
    where the value was found."""
    try:
        return ChatSettings.model_validate({name: setting.value for name, setting in found.items()})
    except ValidationError as error:
        problem = error.errors(include_url=False, include_input=False)[0]  # the input may be a key
        name = str(problem["loc"][0])
        raise UsageError(
            f"the setting '{name}' from {found[name].origin} cannot be used: {advice_on(problem)}"
        ) from None


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
        Key(str(setting.value), setting.origin)
        for layer in layers()
        if (setting := layer.find(CHAT, API_KEY, *names)) and setting.value
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
    if not keys:
        return None
    value = keys[0].value.strip()
    if not re.fullmatch(r"[!-~]+", value):
        raise ChatError(
            f"the key from {keys[0].origin} holds blanks or letters that no key has, or is empty; "
            "copy it again from where it was issued"
        )
    return Key(value, keys[0].origin)


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
        if (said := next(_in_order([layer], "base_url"), None)) and origin_of(str(said.value)) == wanted
    ]
    if wanted == origin_of(None) or any(name not in FOLDER for name in naming):
        return ""
    if SERVERS.given_as(str(wanted)):
        return ""
    return SERVERS.untrusted_file(str(wanted)) or next(iter(naming), "")
