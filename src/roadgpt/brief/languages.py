"""The table of the words of five languages that are recognised without the network: ``languages.toml``."""

import re
import tomllib
from pathlib import Path
from typing import Any

from roadgpt.reading import read_text

TABLE: dict[str, Any] = tomllib.loads(read_text(Path(__file__).with_name("languages.toml")))


def word_set(name: str) -> frozenset[str]:
    """Returns the words that have this name in the table."""
    return frozenset(TABLE["words"][name].split())


def pattern_of(name: str, part: str = "patterns", flags: int = 0) -> re.Pattern[str]:
    """Returns the pattern that has this name in a part of the table, where it may have several lines."""
    return re.compile(TABLE[part][name].replace("\n", ""), flags)
