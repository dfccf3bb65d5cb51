"""Tables of texts that lie beside the tests which use them: one row of JSON in each line."""

import json
from pathlib import Path
from typing import Any


def rows(test: str, name: str) -> list[tuple[Any, ...]]:
    """The table of this name; ``test`` is the ``__file__`` of the test."""
    text = Path(test).with_name(f"{name}.jsonl").read_text(encoding="utf-8")
    return [tuple(json.loads(line)) for line in text.splitlines()]
