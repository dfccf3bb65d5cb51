"""Refuses requests whose wishes cannot be carried out together, or not on the place that they name."""

from collections.abc import Sequence

from roadgpt.design.edit.request import HILLS, OF_SLOPE, Change, Place, Target, What
from roadgpt.errors import EditError

REORDERS: tuple[What, ...] = ("swap", "move")
"""Changes that put turns in another order."""
NUMBERING: tuple[What, ...] = ("add", "remove", "count", "straighten")
"""Changes with which a road gets other turns and straights."""


def refuse_clashes(changes: Sequence[Change]) -> None:
    """Checks that all changes of a request can be made at once.

    Raises:
        EditError: a change does not fit its place, or two changes need requests of their own.
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
        _refuse(counts[0], next(change for change in numbering if change is not counts[0]))
    moves = [change for change in changes if change.what in REORDERS]
    if moves and numbering:
        _refuse(moves[0], numbering[0])
    sloped = [change for change in changes if change.what in OF_SLOPE]
    far = [change for change in sloped if change.target and _is_distance(change.target)]
    if far and (numbering or moves):
        _refuse(far[0], (numbering or moves)[0])
    hills = [change for change in changes if is_hill(change)]
    if hills and whats & {*OF_SLOPE, *REORDERS}:
        _refuse(hills[0], next(each for each in changes if each.what in (*OF_SLOPE, *REORDERS)))


def is_hill(change: Change) -> bool:
    """Returns whether a change adds a crest or a dip."""
    return change.what == "add" and change.kind in HILLS


def _refuse(one: Change, other: Change) -> None:
    raise EditError(f"'{one.words}' and '{other.words}' need requests of their own; make one change first")


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
    if target is not None and _is_distance(target) and target != _only_distance(target):
        raise EditError(f"'{target.words}' is a distance, which stands alone; leave the other words out")
    for place in (change.place, target.place if target else None):
        _check_place(place)
    if target is not None and target.but is not None and _is_distance(target.but):
        _refuse_distance(target.but)


def _check_place(place: Place | None) -> None:
    for target in (place.target, place.other) if place else ():
        if target is not None and _is_distance(target):
            _refuse_distance(target)


def _refuse_distance(target: Target) -> None:
    raise EditError(f"'{target.words}' is a distance, which cannot name a place; name a turn or a straight")


def _is_distance(target: Target) -> bool:
    return target.noun in ("start", "end") and target.length is not None


def _only_distance(target: Target) -> Target:
    return Target(target.noun, length=target.length, words=target.words)
