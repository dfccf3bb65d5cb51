"""The last stage of the grammar reader: converts the features along the road to a Brief."""

from dataclasses import replace
from itertools import pairwise

from roadgpt.brief.grammar.driving_order import DrivingOrder, how_many, plural, turns
from roadgpt.brief.grammar.phrase import WAVY, Phrase
from roadgpt.brief.grammar.reordering import (
    hills_of_a_list,
    in_driving_order,
    most_to_one_side,
    place_picks,
    share_of_the_rest,
    turns_left_open,
)
from roadgpt.brief.grammar.slopes import settle_slopes, slope_of
from roadgpt.brief.model import Amount, Brief, Clause, Kind, at_least, at_most, between, exactly
from roadgpt.brief.normal import SINGLE, STRAIGHT
from roadgpt.brief.words import KINDS, SIZES
from roadgpt.errors import BriefError

ROUND_BUT_TIGHT = between(25, 35)
"""The radius in metres of 'a wide hairpin', which is still a hairpin."""


def lower(order: DrivingOrder, road_said: bool) -> Brief:
    """Returns the Brief of all features and requirements.

    Args:
        order: the features in driving order, and the requirements for the road as a whole.
        road_said: True if the description names the road itself ('a road with ...').

    Raises:
        BriefError: all turns of an S-bend or a chicane are required to go the same way.
    """
    in_driving_order(order)
    _deal_out(order)
    _spell_out(order)
    _name_sides(order)
    place_picks(order)
    share_of_the_rest(order)
    settle_slopes(order)
    _move_to_ends(order)
    _part_of_the_number(order)
    _fill_up(order)
    most_to_one_side(order)
    hills_of_a_list(order)
    if turns_left_open(order, road_said):
        order.wishes.turns = at_least(0)
    wishes = order.wishes
    clauses = [_clause(thing, order) for thing in order.things if thing.kind is not None]
    if len(order.things) == 1 and wishes.turns in (None, at_least(0)):
        joint = order.things[0].joint if not order.things[0].place else order.things[0].place
        if joint == "start" and road_said:
            wishes.starts, clauses = clauses[0], []
        elif joint == "end":
            wishes.ends, clauses = clauses[0], []
    if not clauses and wishes.turns is None and not (wishes.left and wishes.left.lo):
        wishes.turns = at_least(1)
    return Brief(clauses=tuple(clauses), **{name: getattr(wishes, name) for name in wishes.__slots__})


def _deal_out(order: DrivingOrder) -> None:
    """Gives each turn its own number: 'two bends of 45 and 90 degrees'."""
    out = list[Phrase]()
    for thing in order.things:
        name, numbers = thing.series or ("", ())
        if numbers and how_many(thing) == len(numbers):
            single = [replace(thing, count=exactly(1), series=None) for _ in numbers]
            for one, number in zip(single, numbers, strict=True):
                setattr(one, name, exactly(number))
            out += single
        else:
            out.append(thing)
    order.things = out


def _spell_out(order: DrivingOrder) -> None:
    """Counts turns that are spelled out only once: 'three turns: left, right, left' are three, not six."""
    for whole, at in order.lists:
        places = [i for i, thing in enumerate(order.things) if thing is whole]
        if not places or places[0] + 1 > at:
            continue
        start = places[0] + 1
        stop = _spelled(order.things, start, _turns_in(whole))
        if stop == start:
            _spelled_attribute(order, whole, start)
        elif whole.kind in ("s_bend", "chicane"):
            _sides_of(whole, order.things[start:stop])
            del order.things[start:stop]
        else:
            for thing in order.things[start:stop]:
                _inherit(thing, whole)
            order.things[start].joint = whole.joint
            del order.things[places[0]]


def _turns_in(whole: Phrase) -> tuple[int, int]:
    if whole.kind in ("s_bend", "chicane") and not plural(whole):
        own = KINDS[whole.kind].turns
        return (int(own.lo), int(own.hi)) if own else (1, 1)
    number = how_many(whole)
    return (number, number) if whole.count is None or whole.count.exact else (0, 0)


def _spelled(things: list[Phrase], start: int, number: tuple[int, int]) -> int:
    """Returns where the turns that spell out the number end; ``start`` if they do not."""
    total, best = 0, start
    for at in range(start, len(things)):
        if not turns(things[at]):
            break
        total += how_many(things[at])
        if number[0] <= total <= number[1]:
            best = at + 1
    return best


def _spelled_attribute(order: DrivingOrder, whole: Phrase, start: int) -> None:
    """Reads 'two turns, left' as more about the two turns, not as another one."""
    if start < len(order.things) and not _parts_of(order, whole, start):
        thing = order.things[start]
        if (
            thing.kind is None
            and thing.side
            and not thing.count
            and whole.side is None
            and thing.joint != "then"
        ):
            whole.side = thing.side
            del order.things[start]


def _parts_of(order: DrivingOrder, whole: Phrase, start: int) -> bool:
    """Reads '5 turns, 3 to the left' as three of the five."""
    parts = [t for t in order.things[start:] if t.kind is None and t.side and t.count and t.joint != "then"]
    if parts != order.things[start:] or whole.side or not plural(whole):
        return False
    if sum(how_many(part) for part in parts) > how_many(whole):
        return False
    for part in parts:
        setattr(order.wishes, part.side or "left", part.count)
    del order.things[start:]
    return True


def _inherit(thing: Phrase, whole: Phrase) -> None:
    thing.kind = whole.kind if thing.kind in (None, "turn") else thing.kind
    for name in ("sharpness", "degrees", "radius", "incline"):
        if getattr(thing, name) is None:
            setattr(thing, name, getattr(whole, name))
    thing.slope = thing.slope or whole.slope


def _sides_of(whole: Phrase, sides: list[Phrase]) -> None:
    if any(one.side == other.side for one, other in pairwise(sides) if one.side):
        raise BriefError(
            f"the turns of a {whole.kind} go to both sides; write them out as single turns instead"
        )
    whole.side = sides[0].side


def _name_sides(order: DrivingOrder) -> None:
    """Gives a side that stands for a turn the kind of the turn that it was said with."""
    things = order.things
    for at, thing in enumerate(things):
        if thing.kind is not None or thing.side is None:
            continue
        before = next((t for t in reversed(things[:at]) if t.turning), None)
        after = next((t for t in things[at + 1 :] if t.turning), None)
        kind: Kind = "turn"
        elliptic = thing.article or thing.count is not None or thing.joint in ("and", ",")
        if elliptic and not thing.sharpness:  # 'a left and a right hairpin', 'one left hairpin and two right'
            spoken = after if after is not None and after.joint in ("and", "or") else None
            model = before or spoken
            kind = model.kind if model and model.kind in SINGLE else "turn"
        thing.kind = kind


def _move_to_ends(order: DrivingOrder) -> None:
    for thing in [thing for thing in order.things[1:] if thing.joint == "start" and thing.kind in STRAIGHT]:
        if all(turns(other) and other.joint != "then" for other in order.things[: _place(order, thing)]):
            order.things = [thing, *(other for other in order.things if other is not thing)]
    for thing in [thing for thing in order.things if thing.place == "end"]:
        order.things = [other for other in order.things if other is not thing]
        thing.joint = "end"
        order.things.append(thing)


def _place(order: DrivingOrder, thing: Phrase) -> int:
    return next(at for at, other in enumerate(order.things) if other is thing)


def _part_of_the_number(order: DrivingOrder) -> None:
    """Counts a feature at an end as one of the turns: 'a road with 5 turns, ending in a hairpin' has five."""
    things = order.things
    if len(things) < 2 or any(thing.joint in ("then", "for", "after", "stop") for thing in things):
        return
    turning = [thing for thing in things if turns(thing)]
    edge = [thing for thing in turning if thing.joint in ("start", "end") and thing is not things[0]]
    rest = [thing for thing in turning if thing not in edge]
    if len(rest) != 1 or not edge or rest[0].kind != "turn" or not plural(rest[0]):
        return
    whole = rest[0]
    if whole.side and any(thing.side != whole.side for thing in edge):
        return
    if whole.count is None or whole.alternating or how_many(whole) <= sum(how_many(thing) for thing in edge):
        return
    less = sum(how_many(thing) for thing in edge)
    lo, hi = whole.count.lo, whole.count.hi
    whole.count = Amount(lo=None if lo is None else lo - less, hi=None if hi is None else hi - less)
    for thing in edge:
        overlaid = replace(thing, degrees=thing.degrees or (whole.degrees if thing.kind == "turn" else None))
        things[next(i for i, t in enumerate(things) if t is thing)] = overlaid
    starts = [thing for thing in things if thing.joint == "start" and turns(thing)]
    order.things = starts + [t for t in things if not any(t is s for s in starts)]


def _fill_up(order: DrivingOrder) -> None:
    """Adds the missing turns: 'two hairpins, 5 turns in total' has three more."""
    wished = order.wishes.turns
    turning = [thing for thing in order.things if turns(thing)]
    if not wished or not wished.exact or not turning or any(t.kind in WAVY for t in turning):
        return
    if any(t.kind in ("s_bend", "chicane") or (t.count and not t.count.exact) for t in turning):
        return
    missing = int(wished.lo or 0) - sum(how_many(thing) for thing in turning)
    if missing > 0:
        more = Phrase(kind="turn", count=exactly(missing), joint="then")
        at = len(order.things) - (1 if order.things[-1].joint == "end" else 0)
        order.things.insert(at, more)


def _clause(thing: Phrase, order: DrivingOrder) -> Clause:
    kind = thing.kind or "turn"
    slope, count = slope_of(thing), thing.count or exactly(1)
    if kind in STRAIGHT:
        size = thing.size if thing.length is None and kind == "straight" else None
        length = thing.length if kind == "straight" else None
        own = slope if kind == "straight" else None
        return Clause(
            kind=kind,
            count=count,
            length=length,
            size=size,
            slope=own,
            incline=thing.incline if own else None,
        )
    length = thing.length
    if length is None and thing.size and thing.sharpness != "sharp" and kind == "turn":
        limits = SIZES[thing.size].length
        length = (at_least(limits.lo) if thing.size == "long" else at_most(limits.hi)) if limits else None
    if length is not None and (
        kind in WAVY | {"s_bend", "chicane"} or (count != exactly(1) and not thing.each)
    ):
        order.wishes.length = order.wishes.length or length
        length = None
    clause = Clause(
        kind=kind,
        count=count,
        side=None if thing.free_side else thing.side,
        alternating=thing.alternating and (count != exactly(1) or kind in WAVY),
        sharpness=thing.sharpness,
        degrees=thing.degrees,
        radius=thing.radius,
        length=length,
        slope=slope,
        incline=thing.incline if slope else None,
    )
    return _possible(clause)


def _possible(clause: Clause) -> Clause:
    """Combines words that exclude each other: a wide hairpin stays a hairpin, a gentle chicane is an
    S-bend.
    """
    if clause.sharpness in ("gentle", "sweeping"):
        if clause.kind == "hairpin":
            radius = clause.radius or ROUND_BUT_TIGHT
            return clause.model_copy(update={"sharpness": None, "radius": radius})
        if clause.kind == "chicane":
            return clause.model_copy(update={"kind": "s_bend"})
        if clause.kind == "slalom":
            return clause.model_copy(update={"kind": "serpentine"})
    return clause
