"""Defines the grammar of plans of changes for constrained decoding.

A change names a place on the road and what to change there, or adds something new.

Modifiers have the fixed order in which ``brief.change.plan`` prints them.
"""

from collections.abc import Sequence

from roadgpt.brief.readers.model.plan_numbers import COUNTS, Keyed, Numbers
from roadgpt.brief.readers.model.token_grammar import AnyOf, InOrder, Later, ListTail, OneOf, Sequel, Symbol
from roadgpt.brief.readers.model.vocabulary import (
    ALONE,
    ENDS_OF_ROAD,
    FACTORS,
    HALVES,
    KINDS,
    MEASURED,
    NEXT_TO,
    NOUNS,
    PERCENTS,
    POSITIONS,
    SHARPNESS,
    SIDES,
    SIZES,
    SUPERLATIVES,
)

MOST_CHANGES = 8
MOST_NUMBERS = 8
DEEPEST = 2
"""How deeply places in a change may be nested: "all but (the straight after (the first turn))" is depth 2."""
WAYS = ("up", "down", "flat")
STEEPNESS = ("gently_up", "gently_down", "steeply_up", "steeply_down")
HEIGHTS = ("slope", "climb")
"""Properties whose values are written in forms of their own."""
MOVES = ("after(", "before(", "between(")
"""Positions, relative to other places, to which a turn can be moved."""


def change_request(numbers: Numbers) -> Symbol:
    """Returns the grammar of a plan of changes: at most ``MOST_CHANGES``, separated by ";"."""
    added = Sequel(OneOf(("add",)), (_new(numbers),))
    change = AnyOf((added, Sequel(_place(numbers, DEEPEST), (OneOf((":",)), _wish(numbers)))))
    return Sequel(change, (ListTail(";", change, MOST_CHANGES - 1),))


def _place(numbers: Numbers, depth: int) -> Symbol:
    whole, far = OneOf(COUNTS[1:]), OneOf(COUNTS[1:13])
    number = AnyOf((whole, Sequel(OneOf(("-",)), (far,))))
    parts: list[Symbol] = [
        *(number for _ in range(MOST_NUMBERS)),
        OneOf(("all",)),
        OneOf(("middle",)),
        OneOf(SUPERLATIVES),
        Sequel(OneOf(("x",)), (far,)),
        *(OneOf(words) for words in (SIDES, SHARPNESS, WAYS, SIZES)),
        *(_exactly(key, numbers) for key in ("deg=", "len=")),
        OneOf(HALVES),
    ]
    if depth:
        inner = Later(lambda: _place(numbers, depth - 1))
        parts += [_position(inner, POSITIONS), Sequel(OneOf(("but(",)), (inner, OneOf((")",))))]
    return Sequel(OneOf((*dict.fromkeys([*NOUNS, *KINDS]),)), (InOrder(tuple(parts)),))


def _position(inner: Symbol, ways: Sequence[str]) -> Symbol:
    close = OneOf((")",))
    single = tuple(way for way in ways if way != "between(")
    return AnyOf(
        (
            OneOf(ENDS_OF_ROAD),
            Sequel(OneOf(single), (inner, close)),
            Sequel(OneOf(("between(",)), (inner, OneOf((",",)), inner, close)),
        )
    )


def _exactly(key: str, numbers: Numbers) -> Symbol:
    found = numbers.of(key)
    behind = AnyOf((OneOf(found), Sequel(OneOf(("-",)), (OneOf(found),))))
    return Sequel(OneOf((key,) if found else ()), (behind if key == "pct=" else OneOf(found),))


def _wish(numbers: Numbers) -> Symbol:
    like = _place(numbers, DEEPEST - 1)
    measured = [
        Sequel(OneOf((name,)), (_value(name, numbers, like),)) for name in MEASURED if name not in HEIGHTS
    ]
    value = _value("slope", numbers, like)
    slope = AnyOf((Sequel(OneOf(("up", "down")), (_open(value),)), OneOf(("flat", *STEEPNESS)), value))
    shape = InOrder((OneOf(tuple(kind for kind in KINDS if kind not in NOUNS)), OneOf(SHARPNESS)), least=1)
    return AnyOf(
        (
            *measured,
            Sequel(OneOf(("slope",)), (slope,)),
            Sequel(OneOf(("climb",)), (_climb(numbers),)),
            Keyed("x", numbers),
            _position(_place(numbers, DEEPEST - 1), MOVES),
            Sequel(OneOf(("side",)), (OneOf((*SIDES, "other")),)),
            Sequel(OneOf(("shape",)), (shape,)),
            OneOf(ALONE),
        )
    )


def _climb(numbers: Numbers) -> Symbol:
    """Returns the forms of a climb in metres of height, which may be negative: a value, a difference, or a
    factor."""
    found = OneOf(numbers.of("climb"))
    fall = Sequel(OneOf(("-",)), (found,))
    exact = Sequel(OneOf(("=",)), (AnyOf((found, fall)),))
    by = Sequel(OneOf(("+", "-")), (found,))
    return AnyOf((*((exact, by) if found.tokens else ()), *_factors(numbers)))


def _open(symbol: Symbol) -> Symbol:
    return InOrder((symbol,))


def _value(name: str, numbers: Numbers, like: Symbol) -> Symbol:
    """Returns the forms of a value: an exact number or a bound, each also as the place that has it; a
    difference, a factor, or "more" or "less"."""
    found = OneOf(numbers.of(name))
    some = bool(found.tokens)
    exact = [Sequel(OneOf(("=", "..")), (AnyOf((found, like)) if some else like,))]
    exact += [Sequel(OneOf(("+", "-")), (found,))] if some else []
    doses = Sequel(OneOf(("slightly", "much")), (OneOf(("more", "less")),))
    least = [Sequel(each, (OneOf(("..",)),)) for each in ((found, like) if some else (like,))]
    return AnyOf((*exact, *_factors(numbers), doses, OneOf(("more", "less")), *least))


def _factors(numbers: Numbers) -> list[Symbol]:
    percents = OneOf(numbers.percents())
    shares: list[Symbol] = [Sequel(OneOf(tuple(PERCENTS)), (percents,))] if percents.tokens else []
    return [*shares, Sequel(OneOf(("x",)), (OneOf((*FACTORS, *numbers.percents())),))]


def _new(numbers: Numbers) -> Symbol:
    parts: tuple[Symbol, ...] = (
        Sequel(OneOf(("x",)), (OneOf(COUNTS[1:]),)),
        *(OneOf(words) for words in (SIDES, SHARPNESS, (*WAYS, *STEEPNESS))),
        *(_exactly(key, numbers) for key in ("deg=", "len=", "r=", "pct=")),
        OneOf(("whole",)),
        _position(_place(numbers, DEEPEST - 1), NEXT_TO),
    )
    return Sequel(OneOf(KINDS), (InOrder(parts),))
