"""Searches for a road: tries random drafts until one meets the Brief, is valid and unlike earlier roads.

Each draft is checked, the cheapest check first. The draft must fit on the map, keep clear of itself, differ
from earlier roads, and meet the requirements as measured on its line. The rules must then accept the road
that is built from the draft. After the first drafts, straights and turns become a little shorter with every
draft, so that a later draft can meet requirements that leave little room."""

from collections import Counter
from collections.abc import Iterator
from functools import lru_cache, partial
from math import ceil

import numpy as np

from roadgpt import check
from roadgpt.brief.element import Element
from roadgpt.brief.map_fit import COMFORT, ROUND_MAP, check_room, metres_of
from roadgpt.brief.model import Brief
from roadgpt.brief.normal import normal
from roadgpt.brief.outline import Outline, outline
from roadgpt.brief.refusal import NoRoomError
from roadgpt.brief.words import LARGEST_MAP
from roadgpt.check.rules.too_abrupt import asks_for_bumps
from roadgpt.design.compose import DraftTask, TurnSequence, Windows, composed, drawn_sequence, is_long
from roadgpt.design.elements import design_at
from roadgpt.design.heights import asks_for_heights, corrected_draft, drawn_heights, has_room_for_heights
from roadgpt.design.layout import MapPose, PlacedPlan, drawn_ground, keeps_clear, place, smallest_box, walk
from roadgpt.design.variety import ENOUGH, PlanShape, Shapes, nearest, shape_of
from roadgpt.design.vertical import EASES, Pace
from roadgpt.errors import DesignError, RoadGPTError
from roadgpt.road import Design, Road, Segment, World, build

DRAFTS = 320  # for one road, at most
ALIKE = 120  # drafts like earlier roads, after which the least similar one is taken
ALIKE_STRAIGHTS = 12  # the same for a road without turns, where only the length can differ
CHOOSY = 1 / 8  # share of these drafts during which roads that only continue an earlier one count as alike
CROWDED = 400  # number of earlier roads above which this share is divided by three
FINISHED, FEWEST_FINISHED = 100, 12  # drafts that fit and fail a rule, after which the search is given up
FINISHED_METRES = 100_000.0  # m of such drafts; long roads take long to check
MANY_TURNS, OF_MANY = 12, 5  # of a road that is mostly grown; of its other drafts in haste, one in five
HASTIEST, HOPELESS = 4, 2.0  # drafts in the greatest haste; their least ratio to a map that is too small
LAST_RESORTS = 20  # drafts like earlier roads that are finished if there are no others
TRIALS = (1, 2, 3, 4)  # seeds with which ``failed_trial`` tests whether there is room
MANY_METRES = 2000.0  # m, of a long road: the first two seeds do
TRIED = 110  # drafts for each of these seeds
GROWN = 20  # grown drafts of a road of required length, if no composed draft was accepted
GROWN_ON_TRIAL = 5  # grown drafts in a search of fewer than ``DRAFTS`` drafts, as in ``failed_trial``
NO_HASTE = 16  # drafts without haste
SHOULDERS = 0.6  # share of the drafts in which the road must also keep off its own shoulders
FAILED_ON_HEIGHTS = 40  # drafts that failed on their slopes, after which lower speed limits are tried
SLOWER = (50.0, 30.0)  # km/h, speed limits that may be advised
EASES_OF_BUMPS = (0.12, 0.08, 0.0)  # shares of comfort that are also tried where a crest or a dip is required


@lru_cache(maxsize=64)  # the advice for a road that did not fit asks again
def failed_trial(brief: Brief, world: World) -> "DraftSearch | None":
    """Returns the first of four searches (of a long road, of two), with different seeds and up to 110 drafts
    each, that finds no road; None if all find one. Raises DesignError if the requirements contradict each
    other."""
    others = Shapes().of(())
    seeds = TRIALS if metres_of(brief, world.limits.min_radius) < MANY_METRES else TRIALS[:2]
    searches = (DraftSearch(brief, world, others, np.random.default_rng(seed)) for seed in seeds)
    return next((search for search in searches if search.found(TRIED) is None), None)


@lru_cache(maxsize=256)
def sufficient_map(brief: Brief, world: World) -> float | None:
    """Returns the side in metres of a map large enough for a road, if the map of the World is too small.
    Returns None if the World's map is large enough, or if no larger map would help."""
    failed, least = None, world.limits.min_radius
    try:
        check_room(normal(brief), world.site.map_size, least, world.section.road_width)
        failed = failed_trial(brief, world)
        if failed is None:
            return None
    except NoRoomError:  # no draft is needed to see that it is too small
        pass
    except RoadGPTError:
        return None
    from roadgpt.design.advice import FOR_ROOM, LIKELY, larger_map, main_reason, roomier

    if failed and main_reason(failed.failed) not in FOR_ROOM:
        return None
    likely = roomier(world, failed.boxes) if failed else LIKELY * metres_of(brief, least)
    found = larger_map(brief, world, failed_trial, likely)
    if found is None or brief.speed is None:
        return found
    return min(ceil(COMFORT * found / ROUND_MAP) * ROUND_MAP, LARGEST_MAP)  # for its usual straights


class DraftSearch:
    """The search for one road."""

    def __init__(self, brief: Brief, world: World, others: PlanShape, rng: np.random.Generator) -> None:
        """Prepares the search for a road that differs from ``others``, the shapes of earlier roads. Raises
        DesignError if the requirements contradict each other."""
        self.brief, self.world, self.others, self.rng = brief, world, others, rng
        self.outline: Outline = outline(brief, world.site.map_size)
        low, high = self.outline.turns.lo, self.outline.turns.hi
        if low > high:
            told = f"asked for {low:g} turns, and for {high:g} at most"
            raise DesignError(f"{told}; change one of these numbers")
        self.windows = Windows(self.outline, world)
        self.bumps = asks_for_bumps(brief)
        self.failed: Counter[str] = Counter()
        self.failed_on_heights = 0
        self.boxes: list[float] = []

    def run(self) -> tuple[Design, Road]:
        """Returns the first draft that is accepted, as a Design and its Road; one of the least similar
        drafts, if all are like earlier roads. Raises DesignError if no draft was accepted."""
        if (found := self.found()) is not None:
            return found
        from roadgpt.design.advice import advice, too_fast

        slower = self._speed_that_would_do()
        if slower:
            raise DesignError(too_fast(self.world, slower))
        raise DesignError(advice(self.brief, self.outline, self.world, self.failed, self.boxes, failed_trial))

    def found(self, drafts: int = DRAFTS) -> tuple[Design, Road] | None:
        """Returns the first of ``drafts`` drafts that is accepted, as in ``run``; None if none is accepted.
        See ``_hastes`` for the order of the drafts."""
        alike: list[tuple[float, int, PlacedPlan]] = []
        finished = 0
        most_alike = ALIKE if self.outline.turns.hi > 0 else ALIKE_STRAIGHTS
        choosy = CHOOSY * most_alike / (3 if len(self.others.reach) > CROWDED else 1)
        for number, haste in enumerate(self._hastes(drafts)):
            drafted = self._growth() if haste is None else self._plan(haste)
            if drafted is None:
                continue
            if haste is not None and not keeps_clear(drafted.line, self.world, number < SHOULDERS * drafts):
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
            if found := self._finished(drafted):
                return found
            if finished >= max(FEWEST_FINISHED, min(FINISHED, FINISHED_METRES / drafted.line.s[-1])):
                break
        last = map(self._finished, (drafted for _, _, drafted in sorted(alike)[:LAST_RESORTS]))
        return next(filter(None, last), None)

    def _hastes(self, drafts: int) -> Iterator[float | None]:
        """Yields the haste of each of ``drafts`` drafts that are composed; None for drafts that are grown.

        If the length of the road is required, drafts are grown after the composed ones; if it has many turns,
        so that a composed draft hardly keeps clear of itself, before most of them. A long road (see
        ``is_long``) has only grown drafts. No more are composed if the first ones are hopelessly too large.
        """
        hastes = [max(0.0, (n - NO_HASTE) / (drafts - NO_HASTE)) for n in range(drafts)]
        growths = [None] * (GROWN if drafts == DRAFTS else GROWN_ON_TRIAL)
        if is_long(self.outline):
            hastes = []
        yield from hastes[:NO_HASTE]
        others = [] if self.failed["too large"] == NO_HASTE and self._is_hopeless() else hastes[NO_HASTE:]
        if hastes and self.outline.turns.lo >= MANY_TURNS:
            yield from (*growths, *others[::OF_MANY])
        else:
            yield from (*others, *(growths if self.outline.length else ()))

    def _is_hopeless(self) -> bool:
        rng = self.rng.spawn(1)[0]  # so that other drafts stay the same
        drafts = [composed(*self._sequence(True, 1.0, rng)) for _ in range(HASTIEST)]
        boxes = [smallest_box(walk(draft)) for draft in drafts if draft is not None]
        return len(boxes) == HASTIEST and min(boxes) > HOPELESS * self.world.site.map_size

    def _sequence(
        self, plain: bool, haste: float, rng: np.random.Generator | None = None
    ) -> tuple[TurnSequence, DraftTask]:
        rng = rng or self.rng
        order = drawn_sequence(self.outline, rng, plain)
        task = DraftTask(self.outline, self.windows, self.world, rng, haste)
        if not self.outline.alike:
            return order, task
        from roadgpt.design.compose import with_like_parts

        return with_like_parts(order, task), task

    def _growth(self) -> PlacedPlan | None:
        from roadgpt.design.growth import grown

        found = grown(*self._sequence(plain=True, haste=0.5))
        if found is None:
            self.failed["too large"] += 1
        return found

    def _speed_that_would_do(self) -> float | None:
        """Returns a lower speed limit in km/h at which the required slopes are possible; None if there is
        none, if a design speed is required, or if only a few drafts failed because of their slopes."""
        if self.failed_on_heights < FAILED_ON_HEIGHTS or self.outline.speed:
            return None
        limits = [kmh for kmh in SLOWER if kmh / 3.6 < self.world.limits.speed_limit]
        worlds = {kmh: self.world.changed(speed_limit=kmh / 3.6) for kmh in limits}
        return next((kmh for kmh in limits if failed_trial(self.brief, worlds[kmh]) is None), None)

    def _plan(self, haste: float) -> PlacedPlan | None:
        elements = composed(*self._sequence(plain=haste > 0.5, haste=haste))
        if elements is None:
            self.failed["longer than was asked for"] += 1
            return None
        line = walk(elements)
        where = place(line, self.world, self.rng, heading=self.outline.heading)
        if where is None:
            self.failed["too large"] += 1
            self.boxes.append(smallest_box(line))
            return None
        return PlacedPlan(elements, line, where)

    def _finished(self, drafted: PlacedPlan) -> tuple[Design, Road] | None:
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
        """Returns one draft of a road between junctions, without heights, and with its start at the origin;
        None if the draft cannot have the required length, or overlaps itself. The larger ``haste``, from 0 to
        1, the shorter the road; if ``plain``, it has as few turns as the requirements allow."""
        elements = composed(*self._sequence(plain, haste))
        if elements is None:
            return None
        line = walk(elements)
        if not keeps_clear(line, self.world, with_shoulders=True):
            return None
        return PlacedPlan(elements, line, MapPose(0.0, 0.0, 0.0))

    def with_heights(self, drafted: PlacedPlan) -> tuple[Segment, ...] | None:
        """Returns the segments of a plan with slopes that meet all requirements; None if none were found."""
        elements = [half for element in drafted.elements for half in element.halves]
        pace = Pace.along(drafted.elements, self.world, self.outline.speed)
        has_heights = asks_for_heights(elements)
        # shorter parabolas leave more of a straight at the grade and the length that were said
        first = 1 if any(map(_has_exact_slope, drafted.elements)) else 0
        roomy = partial(has_room_for_heights, elements, self.windows.limit, pace, bumps=False)
        eases = [ease for ease in EASES[first:-1] if roomy(ease=ease)]
        tries = [(ease, False) for ease in (*eases, EASES[-1], EASES[-1])]
        tries += [(ease, True) for ease in EASES_OF_BUMPS] if self.bumps else []
        for ease, bumps in tries:
            sloped = drawn_heights(elements, self.outline, self.windows, self.rng, pace, ease, bumps)
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
    length, grade = element.required_length, element.required_grade
    return bool(length and length.number and grade and grade.number)
