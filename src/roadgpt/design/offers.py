"""What to ask for instead, where the map has no room: lengths and maps on which roads were drafted."""

from collections.abc import Callable
from functools import lru_cache
from math import ceil, floor, log10
from typing import NamedTuple

from roadgpt.brief import NoRoomError
from roadgpt.brief.map_fit import LARGEST_MAP, ROUND_MAP
from roadgpt.brief.minimum_length import least_length
from roadgpt.brief.model import Amount, Brief, Clause
from roadgpt.road import World

SIDES = 7.0  # of the map: roads so long were never drafted, so the search for the longest begins there
SHORTER = 0.8  # ratio of one length that is tried to the one before
HALVINGS = 2  # between the last length that failed and the first that did not
SURE = 0.92  # of the longest length that was drafted is offered
LIKELY = 0.4  # side of a map over the length of a winding road that it may hold
LARGER = 1.3  # ratio of one map that is tried to the one before
FEWEST_METRES = 30.0

Fits = Callable[[Brief, World], bool]
"""Can roads be drafted, whatever the seed?"""


class Offer(NamedTuple):
    """Requirements that could be met instead; None where nothing was found."""

    less: str | None
    """A smaller wish: '640 m', 'a straight of 300 m'."""
    map_size: float | None
    """Metres of a map on which the wish as it is can be kept."""

    @property
    def sentence(self) -> str:
        """Advice, as the end of a sentence."""
        larger = f"use --map-size {self.map_size:g}" if self.map_size else ""
        less = f"ask for {self.less or 'less'}"
        return f"{less} or {larger}" if larger else less


@lru_cache(maxsize=64)
def offer(brief: Brief, world: World, fits: Fits, likely: float) -> Offer:
    """Returns what can be asked for instead of a Brief that does not fit on the map.

    Args:
        brief: what was asked for.
        world: the map that is too small.
        fits: tries whether roads can be drafted.
        likely: metres along one side of a map that may be large enough.
    """
    return Offer(_less(brief, world, fits), _larger(brief, world, fits, likely))


def no_room(error: NoRoomError, world: World) -> str:
    """Returns the sentence of a refusal whose offer was verified by drafting."""
    from roadgpt.design.designers.planner import fits  # the planner asks for offers, too

    brief = error.brief
    if _asked(brief) is None or (brief.turns and brief.turns.hi == 0):
        return str(error)  # of a straight road, the longest is known
    said = (brief.length.lo or 0.0) if brief.length else 0.0
    metres = max(least_length(brief, world.min_radius), said)
    found = offer(brief, world, fits, LIKELY * metres)
    room = f"a map of {world.map_size:g} m has no room for"
    if brief.length is None:
        return f"{room} a straight of {_asked(brief):g} m and what else is asked for; {found.sentence}"
    return f"{room} {metres:.0f} m of such road; {found.sentence}"


def _less(brief: Brief, world: World, fits: Fits) -> str | None:
    """The longest road, or straight on it, that can be drafted."""
    asked = _asked(brief)
    if asked is None:
        return None
    failed, share = 1.0, min(1.0, SIDES * world.map_size / asked) * SHORTER
    while not fits(_scaled(brief, share), world):
        failed, share = share, SHORTER * share
        if asked * share < FEWEST_METRES:
            return None
    for _ in range(HALVINGS):
        middle = (share + failed) / 2
        share, failed = (middle, failed) if fits(_scaled(brief, middle), world) else (share, middle)
    metres = _round(SURE * asked * share)
    while not fits(_scaled(brief, metres / asked), world):
        metres = _round(SHORTER * metres)
        if metres < FEWEST_METRES:
            return None
    return f"{metres:g} m" if brief.length else f"a straight of {metres:g} m"


def _larger(brief: Brief, world: World, fits: Fits, likely: float) -> float | None:
    if likely > 2 * LARGEST_MAP or world.map_size == LARGEST_MAP:
        return None
    size = min(ceil(max(likely, world.map_size + ROUND_MAP) / ROUND_MAP) * ROUND_MAP, LARGEST_MAP)
    while size < LARGEST_MAP and not fits(brief, world.model_copy(update={"map_size": size})):
        size = ceil(LARGER * size / ROUND_MAP) * ROUND_MAP
    size = min(size, LARGEST_MAP)
    if size == LARGEST_MAP and not fits(brief, world.model_copy(update={"map_size": size})):
        return None
    return size


def _round(metres: float) -> float:
    """Two figures, from 100 m on; else whole metres, never more than given."""
    step = 10.0 ** max(floor(log10(metres)) - 1, 0)
    return floor(metres / step) * step


def _asked(brief: Brief) -> float | None:
    """Metres that were said: of the road, else of its longest straight."""
    if brief.length:
        return brief.length.lo or brief.length.hi
    lengths = [c.length.lo for c in brief.clauses if c.kind == "straight" and c.length and c.length.lo]
    return max(lengths, default=None)


def _scaled(brief: Brief, share: float) -> Brief:
    """The Brief with a shorter road, or with shorter straights where the road's length is open."""
    if brief.length:
        return brief.model_copy(update={"length": _times(brief.length, share)})
    return brief.model_copy(update={"clauses": tuple(_shorter(clause, share) for clause in brief.clauses)})


def _shorter(clause: Clause, share: float) -> Clause:
    if clause.kind != "straight" or clause.length is None:
        return clause
    return clause.model_copy(update={"length": _times(clause.length, share)})


def _times(amount: Amount, share: float) -> Amount:
    lo, hi = (None if bound is None else share * bound for bound in (amount.lo, amount.hi))
    return Amount(lo=lo, hi=hi)
