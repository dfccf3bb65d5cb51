"""Writes ``names.py`` anew after a row was added to the table: ``python -m roadgpt.language``."""

import tomllib
from pathlib import Path

HERE = Path(__file__).parent
TYPES = {
    "ActorKind": None, "Where": "places", "What": "actions", "Flow": "flows", "WeatherKind": "weather",
    "Light": "lights", "Surface": "surfaces", "Landform": "landforms",
}  # fmt: skip
"""The types of names, and the part of ``scenes.toml`` whose rows have them."""


def names() -> str:
    """Returns the text of ``names.py``: the names of the rows of the table as types."""
    tables = ("road_users.toml", "scenes.toml")
    users, scenes = (tomllib.loads((HERE / name).read_text(encoding="utf-8")) for name in tables)
    lines = ['"""The names in the table, as types. Made by ``python -m roadgpt.language``."""', ""]
    lines += ["from typing import Literal", ""]
    for type_, part in TYPES.items():
        rows = [f'    "{name}",' for name in (users if part is None else scenes[part])]
        lines += [f"{type_} = Literal[", *rows, "]"]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    (HERE / "names.py").write_text(names(), encoding="utf-8")
