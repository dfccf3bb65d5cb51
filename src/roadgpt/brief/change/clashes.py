"""Refuses change requests whose changes cannot all be made at once, or do not fit the places they name."""

from collections.abc import Iterator, Sequence

from roadgpt.brief.change.request import NUMBERING, Change, Place, Target
from roadgpt.errors import EditError


def refuse_clashes(changes: Sequence[Change]) -> None:
    """Raises EditError if a change does not fit its place, or two changes need separate requests."""
    for change in changes:
        if fault := next(_faults(change), ""):
            raise EditError(fault)
    numbering = [change for change in changes if change.what in NUMBERING and not change.is_hill]
    counts = [change for change in changes if change.what == "count"]
    sides = [change.target.side for change in counts if change.target]
    are_of_both_sides = len(numbering) == len(sides) == 2 and {*sides} == {"left", "right"}
    if counts and len(numbering) > 1 and not are_of_both_sides:
        raise clash(counts[0], next(change for change in numbering if change is not counts[0]))


def clash(one: Change, other: Change) -> EditError:
    """Returns the error for two changes that cannot be made at once."""
    return EditError(f"'{one.words}' and '{other.words}' need requests of their own; make one change first")


def _faults(change: Change) -> Iterator[str]:
    target, words = change.target, change.words
    if target is not None and target.length is not None and target.noun == "road":
        metres = f"len={target.length:g}"
        yield f"'{words}' does not say which metres of the road; write start {metres} or end {metres}"
    yield from _distances_in(change.place)
    yield from _distances_in(Place("on", change.like))
    if target is not None:
        yield from _faults_of_target(target)
    if change.what == "count" and target is not None:
        of_all = ("kind", "side", "sharpness", "way", "every", "words")
        if target != Target("turn", **{name: getattr(target, name) for name in of_all}):
            yield (
                f"'{words}' counts the turns of a place; only all turns, or those of a side or a kind, can"
                " be counted, for example: turn left: x4"
            )
        if change.to is None or change.to < 1:
            yield f"'{words}' gives no number of turns; write for example: turn: x4"
    if change.is_hill and change.count > 1:
        yield f"'{words}' adds several at once; say where each one is to be"
    shape = (change.length, change.grade, change.degrees, change.radius)
    shape_in_words = (change.side, change.sharpness, change.way)
    if change.is_hill and (change.is_whole or any(each is not None for each in (*shape, *shape_in_words))):
        yield f"'{words}' gives a {change.kind} a shape; write only where it is to be"


def _faults_of_target(target: Target) -> Iterator[str]:
    place = target.place
    for distance in (target, *(place.ends if place else ())):
        if distance.is_distance and (distance.length or 0) < 0:
            yield f"'{distance.words}' is no distance; give metres from 0 on"
    if target.is_distance and target != Target(target.noun, length=target.length, words=target.words):
        yield f"'{target.words}' is a distance, which stands alone; leave the other words out"
    if target.noun == "road" and place and place.is_of_distances:  # a part of the road between distances
        is_plain = target == Target("road", place=place, words=target.words) and place.how != "on"
        is_plain = is_plain and len(place.ends) == (2 if place.how == "between" else 1)
        if not is_plain or not all(end.is_distance for end in place.ends):
            yield (
                f"'{target.words}' mixes distances with other words; write for example: "
                "road between(start len=50, start len=100)"
            )
    else:
        yield from _distances_in(place)
    yield from _distances_in(Place("on", target.but))


def _distances_in(place: Place | None) -> Iterator[str]:
    """Yields that a place is named by a distance, however deep."""
    for target in place.ends if place else ():
        if target.is_distance:
            yield f"'{target.words}' is a distance, which cannot name a place; name a turn or a straight"
        yield from _distances_in(target.place)
        yield from _distances_in(Place("on", target.but))
