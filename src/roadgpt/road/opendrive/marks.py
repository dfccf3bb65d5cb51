"""Reads the road marks at the edges of lanes."""

from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

from roadgpt.road.opendrive.lanes import Span
from roadgpt.road.opendrive.numbers import number
from roadgpt.road.opendrive.tree import Node
from roadgpt.road.profile import Marking

MARKS: dict[str, Marking] = {
    "solid": "solid",
    "broken": "broken",
    "solid solid": "solid",
    "solid broken": "solid",
    "broken solid": "solid",
    "broken broken": "broken",
    "botts dots": "broken",
    "custom": "solid",
}
"""The marking for each type of road mark that is a line."""


class MarkedLane(NamedTuple):
    """A lane in one lane section. Its XML element, ``node``, contains the road marks at the outer edge."""

    span: Span
    node: Node


def has_marks(road: Node) -> bool:
    """Returns whether the file contains a road mark for this road."""
    return any(
        road.all("lanes", "laneSection", side, "lane", "roadMark") for side in ("left", "center", "right")
    )


def marking(lanes: Iterable[MarkedLane]) -> tuple[Marking, bool]:
    """Returns the marking at the outer edge of a lane, and whether this marking changes along the road.

    If it changes, the marking with the largest total length is returned.

    Args:
        lanes: The parts of the lane, one from each lane section in which it exists.
    """
    lengths: dict[Marking, float] = {}
    for span, lane in lanes:
        marks = sorted(lane.all("roadMark"), key=lambda mark: number(mark, "sOffset", 0.0))
        starts = [span.section.s + number(mark, "sOffset", 0.0) for mark in marks]
        starts = [min(max(start, span.start), span.end) for start in starts]
        before = (starts[0] if starts else span.end) - span.start
        kinds = [MARKS.get(mark.attributes.get("type", "none"), "none") for mark in marks]
        reaches = [end - start for start, end in pairwise([*starts, span.end])]
        for kind, reach in zip(["none", *kinds], [before, *reaches], strict=True):
            lengths[kind] = lengths.get(kind, 0.0) + reach
    found = sorted((kind for kind, reach in lengths.items() if reach > 0), key=lambda kind: -lengths[kind])
    return (found[0] if found else "none"), len(found) > 1
