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
        """Adds a road and returns its id.

        Args:
            road: The road, with a profile.
            junction: The id of the junction, if this is a connecting road.
            number: The id that the road gets; None for the next free one.
        """
        number = self.number() if number is None else number
        self.roads[number] = NetworkRoad(number, road, junction)
        return number

    def network(self) -> Network:
        """Returns the finished network, with the roads in the order of their ids."""
        ordered = tuple(self.roads[number] for number in sorted(self.roads))
        return Network(ordered, tuple(self.junctions), tuple(self.roundabouts), tuple(self.continuations))


@dataclass(frozen=True)
class Stub:
    """The end of a road at a junction that is not built yet. Traffic drives on the right."""

    end: RoadEnd
    direction: float
    """The heading in radians out of the junction."""
    profile: Profile
    station: float
    """The station in metres of this end of the road."""

    @cached_property
    def into(self) -> tuple[Lane, ...]:
        """The driving lanes that lead into the junction, from the centre line outwards."""
        return _driving(self.profile.right if self.end.contact == "end" else self.profile.left)

    @cached_property
    def out_of(self) -> tuple[Lane, ...]:
        """The driving lanes that lead out of the junction, from the centre line outwards."""
        return _driving(self.profile.left if self.end.contact == "end" else self.profile.right)

    def id_into(self, index: int) -> int:
        """Returns the id of a lane that leads into the junction; lanes count from 0 at the centre line."""
        return -(index + 1) if self.end.contact == "end" else self.profile.against_ids[index]

    def id_out_of(self, index: int) -> int:
        """Returns the id of a lane that leads out of the junction; lanes count from 0 at the centre line."""
        return self.profile.against_ids[index] if self.end.contact == "end" else -(index + 1)

    def width_of(self, lane: Lane) -> float:
        """Returns the width in metres of a lane at the junction."""
        return width_at(lane.width, self.station)

    def inside_into(self, index: int) -> float:
        """Returns the distance in metres from the reference line to the left edge of a lane that leads into
        the junction. Left and right are those of the driver; the distance is positive to the right.
        """
        edge = -self._offset if self.end.contact == "end" else self._offset + self.profile.median
        return edge + sum(map(self.width_of, self.into[:index]))

    def inside_out_of(self, index: int) -> float:
        """Returns the distance in metres from the reference line to the left edge of a lane that leads out of
        the junction. Left and right are those of the driver; the distance is positive to the right.
        """
        edge = -self._offset if self.end.contact == "start" else self._offset + self.profile.median
        return edge + sum(map(self.width_of, self.out_of[:index]))

    @property
    def _offset(self) -> float:
        return width_at(self.profile.offset, self.station)

    @property
    def mouth(self) -> tuple[float, float]:
        """The total widths in metres, at the junction, of the lanes into it and of the lanes out of it."""
        return sum(map(self.width_of, self.into)), sum(map(self.width_of, self.out_of))


def _driving(lanes: Sequence[Lane]) -> tuple[Lane, ...]:
    return tuple(lane for lane in lanes if lane.kind == "driving")


def width_at(width: Width, s: float) -> float:
    """Returns the value in metres, at station ``s``, of a width that is constant or varies along a road."""
    return float(width.cubic(max(s, width.stations[0]))[0]) if isinstance(width, CubicProfile) else width


def edges_at(profile: Profile, s: float) -> tuple[float, float]:
    """Returns the offsets of the left and the right edge of the carriageway at station ``s``, in metres.

    The result is that of ``Profile.edges``, without the overhead of arrays.
    """
    centre, (left, right), count = width_at(profile.offset, s), profile.begins, profile.count
    if profile.left_hand:
        count = count[::-1]
    return (
        centre + left + sum(width_at(lane.width, s) for lane in profile.left[: count[1]]),
        centre - right - sum(width_at(lane.width, s) for lane in profile.right[: count[0]]),
    )


def level(length: float, z: float) -> GradeProfile:
    """Returns the elevation profile of a level road, from its length and its height ``z`` in metres."""
    return GradeProfile(z, (0.0, length), (0.0, 0.0))


Change = tuple[float, float]
"""A width or an offset in metres at the start and at the end of a road."""


def one_way(
    widths: Sequence[Change], length: float, offset: Change = (0.0, 0.0), between: Marking = "none"
) -> Profile:
    """Returns the cross-section of a road with lanes on the right only.

    Args:
        widths: The width of each lane, from left to right, at the start and at the end of the road; between
            them, the width changes smoothly.
        length: Length of the road in metres.
        offset: The offset of the left edge of the leftmost lane from the reference line, positive to the
            left, at the start and at the end of the road.
        between: The marking between two lanes. The outer edges have no marking.
    """
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
    offset: Change = (0.0, 0.0),
    between: Marking = "none",
) -> Road:
    """Returns a level connecting road.

    Args:
        start: The point in metres at which the reference line begins.
        heading: The heading there in radians.
        pieces: The lines, arcs and clothoids of the reference line.
        widths: As for ``one_way``.
        offset: As for ``one_way``.
        between: As for ``one_way``.
    """
    x, y, z = start
    plan = PieceCurve(x, y, heading, tuple(pieces))
    return Road(plan, level(plan.length, z), profile=one_way(widths, plan.length, offset, between))
