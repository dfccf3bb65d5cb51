"""Applies phrases to features that were mentioned before: 'both to the right', 'the last one sharp', 'no
turns'.
"""

from dataclasses import replace

from roadgpt.brief.grammar.driving_order import DrivingOrder, how_many, plural, turns
from roadgpt.brief.grammar.phrase import Phrase
from roadgpt.brief.grammar.slopes import slope_of
from roadgpt.brief.model import Amount, at_least, at_most, between, exactly
from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.words import KINDS, SHARPNESS, SLOPES, Range

ATTRIBUTES = ("side", "sharpness", "degrees", "radius", "incline")


def select(order: DrivingOrder, phrase: Phrase, after: Phrase | None) -> bool:
    """Applies a phrase to the earlier features that it refers to; returns False if the phrase was not
    used.
    """
    if phrase.pick is not None:
        return _pick(order, phrase)
    if (phrase.kind in STRAIGHT and phrase.scope == "each") or (
        phrase.scope and phrase.turning and _said_nothing(phrase) and after and after.kind in STRAIGHT
    ):
        if after is not None and after.kind in STRAIGHT:  # 'each turn followed by a straight'
            after.in_between = True
        return True
    if phrase.count and phrase.kind and order.last_turn is None:  # 'all 3 turns to the left'
        order.things.append(replace(phrase, scope=""))
        return True
    targets = _targets(order, phrase)
    if not targets and phrase.scope == "rest" and order.things:
        return _rest(order, phrase)
    if not targets:
        return _wish(order, phrase)
    if (
        phrase.slope
        and not phrase.turning
        and phrase.scope == "all"
        and not any(t.slope for t in order.things)
    ):
        order.wishes.slope, order.wishes.incline = slope_of(phrase), phrase.incline
        phrase.slope, phrase.incline = "", None
    if phrase.alternating and len(targets) > 1:
        order.wishes.alternating, phrase.alternating = True, False
    for thing in targets:
        give(thing, phrase)
    return True


def _rest(order: DrivingOrder, phrase: Phrase) -> bool:
    """Reads 'the first two turns are left, the others right', 'the first 100 m are flat, the rest is
    uphill'.
    """
    if turns(phrase) or phrase.sharpness or phrase.degrees or phrase.radius:
        phrase.kind, phrase.count, phrase.joint = phrase.kind or "turn", None, "then"
        order.things.append(phrase)
        return True
    if phrase.slope:
        order.things.append(replace(phrase, scope="", joint="then"))
    return phrase.slope != ""


def _said_nothing(phrase: Phrase) -> bool:
    return not (
        any(getattr(phrase, name) is not None for name in ATTRIBUTES) or phrase.slope or phrase.alternating
    )


def _targets(order: DrivingOrder, phrase: Phrase) -> list[Phrase]:
    if phrase.scope == "both":
        last = order.last_turn
        if last is not None and how_many(last) == 2:
            return [last]
        return [thing for thing in order.things if turns(thing)][-2:]
    if phrase.scope == "rest":
        order.expand()
        wanted = [name for name in (*ATTRIBUTES, "slope") if getattr(phrase, name)]
        return [t for t in order.things if turns(t) and not any(getattr(t, name) for name in wanted)]
    return [thing for thing in order.things if turns(thing)]


def give(thing: Phrase, phrase: Phrase) -> None:
    """Gives the feature ``thing`` the properties that ``phrase`` states; they replace the earlier ones of
    ``thing``.
    """
    if phrase.kind not in (None, "turn"):
        thing.kind = phrase.kind
    for name in ATTRIBUTES:
        value = getattr(phrase, name)
        if value is not None:
            setattr(thing, name, value)
    thing.alternating |= phrase.alternating
    if phrase.both_sides and phrase.alternating:
        thing.alternating = True
    if phrase.slope:
        thing.slope, thing.steep, thing.mild, thing.nearly = (
            phrase.slope,
            phrase.steep,
            phrase.mild,
            phrase.nearly,
        )


def _wish(order: DrivingOrder, phrase: Phrase) -> bool:
    """Reads 'every bend is sharp', where no bend was named, as a requirement for the road."""
    wishes = order.wishes
    for name in ("sharpness", "degrees", "radius"):
        if getattr(phrase, name) is not None:
            setattr(wishes, name, getattr(phrase, name))
    if phrase.side:
        setattr(wishes, "right" if phrase.side == "left" else "left", exactly(0))
    if phrase.slope:
        wishes.slope, wishes.incline = slope_of(phrase), phrase.incline
    wishes.alternating |= phrase.alternating
    if phrase.turning and phrase.kind != "turn":
        order.things.append(replace(phrase, scope=""))
    return True


def _pick(order: DrivingOrder, phrase: Phrase) -> bool:
    """Reads 'the first two uphill', 'the last is a hairpin'; with nothing to pick from, it is a new
    feature.
    """
    first, number = phrase.pick or (0, 1)
    order.expand()
    places = [at for at, thing in enumerate(order.things) if turns(thing) and thing.pick is None]
    if phrase.kind in STRAIGHT:
        places = [at for at, thing in enumerate(order.things) if thing.kind in STRAIGHT]
    picked = places[first : first + number] if first >= 0 else places[first:][:number]
    if any(plural(order.things[at]) for at in picked):
        return False  # single turns of an alternating group cannot be picked out
    if not picked:
        kind = phrase.kind or ("turn" if phrase.side or phrase.sharpness or phrase.degrees else None)
        if kind is None:
            return False
        count = exactly(number) if number > 1 else None
        order.things.append(replace(phrase, kind=kind, count=count, joint="then"))
        return True
    for at in picked:
        give(order.things[at], phrase)
    return True


def halve(order: DrivingOrder, phrase: Phrase) -> bool:
    """Applies a phrase such as 'the first half uphill' to that half of the turns; returns False if there
    are no turns.
    """
    order.expand()
    turning = [thing for thing in order.things if turns(thing)]
    if not turning:
        return False
    middle = (len(turning) + 1) // 2
    for thing in turning[:middle] if phrase.half == 1 else turning[middle:]:
        give(thing, phrase)
    return True


def take_some(order: DrivingOrder, phrase: Phrase) -> bool:
    """Applies 'two of them to the left' or 'one of which is a hairpin'; returns False if no turn was
    mentioned before.
    """
    whole = order.last_turn
    if whole is None:
        return False
    if phrase.count and _said_nothing(phrase) and phrase.kind is None:  # 'sharp turns, 5 of them'
        whole.count = phrase.count
        return True
    amount = phrase.count or exactly(max(how_many(whole) // 2, 1) if phrase.half else 1)
    if (
        phrase.kind in (None, "turn")
        and phrase.side
        and not (phrase.sharpness or phrase.degrees or phrase.slope)
    ):
        setattr(order.wishes, phrase.side, amount)
        return True
    order.expand()
    number = how_many(replace(phrase, count=amount))
    plain = [
        thing for thing in order.things if turns(thing) and thing.kind == whole.kind and not thing.of_them
    ]
    for thing in plain[len(plain) - number :] if number else []:
        give(thing, phrase)
        thing.of_them = True
    return True


def negate(order: DrivingOrder, phrase: Phrase) -> bool:
    """Applies 'no left turns', 'not steep' or 'without hairpins'; returns False if a Brief cannot express
    this.
    """
    wishes = order.wishes
    if phrase.hilly or phrase.slope_noun:
        wishes.slope = wishes.slope or "flat"
    elif phrase.mountain or phrase.hard or phrase.highway:
        return False
    elif phrase.steep:
        wishes.steepest = wishes.steepest or at_most((SLOPES["steeply_up"].grade or Range(8)).lo)
    elif phrase.slope == "flat":
        wishes.steepest = wishes.steepest or at_least((SLOPES["up"].grade or Range(3)).lo)
    elif phrase.slope:
        return False
    elif phrase.side:
        setattr(wishes, phrase.side, exactly(0))
    elif phrase.sharpness or phrase.degrees or phrase.radius:
        _negate_shape(order, phrase)
    elif phrase.kind is not None:
        return _negate_kind(order, phrase)
    else:
        return False
    return True


def _negate_shape(order: DrivingOrder, phrase: Phrase) -> None:
    target = order.last_turn if phrase.kind is None and order.last_turn is not None else order.wishes
    if phrase.degrees:
        target.degrees = _other_side(phrase.degrees)
    elif phrase.radius:
        target.radius = _other_side(phrase.radius)
    elif phrase.sharpness == "sharp":
        target.radius = at_least((SHARPNESS["sharp"].radius or Range(0, 30)).hi)
    else:
        target.radius = at_most((SHARPNESS["gentle"].radius or Range(40)).lo)


def _other_side(amount: Amount) -> Amount:
    """Reads 'no turn over 90 degrees' as 90 degrees at most."""
    if amount.lo is None and amount.hi is not None:
        return at_least(amount.hi)
    return at_most(amount.lo if amount.lo is not None else 0)


def _negate_kind(order: DrivingOrder, phrase: Phrase) -> bool:
    wishes, kind = order.wishes, phrase.kind
    if kind == "turn":
        wishes.turns = exactly(0)
    elif kind == "winding":
        wishes.turns = wishes.turns or at_most(2)
    elif kind == "straight" and not phrase.many:
        wishes.turns = wishes.turns or at_least(1)
    elif kind in ("hairpin", "switchback", "u_turn"):
        least = KINDS[kind].degrees
        plain = KINDS["turn"].degrees or Range(25, 120)
        most = min(plain.hi, (least.lo if least else 100) - 10)
        wishes.degrees = wishes.degrees or between(plain.lo, most)
    elif kind in ("crest", "dip"):
        wishes.hills = wishes.hills or at_most(0)
    else:
        return False
    return True
