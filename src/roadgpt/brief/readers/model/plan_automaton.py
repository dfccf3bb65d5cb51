"""Defines the grammar of plans for constrained decoding: the model can only write plans that can be read.

Modifiers have the fixed order in which ``brief.plan`` prints them. A measured number is either a slot
of the text with a suitable unit, or a number that a word implies ("right angle": 90).
"""

from collections.abc import Sequence
from dataclasses import replace

from roadgpt.brief.beside import BESIDE
from roadgpt.brief.halfway import HALFWAY
from roadgpt.brief.map_clause import LONGEST_ROUTE, ROUTE
from roadgpt.brief.plan import ONE_WAY, ROAD_KEYS
from roadgpt.brief.readers.model.evidence import Evidence
from roadgpt.brief.readers.model.plan_numbers import Keyed, Numbers
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
    CENTRES,
    CLAUSE_KEYS,
    CONTROLS,
    FLAGS,
    JUNCTIONS,
    KINDS,
    LANE_KINDS,
    LISTED_WAYS,
    NEWER_FLAGS,
    NUMBER_OF,
    PLACES,
    RAMPS,
    RING_SIZES,
    SHARPNESS,
    SIDES,
    SIZES,
    SLOPES,
    TAKES,
)
from roadgpt.brief.refusal import CLASHING, OF_CAUSES

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
        whole = _change(numbers) if is_change else _description(numbers)
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


def _refusals() -> tuple[Symbol, ...]:
    clashing, beyond = OneOf(tuple(CLASHING), True), OneOf(tuple(OF_CAUSES["!impossible"]), True)
    return (
        OneOf(("!nonsense", "!unclear")),
        Sequel(OneOf(("!contradiction",)), (clashing, clashing)),
        Sequel(OneOf(("!impossible",)), (beyond, beyond)),
    )


def _change(numbers: Numbers) -> Symbol:
    from roadgpt.brief.readers.model.change_grammar import change_request  # only for changes

    return change_request(numbers)


def _description(numbers: Numbers) -> Symbol:
    clause = _clause(numbers)
    placed = [Sequel(OneOf((place,)), (clause, OneOf((")",)))) for place in PLACES]
    flags = (["alternating"], ["alike"], ["hard"], ["motorway"], ["divided"], ["left_hand"])
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
    keyed, word = Keyed(f"{key}=", numbers, is_signed=key == "climb"), IN_WORDS.get(key)
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
    kinds, count = OneOf((*JUNCTIONS, "roundabout")), Keyed("x", numbers)
    keys = tuple(Keyed(key, numbers) for key in ("len=", "blocks=", "dead_ends="))
    tail = InOrder((*keys, OneOf(CONTROLS), Sequel(OneOf((f"{ROUTE}=",)), (_ways(LONGEST_ROUTE),))))
    kind = Sequel(kinds, (InOrder((count, OneOf(CONTROLS))),))
    listed = Sequel(kind, (ListTail(";", kind, MOST_KINDS - 1), tail))
    signed = Sequel(kinds, (InOrder((count,)), OneOf(CONTROLS)))
    grid = Sequel(
        Keyed("columns=", numbers), (Keyed("rows=", numbers), tail, ListTail(";", signed, MOST_KINDS))
    )
    length = Keyed("len=", numbers)
    whole = Sequel(
        OneOf(("||",)), (InOrder((OneOf(("left_hand",)), length, _beside()), least=1),), is_open=True
    )
    return Sequel(OneOf(("map",)), (AnyOf((listed, grid)), whole))


def _ways(most: int) -> Symbol:
    """Returns one to ``most`` ways of a route through a map."""
    more = Later(lambda: _ways(most - 1), may_be_empty=True)
    return Sequel(OneOf((*SIDES, "straight")) if most else OneOf(()), (more,))


def _clause(numbers: Numbers) -> Symbol:
    turning = tuple(kind for kind in KINDS if kind not in STRAIGHT_KINDS)
    count, keys = Keyed("x", numbers), {key: Keyed(key, numbers) for key in (*CLAUSE_KEYS, "climb=")}
    straight = (count, OneOf(SIZES), OneOf(SLOPES), keys["len="], keys["pct="], keys["climb="])
    words = tuple(OneOf(words) for words in (SIDES, SHARPNESS, SLOPES, ["alternating"]))
    return AnyOf(
        (
            Sequel(OneOf(STRAIGHT_KINDS), (InOrder(straight),)),
            Sequel(OneOf(turning), (InOrder((count, *words, *keys.values())),)),
        )
    )
