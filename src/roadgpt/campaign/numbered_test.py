"""What tests are called: ``c01/17`` in a campaign, ``17`` in a folder of runs."""

from typing import NamedTuple


class NumberedTest(NamedTuple):
    """One test; as text, what a command takes behind the folder: ``roadgpt view hard/c01/17``."""

    cell: str
    """Empty in a folder of runs."""
    number: int

    def __str__(self) -> str:
        return f"{self.cell}/{self.number}" if self.cell else f"{self.number}"
