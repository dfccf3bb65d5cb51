"""Makes the section on what to try if no road failed."""

from collections.abc import Sequence

from roadgpt.report.page import Section, Table, cell

Steps = Sequence[tuple[str, str]]
"""Pairs of a description and a command."""


def what_to_try(steps: Steps) -> list[Section]:
    """Returns a section with the commands; empty if there are none."""
    if not steps:
        return []
    rows = [[cell(why), cell(command)] for why, command in steps]
    caption = "No road failed; what may find one that does"
    return [Section("What to try next", [Table("next", caption, ["what", "command"], rows)])]
