"""Chooses one meaning for each ambiguous word, judging by the words next to it."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from roadgpt.brief.grammar.quantities import Term

SKIPPED = frozenset({"-", "a", "the", "too", "hyphen"})
SIDES = frozenset({"left", "right"})
TURNING = frozenset(
    {
        "turn",
        "turn+",
        "turn~",
        "hairpin",
        "hairpin+",
        "switchback",
        "switchback+",
        "u_turn",
        "u_turn+",
        "s_bend",
    }
    | {
        "s_bend+",
        "chicane",
        "chicane+",
        "slalom",
        "serpentine",
        "zigzag",
        "winding",
        "kink",
        "dogleg",
        "spiral",
    }
)
MANY = frozenset({name for name in TURNING if name.endswith("+")})
BOTH_WAYS = frozenset({"s_bend", "s_bend+", "chicane", "chicane+", "slalom", "serpentine", "zigzag"})
MANNERS = frozenset({"gentle", "sharp", "sweeping", "long", "short", "hard"})
CLIMBING = frozenset({"up~", "down~", "slope", "flat~"})
SLOPING = CLIMBING | {"up", "down", "hill"}
VERBS = frozenset({"twists", "twist", "winds", "wind", "snakes", "weaves", "meanders"})
HILLS = frozenset({"climbs", "ascents", "descents", "inclines", "declines", "drops", "rises"})
"""Words that are nouns after an adjective, as in 'with steep climbs', and verbs elsewhere."""
LANES = frozenset({"lane", "lanes"})
BEFORE_A_VERB = frozenset({"", "that", "road", "and", "then", ",", "stop", "first_of_all", "start", "end"})


def settle(items: Sequence[Term]) -> list[Term]:
    """Returns the terms of a description, each reduced to the one meaning that its neighbours suggest."""
    out = list[Term]()
    at = 0
    while at < len(items):
        size, name = _sides(items, at)
        if size:
            out.append(replace(items[at], name=name, stop=items[at + size - 1].stop))
            at += size
            continue
        item = items[at]
        before = _name(items, at, -1)
        after = _name(items, at, +1)
        out.append(replace(item, name=_settled(items, at, item, before, after)))
        at += 1
    return out


def _settled(items: Sequence[Term], at: int, item: Term, before: str, after: str) -> str:
    match item.name:
        case "hard":
            return "sharp" if after in TURNING | SIDES | {"sharp"} else "hard_road"
        case "gentle":
            return _gentle(items, at, item, before, after)
        case "sharp":
            steep = (item.text.endswith("ly") and {before, after} & SLOPING) or after in CLIMBING
            return "steep" if steep else "sharp"
        case "m" | "deg" | "%" | "turning_sum" | "count" | "road" if _is_beyond(items, at, before, after):
            return "?"
        case "long" | "short" if before == "m" and items[at - 1].amount is None:
            return "-"
        case "winding" if after in SIDES and item.text in VERBS and not _sides(items, _at(items, at))[0]:
            return "turn~"
        case "turn+" | "crest+":
            return _noun_or_verb(items, at, item, before)
        case "sweeping" if before == "m":  # 'an 8 m wide road'
            return "across"
        case "between" if after in ("", ",", "stop", "then", ")"):
            return "in_between"
        case "then" if item.text == "before" and before in ("", "stop"):
            return "ahead"
        case "nearly":
            return "mostly" if after in SIDES | {"to"} else "nearly" if after in ("flat", "flat~") else "-"
        case "for" | "into" | "enter" if at + 1 < len(items) and items[at + 1].name in ("m", "whole"):
            return "-"
        case "up~" | "down~" if item.text in HILLS:
            return (
                "hills" if _name(items, at, -1, MANNERS | {"steep", "mild", "count"}) == "with" else item.name
            )
        case "slope" if item.text in ("slopes", "gradients", "grades"):
            return "hills"
        case "hill":
            return _hill(items, at, before)
        case _:
            return item.name


def _hill(items: Sequence[Term], at: int, before: str) -> str:
    """Decides a hill: 'a steep hill' is a climb, 'up a hill' only means 'up', any other hill is a crest."""
    if before in ("steep", "mild"):
        return "up~" if _name(items, at, -1, {"steep", "mild"}) not in SLOPING else "-"
    near = {before, _name(items, at, -1, {"steep", "mild", "gentle", "long"})}
    return "-" if near & SLOPING else "crest"


def _is_beyond(items: Sequence[Term], at: int, before: str, after: str) -> bool:
    """True for what no Brief can express: 'a left turn at 50 m', 'total turning of 300 degrees', '3
    lanes'.
    """
    item = items[at]
    match item.name:
        case "count":
            return items[min(at + 1, len(items) - 1)].text in LANES
        case "road":
            return item.text in LANES and before == "count"
        case "m" if item.amount and at and items[at - 1].text == "at":
            return after not in ("radius", "height", "long", "length")
        case "deg" if item.amount:
            return "turning_sum" in [other.name for other in items[max(at - 3, 0) : at]]
        case _:
            return item.amount is None  # a unit without a number; 'total turning'


def _gentle(items: Sequence[Term], at: int, item: Term, before: str, after: str) -> str:
    adverb = item.text.endswith("ly")
    if after in CLIMBING | {"hill"} or (adverb and after in SLOPING):
        return "mild"
    if after in SLOPING:  # 'a gentle uphill turn' is a gentle turn, 'a gentle uphill' a gentle slope
        return "gentle" if _name(items, at, +1, SLOPING | SIDES) in TURNING else "mild"
    return "mild" if before in SLOPING and after not in TURNING | SIDES else "gentle"


def _noun_or_verb(items: Sequence[Term], at: int, item: Term, before: str) -> str:
    """Decides 'turns': 'the road turns left' has one turn, 'a road with left turns' several."""
    verb = item.name.removesuffix("+") + "~"
    if item.name == "crest+":
        return "crest" if before in BEFORE_A_VERB - {""} and item.text == "crests" else item.name
    follows = _name(items, at, +1, MANNERS | {"-"})
    if before in BEFORE_A_VERB and follows in SIDES | {"deg", "deg90"}:
        return verb
    return verb if before in ("that", "road") else item.name


def _sides(items: Sequence[Term], at: int) -> tuple[int, str]:
    """Reads 'left and right' as one meaning where it is one: 'left and right turns'."""
    if items[at].name not in SIDES:
        return 0, ""
    joint = at + 1
    while joint < len(items) and items[joint].name in SKIPPED | {"and", "or", "/"}:
        joint += 1
    if joint >= len(items) or items[joint].name not in SIDES - {items[at].name}:
        return 0, ""
    joints = {item.name for item in items[at + 1 : joint]}
    after = _name(items, joint, +1, MANNERS)
    before = {item.name for item in items[max(at - 3, 0) : at]}
    if "or" in joints:
        return joint - at + 1, "free_side"
    if "a" in joints:
        return 0, ""
    if after in BOTH_WAYS:
        return joint - at + 1, items[at].name
    counted = items[at - 1].name == "a" if at else False
    if "and" in joints or "/" in joints:
        if after in MANY and not counted:
            return joint - at + 1, "both_sides"
        if before & {"alternating", "between"} or after == "alternating" or _whole_of(items, at, joint):
            return joint - at + 1, "both_sides"
    return 0, ""


def _whole_of(items: Sequence[Term], at: int, joint: int) -> bool:
    """True for 'turns to both left and right'."""
    return at > 0 and items[at - 1].name == "both"


def _at(items: Sequence[Term], at: int) -> int:
    """Returns the index of the next term that is not skipped."""
    at += 1
    while at < len(items) - 1 and items[at].name in SKIPPED:
        at += 1
    return min(at, len(items) - 1)


def _name(items: Sequence[Term], at: int, step: int, also: Collection[str] = ()) -> str:
    """Returns the next name that is not skipped; '' at the ends."""
    at += step
    while 0 <= at < len(items) and (items[at].name in SKIPPED or items[at].name in also):
        at += step
    return items[at].name if 0 <= at < len(items) else ""
