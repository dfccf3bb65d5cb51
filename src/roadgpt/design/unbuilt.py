"""Names what a plan can ask for and no designer can build yet."""

from collections.abc import Iterator

from roadgpt.brief.junctions import RAMPS, JunctionClause
from roadgpt.brief.model import Brief
from roadgpt.errors import DesignError


def check_built(brief: Brief) -> None:
    """Checks whether everything that a Brief asks for can be built.

    Raises:
        DesignError: It cannot be built yet; the message names each such thing.
    """
    found = list(dict.fromkeys(_unbuilt(brief)))
    if found:
        *others, last = found
        named = f"{', '.join(others)} and {last}" if others else last
        raise DesignError(f"{named} cannot be built yet; leave {'them' if others else 'it'} out")


def _unbuilt(brief: Brief) -> Iterator[str]:
    if brief.left_hand:
        yield "traffic on the left"
    for junction in brief.junctions:
        yield from _of_junction(junction)
    if brief.divided:
        yield "a median of a single road"


def _of_junction(junction: JunctionClause) -> Iterator[str]:
    if junction.kind in RAMPS and junction.side == "left":
        yield "a ramp on the left"
