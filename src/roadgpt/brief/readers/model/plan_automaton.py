"""Defines the grammar of plans for constrained decoding: the model can only write plans that can be read.

Modifiers have the fixed order in which ``brief.plan`` prints them. A measured number is either a slot
of the text with a suitable unit, or a number that a word implies ("right angle": 90).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from roadgpt.brief.beside import BESIDE
from roadgpt.brief.halfway import HALFWAY
from roadgpt.brief.plan import ONE_WAY, ROAD_KEYS
from roadgpt.brief.readers.model.evidence import Evidence
from roadgpt.brief.readers.model.measures import LARGEST_SEEN
from roadgpt.brief.readers.model.slots import NumberSlot
from roadgpt.brief.readers.model.token_grammar import (
    AnyOf,
    InOrder,
    Later,
    ListTail,
    OneOf,
    Sequel,
    Stack,
    Symbol,
    allowed,
    pushed,
)
from roadgpt.brief.readers.model.vocabulary import (
    ALONE,
    CENTRES,
    CLAUSE_KEYS,
    CONTROLS,
    ENDS_OF_ROAD,
    FACTORS,
    FIXED,
    FLAGS,
    HALVES,
    JUNCTIONS,
    KINDS,
    LANE_KINDS,
    LISTED_WAYS,
    MEASURED,
    NEWER_FLAGS,
    NEXT_TO,
    NOUNS,
    NUMBER_OF,
    PERCENTS,
    PLACES,
    POSITIONS,
    RAMPS,
    RING_SIZES,
    SHARPNESS,
    SIDES,
    SIZES,
    SLOPES,
    SLOT_TOKENS,
    SUPERLATIVES,
    TAKES,
    UNIT_OF,
)
from roadgpt.brief.refusal import CLASHING, OF_CAUSES

STRAIGHT_KINDS = ("straight", "crest", "dip")
UNSAID = {"deg=": FIXED, "angle=": FIXED, "turning=": ("180",), "steepest=": ("4", "5"), "climb=": ("0",)}
"""Numbers that a plan may contain although they are not in the text, by plan key, if words imply them."""
ALWAYS = {"angle": FIXED, "slope": ("1",), "climb=": ("0",)}
"""Numbers that a plan may contain whatever the text says, by plan key: a right angle, one percent."""
COUNTS = tuple(str(number) for number in range(LARGEST_SEEN + 1))
LEAST = {"arms=": 3}  # "a two-lane roundabout" has no two arms
END = "<end>"
IN_WORDS = {"against": ONE_WAY, "len": HALFWAY}
"""Words that can replace a key and its amount, by the name of the key."""
MOST_CLAUSES = 20
MOST_JUNCTIONS = 9  # with merges and changes of lanes
MOST_KINDS = 4  # of junctions on a map
MOST_CHANGES = 8
MOST_NAMES = 4
MOST_NUMBERS = 8
DEEPEST = 2
"""How deeply places in a change may be nested: "all but (the straight after (the first turn))" is depth 2."""
WAYS = ("up", "down", "flat")


class PlanAutomaton:
    """The state of a plan that is written token by token; the state determines which tokens may come next.

    Args:
        slots: the numbers of the text.
        said: the words of the text.
        evidence: which numbers the words may imply; None allows all numbers.
        is_change: whether the text is a change request instead of a description.
    """

    def __init__(
        self,
        slots: Sequence[NumberSlot],
        said: frozenset[str],
        evidence: Evidence | None = None,
        is_change: bool = False,
    ) -> None:
        numbers = Numbers(slots, said, evidence or Evidence())
        whole = _change_request(numbers) if is_change else _description(numbers)
        self._stack: Stack = (AnyOf((*_refusals(), whole)), OneOf((END,)))

    def copy(self) -> "PlanAutomaton":
        """Returns an independent copy in the same state."""
        other = object.__new__(PlanAutomaton)
        other._stack = self._stack
        return other

    def allowed(self) -> list[int]:
        """Returns the indices of all tokens that may come next."""
        return [NUMBER_OF[word] for word in allowed(self._stack)]

    def push(self, word: str) -> None:
        """Advances the state by one token."""
        self._stack = pushed(self._stack, word)


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
            return [each for each in (*COUNTS, *fitting) if self.value(each) >= LEAST.get(key, 0)]
        unsaid = UNSAID.get(key, ())
        is_meant = {
            "deg=": self.evidence.angles,
            "angle=": self.evidence.angles,
            "turning=": self.evidence.angles,
            "steepest=": self.evidence.mountains,
        }.get(key, True)
        plain = [number for number in (*COUNTS, *unsaid) if number in self.said]
        if key in ALWAYS:
            unsaid = ALWAYS[key]
        return [*dict.fromkeys([*fitting, *plain, *(unsaid if is_meant else ())])]

    def _fitting(self, unit: str) -> list[str]:
        return [SLOT_TOKENS[index] for index, slot in enumerate(self.slots) if slot.unit in ("", unit)]

    def percents(self) -> list[str]:
        """Returns the numbers of the text that can be percentages."""
        return self._fitting("percent")

    def value(self, word: str) -> float:
        """Returns the value of a number token."""
        return self.slots[SLOT_TOKENS.index(word)].value if word in SLOT_TOKENS else float(word)


@dataclass(frozen=True, slots=True)
class Keyed:
    """A key and its amount, such as "len=60" or "len=60..80"; never written if no number suits the key."""

    key: str
    numbers: Numbers
    may_be_empty: bool = False

    def first(self) -> Iterable[str]:
        """Returns the key if there are numbers for it."""
        return [self.key] if self.numbers.of(self.key) else []

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns the amount."""
        return (AmountTokens(self.key, self.numbers),)


@dataclass(frozen=True, slots=True)
class AmountTokens:
    """The number, bound or range that follows a key; if ``low`` is set, the upper end of a range from
    ``low``."""

    key: str
    numbers: Numbers
    low: str = ""
    may_be_empty: bool = False

    def first(self) -> Iterable[str]:
        """Returns the numbers and signs with which the amount can begin."""
        numbers = self.numbers.of(self.key)
        if self.low:
            low = self.numbers.value(self.low)
            return [number for number in numbers if self.numbers.value(number) > low]
        return ["..", *numbers, *(["-"] if self.key == "climb=" else [])]

    def after(self, token: str) -> tuple[Symbol, ...]:
        """Returns the rest of the amount."""
        if self.low:
            return ()
        if token in ("..", "-"):
            return (OneOf(self.numbers.of(self.key)),)
        above = replace(self, low=token, may_be_empty=True)
        return (Sequel(OneOf(("..",)), (above,), is_open=True),)


def _refusals() -> tuple[Symbol, ...]:
    clashing, beyond = OneOf(tuple(CLASHING), True), OneOf(tuple(OF_CAUSES["!impossible"]), True)
    return (
        OneOf(("!nonsense", "!unclear")),
        Sequel(OneOf(("!contradiction",)), (clashing, clashing)),
        Sequel(OneOf(("!impossible",)), (beyond, beyond)),
    )


def _description(numbers: Numbers) -> Symbol:
    clause = _clause(numbers)
    placed = [Sequel(OneOf((place,)), (clause, OneOf((")",)))) for place in PLACES]
    flags = (["alternating"], ["hard"], ["motorway"], ["divided"], ["left_hand"])
    wishes = InOrder(
        (
            *(OneOf(words) for words in (SHARPNESS, SLOPES, *flags)),
            *(_road_key(key, numbers) for key in ROAD_KEYS),
            *placed,
            _beside(),
            Sequel(OneOf(("centre=",)), (OneOf(CENTRES),)),
        ),
        least=1,
    )
    whole = Sequel(OneOf(("|",)), (wishes,))
    clauses = (ListTail(";", clause, MOST_CLAUSES - 1), replace(whole, is_open=True))
    road = AnyOf((whole, Sequel(clause, clauses)))
    return AnyOf((*_route(road, numbers), _map(numbers)))


def _beside() -> Symbol:
    names = OneOf(sorted(BESIDE))
    return Sequel(OneOf(("beside(",)), (names, ListTail(",", names, MOST_NAMES - 1), OneOf((")",))))


def _road_key(key: str, numbers: Numbers) -> Symbol:
    """Returns a key and its amount, or the word that stands for an amount."""
    keyed, word = Keyed(f"{key}=", numbers), IN_WORDS.get(key)
    return AnyOf((OneOf((word,)), keyed)) if word else keyed


def _route(road: Symbol, numbers: Numbers) -> tuple[Symbol, ...]:
    """Returns the two forms of a road or a route: it begins with a road, or with a junction."""
    whole = Sequel(
        OneOf(("||",)),
        (InOrder((OneOf(("left_hand",)), Keyed("len=", numbers), _beside()), least=1),),
        is_open=True,
    )
    junction = junction_tokens(numbers)

    def behind_junction(left: int) -> Symbol:
        after = [
            Sequel(road, (behind_road(left),)),
            Sequel(junction, (Later(lambda: behind_junction(left - 1), True),)),
        ]
        return Sequel(OneOf(("//",) if left else ()), (AnyOf(tuple(after)),), is_open=True)

    def behind_road(left: int) -> Symbol:
        rest = (junction, Later(lambda: behind_junction(left - 1), True))
        return Sequel(OneOf(("//",) if left else ()), rest, is_open=True)

    first = Sequel(
        OneOf(("//",)), (junction, Later(lambda: behind_junction(MOST_JUNCTIONS - 1), True), whole), True
    )
    return (
        Sequel(road, (first,)),
        Sequel(junction, (behind_junction(MOST_JUNCTIONS - 1), whole)),
    )


def junction_tokens(numbers: Numbers) -> Symbol:
    """Returns the grammar of a junction, a merge, an exit or a lane change in a plan."""
    side, length = Sequel(OneOf(("side=",)), (OneOf(SIDES),)), Keyed("len=", numbers)
    takes, controls = OneOf((*SIDES, *TAKES)), OneOf(CONTROLS)
    flags = tuple(OneOf((flag,)) for flag in (*FLAGS, *NEWER_FLAGS))
    listed = OneOf((*LISTED_WAYS, *SIDES, "straight"))
    ways, only_in, only_out = (Sequel(OneOf((key,)), (listed,)) for key in ("ways=", "in=", "out="))
    degrees, angle, taper = (Keyed(key, numbers) for key in ("deg=", "angle=", "taper="))
    exit_, arms, lanes = (Keyed(key, numbers) for key in ("exit=", "arms=", "lanes="))
    radius = AnyOf((Keyed("r=", numbers), Keyed("d=", numbers)))
    forms: tuple[tuple[Sequence[str], tuple[Symbol, ...]], ...] = (
        (JUNCTIONS, (takes, controls, *flags, ways, only_in, only_out, degrees, angle, arms)),
        (("roundabout",), (takes, OneOf(RING_SIZES), controls, *flags[1:], ways, exit_, arms, radius, lanes)),
        (RAMPS, (OneOf(("ramp", "main")), side, length, taper)),
        (LANE_KINDS, (side, length)),
        (("lane_change",), (OneOf(SIDES),)),
    )
    return AnyOf(tuple(Sequel(OneOf(kinds), (InOrder(parts),)) for kinds, parts in forms))


def _map(numbers: Numbers) -> Symbol:
    count = InOrder((Keyed("x", numbers),))
    kinds = OneOf((*JUNCTIONS, "roundabout"))
    listed = Sequel(kinds, (count, ListTail(";", Sequel(kinds, (count,)), MOST_KINDS - 1)))
    grid = Sequel(Keyed("columns=", numbers), (Keyed("rows=", numbers),))
    tail = InOrder((Keyed("len=", numbers), Keyed("dead_ends=", numbers), OneOf(CONTROLS)))
    whole = Sequel(OneOf(("||",)), (InOrder((OneOf(("left_hand",)), _beside()), least=1),), is_open=True)
    return Sequel(OneOf(("map",)), (AnyOf((listed, grid)), tail, whole))


def _clause(numbers: Numbers) -> Symbol:
    turning = tuple(kind for kind in KINDS if kind not in STRAIGHT_KINDS)
    count, keys = Keyed("x", numbers), {key: Keyed(key, numbers) for key in CLAUSE_KEYS}
    straight = (count, OneOf(SIZES), OneOf(SLOPES), keys["len="], keys["pct="])
    words = tuple(OneOf(words) for words in (SIDES, SHARPNESS, SLOPES, ["alternating"]))
    return AnyOf(
        (
            Sequel(OneOf(STRAIGHT_KINDS), (InOrder(straight),)),
            Sequel(OneOf(turning), (InOrder((count, *words, *keys.values())),)),
        )
    )


def _change_request(numbers: Numbers) -> Symbol:
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
    measured = [Sequel(OneOf((name,)), (_value(name, numbers),)) for name in MEASURED if name != "slope"]
    value = _value("slope", numbers)
    way = Sequel(OneOf(WAYS), (_open(value),))
    shape = InOrder((OneOf(tuple(kind for kind in KINDS if kind not in NOUNS)), OneOf(SHARPNESS)), least=1)
    return AnyOf(
        (
            *measured,
            Sequel(OneOf(("slope",)), (AnyOf((way, value)),)),
            Sequel(OneOf(("side",)), (OneOf((*SIDES, "other")),)),
            Sequel(OneOf(("shape",)), (shape,)),
            OneOf(ALONE),
        )
    )


def _open(symbol: Symbol) -> Symbol:
    return InOrder((symbol,))


def _value(name: str, numbers: Numbers) -> Symbol:
    """Returns the forms of a value: an exact number, a bound, a difference, a factor, or "more" or "less"."""
    found = OneOf(numbers.of(name))
    some, percents = bool(found.tokens), OneOf(numbers.percents())
    exact = [Sequel(OneOf((sign,)), (found,)) for sign in ("=", "..", "+", "-")] if some else []
    shares = [Sequel(OneOf(tuple(PERCENTS)), (percents,))] if percents.tokens else []
    factor = Sequel(OneOf(("x",)), (OneOf((*FACTORS, *numbers.percents())),))
    doses = Sequel(OneOf(("slightly", "much")), (OneOf(("more", "less")),))
    least = [Sequel(found, (OneOf(("..",)),))] if some else []
    return AnyOf((*exact, *shares, factor, doses, OneOf(("more", "less")), *least))


def _new(numbers: Numbers) -> Symbol:
    parts: tuple[Symbol, ...] = (
        Sequel(OneOf(("x",)), (OneOf(COUNTS[1:]),)),
        *(OneOf(words) for words in (SIDES, SHARPNESS, WAYS)),
        *(_exactly(key, numbers) for key in ("deg=", "len=", "r=", "pct=")),
        OneOf(("whole",)),
        _position(_place(numbers, DEEPEST - 1), NEXT_TO),
    )
    return Sequel(OneOf(KINDS), (InOrder(parts),))
