"""Rewrites a request in simpler words, which the parser of clauses knows. Main function: ``reworded``.

turn 4 (the last one) a hairpin          turn 4 a hairpin
left instead of right                    left
from 60 to 80 m                          to 80 m
take 10 degrees off the first turn       the first turn gentler by 10 degrees
no steeper than 6 %                      slope at most 6 %
"""

from collections.abc import Sequence
from dataclasses import replace

from roadgpt.design.edit.lexing import RequestLexeme
from roadgpt.design.edit.limiting import bounded
from roadgpt.design.edit.naming import NamedTarget, named

Row = list[RequestLexeme]
STOPS = {"comma", "then", "stop", "open", "close"}
VERBS = {"make", "add", "remove"}
QUALITIES = {"left", "right", "up", "down", "flat", "sharp", "gentle", "sweeping", "long", "short", "steep"}
EXTRA = {"another", "an extra", "an additional", "a further", "some extra", "some more"}
EXTREMES = {
    ("smallest", "radius"): "sharpest",
    ("largest", "radius"): "gentlest",
    ("largest", "angle_noun"): "sharpest",
    ("smallest", "angle_noun"): "gentlest",
    ("largest", "slope_noun"): "steepest",
    ("largest", "length_noun"): "longest",
    ("smallest", "length_noun"): "shortest",
}
ARTICLES = {"a", "the"}
MORE = {"deg": "sharper", "m": "longer", "%": "steeper"}
LESS = {"deg": "gentler", "m": "shorter", "%": "flatter"}
ONTO = {"to", "from", "on", "the", "ord", "every", "it", "at_end", "at_start", "turn", "at", "of"}


def reworded(row: Sequence[RequestLexeme]) -> Row:
    """Returns the same request in simpler words."""
    out = _by_extremes(_turning(_without_statements(_without_asides([*row]))))
    out = [lexeme for lexeme in out if lexeme.name != "is"]
    out = _by_amounts(_new_in_row(_from_to(_followed(_instead(bounded(_apart(_pairs(out))))))))
    return [replace(x, name="and") if x.name == "plus" else x for x in out if x.name not in ("from", "over")]


def _name(row: Row, at: int) -> str:
    return row[at].name if 0 <= at < len(row) else ""


def _by_extremes(row: Row) -> Row:
    """'The turn with the smallest radius' is the sharpest one."""
    for at, lexeme in enumerate(row):
        most = EXTREMES.get((lexeme.name, _name(row, at + 1)))
        begun = at - 1 if _name(row, at - 1) == "the" else at
        if most and _name(row, begun - 1) == "with" and _name(row, begun - 2) in ("turn", "straight"):
            noun = begun - 2
            return [*row[:noun], RequestLexeme(most, lexeme.text), row[noun], *_by_extremes(row[at + 2 :])]
    return row


def _turning(row: Row) -> Row:
    """'The second turn should turn 10 degrees less': the second of these words is a verb."""
    out: Row = []
    for at, lexeme in enumerate(row):
        verb = at + (lexeme.name == "every")
        is_verb = _name(row, verb) == "turn" and _name(row, verb + 1) == "#" and row[verb + 1].unit == "deg"
        begun = max((i + 1 for i in range(at) if row[i].name in STOPS), default=0)
        if is_verb and any(x.name in ("turn", "it") for x in out[begun - at :] if at > begun):
            if lexeme.name != "every":
                continue
            row[verb] = replace(row[verb], name="-")
            continue
        if lexeme.name != "-":
            out.append(lexeme)
    return out


def _without_asides(row: Row) -> Row:
    """Brackets around another name of the same are left out, others become commas."""
    out: Row = []
    at = 0
    while at < len(row):
        found = named(row, at + 1) if row[at].name == "open" else None
        if found and _name(row, found.stop) == "close":
            at = found.stop + 1
            continue
        out.append(replace(row[at], name="comma") if row[at].name in ("open", "close") else row[at])
        at += 1
    return out


def _without_statements(row: Row) -> Row:
    """'The last straight is 108 m, make it 60': what is so already only names the place."""
    at = next((i for i, x in enumerate(row) if x.name == "is"), -1)
    stop = next((i for i in range(at + 1, len(row)) if row[i].name in {*STOPS, "and"}), len(row))
    end = next((i for i in range(stop + 1, len(row)) if row[i].name in STOPS), len(row))
    is_told = at > 0 and _name(row, at + 1) == "#" and not {x.name for x in row[:at]} & VERBS
    return [*row[:at], *row[stop:]] if is_told and any(x.name == "it" for x in row[stop:end]) else row


def _pairs(row: Row) -> Row:
    """'Add a left-right' adds an S-bend."""
    sides = ("left", "right")
    if not any(x.name == "add" for x in row):
        return row
    at = next((i for i, x in enumerate(row) if x.name in sides and _name(row, i + 1) in sides), -1)
    if at < 0 or row[at].name == row[at + 1].name:
        return row
    behind = at + 2 + (_name(row, at + 2) == "turn")
    return [*row[:at], row[at], RequestLexeme("s_bend", row[at + 1].text), *row[behind:]]


def _apart(row: Row) -> Row:
    """'Separate the two turns by 40 m' is a straight between them."""
    at = next((i for i, x in enumerate(row) if x.name == "separate"), -1)
    found = named(row, at + 1) if at >= 0 else None
    if found is None:
        return row
    straight = [RequestLexeme("add", "apart"), RequestLexeme("a", "a"), RequestLexeme("straight", "straight")]
    return [*row[:at], *straight, RequestLexeme("between", "between"), *row[at + 1 :]]


def _followed(row: Row) -> Row:
    """'Follow the first turn with a hairpin' adds one after it."""
    at = next((i for i, x in enumerate(row) if x.name == "follow"), -1)
    if at < 0:
        return row
    how = "before" if row[at].text.lower().startswith("prec") else "after"
    begun = max((i + 1 for i in range(at) if row[i].name in STOPS), default=0)
    stop = next((i for i in range(at, len(row)) if row[i].name in STOPS), len(row))
    if found := named(row, at + 1):
        place, new = row[at + 1 : found.stop], row[found.stop : stop]
    else:
        place, new = row[begun:at], row[at + 1 : stop]
    place, new = [x for x in place if x.name not in VERBS], [x for x in new if x.name not in ("with", "by")]
    return [*row[:begun], RequestLexeme("add", ""), *new, RequestLexeme(how, how), *place, *row[stop:]]


def _instead(row: Row) -> Row:
    """What is not wanted any more is left out, or is what something new takes the place of."""
    at = next((i for i, x in enumerate(row) if x.name == "instead"), -1)
    if at < 0:
        return row
    begun = max((i + 1 for i in range(at) if row[i].name in {*STOPS, "and"}), default=0)
    stop = next((i for i in range(at + 1, len(row)) if row[i].name in {*STOPS, "and"}), len(row))
    found = named(row, at + 1)
    if found and found.stop > stop:
        stop = found.stop
    behind = stop if _name(row, stop) in STOPS else stop - 1
    end = next((i for i in range(behind + 1, len(row)) if row[i].name in {*STOPS, "and"}), len(row))
    new = row[begun:at] or row[behind + 1 : end]
    if found and _is_replaced(found, new):
        kept = [x for x in new if x.name not in VERBS]
        rest = row[stop:] if at > begun else row[end:]
        middle = [RequestLexeme("make", ""), *row[at + 1 : found.stop], *kept]
        return [*row[:begun], *middle, *_instead(rest)]
    return [*row[:at], *_instead(row[stop:])]


def _is_replaced(found: NamedTarget, new: Row) -> bool:
    is_known = found.target.noun in ("turn", "straight") and found.target.is_definite
    first = next((i for i, x in enumerate(new) if x.name not in VERBS), len(new))
    return is_known and not found.target.is_bare and _name(new, first) == "a"


def _from_to(row: Row) -> Row:
    """'From 60 to 80 m', 'from right to left': what it is now says nothing of what it is to be."""
    out: Row = []
    at = 0
    while at < len(row):
        is_from = row[at].name == "from" or row[at].text.lower() in ("von", "de", "da")
        stop = _behind_old(row, at + 1) if is_from else 0
        if stop:
            if _name(row, stop + 1) == "#" and _name(row, stop - 1) == "#" and not row[stop + 1].unit:
                row[stop + 1] = replace(row[stop + 1], unit=row[stop - 1].unit)
            at = stop
            continue
        out.append(row[at])
        at += 1
    return out


def _behind_old(row: Row, at: int) -> int:
    """The index behind the old value; 0 where none stands there with a new one behind it."""
    while _name(row, at) in ARTICLES:
        at += 1
    if _name(row, at) == "#":
        is_to = _name(row, at + 1) in ("to", "a") and _name(row, at + 2) == "#"
        return at + 1 if is_to else 0
    if _name(row, at) not in QUALITIES:
        return 0
    at += 1
    while _name(row, at) in ("turn", "slope_noun"):
        at += 1
    return at if any(_name(row, i) in QUALITIES for i in range(at, at + 3)) else 0


def _new_in_row(row: Row) -> Row:
    """'Add a second turn' adds one."""
    if not any(x.name == "add" for x in row):
        return row
    return [x for i, x in enumerate(row) if not (x.name == "ord" and x.value > 0 and _is_an(row, i - 1))]


def _is_an(row: Row, at: int) -> bool:
    return _name(row, at) == "a" and any(x.name == "add" for x in row[max(at - 2, 0) : at])


def _by_amounts(row: Row) -> Row:
    """'Add 20 m to the first straight', 'take 10 degrees off the second turn'."""
    unit = ""
    out: Row = []
    for at, lexeme in enumerate(row):
        unit_ = row[at + 1].unit if _name(row, at + 1) == "#" else ""
        if lexeme.name == "plus" and unit_ in ("deg", "m"):  # 'turn 1 +15 degrees'
            out += [replace(lexeme, name=MORE[unit_]), RequestLexeme("by", "")]
            continue
        if lexeme.name == "plus" and unit_ == "%":  # 'to +5 %'
            out.append(replace(lexeme, name="up"))
            continue
        if lexeme.name == "#" and lexeme.value < 0 and lexeme.unit in ("deg", "m"):
            out += [
                RequestLexeme(LESS[lexeme.unit], ""),
                RequestLexeme("by", ""),
                replace(lexeme, value=-lexeme.value),
            ]
            continue
        is_extra = lexeme.name == "a" and lexeme.text.lower() in EXTRA and unit_ in MORE
        if is_extra and not _is_new(row, at):  # 'give it another 30 m'
            out += [replace(lexeme, name=MORE[unit_]), RequestLexeme("by", "")]
            continue
        if lexeme.name == "remove" and _is_slope_of(row, at + 1):  # 'remove the slope from turn 1'
            out.append(replace(lexeme, name="flat"))
            gone = 1 + (_name(row, at + 1) == "the")
            row[at + 1 : at + 1 + gone] = [RequestLexeme("at", "")] * gone
            continue
        step = at + 1
        while _name(row, step) in ("a", "more", "by"):
            step += 1
        if lexeme.name in ("add", "remove", "less", "more") and _name(row, step) == "#":
            number = row[step]
            unit = number.unit or unit
            if unit in MORE and _name(row, step + 1) in ONTO and not _is_new(row, step):
                row[step] = replace(number, unit=unit)
                is_more = lexeme.name in ("add", "more")
                out += [replace(lexeme, name=(MORE if is_more else LESS)[unit]), RequestLexeme("by", "")]
                continue
        out.append(lexeme)
    return out


def _is_new(row: Row, at: int) -> bool:
    """'Add 40 m of straight road' adds something."""
    found = named(row, at)
    return found is not None and found.target.is_new


def _is_slope_of(row: Row, at: int) -> bool:
    at += _name(row, at) == "the"
    is_slope = _name(row, at) in ("up", "down", "slope_noun")
    return is_slope and _name(row, at + 1) in ("from", "of", "on", "at_end", "at_start")
