"""Stretches of a road by distance: "the last 80 m", "from station 50 to 100", "the first half"."""

from collections.abc import Iterator, Sequence
from itertools import compress
from typing import NamedTuple

from roadgpt.brief.change.request import Target
from roadgpt.design.road_elements import RoadElement, RoadElements, with_stations
from roadgpt.errors import EditError
from roadgpt.road import Segment

LEAST_LENGTH = 5.0  # m of a stretch
LEAST_PIECE = 1.0  # m of a straight segment: a shorter piece is not cut off
MOST_MOVED = 0.3  # share of a stretch by which its end may be moved to the end of a turn
MILLIMETRE = 1000.0


class RoadStretch(NamedTuple):
    """A part of a road, between two stations in metres from its start."""

    start: float
    end: float


def stretch_of(target: Target, elements: RoadElements) -> RoadStretch | None:
    """Returns the stretch that a target names by distances or as a half; None for any other target.

    A stretch that would begin or end within a bend begins or ends at the nearer end of that bend.

    Raises:
        EditError: the road is shorter than the target says, the stretch is shorter than 5 m, or one of its
            ends would be moved too far.
    """
    whole = sum(element.length for element in elements)
    ends = _named_ends(target, whole)
    if ends is None:
        return None
    length = ends.end - ends.start
    furthest = max(ends.end, whole - ends.start)
    if furthest > whole + LEAST_PIECE:
        raise EditError(f"the road is only {whole:.0f} m long, not {furthest:g} m; name a shorter part of it")
    if length < LEAST_LENGTH:
        raise EditError(f"'{target.words}' is too short for a slope; name {LEAST_LENGTH:g} m or more")
    return RoadStretch(*(_outside_bends(max(station, 0.0), length, elements) for station in ends))


def _named_ends(target: Target, whole: float) -> RoadStretch | None:
    """Returns the stations that a target names, on a road of this length; None if it names none."""
    if target.is_distance:
        station = _station(target, whole)
        return RoadStretch(station, whole) if target.noun == "end" else RoadStretch(0.0, station)
    if target.noun != "road" or target.but or target.way:
        return None
    place = target.place
    if place is None and target.half:
        return RoadStretch(whole / 2, whole) if target.half == 2 else RoadStretch(0.0, whole / 2)
    if place is None or place.target is None or not place.is_of_distances:
        return None
    station = _station(place.target, whole)
    if place.other is not None:
        return RoadStretch(*sorted((station, _station(place.other, whole))))
    is_first = place.how in ("before", "up_to")
    return RoadStretch(0.0, station) if is_first else RoadStretch(station, max(station, whole))


def _station(target: Target, whole: float) -> float:
    assert target.length is not None
    return whole - target.length if target.noun == "end" else target.length


def _outside_bends(station: float, length: float, elements: RoadElements) -> float:
    """Returns the station, or the nearer end of the turn in which it lies.

    Raises:
        EditError: the station would be moved by more than a share of the stretch, which has this length.
    """
    for at, end in _bends(elements):
        if at < station < end:
            nearer = min(at, end, key=lambda each: abs(each - station))
            if abs(nearer - station) > MOST_MOVED * length:
                raise EditError(
                    f"station {station:.0f} m of this road lies in a turn, which keeps one slope; name turns "
                    "and straights, for example: from turn 2 on"
                )
            return nearer
    return station


def _bends(elements: RoadElements) -> Iterator[tuple[float, float]]:
    """Yields the stations at which each turn, and each bend too slight for a turn, begins and ends."""
    for element, at in with_stations(elements):
        if element.is_turn:
            yield at, at + element.length
        else:
            for segment, start in _segment_stations(element.segments, at):
                if segment.turn_degrees:
                    yield start, start + segment.distance


def within(elements: RoadElements, stretch: RoadStretch) -> RoadElements:
    """Returns the elements, each with only those of its segments that lie in the stretch.

    Elements without such a segment are left out.
    """
    parts = (
        element.with_segments(compress(*pieces(element, at, stretch)))
        for element, at in with_stations(elements)
    )
    return tuple(part for part in parts if part.segments)


def pieces(
    element: RoadElement, at: float, stretch: RoadStretch
) -> tuple[tuple[Segment, ...], tuple[bool, ...]]:
    """Returns the segments of an element that begins at station ``at``, and which of them lie in a stretch.

    A straight segment in which the stretch begins or ends is cut in two there.
    """
    pairs = _segment_stations(element.segments, at)
    cut = [part for segment, start in pairs for part in _cut(segment, start, stretch)]
    middles = (start + part.distance / 2 for part, start in _segment_stations(cut, at))
    return tuple(cut), tuple(stretch.start < middle < stretch.end for middle in middles)


def _segment_stations(segments: Sequence[Segment], at: float) -> Iterator[tuple[Segment, float]]:
    """Yields segments, each with the station at which it begins; the first begins at ``at``."""
    for segment in segments:
        yield segment, at
        at += segment.distance


def _cut(segment: Segment, at: float, stretch: RoadStretch) -> list[Segment]:
    if segment.turn_degrees:
        return [segment]
    out = [segment]
    for station in stretch:
        before = sum(part.distance for part in out[:-1])
        first = round((station - at - before) * MILLIMETRE) / MILLIMETRE
        rest = round((out[-1].distance - first) * MILLIMETRE) / MILLIMETRE
        if min(first, rest) >= LEAST_PIECE:
            out[-1:] = [out[-1].model_copy(update={"distance": each}) for each in (first, rest)]
    return out
