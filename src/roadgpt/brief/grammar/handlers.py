"""Defines a handler for each meaning of a word; a handler sets the fields of the current Phrase that this
meaning affects.
"""

from collections.abc import Callable
from typing import TypeGuard

from roadgpt.brief.grammar.phrase import ROAD_LIKE, WAVY, Phrase
from roadgpt.brief.grammar.quantities import Term
from roadgpt.brief.model import Amount, Kind, Sharpness, exactly
from roadgpt.brief.normal import STRAIGHT

KINDS: dict[str, tuple[Kind, bool]] = {
    **{
        name: (name, False)
        for name in ("turn", "straight", "crest", "dip", "hairpin", "switchback", "u_turn")
    },
    **{name: (name, False) for name in ("s_bend", "chicane", "slalom", "serpentine", "zigzag", "winding")},
    "turn+": ("turn", True),
    "turn~": ("turn", False),
    "straight+": ("straight", True),
    "crest+": ("crest", True),
    "dip+": ("dip", True),
    "hairpin+": ("hairpin", True),
    "switchback+": ("switchback", True),
    "u_turn+": ("u_turn", True),
    "s_bend+": ("s_bend", True),
    "chicane+": ("chicane", True),
    "kink": ("turn", False),
    "dogleg": ("turn", False),
    "spiral": ("turn", False),
}


def handle_kind(now: Phrase, item: Term) -> None:
    """Sets which feature a phrase describes, such as a hairpin; 'hairpin bend' and 'zig-zag switchbacks' name
    one feature each.
    """
    kind, many = KINDS[item.name]
    if now.kind in WAVY and kind not in STRAIGHT and kind not in ("turn", now.kind):
        now.alternating = now.kind != "winding"
        now.kind = kind
    elif now.kind in (None, "turn"):
        now.kind = kind
    now.many |= many
    now.verb |= item.name.endswith("~")
    if item.name == "kink":
        now.degrees, now.sharpness = Amount(lo=15, hi=30), "gentle"
    elif item.name == "dogleg":
        now.degrees = Amount(lo=60, hi=120)
    elif item.name == "spiral":
        now.spiral = True


def _take_side(now: Phrase, item: Term, after: str) -> None:
    if item.name == "both_sides":
        now.both_sides = True
    elif item.name == "free_side":
        now.free_side = True
    else:
        now.side = "left" if item.name == "left" else "right"


def _take_slope(now: Phrase, item: Term, after: str) -> None:
    now.slope = item.name.rstrip("~")
    now.climbs |= item.name.endswith("~") or item.text in ("going", "goes")
    now.after_road = now.road
    if now.height_said == "" and after == "m":
        now.height_said = "?"  # 'climbs 10 metres'


def _take_count(now: Phrase, item: Term, after: str) -> None:
    if now.pick is not None and item.amount and item.amount.lo:
        now.pick = (now.pick[0] if now.pick[0] >= 0 else -int(item.amount.lo), int(item.amount.lo))
    elif now.count is None or (not now.counted and item.exact):
        now.count, now.counted = item.amount, item.exact
    else:
        now.ignored.append(item)


def _take_metres(now: Phrase, item: Term, after: str) -> None:
    if after == "across":
        now.ignored.append(item)
    elif (now.radius_said or after == "radius") and now.radius is None:
        now.radius = item.amount
        now.series = ("radius", item.series) if item.series else now.series
    elif _is_height(now, item, after):
        now.height = item.amount
    elif now.length is None:
        now.length = item.amount
    else:
        now.ignored.append(item)
    if now.height_said == "?":
        now.height_said = ""


def _is_height(now: Phrase, item: Term, after: str) -> bool:
    if now.height is not None:
        return False
    if now.height_said == "?" and item.amount:
        return (item.amount.hi or item.amount.lo or 0) <= MOST_HEIGHT or after == "height"
    if after in ("up~", "down~") and item.amount and (item.amount.hi or 0) <= MOST_RISE:
        now.height_said = "gain"  # 'a 10 m climb'
        return True
    return now.height_said != "" or after in ("height", "loss", "gain")


MOST_RISE = 20.0
"""The largest length in metres that is read as a height before a noun: 'a 10 m climb' is 10 m high, 'a 50 m
climb' is 50 m long."""
MOST_HEIGHT = 30.0
"""The largest length in metres that is read as a height after a verb: 'climbs 20 metres' is a height, 'climbs
100 metres' a distance."""


def _take_percent(now: Phrase, item: Term, after: str) -> None:
    amount = item.amount
    if now.incline is not None or _changes_sign(amount):
        now.ignored.append(item)
        return
    if _is_negative(amount):  # '-5 %' is downhill
        now.slope = now.slope or "down"
        amount = _size(amount)
    now.incline = amount


def _changes_sign(amount: Amount | None) -> bool:
    """True if the amount reaches from below to above zero: no slope has a name for that."""
    return amount is not None and (amount.lo or 0) < 0 < (amount.hi or 0)


def _is_negative(amount: Amount | None) -> TypeGuard[Amount]:
    return amount is not None and min(amount.lo or 0, amount.hi or 0) < 0


def _size(amount: Amount) -> Amount:
    """Returns the amount without its sign; a bound stays on the side that was said."""
    if amount.lo is None or amount.hi is None:
        return Amount(lo=amount.lo and abs(amount.lo), hi=amount.hi and abs(amount.hi))
    return Amount(lo=abs(amount.hi), hi=abs(amount.lo))


def _take_degrees(now: Phrase, item: Term, after: str) -> None:
    amount = item.amount
    if (now.turned_said or after == "turned") and now.turned is None and not item.series:
        now.turned = amount
        return
    if _changes_sign(amount):
        now.ignored.append(item)
        return
    if item.series:
        now.series = ("degrees", item.series)
    if _is_negative(amount):  # '-90 degrees' is to the right, as RoadGPT has it
        now.side = now.side or "right"
        amount = _size(amount)
    now.degrees = amount if now.degrees is None or not now.degrees.exact else now.degrees


def _take_size(now: Phrase, item: Term, after: str) -> None:
    if now.length is not None or after == "m":
        now.length_said = True
    else:
        now.size = "long" if item.name == "long" else "short"


def _take_road(now: Phrase, item: Term, after: str) -> None:
    if now.kind in ("hairpin", "switchback") and now.count is None:
        now.many = True  # 'a switchback road' has several
    if now.kind is None or now.kind in ROAD_LIKE or now.verb:
        now.road = True
        now.length_said |= now.length is not None


def _take_scope(now: Phrase, item: Term, after: str) -> None:
    if now.kind is None and not now.road:
        now.scope = item.name
    else:
        now.each = True


def _take_other(now: Phrase, item: Term, after: str) -> None:
    if now.count is None:  # 'two other turns' are two more
        now.scope = "rest"


def _take_last(now: Phrase, item: Term, after: str) -> None:
    now.pick = (-1, 1)


def _take_times(now: Phrase, item: Term, after: str) -> None:
    now.times = item.amount or exactly(2)


def _set(**values: object) -> Callable[[Phrase, Term, str], None]:
    def take(now: Phrase, item: Term, after: str) -> None:
        for name, value in values.items():
            setattr(now, name, value)

    return take


def _sharpness(value: Sharpness) -> Callable[[Phrase, Term, str], None]:
    def take(now: Phrase, item: Term, after: str) -> None:
        if now.sharpness is None or value == "sweeping":
            now.sharpness = value

    return take


def _radius_word(now: Phrase, item: Term, after: str) -> None:
    if now.length is not None and now.radius is None and now.turning:
        now.radius, now.length = now.length, None
    now.radius_said = True


HANDLERS: dict[str, Callable[[Phrase, Term, str], None]] = {
    **dict.fromkeys(("left", "right", "both_sides", "free_side"), _take_side),
    **dict.fromkeys(("up", "down", "flat", "up~", "down~", "flat~"), _take_slope),
    **dict.fromkeys(("long", "short"), _take_size),
    **dict.fromkeys(("all", "each", "both", "rest"), _take_scope),
    "gentle": _sharpness("gentle"),
    "sharp": _sharpness("sharp"),
    "sweeping": _sharpness("sweeping"),
    "count": _take_count,
    "m": _take_metres,
    "%": _take_percent,
    "deg": _take_degrees,
    "road": _take_road,
    "deg90": _set(degrees=exactly(90)),
    "deg45": _set(degrees=exactly(45)),
    "last_one": _take_last,
    "times": _take_times,
    "times2": _take_times,
    "radius": _radius_word,
    "length": _set(length_said=True),
    "height": _set(height_said="gain"),
    "turned": _set(turned_said=True),
    "gain": _set(height_said="gain", slope="up", climbs=True),
    "loss": _set(height_said="loss"),
    "lose": _set(height_said="loss", slope="down", climbs=True),
    "highest": _set(highest=True),
    "slope": _set(slope_noun=True),
    "steep": _set(steep=True),
    "mild": _set(mild=True),
    "nearly": _set(nearly=True),
    "hilly": _set(hilly=True),
    "hills": _set(climbs_said=True),
    "more_left": _set(more="left"),
    "more_right": _set(more="right"),
    "same_sides": _set(more="same"),
    "changes": _set(changes=True),
    "mountain": _set(mountain=True),
    "highway": _set(highway=True, road=True),
    "hard_road": _set(hard=True),
    "alternating": _set(alternating=True),
    "whole": _set(whole=True),
    "total": _set(total=True),
    "loop": _set(loop=True),
    "of_them": _set(of_them=True),
    "in_between": _set(in_between=True),
    "repeat": _set(repeat=True),
    "other": _take_other,
    "free_turns": _set(free_turns=True),
    "at_end": _set(place="end"),
    "at_start": _set(place="start"),
    "in_middle": _set(place="middle"),
    "same_hand": _set(same_hand=True),
    "each_side": _set(each_side=True),
    "at_top": _set(place="top"),
    "at_bottom": _set(place="bottom"),
    "half_of": _set(of_them=True, half=3),
    "no": _set(negated=True),
    "only": _set(only=True),
    "a": _set(article=True),
    "again": _set(again=True),
    "stretch": _set(stretch=True),
    "mostly": _set(mostly=True),
    "half1": _set(half=1),
    "half2": _set(half=2),
}
