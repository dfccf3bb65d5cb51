"""What can be set by options and files: ``options.toml`` has a row for each field of a model that people can
set, from which the field and the option are made; and ``layers`` reads the sources of settings other than
options, in this order:

    environment   ROADGPT_MODEL=gpt-5-mini       also OPENAI_BASE_URL and OPENAI_API_KEY
    .env          the same names, in the working folder
    TOML          roadgpt.toml in the working folder, then the user's config.toml: model under [chat]"""

import os
import re
from collections.abc import Collection, Mapping, Sequence
from difflib import get_close_matches
from math import inf
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from roadgpt.errors import UsageError
from roadgpt.reading import read_text, toml_of

CHAT = "chat"
API_KEY = "api_key"
DOTENV = ".env"
PROJECT = "roadgpt.toml"
FOLDER = (DOTENV, PROJECT)
"""Files in the working folder, which may have been written by somebody else."""
LINE = re.compile(r"\s*(?:export\s+)?([A-Za-z_]\w*)\s*=\s*(.*?)\s*")
PREFIXES = ("ROADGPT_", "OPENAI_", "AZURE_OPENAI_")
"""The beginnings of the names of all variables that set something."""
OF_OTHERS = "ROADGPT_NO_NUMBA"  # used in the hallway: compiled.py
MOST_BYTES = 1_000_000  # of a settings file

Row = Mapping[str, Any]
"""A row of a file like ``options.toml``, which explains its keys."""


def rows_in(path: Path) -> dict[str, dict[str, Row]]:
    """Returns the tables of rows in a file like ``options.toml``."""
    return toml_of(path.read_text(encoding="utf-8"))


ROWS = rows_in(Path(__file__).with_name("options.toml"))


def span(row: Row) -> tuple[float, float]:
    """Returns the least and the greatest value that people can give, in their unit."""
    low, high = row.get("within") or (row.get("from", row.get("above", -inf)), row.get("to", inf))
    return float(low), float(high)


def field(row: Row, **more: Any) -> Any:
    """Returns the field of a pydantic model that a row describes; ``more`` are further arguments of it."""
    from pydantic import Field

    unit, usual = row.get("unit", 1.0), row.get("default")
    bounds = {name: row[key] for key, name in (("from", "ge"), ("above", "gt"), ("to", "le")) if key in row}
    default = usual / unit if isinstance(usual, float) else usual
    return Field(**{"default": default, **bounds, **more})


class Setting(NamedTuple):
    """The value of a setting and where it was found."""

    value: Any
    origin: str


class Layer(NamedTuple):
    """One source of settings, such as the environment or a file."""

    name: str
    variables: Mapping[str, str] = MappingProxyType({})
    tables: Mapping[str, Any] = MappingProxyType({})
    """The tables of a TOML file, by name."""

    def find(self, table: str, key: str, *variables: str) -> Setting | None:
        """Returns the Setting that one of these variables sets here, or this key of a table; None if none."""
        for name in variables:
            if name in self.variables:
                return Setting(self.variables[name], f"{self.name} ({name})")
        value = self.tables.get(table, {}).get(key)
        return None if value is None else Setting(value, f"{self.name} [{table}]")


def layers(known: Mapping[str, Sequence[str]] | None = None) -> list[Layer]:
    """Returns all sources of settings except options and plan files, beginning with the highest precedence.

    Raises UsageError if a file cannot be read, or its table ``[chat]`` has an unknown key. ``known`` are the
    keys of the other tables, by name; with them, these and all other tables are looked at, too."""
    files = [Layer(str(path), tables=_toml(path)) for path in (Path(PROJECT), user_file())]
    keys = {**(known or {}), CHAT: (*ROWS[CHAT], API_KEY)}
    for path, _, tables in files:
        outside = next((name for name in keys[CHAT] if name in tables), None)
        if outside:
            raise UsageError(
                f"the setting '{outside}' in {path} is outside of a table; put it below a line [chat]"
            )
        for name, table in tables.items():
            if name in keys and not isinstance(table, dict):
                raise UsageError(f"the settings in {path} need a table [{name}]")
            if name not in keys and known is not None:
                there = ", ".join(f"[{each}]" for each in keys)
                raise UsageError(f"the settings in {path} have no table [{name[:40]}]; there are: {there}")
            for key in table if name in keys else ():
                if key not in keys[name]:
                    near = get_close_matches(key, keys[name], 1)
                    advice = f"did you mean '{near[0]}'?" if near else f"there are: {', '.join(keys[name])}"
                    raise UsageError(f"the settings in {path} have no '{key[:40]}' under [{name}]; {advice}")
    environment = {name: value for name, value in os.environ.items() if _is_ours(name, value)}
    return [Layer("environment", environment), Layer(DOTENV, _dotenv(Path(DOTENV))), *files]


def user_file() -> Path:
    """Returns the path of the user's own settings file, whether or not it exists."""
    home = os.environ.get("XDG_CONFIG_HOME") or os.environ.get("APPDATA")
    return (Path(home) if home else Path("~/.config").expanduser()) / "roadgpt" / "config.toml"


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
        if match := LINE.fullmatch(line):
            name, value = match.groups()
            if len(value) >= 2 and value[0] in "\"'" and value[0] in value[1:]:
                value = value[1 : value.index(value[0], 1)]
            else:
                value = re.split(r"\s#", value)[0].strip()
            if _is_ours(name, value):
                found[name] = value
    return found


def _is_ours(name: str, value: str) -> bool:
    return name.startswith(PREFIXES) and bool(value.strip())


def _toml(path: Path) -> dict[str, Any]:
    text = _read(path)
    try:
        return toml_of(text)
    except ValueError as error:
        # the library's message may quote the line, which may contain a key
        place = re.search(r"at line \d+", str(error))
        where = place.group() if place else "somewhere"
        raise UsageError(f"the settings in {path} are not TOML ({where}); correct them") from None


def unknown_variables(others: Collection[str] = ()) -> list[str]:
    """Returns the variables whose names begin with ``ROADGPT_`` but are unknown, as texts such as
    "ROADGPT_MODLE in .env"; ``others`` are known variables that do not concern language models."""
    known = {f"ROADGPT_{name.upper()}" for name in (*ROWS[CHAT], API_KEY)} | {OF_OTHERS, *others}
    places = (("the environment", os.environ), (DOTENV, _dotenv(Path(DOTENV))))
    return [
        f"{name} in {place}"
        for place, names in places
        for name in sorted(names)
        if name.startswith("ROADGPT_") and name not in known
    ]
