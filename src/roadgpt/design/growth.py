"""Drafts long roads turn by turn, directly on the map.

If the road is much longer than the side of the map, a draft that is composed as a whole hardly ever fits. A
long road therefore starts at a random place on the map. For every turn, several combinations of side, angle
and preceding straight are tried. The first one that stays on the map, keeps clear of the road so far and
leaves room ahead is used. If the description leaves the number of turns open, a longer road has more turns.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import NamedTuple

import numpy as np

from roadgpt.brief.element import Element, Elements
from roadgpt.brief.map_fit import EDGE
from roadgpt.brief.outline import Feature, Outline
from roadgpt.brief.ranges import Range
from roadgpt.design.compose import (
    ANY_TURN,
    NEAR_NUMBER,
    DraftTask,
    TurnSequence,
    asked_length,
    drawn_turn,
    gap_between,
    hand_of,
    longest_turn,
    may_repeat_last_turn,
    narrowed_turns,
)
from roadgpt.design.layout import (
    COARSENESS,
    SPARE,
    MapPose,
    PlacedPlan,
    PlanLine,
    drawn_headings,
    meets,
    walk,
)
from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Complex
from roadgpt.road.road import CONTROL_SPACING, MOST_CONTROL_POINTS

TRIED = 14  # candidates for each turn
AHEAD, FAR_AHEAD = 45.0, 400.0  # m straight on from the end of a turn that must be free: at least; at most
LATE = 3.0  # haste for each part of the length that the turns to come are too long
COARSE = 3.0  # m between the points that are compared with the border and the road
MOST_TURNS = 400
EXTRA = {"winding": (10.0, 70.0)}  # m by which straights between turns are longer than needed, on average
EXTRA_OF_OTHERS = (30.0, 160.0)
UNEVEN = (0.2, 1.8)  # factors on that average
OFF_TIGHTEST = 1.2  # ratio of the least radius drawn to the least allowed
OF_TIGHT = 0.7  # of the range of a radius with an upper limit: no more is kept off its lower end
OFF_BY_SPACING = 0.6  # metres added to the radius for each metre added between points of the spline
BULGE = 0.5  # m by which the walked line may differ from the road that is built
DEAD_ENDS = 20  # without progress, after which an attempt is given up
LEAST_LEFT = 25.0  # m of road behind the last turn


class _Way(NamedTuple):
    """The road so far: elements, stations and points every 3 m, length, and point and heading at its end."""

    elements: Elements
    s: Array
    z: Complex
    length: float
    end: complex
    heading: complex

    def with_(self, elements: Sequence[Element], line: PlanLine) -> "_Way":
        every = max(1, round(COARSE / float(line.s[1])))
        z = self.end + self.heading * line.z
        degrees = sum(element.turn for element in elements)  # exact, whereas the walk adds up errors
        return _Way(
            (*self.elements, *elements),
            np.concatenate([self.s, self.length + line.s[1::every]]),
            np.concatenate([self.z, z[1::every]]),
            self.length + float(line.s[-1]),
            complex(z[-1]),
            self.heading * complex(np.exp(1j * np.radians(degrees))),
        )


def grown(order: TurnSequence, task: DraftTask) -> PlacedPlan | None:
    """Returns a road of the required length, drafted turn by turn; None if it found no room on the map, if
    there are no turns, or if a sum of all turning angles is required."""
    asked = asked_length(task.outline, task.windows) or Range(0.0)
    if not order.turns or task.outline.turning:
        return None
    near = asked.around(NEAR_NUMBER)
    low, high = near.lo + 1, min(near.hi - 1, 1.3 * near.lo)
    target = low + (high - low) * (0.3 + 0.4 * task.rng.random()) if near.lo > 0 else 0.0
    return _Growth(order, task, target, asked).run()


class _Growth:
    """One attempt to draft a long road."""

    def __init__(self, order: TurnSequence, task: DraftTask, target: float, asked: Range) -> None:
        self.order, self.task, self.target, self.asked = order, task, target, asked
        self.outline, self.world, self.rng = task.outline, task.world, task.rng
        self.more = may_repeat_last_turn(self.outline)
        self.has_open_sides = _has_open_sides(self.outline)
        self.turns = [_roomy(turn, target) for turn in narrowed_turns(order.turns, task)]
        self.longest = longest_turn(len(order.turns), task)
        low, high = EXTRA.get(order.turns[-1].name, EXTRA_OF_OTHERS)
        self.extra = low + (high - low) * self.rng.random()
        self.apart = self.world.section.road_width + SPARE + COARSENESS + BULGE

    def run(self) -> PlacedPlan | None:
        start, heading = self._start()
        way = self._grown(_Way((), np.zeros(1), np.array([start]), 0.0, start, heading))
        if way is None or way.length not in self.asked:
            return None
        theta = round(float(np.degrees(np.angle(heading))) % 360, 1) % 360
        place = MapPose(round(start.real, 2), round(start.imag, 2), theta)
        return PlacedPlan(way.elements, walk(way.elements), place)

    def _grown(self, start: _Way) -> _Way | None:
        """Returns the whole road; None after too many dead ends without any progress. If the road cannot be
        continued, the last turns are removed and others are tried; the longer without progress, the more
        turns."""
        steps: list[tuple[_Way, Element | None]] = [(start, None)]
        most, stuck = 0, 0
        while stuck < DEAD_ENDS:
            while (following := self._turn(len(steps) - 1, steps[-1][0].length)) is not None:
                way, before = steps[-1]
                step = self._step(way, before, *following, len(steps) - 1)
                if step is None:
                    break
                steps.append(step)
            else:
                whole = self._out(*steps[-1])
                if whole is not None:
                    return whole
            most, stuck = (len(steps), 0) if len(steps) > most else (most, stuck + 1)
            del steps[max(1, len(steps) - 1 - int(self.rng.integers(1, 4 + stuck))) :]
        return None

    def _start(self) -> tuple[complex, complex]:
        border = self.world.section.road_width / 2 + EDGE + 1.0
        x, y = border + self.rng.random(2) * (self.world.site.map_size - 2 * border)
        heading = np.exp(1j * np.radians(drawn_headings(self.rng, self.outline.heading)[0]))
        return complex(round(x, 2), round(y, 2)), complex(heading)

    def _turn(self, at: int, so_far: float) -> tuple[Feature, Sequence[Feature]] | None:
        named = len(self.order.turns)
        if at < named:
            return self.turns[at], self.order.gaps[at]
        left = self.target - so_far - LEAST_LEFT - self.extra / 2
        if not self.more or at >= min(MOST_TURNS, self.outline.turns.hi) or left < self.longest:
            return None
        return self.turns[-1], ()

    def _step(
        self, way: _Way, before: Element | None, asked: Feature, wishes: Sequence[Feature], at: int
    ) -> tuple[_Way, Element] | None:
        """Returns the road with one more turn, and that turn; None if no candidate has room. ``before`` is
        the last turn so far. The next one, number ``at`` from 0, has the ranges ``asked``, and the straights
        ``wishes`` before it."""
        hand, degrees = hand_of(asked), asked.degrees or ANY_TURN
        if at >= len(self.order.turns) and before:
            hand = -1 if (before.turn > 0) != self.has_open_sides else 1
        extra, least = self._extra(way.length, at)
        for number in range(TRIED):
            if self.has_open_sides and number % 2 == 0:
                hand = 1 if self.rng.random() < 0.5 else -1
            elif self.has_open_sides:
                hand = -hand
            haste = max(number / TRIED, least)
            angle = degrees.lo + (1 - least) * self.rng.random() * (degrees.hi - degrees.lo)
            sided = replace(asked, side="left" if hand > 0 else "right")
            turn = drawn_turn(sided, angle, self.longest, self.task._replace(haste=haste))
            task = self.task._replace(haste=max(haste, 0.5 * (number > 0)))
            gap = gap_between(before, wishes, turn, task, self.order.is_leg(at))
            elements = _stretched(gap, extra * (1 - haste) * self.rng.uniform(*UNEVEN))
            if not self._is_on_map(way.end + way.heading * sum(element.length for element in elements)):
                continue
            line = walk([*elements, turn])
            if self._is_free(way, line, max(AHEAD, min(extra, FAR_AHEAD) * (1 - haste))):
                return way.with_([*elements, turn], line), turn
        return None

    def _extra(self, so_far: float, at: int) -> tuple[float, float]:
        """Returns by how many metres the straight before the next turn may be longer than needed, and the
        least haste, from 0 to 1, with which the required length can still be kept."""
        if self.more and self.outline.turns.hi == inf and self.outline.turns.lo <= len(self.order.turns):
            return self.extra, 0.0
        turns = max(len(self.order.turns) - at, 0)
        needed, left = turns * (self.longest / 2 + LEAST_LEFT), self.target - so_far
        late = 1 - left / needed if needed and self.target else 0.0
        return max(left - needed, 0.0) / (turns + 1), min(max(LATE * late, 0.0), 1.0)

    def _out(self, way: _Way, before: Element | None) -> _Way | None:
        wishes = self.order.gaps[-1]
        elements = gap_between(before, wishes, None, self.task._replace(haste=1.0))
        missing = self.target - way.length - sum(element.length for element in elements)
        for share in (1.0, 0.7, 0.4, 0.0):
            longer = _stretched(elements, share * missing) if missing > 0 else elements
            line = walk(longer)
            if self._is_free(way, line, 0.0):
                return way.with_(longer, line)
        return None

    def _is_free(self, way: _Way, line: PlanLine, ahead: float) -> bool:
        every = max(1, round(COARSE / float(line.s[1])))
        s, z = line.s[::every], line.z[::every]
        last = line.z[-1] - line.z[-2]
        on = np.arange(COARSE, ahead, COARSE)
        s = np.concatenate([s, line.s[-1:], line.s[-1] + on]) + way.length
        z = np.concatenate([z, line.z[-1:], line.z[-1] + on * (last / abs(last))])
        z = way.end + way.heading * z
        return self._is_on_map(z) and not meets(z, s, way.z, way.s, self.apart)

    def _is_on_map(self, z: Complex | complex) -> bool:
        low = self.world.section.road_width / 2 + EDGE + BULGE
        x_and_y = np.array([np.real(z), np.imag(z)])
        return bool(x_and_y.min() >= low and x_and_y.max() <= self.world.site.map_size - low)


def _stretched(elements: Sequence[Element], metres: float) -> list[Element]:
    out = list(elements)
    for i, element in enumerate(out):
        if element.is_elastic:
            out[i] = element._replace(straight=element.length + metres)
            return out
    return out if out else [Element(metres)] if metres > 1 else []


def _roomy(turn: Feature, metres: float) -> Feature:
    if turn.radius is None or turn.radius.number is not None:
        return turn
    spacing = max(CONTROL_SPACING, metres / MOST_CONTROL_POINTS)
    least = turn.radius.lo * OFF_TIGHTEST + OFF_BY_SPACING * (spacing - CONTROL_SPACING)
    low, high = turn.radius.lo, turn.radius.hi
    return replace(turn, radius=Range(max(low, min(least, low + OF_TIGHT * (high - low))), high))


def _has_open_sides(outline: Outline) -> bool:
    features = [*(g.feature for g in outline.groups), *(e for e in (outline.starts, outline.ends) if e)]
    is_open = outline.left == outline.right == Range() and not outline.alternating
    return is_open and not any(f.side for f in features) and not any(g.alternating for g in outline.groups)
