"""Finds the elements of the road that each change of a request concerns. Main function: ``placed``."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from roadgpt.design.edit.combinations import clash, refuse_clashes
from roadgpt.design.edit.likeness import with_value_of
from roadgpt.design.edit.pointing import among, named, pointed, turns
from roadgpt.design.edit.request import OF_SLOPE, Change, Place, Target
from roadgpt.design.edit.stretches import RoadStretch, stretch_of
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.errors import EditError


class PlacedChange(NamedTuple):
    """A requested change, and the elements of the road that it refers to."""

    change: Change
    elements: RoadElements
    """The elements to change, in driving order; none for an addition."""
    marks: RoadElements = ()
    """The elements after, before or on which something is added."""
    stop: RoadElement | None = None
    """The second element if something is added between two; else None."""
    stretch: RoadStretch | None = None
    """The stretch of the road if it is named by a distance or as a half, and its slope changes; else None."""


def placed(changes: Sequence[Change], elements: RoadElements) -> tuple[PlacedChange, ...]:
    """Returns the changes with the elements that they refer to.

    Args:
        changes: the changes, as they were read from the request.
        elements: the elements of the road before the edit.

    Raises:
        EditError: no element matches, several match although the request means one, or two changes cannot be
            made at once.
    """
    refuse_clashes(changes)
    out = []
    for change in changes:
        place = change.place
        if change.like is not None:
            out.append(_like_its_model(change, changes, elements))
        elif change.what in ("mirror", "reverse"):
            out.append(PlacedChange(change, elements))
        elif change.what == "count":
            out.append(_counted(change, elements))
        elif change.what == "move":
            assert change.target is not None
            moved = tuple(pointed(change.target, elements, "side"))
            out.append(PlacedChange(change, moved, *_marks(place, elements)))
        elif change.what != "add":
            assert change.target is not None
            own = tuple(pointed(change.target, elements, change.what))
            is_sloped = change.what in OF_SLOPE
            if is_sloped and not own:
                raise EditError(f"there is no road at '{change.target.words}', so it has no slope")
            stretch = stretch_of(change.target, elements) if is_sloped else None
            out.append(PlacedChange(change, own, stretch=stretch))
        else:
            out.append(PlacedChange(change, (), *_marks(place, elements)))
    return tuple(out)


def _like_its_model(asked: Change, changes: Sequence[Change], elements: RoadElements) -> PlacedChange:
    """Returns a change that takes its value from another place, with this value.

    Two places may exchange their values; the value of a model that itself takes one from a third place is not
    known.
    """
    assert asked.like is not None
    assert asked.target is not None
    models = pointed(asked.like, elements, asked.what)
    if len(models) != 1 or models[0].seen is None:
        raise EditError(f"'{asked.words}' has to compare with one turn or one straight; name it")
    own = tuple(each for each in pointed(asked.target, elements, asked.what) if each is not models[0])
    if not own:
        raise EditError(f"'{asked.words}' compares a place with itself; name another one")
    others = []
    for other in changes:
        if other is asked or other.target is None or other.what in ("add", "count", "move", "swap"):
            continue
        changed = pointed(named(other.target), elements, other.what)
        if models[0] not in changed:
            continue
        if other.like is None:
            others.append(other)
        elif other.what == asked.what and not {*pointed(other.like, elements, other.what)} <= {*own}:
            raise clash(asked, other)
    stretch = stretch_of(asked.target, elements) if asked.what == "slope" else None
    return PlacedChange(with_value_of(asked, models[0], others), own, stretch=stretch)


def _marks(place: Place | None, elements: RoadElements) -> tuple[RoadElements, RoadElement | None]:
    """Returns the elements next to which something comes, and the second one if it comes between two."""
    if place is None or place.target is None or place.how in ("start", "end", "middle"):
        return (), None
    marks = tuple(pointed(named(place.target), elements, "length"))
    other = place.other if place.how == "between" else None
    stop = pointed(named(other), elements, "length")[0] if other else None
    return marks, stop


def _counted(change: Change, elements: RoadElements) -> PlacedChange:
    """Returns the removal or the addition with which the road has as many turns as asked for.

    The last ones are removed; new ones come at the end.
    """
    target = change.target
    assert target is not None
    assert change.to is not None
    there, wanted = among(target, turns(elements), elements), int(change.to)
    if change.bound <= 0 and len(there) > wanted:
        return PlacedChange(replace(change, what="remove"), tuple(there[wanted:]))
    if change.bound >= 0 and len(there) < wanted:
        new = Target("turn", indefinite=True, words=target.words)
        more = Change(
            "add",
            new,
            kind=target.kind,
            side=target.side,
            sharpness=target.sharpness,
            way=target.way,
            count=wanted - len(there),
            place=Place("end"),
            words=change.words,
        )
        return PlacedChange(more, ())
    return PlacedChange(change, ())
