"""Collects the roads and junctions of a network while it is built, and gives them their ids."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve
from roadgpt.network.network import Continuation, Junction, Network, NetworkRoad, RoadEnd, Roundabout
from roadgpt.road import Profile, Road
from roadgpt.road.profile import Lane, Marking, Width


@dataclass
class Builder:
    """A network under construction."""

    roads: dict[int, NetworkRoad] = field(default_factory=dict)
    junctions: list[Junction] = field(default_factory=list)
    roundabouts: list[Roundabout] = field(default_factory=list)
    continuations: list[Continuation] = field(default_factory=list)
    _last: int = 0

    def number(self) -> int:
        """Returns the next free id. Roads and junctions are numbered in one series."""
        self._last += 1
        return self._last

    def add(self, road: Road, junction: int | None = None, number: int | None = None) -> int:
        """Adds a road that has a profile; returns its id: ``number`` or, for None, the next free one.
        ``junction`` is the id of the junction to which a connecting road belongs."""
        number = self.number() if number is None else number
        self.roads[number] = NetworkRoad(number, road, junction)
        return number

    def stub(self, end: RoadEnd, direction: float) -> "Stub":
        """Returns the end of a road that leads out of a junction in a direction, given in radians."""
        member = self.roads[end.road]
        return Stub(end, direction, member.profile, member.road.length if end.contact == "end" else 0.0)

    def network(self) -> Network:
        """Returns the finished network, with the roads in the order of their ids."""
        ordered = tuple(self.roads[number] for number in sorted(self.roads))
        return Network(ordered, tuple(self.junctions), tuple(self.roundabouts), tuple(self.continuations))


@dataclass(frozen=True)
class Stub:
    """The end of a road at a junction that is not built yet. Traffic drives on the right."""

    end: RoadEnd
    direction: float  # the heading in radians out of the junction
    profile: Profile
    station: float  # the station in metres of this end of the road

    @cached_property
    def into(self) -> "StubLanes":
        """The driving lanes that lead into the junction."""
        return self._lanes(self.end.contact == "end")

    @cached_property
    def out_of(self) -> "StubLanes":
        """The driving lanes that lead out of the junction."""
        return self._lanes(self.end.contact == "start")

    def _lanes(self, is_along: bool) -> "StubLanes":
        profile, offset = self.profile, width_at(self.profile.offset, self.station)
        lanes = profile.right if is_along else profile.left
        return StubLanes(
            profile.along_ids if is_along else profile.against_ids,
            tuple(width_at(lane.width, self.station) for lane in lanes if lane.kind == "driving"),
            -offset if is_along else offset + profile.median,
        )


@dataclass(frozen=True)
class StubLanes:
    """The driving lanes of a stub in one direction, from the centre line outwards."""

    ids: range
    widths: tuple[float, ...]  # the widths in metres at the junction
    edge: float
    """The distance in metres from the reference line to the left edge of the first lane. Left and right are
    those of the driver; the distance is positive to the right."""

    def __len__(self) -> int:
        return len(self.widths)

    def inside(self, index: int) -> float:
        """Returns the distance to the left edge of a lane, measured as ``edge`` is for the first lane."""
        return self.edge + sum(self.widths[:index])


def width_at(width: Width, s: float) -> float:
    """Returns the value in metres, at station ``s``, of a width that is constant or varies along a road."""
    return float(width.cubic(max(s, width.stations[0]))[0]) if isinstance(width, CubicProfile) else width


def edges_at(profile: Profile, s: float) -> tuple[float, float]:
    """Returns the offsets of ``Profile.edges`` at one station, without the overhead of arrays."""
    centre, (left, right), count = width_at(profile.offset, s), profile.begins, profile.count
    if profile.left_hand:
        count = count[::-1]
    return (
        centre + left + sum(width_at(lane.width, s) for lane in profile.left[: count[1]]),
        centre - right - sum(width_at(lane.width, s) for lane in profile.right[: count[0]]),
    )


Change = tuple[float, float]
"""A width or an offset in metres at the start and at the end of a road."""


def one_way(
    widths: Sequence[Change], length: float, offset: Change = (0.0, 0.0), between: Marking = "none"
) -> Profile:
    """Returns the cross-section of a road with lanes on the right only, given by their widths from left to
    right. ``offset`` is that of the first lane's left edge, positive to the left of the reference line.
    Widths and offset change smoothly over ``length`` metres. ``between`` is the marking between lanes; the
    outer edges have none."""
    return _one_way(tuple(_changing(each, length) for each in widths), _changing(offset, length), between)


@lru_cache(maxsize=256)
def _one_way(widths: tuple[Width, ...], offset: Width, between: Marking) -> Profile:
    """Returns one Profile for all connecting roads that have the same lanes, since a Profile takes long."""
    marks: list[Marking] = [*[between] * (len(widths) - 1), "none"]
    lanes = tuple(Lane("driving", width, mark) for width, mark in zip(widths, marks, strict=True))
    return Profile((), lanes, 0, "none", offset=offset)


def _changing(change: Change, length: float) -> Width:
    first, last = change
    same = math.isclose(first, last, abs_tol=1e-9)
    return first if same else CubicProfile.smooth([(0.0, first), (length, last)])


def connecting_road(
    start: tuple[float, float, float],
    heading: float,
    pieces: Sequence[Piece],
    widths: Sequence[Change],
    offset: Change,
    between: Marking = "none",
) -> Road:
    """Returns a level connecting road that begins at a point in metres with a heading in radians; for
    ``widths``, ``offset`` and ``between`` see ``one_way``."""
    x, y, z = start
    plan = PieceCurve(x, y, heading, tuple(pieces))
    return Road(
        plan, GradeProfile.level(plan.length, z), profile=one_way(widths, plan.length, offset, between)
    )
