"""The name of one test: ``c01/17`` in a campaign, ``17`` in a folder of runs."""

from typing import NamedTuple


class NumberedTest(NamedTuple):
    """Cell and number of a test; as text, what a command takes behind the folder: ``roadgpt view
    hard/c01/17``."""

    cell: str
    """Name of the cell; empty in a folder of runs."""
    number: int

    def __str__(self) -> str:
        return f"{self.cell}/{self.number}" if self.cell else f"{self.number}"
