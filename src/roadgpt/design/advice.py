"""What to tell someone whose wishes no road on the map can keep."""

from collections import Counter
from collections.abc import Sequence
from math import inf

from roadgpt.brief.model import Brief
from roadgpt.brief.outline import Outline
from roadgpt.check.rules.too_abrupt import MOST
from roadgpt.design.offers import Fits, offer
from roadgpt.road import World

OF_THE_PLAN = ("too large", "over itself", "longer than was asked for", "like an earlier road")
TOO_ABRUPT = "slopes that change too fast for the speed"
MANY = 60  # drafts that fitted on the map and broke a promise: then the map was not what stood in the way


def advice(
    brief: Brief, outline: Outline, world: World, failed: Counter[str], boxes: Sequence[float], fits: Fits
) -> str:
    """Returns one sentence that says which requirement could not be met, and what to do.

    Args:
        brief: what was asked for.
        outline: the same as ranges.
        world: the map.
        failed: why drafts were given up, and how often.
        boxes: sides in metres of the smallest square around each draft that was too large for the map.
        fits: tries whether roads of another length, or on another map, can be drafted.
    """
    broken = Counter({reason: count for reason, count in failed.items() if reason not in OF_THE_PLAN})
    fitted = broken.total() >= MANY
    reason = (broken if fitted else failed or Counter(["too large"])).most_common(1)[0][0]
    wishes = wishes_of(outline)
    if reason in ("too large", "over itself"):
        found = offer(brief, world, fits, _roomier(world, boxes))
        where = f"on a {world.map_size:g} m map" + (" without crossing" if reason == "over itself" else "")
        return f"{wishes} not fit {where}; {found.sentence}"
    if reason == "longer than was asked for":
        return f"{wishes} not fit into a road of {outline.length} m; ask for a longer road or for fewer turns"
    if reason == "like an earlier road":
        return "every further road is like an earlier one; ask for fewer roads or leave more open"
    if reason == TOO_ABRUPT:
        return too_fast(world, None)
    return f"no road could keep every wish ({reason}); leave one of them open or use a larger --map-size"


def too_fast(world: World, slower: float | None) -> str:
    """Returns one sentence that says that crests and dips would be too abrupt for the speed limit.

    Args:
        world: its speed limit.
        slower: km/h, at which they can be had, where that is known.
    """
    limit = f"a speed limit of {3.6 * world.speed_limit:.3g} km/h"
    less = f"use --speed-limit {slower:g}" if slower else "use a lower --speed-limit"
    return (
        f"the slopes that were asked for change too fast for {limit}: the crests and dips between them would "
        f"lift or press the car by more than {MOST:g} m/s2; ask for gentler or longer slopes, or {less}"
    )


def wishes_of(outline: Outline) -> str:
    """Returns what was asked for, as the start of a sentence that goes on with 'not fit'."""
    parts = [
        _counted(group.lo, group.feature.name) for group in outline.groups if group.feature.kind == "turn"
    ]
    if not parts and 1 < outline.turns.lo < inf:
        parts = [_counted(int(outline.turns.lo), "turn")]
    if outline.length and outline.length.lo > 0:
        parts.append(f"a length of {outline.length} m")
    if outline.climb:
        parts.append(f"a climb of {outline.climb} m")
    if not parts:
        parts = ["the straights that were asked for" if outline.groups else "a road of this kind"]
    single = len(parts) == 1 and (parts[0].startswith(("1 ", "a ")))
    listed = ", ".join(parts[:-1]) + (" and " if len(parts) > 1 else "") + parts[-1]
    return f"{listed} {'does' if single else 'do'}"


def _counted(number: int, what: str) -> str:
    return f"{number} {what}" + ("s" if number != 1 else "")


def _roomier(world: World, boxes: Sequence[float]) -> float:
    """Side in metres of a map on which most of the drafts that were too large would have fitted."""
    needed = sorted(boxes)[len(boxes) // 4] + world.road_width if boxes else 0.0
    return max(needed, 1.2 * world.map_size)
