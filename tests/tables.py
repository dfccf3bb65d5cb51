"""Tables of tests: one JSONL file beside the test, with one row a line under the name of its table."""

import json
from pathlib import Path
from typing import Any


def rows(test: str, table: str) -> list[Any]:
    """The rows of a table beside ``test``, which a test gives as ``__file__``."""
    lines = Path(test).with_suffix(".jsonl").read_text(encoding="utf-8").splitlines()
    return [row for line in lines for name, row in json.loads(line).items() if name == table]
