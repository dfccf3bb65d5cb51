"""Grammars of tokens: which tokens may come next, and what follows each token.

A grammar is built of symbols by the functions below. No two alternatives of a symbol begin with the same
token, so the next token decides between them (LL(1)). The state of an unfinished text is a stack of symbols.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import inf
from typing import get_args

from roadgpt.brief.beside import BESIDE
from roadgpt.brief.design_speed import FASTEST, SLOWEST
from roadgpt.brief.junctions import LANE_KINDS, LONGEST_ROUTE, RAMPS, ROUTE, Side
from roadgpt.brief.languages import pattern_of
from roadgpt.brief.model import CentreLine
from roadgpt.brief.plan import HALFWAY, ONE_WAY
from roadgpt.brief.readers.model.slots import LARGEST_SEEN, NumberSlot
from roadgpt.brief.readers.model.vocabulary import (
    FACTORS,
    FIXED,
    KEYS,
    KINDS,
    MEASURED,
    MULTIPLES,
    NOUNS,
    NUMBER_OF,
    ONE,
    ORDER,
    PERCENTS,
    ROUNDABOUT,
    SIGNS,
    SLOPES,
    SLOT_TOKENS,
    STEPS,
    UNIT_OF,
    Compared,
    value_of,
)
from roadgpt.brief.refusal import CLASHING, OF_CAUSES
from roadgpt.brief.words import Surroundings
from roadgpt.language.names import Control, IslandSize, MapJunctionKind, Sharpness, Size, Take
from roadgpt.language.table import ROADS


@dataclass(frozen=True, slots=True)
class Symbol:
    """A part of a grammar, such as a choice between tokens."""

    first: Callable[[], Iterable[str]]
    """Returns the tokens with which the symbol can begin."""
    after: Callable[[str], "Stack"]
    """Returns what follows if the symbol begins with this token."""
    may_be_empty: bool = False
    """Whether the symbol can be left out."""


Stack = tuple[Symbol, ...]
"""The symbols that must or may follow, the next one first."""


def _nothing(token: str) -> Stack:
    return ()


def one_of(*tokens: str, may_be_empty: bool = False) -> Symbol:
    """Returns the symbol for one of several tokens; without tokens, nothing can stand in its place."""
    return Symbol(lambda: tokens, _nothing, may_be_empty)


def sequel(head: Symbol, *rest: Symbol, is_open: bool = False) -> Symbol:
    """Returns the symbol for a sequence of symbols; with ``is_open``, the sequence may be left out."""
    return Symbol(head.first, lambda token: (*head.after(token), *rest), is_open)


def any_of(*ways: Symbol) -> Symbol:
    """Returns the symbol for a choice between several symbols."""

    def after(token: str) -> Stack:
        return next(way.after(token) for way in ways if token in way.first())

    return Symbol(lambda: [token for way in ways for token in way.first()], after)


def in_order(*parts: Symbol, least: int = 0) -> Symbol:
    """Returns the symbol for ``least`` or more of several symbols, each at most once, in the given order."""

    def after(token: str) -> Stack:
        index = next(index for index, part in enumerate(parts) if token in part.first())
        behind = parts[index + 1 :]
        return (*parts[index].after(token), *([in_order(*behind, least=least - 1)] if behind else []))

    return Symbol(lambda: [token for part in parts for token in part.first()], after, least <= 0)


def list_tail(joint: str, item: Symbol, most: int) -> Symbol:
    """Returns the symbol for at most ``most`` further items of a list, each after a separator such as ';'."""
    rest = later(lambda: list_tail(joint, item, most - 1), may_be_empty=True)
    return sequel(one_of(joint) if most else one_of(), item, rest, is_open=True)


def later(make: Callable[[], Symbol], may_be_empty: bool = False) -> Symbol:
    """Returns a symbol that is made when it is needed; a symbol can thus contain itself."""
    made = cache(make)
    return Symbol(lambda: made().first(), lambda token: made().after(token), may_be_empty)


def allowed(stack: Stack) -> list[str]:
    """Returns the tokens that may come next, each once."""
    found: dict[str, None] = {}
    for symbol in stack:
        found |= dict.fromkeys(symbol.first())
        if not symbol.may_be_empty:
            break
    return list(found)


def pushed(stack: Stack, token: str) -> Stack:
    """Returns the stack after one more token; the token must be allowed."""
    for index, symbol in enumerate(stack):
        if token in symbol.first():
            return (*symbol.after(token), *stack[index + 1 :])
        if not symbol.may_be_empty:
            break
    raise ValueError(f"the token '{token}' cannot stand here")


UNSAID = {"deg=": FIXED, "angle=": FIXED, "turning=": ("180",), "steepest=": ("4", "5")}
"""Numbers that a plan may contain although they are not in the text, by plan key, if words imply them."""
ALWAYS = {"angle": FIXED, "slope": ("1",), "climb=": ("0",), **dict.fromkeys(("v=", "dv=", "lead="), ("0",))}
"""Numbers that a plan may contain whatever the text says, by plan key: a right angle, one percent, rest."""
COUNTS = tuple(str(number) for number in range(LARGEST_SEEN + 1))
BOUND, MINUS = "..", "-"
LEAST = {"arms=": 3}  # "a two-lane roundabout" has no two arms
PATTERNS = [*map(pattern_of, ("angle", "mountain", "hilly"))]


@dataclass(frozen=True, slots=True)
class Evidence:
    """The numbers that a description can imply: angles ("right angle"), a grade ("mountain road"), a number
    of hills ("rolling"), and numbers relative to other numbers ("twice as long")."""

    angles: bool = True
    mountains: bool = True
    hills: bool = True
    compared: Compared | None = None

    @classmethod
    def of(cls, text: str) -> "Evidence":
        """Returns which numbers a description can imply; the text must be in lower case and without
        accents."""
        angles, mountains, hills = (pattern.search(text) is not None for pattern in PATTERNS)
        return cls(angles, mountains, hills, Compared.of(text))


@dataclass(frozen=True, slots=True)
class Numbers:
    """The numbers that may occur in the plan of a text."""

    slots: Sequence[NumberSlot]
    said: frozenset[str]
    evidence: Evidence

    def of(self, key: str) -> list[str]:
        """Returns the numbers that may follow a key such as "len="; if there are none, the key is never
        written."""
        fitting = self._fitting(UNIT_OF.get(key, ""))
        if key == "hills=" and not self.evidence.hills:
            return [number for number in COUNTS if number in self.said]
        if key not in UNIT_OF:
            return [each for each in (*COUNTS, *fitting) if value_of(each, self.slots) >= LEAST.get(key, 0)]
        unsaid = UNSAID.get(key, ())
        is_meant = self.evidence.mountains if key == "steepest=" else self.evidence.angles
        plain = [number for number in (*COUNTS, *unsaid) if number in self.said]
        implied = ALWAYS.get(key, unsaid if is_meant else ())
        return [*dict.fromkeys([*fitting, *plain, *implied])]

    def keyed(self, key: str, is_signed: bool = False) -> Symbol:
        """Returns a key and its amount, such as "len=60"; never written if no number suits the key.

        The amount is a number, a bound or a range, and with ``is_signed`` also a negative number."""
        amount = self.amount(key, is_signed)
        return Symbol(lambda: [key] if self.of(key) else [], lambda token: (amount,))

    def amount(self, key: str, is_signed: bool = False, may_be_empty: bool = False) -> Symbol:
        """Returns an amount as ``keyed`` has it, without the key."""
        return Symbol(
            lambda: [BOUND, *self.of(key), *([MINUS] if is_signed else [])] if self.of(key) else [],
            lambda token: self._after_begin_of_amount(key, token),
            may_be_empty,
        )

    def design_speed(self) -> Symbol:
        """Returns the symbol for a design speed, which is one number that a road can have."""
        given = self._fitting(UNIT_OF["speed="])
        fit = [each for each in given if SLOWEST <= value_of(each, self.slots) <= FASTEST]
        return sequel(one_of(*(["speed="] if fit else [])), one_of(*fit))

    def percents(self) -> list[str]:
        """Returns the numbers of the text that can be percentages."""
        return self._fitting("percent")

    def _fitting(self, unit: str) -> list[str]:
        return [SLOT_TOKENS[index] for index, slot in enumerate(self.slots) if slot.unit in ("", unit)]

    def _after_begin_of_amount(self, key: str, token: str) -> Stack:
        number = self._number(key)
        if token == BOUND:
            return (number,)
        if token == MINUS:  # "-9" or "-9..-6"
            return (number, sequel(one_of(BOUND), sequel(one_of(MINUS), number), is_open=True))
        above = self._number(key, value_of(token, self.slots), may_be_empty=True)
        return (*number.after(token), sequel(one_of(BOUND), above, is_open=True))

    def _number(self, key: str, above: float = -inf, may_be_empty: bool = False) -> Symbol:
        return Symbol(
            lambda: [each for each in self.of(key) if value_of(each, self.slots) > above],
            lambda token: self._computed(key, token),
            may_be_empty,
        )

    def _computed(self, key: str, base: str) -> Stack:
        """Returns what may follow a number if the words compare figures: a factor, or a sum with another
        number."""
        compared = self.evidence.compared
        if key not in KEYS or compared is None:
            return ()
        ways: list[Symbol] = [sequel(one_of("x"), one_of(*MULTIPLES))] if compared.by_factor else []
        small = [each for each in COUNTS if each in self.said or (each == "1" and key in ONE)]
        others = [number for number in (*self._fitting(UNIT_OF[key]), *small) if number != base]
        if others and compared.by_difference:
            often = sequel(one_of("x"), one_of(*STEPS), is_open=True)
            ways.append(sequel(one_of(*SIGNS), one_of(*others), often))
        return (sequel(any_of(*ways), is_open=True),) if ways else ()


SIDES: tuple[str, ...] = get_args(Side)
SHARPNESS, SIZES = one_of(*get_args(Sharpness)), one_of(*get_args(Size))
CONTROLS = one_of(*get_args(Control))
PLACES = ("starts(", "ends(")
JUNCTIONS = tuple(kind for kind in get_args(MapJunctionKind) if kind != ROUNDABOUT)
FLAGS = [one_of(flag) for flag in ("skew", "all_way", "crosswalk", "others_stop")]
LISTED_WAYS = ("left+right", "left+straight", "right+straight", "left+right+straight")
STRAIGHT_KINDS = ("straight", "crest", "dip")
END = "<end>"
IN_WORDS = {"against": ONE_WAY, "len": HALFWAY}
"""Words that can replace a key and its amount, by the name of the key."""
MOST_CLAUSES = 20
MOST_JUNCTIONS = 9  # with merges and changes of lanes
MOST_KINDS = 4  # of junctions on a map
MOST_NAMES = 4


class PlanAutomaton:
    """The state of a plan that is written token by token; the state determines which tokens may come next.

    Args:
        slots: the numbers of the text.
        said: the words of the text.
        evidence: which numbers the words may imply; None allows all numbers.
        whole: returns the symbol for what is written."""

    def __init__(
        self,
        slots: Sequence[NumberSlot],
        said: frozenset[str],
        evidence: Evidence | None = None,
        whole: Callable[[Numbers], Symbol] | None = None,
    ) -> None:
        asked = (whole or description)(Numbers(slots, said, evidence or Evidence()))
        first = any_of(*_refusals(), asked)
        self._stack: Stack = (replace(first, may_be_empty=asked.may_be_empty), one_of(END))

    def allowed(self) -> list[int]:
        """Returns the indices of all tokens that may come next."""
        return [NUMBER_OF[word] for word in allowed(self._stack)]

    def push(self, word: str) -> None:
        """Advances the state by one token."""
        self._stack = pushed(self._stack, word)


@cache
def _refusals() -> tuple[Symbol, ...]:
    clashing, beyond = (one_of(*causes, may_be_empty=True) for causes in (CLASHING, OF_CAUSES["!impossible"]))
    return (
        one_of("!nonsense", "!unclear"),
        sequel(one_of("!contradiction"), clashing, clashing),
        sequel(one_of("!impossible"), beyond, beyond),
    )


def description(numbers: Numbers) -> Symbol:
    """Returns the symbol for a road, a route or a map."""
    clause = _clause(numbers)
    wishes = in_order(
        SHARPNESS,
        one_of(*SLOPES),
        one_of(*get_args(Surroundings)),
        *map(one_of, ("alternating", "alike", "hard", "motorway", "divided", "left_hand")),
        *(_road_key(key, numbers) for key in ROADS["keys"]["road"]),
        *(sequel(one_of(place), clause, one_of(")")) for place in PLACES),
        _beside(),
        sequel(one_of("centre="), one_of(*get_args(CentreLine))),
        numbers.design_speed(),
        least=1,
    )
    whole = sequel(one_of("|"), wishes)
    clauses = sequel(clause, list_tail(";", clause, MOST_CLAUSES - 1), replace(whole, may_be_empty=True))
    return any_of(_route(any_of(whole, clauses), numbers), _map(numbers))


@cache
def _beside() -> Symbol:
    names = one_of(*sorted(BESIDE))
    return sequel(one_of("beside("), names, list_tail(",", names, MOST_NAMES - 1), one_of(")"))


def _road_key(key: str, numbers: Numbers) -> Symbol:
    keyed = numbers.keyed(f"{key}=", is_signed=key == "climb")
    return any_of(one_of(IN_WORDS[key]), keyed) if key in IN_WORDS else keyed


def _route(road: Symbol, numbers: Numbers) -> Symbol:
    junction = _junction(numbers)

    def behind_junction(left: int) -> Symbol:
        after = any_of(sequel(road, behind_road(left)), sequel(junction, later_behind(left - 1)))
        return sequel(one_of("//") if left else one_of(), after, is_open=True)

    def behind_road(left: int) -> Symbol:
        return sequel(one_of("//") if left else one_of(), junction, later_behind(left - 1), is_open=True)

    def later_behind(left: int) -> Symbol:
        return later(lambda: behind_junction(left), may_be_empty=True)

    return any_of(
        sequel(road, sequel(behind_road(MOST_JUNCTIONS), _whole(numbers), is_open=True)),
        sequel(junction, behind_junction(MOST_JUNCTIONS - 1), _whole(numbers)),
    )


def _whole(numbers: Numbers) -> Symbol:
    wishes = in_order(one_of("left_hand"), numbers.keyed("len="), _beside(), least=1)
    return sequel(one_of("||"), wishes, is_open=True)


def _junction(numbers: Numbers) -> Symbol:
    side, length = sequel(one_of("side="), one_of(*SIDES)), numbers.keyed("len=")
    to_ramps = ("ramp", "main")
    takes = one_of(*(take for take in get_args(Take) if take not in to_ramps))
    listed = one_of(*LISTED_WAYS, *SIDES, "straight")
    ways, *ends = (sequel(one_of(key), listed) for key in ("ways=", "in=", "out=", "turn_lane="))
    degrees, angle, taper = map(numbers.keyed, ("deg=", "angle=", "taper="))
    exit_, arms, lanes, outer = map(numbers.keyed, ("exit=", "arms=", "lanes=", "outer="))
    turn_length = numbers.keyed("turn_len=")
    radius = any_of(numbers.keyed("r="), numbers.keyed("d="))
    forms: tuple[tuple[Sequence[str], tuple[Symbol, ...]], ...] = (
        (JUNCTIONS, (takes, CONTROLS, *FLAGS, ways, *ends, turn_length, degrees, angle, arms)),
        (
            [ROUNDABOUT],
            (
                takes,
                one_of(*get_args(IslandSize)),
                CONTROLS,
                *FLAGS[1:],
                ways,
                exit_,
                arms,
                radius,
                outer,
                lanes,
            ),
        ),
        (RAMPS, (one_of(*to_ramps), side, length, taper)),
        (LANE_KINDS[:2], (side, length)),
        (LANE_KINDS[2:], (one_of(*SIDES),)),
    )
    return any_of(*(sequel(one_of(*kinds), in_order(*parts)) for kinds, parts in forms))


def _map(numbers: Numbers) -> Symbol:
    kinds, count = one_of(*JUNCTIONS, ROUNDABOUT), numbers.keyed("x")
    route = sequel(one_of(f"{ROUTE}="), _ways(LONGEST_ROUTE))
    tail = in_order(*map(numbers.keyed, ("len=", "blocks=", "dead_ends=")), CONTROLS, route)
    kind = sequel(kinds, in_order(count, CONTROLS))
    listed = sequel(kind, list_tail(";", kind, MOST_KINDS - 1), tail)
    signed = sequel(kinds, in_order(count), CONTROLS)
    grid = sequel(numbers.keyed("columns="), numbers.keyed("rows="), tail, list_tail(";", signed, MOST_KINDS))
    return sequel(one_of("map"), any_of(listed, grid), _whole(numbers))


def _ways(most: int) -> Symbol:
    more = later(lambda: _ways(most - 1), may_be_empty=True)
    return sequel(one_of(*SIDES, "straight") if most else one_of(), more)


def _clause(numbers: Numbers) -> Symbol:
    turning = (kind for kind in KINDS if kind not in STRAIGHT_KINDS)
    count, keys = (
        numbers.keyed("x"),
        {key: numbers.keyed(key) for key in (*("deg=", "r=", "len=", "pct="), "climb=")},
    )
    straight = (count, SIZES, one_of(*SLOPES), keys["len="], keys["pct="], keys["climb="])
    words = (one_of(*SIDES), SHARPNESS, one_of(*SLOPES), one_of("alternating"))
    return any_of(
        sequel(one_of(*STRAIGHT_KINDS), in_order(*straight)),
        sequel(one_of(*turning), in_order(count, *words, *keys.values())),
    )


MOST_CHANGES = 8
MOST_NUMBERS = 8
DEEPEST = 2
"""How deeply places in a change may be nested: "all but (the straight after (the first turn))" is depth 2."""
WAYS = ("up", "down", "flat")
STEEPNESS = ("gently_up", "gently_down", "steeply_up", "steeply_down")
SUPERLATIVES = ("longest", "shortest", "sharpest", "gentlest", "steepest", "flattest")
LESS = one_of("more", "less")
MORE_OR_LESS = (sequel(one_of("slightly", "much"), LESS), LESS)
NEXT_TO = ("after(", "before(", "between(", "on(")
"""The positions of a feature that a change adds, relative to a place on the road."""
MOVES = NEXT_TO[:3]
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
        one_of(*SIDES),
        SHARPNESS,
        one_of(*WAYS),
        SIZES,
        *(_exactly(key, numbers) for key in ("deg=", "len=")),
        one_of("half1", "half2"),
    ]
    if depth:
        inner = later(lambda: _place(numbers, depth - 1))
        parts += [_position(inner, (*NEXT_TO, "from(", "up_to(")), sequel(one_of("but("), inner, one_of(")"))]
    return sequel(one_of(*dict.fromkeys([*NOUNS, *KINDS])), in_order(*parts))


def _position(inner: Symbol, ways: Sequence[str]) -> Symbol:
    close = one_of(")")
    single = (way for way in ways if way != "between(")
    return any_of(
        one_of("at_start", "at_end", "at_middle"),
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
    shape = in_order(one_of(*(kind for kind in KINDS if kind not in NOUNS)), SHARPNESS, least=1)
    whole = (number for number in numbers.of("x") if value_of(number, numbers.slots) in range(1, 1000))
    count = one_of(*whole)
    counted = any_of(sequel(one_of(BOUND), count), sequel(count, one_of(BOUND, may_be_empty=True)))
    return any_of(
        *(sequel(one_of(name), value) for name, value in values.items()),
        sequel(one_of("climb"), _climb(numbers)),
        sequel(one_of("x"), counted),
        _position(like, MOVES),
        sequel(one_of("side"), one_of(*SIDES, "other")),
        sequel(one_of("shape"), shape),
        one_of("straighten", "remove", "mirror", "alternate"),
        sequel(one_of(ORDER), in_order(sequel(one_of("="), like))),
    )


def _climb(numbers: Numbers) -> Symbol:
    metres = numbers.of("climb")
    found = one_of(*metres)
    exact = sequel(one_of("="), any_of(found, sequel(one_of(MINUS), found)))
    by = sequel(one_of("+", MINUS), found)
    return any_of(*((exact, by) if metres else ()), *factors(numbers))


def _value(name: str, numbers: Numbers, like: Symbol) -> Symbol:
    """Returns the forms of a value: an exact number or a bound, each also as the place that has it; a
    difference or a factor, each also of the value of another place; or "more" or "less"."""
    found = numbers.of(name)
    figures = [one_of(*found)] if found else []
    other = in_order(sequel(one_of("="), like))
    return any_of(
        sequel(one_of("=", BOUND), any_of(*figures, like)),
        *(sequel(one_of("+", MINUS), figure, other) for figure in figures),
        *(sequel(factor, other) for factor in factors(numbers)),
        *MORE_OR_LESS,
        *(sequel(each, one_of(BOUND)) for each in (*figures, like)),
    )


def factors(numbers: Numbers) -> list[Symbol]:
    """Returns the symbols for a factor, as a share of the text or as a usual one."""
    found = numbers.percents()
    shares = [sequel(one_of(*PERCENTS), one_of(*found))] if found else []
    return [*shares, sequel(one_of("x"), one_of(*FACTORS, *found))]


def _new(numbers: Numbers) -> Symbol:
    parts = (
        sequel(one_of("x"), one_of(*COUNTS[1:])),
        one_of(*SIDES),
        SHARPNESS,
        one_of(*WAYS, *STEEPNESS),
        *(_exactly(key, numbers) for key in ("deg=", "len=", "r=", "pct=")),
        one_of("whole"),
        _position(_place(numbers, DEEPEST - 1), NEXT_TO),
    )
    return sequel(one_of(*KINDS), in_order(*parts))
