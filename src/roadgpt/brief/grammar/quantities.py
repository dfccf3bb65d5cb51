"""Reads numbers with their bounds and units, such as 'no more than 3', '40 to 60 metres', 'one in ten'."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from roadgpt.brief.grammar.lexicon import Lexeme
from roadgpt.brief.model import Amount

UNITS: dict[str, tuple[str, float]] = {
    "m": ("m", 1.0),
    "km": ("m", 1000.0),
    "ft": ("m", 0.3048),
    "yd": ("m", 0.9144),
    "mile": ("m", 1609.344),
    "%": ("%", 1.0),
    "deg": ("deg", 1.0),
    "speed": ("speed", 1.0),
    "times": ("times", 1.0),
}
"""Maps each unit to the unit that RoadGPT uses for it, and to its size in that unit: 'km' to ('m', 1000)."""
BEFORE = frozenset({">=", "<=", ">", "<", "exact"})
RANGE_WORDS = frozenset({"to", "bis", "a", "till", "until", "-"})
LOOK_BACK = 3  # items between a bound and its number: 'a minimum radius of 20 m'


@dataclass(frozen=True, slots=True)
class Term:
    """The meaning of one or more words, or a quantity, which is a number with its unit.

    A quantity has an ``amount``, and its name is its unit or, if it has no unit, 'count'.
    """

    name: str
    start: int
    stop: int
    text: str = ""
    amount: Amount | None = None
    exact: bool = True
    """True if the text contains the number, not a word such as 'several'."""
    series: tuple[float, ...] = ()
    """All numbers of a list, such as '45, 60 and 90 degrees'; ``amount`` is the first."""


@dataclass(frozen=True, slots=True)
class _Read:
    """A number or a range of numbers, which ends before the lexeme ``stop``."""

    lo: float | None
    hi: float | None
    stop: int
    exact: bool = True


def quantities(lexemes: Sequence[Lexeme]) -> list[Term]:
    """Combines numbers with their bounds and units, and returns all terms of the description in order."""
    out, at = list[Term](), 0
    while at < len(lexemes):
        lexeme = lexemes[at]
        if lexeme.name == "1:n":
            out.append(Term("%", lexeme.start, lexeme.stop, amount=_amount(lexeme.value, lexeme.value)))
            at += 1
        elif lexeme.name.startswith("#"):
            at = _quantity(lexemes, at, out)
        else:
            out.append(Term(lexeme.name, lexeme.start, lexeme.stop, lexeme.text))
            at += 1
    return _bounded(out)


def _quantity(lexemes: Sequence[Lexeme], at: int, out: list[Term]) -> int:
    read = _number(lexemes, at)
    if (listed := _series(lexemes, at)) is not None:
        out.append(listed[0])
        return listed[1]
    if (slope := _one_in(lexemes, read)) is not None:
        out.append(
            Term("%", lexemes[at].start, lexemes[slope[1] - 1].stop, amount=_amount(slope[0], slope[0]))
        )
        return slope[1]
    unit, stop = _unit(lexemes, read.stop)
    first = read
    if (second := _second(lexemes, stop, read)) is not None:
        unit_after, stop = _unit(lexemes, second.stop)
        unit = unit_after or unit
        low, high = sorted((first.lo or 0.0, second.hi or 0.0))
        read = replace(second, lo=low, hi=high)
    name, factor = UNITS[unit] if unit else ("count", 1.0)
    lo, hi = (None if x is None else x * factor for x in (read.lo, read.hi))
    item = Term(name, lexemes[at].start, lexemes[stop - 1].stop, "#", _amount(lo, hi), read.exact)
    out.append(item)
    return stop


def _series(lexemes: Sequence[Lexeme], at: int) -> tuple[Term, int] | None:
    """Reads a list of numbers with one unit after the last: '45, 60 and 90 degrees'."""
    numbers, stop, joint = list[float](), at, ""
    while stop < len(lexemes) and lexemes[stop].name.startswith("#"):
        read = _number(lexemes, stop)
        if read.lo is None or read.lo != read.hi:
            return None
        numbers.append(read.lo)
        stop, joint = read.stop, ""
        while stop < len(lexemes) and lexemes[stop].name in (",", "and"):
            joint, stop = lexemes[stop].name, stop + 1
        if not joint:
            break
    unit, stop = _unit(lexemes, stop)
    if joint or len(numbers) < 2 or unit not in ("deg", "m") or _is_between(lexemes, at):
        return None
    item = Term(unit, lexemes[at].start, lexemes[stop - 1].stop, "#", _amount(numbers[0], numbers[0]))
    return replace(item, series=tuple(numbers)), stop


def _is_between(lexemes: Sequence[Lexeme], at: int) -> bool:
    return "between" in [lexeme.name for lexeme in lexemes[max(at - 2, 0) : at]]


def _amount(lo: float | None, hi: float | None) -> Amount:
    lo, hi = (None if x is None else round(x, 4) for x in (lo, hi))
    return Amount(lo=lo, hi=hi)


def _number(lexemes: Sequence[Lexeme], at: int) -> _Read:
    """Reads the number that begins here: digits, or words as in 'three hundred and fifty'."""
    name = lexemes[at].name
    if name == "#":
        return _Read(lexemes[at].value, lexemes[at].value, at + 1)
    if name.endswith("+"):
        return _Read(float(name[1:-1]), None, at + 1, exact=False)
    if "-" in name:
        low, high = name[1:].split("-")
        return _Read(float(low), float(high), at + 1, exact=False)
    total, at = _words(lexemes, at)
    return _Read(total, total, at)


def _words(lexemes: Sequence[Lexeme], at: int) -> tuple[float, int]:
    total, last = float(lexemes[at].name[1:]), at + 1
    while last < len(lexemes):
        step = 1 if lexemes[last].text in ("and", "hyphen", "-") and total >= 100 else 0
        if last + step >= len(lexemes):
            break
        name = lexemes[last + step].name
        if not name[1:].isdigit():
            break
        more = float(name[1:])
        if more in (100, 1000) and total < more and not step:
            total *= more
        elif (20 <= total % 100 <= 90 and total % 10 == 0 and more < 10) or (total >= 100 and more < 100):
            total += more
        else:
            break
        last += step + 1
    return total, last


def _one_in(lexemes: Sequence[Lexeme], read: _Read) -> tuple[float, int] | None:
    """Reads 'one in ten' as percent."""
    at = read.stop
    if read.lo != 1 or at + 1 >= len(lexemes) or lexemes[at].name != "in_ten":
        return None
    if not lexemes[at + 1].name.startswith("#"):
        return None
    run = _number(lexemes, at + 1)
    return (100.0 / run.lo, run.stop) if run.lo else None


def _unit(lexemes: Sequence[Lexeme], at: int) -> tuple[str, int]:
    step = 1 if at < len(lexemes) and lexemes[at].name == "hyphen" else 0
    if at + step < len(lexemes) and lexemes[at + step].name in UNITS:
        name, stop = lexemes[at + step].name, at + step + 1
        per_hour = [lexeme.text for lexeme in lexemes[stop : stop + 2]] == ["/", "h"]
        return ("speed", stop + 2) if per_hour else (name, stop)
    return "", at


def _second(lexemes: Sequence[Lexeme], at: int, first: _Read) -> _Read | None:
    """Reads the other end of a range: '3 to 5', '3-5', 'between 3 and 5', 'two or three'."""
    if at + 1 >= len(lexemes) or not first.exact or not lexemes[at + 1].name.startswith("#"):
        return None
    joint = lexemes[at]
    before = [lexeme.name for lexeme in lexemes[max(at - 4, 0) : at]]
    if (
        joint.text in RANGE_WORDS
        or joint.name in ("or", "hyphen")
        or (joint.name == "and" and "between" in before)
    ):
        second = _number(lexemes, at + 1)
        return second if second.exact else None
    return None


def _bounded(items: list[Term]) -> list[Term]:
    """Applies bounds to the amounts beside them and removes the bounds."""
    out = list[Term]()
    waiting: Term | None = None
    for at, item in enumerate(items):
        if item.amount is not None:
            if waiting is not None and not (waiting.text == "over" and _passed(items, at, out)):
                item = _with(item, waiting.name)
            waiting = None
            out.append(_with_other_bound(out, _without_between(out, item)))
        elif item.name in ("or_more", "or_less"):
            _bound_behind(out, replace(item, name=">=" if item.name == "or_more" else "<="))
        elif item.name in BEFORE:
            waiting = item
        else:
            if waiting is not None and item.name in (",", "stop", "and", "then", "end"):
                _bound_behind(out, waiting)
                waiting = None
            if waiting is not None and item.name == "a":  # 'at least a left turn'
                out.append(_with(Term("count", item.start, item.stop, "#", _amount(1, 1)), waiting.name))
                waiting = None
            else:
                out.append(item)
    if waiting is not None:
        _bound_behind(out, waiting)
    return out


def _passed(items: list[Term], at: int, out: list[Term]) -> bool:
    """True for 'climbs 10 m over 200 m' and 'over three crests': a distance, not a bound."""
    if at + 1 < len(items) and items[at + 1].name in ("crest", "crest+", "hill", "hilly"):
        return True
    return any(item.amount is not None for item in out[-LOOK_BACK - 1 :])


def _without_between(out: list[Term], item: Term) -> Term:
    if out and out[-1].name == "between" and item.amount and not item.amount.exact:
        out.pop()
    return item


def _with_other_bound(out: list[Term], item: Term) -> Term:
    """Joins 'at least 4 and at most 6 turns' to one range, and removes its first bound."""
    first = out[-2] if len(out) > 1 and out[-1].name in ("and", ",") else None
    if first is None or first.amount is None or item.amount is None or first.name not in ("count", item.name):
        return item
    low, high = first.amount.lo, item.amount.hi
    if low is None or high is None or first.amount.hi is not None or item.amount.lo is not None or low > high:
        return item
    del out[-2:]
    return replace(item, start=first.start, amount=Amount(lo=low, hi=high))


def _bound_behind(out: list[Term], bound: Term) -> None:
    """Reads '3 turns minimum': the bound follows its number."""
    for at in range(len(out) - 1, max(len(out) - 1 - LOOK_BACK, -1), -1):
        if out[at].amount is not None:
            out[at] = _with(out[at], bound.name)
            return


def _with(item: Term, bound: str) -> Term:
    """Returns the term with a bound applied; 'more than 3 turns' is 4 or more, since counts are whole."""
    amount = item.amount
    number = amount.lo if amount and amount.lo is not None else amount.hi if amount else None
    if amount is None or number is None:
        return item
    step = 1.0 if item.name == "count" else 0.0
    bounds: dict[str, Callable[[], Amount]] = {
        ">=": lambda: Amount(lo=number),
        ">": lambda: Amount(lo=number + step),
        "<=": lambda: Amount(hi=number if amount.hi is None else amount.hi),
        "<": lambda: Amount(hi=max(number - step, 0.0)),
    }
    return replace(item, amount=bounds[bound]()) if bound in bounds else item
