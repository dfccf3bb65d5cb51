"""Lists ways to change lengths: of one turn or straight, or of the road."""

from collections.abc import Sequence

from roadgpt.brief.change.request import Change
from roadgpt.brief.ranges import Range
from roadgpt.brief.words import LEAST_STRAIGHT
from roadgpt.design.edit.steps import (
    WIDEST,
    Adjust,
    EditCandidate,
    EditStep,
    RoadLength,
    Wanted,
)
from roadgpt.design.road_elements import RoadElement
from roadgpt.errors import EditError
from roadgpt.road import World

LONGER, SHORTER = 1.4, 0.65  # shares of a length
ROAD_LONGER, ROAD_SHORTER = 1.3, 0.75  # shares of the length of a road
SEEN = 10.6  # m: the shortest straight that is seen
KEPT = 17.5  # m that remain of each straight when the road is shortened
ROAD_SLACK = 0.02  # of the length of a road


def length_steps(change: Change, element: RoadElement, world: World) -> list[EditStep]:
    """Returns the step that gives one turn or straight another length.

    Raises:
        EditError: the straight would be too short to be seen.
    """
    seen = element.seen
    before = seen.length if seen else element.length
    aim = change.aim(before)
    share = 1 + ((LONGER if change.more > 0 else SHORTER) - 1) * change.dose
    wished = before * share if aim is None else aim
    if element.is_turn:
        assert seen is not None
        tight = world.limits.design_radius
        if seen.radius * wished / before >= tight:
            wanted = Wanted.near(wished, 0.06 * wished) if aim is not None else Wanted.towards(before, wished)
            return [Adjust(element, Wanted.near(seen.degrees, 2.0), None, wanted)]
        share = max(wished / before / (tight / seen.radius), 0.3)  # then it also turns less far
        return [Adjust(element, Wanted.near(seen.degrees * share, 4.0), Wanted.near(tight, 0.12 * tight))]
    if aim is None:
        wished = max(wished, before + 15 if change.more > 0 else 0.0, min(SEEN + 1, before))
        room = Wanted.towards(before, wished).room
        room = Range(max(min(room.lo, wished - 0.5), LEAST_STRAIGHT), max(room.hi, wished + 0.5))
        return [Adjust(element, length=Wanted(wished, room))]
    if wished < SEEN - 0.6:
        raise EditError(
            f"a straight of {max(wished, 0):.0f} m is not seen as one; ask for 10 m or more, or remove it"
        )
    return [Adjust(element, length=Wanted.near(max(wished, SEEN), max(1.0, 0.02 * wished)))]


def road_length_candidates(
    change: Change, elements: Sequence[RoadElement], world: World
) -> tuple[EditCandidate, ...]:
    """Returns candidates that change the road's length by its straights alone, or by its turns as well.

    Raises:
        EditError: the road would be shorter than the rules allow.
    """
    own = sum(element.length for element in elements)
    aim = change.aim(own)
    if aim is None:
        aim = own * (1 + ((ROAD_LONGER if change.more > 0 else ROAD_SHORTER) - 1) * change.dose)
    if aim < world.limits.min_length:
        raise EditError(f"a road of {aim:.0f} m is too short; ask for {world.limits.min_length:g} m or more")
    slack = max(2.0, ROAD_SLACK * aim)
    whole = RoadLength(Range(aim - slack, aim + slack))
    lengths = [(e, e.seen.length) for e in elements if not e.is_turn and e.seen is not None]
    spare = [length if aim > own else max(length - KEPT, 0.0) for _, length in lengths]
    share = (aim - own) / max(sum(spare), 1e-9)
    straights: list[EditStep] = [
        Adjust(element, length=Wanted(length + share * part, Range(SEEN)))
        for (element, length), part in zip(lengths, spare, strict=True)
    ]
    everything: list[EditStep] = [
        Adjust(element, length=Wanted(now, Range(SEEN))) for element, now in lengths
    ]
    for seen, element in ((e.seen, e) for e in elements if e.is_turn):
        assert seen is not None
        radius = Range(min(world.limits.design_radius, seen.radius), max(WIDEST, seen.radius))
        everything.append(Adjust(element, Wanted.near(seen.degrees, 2.0), Wanted(seen.radius, radius)))
    can = sum(spare) and share > -1
    return ((*straights, whole), (*everything, whole)) if can else ((*everything, whole),)
