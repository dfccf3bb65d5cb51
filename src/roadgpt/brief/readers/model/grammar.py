"""Grammars of tokens: which tokens may come next, and what follows each token.

Behind a road, a route or a map stand ``:`` with the wishes for it that a text tells among its story (its
kind, its design speed, where one comes from), and ``&&`` with the scene:

    | lanes= 1 against= 1 : country from= south speed= [2] && ego v= [1] ; truck ahead : brake ; night

A grammar is built of symbols by the functions below. No two alternatives of a symbol begin with the same
token, so the next token decides between them (LL(1)). The state of an unfinished text is a stack of symbols.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from math import inf
from typing import cast, get_args

from roadgpt.brief.amount import Frozen
from roadgpt.brief.beside import BESIDE
from roadgpt.brief.design_speed import FASTEST, SLOWEST
from roadgpt.brief.junctions import FORMS, LONGEST_ROUTE, ROUTE, TAKES
from roadgpt.brief.languages import pattern_of
from roadgpt.brief.normal import STRAIGHT
from roadgpt.brief.plan import A_LAND, A_PATCH, HALFWAY, SCENE, SIDES, SLIPPERY, TESTED_CAR
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
    OF_ORDER,
    ONE,
    ORDER,
    PERCENTS,
    RAINS,
    ROUNDABOUT,
    SIGNS,
    SLOT_TOKENS,
    STEPS,
    UNIT_OF,
    WISHES,
    Compared,
    value_of,
    written,
)
from roadgpt.brief.refusal import CLASHING, OF_CAUSES
from roadgpt.brief.scene import LAND_KINDS, ON_ITS_WAY, ONE_OF, Land, Role, SlipperyPlace
from roadgpt.language.names import MapJunctionKind, What, Where
from roadgpt.language.table import (
    COUNTED,
    CUES,
    FLOWS,
    LANDFORMS,
    LIGHTS,
    MANEUVERS,
    NUMBERS,
    PARTS,
    PLACES,
    ROAD_USERS,
    ROADS,
    SURFACES,
    WEATHER,
    Part,
    named_in,
)


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
    """Returns the symbol for one of several tokens; without tokens, nothing can stand in its place. Names of
    rows that have no token are left out."""
    known = written(tokens)
    return Symbol(lambda: known, _nothing, may_be_empty)


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


SHARPNESS, SIZES = one_of(*named_in("sharpness")), one_of(*named_in("sizes"))
CONTROLS = one_of(*named_in("controls"))
LISTED_WAYS = ("left+right", "left+straight", "right+straight", "left+right+straight")
END = "<end>"
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
    apart = {name: sequel(one_of(f"{name}("), clause, one_of(")")) for name in ("starts", "ends")}
    apart |= {"beside": _beside(), "speed": numbers.design_speed()}
    apart["length"] = any_of(one_of(HALFWAY), numbers.keyed("len="))
    whole = sequel(one_of("|"), in_order(*_parts(PARTS["road"], numbers, apart), least=1))
    clauses = sequel(clause, list_tail(";", clause, MOST_CLAUSES - 1), replace(whole, may_be_empty=True))
    return any_of(_route(any_of(whole, clauses), numbers), _map(numbers))


@cache
def _beside() -> Symbol:
    names = one_of(*sorted(BESIDE))
    return sequel(one_of("beside("), names, list_tail(",", names, MOST_NAMES - 1), one_of(")"))


def _parts(
    parts: Mapping[str, Part],
    numbers: Numbers,
    apart: Mapping[str, Symbol],
    names: Iterable[str] | None = None,
) -> Iterator[Symbol]:
    """Yields the symbols for what a thing can have, by the names of fields; ``apart`` has those that are not
    only words and numbers."""
    for name in parts if names is None else names:
        part = parts[name]
        if name in apart:
            yield apart[name]
        elif not part.token:
            continue
        elif part.words:
            words = one_of(*(LISTED_WAYS if part.list else ()), *part.words)
            yield sequel(one_of(f"{part.key}="), words) if part.key else words
        elif part.key == COUNTED:
            yield numbers.keyed(COUNTED)
        else:
            keyed = numbers.keyed(f"{part.key}=", is_signed=part.signed)
            zero = [one_of(part.zero)] if part.zero else []
            double = [numbers.keyed(f"{part.double}=")] if part.double else []
            yield any_of(*zero, keyed, *double)


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
    def of(form: str, names: Iterable[str]) -> Symbol:
        kinds = [kind for kind in named_in("junctions") if FORMS[kind] == form]
        takes = (take for take in named_in("takes") if any(take in TAKES[kind] for kind in kinds))
        return sequel(
            one_of(*kinds), in_order(*_parts(PARTS["junction"], numbers, {"take": one_of(*takes)}, names))
        )

    return any_of(*(of(form, names) for form, names in ROADS["forms"].items()))


def _map(numbers: Numbers) -> Symbol:
    plain = (kind for kind in get_args(MapJunctionKind) if kind != ROUNDABOUT)
    kinds, count = one_of(*plain, ROUNDABOUT), numbers.keyed("x")
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
    def of(what: str, kinds: Iterable[str]) -> Symbol:
        names = [name for name, part in PARTS["clause"].items() if part.of in ("", what)]
        return sequel(one_of(*kinds), in_order(*_parts(PARTS["clause"], numbers, {}, names)))

    straight = [kind for kind in KINDS if kind in STRAIGHT]
    return any_of(of("straights", straight), of("turns", [kind for kind in KINDS if kind not in straight]))


MOST_CHANGES = 8
MOST_NUMBERS = 8
DEEPEST = 2
"""How deeply places in a change may be nested: "all but (the straight after (the first turn))" is depth 2."""
LESS = one_of("more", "less")
MORE_OR_LESS = (sequel(one_of("slightly", "much"), LESS), LESS)


def change_request(numbers: Numbers) -> Symbol:
    """Returns the grammar of a plan of changes: at most ``MOST_CHANGES``, separated by ";"."""
    added = sequel(one_of("add"), _new(numbers))
    change = any_of(added, sequel(_place(numbers, DEEPEST), one_of(":"), _wish(numbers)))
    return sequel(change, list_tail(";", change, MOST_CHANGES - 1))


def _place(numbers: Numbers, depth: int) -> Symbol:
    far = one_of(*COUNTS[1:13])
    number = any_of(one_of(*COUNTS[1:]), sequel(one_of(MINUS), far))
    parts = [*(number for _ in range(MOST_NUMBERS)), *_described("place", numbers, COUNTS[1:13])]
    if depth:
        inner = later(lambda: _place(numbers, depth - 1))
        parts += [_position(inner, ""), sequel(one_of("but("), inner, one_of(")"))]
    return sequel(one_of(*dict.fromkeys([*NOUNS, *KINDS])), in_order(*parts))


def _described(thing: str, numbers: Numbers, counts: Sequence[str]) -> Iterator[Symbol]:
    keys = {name: f"{part.key}=" for name, part in PARTS[thing].items() if part.key}
    apart = {name: _exactly(key, numbers) for name, key in keys.items()}
    return _parts(PARTS[thing], numbers, apart | {"count": sequel(one_of(COUNTED), one_of(*counts))})


def _position(inner: Symbol, how: str) -> Symbol:
    """Returns the symbol for a position; ``how`` are those of a part that is new or moved, or else all."""
    close, ways = one_of(")"), [way for way, row in ROADS["positions"].items() if not how or row.get(how)]
    return any_of(
        one_of(*ROADS["ends"]),
        sequel(one_of(*(f"{way}(" for way in ways if way != "between")), inner, close),
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
    level = [way for way in PARTS["new"]["slope"].words if way not in ("up", "down")]
    values["slope"] = any_of(sequel(one_of("up", "down"), in_order(slope)), one_of(*level), slope)
    shape = in_order(one_of(*(kind for kind in KINDS if kind not in NOUNS)), SHARPNESS, least=1)
    whole = (number for number in numbers.of("x") if value_of(number, numbers.slots) in range(1, 1000))
    count = one_of(*whole)
    counted = any_of(sequel(one_of(BOUND), count), sequel(count, one_of(BOUND, may_be_empty=True)))
    return any_of(
        *(sequel(one_of(name), value) for name, value in values.items()),
        sequel(one_of("climb"), _climb(numbers)),
        sequel(one_of("x"), counted),
        _position(like, "moved"),
        sequel(one_of("side"), one_of(*SIDES, "other")),
        sequel(one_of("shape"), shape),
        one_of(*(wish for wish in ROADS["wishes"] if wish not in OF_ORDER)),
        sequel(one_of(ORDER), in_order(sequel(one_of("="), like))),
    )


def _climb(numbers: Numbers) -> Symbol:
    metres = numbers.of("climb")
    found = one_of(*metres)
    exact = sequel(one_of("="), any_of(found, sequel(one_of(MINUS), found)))
    by = sequel(one_of("+", MINUS), found)
    return any_of(*((exact, by) if metres else ()), *factors(numbers))


def _value(name: str, numbers: Numbers, like: Symbol | None = None) -> Symbol:
    """Returns the forms of a value: an exact number or a bound, each also as the place ``like`` that has
    it; a difference or a factor, each also of the value of another place; or "more" or "less"."""
    found, key = numbers.of(name), name.removesuffix("=")
    figures = [one_of(*found)] if found else []
    is_signed = any(number.key == key and number.least < 0 for number in NUMBERS.values())
    below = [sequel(one_of(MINUS), *figures)] if is_signed and found else []
    values, other = figures, list[Symbol]()
    if like is not None:
        values, other, below = [*figures, like], [in_order(sequel(one_of("="), like))], []
    return any_of(
        *([sequel(one_of("="), any_of(*values, *below))] if values else []),
        *([sequel(one_of(BOUND), any_of(*values))] if values else []),
        *(sequel(one_of("+", MINUS), figure, *other) for figure in figures),
        *(sequel(each, one_of(BOUND)) for each in values),
        *(sequel(factor, *other) for factor in factors(numbers)),
        *MORE_OR_LESS,
    )


def factors(numbers: Numbers) -> list[Symbol]:
    """Returns the symbols for a factor, as a share of the text or as a usual one."""
    found = numbers.percents()
    shares = [sequel(one_of(*PERCENTS), one_of(*found))] if found else []
    return [*shares, sequel(one_of("x"), one_of(*FACTORS, *found))]


def _new(numbers: Numbers) -> Symbol:
    position = _position(_place(numbers, DEEPEST - 1), "new")
    return sequel(one_of(*KINDS), in_order(*_described("new", numbers, COUNTS[1:]), position))


ACTORS, WHATS, AIRS = written(ROAD_USERS), cast("list[What]", written(MANEUVERS)), written(WEATHER)
WHERES = cast("list[Where]", written(PLACES))
STRUCTURES = [form for form, row in LANDFORMS.items() if row.structure]
MOST_ACTORS, MOST_PATCHES, MOST_LANDS, MOST_ACTIONS = 6, 2, 5, 4
MOST_SAME = tuple(map(str, range(1, 10)))
ONE_SIDE = one_of(*SIDES, "opposite")
WHICH = (
    *(any_of(one_of(*MOST_SAME), sequel(one_of("-"), one_of(*MOST_SAME))) for _ in range(3)),
    one_of("all"),
)
"""Which of several alike things are meant."""


def whole(numbers: Numbers) -> Symbol:
    """Returns the symbol for a road, a route or a map, with what is told beside it."""
    return sequel(description(numbers), told(numbers))


def told(numbers: Numbers) -> Symbol:
    """Returns the symbol for a scene and the wishes before it; all of it may be left out."""
    origin = sequel(one_of("from="), one_of(*named_in("compass")))
    wishes = in_order(one_of(*named_in("surroundings"), "motorway"), origin, numbers.design_speed(), least=1)
    scene = sequel(one_of(SCENE), _joined([_tested_car(numbers), *_parts_of_scene(numbers)]))
    both = any_of(sequel(one_of(WISHES), wishes, replace(scene, may_be_empty=True)), scene)
    return replace(both, may_be_empty=True)


def _tested_car(numbers: Numbers) -> Symbol:
    lane = sequel(one_of("lane="), any_of(one_of(*MOST_SAME[:4]), sequel(one_of("-"), one_of("1", "2", "3"))))
    ways = one_of(*SIDES, "straight")
    return sequel(one_of(TESTED_CAR), in_order(one_of("robot"), ways, numbers.keyed("v="), lane, least=1))


def _parts_of_scene(numbers: Numbers) -> list[Symbol]:
    """Returns the symbols for the parts of a scene, in their order, but for the tested car."""
    return [
        *[_actor(numbers)] * MOST_ACTORS,
        one_of(*FLOWS),
        sequel(one_of("oncoming"), one_of(*FLOWS, "none")),
        *(sequel(one_of("parked"), one_of(*SIDES)) for _ in SIDES),
        *(_air(kind, numbers) for kind in AIRS),
        one_of(*LIGHTS),
        one_of(*SURFACES),
        *[sequel(one_of(SLIPPERY), in_order(*_parts(A_PATCH.parts, numbers, {})))] * MOST_PATCHES,
        *[_land(numbers)] * MOST_LANDS,
    ]


def _joined(parts: Sequence[Symbol]) -> Symbol:
    """Returns the symbol for one or more of the parts, each at most once, in this order, and ';' between."""

    @cache
    def behind(index: int) -> Symbol:
        if index == len(parts):
            return one_of(may_be_empty=True)
        return sequel(one_of(";"), later(lambda: since(index)), is_open=True)

    @cache
    def since(index: int) -> Symbol:
        return any_of(
            *(sequel(part, behind(place + 1)) for place, part in enumerate(parts) if place >= index)
        )

    return since(0)


def _air(kind: str, numbers: Numbers) -> Symbol:
    """Returns the symbol for a kind of weather, with or without an amount of the text."""
    symbol = sequel(one_of(kind), numbers.amount(f"{kind}=", may_be_empty=True))
    return any_of(symbol, one_of(*RAINS)) if kind == "rain" else symbol


def _actor(numbers: Numbers) -> Symbol:
    def after_kind(kind: str) -> Stack:
        places = [where for where in WHERES if kind in PLACES[where].who]
        after = {str(where): partial(_after_place, kind, where, numbers) for where in places}
        return sequel(numbers.keyed("x"), is_open=True), Symbol(lambda: places, lambda where: after[where]())

    return Symbol(lambda: ACTORS, after_kind)


def _after_place(kind: str, where: Where, numbers: Numbers) -> Stack:
    sides = [*SIDES, *(["opposite"] if where == "junction" else [])] if PLACES[where].side else []
    fields = [name for name in NUMBERS if name in Role.model_fields and where in NUMBERS[name].where]
    if kind not in MANEUVERS["keep"].who or where == "parked":
        fields = [name for name in fields if name not in ("speed", "faster")]
    if where == "crossing":  # the networks were not trained to write its gap to a part of the route
        fields.remove("gap")
    apart = (group for group in ONE_OF[:-1] if "at" not in group)
    groups = [[name for name in fields if name in group] for group in (*apart, ["away"])]
    keys = [_one_key(names, numbers) for names in groups]
    doings = [what for what in WHATS if kind in MANEUVERS[what].who]
    first = [what for what in doings if where in MANEUVERS[what].starts]
    later_on = [what for what in doings if what not in ON_ITS_WAY or what in first]
    actions = _actions(first, later_on, MOST_ACTIONS, numbers)
    return (
        in_order(*([one_of(*sides)] if sides else []), *keys, _mark()),
        sequel(one_of(":"), actions, is_open=True) if first else one_of(may_be_empty=True),
    )


def _actions(first: Sequence[What], later_on: Sequence[What], most: int, numbers: Numbers) -> Symbol:
    after = {str(what): partial(_after_doing, what, numbers) for what in first}
    head = Symbol(lambda: first, lambda what: after[what]())
    if most == 1:
        return head
    return sequel(
        head,
        sequel(one_of(","), later(lambda: _actions(later_on, later_on, most - 1, numbers)), is_open=True),
    )


def _after_doing(what: What, numbers: Numbers) -> Stack:
    doing = MANEUVERS[what]
    side = [one_of(*SIDES)] if doing.side else []
    keys = [_one_key([name], numbers) for name in NUMBERS if name in doing.numbers]
    cue = any_of(_one_key([name for name in CUES if name in NUMBERS], numbers), _mark(is_of_action=True))
    return (in_order(*side, *keys, cue),)


def _one_key(names: Sequence[str], numbers: Numbers) -> Symbol:
    """Returns the symbol for one of several numbers with its key."""
    given = [NUMBERS[name] for name in names if name in NUMBERS]
    return any_of(*(numbers.keyed(f"{each.key}=", is_signed=each.least < 0) for each in given))


@cache
def _mark(is_of_action: bool = False) -> Symbol:
    """Returns the symbol for a part of the route, such as "after turn 1", and, for when an action begins,
    also for what another actor does, such as "with truck 1 brake"."""
    last = sequel(one_of("-"), one_of("1"))
    place = sequel(one_of("turn", "junction"), any_of(one_of(*MOST_SAME), last))
    event = sequel(one_of(*ACTORS), one_of(*MOST_SAME), one_of(*WHATS))
    if not is_of_action:
        return sequel(one_of("after", "before", "in"), place)
    after = sequel(one_of("after"), any_of(place, event))
    return any_of(sequel(one_of("before", "in"), place), after, sequel(one_of("with"), event))


def _land(numbers: Numbers) -> Symbol:
    plain = in_order(*_parts(A_LAND.parts, numbers, {}, ("count", "length")))
    forms = [form for form in LANDFORMS if form not in STRUCTURES]
    lies = in_order(*_parts(A_LAND.parts, numbers, {}))
    return any_of(sequel(one_of(*STRUCTURES), plain), sequel(one_of(*forms), lies))


def any_change(numbers: Numbers) -> Symbol:
    """Returns the symbol for a request that changes the road, the scene or both."""
    change = _scene_change(numbers)
    scene = sequel(one_of(SCENE), change, list_tail(";", change, MOST_CHANGES - 1))
    road = sequel(change_request(numbers), replace(scene, may_be_empty=True))
    return any_of(road, scene)


def _scene_change(numbers: Numbers) -> Symbol:
    """Returns the symbol for one change of a scene: what is added, or something and what is to be of it."""
    actor = any_of(
        sequel(one_of("add"), _actions(WHATS, [], 1, numbers)),
        sequel(one_of("as"), in_order(one_of(*ACTORS), one_of(*WHERES), ONE_SIDE, least=1)),
        Symbol(lambda: WHATS, lambda what: (_of_doing(cast(What, what), numbers),)),
        *_of_thing(Role, numbers),
    )
    levels = one_of(*FLOWS, "none")
    things: dict[tuple[str, ...], tuple[Sequence[Symbol], Symbol]] = {
        (*ACTORS, "actor"): ((*WHICH, one_of(*WHERES), ONE_SIDE), actor),
        (*LANDFORMS, "landscape"): ((*WHICH, one_of(*SIDES)), any_of(*_of_thing(Land, numbers))),
        ("slippery",): (WHICH, any_of(*_of_thing(SlipperyPlace, numbers))),
        (TESTED_CAR,): ((), any_of(sequel(one_of("v="), _value("v=", numbers)), one_of("remove"))),
        ("traffic", "oncoming"): ((), any_of(one_of("remove"), levels, *MORE_OR_LESS)),
        ("land",): ((), any_of(*MORE_OR_LESS)),
        **{(kind,): ((), any_of(one_of("remove"), _value(f"{kind}=", numbers))) for kind in AIRS},
        ("parked",): ([one_of(*SIDES)], one_of("remove")),
        (*LIGHTS, *SURFACES, "scene"): ((), one_of("remove")),
    }
    known = [
        sequel(one_of(*names), in_order(*which), one_of(":"), wish) for names, (which, wish) in things.items()
    ]
    parts = {tuple(part.first()): part for part in _parts_of_scene(numbers)}  # each kind once
    new = any_of(_tested_car(numbers), *parts.values(), one_of(*LAND_KINDS))
    return any_of(sequel(one_of("add"), new), *known)


def _of_thing(kind: type[Frozen], numbers: Numbers) -> list[Symbol]:
    """Returns the symbols for what can be changed of each thing of a kind: its numbers and how many it is."""
    keys = [NUMBERS[name].key for name in kind.model_fields if name in NUMBERS]
    count = one_of(*(each for each in numbers.of("x") if value_of(each, numbers.slots) >= 1))
    counted = any_of(sequel(one_of(".."), count), sequel(count, one_of("..", may_be_empty=True)))
    is_counted = "count" in kind.model_fields
    return [
        one_of("remove"),
        *([sequel(one_of("x"), counted)] if is_counted else []),
        *(sequel(one_of(f"{key}="), _value(f"{key}=", numbers)) for key in keys),
    ]


def _of_doing(what: What, numbers: Numbers) -> Symbol:
    names = [*MANEUVERS[what].numbers, *(name for name in CUES if name in NUMBERS)]
    keys = [f"{NUMBERS[name].key}=" for name in names]
    usual = [_value(keys[0], numbers)] if MANEUVERS[what].numbers else []
    return any_of(
        one_of("remove"), *usual, *(sequel(one_of(key), _value(key, numbers)) for key in dict.fromkeys(keys))
    )
