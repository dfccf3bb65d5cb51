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
from roadgpt.design.compose import NEAR_NUMBER, gap_between
from roadgpt.design.draw import ANY_TURN, DraftTask, drawn_turn, hand_of, longest_turn, narrowed_turns
from roadgpt.design.layout import COARSENESS, NEIGHBOURS, SPARE, MapPose, PlacedPlan, PlanLine, walk
from roadgpt.design.sequence import TurnSequence, may_repeat_last_turn
from roadgpt.geometry.curve import Array
from roadgpt.geometry.nearness import Complex, meeting
from roadgpt.road.road import CONTROL_SPACING, MOST_CONTROL_POINTS

TRIED = 14  # candidates for each turn
AHEAD = 45.0  # m straight on from the end of a turn that must be free
COARSE = 3.0  # m between the points that are compared with the border and the road
MOST_TURNS = 400
EXTRA = {"winding": (10.0, 70.0)}  # m by which straights between turns are longer than needed, on average
EXTRA_OF_OTHERS = (30.0, 160.0)
UNEVEN = (0.2, 1.8)  # factors on that average
OFF_TIGHTEST = 1.2  # ratio of the least radius drawn to the least allowed
OFF_BY_SPACING = 1.3  # metres added to the radius for each metre added between points of the spline
BULGE = 0.5  # m by which the walked line may differ from the road that is built
DEAD_ENDS = 30  # after which an attempt is given up
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
    """Returns a road of the required length, drafted turn by turn; None if it found no room on the map.

    Also returns None if no length is required, if there are no turns, or if a sum of all turning angles is
    required.
    """
    asked = task.outline.length
    if asked is None or asked.lo <= 0 or not order.turns or task.outline.turning:
        return None
    near = asked.around(NEAR_NUMBER)
    low, high = near.lo + 1, min(near.hi - 1, 1.3 * near.lo)
    target = low + (high - low) * (0.3 + 0.4 * task.rng.random())
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
        """Returns the whole road; None after too many dead ends.

        If the road cannot be continued, the last turns are removed and others are tried.
        """
        steps: list[tuple[_Way, Element | None]] = [(start, None)]
        for back in range(1, DEAD_ENDS + 1):
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
            del steps[max(1, len(steps) - 1 - int(self.rng.integers(1, 3 + back))) :]
        return None

    def _start(self) -> tuple[complex, complex]:
        border = self.world.section.road_width / 2 + EDGE + 1.0
        x, y = border + self.rng.random(2) * (self.world.site.map_size - 2 * border)
        heading = np.exp(1j * np.radians(self.rng.integers(3600) / 10))
        return complex(round(x, 2), round(y, 2)), complex(heading)

    def _turn(self, at: int, so_far: float) -> tuple[Feature, Sequence[Feature]] | None:
        """Returns the ranges of the next turn and the straights required before it; None after the last."""
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
        """Returns the road with one more turn, and that turn; None if no candidate has room.

        ``before`` is the last turn so far. The next one, number ``at`` from 0, has the ranges ``asked``, and
        the straights ``wishes`` before it.
        """
        hand, degrees = hand_of(asked), asked.degrees or ANY_TURN
        if at >= len(self.order.turns) and before:
            hand = -1 if (before.turn > 0) != self.has_open_sides else 1
        extra = self._extra(way.length, at)
        for number in range(TRIED):
            if self.has_open_sides and number % 2 == 0:
                hand = 1 if self.rng.random() < 0.5 else -1
            elif self.has_open_sides:
                hand = -hand
            haste = number / TRIED
            angle = degrees.lo + self.rng.random() * (degrees.hi - degrees.lo)
            sided = replace(asked, side="left" if hand > 0 else "right")
            turn = drawn_turn(sided, angle, self.longest, self.task._replace(haste=haste))
            gap = gap_between(before, wishes, turn, self.task._replace(haste=0.5 + haste / 2))
            elements = _stretched(gap, extra * (1 - haste) * self.rng.uniform(*UNEVEN))
            line = walk([*elements, turn])
            if self._is_free(way, line, AHEAD):
                return way.with_([*elements, turn], line), turn
        return None

    def _extra(self, so_far: float, at: int) -> float:
        """Returns by how many metres the straight before the next turn may be longer than needed."""
        if self.more and self.outline.turns.lo <= len(self.order.turns):
            return self.extra
        turns = max(len(self.order.turns) - at, 0)
        return max(self.target - so_far - turns * (self.longest / 2 + LEAST_LEFT), 0.0) / (turns + 1)

    def _out(self, way: _Way, before: Element | None) -> _Way | None:
        """Returns the road with its last straight; None if there is no room for it."""
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
        """Returns whether a new part, and ``ahead`` metres straight on from its end, stay on the map and keep
        clear of the road so far.
        """
        every = max(1, round(COARSE / float(line.s[1])))
        s, z = line.s[::every], line.z[::every]
        last = line.z[-1] - line.z[-2]
        on = np.arange(COARSE, ahead, COARSE)
        s = np.concatenate([s, line.s[-1:], line.s[-1] + on]) + way.length
        z = np.concatenate([z, line.z[-1:], line.z[-1] + on * (last / abs(last))])
        z = way.end + way.heading * z
        border = self.world.section.road_width / 2 + EDGE + BULGE
        low, high = border, self.world.site.map_size - border
        if min(z.real.min(), z.imag.min()) < low or max(z.real.max(), z.imag.max()) > high:
            return False
        return not len(meeting(z, s, way.z, way.s, self.apart, NEIGHBOURS)[0])


def _stretched(elements: Sequence[Element], metres: float) -> list[Element]:
    """Returns elements whose first elastic straight is longer; a new straight if there are no elements."""
    out = list(elements)
    for i, element in enumerate(out):
        if element.is_elastic:
            out[i] = element._replace(straight=element.length + metres)
            return out
    return out if out else [Element(metres)] if metres > 1 else []


def _roomy(turn: Feature, metres: float) -> Feature:
    """Returns a turn whose least radius suits the spacing of the spline's points.

    The competition's files hold few points: on a road of 10 km, the spline has one every 20 m.
    """
    if turn.radius is None or turn.radius.hi < inf:
        return turn
    spacing = max(CONTROL_SPACING, metres / MOST_CONTROL_POINTS)
    least = turn.radius.lo * OFF_TIGHTEST + OFF_BY_SPACING * (spacing - CONTROL_SPACING)
    return replace(turn, radius=Range(least))


def _has_open_sides(outline: Outline) -> bool:
    """Returns whether every turn may go to either side."""
    features = [*(g.feature for g in outline.groups), *(e for e in (outline.starts, outline.ends) if e)]
    is_open = outline.left == outline.right == Range() and not outline.alternating
    return is_open and not any(f.side for f in features) and not any(g.alternating for g in outline.groups)
