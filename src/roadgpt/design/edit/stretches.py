"""Stretches of a road by distance: "the last 80 m", "from station 50 to 100", "the first half"."""

from collections.abc import Iterator, Sequence
from itertools import compress
from math import ceil, degrees, floor, radians
from typing import NamedTuple

from roadgpt.brief.change.request import Target
from roadgpt.design.road_elements import RoadElement, RoadElements, with_stations
from roadgpt.errors import EditError
from roadgpt.road import Segment

LEAST_LENGTH = 5.0  # m of a stretch
LEAST_PIECE = 1.0  # m of a straight segment: a shorter piece is not cut off
LEAST_ARC = 4.0  # m of the arc of a turn on either side of a cut
TENTH = 10.0  # per degree
MOST_MOVED = 0.3  # share of a stretch by which its end may be moved to the end of a turn
MILLIMETRE = 1000.0


class RoadStretch(NamedTuple):
    """A part of a road, between two stations in metres from its start."""

    start: float
    end: float


def stretch_of(target: Target, elements: RoadElements) -> RoadStretch | None:
    """Returns the stretch that a target names by distances or as a half; None for any other target.

    A stretch may begin or end in the arc of a turn. If it would begin or end anywhere else within a bend, it
    begins or ends at the nearer end of that bend.

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
    """Returns the station, or the nearer end of the turn in which it lies; in an arc, the station itself.

    Raises:
        EditError: the station would be moved by more than a share of the stretch, which has this length.
    """
    for element, begin in with_stations(elements):
        for i, (_, start) in enumerate(_segment_stations(element.segments, begin)):
            if not element.is_of_arcs:
                break
            if i and _is_in_turn(element.segments, i) and abs(start - station) < LEAST_ARC:
                return start
            if _arc_cut(element.segments, i, start, station):
                return station
    for at, end in _bends(elements):
        if at < station < end:
            nearer = min(at, end, key=lambda each: abs(each - station))
            if abs(nearer - station) > MOST_MOVED * length:
                raise EditError(
                    f"station {station:.0f} m of this road lies in a turn and cannot be an end there; name "
                    "turns and straights, for example: from turn 2 on"
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

    A straight segment or an arc in which the stretch begins or ends is cut in two there.
    """
    cut = list(element.segments)
    for station in stretch:
        starts = list(_segment_stations(cut, at))
        cut = [part for i, (_, start) in enumerate(starts) for part in _cut(cut, i, start, station)]
    middles = (start + part.distance / 2 for part, start in _segment_stations(cut, at))
    return tuple(cut), tuple(stretch.start < middle < stretch.end for middle in middles)


def _segment_stations(segments: Sequence[Segment], at: float) -> Iterator[tuple[Segment, float]]:
    """Yields segments, each with the station at which it begins; the first begins at ``at``."""
    for segment in segments:
        yield segment, at
        at += segment.distance


def _is_in_turn(segments: Sequence[Segment], index: int) -> bool:
    """Returns whether a segment goes on with the turn of the segment before it."""
    return segments[index - 1].turn_degrees * segments[index].turn_degrees > 0


def _cut(segments: Sequence[Segment], index: int, at: float, station: float) -> Sequence[Segment]:
    """Returns a segment, which begins at station ``at``, in two parts if it is to be cut at ``station``."""
    segment = segments[index]
    if segment.turn_degrees:
        return _arc_cut(segments, index, at, station) or [segment]
    first = round((station - at) * MILLIMETRE) / MILLIMETRE
    rest = round((segment.distance - first) * MILLIMETRE) / MILLIMETRE
    if min(first, rest) < LEAST_PIECE:
        return [segment]
    return [segment.model_copy(update={"distance": each}) for each in (first, rest)]


def _arc_cut(segments: Sequence[Segment], index: int, at: float, station: float) -> list[Segment]:
    """Returns a segment of a turn in two parts with the same curvature, cut at the tenth of a degree that is
    nearest to ``station``; an empty list if there is no arc there, or the segment does not give its arc.
    """
    segment, away = segments[index], station - at
    if not segment.turn_degrees or not 0 < away < segment.distance:
        return []
    is_end = [not (0 < i < len(segments) and _is_in_turn(segments, i)) for i in (index, index + 1)]
    if any(is_end) and not (segment.radius and segment.transition):
        return []
    ramps = [(segment.transition or 0.0) if end else 0.0 for end in is_end]
    turned = radians(abs(segment.turn_degrees))
    radius = segment.radius if segment.radius and any(is_end) else segment.distance / turned
    if away - ramps[0] < LEAST_ARC or segment.distance - away - ramps[1] < LEAST_ARC:
        return []
    angle = round(degrees((away - ramps[0] / 2) / radius) * TENTH) / TENTH
    if not 0 < angle < abs(segment.turn_degrees):
        return []
    angles = angle, round((abs(segment.turn_degrees) - angle) * TENTH) / TENTH
    return [_arc(segment, *part, radius) for part in zip(angles, ramps, strict=True)]


def _arc(segment: Segment, angle: float, ramp: float, radius: float) -> Segment:
    """Returns a part of a segment of a turn, of so many degrees, with a ramp of so many metres or none.

    As in ``design.elements.cut``, parts with ramps are a hair long, and others a hair short, so that all of
    them keep the radius.
    """
    exact = (radius * radians(angle) + ramp / 2) * MILLIMETRE
    return segment.model_copy(
        update={
            "distance": (ceil(exact) if ramp else floor(exact)) / MILLIMETRE,
            "turn_degrees": angle if segment.turn_degrees > 0 else -angle,
            "radius": segment.radius if ramp else None,
            "transition": segment.transition if ramp else None,
        }
    )
