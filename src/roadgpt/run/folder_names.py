"""Makes names for campaigns' folders that are safe in paths, whatever the description contains."""

import re
import unicodedata
from pathlib import Path

from roadgpt.errors import UsageError, explained

HOME = Path("roadgpt-runs")
LONGEST = 40  # letters of a description


def slug(words: str) -> str:
    """Returns a description as a path component: only a-z, 0-9 and '-', at most 40 characters; "road" if
    no character is left."""
    plain = unicodedata.normalize("NFKD", words[:1000].casefold()).encode("ascii", "ignore").decode()
    return re.sub(r"[^a-z0-9]+", "-", plain.lower()).strip("-")[:LONGEST].strip("-") or "road"


def new_folder(words: str, seed: int, home: Path = HOME) -> Path:
    """Creates a new folder named after the description and the seed; a number is appended if the name is
    taken.

    Raises:
        UsageError: the folder cannot be created.
    """
    name, number = f"{slug(words)}-{seed}", 1
    with explained(UsageError, f"cannot make a folder in {home}", "say --out FOLDER"):
        home.mkdir(parents=True, exist_ok=True)
        while True:
            folder = home / (name if number == 1 else f"{name}-{number}")
            try:
                folder.mkdir()
            except FileExistsError:
                number += 1
            else:
                return folder
