"""Reads the lane sections of an OpenDRIVE road, and the edge that becomes the centre line.

The driven side is the right-hand side, or the left-hand side if driving lanes cover more than twice as much
length there. The inner edge of the innermost driving lane on the driven side becomes the centre line of the
Road."""

from dataclasses import dataclass
from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.road.opendrive.tree import DRIVING, cubics, number

BESIDE = ("shoulder", "border")
EDGES = ("width", "border")  # elements of a lane that state its outer edge
NEAR = 1.0  # m; shorter parts without a driving lane are not reported
MOST_SECTIONS = 5_000
MOST_ACROSS = 200  # lanes on one side of a section


@dataclass(frozen=True)
class LaneElement:
    """One lane of a section, with either its width or its ``border``, the offset of its outer edge."""

    node: Element
    kind: str
    width: CubicProfile | None
    border: CubicProfile | None


@dataclass(frozen=True)
class LaneSection:
    """One lane section, with its lanes on both sides, ordered from the inside out."""

    s: float
    lanes: tuple[LaneElement, ...]  # the lanes on the driven side
    others: tuple[LaneElement, ...]  # the lanes on the side opposite to the driven side
    centre: tuple[Element, ...]  # lane 0, if there is one
    first: int  # index in ``lanes`` of the innermost driving lane; ``len(lanes)`` if there is none

    @property
    def is_driven(self) -> bool:
        """Whether there is a driving lane on the driven side."""
        return self.first < len(self.lanes)


class Span(NamedTuple):
    """A lane section that has a driving lane, with the stations in metres at which it begins and ends."""

    section: LaneSection
    start: float
    end: float


@dataclass(frozen=True)
class Lanes:
    """The lane sections of a road."""

    side: int  # -1 if the driven side is to the right of the reference line, 1 if it is to the left
    sections: tuple[LaneSection, ...]
    offset: CubicProfile | None
    angle: CubicProfile | None
    """The superelevation in radians, positive where the surface falls to the right of the reference line."""
    length: float

    def edge(self, s: Array) -> tuple[Array, Array]:
        """Returns offset and slope of the inner edge of the driving lanes at stations ``s``. The offset is in
        metres to the left of the reference line and is measured in plan; the slope is its change per metre.
        """
        t, slope = self.edge_on_surface(s)
        if self.angle is None:
            return t, slope
        cos, sin = np.cos(self.angle.height(s)), np.sin(self.angle.height(s))
        return t * cos, slope * cos - t * sin * self.angle.grade(s)

    def edge_on_surface(self, s: Array) -> tuple[Array, Array]:
        """Returns offset and slope as ``edge`` does, but measured along the inclined road surface."""
        t, slope = _both(self.offset, s)
        starts = np.array([section.s for section in self.sections])
        index = np.clip(np.searchsorted(starts, s, side="right") - 1, 0, len(starts) - 1)
        for i in np.unique(index):
            section, some = self.sections[i], index == i
            if section.is_driven:
                across, lean = self._outer(section, section.first - 1, s[some])
                t[some] += self.side * across
                slope[some] += self.side * lean
        return t, slope

    def _outer(self, section: LaneSection, last: int, s: Array) -> tuple[Array, Array]:
        """Returns the distance of the outer edge of ``section.lanes[last]`` from lane 0, and its slope."""
        across, lean = np.zeros(len(s)), np.zeros(len(s))
        for lane in section.lanes[: last + 1]:
            if lane.width is None and lane.border is not None:
                across, lean = _both(lane.border, s)
                across, lean = np.abs(across), np.where(across < 0, -lean, lean)
            else:
                more, leaning = _both(lane.width, s)
                across, lean = across + more, lean + leaning
        return across, lean

    def joints(self) -> list[float]:
        """Returns the stations at which the inner edge of the driving lanes may have a kink."""
        found = [section.s for section in self.sections]
        found += self.offset.stations if self.offset else ()
        found += self.angle.stations if self.angle else ()
        for section in self.sections:
            for lane in section.lanes[: section.first]:
                for profile in (lane.width, lane.border):
                    found += profile.stations if profile else ()
        return found

    def spans(self) -> list[Span]:
        """Returns the sections that have a driving lane and a length above 0, in order."""
        ends = [section.s for section in self.sections[1:]] + [self.length]
        starts = [max(section.s, 0.0) for section in self.sections]
        return [
            Span(section, start, end)
            for section, start, end in zip(self.sections, starts, ends, strict=True)
            if section.is_driven and end > start
        ]

    def stretches(self) -> list[tuple[float, float]]:
        """Returns the first and last station in metres of each continuous stretch with a driving lane."""
        found: list[tuple[float, float]] = []
        for _, start, end in self.spans():
            joins = bool(found) and start - found[-1][1] < NEAR
            found = [*found[:-1], (found[-1][0], end)] if joins else [*found, (start, end)]
        return found


def read_lanes(road: Element, length: float) -> Lanes:
    """Returns the lane sections of a road that is ``length`` metres long. Raises UsageError if it has no
    driving lane."""
    nodes = road.findall("lanes/laneSection")
    if not nodes:
        raise UsageError("it has no lane section; add <lanes>")
    if len(nodes) > MOST_SECTIONS:
        raise UsageError(f"it has more than {MOST_SECTIONS:,} lane sections; cut out the part that you need")
    offset = cubics(road.findall("lanes/laneOffset"), "s")
    angle = cubics(road.findall("lateralProfile/superelevation"), "s")
    starts = [number(node, "s") for node in nodes]
    centres = [tuple(node.findall("center/lane")) for node in nodes]
    on_right, on_left = (
        [_elements(node, side, s) for node, s in zip(nodes, starts, strict=True)]
        for side in ("right", "left")
    )
    right, left = (
        Lanes(side, tuple(map(_section, starts, lanes, others, centres)), offset, angle, length)
        for side, lanes, others in ((-1, on_right, on_left), (1, on_left, on_right))
    )
    along, against = (sum(end - start for start, end in lanes.stretches()) for lanes in (right, left))
    if along or against:
        return right if along >= against / 2 else left
    kinds = {lane.get("type", "?") for node in nodes for lane in node.findall("left/lane")}
    kinds |= {lane.get("type", "?") for node in nodes for lane in node.findall("right/lane")}
    told = ", ".join(sorted(kinds)[:6]) or "none"
    raise UsageError(f"it has no lane of type driving (its lanes are: {told}); take another road")


def _section(
    s: float, lanes: tuple[LaneElement, ...], others: tuple[LaneElement, ...], centre: tuple[Element, ...]
) -> LaneSection:
    first = next((i for i, lane in enumerate(lanes) if lane.kind in DRIVING), len(lanes))
    return LaneSection(s, lanes, others, centre, first)


def _elements(section: Element, side: str, s: float) -> tuple[LaneElement, ...]:
    nodes = sorted(section.findall(f"{side}/lane"), key=lambda lane: abs(number(lane, "id")))
    if len(nodes) > MOST_ACROSS:
        raise UsageError(f"its lane section at s = {s:g} has more than {MOST_ACROSS} lanes on one side")
    return tuple(
        LaneElement(lane, lane.get("type", ""), *(cubics(lane.findall(tag), "sOffset", s) for tag in EDGES))
        for lane in nodes
    )


def _both(profile: CubicProfile | None, s: Array) -> tuple[Array, Array]:
    if profile is None:
        return np.zeros(len(s)), np.zeros(len(s))
    return profile.height(s), profile.grade(s)
