"""The chapters of reports, and the door for those of other packages.

A plug-in ``chapters`` is a function that gets the Record of a folder of runs or of a campaign, and returns a
``Chapter``, or None if it has nothing to tell of it."""

from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

from roadgpt import plugins
from roadgpt.campaign.record import Record
from roadgpt.report.page.model import Section


class Chapter(NamedTuple):
    """A chapter of a report."""

    section: Section
    sentences: tuple[str, ...] = ()  # for the summary at the begin of the report
    is_first: bool = False  # whether section and sentences stand before those of the report itself, or after


def with_chapters(
    record: Record, sections: Sequence[Section], sentences: Sequence[str]
) -> tuple[list[Section], list[str]]:
    """Returns sections and sentences of a report with those of the plug-ins."""
    every = [plugins.find("chapters", name)(record) for name in plugins.names("chapters")]
    found: list[Chapter] = [each for each in every if each is not None]
    first, last = ([each for each in found if each.is_first is wanted] for wanted in (True, False))
    return (
        [*(each.section for each in first), *sections, *(each.section for each in last)],
        [*chain(*(each.sentences for each in first)), *sentences, *chain(*(each.sentences for each in last))],
    )
