"""Defines the grammar of plans of changes for constrained decoding.

A change names a place on the road and what to change there, or adds something new.

Modifiers have the fixed order in which ``brief.change.plan`` prints them.
"""

from collections.abc import Sequence

from roadgpt.brief.readers.model.plan_numbers import BOUND, COUNTS, MINUS, Numbers
from roadgpt.brief.readers.model.token_grammar import (
    Symbol,
    any_of,
    in_order,
    later,
    list_tail,
    one_of,
    sequel,
)
from roadgpt.brief.readers.model.vocabulary import (
    ALONE,
    ENDS_OF_ROAD,
    FACTORS,
    HALVES,
    KINDS,
    MEASURED,
    NEXT_TO,
    NOUNS,
    ORDER,
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
MOVES = ("after(", "before(", "between(")
"""Positions, relative to other places, to which a turn can be moved."""


def change_request(numbers: Numbers) -> Symbol:
    """Returns the grammar of a plan of changes: at most ``MOST_CHANGES``, separated by ";"."""
    added = sequel(one_of("add"), _new(numbers))
    change = any_of(added, sequel(_place(numbers, DEEPEST), one_of(":"), _wish(numbers)))
    return sequel(change, list_tail(";", change, MOST_CHANGES - 1))


def _place(numbers: Numbers, depth: int) -> Symbol:
    far = one_of(*COUNTS[1:13])
    number = any_of(one_of(*COUNTS[1:]), sequel(one_of(MINUS), far))
    parts = [
        *(number for _ in range(MOST_NUMBERS)),
        one_of("all"),
        one_of("middle"),
        one_of(*SUPERLATIVES),
        sequel(one_of("x"), far),
        *(one_of(*words) for words in (SIDES, SHARPNESS, WAYS, SIZES)),
        *(_exactly(key, numbers) for key in ("deg=", "len=")),
        one_of(*HALVES),
    ]
    if depth:
        inner = later(lambda: _place(numbers, depth - 1))
        parts += [_position(inner, POSITIONS), sequel(one_of("but("), inner, one_of(")"))]
    return sequel(one_of(*dict.fromkeys([*NOUNS, *KINDS])), in_order(*parts))


def _position(inner: Symbol, ways: Sequence[str]) -> Symbol:
    close = one_of(")")
    single = (way for way in ways if way != "between(")
    return any_of(
        one_of(*ENDS_OF_ROAD),
        sequel(one_of(*single), inner, close),
        sequel(one_of("between("), inner, one_of(","), inner, close),
    )


def _exactly(key: str, numbers: Numbers) -> Symbol:
    found = numbers.of(key)
    number = one_of(*found)
    signed = any_of(number, sequel(one_of(MINUS), number))
    return sequel(one_of(key) if found else one_of(), signed if key == "pct=" else number)


def _wish(numbers: Numbers) -> Symbol:
    like = _place(numbers, DEEPEST - 1)
    values = {name: _value(name, numbers, like) for name in MEASURED if name != "climb"}
    slope = values["slope"]
    values["slope"] = any_of(sequel(one_of("up", "down"), in_order(slope)), one_of("flat", *STEEPNESS), slope)
    shape = in_order(one_of(*(kind for kind in KINDS if kind not in NOUNS)), one_of(*SHARPNESS), least=1)
    return any_of(
        *(sequel(one_of(name), value) for name, value in values.items()),
        sequel(one_of("climb"), _climb(numbers)),
        numbers.keyed("x"),
        _position(like, MOVES),
        sequel(one_of("side"), one_of(*SIDES, "other")),
        sequel(one_of("shape"), shape),
        one_of(*ALONE),
        sequel(one_of(ORDER), in_order(sequel(one_of("="), like))),
    )


def _climb(numbers: Numbers) -> Symbol:
    """Returns the forms of a climb in metres of height, which may be negative: a value, a difference, or a
    factor."""
    metres = numbers.of("climb")
    found = one_of(*metres)
    exact = sequel(one_of("="), any_of(found, sequel(one_of(MINUS), found)))
    by = sequel(one_of("+", MINUS), found)
    return any_of(*((exact, by) if metres else ()), *_factors(numbers))


def _value(name: str, numbers: Numbers, like: Symbol) -> Symbol:
    """Returns the forms of a value: an exact number or a bound, each also as the place that has it; a
    difference or a factor, each also of the value of another place; or "more" or "less"."""
    found = numbers.of(name)
    figures = [one_of(*found)] if found else []
    other = in_order(sequel(one_of("="), like))
    return any_of(
        sequel(one_of("=", BOUND), any_of(*figures, like)),
        *(sequel(one_of("+", MINUS), figure, other) for figure in figures),
        *(sequel(factor, other) for factor in _factors(numbers)),
        sequel(one_of("slightly", "much"), one_of("more", "less")),
        one_of("more", "less"),
        *(sequel(each, one_of(BOUND)) for each in (*figures, like)),
    )


def _factors(numbers: Numbers) -> list[Symbol]:
    found = numbers.percents()
    shares = [sequel(one_of(*PERCENTS), one_of(*found))] if found else []
    return [*shares, sequel(one_of("x"), one_of(*FACTORS, *found))]


def _new(numbers: Numbers) -> Symbol:
    parts = (
        sequel(one_of("x"), one_of(*COUNTS[1:])),
        *(one_of(*words) for words in (SIDES, SHARPNESS, (*WAYS, *STEEPNESS))),
        *(_exactly(key, numbers) for key in ("deg=", "len=", "r=", "pct=")),
        one_of("whole"),
        _position(_place(numbers, DEEPEST - 1), NEXT_TO),
    )
    return sequel(one_of(*KINDS), in_order(*parts))
