"""What agents have to know, by topic: ``knowledge.md``, whose lists come from the table of the language."""

import re
import tomllib
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from roadgpt.language import table
from roadgpt.reading import read_text

HERE = Path(__file__).parent
HEAD, TEXT = read_text(HERE / "knowledge.md").split("\n\n", 1)
DATA: dict[str, Any] = tomllib.loads(read_text(HERE / "knowledge.toml"))
OF_SOMEBODY = ("gap", "headway", "lead", "station", "speed", "faster", "overlap", "impact", "offset", "away")


@cache
def topics(whose: str = "tools") -> Mapping[str, str]:
    """Returns the texts by topic, for agents with the tools of the server, or with the commands."""
    lists: Mapping[str, Callable[[str], str]] = {**LISTS, "do": DATA[whose].__getitem__}
    text = re.sub(r"\$(\w+):(\w+)", lambda found: lists[found[1]](found[2]), TEXT)
    parts = re.findall(r"^## (\w+): (.+\n(?:(?!## ).*\n)+)", text, re.M)
    worked = "\n".join(f"- {each['text']}\n  `{each['plan']}`\n  {each['says']}" for each in DATA["worked"])
    return {name: f"## {said}" for name, said in parts} | {"examples": f"## Texts and plans\n{worked}\n"}


def skill() -> str:
    """Returns the page for coding agents."""
    return f"{HEAD}\n\n{''.join(topics('commands').values())}"


def _part(thing: str) -> str:
    """Returns what a thing can have, as plans write it."""
    said = list[str]()
    for name, part in table.PARTS[thing].items():
        key = "x3" if part.key == table.COUNTED else f"{part.key}=" if part.key else ""
        said.append(f"{name}(...)" if part.brackets else key + "|".join(part.words))
        said += filter(None, (part.zero, part.double and f"{part.double}="))
    return f"`{' '.join(said)}`"


def _listed(name: str) -> str:
    rows = getattr(table, name, None) or table.SCENES.get(name) or table.named_in(name)
    return f"`{' '.join(rows.get('rows', rows) if isinstance(rows, dict) else rows)}`"


def _told(name: str) -> str:
    """Returns the rows of a part of scenes, in words."""
    if name == "places":
        said = [f"`{each}`{' and a side' * bool(row.side)}: {row.said}" for each, row in table.PLACES.items()]
    elif name == "numbers":
        rows = (table.NUMBERS[each] for each in OF_SOMEBODY)
        said = [f"`{row.key}=` {row.said.format('N')} ({row.least:g} to {row.most:g})" for row in rows]
    elif name == "weather":
        said = [f"`{each}`, {'mm/h' if row.falls else 'm of sight'}" for each, row in table.WEATHER.items()]
    else:
        said = [_action(each, row) for each, row in table.MANEUVERS.items() if row.who]
    return "\n".join(f"- {each}" for each in said)


def _action(name: str, row: table.ManeuverRow) -> str:
    keys = [f"{table.NUMBERS[each].key}=" for each in row.numbers]
    numbers = [f"[{key[:-1]}]" for key in keys[:1]] + keys[1:]
    starts = "" if len(row.starts) == len(table.PLACES) else f"; {', '.join(row.starts)}"
    return f"`{' '.join([name, *numbers])}` {row.said}{' (and a side)' * row.side}{starts}"


LISTS: Mapping[str, Callable[[str], str]] = {"part": _part, "list": _listed, "told": _told}
