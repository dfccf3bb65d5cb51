"""Long roads, grown piece by piece where there is room: each turn looks for a way that stays on the map.

A plan that is drawn as a whole and then laid on the map hardly ever fits where it is much longer than the map
is wide. So such a road begins somewhere on the map, and of every turn several are tried: sides, angles and
straights before it. One is taken whose way ahead is free of the border and of the road itself. Where the
number of turns is open, a longer road has more of them.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import NamedTuple

import numpy as np

from roadgpt.brief.element import Element, Elements
from roadgpt.brief.map_fit import EDGE
from roadgpt.brief.outline import Feature, Outline
from roadgpt.brief.words import Range
from roadgpt.design.compose import asked_length, gap_between
from roadgpt.design.draw import ANY_TURN, drawn_turn, hand_of, longest_turn, narrowed_turns
from roadgpt.design.heights import Windows
from roadgpt.design.layout import COARSENESS, SPARE, Complex, MapPose, PlacedPlan, PlanLine, meets, walk
from roadgpt.design.sequence import TurnSequence
from roadgpt.geometry.curve import Array
from roadgpt.road import World
from roadgpt.road.road import CONTROL_SPACING, MOST_CONTROL_POINTS

TRIED = 14  # turns, of which the first that leads on is taken
AHEAD = 45.0  # m behind a turn that must be free
COARSE = 3.0  # m between points that are held against the border and the road
MOST_TURNS = 400
EXTRA = {"winding": (10.0, 70.0)}  # m of straight between turns, more than there must be, on average
EXTRA_OF_OTHERS = (30.0, 160.0)
UNEVEN = (0.2, 1.8)  # of that average
OFF_TIGHTEST = 1.2  # ratio of the least radius of a turn to the tightest that is allowed
OFF_BY_SPACING = 1.3  # metres of radius more, for each metre more between points of the road's spline
BULGE = 0.5  # m that the walked line may be off the road that is built
DEAD_ENDS = 30  # of one attempt, before it is given up
LEAST_LEFT = 25.0  # m of road behind the last turn
LONG = 700.0  # m: a shorter road with a few turns fits on the usual map


class _Way(NamedTuple):
    """The road so far: its elements, points every few metres with stations, and where it has come to."""

    elements: Elements
    s: Array
    z: Complex
    length: float
    end: complex
    heading: complex

    def with_(self, elements: Sequence[Element], line: PlanLine) -> "_Way":
        every = max(1, round(COARSE / float(line.s[1])))
        z = self.end + self.heading * line.z
        turned = np.exp(
            1j * np.radians(sum(element.turn for element in elements))
        )  # exact: the walk adds up errors
        return _Way(
            (*self.elements, *elements),
            np.concatenate([self.s, self.length + line.s[1::every]]),
            np.concatenate([self.z, z[1::every]]),
            self.length + float(line.s[-1]),
            complex(z[-1]),
            self.heading * complex(turned),
        )


def grown(
    order: TurnSequence, outline: Outline, windows: Windows, world: World, rng: np.random.Generator
) -> PlacedPlan | None:
    """Returns a road of the required length; None where it ran out of room, or where no length is required.

    Args:
        order: turns with their sides, and the straights that were asked for between them.
        outline: what was asked for.
        windows: grades.
        world: the map.
        rng: source of chance.
    """
    asked = asked_length(outline, windows)
    if asked is None or asked.lo <= 0 or not order.turns or outline.turning:
        return None
    low, high = asked.lo + 1, min(asked.hi - 1, 1.3 * asked.lo)
    target = low + (high - low) * (0.3 + 0.4 * rng.random())
    return _Growth(order, outline, windows, world, rng, target, asked).run()


class _Growth:
    """One attempt."""

    def __init__(
        self,
        order: TurnSequence,
        outline: Outline,
        windows: Windows,
        world: World,
        rng: np.random.Generator,
        target: float,
        asked: Range,
    ) -> None:
        self.order, self.outline, self.windows, self.world, self.rng = order, outline, windows, world, rng
        self.target, self.asked = target, asked
        self.more = _repeated(outline)
        self.has_open_sides = _has_open_sides(outline)
        turns = narrowed_turns(order.turns, outline, windows, world)
        self.turns = [_roomy(turn, target) for turn in turns]
        self.longest = longest_turn(len(turns), outline, world)
        low, high = EXTRA.get(order.turns[-1].name, EXTRA_OF_OTHERS)
        self.extra = low + (high - low) * rng.random()
        self.apart = world.road_width + SPARE + COARSENESS + BULGE

    def run(self) -> PlacedPlan | None:
        start, heading = self._start()
        way = self._grown(_Way((), np.zeros(1), np.array([start]), 0.0, start, heading))
        if way is None or way.length not in self.asked:
            return None
        theta = round(float(np.degrees(np.angle(heading))) % 360, 1) % 360
        place = MapPose(round(start.real, 2), round(start.imag, 2), theta)
        return PlacedPlan(way.elements, walk(way.elements), place)

    def _grown(self, start: _Way) -> _Way | None:
        """The whole road; where it does not go on, some turns are taken back and others tried."""
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
        border = self.world.road_width / 2 + EDGE + 1.0
        x, y = border + self.rng.random(2) * (self.world.map_size - 2 * border)
        heading = np.exp(1j * np.radians(self.rng.integers(3600) / 10))
        return complex(round(x, 2), round(y, 2)), complex(heading)

    def _turn(self, at: int, so_far: float) -> tuple[Feature, Sequence[Feature]] | None:
        """What the next turn is drawn from, and the straights before it; None behind the last."""
        named = len(self.order.turns)
        if at < named:
            return self.turns[at], self.order.gaps[at]
        left = self.target - so_far - LEAST_LEFT - self.extra / 2
        if not self.more or at >= min(MOST_TURNS, self.outline.turns.hi) or left < self.longest:
            return None
        return self.turns[-1], ()

    def _step(
        self,
        way: _Way,
        before: Element | None,
        asked: Feature,
        wishes: Sequence[Feature],
        at: int,
    ) -> tuple[_Way, Element] | None:
        """The road with one turn more, and that turn.

        Args:
            way, before: the road so far, and its last turn.
            asked, wishes: from what the next turn is drawn, and the straights asked for before it.
            at: its number, from 0.
        """
        hand, degrees = hand_of(asked), asked.degrees or ANY_TURN
        if at >= len(self.order.turns) and before:
            switches = self.has_open_sides is False
            hand = -1 if (before.turn > 0) == switches else 1
        extra = self._extra(way.length, at)
        for number in range(TRIED):
            if self.has_open_sides and number % 2 == 0:
                hand = 1 if self.rng.random() < 0.5 else -1
            elif self.has_open_sides:
                hand = -hand
            haste = number / TRIED
            angle = degrees.lo + self.rng.random() * (degrees.hi - degrees.lo)
            sided = replace(asked, side="left" if hand > 0 else "right")
            turn = drawn_turn(sided, angle, self.longest, self.outline.hard, self.rng, haste)
            gap = gap_between(before, wishes, turn, self.outline, self.windows, self.rng, 0.5 + haste / 2)
            elements = _stretched(gap, extra * (1 - haste) * self.rng.uniform(*UNEVEN))
            line = walk([*elements, turn])
            if self._is_free(way, line, AHEAD):
                return way.with_([*elements, turn], line), turn
        return None

    def _extra(self, so_far: float, at: int) -> float:
        """Metres by which the straight before the next turn may be longer than it must be."""
        if self.more and self.outline.turns.lo <= len(self.order.turns):
            return self.extra
        turns = max(len(self.order.turns) - at, 0)
        return max(self.target - so_far - turns * (self.longest / 2 + LEAST_LEFT), 0.0) / (turns + 1)

    def _out(self, way: _Way, before: Element | None) -> _Way | None:
        """The road with its last straight."""
        wishes = self.order.gaps[-1]
        elements = gap_between(before, wishes, None, self.outline, self.windows, self.rng, 1.0)
        missing = self.target - way.length - sum(element.length for element in elements)
        for share in (1.0, 0.7, 0.4, 0.0):
            longer = _stretched(elements, share * missing) if missing > 0 else elements
            line = walk(longer)
            if self._is_free(way, line, 0.0):
                return way.with_(longer, line)
        return None

    def _is_free(self, way: _Way, line: PlanLine, ahead: float) -> bool:
        """Does a piece, with some metres straight on, stay on the map and off the road so far?"""
        every = max(1, round(COARSE / float(line.s[1])))
        s, z = line.s[::every], line.z[::every]
        last = line.z[-1] - line.z[-2]
        on = np.arange(COARSE, ahead, COARSE)
        s = np.concatenate([s, line.s[-1:], line.s[-1] + on]) + way.length
        z = np.concatenate([z, line.z[-1:], line.z[-1] + on * (last / abs(last))])
        z = way.end + way.heading * z
        border = self.world.road_width / 2 + EDGE + BULGE
        low, high = border, self.world.map_size - border
        if min(z.real.min(), z.imag.min()) < low or max(z.real.max(), z.imag.max()) > high:
            return False
        return not meets(z, s, way.z, way.s, self.apart)


def _stretched(elements: Sequence[Element], metres: float) -> list[Element]:
    """With the first straight that may be longer made so; with one in front where there is none."""
    out = list(elements)
    for i, element in enumerate(out):
        if element.is_elastic:
            out[i] = element._replace(straight=element.length + metres)
            return out
    return out if out else [Element(metres)] if metres > 1 else []


def is_long(outline: Outline) -> bool:
    """Returns whether a road is so long that it is grown from the first draft on."""
    return outline.length is not None and outline.length.lo >= LONG and _repeated(outline)


def _roomy(turn: Feature, metres: float) -> Feature:
    """Turns off the tightest that is allowed, and the more so the further apart a spline's points are.

    The competition's files hold so few points that on a road of 10 km its spline has one every 20 m.
    """
    if turn.radius is None or turn.radius.hi < inf:
        return turn
    spacing = max(CONTROL_SPACING, metres / MOST_CONTROL_POINTS)
    least = turn.radius.lo * OFF_TIGHTEST + OFF_BY_SPACING * (spacing - CONTROL_SPACING)
    return replace(turn, radius=Range(least))


def _repeated(outline: Outline) -> bool:
    """May there be more turns, like the last?"""
    turning = [group for group in outline.groups if group.feature.kind == "turn"]
    is_last = bool(outline.groups) and outline.groups[-1].feature.kind == "turn" and outline.ends is None
    if not turning:
        return outline.turns.hi == inf and outline.ends is None
    return len(turning) == 1 and is_last and turning[0].hi is None


def _has_open_sides(outline: Outline) -> bool:
    """May every turn go either way?"""
    features = [*(g.feature for g in outline.groups), *(e for e in (outline.starts, outline.ends) if e)]
    is_open = outline.left == outline.right == Range() and not outline.alternating
    return is_open and not any(f.side for f in features) and not any(g.alternating for g in outline.groups)
