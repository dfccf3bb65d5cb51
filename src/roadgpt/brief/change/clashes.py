"""Refuses change requests whose changes cannot all be made at once, or do not fit the places they name."""

from collections.abc import Sequence

from roadgpt.brief.change.request import NUMBERING, Change, Place, Target
from roadgpt.errors import EditError


def refuse_clashes(changes: Sequence[Change]) -> None:
    """Checks that all changes of a request can be made at once.

    Raises:
        EditError: a change does not fit its place, or two changes need separate requests.
    """
    for change in changes:
        _check_places(change)
        if change.what == "count":
            _check_count(change)
        if change.is_hill:
            _check_hill(change)
    numbering = [change for change in changes if change.what in NUMBERING and not change.is_hill]
    counts = [change for change in changes if change.what == "count"]
    if counts and len(numbering) > 1 and not _are_of_both_sides(numbering):
        raise clash(counts[0], next(change for change in numbering if change is not counts[0]))


def _are_of_both_sides(changes: Sequence[Change]) -> bool:
    """Returns whether two changes count the left and the right turns."""
    sides = [change.target.side if change.what == "count" and change.target else None for change in changes]
    return len(sides) == 2 and {*sides} == {"left", "right"}


def clash(one: Change, other: Change) -> EditError:
    """Returns the error for two changes that cannot be made at once."""
    return EditError(f"'{one.words}' and '{other.words}' need requests of their own; make one change first")


def _check_count(change: Change) -> None:
    target = change.target
    assert target is not None
    of_all = ("kind", "side", "sharpness", "way", "every", "words")
    plain = Target("turn", **{name: getattr(target, name) for name in of_all})
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
    for distance in (target, *(target.place.ends if target.place else ())):
        if distance.is_distance and (distance.length or 0) < 0:
            raise EditError(f"'{distance.words}' is no distance; give metres from 0 on")
    if target.is_distance and target != Target(target.noun, length=target.length, words=target.words):
        raise EditError(f"'{target.words}' is a distance, which stands alone; leave the other words out")
    if target.noun == "road" and target.place and target.place.is_of_distances:
        _check_distances(target, target.place)
    else:
        _refuse_distances(target.place)
    _refuse_distances(Place("on", target.but))


def _check_distances(target: Target, place: Place) -> None:
    """Checks a part of the road whose ends are named by their distances from the start or the end."""
    is_plain = target == Target("road", place=place, words=target.words)
    is_plain = is_plain and len(place.ends) == (2 if place.how == "between" else 1)
    if not is_plain or place.how == "on" or not all(end.is_distance for end in place.ends):
        raise EditError(
            f"'{target.words}' mixes distances with other words; write for example: "
            "road between(start len=50, start len=100)"
        )


def _refuse_distances(place: Place | None) -> None:
    """Checks that a place is not named by a distance, however deep.

    Raises:
        EditError: a distance is named.
    """
    for target in place.ends if place else ():
        if target.is_distance:
            raise EditError(
                f"'{target.words}' is a distance, which cannot name a place; name a turn or a straight"
            )
        _refuse_distances(target.place)
        _refuse_distances(Place("on", target.but))
