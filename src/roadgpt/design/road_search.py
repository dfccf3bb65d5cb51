"""Searches for a road: tries random drafts until one meets the Brief, is valid and unlike earlier roads.

Each draft is checked, the cheapest check first. The draft must fit on the map, keep clear of itself, differ
from earlier roads, and meet the requirements as measured on its line. The rules must then accept the road
that is built from the draft. After the first drafts, straights and turns become a little shorter with every
draft, so that a later draft can meet requirements that leave little room.
"""

from collections import Counter
from functools import lru_cache, partial

import numpy as np

from roadgpt import check
from roadgpt.brief.element import Element
from roadgpt.brief.map_fit import check_room
from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.outline import Outline, outline
from roadgpt.brief.refusal import NoRoomError
from roadgpt.check.bumps import asks_for_bumps
from roadgpt.design.climbs import asks_for_heights, has_room_for_heights
from roadgpt.design.compose import composed
from roadgpt.design.draw import DraftTask
from roadgpt.design.grade_correction import corrected_draft
from roadgpt.design.heights import drawn_heights
from roadgpt.design.layout import MapPose, PlacedPlan, drawn_ground, keeps_clear, place, smallest_box, walk
from roadgpt.design.sequence import TurnSequence, drawn_sequence, is_long
from roadgpt.design.variety import ENOUGH, PlanShape, Shapes, nearest, shape_of
from roadgpt.design.vertical import EASES, Pace
from roadgpt.design.windows import Windows
from roadgpt.design.writing import design_at
from roadgpt.errors import DesignError, RoadGPTError
from roadgpt.road import Design, Road, Segment, World, build

DRAFTS = 320  # for one road, at most
ALIKE = 120  # drafts like earlier roads, after which the least similar one is taken
ALIKE_STRAIGHTS = 12  # the same for a road without turns, where only the length can differ
CHOOSY = 1 / 8  # share of these drafts during which roads that only continue an earlier one count as alike
CROWDED = 400  # number of earlier roads above which this share is divided by three
FINISHED = 100  # drafts that fit but fail a requirement or rule, after which the search is given up
LAST_RESORTS = 20  # drafts like earlier roads that are finished if there are no others
TRIALS = (1, 2, 3, 4)  # seeds with which ``fits`` tests whether there is room
TRIED = 110  # drafts for each of these seeds
GROWN = 20  # grown drafts of a road of required length, if no composed draft was accepted
GROWN_ON_TRIAL = 5  # grown drafts in a search of fewer than ``DRAFTS`` drafts, as in ``fits``
NO_HASTE = 16  # drafts without haste
SHOULDERS = 0.6  # share of the drafts in which the road must also keep off its own shoulders
FAILED_ON_HEIGHTS = 40  # drafts that failed on their slopes, after which lower speed limits are tried
SLOWER = (50.0, 30.0)  # km/h, speed limits that may be advised
EASES_OF_BUMPS = (0.12, 0.08, 0.0)  # shares of comfort that are also tried where a crest or a dip is required


@lru_cache(maxsize=64)  # the advice for a road that did not fit asks again
def fits(brief: Brief, world: World) -> bool:
    """Returns whether each of four searches, with different seeds and up to 110 drafts each, finds a road."""
    try:
        return _failed_trial(brief, world) is None
    except DesignError:
        return False


def _failed_trial(brief: Brief, world: World) -> "DraftSearch | None":
    """Returns the first of the searches of ``fits`` that finds no road; None if all find one.

    Raises:
        DesignError: the requirements contradict each other.
    """
    others = Shapes().of(())
    searches = [DraftSearch(brief, world, others, np.random.default_rng(seed)) for seed in TRIALS]
    return next((search for search in searches if search.found(TRIED) is None), None)


@lru_cache(maxsize=256)
def sufficient_map(brief: Brief, world: World) -> float | None:
    """Returns the side in metres of a map large enough for a road, if the map of the World is too small.

    Returns None if the World's map is large enough, or if no larger map would help.
    """
    try:
        check_room(normal(brief), world.site.map_size, world.limits.min_radius, world.section.road_width)
        failed = _failed_trial(brief, world)
    except NoRoomError:
        return _larger_map(brief, world)
    except RoadGPTError:
        return None
    return None if failed is None else _larger_map(brief, world, failed)


def _larger_map(brief: Brief, world: World, failed: "DraftSearch | None" = None) -> float | None:
    """Returns the side in metres of a map large enough for a road that the World's map has no room for.

    Returns None if no larger map would help. ``failed`` is a search that found no road; None if none was
    made, because the map is clearly too small.
    """
    from roadgpt.design.advice import FOR_ROOM, LIKELY, larger_map, main_reason, metres_of, roomier

    if failed is None:
        return larger_map(brief, world, fits, LIKELY * metres_of(brief, world))
    if main_reason(failed.failed) not in FOR_ROOM:
        return None
    return larger_map(brief, world, fits, roomier(world, failed.boxes))


class DraftSearch:
    """The search for one road."""

    def __init__(self, brief: Brief, world: World, others: PlanShape, rng: np.random.Generator) -> None:
        """Prepares the search for a road that differs from ``others``, the shapes of earlier roads.

        Raises:
            DesignError: the requirements contradict each other.
        """
        self.brief, self.world, self.others, self.rng = brief, world, others, rng
        self.outline: Outline = outline(brief, world.site.map_size)
        if self.outline.turns.lo > self.outline.turns.hi:
            low, high = self.outline.turns.lo, self.outline.turns.hi
            raise DesignError(
                f"asked for {low:g} turns, and for {high:g} at most; change one of these numbers"
            )
        self.windows = Windows(self.outline, world)
        self.bumps = asks_for_bumps(brief)
        self.failed: Counter[str] = Counter()
        self.failed_on_heights = 0
        self.boxes: list[float] = []

    def run(self) -> tuple[Design, Road]:
        """Returns the first draft that is accepted, as a Design and its Road.

        If all drafts are like earlier roads, one of the least similar drafts is returned.

        Raises:
            DesignError: no draft was accepted.
        """
        found = self.found()
        if found is not None:
            return found
        from roadgpt.design.advice import advice, too_fast

        slower = self._speed_that_would_do()
        if slower:
            raise DesignError(too_fast(self.world, slower))
        raise DesignError(advice(self.brief, self.outline, self.world, self.failed, self.boxes, fits))

    def found(self, drafts: int = DRAFTS) -> tuple[Design, Road] | None:
        """Returns the first of ``drafts`` drafts that is accepted, as in ``run``; None if none is accepted.

        If the length of the road is required, additional drafts are grown turn by turn; a long road (see
        ``is_long``) has only grown drafts.
        """
        alike: list[tuple[float, int, PlacedPlan]] = []
        finished = 0
        most_alike = ALIKE if self.outline.turns.hi > 0 else ALIKE_STRAIGHTS
        choosy = CHOOSY * most_alike / (3 if len(self.others.reach) > CROWDED else 1)
        grows = is_long(self.outline)
        growths = GROWN if drafts == DRAFTS else GROWN_ON_TRIAL
        most = growths if grows else drafts + (growths if self.outline.length else 0)
        for number in range(most):
            haste = max(0.0, (number - NO_HASTE) / (drafts - NO_HASTE))
            is_grown = grows or number >= drafts
            drafted = self._growth() if is_grown else self._plan(haste)
            if drafted is None:
                continue
            if not is_grown and not keeps_clear(drafted.line, self.world, number < SHOULDERS * drafts):
                self.failed["over itself"] += 1
                continue
            shape = shape_of(drafted.line.s, drafted.line.z)
            away = nearest(shape, self.others, by_metres=len(alike) < choosy)
            if away < ENOUGH * min(1.0, 1.5 * (1 - len(alike) / most_alike)):
                self.failed["like an earlier road"] += 1
                alike.append((-away, number, drafted))
                if len(alike) == most_alike:
                    break
                continue
            finished += 1
            found = self._finished(drafted)
            if found:
                return found
            if finished == FINISHED:
                break
        for _, _, drafted in sorted(alike)[:LAST_RESORTS]:
            found = self._finished(drafted)
            if found:
                return found
        return None

    def _sequence(self, plain: bool, haste: float) -> tuple[TurnSequence, DraftTask]:
        order = drawn_sequence(self.outline, self.rng, plain)
        task = DraftTask(self.outline, self.windows, self.world, self.rng, haste)
        if not self.outline.alike:
            return order, task
        from roadgpt.design.like_parts import with_like_parts

        return with_like_parts(order, task), task

    def _growth(self) -> PlacedPlan | None:
        """Returns a plan that was drafted turn by turn on the map; None if it ran out of room."""
        from roadgpt.design.growth import grown

        found = grown(*self._sequence(plain=True, haste=0.5))
        if found is None:
            self.failed["too large"] += 1
        return found

    def _speed_that_would_do(self) -> float | None:
        """Returns a lower speed limit in km/h at which the required slopes are possible.

        Returns None if there is none, or if only a few drafts failed because of their slopes.
        """
        if self.failed_on_heights < FAILED_ON_HEIGHTS:
            return None
        limits = [kmh for kmh in SLOWER if kmh / 3.6 < self.world.limits.speed_limit]
        worlds = [self.world.changed(speed_limit=kmh / 3.6) for kmh in limits]
        return next((k for k, w in zip(limits, worlds, strict=True) if fits(self.brief, w)), None)

    def _plan(self, haste: float) -> PlacedPlan | None:
        elements = composed(*self._sequence(plain=haste > 0.5, haste=haste))
        if elements is None:
            self.failed["longer than was asked for"] += 1
            return None
        line = walk(elements)
        where = place(line, self.world, self.rng)
        if where is None:
            self.failed["too large"] += 1
            self.boxes.append(smallest_box(line))
            return None
        return PlacedPlan(elements, line, where)

    def _finished(self, drafted: PlacedPlan) -> tuple[Design, Road] | None:
        """Returns the Design and the Road of a plan; None if they violate a requirement or a rule."""
        segments = self.with_heights(drafted)
        if segments is None:
            return None
        design = design_at(drafted.place, segments, drawn_ground(self.world, self.rng))
        road = build(design)
        objections = check.inspect(road, self.brief, self.world)
        if objections:
            self.failed[objections[0].sentence] += 1
            return None
        return design, road

    def stretch(self, haste: float, plain: bool) -> PlacedPlan | None:
        """Returns one draft of a road between junctions, without heights, and with its start at the origin.

        Returns None if the draft cannot have the required length, or overlaps itself. The larger ``haste``,
        from 0 to 1, the shorter the road; if ``plain``, it has as few turns as the requirements allow.
        """
        elements = composed(*self._sequence(plain, haste))
        if elements is None:
            return None
        line = walk(elements)
        if not keeps_clear(line, self.world, with_shoulders=True):
            return None
        return PlacedPlan(elements, line, MapPose(0.0, 0.0, 0.0))

    def with_heights(self, drafted: PlacedPlan) -> tuple[Segment, ...] | None:
        """Returns the segments of a plan with slopes that meet all requirements; None if none were found."""
        pace = Pace.along(drafted.elements, self.world)
        has_heights = asks_for_heights(drafted.elements)
        # shorter parabolas leave more of a straight at the grade and the length that were said
        first = 1 if any(map(_has_exact_slope, drafted.elements)) else 0
        roomy = partial(has_room_for_heights, drafted.elements, self.windows.limit, pace, bumps=False)
        eases = [ease for ease in EASES[first:-1] if roomy(ease=ease)]
        tries = [(ease, False) for ease in (*eases, EASES[-1], EASES[-1])]
        tries += [(ease, True) for ease in EASES_OF_BUMPS] if self.bumps else []
        for ease, bumps in tries:
            sloped = drawn_heights(drafted.elements, self.outline, self.windows, self.rng, pace, ease, bumps)
            # what is not required may be comfortable after all, unless it takes away a height
            for share in dict.fromkeys((ease if has_heights else 1.0, ease)):
                segments, broken = corrected_draft(
                    sloped, drafted.line, self.outline, self.windows.limit, pace, ease, share, bumps
                )
                if not broken:
                    return segments
                self.failed[broken[0].sentence] += 1
                if not any(complaint.on_heights for complaint in broken):
                    return None
                self.failed_on_heights += 1
        return None


def _has_exact_slope(element: Element) -> bool:
    """Returns whether numbers were given for both the length and the grade of a straight."""
    length, grade = element.required_length, element.required_grade
    return bool(length and length.number and grade and grade.number)
