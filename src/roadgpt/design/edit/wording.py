"""Converts one clause to the changes that it asks for, from words about angles, radii, lengths, slopes and
sides.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast

from roadgpt.design.edit.clause import RequestClause
from roadgpt.design.edit.dimensions import ADJECTIVES, LONG, SHORT, Dimensions
from roadgpt.design.edit.request import Change, Place, Target
from roadgpt.errors import EditError

ABROAD = {"gauche", "droite", "izquierda", "derecha", "sinistra", "destra"}  # sides stand behind their noun
EXCHANGES = {"swap", "switch", "vertausche"}
VERBS = {"remove", "swap", "mirror", "straighten", "sharper", "gentler", "tighter", "wider", "longer",
         "shorter", "steeper", "flatter", "more", "less"}  # fmt: skip
"""Of what is there already."""
ROAD = Target("road")
ENDINGS = {
    "end",
    "ends",
    "ending",
    "finish",
    "finishes",
    "terminate",
    "start",
    "starts",
    "begin",
    "begins",
    "apart",
}
"""First words of 'end with' and its like; the last one is of turns that are to lie apart."""


def wanted(clause: RequestClause, before: tuple[Target, ...]) -> list[Change]:
    """Returns the changes that one clause asks for; none if no word in it is known.

    Args:
        clause: the clause, with its places, its new elements and the words that remain.
        before: the targets of the previous clause.

    Raises:
        EditError: the clause is ambiguous, or omits something that cannot be guessed.
    """
    _is_of_this_road(clause)
    names = clause.names
    if "alternate" in names:
        return [Change("alternate", target, words=clause.words) for target in _of_turns(clause, before)]
    if names & {"at_most", "at_least"} and clause.new:
        raise EditError(f"'{clause.words}' leaves open which are to go or to come; name them with numbers")
    if "mirror" in names and not any(t.noun in ("turn", "straight") for t in clause.targets):
        return [Change("mirror", words=clause.words)]
    is_new = bool(clause.new) and not clause.targets and not _speaks_of_it(clause, before)
    is_had = bool(clause.new and clause.places) and all(
        t == replace(ROAD, words=t.words) for t in clause.targets
    )
    is_new |= is_had and not _speaks_of_it(clause, before)  # 'the road should have a turn at the end'
    if "add" in names or (is_new and not names & VERBS):
        return [_added(clause, before)]
    if is_new and "remove" not in names:
        raise EditError(f"which one is meant in '{clause.words}' is not said; say: the second turn")
    targets = _targets(clause, before)
    if _is_new_shape(clause):  # 'swap the second turn for a hairpin'
        clause.row = [replace(x, name="make") if x.name == "swap" else x for x in clause.row]
        names = clause.names
    if "remove" in names and any(x.name == "#" and x.unit for x in clause.row):
        clause.row = [replace(x, name="shorter") if x.name == "remove" else x for x in clause.row]
        names = clause.names  # 'cut the last straight in half'
    if "remove" in names:
        return _removed(clause, targets)
    if "straighten" in names or _into_a_straight(clause):
        return [Change("straighten", target, words=clause.words) for target in targets]
    is_compared = [x.name for x in clause.row].count("as") > 1 and len(clause.targets) > 1
    if is_compared or ("as" in names and not any(x.name == "#" for x in clause.row)):
        raise EditError(f"'as ... as' in '{clause.words}' is not understood; say a number")
    clause.targets = targets or clause.targets
    found = Dimensions(clause).changes()
    if not found and "make" in names:  # 'make the third left'
        found = [Change("side", side=t.side, words=clause.words) for t in targets if t.is_bare][:1]
    out = []
    some: list[Target | None] = [*targets]
    for target in some or [None]:
        out += [_on(target, change, found, clause) for change in found]
    return [change for change in out if change is not None]


def _is_new_shape(clause: RequestClause) -> bool:
    """Is something new to stand in the place of what is there?"""
    described = any(t.kind or t.side or t.sharpness or t.degrees for t in clause.new)
    return "swap" in clause.names and described


def _of_turns(clause: RequestClause, before: tuple[Target, ...]) -> list[Target]:
    """All turns, where none were named."""
    named = [t for t in _targets(clause, before) if t.noun in ("turn", None) and not t.is_bare]
    return [replace(target, every=True) for target in named] or [
        Target("turn", every=True, words="all turns")
    ]


def _speaks_of_it(clause: RequestClause, before: tuple[Target, ...]) -> bool:
    """'Make it a hairpin' and 'turn it into a left turn' change what was named before."""
    return bool(before) and "make" in clause.names


def _targets(clause: RequestClause, before: tuple[Target, ...]) -> list[Target]:
    out: list[Target] = []
    for target in clause.targets:
        if target.noun == "it":
            out += before or (Target("road", words="the road"),)
        elif target.is_that:
            out += _spoken_of(target, before) or (target,)
        else:
            out.append(_without_it(target, before))
    if len(out) > 1 and out[0].noun == "road" and out[1].noun in ("end", "start"):
        out = out[1:]  # 'the road should end flat'
    if len(out) > 1 and out[-1].noun == "road":  # 'the turns of the road', 'the turns in its second half'
        half = out[-1].half
        out = [replace(target, half=half) for target in out if target.noun != "road"]
    places = clause.places
    if places and (not out or out[0].noun == "road"):
        ends = [p for p in places if p.how in ("start", "end")]
        if ends:
            return [Target("end" if ends[0].how == "end" else "start", words=f"the {ends[0].how}")]
        if places[0].how == "on" and places[0].target:
            return [places[0].target]
        return [Target("road", place=places[0], words=clause.words)]
    sides = [place.how for place in places if place.how in ("start", "end", "middle")]
    if sides and out and out[0].noun in ("turn", "straight") and not out[0].numbers and not out[0].every:
        number = {"start": (1,), "end": (-1,)}.get(sides[0], ())  # 'a longer straight at the end'
        out[0] = replace(out[0], numbers=number, middle=not number, indefinite=False)
    return out or list(before)


def _is_of_this_road(clause: RequestClause) -> None:
    """EditError for what no change of a design is, though its words are known."""
    words = {x.text.lower() for x in clause.row}
    if any(target.noun == "road" for target in clause.new):
        raise EditError(f"'{clause.words}' describes a new road, and no change of this one")
    places = {number for target in clause.targets for number in (target.numbers or (target.words,))}
    if words & EXCHANGES and len(places) == 2 and [x.name for x in clause.row].count("swap") == 1:
        raise EditError("turns cannot change places; for the other side say: flip the second turn")
    if words & {"wider", "narrower", "widen"} and [target.noun for target in clause.targets] == ["road"]:
        raise EditError("a design has no width; for larger radii say: make all turns wider")


def _spoken_of(target: Target, before: tuple[Target, ...]) -> tuple[Target, ...]:
    """What 'that turn' and 'those turns' mean: of those that were named before, the last one, or all."""
    named = [
        one
        for other in before
        for one in ((other.place.target, other.place.other, other) if other.place else (other,))
        if one and (one.noun or "turn") == target.noun
    ]
    return tuple(named if target.every else named[-1:])


def _without_it(target: Target, before: tuple[Target, ...]) -> Target:
    """'The turn after it': with what was spoken of before in its place."""
    place = target.place
    if place and place.target and place.target.noun == "it" and before:
        return replace(target, place=replace(place, target=before[0]))
    return target


def _into_a_straight(clause: RequestClause) -> bool:
    turns = any(t.noun in ("turn", None) for t in clause.targets)
    straight = any(t.noun == "straight" for t in clause.new) or (
        len(clause.targets) > 1 and clause.targets[-1].words == "straight"
    )
    if turns and straight:
        clause.targets[:] = [t for t in clause.targets if t.words != "straight"]
        return True
    return False


def _removed(clause: RequestClause, targets: Sequence[Target]) -> list[Change]:
    if clause.new and not targets:
        raise EditError(
            f"which one is to be removed in '{clause.words}' is not said; say: remove the second turn"
        )
    if not targets or any(t.noun == "road" and t.place is None for t in targets):
        raise EditError(f"'{clause.words}' would leave no road; say which turn or straight is to be removed")
    return [Change("remove", target, words=clause.words) for target in targets]


def _added(clause: RequestClause, before: tuple[Target, ...]) -> Change:
    things = clause.new or [t for t in clause.targets if t.noun in ("turn", "straight")]
    if not things:
        raise EditError(
            f"what is to be added in '{clause.words}' is not said; say: add a left turn at the end"
        )
    thing, dims = things[0], Dimensions(clause)
    place = clause.places[0] if clause.places else thing.place or _at(clause)
    if place.target and place.target.noun == "it" and before:
        place = replace(place, target=before[0])
    amounts = dims.amounts
    grade = next((a.value for a in amounts if a.unit == "%"), None)
    metres = next((a.value for a in amounts if a.unit == "m" and a.noun != "radius"), None)
    way = thing.way or dims.way()
    side: Any = thing.side or dims.side()
    if grade is not None and way == "down":
        grade = -abs(grade)
    length = thing.length or metres if thing.noun == "straight" else None
    if thing.noun == "straight" and length is None:
        length = {"long": LONG, "short": SHORT}.get(thing.size or "")
    adjective = thing.sharpness or next((n for n in ADJECTIVES if n in clause.names), None)
    return Change(
        "add",
        target=Target(thing.noun, indefinite=True, words=thing.words),
        side=side,
        kind=thing.kind,
        sharpness=adjective,
        count=thing.count or 1,
        way=way,
        place=place,
        degrees=thing.degrees or next((a.value for a in amounts if a.unit == "deg"), None),
        radius=next((a.value for a in amounts if a.unit in ("m", "") and a.noun == "radius"), None),
        length=length,
        grade=grade,
        is_whole=any(bool({*x.text.lower().split()[:1]} & ENDINGS) for x in clause.row if x.name == "add"),
        words=clause.words,
    )


def _at(clause: RequestClause) -> Place:
    """Where it is to be added: also 'to the start', which reads like a target."""
    for target in clause.targets:
        if target.noun in ("start", "end"):
            return Place(cast(Any, target.noun))
    return Place("end")


def _on(
    target: Target | None, change: Change, found: Sequence[Change], clause: RequestClause
) -> Change | None:
    """The change for one target; where none was named, for what such changes are usually meant."""
    is_side = target is not None and target.is_bare and target.side and not clause.new
    if target is not None and is_side and all(c.what == "side" for c in found):
        change = replace(change, side=target.side)  # 'the second turn left and the third right'
        target = replace(target, side=None)
    if change.what == "side" and change.side and target is not None and _is_filter(found, clause):
        return None
    if target is not None and _is_filter(found, clause) and target.noun in ("turn", None):
        side = next((c.side for c in found if c.what == "side"), None)
        target = replace(target, side=target.side or side)
    if target is None:
        is_of_turns = change.what in ("angle", "radius", "shape", "side")
        target = Target("turn" if is_of_turns else "road", every=True, words="every turn")
        if change.what == "side" and change.side is None:
            return Change("mirror", words=change.words)
    if target.noun == "road" and change.what in ("angle", "radius", "shape"):
        target = replace(target, noun="turn", every=True)
    if target.noun == "road" and change.what == "side" and "reverse" in clause.words.lower().split():
        raise EditError("a road cannot be turned round; for its mirror image say: mirror the road")
    if target.noun == "road" and change.what == "side" and target.place is None:
        return Change("mirror", words=change.words)
    return replace(change, target=target)


def _is_filter(found: Sequence[Change], clause: RequestClause) -> bool:
    """'Le virage à gauche plus serré': the side says which turn, as something else is to be changed."""
    abroad = any(x.name in ("left", "right") and set(x.text.lower().split()) & ABROAD for x in clause.row)
    return abroad and any(c.what != "side" for c in found)
