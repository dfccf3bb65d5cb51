"""Room between turns: how much straight road they need, so that each of them is seen by itself."""

from itertools import pairwise

from roadgpt.brief.model import Side
from roadgpt.design.edit.steps import straight
from roadgpt.design.road_elements import RoadElement, RoadElements

SEPARATE = 18.0  # m between turns of one hand, so that they are seen as two
HIDDEN = 9.0  # m, measured: turns of one hand with so much between them are two, but no straight is seen


def gap(name: str, length: float, incline: float) -> RoadElement:
    """A straight that is new."""
    return RoadElement(name, "gap", (straight(length, incline),))


def with_room(blocks: RoadElements, before: RoadElements) -> RoadElements:
    """Straights between new neighbours of one hand, so that they are not seen as one turn.

    Turns that were neighbours before, on the same sides, are two already.
    """
    known = {_pair(one, other) for one, other in pairwise(b for b in before if b.kind == "turn")}
    out: list[RoadElement] = []
    last: RoadElement | None = None
    metres = 0.0
    for block in blocks:
        if block.kind == "turn":
            is_new = last is not None and last.side == block.side and _pair(last, block) not in known
            if is_new and metres < SEPARATE - 2:
                out.append(gap(f"room before {block.name}", round(SEPARATE - metres, 1), block.incline))
            last, metres = block, 0.0
        else:
            metres += block.length
        out.append(block)
    return tuple(out)


def _pair(one: RoadElement, other: RoadElement) -> tuple[str, Side | None, str, Side | None]:
    return one.name, one.side, other.name, other.side
