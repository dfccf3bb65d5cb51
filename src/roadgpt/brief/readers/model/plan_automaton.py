"""Defines the grammar of plans for constrained decoding: the model can only write plans that can be read.

Modifiers have the fixed order in which ``brief.plan`` prints them. A measured number is either a slot
of the text with a suitable unit, or a number that a word implies ("right angle": 90).
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

from roadgpt.brief.beside import BESIDE
from roadgpt.brief.junctions import LONGEST_ROUTE, ROUTE
from roadgpt.brief.plan import HALFWAY, ONE_WAY, ROAD_KEYS
from roadgpt.brief.readers.model.plan_numbers import Evidence, Numbers
from roadgpt.brief.readers.model.slots import NumberSlot
from roadgpt.brief.readers.model.token_grammar import (
    Stack,
    Symbol,
    allowed,
    any_of,
    in_order,
    later,
    list_tail,
    one_of,
    pushed,
    sequel,
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
    ROUNDABOUT,
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
        if is_change:
            from roadgpt.brief.readers.model.change_grammar import change_request  # only for changes

            whole = change_request(numbers)
        else:
            whole = _description(numbers)
        self._stack: Stack = (any_of(*_refusals(), whole), one_of(END))

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


def _description(numbers: Numbers) -> Symbol:
    clause = _clause(numbers)
    wishes = in_order(
        one_of(*SHARPNESS),
        one_of(*SLOPES),
        *map(one_of, ("alternating", "alike", "hard", "motorway", "divided", "left_hand")),
        *(_road_key(key, numbers) for key in ROAD_KEYS),
        *(sequel(one_of(place), clause, one_of(")")) for place in PLACES),
        _beside(),
        sequel(one_of("centre="), one_of(*CENTRES)),
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
    """Returns a key and its amount, or the word that stands for an amount."""
    keyed = numbers.keyed(f"{key}=", is_signed=key == "climb")
    return any_of(one_of(IN_WORDS[key]), keyed) if key in IN_WORDS else keyed


def _route(road: Symbol, numbers: Numbers) -> Symbol:
    """Returns the two forms of a road or a route: it begins with a road, or with a junction."""
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
    """Returns what a plan may say of a whole route or map."""
    wishes = in_order(one_of("left_hand"), numbers.keyed("len="), _beside(), least=1)
    return sequel(one_of("||"), wishes, is_open=True)


def _junction(numbers: Numbers) -> Symbol:
    """Returns the grammar of a junction, a merge, an exit or a lane change in a plan."""
    side, length = sequel(one_of("side="), one_of(*SIDES)), numbers.keyed("len=")
    takes, controls = one_of(*SIDES, *TAKES), one_of(*CONTROLS)
    flags = [one_of(flag) for flag in (*FLAGS, *NEWER_FLAGS)]
    listed = one_of(*LISTED_WAYS, *SIDES, "straight")
    ways, only_in, only_out = (sequel(one_of(key), listed) for key in ("ways=", "in=", "out="))
    degrees, angle, taper = map(numbers.keyed, ("deg=", "angle=", "taper="))
    exit_, arms, lanes = map(numbers.keyed, ("exit=", "arms=", "lanes="))
    radius = any_of(numbers.keyed("r="), numbers.keyed("d="))
    forms: tuple[tuple[Sequence[str], tuple[Symbol, ...]], ...] = (
        (JUNCTIONS, (takes, controls, *flags, ways, only_in, only_out, degrees, angle, arms)),
        ([ROUNDABOUT], (takes, one_of(*RING_SIZES), controls, *flags[1:], ways, exit_, arms, radius, lanes)),
        (RAMPS, (one_of("ramp", "main"), side, length, taper)),
        (LANE_KINDS, (side, length)),
        (["lane_change"], (one_of(*SIDES),)),
    )
    return any_of(*(sequel(one_of(*kinds), in_order(*parts)) for kinds, parts in forms))


def _map(numbers: Numbers) -> Symbol:
    kinds, count, controls = one_of(*JUNCTIONS, ROUNDABOUT), numbers.keyed("x"), one_of(*CONTROLS)
    route = sequel(one_of(f"{ROUTE}="), _ways(LONGEST_ROUTE))
    tail = in_order(*map(numbers.keyed, ("len=", "blocks=", "dead_ends=")), controls, route)
    kind = sequel(kinds, in_order(count, controls))
    listed = sequel(kind, list_tail(";", kind, MOST_KINDS - 1), tail)
    signed = sequel(kinds, in_order(count), controls)
    grid = sequel(numbers.keyed("columns="), numbers.keyed("rows="), tail, list_tail(";", signed, MOST_KINDS))
    return sequel(one_of("map"), any_of(listed, grid), _whole(numbers))


def _ways(most: int) -> Symbol:
    """Returns one to ``most`` ways of a route through a map."""
    more = later(lambda: _ways(most - 1), may_be_empty=True)
    return sequel(one_of(*SIDES, "straight") if most else one_of(), more)


def _clause(numbers: Numbers) -> Symbol:
    turning = (kind for kind in KINDS if kind not in STRAIGHT_KINDS)
    count, keys = numbers.keyed("x"), {key: numbers.keyed(key) for key in (*CLAUSE_KEYS, "climb=")}
    straight = (count, one_of(*SIZES), one_of(*SLOPES), keys["len="], keys["pct="], keys["climb="])
    words = (one_of(*SIDES), one_of(*SHARPNESS), one_of(*SLOPES), one_of("alternating"))
    return any_of(
        sequel(one_of(*STRAIGHT_KINDS), in_order(*straight)),
        sequel(one_of(*turning), in_order(count, *words, *keys.values())),
    )
