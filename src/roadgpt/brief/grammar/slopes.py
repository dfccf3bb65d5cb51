"""Decides whether a slope without a feature of its own ('then uphill') applies to features or to the road."""

from dataclasses import replace

from roadgpt.brief.grammar.driving_order import DrivingOrder, RoadWishes, how_many, turns
from roadgpt.brief.grammar.phrase import WAVY, Phrase
from roadgpt.brief.model import Slope, exactly
from roadgpt.brief.normal import SINGLE, STRAIGHT
from roadgpt.errors import BriefError

SCOPED = ("with", "for", "into", "enter", "(", "colon", "")
ONE_LEG = ("for", "then", "into", "enter", "and")
_WORDS: dict[tuple[str, str], Slope] = {
    ("up", ""): "up",
    ("up", "steep"): "steeply_up",
    ("up", "mild"): "gently_up",
    ("flat", ""): "flat",
    ("down", ""): "down",
    ("down", "steep"): "steeply_down",
    ("down", "mild"): "gently_down",
    ("flat", "nearly"): "nearly_flat",
}


def slope_of(phrase: Phrase) -> Slope | None:
    """Returns the slope of a phrase as a value of ``Brief.slope``; if the phrase gives the grade as a number,
    'steeply' and 'gently' are dropped.
    """
    if not phrase.slope:
        return None
    if phrase.slope == "flat":
        return "nearly_flat" if phrase.nearly else "flat"
    manner = "" if phrase.incline else "steep" if phrase.steep else "mild" if phrase.mild else ""
    return _WORDS[phrase.slope, manner]


def settle_slopes(order: DrivingOrder) -> None:
    """Assigns each slope that is mentioned without a turn or straight ('then uphill') to earlier features
    or to the whole road, or inserts a straight for it.
    """
    alone = [thing for thing in order.things if _alone(thing)]
    if alone and not _shared_out(order, alone):
        only = len({_said(thing) for thing in order.things if thing.slope}) == 1 and not _rises_and_falls(
            order
        )
        if only and _of_the_road(order, alone):
            _to_the_road(order, alone)
        else:
            _along_the_road(order, only)


def _shared_out(order: DrivingOrder, alone: list[Phrase]) -> bool:
    """Shares out '3 turns, first uphill, then downhill': each slope gets its part of the turns."""
    things = [thing for thing in order.things if not _alone(thing)]
    if len(alone) < 2 or len(things) != 1 or not turns(things[0]) or things[0].slope:
        return False
    turn, first = things[0], order.things[0] is things[0]
    if (not first and (order.things[-1] is not turn or turn.joint != "with")) or any(a.length for a in alone):
        return False
    if turn.alternating or (turn.count and not turn.count.exact) or turn.kind not in SINGLE:
        return False
    number, out = how_many(turn), list[Phrase]()
    if number < len(alone):
        return False
    for at, slope in enumerate(alone):
        share = number // len(alone) + (1 if at < number % len(alone) else 0)
        part = replace(turn, count=exactly(share), joint="then" if at else turn.joint)
        _give(part, slope, with_number=True)
        out.append(part)
    order.things = out
    return True


def _alone(thing: Phrase) -> bool:
    return thing.kind is None and thing.side is None and thing.slope != ""


def _said(thing: Phrase) -> tuple[str, bool]:
    return thing.slope, thing.nearly


def _rises_and_falls(order: DrivingOrder) -> bool:
    return any(thing.kind in ("crest", "dip") for thing in order.things)


def _of_the_road(order: DrivingOrder, alone: list[Phrase]) -> bool:
    """True if there is only one slope and it is not one part of several: 'climbing, with 3 turns'."""
    slope, things = alone[0], order.things
    if len(alone) > 1 or slope.joint in ("start", "end") or slope.place:
        return False
    at = next(i for i, thing in enumerate(things) if thing is slope)
    if len(things) == 1:
        return True
    if at == len(things) - 1:
        return slope.joint != "then" and not (slope.article and slope.joint in (",", "and"))
    follows = things[at + 1]
    if (
        follows.kind in WAVY
        and follows.count is None
        and not follows.article
        and follows.joint in ("and", ",")
    ):
        return True  # 'uphill and curvy'
    if (
        slope.joint == "with"
        and follows.joint == "and"
        and turns(follows)
        and all(thing.joint != "then" for thing in things)
    ):
        return True  # 'with a gentle incline and five curves'
    return (slope.after_road or follows.joint in ("with", ",", "stop")) and follows.joint not in ONE_LEG


def _to_the_road(order: DrivingOrder, alone: list[Phrase]) -> None:
    slope, wishes = alone[0], order.wishes
    order.things = [thing for thing in order.things if thing is not slope]
    for thing in order.things:
        if thing.kind in STRAIGHT and thing.slope == "" and thing.joint == "" and thing.incline:
            thing.slope = slope.slope
    _wish(wishes, slope)


def _wish(wishes: RoadWishes, slope: Phrase) -> None:
    if slope.length is not None and wishes.length is None:
        wishes.length = slope.length
    said = slope_of(slope)
    if wishes.slope is None or (said and said.endswith(wishes.slope)):  # 'an uphill road that climbs steeply'
        wishes.slope, wishes.incline = said, slope.incline or wishes.incline
    elif said and {said.split("_")[-1], wishes.slope.split("_")[-1]} == {"up", "down"}:
        raise BriefError(
            "the road cannot go uphill and downhill as a whole; say the slope of each part instead"
        )
    elif said and said != wishes.slope and ("flat" in said) != ("flat" in wishes.slope):
        raise BriefError(
            "the road cannot be flat and also climb or fall; say the slope of each part, as in"
            " 'a flat straight, then a steep climb, then a flat straight'"
        )


def _along_the_road(order: DrivingOrder, only: bool) -> None:
    out, carried = list[Phrase](), None
    things = order.things
    for at, thing in enumerate(things):
        after = things[at + 1] if at + 1 < len(things) else None
        if not _alone(thing):
            carried = _carry(thing, carried)
            out.append(thing)
        elif after is not None and _belongs(thing, after):
            carried = thing
            after.joint = (
                thing.joint if after.joint in SCOPED or thing.joint in ("start", "end") else after.joint
            )
            if after.kind in ("crest", "dip"):
                carried = None
            else:
                _give(after, thing, with_number=True)
                if thing.length is not None and after.length is None and after.kind in STRAIGHT:
                    after.length = thing.length
        elif _describes_the_one_before(thing, after, out):
            _give(out[-1], thing, with_number=True)
            carried = None
        else:
            out.append(replace(thing, kind="straight", count=None, slope_alone=True))
            carried = thing if thing.climbs and not thing.article else None
    order.things = out


def _carry(thing: Phrase, carried: Phrase | None) -> Phrase | None:
    """Passes a slope on: in 'climbs through a left and a right turn' the second climbs, too."""
    if carried is None or thing.kind in ("crest", "dip") or (thing.slope and not _alike(thing, carried)):
        return None
    if thing.slope == "":
        if thing.joint in ("then", "end", "stop") and not carried.climbs:
            return None
        _give(thing, carried, with_number=thing.joint in ("and", ","))
    return carried


def _alike(thing: Phrase, carried: Phrase) -> bool:
    return thing.slope == carried.slope


def _give(thing: Phrase, slope: Phrase, with_number: bool) -> None:
    thing.slope, thing.nearly = slope.slope, slope.nearly
    if with_number:
        thing.steep, thing.mild, thing.incline = slope.steep, slope.mild, thing.incline or slope.incline


def _belongs(slope: Phrase, after: Phrase) -> bool:
    """True if the slope was said of the next feature: 'uphill for 3 turns', 'climbs, straight'."""
    if _alone(after) or after.slope:
        return False
    if after.joint in SCOPED:
        if after.joint == "enter" and slope.article:  # 'a descent into a hairpin'
            return False
        return not (after.joint == "" and slope.article and slope.stretch)
    bare = after.kind == "straight" and not after.article and after.count is None
    return bare and after.joint == ","


def _describes_the_one_before(slope: Phrase, after: Phrase | None, out: list[Phrase]) -> bool:
    """True for '2 turns, uphill, then 2 turns, downhill', where a slope describes the turns before it."""
    if not out or not turns(out[-1]) or out[-1].slope or slope.article or slope.joint not in (",", "(", ""):
        return False
    return not slope.climbs and (after is None or after.joint in ("then", "stop", "and", ")"))
