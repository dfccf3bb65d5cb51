"""Selects the driven lane of an OpenDRIVE road, and reads its inner edge, width, speed limit and friction.

The driven lane is the innermost driving lane on the right, or on the left if there is none on the right. Its
inner edge becomes the centre line of the Road.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile
from roadgpt.geometry.curve import Array
from roadgpt.road.opendrive.numbers import cubics, number
from roadgpt.road.opendrive.tree import DRIVING, Node

BESIDE = ("shoulder", "border")
UNITS = {"m/s": 1.0, "km/h": 3.6, "mph": 3600 / 1609.344}  # per m/s
NEAR = 1.0  # m; shorter parts without a driving lane are not reported
PLACES = 64  # per lane section, at which widths are sampled
MOST_SECTIONS = 5_000

Which = Callable[["LaneSection"], tuple[int, int]]
"""A function that returns the indices of the first and the last lane of a group of lanes in a section."""


@dataclass(frozen=True)
class LaneElement:
    """One lane of a lane section. Either ``width`` or ``border``, the offset of its outer edge, is given."""

    node: Node
    kind: str
    width: CubicProfile | None
    border: CubicProfile | None


@dataclass(frozen=True)
class LaneSection:
    """One lane section, with the lanes on the side of the driven lane, ordered from the inside out."""

    s: float
    lanes: tuple[LaneElement, ...]
    driven: int
    """Index of the driven lane in ``lanes``; the number of lanes if this section has no driven lane."""


@dataclass(frozen=True)
class Lanes:
    """The lane sections of a road, with the lanes on the side of the driven lane."""

    side: int
    """-1 where the driven lane is to the right of the reference line, 1 where it is to the left."""
    sections: tuple[LaneSection, ...]
    offset: CubicProfile | None
    length: float

    def edge(self, s: Array) -> tuple[Array, Array]:
        """Returns the offset of the driven lane's inner edge at stations ``s``, and the slope of the offset.

        The offset is in metres to the left of the reference line; the slope is its change per metre.
        """
        t, slope = _both(self.offset, s)
        starts = np.array([section.s for section in self.sections])
        index = np.clip(np.searchsorted(starts, s, side="right") - 1, 0, len(starts) - 1)
        for i in np.unique(index):
            section, some = self.sections[i], index == i
            if section.driven < len(section.lanes):
                across, lean = self._outer(section, section.driven - 1, s[some])
                t[some] += self.side * across
                slope[some] += self.side * lean
        return t, slope

    def _outer(self, section: LaneSection, last: int, s: Array) -> tuple[Array, Array]:
        """Returns how far the outer edge of a lane is from lane 0, and its slope; 0 before the first lane."""
        across, lean = np.zeros(len(s)), np.zeros(len(s))
        for lane in section.lanes[: last + 1]:
            if lane.width is None and lane.border is not None:
                across, lean = (np.abs(each) for each in _both(lane.border, s))
            else:
                more, leaning = _both(lane.width, s)
                across, lean = across + more, lean + leaning
        return across, lean

    def joints(self) -> list[float]:
        """Returns the stations at which the inner edge of the driven lane may have a kink."""
        found = [section.s for section in self.sections]
        found += self.offset.stations if self.offset else ()
        for section in self.sections:
            for lane in section.lanes[: section.driven]:
                for profile in (lane.width, lane.border):
                    found += profile.stations if profile else ()
        return found

    def lane_widths(self) -> Array:
        """Returns widths of the driven lane in metres, sampled along the road."""
        return self._spread(lambda section: (section.driven, section.driven))

    def shoulder_widths(self) -> Array:
        """Returns widths in metres of the shoulder outside the driving lanes, sampled along the road."""

        def beside(section: LaneSection) -> tuple[int, int]:
            kinds = [lane.kind for lane in section.lanes]
            first = section.driven
            while first < len(kinds) and kinds[first] in DRIVING:
                first += 1
            last = first
            while last < len(kinds) and kinds[last] in BESIDE:
                last += 1
            return first, last - 1

        return self._spread(beside)

    def _spread(self, which: Which) -> Array:
        """Returns the width from the first to the last lane of each section, sampled along the road."""
        ends = [section.s for section in self.sections[1:]] + [self.length]
        found = []
        for section, end in zip(self.sections, ends, strict=True):
            if section.driven == len(section.lanes):
                continue
            first, last = which(section)
            s = np.linspace(section.s, max(end, section.s) - 1e-6, PLACES)
            found.append(self._outer(section, last, s)[0] - self._outer(section, first - 1, s)[0])
        return np.concatenate(found)

    def spans(self) -> list[tuple[float, float]]:
        """Returns the first and the last station in metres of every part with a driving lane."""
        ends = [section.s for section in self.sections[1:]] + [self.length]
        found: list[tuple[float, float]] = []
        for section, end in zip(self.sections, ends, strict=True):
            start = max(section.s, 0.0)
            if section.driven < len(section.lanes) and end > start:
                joins = bool(found) and start - found[-1][1] < NEAR
                found = [*found[:-1], (found[-1][0], end)] if joins else [*found, (start, end)]
        return found

    def driven(self) -> Iterator[Node]:
        """Yields the driven lane of each section that has one."""
        return (each.lanes[each.driven].node for each in self.sections if each.driven < len(each.lanes))


def read_lanes(road: Node, length: float) -> Lanes:
    """Returns the lane sections of a road that is ``length`` metres long.

    Raises:
        UsageError: The road has no lanes, or no driving lane.
    """
    nodes = road.all("lanes", "laneSection")
    if not nodes:
        raise UsageError("it has no lane section; add <lanes>")
    if len(nodes) > MOST_SECTIONS:
        raise UsageError(f"it has more than {MOST_SECTIONS:,} lane sections; cut out the part that you need")
    nodes.sort(key=lambda node: number(node, "s"))
    offset = cubics(road.all("lanes", "laneOffset"), "s")
    right, left = (
        Lanes(side, tuple(_section(node, name) for node in nodes), offset, length)
        for side, name in ((-1, "right"), (1, "left"))
    )
    on_right, on_left = (sum(end - start for start, end in lanes.spans()) for lanes in (right, left))
    if on_right or on_left:
        return right if on_right >= on_left / 2 else left
    kinds = {lane.attributes.get("type", "?") for node in nodes for lane in node.all("left", "lane")}
    kinds |= {lane.attributes.get("type", "?") for node in nodes for lane in node.all("right", "lane")}
    told = ", ".join(sorted(kinds)[:6]) or "none"
    raise UsageError(f"it has no lane of type driving (its lanes are: {told}); take another road")


def _section(node: Node, side: str) -> LaneSection:
    s = number(node, "s")
    nodes = sorted(node.all(side, "lane"), key=lambda lane: abs(number(lane, "id")))
    lanes = tuple(
        LaneElement(
            lane,
            lane.attributes.get("type", ""),
            cubics(lane.all("width"), "sOffset", s),
            cubics(lane.all("border"), "sOffset", s),
        )
        for lane in nodes
    )
    driven = next((i for i, lane in enumerate(lanes) if lane.kind in DRIVING), len(lanes))
    return LaneSection(s, lanes, driven)


def _both(profile: CubicProfile | None, s: Array) -> tuple[Array, Array]:
    if profile is None:
        return np.zeros(len(s)), np.zeros(len(s))
    return profile.height(s), profile.grade(s)


def speed_limit(road: Node, lanes: Lanes) -> float | None:
    """Returns the first speed limit of the driven lane in m/s.

    If the lane has none, that of the road is returned; None if the road has none.
    """
    return next(iter(speed_limits(road, lanes)), None)


def speed_limits(road: Node, lanes: Lanes) -> list[float]:
    """Returns all speed limits of the driven lane in m/s, in driving order.

    If the lane has none, those of the road are returned.
    """
    of_lane = [node for lane in lanes.driven() for node in lane.all("speed")]
    return _speeds(of_lane) or _speeds(road.all("type", "speed"))


def _speeds(nodes: Sequence[Node]) -> list[float]:
    return [
        number(node, "max") / UNITS.get(node.attributes.get("unit", "m/s"), 1.0)
        for node in nodes
        if node.attributes.get("max") not in (None, "no limit", "undefined")
    ]


def friction(lanes: Lanes) -> float | None:
    """Returns the friction of the driven lane in the file; None where the file gives none."""
    said = [node for lane in lanes.driven() for node in lane.all("material") if "friction" in node.attributes]
    return number(said[0], "friction") if said else None
