"""Refuses change requests whose changes cannot all be made at once, or do not fit the places they name."""

from collections.abc import Sequence

from roadgpt.design.edit.request import HILLS, OF_SLOPE, Change, Place, Target, What
from roadgpt.design.edit.stretches import is_distance, is_of_distances
from roadgpt.errors import EditError

REORDERS: tuple[What, ...] = ("swap", "move")
"""Changes that put turns in another order."""
NUMBERING: tuple[What, ...] = ("add", "remove", "count", "straighten")
"""Changes with which a road gets other turns and straights."""


def refuse_clashes(changes: Sequence[Change]) -> None:
    """Checks that all changes of a request can be made at once.

    Raises:
        EditError: a change does not fit its place, or two changes need separate requests.
    """
    for change in changes:
        _check_places(change)
        if change.what == "count":
            _check_count(change)
        if is_hill(change):
            _check_hill(change)
    whats = {change.what for change in changes}
    numbering = [change for change in changes if change.what in NUMBERING and not is_hill(change)]
    counts = [change for change in changes if change.what == "count"]
    if counts and len(numbering) > 1:
        raise clash(counts[0], next(change for change in numbering if change is not counts[0]))
    moves = [change for change in changes if change.what in REORDERS]
    if moves and numbering:
        raise clash(moves[0], numbering[0])
    sloped = [change for change in changes if change.what in OF_SLOPE]
    far = [change for change in sloped if change.target and _is_by_distance(change.target)]
    if far and (numbering or moves):
        raise clash(far[0], (numbering or moves)[0])
    hills = [change for change in changes if is_hill(change)]
    if hills and whats & {*OF_SLOPE, *REORDERS}:
        raise clash(hills[0], next(each for each in changes if each.what in (*OF_SLOPE, *REORDERS)))


def _is_by_distance(target: Target) -> bool:
    return is_distance(target) or is_of_distances(target.place)


def is_hill(change: Change) -> bool:
    """Returns whether a change adds a crest or a dip."""
    return change.what == "add" and change.kind in HILLS


def clash(one: Change, other: Change) -> EditError:
    """Returns the error that two changes cannot be made at once."""
    return EditError(f"'{one.words}' and '{other.words}' need requests of their own; make one change first")


def _check_count(change: Change) -> None:
    target = change.target
    assert target is not None
    plain = Target(
        "turn",
        kind=target.kind,
        side=target.side,
        sharpness=target.sharpness,
        way=target.way,
        every=target.every,
        words=target.words,
    )
    if target != plain:
        raise EditError(
            f"'{change.words}' counts the turns of a place; only all turns, or those of a side or a kind, "
            "can be counted, for example: turn left: x4"
        )
    if change.to is None or change.to < 1:
        raise EditError(f"'{change.words}' gives no number of turns; write for example: turn: x4")


def _check_hill(change: Change) -> None:
    figures = (change.length, change.grade, change.degrees, change.radius)
    words = (change.side, change.sharpness, change.way)
    if change.count > 1:
        raise EditError(f"'{change.words}' adds several at once; say where each one is to be")
    if any(each is not None for each in (*figures, *words)) or change.is_whole:
        raise EditError(f"'{change.words}' gives a {change.kind} a shape; write only where it is to be")


def _check_places(change: Change) -> None:
    target = change.target
    if target is not None and target.length is not None and target.noun == "road":
        raise EditError(
            f"'{change.words}' does not say which metres of the road; write start len={target.length:g} or "
            f"end len={target.length:g}"
        )
    for place in (change.place, Place("on", change.like)):
        _refuse_distances(place)
    if target is None:
        return
    for distance in (target, *_ends(target.place)):
        if is_distance(distance) and (distance.length or 0) < 0:
            raise EditError(f"'{distance.words}' is no distance; give metres from 0 on")
    if is_distance(target) and target != Target(target.noun, length=target.length, words=target.words):
        raise EditError(f"'{target.words}' is a distance, which stands alone; leave the other words out")
    if target.noun == "road" and is_of_distances(target.place):
        _check_distances(target)
    else:
        _refuse_distances(target.place)
    _refuse_distances(Place("on", target.but))


def _ends(place: Place | None) -> tuple[Target, ...]:
    """Returns the targets that a place names."""
    return tuple(each for each in (place.target, place.other) if each) if place else ()


def _check_distances(target: Target) -> None:
    """Checks a part of the road whose ends are named by their distances from the start or the end."""
    place = target.place
    assert place is not None
    ends = (place.target, place.other)[: 2 if place.how == "between" else 1]
    is_plain = target == Target("road", place=place, words=target.words)
    if not is_plain or place.how == "on" or not all(map(is_distance, ends)):
        raise EditError(
            f"'{target.words}' mixes distances with other words; write for example: "
            "road between(start len=50, start len=100)"
        )


def _refuse_distances(place: Place | None) -> None:
    """Checks that a place is not named by a distance, however deep.

    Raises:
        EditError: a distance is named.
    """
    for target in _ends(place):
        if is_distance(target):
            raise EditError(
                f"'{target.words}' is a distance, which cannot name a place; name a turn or a straight"
            )
        _refuse_distances(target.place)
        _refuse_distances(Place("on", target.but))
