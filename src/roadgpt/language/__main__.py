"""Writes ``names.py`` anew after a row was added to the table: ``python -m roadgpt.language``."""

import textwrap
import tomllib
from pathlib import Path

HERE = Path(__file__).parent
TYPES = {
    "ActorKind": ("road_users", ""), "Where": ("scenes", "places"), "What": ("scenes", "actions"),
    "Flow": ("scenes", "flows"), "WeatherKind": ("scenes", "weather"), "Light": ("scenes", "lights"),
    "Surface": ("scenes", "surfaces"), "Landform": ("scenes", "landforms"), "Kind": ("roads", "features"),
    "Sharpness": ("roads", "sharpness"), "Size": ("roads", "sizes"), "Slope": ("roads", "slopes"),
    "Bump": ("roads", "bumps"), "JunctionKind": ("roads", "junctions"), "Control": ("roads", "controls"),
    "IslandSize": ("roads", "islands"), "Take": ("roads", "takes"), "Side": ("roads", "sides"),
    "Way": ("roads", "ways"), "Surroundings": ("roads", "surroundings"), "CentreLine": ("roads", "centres"),
    "Compass": ("roads", "compass"), "Shown": ("scenes", "signals"),
    "Face": ("scenes", "faces"), "Works": ("scenes", "roadworks"),
}  # fmt: skip
"""The types of names, and the file and the part whose rows have them."""
OF_JUNCTIONS = {
    "PlainKind": ("plain", "end"), "MapJunctionKind": ("plain", "open"), "RampKind": ("ramp",),
    "LaneKind": ("lane",),
}  # fmt: skip
"""The types of some kinds of junctions, and the groups of these."""


def names() -> str:
    """Returns the text of ``names.py``: the names of the rows of the table as types."""
    files = ("road_users", "scenes", "roads")
    tables = {name: tomllib.loads((HERE / f"{name}.toml").read_text(encoding="utf-8")) for name in files}
    found = {type_: tables[file][part] if part else tables[file] for type_, (file, part) in TYPES.items()}
    rows = {type_: part.get("rows", [*part]) for type_, part in found.items()}
    for type_, groups in OF_JUNCTIONS.items():
        rows[type_] = [name for name, row in found["JunctionKind"].items() if row["group"] in groups]
    lines = ['"""The names in the table, as types. Made by ``python -m roadgpt.language``."""', ""]
    lines += ["from typing import Literal", "", "# fmt: off"]
    for type_, those in rows.items():
        row = f"{type_} = Literal{[*those]}".replace("'", '"')
        lines += textwrap.wrap(row, 109, subsequent_indent="    ")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    (HERE / "names.py").write_text(names(), encoding="utf-8")
