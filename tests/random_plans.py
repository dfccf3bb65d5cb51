"""Plans that the automaton of the reader allows, drawn at random."""

from collections.abc import Sequence

import numpy as np

from roadgpt.brief.readers.model.grammar import END, PlanAutomaton, change_request
from roadgpt.brief.readers.model.slots import NumberSlot
from roadgpt.brief.readers.model.vocabulary import NUMBER_OF, TOKENS, plan_of


def random_plan(seed: int, values: Sequence[float], is_change: bool = False, most: int = 70) -> str:
    """A plan with these numbers; empty if it does not end within ``most`` tokens."""
    rng = np.random.default_rng(seed)
    units = ("metres", "percent", "degrees", "")
    slots = [NumberSlot(value, units[index % 4]) for index, value in enumerate(values)]  # type: ignore[arg-type]
    writer = PlanAutomaton(slots, frozenset({"3", "15"}), whole=change_request if is_change else None)
    tokens: list[str] = []
    while len(tokens) < most:
        may = writer.allowed()
        ends = NUMBER_OF[END] in may and rng.random() < 0.3
        word = END if ends else TOKENS[int(rng.choice(may))]
        if word == END:
            return plan_of(tokens, slots)
        tokens.append(word)
        writer.push(word)
    return ""
