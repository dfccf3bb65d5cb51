"""Composes English descriptions whose turns are numbered, repeated, separated by straights, or counted
separately for left and right. Also composes lists of turns, in five languages.

The grammars of ``learn.generator`` describe a road feature by feature. Here, one sentence refers to many
features at once ("six bends, 30 m of straight between any two", "turns 2 and 4 go left, the others right"),
so the reader of the sentence has to count. Such descriptions teach a network to count.
"""

from collections.abc import Callable
from itertools import accumulate

import numpy as np

from roadgpt.brief.feasible import check
from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.errors import BriefError
from roadgpt_training.compositions.counted import by_parts, numbered_kinds, numbered_sides, ranged, sided_sum
from roadgpt_training.compositions.in_a_row import (
    corrected,
    lettered,
    nothing_more,
    out_of_order,
    repeated,
    spaced_turns,
)
from roadgpt_training.compositions.limits import limited, with_limits
from roadgpt_training.compositions.listed import listed
from roadgpt_training.compositions.voice import Composition, Voice
from roadgpt_training.noise import noisy, tidy
from roadgpt_training.pair import Pair, is_held_out, standard
from roadgpt_training.phrasebook import weighted

MAP_SIZE = 750.0  # metres: eight turns and their straights need not fit on the usual map
WAYS: tuple[tuple[Callable[[Voice], Composition], float], ...] = (
    (spaced_turns, 0.16),
    (numbered_sides, 0.13),
    (numbered_kinds, 0.13),
    (by_parts, 0.10),
    (repeated, 0.11),
    (lettered, 0.05),
    (sided_sum, 0.07),
    (ranged, 0.04),
    (limited, 0.10),
    (corrected, 0.03),
    (nothing_more, 0.03),
    (out_of_order, 0.05),
    (listed, 0.33),
)
SEVERAL = 2
WITH_LIMITS = 0.4
"""The share of descriptions, from 0 to 1, to which limits for the whole road are added."""
SHARES = tuple(accumulate(share for _, share in WAYS))


def composed(rng: np.random.Generator, language: str = "en") -> Pair | None:
    """Returns a random description and its plan in standard form; None if the described road is impossible,
    or the description is held out. In languages other than English ("en"), it is a list of turns.
    """
    way = WAYS[weighted(SHARES, rng)][0]
    way = way if language == "en" else listed
    voice = Voice(rng, language)
    said = way(voice)
    if way not in (limited, listed) and voice.chance(WITH_LIMITS):
        said = with_limits(voice, said)
    try:
        brief = read_plan(said.plan)
        check(brief, MAP_SIZE)
    except BriefError:
        return None
    text = noisy(tidy(said.text, language), language, rng)
    return None if is_held_out(text) else Pair(text, _written(brief), f"composed-{language}", language)


def _written(brief: Brief) -> str:
    """Returns the plan in standard form. If several clauses turn, degrees and radii that were required of all
    turns stay after the ``|``.
    """
    if len([clause for clause in brief.clauses if clause.kind != "straight"]) < SEVERAL:
        return standard(brief)
    rest = normal(brief.model_copy(update={"degrees": None, "radius": None}))
    return plan(rest.model_copy(update={"degrees": brief.degrees, "radius": brief.radius}))
