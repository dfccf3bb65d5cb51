"""What the words of a description rule out whatever the network finds likely.

A network loses count in lists, and then writes a junction too many; it may write a route where the words ask
for a map. If its likeliest plan is ruled out so, it writes once more, within what the words allow.
"""

from collections.abc import Callable, Sequence
from functools import partial
from math import inf
from typing import NamedTuple

from roadgpt.brief.junctions import NAMES
from roadgpt.brief.map_clause import MAP
from roadgpt.brief.readers.model.junction_number import JOINT, kinds_of, number_of, number_said
from roadgpt.brief.readers.model.map_words import asks_for_map
from roadgpt.brief.readers.model.plan_automaton import END
from roadgpt.brief.readers.model.slots import SlottedText
from roadgpt.brief.readers.model.vocabulary import REFUSALS, TOKENS

MISCOUNTED = 4.0
"""How much likelier, in score, a plan must be to be kept if its number of junctions is not the one said."""
NOT_A_MAP = tuple(token for token in TOKENS if token != MAP)

Tokens = Sequence[str]


class Condition(NamedTuple):
    """What the plan of a description must be like."""

    holds: Callable[[Tokens], bool]
    """Whether the tokens of a plan meet it."""
    barred: Callable[[Tokens], Tokens]
    """Returns the tokens that cannot follow the tokens of an unfinished plan."""
    worth: float
    """The score by which a plan that does not meet it must be likelier to be kept."""


def condition_missed(text: SlottedText, plan: Tokens) -> Condition | None:
    """Returns the condition of the words that the tokens of a plan do not meet; None if they meet all."""
    if asks_for_map(text) and plan[0] not in (MAP, *REFUSALS):
        return Condition(lambda tokens: tokens[0] == MAP, lambda tokens: () if tokens else NOT_A_MAP, inf)
    number = number_said(text)
    if number is None or number_of(plan) in (None, number):
        return None
    return Condition(lambda tokens: number_of(tokens) == number, partial(_barred, number), MISCOUNTED)


def _barred(number: int, plan: Tokens) -> Tokens:
    """Returns the tokens that cannot follow if a plan shall have this number of junctions."""
    if len(kinds_of(plan)) < number:
        return (END, MAP, *REFUSALS)
    return tuple(NAMES) if plan[-1] == JOINT else ()
