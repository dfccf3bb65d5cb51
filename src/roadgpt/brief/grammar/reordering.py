"""Rearranges features that are mentioned out of driving order; runs after all phrases were read."""

from dataclasses import replace

from roadgpt.brief.grammar.driving_order import DrivingOrder, how_many, plural, turns
from roadgpt.brief.grammar.phrase import WAVY, Phrase
from roadgpt.brief.grammar.scope import give
from roadgpt.brief.model import at_least, exactly
from roadgpt.brief.normal import STRAIGHT


def in_driving_order(order: DrivingOrder) -> None:
    """Moves features that come first on the road to the front, as in 'finally a left turn, but first two
    right turns'.
    """
    things = order.things
    ends = next((at for at, thing in enumerate(things) if thing.joint == "end"), len(things))
    start = next((at for at in range(ends + 1, len(things)) if things[at].joint == "start"), None)
    if start is not None and not order.lists:
        order.things = things[start:] + things[:ends] + things[ends:start]


def place_picks(order: DrivingOrder) -> None:
    """Applies phrases about single turns when the number of turns is known, as in 'the last turn is sharp;
    four turns'.
    """
    picked = [thing for thing in order.things if thing.pick is not None and turns(thing)]
    others = [
        thing for thing in order.things if turns(thing) and thing.pick is None and thing.scope != "rest"
    ]
    if not picked or any(thing.scope == "rest" for thing in order.things):
        return
    wished = order.wishes.turns
    if not others and wished and wished.exact:
        others = [Phrase(kind="turn", count=wished, joint=picked[0].joint)]
        order.things.insert(0, others[0])
        order.wishes.turns = None
    if len(others) == 1 and plural(others[0]) and others[0].count and others[0].count.exact:
        _give_to(order, picked, how_many(others[0]))
    elif not others:
        _alone(order, picked)


def _give_to(order: DrivingOrder, picked: list[Phrase], number: int) -> None:
    if any(max(first + many, -first) > number for first, many in (p.pick or (0, 1) for p in picked)):
        return
    order.things = [thing for thing in order.things if not any(thing is one for one in picked)]
    order.expand()
    turning = [thing for thing in order.things if turns(thing)]
    for one in picked:
        first, many = one.pick or (0, 1)
        for thing in turning[first:][:many]:
            give(thing, one)


def _alone(order: DrivingOrder, picked: list[Phrase]) -> None:
    """Fills in turns before 'the second' if there is nothing to pick from; 'the last' then ends the road."""
    before = 0
    for one in picked:
        first, many = one.pick or (0, 1)
        if first > before:
            filling = Phrase(kind="turn", count=exactly(first - before), joint="then")
            order.things.insert(next(i for i, thing in enumerate(order.things) if thing is one), filling)
        if first < 0 and len(picked) == 1 and len(order.things) == 1:
            one.joint = "end"
        before = max(before, first) + many


def share_of_the_rest(order: DrivingOrder) -> None:
    """Computes how many turns 'the others' are, as in 'the first two turns are left, the others right;
    five in total'.
    """
    rest = next((thing for thing in order.things if thing.scope == "rest"), None)
    if rest is None or rest.kind in WAVY:
        return
    wished = order.wishes.turns
    said = sum(how_many(thing) for thing in order.things if turns(thing) and thing is not rest)
    left = int(wished.lo or 0) - said if wished and wished.exact else 0
    rest.count = exactly(left) if left > 0 else at_least(1)


def most_to_one_side(order: DrivingOrder) -> None:
    """Requires more than half of the turns to go in the direction given by a phrase such as 'mostly left
    turns, 5 in total'.
    """
    if order.mostly is None:
        return
    wished = order.wishes.turns
    number = wished.lo if wished and wished.lo else sum(how_many(t) for t in order.things if turns(t))
    setattr(order.wishes, order.mostly, at_least(int(number) // 2 + 1))


def hills_of_a_list(order: DrivingOrder) -> None:
    """Drops the requirement of three changes of slope, which 'hilly' implies, if the description lists fewer:
    'hilly: up, down, up' has two.
    """
    hills, changes, before = order.wishes.hills, 0, ""
    for thing in order.things:
        for slope in _SLOPES.get(thing.kind or "", (thing.slope,)):
            changes += slope in ("up", "down") and before in ("up", "down") and slope != before
            before = slope or before
    if order.hills_are_counted:
        return
    if hills and hills.lo and not hills.exact and 1 <= changes < hills.lo:
        order.wishes.hills = None


_SLOPES = {"crest": ("up", "down"), "dip": ("down", "up")}


def turns_left_open(order: DrivingOrder, road_said: bool) -> bool:
    """Returns True if the road may have turns that the description does not mention: true for 'a road with
    a crest', false for 'a straight road'.
    """
    things = order.things
    if order.wishes.turns is not None or not things or any(t.kind not in STRAIGHT for t in things):
        return False
    if all(thing.kind in ("crest", "dip") for thing in things):
        return True
    if road_said and all(thing.slope_alone and thing.length is None for thing in things):
        return True  # 'the road goes up and then down'
    return road_said and things[0].joint == "with" and not any(thing.road for thing in things)


def as_one_turn(order: DrivingOrder, phrase: Phrase) -> bool:
    """Adds the turn meant by 'one' in 'a long bend, then a short sharp one'; returns False if 'one' does
    not stand for a turn.
    """
    last = order.last_turn
    said = phrase.sharpness or phrase.size or phrase.side
    alone = phrase.joint in ("then", "and") or (last is not None and not plural(last))
    if last is None or phrase.count != exactly(1) or not said or not alone:
        return False
    order.add(replace(phrase, kind="turn" if last.kind is None else last.kind), leading=False)
    return True
