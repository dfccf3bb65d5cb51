"""Candidates that change slopes, the preferred one first."""

from collections.abc import Sequence
from dataclasses import dataclass

from roadgpt.check.measures import Measures, way
from roadgpt.design.edit.request import Change
from roadgpt.design.edit.steps import Adjust, Aims, EditStep, Goal, with_incline
from roadgpt.design.road_elements import RoadElement, RoadElements
from roadgpt.errors import EditError
from roadgpt.road import World

STEEPER = ((1.5, 2.0), (1.3, 1.2), (1.7, 2.5), (1.15, 0.7))
FLATTER = (0.5, 0.6, 0.4, 0.75)
UPHILL = ((5.0, 3.0, 12.0), (4.0, 3.0, 12.0), (6.5, 3.0, 12.0), (5.0, 1.3, 13.0))
LEVEL, CLEARLY_LEVEL = 1.0, 0.8  # percent
STEEP_FROM = 4.0  # percent: what a level place becomes that is to be steeper


@dataclass(frozen=True, slots=True)
class SlopeOfAll:
    """Changes the slopes of many elements: each incline is multiplied, increased and then clipped."""

    names: frozenset[str]
    times: float = 1.0
    more: float = 0.0
    low: float = -100.0
    high: float = 100.0
    way: int = 0
    """1 or -1 makes every slope one uphill or downhill first."""

    @property
    def goals(self) -> tuple[Goal, ...]:
        """None, because inclines of many segments measure as they are written."""
        return ()

    def apply(self, elements: RoadElements, aims: Aims, world: World) -> RoadElements:
        """Returns the elements with each segment's incline changed by itself."""
        limit = 100 * world.max_grade - 0.2

        def one(incline: float) -> float:
            if self.way:
                incline = self.way * abs(incline)
            by = self.more if incline >= 0 else -self.more
            incline = incline * self.times + by
            if self.way:
                incline = self.way * min(max(abs(incline), self.low), self.high)
            else:
                incline = min(max(incline, self.low), self.high)
            return min(max(incline, -limit), limit)

        return tuple(
            b.with_segments(with_incline(s, one(s.incline)) for s in b.segments)
            if b.name in self.names
            else b
            for b in elements
        )


def slope_candidates(change: Change, element: RoadElement, found: Measures, world: World) -> list[EditStep]:
    """Returns the steps that give one turn or straight another grade, the preferred one first."""
    now = element.seen.grade if element.seen else element.incline
    limit = 100 * world.max_grade
    sign = {"up": 1, "down": -1}.get(change.way or "", 0) or (
        1 if now >= LEVEL else -1 if now <= -LEVEL else 0
    )
    sign = sign or (-1 if found.grade <= -LEVEL else 1)
    if change.to is not None and abs(change.to) > limit:
        raise EditError(f"{change.to:g} % is steeper than the {limit:g} % that the rules allow; ask for less")
    if change.to is not None and change.way != "flat":
        aim = sign * change.to
        return [Adjust(element, grade=(aim, aim - slack, aim + slack)) for slack in (0.5, 0.9)]
    if change.by is not None:
        aim = sign * max(abs(now) + (change.more or 1) * change.by, 0.0)
        if abs(aim) > limit:
            raise EditError(
                f"{abs(aim):.1f} % is steeper than the {limit:g} % that the rules allow; ask for less"
            )
        return [Adjust(element, grade=(aim, aim - slack, aim + slack)) for slack in (0.5, 0.9)]
    if change.times is not None:
        aim = now * change.times
        return [Adjust(element, grade=(aim, aim - slack, aim + slack)) for slack in (0.5, 0.9)]
    if change.way == "flat":
        if abs(now) < CLEARLY_LEVEL and all(abs(s.incline) < LEVEL for s in element.segments):
            return []
        return [Adjust(element, grade=(0.0, -slack, slack)) for slack in (0.5, CLEARLY_LEVEL)]
    if change.way and not change.more:
        if way(now) == change.way:
            return []
        return [Adjust(element, grade=(sign * a, sign * low, sign * high)) for a, low, high in UPHILL]
    if change.more > 0 and change.way and way(now) != change.way:
        return [Adjust(element, grade=(sign * 6.0, sign * 3.0, sign * 12.0))]
    return _steeper(change, element, now, sign, limit)


def _steeper(change: Change, element: RoadElement, now: float, sign: int, limit: float) -> list[EditStep]:
    if change.more < 0:
        if abs(now) < LEVEL:
            return []
        return [
            Adjust(element, grade=(now * share, now * (share - 0.3), now * min(share + 0.15, 0.9)))
            for share in FLATTER
        ]
    out: list[EditStep] = []
    for times, more in STEEPER:
        aim = max(abs(now) * (1 + (times - 1) * change.dose), abs(now) + more * change.dose)
        aim = min(aim if abs(now) >= LEVEL else STEEP_FROM * times / 1.5, limit - 0.3)
        if aim > abs(now) + 0.4:
            low, high = min(abs(now) + 0.4, aim - 0.2), min(aim + 1.5, limit)
            out.append(Adjust(element, grade=(sign * aim, sign * low, sign * high)))
    if not out:
        raise EditError(f"it is as steep as the rules allow there: {now:.1f} % of {limit:g} %")
    return out


def road_slope_candidates(
    change: Change, elements: Sequence[RoadElement], found: Measures, world: World
) -> tuple[tuple[EditStep, ...], ...]:
    """Returns the candidates that give many elements other grades, the preferred one first."""
    names = frozenset(element.name for element in elements)
    limit = 100 * world.max_grade - 0.3
    sign = {"up": 1, "down": -1}.get(change.way or "", 0)
    if change.to is not None and change.to > limit + 0.3:
        raise EditError(
            f"{change.to:g} % is steeper than the {limit + 0.3:g} % that the rules allow; ask for less"
        )
    if change.way == "flat" or change.to == 0:
        return ((SlopeOfAll(names, times=0.0),),)
    if change.to is not None:
        sign = sign or (-1 if found.grade < 0 else 1)
        return ((SlopeOfAll(names, way=sign, low=change.to, high=change.to),),)
    if change.by is not None:
        return ((SlopeOfAll(names, more=(change.more or 1) * change.by),),)
    if change.times is not None:
        return ((SlopeOfAll(names, times=change.times),),)
    if sign and not change.more:
        inclines = [s.incline * sign for element in elements for s in element.segments]
        if inclines and min(inclines) >= 1.5:
            return ()
        return tuple((SlopeOfAll(names, way=sign, low=low, high=12.0),) for low in (4.0, 3.0))
    if change.more < 0:
        return tuple((SlopeOfAll(names, times=share),) for share in FLATTER)
    if all(abs(s.incline) < LEVEL for element in elements for s in element.segments):
        return ((SlopeOfAll(names, way=sign or 1, low=STEEP_FROM),),)
    return tuple(
        (SlopeOfAll(names, times=1 + (times - 1) * change.dose, low=-limit, high=limit),)
        for times, _ in STEEPER
    )


def bounded_slope_candidates(
    change: Change, elements: Sequence[RoadElement]
) -> tuple[tuple[EditStep, ...], ...]:
    """Returns the candidates that bring slopes within the bound of a change."""
    assert change.to is not None
    names = frozenset(element.name for element in elements)
    if change.bound < 0:
        return ((SlopeOfAll(names, low=-change.to, high=change.to),),)
    up = sum(element.incline * element.length for element in elements) >= 0
    return ((SlopeOfAll(names, way=1 if up else -1, low=change.to),),)
