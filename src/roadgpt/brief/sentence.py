"""Writes a Brief as one plain English sentence, which the grammar reader reads back as the same Brief."""

from collections.abc import Callable

from roadgpt.brief.model import Amount, Brief, Clause, Slope, at_least, exactly
from roadgpt.brief.normal import STRAIGHT, normal

SLOPE_WORDS: dict[Slope, str] = {
    "up": "uphill",
    "down": "downhill",
    "flat": "flat",
    "nearly_flat": "nearly flat",
    "gently_up": "gently uphill",
    "gently_down": "gently downhill",
    "steeply_up": "steeply uphill",
    "steeply_down": "steeply downhill",
}
NOUNS = {"u_turn": "U-turn", "s_bend": "S-bend", "zigzag": "zig-zag", "winding": "winding stretch"}
WAVY = ("serpentine", "zigzag", "winding", "slalom")


def sentence(brief: Brief) -> str:
    """Returns a sentence that states the requirements of a Brief, such as 'An uphill road with 3 turns.'"""
    said = normal(brief)
    adjectives = [_exact_metres(said.length)]
    if said.slope and not said.incline:
        adjectives.append(SLOPE_WORDS[said.slope])
    road = " ".join(word for word in [*adjectives, "motorway" if said.motorway else "road"] if word)
    if said.clauses:
        road += " with " + ", then ".join(clause_text(clause) for clause in said.clauses)
    elif said.turns and said.turns not in (at_least(1), exactly(0)):
        road += f" with {_count(said.turns)} {_plural('turn', said.turns)}"
    text = "; ".join([_article(road) + road, *_wishes(said)])
    return text[0].upper() + text[1:] + "."


def _wishes(brief: Brief) -> list[str]:
    out: list[str | None] = [
        _turns(brief),
        _side_count(brief.left, "left"),
        _side_count(brief.right, "right"),
        "all turns alternating" if brief.alternating else None,
        f"every turn {brief.sharpness}" if brief.sharpness else None,
        _if(brief.degrees, lambda a: f"every turn of {_number(a)} degrees"),
        _if(brief.radius, lambda a: f"every turn radius {_number(a)} metres"),
        _if(brief.turning, lambda a: f"{_number(a)} degrees of turning in all"),
        _slope(brief),
        _if(brief.steepest, lambda a: f"steepest {_number(a)} percent"),
        _if(brief.climb, _climb),
        _if(brief.hills, lambda a: f"{_number(a)} {_plural('change', a)} of slope"),
        None
        if _exact_metres(brief.length)
        else _if(brief.length, lambda a: f"{_number(a)} metres long in all"),
        _if_clause("it starts with", brief.starts),
        _if_clause("it ends with", brief.ends),
        "hard for a lane keeper" if brief.hard else None,
    ]
    return [wish for wish in out if wish]


def _turns(brief: Brief) -> str | None:
    if brief.turns == exactly(0):
        return "no turns"
    if brief.turns == at_least(0):
        return "with or without turns"
    if brief.turns and brief.clauses:
        return f"{_count(brief.turns)} {_plural('turn', brief.turns)} in all"
    return None


def _side_count(amount: Amount | None, side: str) -> str | None:
    if amount is None:
        return None
    return (
        f"no {side} turns"
        if amount == exactly(0)
        else f"{_count(amount)} {side} {_plural('turn', amount)} in all"
    )


def _slope(brief: Brief) -> str | None:
    if brief.incline is None:
        return None
    return f"{SLOPE_WORDS[brief.slope or 'up']} {_percent(brief.incline)} all the way"


def _percent(amount: Amount) -> str:
    return f"{'by' if amount.lo is None or amount.hi is None else 'at'} {_number(amount)} percent"


def _climb(amount: Amount) -> str:
    falls = amount.hi is not None and amount.hi <= 0 and amount.lo != 0
    if falls or (amount.hi is None and (amount.lo or 0) < 0):
        fall = Amount(lo=_minus(amount.hi), hi=_minus(amount.lo))
        return f"a net drop of {_number(fall)} metres"
    return f"a net climb of {_number(amount)} metres"


def _minus(number: float | None) -> float | None:
    return None if number is None else 0.0 - number


def clause_text(clause: Clause) -> str:
    """Returns the text of one clause, such as 'a sharp left turn of 90 degrees uphill at 5 percent'."""
    counted = clause.kind not in WAVY
    count = clause.count if counted else exactly(1)
    noun = NOUNS.get(clause.kind, clause.kind)
    words = ["alternating" if clause.alternating else "", clause.sharpness or "", clause.size or ""]
    if clause.slope and not clause.incline:
        words.append(SLOPE_WORDS[clause.slope])
    leading = clause.side if not (clause.alternating and clause.kind not in STRAIGHT) else None
    words += [leading or "", _plural(noun, count)]
    text = " ".join(word for word in words if word)
    text = (_article(text) if count == exactly(1) else f"{_count(count)} ") + text
    return " ".join([text, *_tails(clause)])


def clause_columns(clause: Clause) -> tuple[str, str]:
    """Returns the text of one clause as two columns of a table: ('2 turns', 'sharp, uphill, left')."""
    noun = NOUNS.get(clause.kind, clause.kind)
    is_one = clause.kind in WAVY or clause.count == exactly(1)
    what = noun if is_one else f"{_count(clause.count)} {_plural(noun, clause.count)}"
    how = ["alternating" if clause.alternating else "", clause.sharpness or "", clause.size or ""]
    if clause.slope and not clause.incline:
        how.append(SLOPE_WORDS[clause.slope])
    leading = clause.side if not (clause.alternating and clause.kind not in STRAIGHT) else None
    how += [leading or "", *_tails(clause)]
    return what, ", ".join(words.removeprefix("of ") for words in how if words)


def road_words(brief: Brief) -> str:
    """Returns the requirements for the whole road as text, such as 'uphill, 3 turns'; empty if there are
    none.
    """
    slope = SLOPE_WORDS[brief.slope] if brief.slope and not brief.incline else ""
    turns = ""
    if not brief.clauses and brief.turns and brief.turns not in (at_least(1), exactly(0), at_least(0)):
        turns = f"{_count(brief.turns)} {_plural('turn', brief.turns)}"
    length = _exact_metres(brief.length)
    said = [f"{length}s long" if length else "", slope, turns, *_wishes(brief)]
    return ", ".join(words for words in said if words)


def _tails(clause: Clause) -> list[str]:
    tails = []
    if clause.degrees:
        tails.append(f"of {_number(clause.degrees)} degrees")
    if clause.length:
        each = " each" if clause.count != exactly(1) else ""
        tails.append(f"of {_number(clause.length)} metres{each}")
    if clause.slope and clause.incline:
        tails.append(f"{SLOPE_WORDS[clause.slope]} {_percent(clause.incline)}")
    if clause.radius:
        tails.append(f"with a radius of {_number(clause.radius)} metres")
    if clause.kind in WAVY and clause.count != exactly(1):
        tails.append(f"with {_count(clause.count)} {_plural('turn', clause.count)}")
    if clause.alternating and clause.side:
        tails.append(f"starting to the {clause.side}")
    return tails


def _if(amount: Amount | None, say: Callable[[Amount], str]) -> str | None:
    return None if amount is None else say(amount)


def _if_clause(lead: str, clause: Clause | None) -> str | None:
    return None if clause is None else f"{lead} {clause_text(clause)}"


def _exact_metres(amount: Amount | None) -> str:
    return f"{_figure(amount.lo or 0)} metre" if amount and amount.exact else ""


def _figure(number: float) -> str:
    return f"{number:.4f}".rstrip("0").rstrip(".")


def _number(amount: Amount) -> str:
    lo, hi = amount.lo, amount.hi
    if lo is not None and hi is not None:
        return _figure(lo) if lo == hi else f"{_figure(lo)} to {_figure(hi)}"
    return f"at least {_figure(lo)}" if lo is not None else f"at most {_figure(hi or 0)}"


def _count(amount: Amount) -> str:
    return _number(amount)


def _plural(noun: str, amount: Amount) -> str:
    is_one = (amount.lo, amount.hi) in ((1, 1), (1, None), (None, 1))
    return noun if is_one else noun + ("es" if noun.endswith("ch") else "s")


def _article(text: str) -> str:
    vowel = text[:1].lower() in "aei" or text.startswith(("up", "S-", "8", "11 ", "18 ", "11.", "18."))
    return "an " if vowel else "a "
