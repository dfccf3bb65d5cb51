"""The name of a test: cell and number, such as ``c01/17``, in a campaign; the number alone in a folder of
runs.
"""

from typing import NamedTuple


class NumberedTest(NamedTuple):
    """Cell and number of a test.

    Its text is the part after the folder's name in a command: ``c01/17`` in ``roadgpt view hard/c01/17``.
    """

    cell: str
    """Name of the test's cell; empty for a run in a folder of runs."""
    number: int

    def __str__(self) -> str:
        return f"{self.cell}/{self.number}" if self.cell else f"{self.number}"
