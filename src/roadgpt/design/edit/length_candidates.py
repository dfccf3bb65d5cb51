"""Another length of the whole road: its straights first, at its ends alone, or everything alike."""

from collections.abc import Sequence

from roadgpt.check.measures import Measures
from roadgpt.design.edit.request import Change
from roadgpt.design.edit.steps import Adjust, EditStep
from roadgpt.design.elements import least_radius
from roadgpt.design.road_elements import RoadElement
from roadgpt.errors import EditError
from roadgpt.road import World

LONGER, SHORTER = (1.3, 1.2, 1.45, 1.12), (0.75, 0.82, 0.65, 0.9)
KEPT = 17.5  # m of a straight that others are shortened to
SLACK = 0.02  # of the length of a road
WHOLE_ROAD = RoadElement("", "gap", ())  # changes nothing, and is measured


def road_length_candidates(
    change: Change, elements: Sequence[RoadElement], found: Measures, world: World
) -> tuple[tuple[EditStep, ...], ...]:
    """Returns all candidates that give the road another length, the preferred one first.

    Raises:
        EditError: so short a road is none.
    """
    own = sum(b.length for b in elements)
    if change.to is not None:
        lengths = [change.to]
    elif change.by is not None:
        lengths = [own + change.more * change.by]
    elif change.times is not None:
        lengths = [own * change.times]
    else:
        shares = LONGER if change.more > 0 else SHORTER
        lengths = [own * (1 + (share - 1) * change.dose) for share in shares]
    if lengths[0] < world.min_length:
        raise EditError(f"a road of {lengths[0]:.0f} m is too short; ask for {world.min_length:g} m or more")
    out: list[tuple[EditStep, ...]] = []
    for length in lengths:
        slack = max(2.0, SLACK * length)
        out += [
            (*way, Adjust(WHOLE_ROAD, length=length, length_slack=slack))
            for way in _ways(elements, length - own, world)
            if way
        ]
    return tuple(out)


def _ways(elements: Sequence[RoadElement], more: float, world: World) -> list[tuple[EditStep, ...]]:
    gaps = [element for element in elements if element.kind == "gap" and element.seen is not None]
    out = []
    if gaps:
        out.append(_straights(gaps, more))
        if more > 0:
            out += [_straights(gaps[-1:], more), _straights(gaps[:1], more)]
            out += [_straights([gap], more) for gap in gaps[1:-1]]
    out.append(_everything(elements, more, world))
    return out


def _straights(gaps: Sequence[RoadElement], more: float) -> tuple[EditStep, ...]:
    """All of them in proportion; none where they would get too short."""
    lengths = [gap.seen.length if gap.seen else gap.length for gap in gaps]
    if more >= 0:
        return tuple(
            Adjust(gap, length=length + more * length / sum(lengths), length_slack=3.0)
            for gap, length in zip(gaps, lengths, strict=True)
        )
    spare = [max(length - KEPT, 0.0) for length in lengths]
    if sum(spare) < -more:
        return ()
    return tuple(
        Adjust(gap, length=length + more * own / sum(spare), length_slack=3.0)
        for gap, length, own in zip(gaps, lengths, spare, strict=True)
        if own
    )


def _everything(elements: Sequence[RoadElement], more: float, world: World) -> tuple[EditStep, ...]:
    """Turns with other radii, as far as they may, and the rest on straights."""
    turns = [element for element in elements if element.kind == "turn" and element.seen is not None]
    gaps = [element for element in elements if element.kind == "gap" and element.seen is not None]
    share = 1 + more / max(sum(element.length for element in elements), 1.0)
    least = least_radius(world)
    out: list[EditStep] = []
    for turn in turns:
        assert turn.seen is not None
        wider = max(share, least / turn.seen.radius) if share < 1 else share
        if abs(wider - 1) < 0.02 or (share < 1) != (wider < 1):
            continue
        out.append(Adjust(turn, None, turn.seen.radius * wider, slack=(2.0, 0.15)))
        more -= turn.length * (wider - 1)
    if gaps and abs(more) > 1:
        rest = _straights(gaps, more)
        if not rest:
            spare = sum(gap.seen.length - 12.0 for gap in gaps if gap.seen and gap.seen.length > 12)
            share = max(1 + more / max(spare, 1.0), 0.0)
            rest = tuple(
                Adjust(gap, length=12.0 + (gap.seen.length - 12.0) * share, length_slack=3.0)
                for gap in gaps
                if gap.seen and gap.seen.length > 12
            )
        out += rest
    return tuple(out)
