"""Writes messages that say which requirement no road can meet, and what to ask for instead.

A road length or a map size is suggested only after a road has been drafted with it."""

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from math import ceil, floor, inf, log10
from typing import Any

from roadgpt.brief import NoRoomError
from roadgpt.brief.map_fit import ROUND_MAP, metres_of
from roadgpt.brief.model import Amount, Brief
from roadgpt.brief.outline import Outline
from roadgpt.brief.words import LARGEST_MAP, ROAD
from roadgpt.check.rules.too_abrupt import MOST
from roadgpt.design.heights import TOO_ABRUPT
from roadgpt.road import World

OF_THE_PLAN = ("too large", "over itself", "longer than was asked for", "like an earlier road")
FOR_ROOM = ("too large", "over itself")
"""Reasons why drafts fail that may disappear on a larger map."""
MANY = 60  # if this many drafts fitted on the map but failed, the map was large enough
SIDES = 7.0  # ratio of road length to map side; no longer road was ever drafted, so the search starts here
SHORTER = 0.8  # ratio of each length tried to the one before
HALVINGS = 2  # of the range between the last length that failed and the first that did not
SURE = 0.92  # share of the longest drafted length that is offered
LIKELY = 0.4  # ratio of the side of a map to the length of a winding road that may fit on it
LARGER = 1.3  # ratio of each map size tried to the one before
FIRST_SIZES = 2  # map sizes that are tried before the largest, on which an open count of turns may not fit
FEWEST_METRES = 30.0

Trial = Callable[[Brief, World], Any]
"""A function that drafts a road for a Brief with each of several seeds and returns the first search that
failed; None if all found one. Its ``boxes`` are the sides in metres of squares around too large drafts."""


def advice(
    brief: Brief, outline: Outline, world: World, failed: Counter[str], boxes: Sequence[float], trial: Trial
) -> str:
    """Returns one sentence that says which requirement could not be met, and what to do. ``failed`` counts
    the reasons why drafts failed. ``boxes`` are the sides in metres of the smallest squares around the drafts
    that were too large for the map."""
    reason = main_reason(failed)
    if reason in FOR_ROOM:
        found = _offer(brief, world, trial, roomier(world, boxes))
        crossing = " without crossing" if reason == "over itself" else ""
        return f"{_wishes_of(outline)} not fit on a {world.site.map_size:g} m map{crossing}; {found}"
    if reason == "longer than was asked for":
        wishes = _wishes_of(replace(outline, length=None))
        return f"{wishes} not fit into a road of {outline.length} m; ask for a longer road or for fewer turns"
    if reason == "like an earlier road":
        return "every further road is like an earlier one; ask for fewer roads or leave more open"
    if reason == TOO_ABRUPT and outline.speed:
        return (
            f"the slopes that were asked for change too fast for {outline.speed.kmh:g} km/h: crests and dips "
            f"need radii of {outline.speed.vertical_radius:.0f} m or more; ask for gentler or longer slopes, "
            "or for a lower speed"
        )
    if reason == TOO_ABRUPT:
        return too_fast(world, None)
    larger = " or use a larger --map-size" if world.site.map_size < LARGEST_MAP else ""
    return f"no road could keep every wish ({reason}); leave one of them open{larger}"


def too_fast(world: World, slower: float | None) -> str:
    """Returns the message that crests and dips would be too abrupt for the speed limit. ``slower`` is a limit
    in km/h at which the road is possible; None if none is known."""
    limit = f"a speed limit of {3.6 * world.limits.speed_limit:.3g} km/h"
    less = f"use --speed-limit {slower:g}" if slower else "use a lower --speed-limit"
    return (
        f"the slopes that were asked for change too fast for {limit}: the crests and dips between them would "
        f"lift or press the car by more than {MOST:g} m/s2; ask for gentler or longer slopes, or {less}"
    )


def main_reason(failed: Counter[str]) -> str:
    """Returns the reason why most drafts failed; "too large" if ``failed``, which counts them, is empty.
    Reasons in ``OF_THE_PLAN``, such as "too large", do not count if at least 60 drafts failed for other
    reasons."""
    broken = Counter({reason: count for reason, count in failed.items() if reason not in OF_THE_PLAN})
    fitted = broken.total() >= MANY
    return (broken if fitted else failed or Counter(["too large"])).most_common(1)[0][0]


def _wishes_of(outline: Outline) -> str:
    parts = [group.counted for group in outline.groups if group.feature.kind == "turn"]
    if not parts and 1 < outline.turns.lo < inf:
        parts = [f"{outline.turns} turns"]
    parts += [ROAD["length"].asked.format(outline.length)] if outline.length and outline.length.lo > 0 else []
    parts += [ROAD["climb"].asked.format(outline.climb)] if outline.climb else []
    if not parts:
        parts = ["the straights that were asked for" if outline.groups else "a road of this kind"]
    single = len(parts) == 1 and parts[0].startswith(("1 ", "a ")) and not parts[0].endswith("s")
    listed = ", ".join(parts[:-1]) + (" and " if len(parts) > 1 else "") + parts[-1]
    return f"{listed} {'does' if single else 'do'}"


def roomier(world: World, boxes: Sequence[float]) -> float:
    """Returns the side in metres of a map that may be large enough: at least 1.2 times as wide as the present
    one, and large enough for a quarter of the drafts with these ``boxes``."""
    needed = sorted(boxes)[len(boxes) // 4] + world.section.road_width if boxes else 0.0
    return max(needed, 1.2 * world.site.map_size)


@lru_cache(maxsize=64)
def _offer(brief: Brief, world: World, trial: Trial, likely: float) -> str:
    """Returns advice for a Brief that does not fit on the map, as the end of a sentence. ``likely`` is the
    side in metres of a map that may be large enough."""
    larger = larger_map(brief, world, trial, likely)
    less = f"ask for {_less(brief, world, trial) or 'less'}"
    return f"{less} or use --map-size {larger:g}" if larger else less


def no_room(error: NoRoomError, world: World, trial: Trial) -> str:
    """Returns the message for a road that does not fit on the map. If it suggests a length or a map size, a
    road was drafted with it. The result is the message of ``error`` if no length of the road or of a straight
    is required, or if the road must have no turns. ``trial`` is ``road_search.failed_trial``."""
    brief = error.brief
    if _asked(brief) is None or (brief.turns and brief.turns.hi == 0):
        return str(error)  # of a straight road, the longest is known
    metres = metres_of(brief, world.limits.min_radius)
    found = _offer(brief, world, trial, LIKELY * metres)
    room = f"a map of {world.site.map_size:g} m has no room for"
    if brief.length is None:
        return f"{room} a straight of {_asked(brief):g} m and what else is asked for; {found}"
    return f"{room} {metres:.0f} m of such road; {found}"


def _less(brief: Brief, world: World, trial: Trial) -> str | None:
    """Returns, as text, the greatest length of the road that could be drafted or, if its length is open, that
    of its longest straight; None if none could."""
    asked = _asked(brief)
    if asked is None:
        return None
    failed, share = 1.0, min(1.0, SIDES * world.site.map_size / asked) * SHORTER
    while trial(_scaled(brief, share), world) is not None:
        failed, share = share, SHORTER * share
        if asked * share < FEWEST_METRES:
            return None
    for _ in range(HALVINGS):
        middle = (share + failed) / 2
        share, failed = (middle, failed) if trial(_scaled(brief, middle), world) is None else (share, middle)
    metres = _round(SURE * asked * share)
    while trial(_scaled(brief, metres / asked), world) is not None:
        metres = _round(SHORTER * metres)
        if metres < FEWEST_METRES:
            return None
    return f"{metres:g} m" if brief.length else f"a straight of {metres:g} m"


def larger_map(brief: Brief, world: World, trial: Trial, likely: float) -> float | None:
    """Returns the side in metres of a larger map on which roads can be drafted; None if none was found. The
    first size to be tried is ``likely``."""
    largest = world.changed(map_size=LARGEST_MAP)
    size, tried = max(likely, world.site.map_size + ROUND_MAP), 0
    while world.site.map_size < LARGEST_MAP and likely <= 2 * LARGEST_MAP:
        size = min(ceil(size / ROUND_MAP) * ROUND_MAP, LARGEST_MAP)
        larger = world.changed(map_size=size)
        failed = trial(brief, larger)
        if failed is None:
            return size
        tried += 1
        if size == LARGEST_MAP or (tried == FIRST_SIZES and trial(brief, largest) is not None):
            break  # no larger map would help either
        size = max(LARGER * size, roomier(larger, failed.boxes))
    return None


def _round(metres: float) -> float:
    """Returns metres rounded down to whole metres, or to two significant digits from 100 m on."""
    step = 10.0 ** max(floor(log10(metres)) - 1, 0)
    return floor(metres / step) * step


def _asked(brief: Brief) -> float | None:
    """Returns the required length of the road in metres; if it is open, that of the longest straight, if
    any."""
    if brief.length:
        return brief.length.lo or brief.length.hi
    lengths = [c.length.lo for c in brief.clauses if c.kind == "straight" and c.length and c.length.lo]
    return max(lengths, default=None)


def _scaled(brief: Brief, share: float) -> Brief:
    if brief.length:
        return brief.model_copy(update={"length": _times(brief.length, share)})
    clauses = list(brief.clauses)
    for n, clause in enumerate(clauses):
        if clause.kind == "straight" and clause.length is not None:
            clauses[n] = clause.model_copy(update={"length": _times(clause.length, share)})
    return brief.model_copy(update={"clauses": tuple(clauses)})


def _times(amount: Amount, share: float) -> Amount:
    lo, hi = (None if bound is None else share * bound for bound in (amount.lo, amount.hi))
    return Amount(lo=lo, hi=hi)
