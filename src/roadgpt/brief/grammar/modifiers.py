"""Applies phrases that contain no feature of their own to the previous feature or to the whole road."""

from dataclasses import replace

from roadgpt.brief.grammar.driving_order import DrivingOrder, plural, turns
from roadgpt.brief.grammar.phrase import Phrase
from roadgpt.brief.grammar.reordering import as_one_turn
from roadgpt.brief.grammar.slopes import slope_of
from roadgpt.brief.model import Amount, at_least, exactly
from roadgpt.brief.normal import STRAIGHT
from roadgpt.errors import BriefError


def modify(order: DrivingOrder, phrase: Phrase, before: Phrase | None, after: Phrase | None) -> bool:
    """Applies a phrase that contains no feature of its own to the previous feature or to the whole road.

    Returns:
        True if something in the phrase was used.
    """
    last, turn, wishes = order.last, order.last_turn, order.wishes
    used = (
        phrase.height is not None
        or phrase.hilly
        or phrase.climbs_said
        or phrase.more != ""
        or phrase.mountain
        or phrase.hard
        or phrase.highest
        or phrase.changes
        or phrase.free_turns
    )
    if as_one_turn(order, phrase):
        return True
    if phrase.in_between and phrase.length and turn is not None:
        order.add(replace(phrase, kind="straight"), leading=False)
        return True
    if phrase.same_hand and turn is not None:
        turn.side, used = turn.side or "left", True
    if phrase.series and turn is not None:
        turn.series = phrase.series
    if phrase.length is not None:
        used |= _length(order, phrase, before, after)
    if phrase.incline is not None or (phrase.slope_noun and (phrase.steep or phrase.mild)):
        used |= _incline(order, phrase, before)
    on_turn = turn is not None and (before is turn or phrase.joint in ("with", "", "(", ","))
    for name in ("degrees", "radius", "sharpness"):
        value = getattr(phrase, name)
        if value is not None:
            target = turn if on_turn and turn is not None else wishes
            setattr(target, name, getattr(target, name) or value)
            used = True
    if phrase.alternating:
        used = True
        if turn is not None and plural(turn):
            turn.alternating = True
        else:
            wishes.alternating = True
    if phrase.size and last is not None and last.kind in STRAIGHT and last.size is None:
        last.size, used = phrase.size, True
    if phrase.count and turn is not None and turn.many and turn.count == at_least(2):
        turn.count, used = phrase.count, True
    if phrase.count and turn is not None and turn.count and not (turn.count.exact and phrase.count.exact):
        turn.count, used = _both(turn.count, phrase.count), True
    if (phrase.times or phrase.repeat) and order.things:
        _repeat(order, phrase)
        used = True
    if phrase.again and last is not None and last.kind and phrase.joint in ("then", "and"):
        order.things.append(replace(last, joint="then", count=phrase.count))
        used = True
    return used or phrase.steep or phrase.only or not (phrase.count or phrase.length or phrase.degrees)


def _length(order: DrivingOrder, phrase: Phrase, before: Phrase | None, after: Phrase | None) -> bool:
    last, wishes = order.last, order.wishes
    leads = phrase.joint in ("after", "then") or (
        phrase.fresh and after is not None and after.joint == "then"
    )
    if phrase.joint == "after" and not phrase.fresh and turns(last or phrase):
        order.things.insert(-1, replace(phrase, kind="straight"))
        return True
    if leads and not phrase.length_said:
        order.things.append(replace(phrase, kind="straight", joint="then"))
        return True
    on_thing = last is not None and last is before and not phrase.total and last.length is None
    if on_thing and last is not None and _has_a_length(last, phrase):
        last.length = phrase.length
        return True
    if wishes.length is None:
        wishes.length = phrase.length
        return True
    return False


def _incline(order: DrivingOrder, phrase: Phrase, before: Phrase | None) -> bool:
    last, wishes = order.last, order.wishes
    if last is not None and before is last:
        last.incline = last.incline or phrase.incline
        last.slope = last.slope or ("" if wishes.slope else "up")
        last.steep |= phrase.steep
        last.mild |= phrase.mild
    else:
        wishes.incline = wishes.incline or phrase.incline
        phrase.slope = "up"
        wishes.slope = wishes.slope or slope_of(phrase)
    return True


def _both(one: Amount, other: Amount) -> Amount:
    """Combines two bounds: 'more than five turns but fewer than nine'.

    Raises:
        BriefError: no number satisfies both.
    """
    lows = [amount.lo for amount in (one, other) if amount.lo is not None]
    highs = [amount.hi for amount in (one, other) if amount.hi is not None]
    low, high = max(lows, default=None), min(highs, default=None)
    if low is not None and high is not None and low > high:
        raise BriefError(
            f"no number is {low:g} or more and {high:g} or less; leave out one of the two bounds"
        )
    return Amount(lo=low, hi=high)


def _repeat(order: DrivingOrder, phrase: Phrase) -> None:
    times = phrase.times or phrase.count or exactly(2)
    number = int(times.lo or times.hi or 2)
    if number * len(order.things) > 100:
        raise BriefError("no map has room for so many repetitions; ask for fewer")
    last = order.last
    if len(order.things) == 1 and last is not None and last.count is None and turns(last):
        last.count = exactly(number)
        return
    once = list(order.things)
    for _ in range(number - 1):
        order.things += [replace(thing, joint="then") for thing in once]


def _has_a_length(thing: Phrase, phrase: Phrase) -> bool:
    """True if it is a straight, or a slope that is not the slope of the whole road."""
    of_the_road = thing.after_road and phrase.length_said
    return thing.kind in STRAIGHT or (thing.kind is None and thing.slope != "" and not of_the_road)
