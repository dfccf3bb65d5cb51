"""Finds the elements of the road that each change of a request concerns. Main function: ``placed``."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

from roadgpt.brief.change.clashes import clash
from roadgpt.brief.change.request import OF_SLOPE, Change, Place, Target, Way, What
from roadgpt.check.measures import way
from roadgpt.design.edit.pointing import among, around_middle, named, pointed, turns
from roadgpt.design.edit.stretches import RoadStretch, stretch_of
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.errors import EditError, IdleEditError

CLEARLY = 0.04  # share by which a value gets beyond that of another place
LEAST_FOR_HILL = 40.0  # m: the shortest straight for a crest or a dip
RELATED: Mapping[What, frozenset[What]] = {
    "angle": frozenset({"shape", "length", "straighten"}),
    "radius": frozenset({"shape", "length", "straighten"}),
    "length": frozenset({"angle", "radius", "shape", "straighten"}),
    "slope": frozenset({"climb"}),
}
"""For each property, the changes of other properties that also change this property."""


class PlacedChange(NamedTuple):
    """A requested change, and the elements of the road that it refers to."""

    change: Change
    elements: RoadElements
    """The elements to change, in driving order; none for an addition, except the straight that gets a crest
    or a dip.
    """
    marks: RoadElements = ()
    """The elements after, before or on which something is added."""
    stop: RoadElement | None = None
    """The second element if something is added between two; else None."""
    stretch: RoadStretch | None = None
    """The stretch of the road whose slope changes, if named by a distance or as a half; else None."""

    def without(self, others: Sequence["PlacedChange"]) -> "PlacedChange":
        """Returns the change without the elements that ``others`` keep as they are. Another change counts if
        it is of the same property and concerns only some of the elements of this change.

        Raises:
            EditError: the change concerns a stretch of the road, and a part of the stretch would be left out.
        """
        own = self.elements
        for other in others if self.change.what != "length" or not self.change.is_of_road else ():
            if other.change.what == self.change.what and {*other.elements} < {*own}:
                if self.stretch is not None:
                    raise clash(self.change, other.change)
                own = tuple(element for element in own if element not in other.elements)
        return self._replace(elements=own)


def placed(changes: Sequence[Change], elements: RoadElements) -> tuple[PlacedChange, ...]:
    """Returns the changes with the elements that they refer to on the road before the edit.

    Raises:
        EditError: no element matches, several match although the request means one, or there is no straight
            for a crest or a dip.
    """
    out = []
    for change in changes:
        if change.like is not None and change.what == "swap":
            out.append(_swapped(change, change.like, elements))
        elif change.like is not None:
            out.append(_like_its_model(change, changes, elements))
        elif change.what in ("mirror", "reverse") and change.target is None:  # the whole road
            out.append(PlacedChange(change, elements))
        elif change.what == "count":
            out.append(_counted(change, elements))
        elif change.what in ("move", "add"):
            moved = (
                pointed(change.target, elements, "side") if change.target and change.what == "move" else ()
            )
            out.append(PlacedChange(change, tuple(moved), *_marks(change.place, elements)))
        else:
            assert change.target is not None
            own = tuple(pointed(change.target, elements, change.what))
            is_sloped = change.what in OF_SLOPE
            if is_sloped and not own:
                raise EditError(f"there is no road at '{change.target.words}', so it has no slope")
            stretch = stretch_of(change.target, elements) if is_sloped else None
            out.append(PlacedChange(change, own, stretch=stretch))
    return tuple(_on_straight(placed, elements) if placed.change.is_hill else placed for placed in out)


def _swapped(change: Change, like: Target, elements: RoadElements) -> PlacedChange:
    """Returns a swap of two things that are named each by itself, with both of them."""
    assert change.target is not None
    own = pointed(change.target, elements, "length"), pointed(named(like), elements, "length")
    if any(len(each) != 1 for each in own) or own[0] == own[1]:
        raise EditError(f"'{change.words}' has to name two different things; name one on each side")
    both = {element.name for each in own for element in each}
    return PlacedChange(change, tuple(element for element in elements if element.name in both))


def _on_straight(placed: PlacedChange, elements: RoadElements) -> PlacedChange:
    """Returns the addition of a crest or a dip, with the straight that gets it.

    Raises:
        EditError: the change does not refer to exactly one straight.
    """
    where = _straight_at(placed, elements)
    if where is None:
        raise EditError(too_short_for_hill(placed.change))
    return placed._replace(elements=(where,))


def too_short_for_hill(change: Change, found: str = "") -> str:
    """Returns a sentence on a crest or dip for which there is no straight; ``found`` says what there is."""
    return f"a {change.kind} needs a straight of {LEAST_FOR_HILL:.0f} m or more{found}; lengthen it first"


def _straight_at(placed: PlacedChange, elements: RoadElements) -> RoadElement | None:
    """Returns the straight at the place of a change; None if there is none."""
    place = placed.change.place
    how = place.how if place else "end"
    if how == "on":
        if len(placed.marks) != 1 or placed.marks[0].is_turn:
            raise EditError(f"'{placed.change.words}' names no single straight; name one")
        return placed.marks[0]
    gaps = [element for element in elements if not element.is_turn and element.segments]
    at = {element.name: index for index, element in enumerate(elements)}
    match how:
        case "start" | "end":
            found = gaps[:1] if how == "start" else gaps[-1:]
        case "middle":
            found = [around_middle(gaps, elements)] if gaps else []
        case "before":
            found = [gap for gap in gaps if at[gap.name] < at[placed.marks[0].name]][-1:]
        case "between" if placed.stop is not None:
            low, high = at[placed.marks[-1].name], at[placed.stop.name]
            found = [gap for gap in gaps if low < at[gap.name] < high]
            if len(found) != 1:
                raise EditError(
                    f"'{placed.change.words}' names {len(found) or 'no'} straights; name one of them"
                )
        case _:
            found = [gap for gap in gaps if at[gap.name] > at[placed.marks[-1].name]][:1]
    return found[0] if found else None


def _like_its_model(asked: Change, changes: Sequence[Change], elements: RoadElements) -> PlacedChange:
    """Returns a change that takes its value from another place ("as long as the first straight"), with this
    value.

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
        raise IdleEditError(f"'{asked.words}' compares a place with itself; name another one")
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
    change = _with_value_of(asked, models[0], others)
    if change.bound and change.what != "slope":
        beyond = tuple(each for each in own if is_beyond(change, each))
        if beyond:  # "longer than the first" is clearly longer, and "at least as long" allows it
            return PlacedChange(replace(change, to=(change.to or 0.0) * (1 + CLEARLY * change.bound)), beyond)
    return PlacedChange(change, own, stretch=stretch)


def _with_value_of(change: Change, model: RoadElement, others: Sequence[Change]) -> Change:
    """Returns the change with the value of the element that it names as its model.

    That is the value before the edit, or the new one if another change of the request gives the model one.

    Raises:
        EditError: the request compares with a straight where only turns have a value, or the value that
            another change gives the model is not known beforehand.
    """
    if change.what in ("angle", "radius") and not model.is_turn:
        raise EditError(f"'{change.words}' compares with a straight, which does not bend; name a turn")
    seen = model.seen
    assert seen is not None
    measures = {"angle": seen.degrees, "radius": seen.radius, "length": seen.length, "slope": seen.grade}
    is_exact = change.bound or change.is_compared
    value = measures[change.what] if is_exact else round(measures[change.what], 1)
    direction = way(value) if change.what == "slope" else None
    for other in others:
        if other.what in RELATED[change.what]:
            raise clash(change, other)
        if other.what == change.what:
            value, direction = _new_value(change, other, value, direction)
    if change.is_compared:
        value, direction = change.aim(abs(value)) or 0.0, None if direction == "flat" else direction
        if value < 0:
            raise EditError(f"'{change.words}' would be less than nothing on this road; ask for less")
        change = replace(change, more=0, by=None, times=None)
    if change.what != "slope":
        return replace(change, like=None, to=value)
    if change.bound:
        return replace(change, like=None, to=abs(value))
    direction = change.way or direction
    return replace(change, like=None, way=direction, to=None if direction == "flat" else abs(value))


def _new_value(
    change: Change, other: Change, value: float, direction: Way | None
) -> tuple[float, Way | None]:
    """Returns the value and the way of a model that another change has given it."""
    if other.way == "flat":
        return 0.0, "flat"
    if other.to is not None:
        if other.bound and not other.is_outside(abs(value)):
            return value, direction
        level = None if direction == "flat" else direction
        return other.to, other.way or level
    if change.what != "slope" and other.by is not None:
        return value + other.more * other.by, None
    if change.what != "slope" and other.times is not None:
        return value * other.times, None
    raise clash(change, other)


def is_beyond(change: Change, element: RoadElement) -> bool:
    """Returns whether an element violates the limit that a change sets."""
    if change.what == "slope":
        return any(change.is_outside(abs(segment.incline)) for segment in element.segments)
    seen = element.seen
    return seen is not None and change.is_outside(
        getattr(seen, "degrees" if change.what == "angle" else change.what)
    )


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
        new = Target("turn", words=target.words)
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
