"""Searches for a route through junctions: tries random drafts until one fits on the map and breaks no rule.

Each road between junctions is drafted like any road, and each junction is drawn within its requirements. A
road whose climb is required is made steeper, because its ends at junctions are level. The sketch of the whole
is checked first: nothing may overlap, and it must fit on the map. Then the rules must accept the network that
is built from it."""

import math
from collections import Counter
from collections.abc import Sequence
from itertools import accumulate, pairwise
from math import inf
from typing import TypeVar

import numpy as np

from roadgpt.brief.amount import at_least, between, exactly, span
from roadgpt.brief.junction_check import check_junction
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, JunctionClause
from roadgpt.brief.model import Brief, Clause
from roadgpt.brief.words import LARGEST_MAP, ROAD_LENGTH_SLACK
from roadgpt.check.network_promises import length_range
from roadgpt.design.advice import main_reason
from roadgpt.design.elements import start_height
from roadgpt.design.first_accepted import LANES_DIFFER, RUN_TOGETHER, first_accepted
from roadgpt.design.junction_draft import drawn_junction
from roadgpt.design.lane_draft import (
    SHORT_ROAD,
    counted_from_lanes,
    drawn_change,
    drawn_ramp,
    lanes_of_roads,
    main_roads,
    with_roads_continued,
    with_side_of_change,
)
from roadgpt.design.layout import MapPose, PlacedPlan, PlanLine, drawn_ground, place, smallest_box
from roadgpt.design.network_sketch import is_clear, sketched
from roadgpt.design.road_search import DraftSearch
from roadgpt.design.unbuilt import check_lanes_across
from roadgpt.design.variety import Shapes
from roadgpt.errors import DesignError, UsageError
from roadgpt.network import NetworkDesign, build_route
from roadgpt.network.design import LanesDesign, PlaceDesign, RampDesign, ends_route
from roadgpt.network.growing import length_inside
from roadgpt.network.ramps import BESIDE, length_beside
from roadgpt.network.stretch import level_ends, profiles_between
from roadgpt.plural import plural
from roadgpt.road import Profile, Segment, World
from roadgpt.road.design import vertical_curves_of

STEADY = 1.0  # percent; a road whose mean grade is less remains unchanged
ROUNDS = 4  # of steepening, since each round also makes the level ends a little longer
TENTH = 10.0  # per percentage point: grades are written to the tenth
DRAFTS = 400  # for one route, at most
DRAFTS_OF_LENGTH = 1200  # the same, if a length of the whole route is required
NO_HASTE = 12  # drafts without haste
STRETCHES = 12  # drafts of one road between junctions
HEIGHTS = 3  # draws of the heights of one road
BUILT = 60  # drafts that fit and break a rule, after which the search is given up
LEAST_OF_MOST = 0.6  # least length of a route as a share of its greatest, if only the latter is required
MOST_OF_LEAST = 1.2  # greatest length of a route as a multiple of its least length
LONG = 150.0  # m; a road of this length or more is easier to place if it has several turns
HURRIED = 1 / 8  # least haste for each junction beyond the second
CURVED = 0.4  # share of roads without requirements that have a turn
SHORTEST = 30.0  # m, least length of a road without requirements
SHORTEST_WITH_LANES = 80.0  # m, where lanes end, begin or are changed
TRIED_LARGER = 40  # drafts on the largest map, which show whether only room is missing
BETWEEN_RAMPS = 40.0  # m, more than the roads beside it, of a road that begins and ends at a ramp
ROOM = 360.0  # m of roads without requirements on the usual map, all together
MOST = 130.0  # m, greatest length of one such road
TURNING = 45.0  # m more for such a road with a turn
PARTS = 250.0  # m, side of the usual map
ROOM_TO_TURN = 20.0  # m of a road of required length that must remain beyond the lane of a ramp
TOO_LARGE, OVERLAPS, UNDRAFTED = "too large", "its roads would overlap", "one of its roads cannot be drafted"
NO_LENGTH = "the length that was asked for leaves too little for the roads between the junctions"
FOR_ROOM = (TOO_LARGE, OVERLAPS, UNDRAFTED)
"""Reasons for failure that may disappear on a larger map."""
Asked = TypeVar("Asked", Brief, Clause)
Draft = tuple[DraftSearch, PlacedPlan]
"""The search for a road between junctions, and the plan of the road that it found."""


def climbing(
    segments: Sequence[Segment], is_level: tuple[bool, bool], steepest: float
) -> tuple[Segment, ...]:
    """Returns the segments, steepened so that level ends do not change the mean grade of the road.

    Up to four rounds of steepening bring the mean grade close to its original value. A road whose mean grade
    is below 1 % is returned unchanged. Vertical radii that no longer fit are reduced. ``is_level`` says
    whether the road is level at its start, and at its end. Steepening stops before a grade exceeds
    ``steepest`` percent."""
    length = sum(segment.distance for segment in segments)
    wanted = sum(segment.distance * segment.incline for segment in segments) / length
    found = tuple(segments)
    if abs(wanted) < STEADY:
        return found
    for _ in range(ROUNDS):
        profile = level_ends(found, 0.0, is_level)
        mean = 100 * float(profile.height(length) - profile.height(0.0)) / length
        if mean * wanted <= 0 or abs(mean) >= abs(wanted):
            break
        steeper = [_steeper(segment, wanted / mean) for segment in found]
        if any(abs(segment.incline) > steepest for segment in steeper):
            break
        found = tuple(steeper)
    return _fitted(found)


def _steeper(segment: Segment, factor: float) -> Segment:
    """Returns the segment with its grade multiplied by ``factor``; its vertical curve keeps its length."""
    radius = segment.vertical_radius
    changed = {
        "incline": round(TENTH * segment.incline * factor) / TENTH,
        "vertical_radius": None if radius is None else math.floor(TENTH * radius / factor) / TENTH,
    }
    return segment.model_copy(update=changed)


def _fitted(segments: tuple[Segment, ...]) -> tuple[Segment, ...]:
    """Returns the segments with vertical radii reduced where there is too little room for them."""
    found = list(segments)
    for curve in vertical_curves_of(segments):
        asked = found[curve.number].vertical_radius
        if asked is not None and curve.radius < asked:
            fits = math.floor(TENTH * curve.radius) / TENTH
            found[curve.number] = found[curve.number].model_copy(update={"vertical_radius": fits})
    return tuple(found)


class NetworkSearch:
    """The search for one route."""

    tried = 40
    """Number of drafts in a search that tests whether the World's map is large enough."""

    def __init__(self, brief: Brief, world: World, rng: np.random.Generator) -> None:
        """Prepares the search. Raises BriefError if a junction cannot meet its requirements, and DesignError
        if lanes of a road would lead nowhere at a junction."""
        for clause in brief.junctions:
            check_junction(clause)
        self.brief, self.world, self.rng = with_roads_continued(brief), world, rng
        self.has_wide_bends = main_roads(brief.junctions)
        self.usual = LanesDesign(width=world.section.lane_width)
        self.lanes = lanes_of_roads(brief, world.section.lane_width)
        self.others = Shapes().of(())
        check_lanes_across(brief.junctions, self.lanes)
        self.failed: Counter[str] = Counter()
        self.boxes: list[float] = []

    def run(self, drafts: int | None = None) -> NetworkDesign:
        """Returns the first of up to ``drafts`` drafts that is accepted; None stands for the usual number.
        Raises DesignError if no draft was accepted, for the most frequent reason, or no road can have the
        lanes that are required."""
        drafts = drafts or (DRAFTS if self.brief.length is None else DRAFTS_OF_LENGTH)
        least = HURRIED * max(len(self.brief.junctions) - 2, 0)
        calm = min(NO_HASTE, drafts // 3)
        hastes = (max(0.0, (n - calm) / (drafts - calm)) ** 0.5 for n in range(drafts))
        tried = (self._draft(min(max(haste, least), 1.0)) for haste in hastes)
        try:
            found = first_accepted(tried, build_route, self.brief, self.world, self.failed, BUILT)
        except UsageError as error:  # no draft can have such lanes
            raise DesignError(str(error)) from error
        if found is None:
            raise DesignError(self._advice())
        return found

    def _draft(self, haste: float) -> NetworkDesign | None:
        junctions = self._places(haste)
        drafts = None if junctions is None else self._stretches(junctions, haste)
        if junctions is None or drafts is None:
            return None
        pose = self._place(drafts, junctions)
        segments = None if pose is None else self._segments(drafts)
        if pose is None or segments is None:
            return None
        after = accumulate(map(len, segments))
        driven = segments[:-1] if any(map(ends_route, junctions)) else segments
        every = tuple(segment for part in driven for segment in part)
        return NetworkDesign(
            starting_point=(pose.x, pose.y, start_height(every, drawn_ground(self.world, self.rng))),
            theta=pose.theta,
            segments=every,
            junctions=tuple(
                junction.model_copy(update={"after": number})
                for junction, number in zip(junctions, after, strict=False)
            ),
            lanes=None if self._has_usual_lanes else self.lanes[0],
        )

    @property
    def lacks_room(self) -> bool:
        """Whether most drafts failed for a reason that may disappear on a larger map."""
        return main_reason(self.failed) in FOR_ROOM

    @property
    def _has_usual_lanes(self) -> bool:
        return all(each == self.usual for each in self.lanes)

    def _places(self, haste: float) -> list[PlaceDesign] | None:
        """Returns what the route passes; None if a junction cannot be drawn."""
        found: list[PlaceDesign] = []
        # "five junctions, two of them forks" has no third fork
        named = {clause.kind for clause in self.brief.junctions}
        for number, clause in enumerate(self.brief.junctions):
            drawn: PlaceDesign | None
            if clause.kind in LANE_KINDS:
                around = self.brief.roads[number : number + 2]
                drawn = drawn_change(with_side_of_change(self.brief.junctions, number), around)
            elif clause.kind in RAMPS:
                drawn = drawn_ramp(clause, self._room_beside(number))
            else:
                asked = self._at_end_of_ramp(number) or self._with_ring_lanes(number)
                drawn = drawn_junction(asked, self.rng, haste, named)
            if drawn is None:
                is_small = clause.kind == "roundabout" and not (clause.take and clause.exit)
                why = "such an island is too small for so many arms" if is_small else "it has no such ways on"
                self.failed[f"{why} at a {clause.name}"] += 1
                return None
            lanes = None if self._has_usual_lanes else self.lanes[number + 1]
            found.append(drawn.model_copy(update={"lanes": lanes}))
        return found

    def _with_ring_lanes(self, number: int) -> JunctionClause:
        """Returns what is required of a junction; a ring has as many lanes as the roads that it joins."""
        clause = self.brief.junctions[number]
        if clause.kind != "roundabout" or clause.lanes is not None:
            return clause
        most = max(max(each.forward, each.backward) for each in self.lanes[number : number + 2])
        return clause.model_copy(update={"lanes": exactly(most)}) if most > 1 else clause

    def _at_end_of_ramp(self, number: int) -> JunctionClause | None:
        """Returns what is required of a T-junction at the end of a motorway's exit, where the ramp is its
        stem; None for any other junction."""
        clause = self.brief.junctions[number]
        before = self.brief.junctions[number - 1] if number else None
        is_exit = before is not None and before.kind == "diverge" and before.take != "main"
        is_free = clause.take in ("left", "right") and not clause.ways and clause.angle is None
        if clause.kind != "t_junction" or not is_exit or not is_free:
            return None
        return clause.model_copy(update={"ways": ("left", "right")})

    def _room_beside(self, number: int) -> float:
        """Returns the length in metres that a lane for acceleration or deceleration can have, with its
        taper."""
        places = self.brief.junctions
        n = number if places[number].kind == "diverge" else number + 1
        road = self.brief.roads[n]
        beside = road.clauses[-1 if n == number else 0] if road.clauses else None
        asked = (beside.length if beside and beside.kind == "straight" else None) or road.length
        if asked is None:
            return inf
        is_shared = 0 < n < len(places) and (places[n - 1].kind, places[n].kind) == ("merge", "diverge")
        room = span(asked).hi - SHORT_ROAD - ROOM_TO_TURN
        other = places[n - 1 if number == n else n] if is_shared else None
        if other is None or other.length is None:
            return room / 2 if is_shared else room
        return room - length_beside(drawn_ramp(other, room / 2))

    def _profiles(self, places: Sequence[PlaceDesign], lengths: Sequence[float]) -> list[Profile]:
        return profiles_between(self.lanes[0], places, lengths, self.world.section.shoulder)

    def _stretches(self, junctions: Sequence[PlaceDesign], haste: float) -> list[Draft] | None:
        """Returns a draft of each road between the junctions; None if one of them cannot be drafted. The
        roads of which nothing is required, or else those of which no length is, are drafted last: they make
        up the length of the whole route. If one is required, straight roads of any length do so too."""
        briefs = counted_from_lanes(self.brief, junctions, self.usual.width)
        rest = self._rest(junctions)
        free = [n for n, brief in enumerate(briefs) if brief.has_free_shape]
        if free and rest is not None:
            free = [n for n, brief in enumerate(briefs) if n in free or brief.is_straight_of_any_length]
        free = free or [n for n, brief in enumerate(briefs) if brief.length is None]
        found: dict[int, Draft] = {}
        for n in sorted(range(len(briefs)), key=lambda n: (n in free, n)):
            share = None
            if rest is not None and n in free:
                left = rest - sum(drafted.line.s[-1] for _, drafted in found.values())
                share = left / sum(each not in found for each in free)
                if share < SHORTEST:
                    self.failed[NO_LENGTH] += 1
                    return None
            draft = self._stretch(_without_ramps(briefs[n], n, junctions), n, haste, share)
            if draft is None:
                self.failed[UNDRAFTED] += 1
                return None
            found[n] = draft
        return [found[n] for n in range(len(briefs))]

    def _shortest(self, n: int, haste: float) -> float:
        """Returns the least length in metres of a road of which no length is required. The larger ``haste``,
        from 0 to 1, the shorter a road with several lanes on which none ends, begins or is changed."""
        kinds = [place.kind for place in self.brief.junctions[max(n - 1, 0) : n + 1]]
        if len(kinds) == 2 and all(kind in RAMPS for kind in kinds) and kinds != ["merge", "diverge"]:
            # beside this road lie those that the route does not take
            return BESIDE * ((kinds[0] == "diverge") + (kinds[1] == "merge")) + BETWEEN_RAMPS
        if any(kind in LANE_KINDS for kind in kinds):
            return SHORTEST_WITH_LANES
        return max(SHORTEST_WITH_LANES * (1 - haste), SHORTEST) if self.lanes[n].forward > 1 else SHORTEST

    def _rest(self, junctions: Sequence[PlaceDesign]) -> float | None:
        """Returns the length in metres that the roads between junctions share; None if it is open."""
        if self.brief.length is None:
            return None
        asked = length_range(self.brief.length)
        low = asked.lo if asked.lo > 0 else LEAST_OF_MOST * asked.hi
        high = min(asked.hi, MOST_OF_LEAST * low)
        profiles = self._profiles(junctions, [LONG] * (len(junctions) + 1))
        inside = sum(
            length_inside(place, *pair) for place, pair in zip(junctions, pairwise(profiles), strict=True)
        )
        return float(self.rng.uniform(0.7 * low + 0.3 * high, 0.3 * low + 0.7 * high)) - inside

    def _stretch(self, brief: Brief, n: int, haste: float, length: float | None) -> Draft | None:
        """Returns a draft of road number ``n`` between junctions; None if no draft was accepted. If a ramp
        joins or leaves the road, turns that are not required are sweeping. ``length`` is what the road should
        have in metres; None if it is open."""
        wanted, shortest = brief, self._shortest(n, haste)
        if length is not None:
            is_straight = brief.motorway and not brief.clauses and brief.turns is None
            turns = exactly(0) if is_straight else brief.turns
            long = between(0.97 * length, 1.03 * length)
            wanted = brief.model_copy(update={"length": long, "turns": turns})
        elif brief.has_free_shape:
            wanted = self._open(haste, shortest, is_straight=brief.motorway)
        elif brief.length is None and not brief.clauses and brief.turns is None:
            free = self._open(haste, shortest, is_straight=True)
            needs_room = brief.hills is not None or brief.climb is not None
            wanted = brief.model_copy(
                update={"length": None if needs_room else free.length, "turns": free.turns}
            )
        elif not brief.clauses and brief.turns is None:
            is_straight = brief.motorway or self.rng.random() > CURVED * (1 - haste)
            wanted = brief.model_copy(update={"turns": exactly(0) if is_straight else at_least(1)})
        if n in self.has_wide_bends and brief.turns is None and wanted.turns not in (None, exactly(0)):
            wanted = wanted.model_copy(update={"sharpness": "sweeping"})
        search = DraftSearch(wanted, self.world, self.others, self.rng)
        for _ in range(STRETCHES):
            found = search.stretch(haste, plain=span(wanted.length).lo < LONG)
            if found is not None:
                return search, found
        return None

    def _segments(self, drafts: Sequence[Draft]) -> list[tuple[Segment, ...]] | None:
        """Returns the segments of each road; None if one cannot have heights that meet its requirements."""
        found = []
        for n, (search, drafted) in enumerate(drafts):
            tries = (search.with_heights(drafted) for _ in range(HEIGHTS))
            segments = next((each for each in tries if each is not None), None)
            if segments is None:
                self.failed.update(search.failed)
                return None
            if self.brief.roads[n].climb is not None:
                is_level = (n > 0, n < len(drafts) - 1)
                segments = climbing(segments, is_level, 100 * self.world.limits.max_grade)
            found.append(segments)
        return found

    def _open(self, haste: float, shortest: float, is_straight: bool = False) -> Brief:
        """Returns requirements for a road of which nothing is required: short, and with a turn at most."""
        count = len(self.brief.roads)
        most = min(MOST, ROOM * self.world.site.map_size / PARTS / count)
        most = max(most, shortest)
        high = shortest + 5 + (most - shortest) * (1 - haste) * float(self.rng.random())
        if is_straight or self.rng.random() > CURVED * (1 - haste):
            return Brief(turns=exactly(0), length=between(shortest * (1 - 0.3 * haste), high))
        return Brief(turns=exactly(1), degrees=between(18, 70), length=between(shortest, high + TURNING))

    def _place(self, drafts: Sequence[Draft], junctions: Sequence[PlaceDesign]) -> MapPose | None:
        """Returns the start of a route on the map; None if it overlaps itself or does not fit."""
        if any(map(ends_route, junctions)) and not self.brief.roads[-1].is_open:
            self.failed["it turns back, so it cannot go on on another road"] += 1
            return None
        lines = [drafted.line for _, drafted in drafts]
        profiles = self._profiles(junctions, [float(line.s[-1]) for line in lines])
        sketch = sketched(lines, junctions, profiles)
        if not is_clear(sketch):
            self.failed[OVERLAPS] += 1
            return None
        line = PlanLine(np.arange(len(sketch.z), dtype=float), sketch.z)
        pose = place(line, self.world, self.rng, float(sketch.reach.max()))
        if pose is None:
            self.failed[TOO_LARGE] += 1
            self.boxes.append(smallest_box(line))
        return pose

    def _advice(self) -> str:
        why, _ = max(self.failed.items(), key=lambda item: item[1], default=("nothing could be drafted", 0))
        size = self.world.site.map_size
        if why in FOR_ROOM and size < LARGEST_MAP:
            largest = self.world.changed(map_size=LARGEST_MAP)
            try:
                NetworkSearch(self.brief, largest, self.rng).run(TRIED_LARGER)
            except DesignError as error:  # room is not what it lacks
                return str(error)
        if why in (TOO_LARGE, OVERLAPS):
            count = plural(len(self.brief.junctions), "junction")
            or_else = ", or give a larger map with --map-size" if size < LARGEST_MAP else ""
            return (
                f"{count} and the roads between them found no place on a map of {size:g} m; ask for fewer or "
                f"shorter roads{or_else}"
            )
        advice = {
            LANES_DIFFER: "give the roads at each junction as many lanes",
            RUN_TOGETHER: "change the turns or the lengths between the junctions",
            NO_LENGTH: "ask for a longer route",
        }
        what = advice.get(why, "leave something out")
        return f"no draft of this route was accepted: {why}; {what}"


def _without_ramps(asked: Brief, n: int, places: Sequence[PlaceDesign]) -> Brief:
    """Returns the requirements for the part of the road number ``n`` that is not beside a lane of a ramp."""
    around = [(place, "merge", 0) for place in places[max(n - 1, 0) : n]]
    around += [(place, "diverge", -1) for place in places[n : n + 1]]
    for passed, kind, end in around:
        if isinstance(passed, RampDesign) and passed.kind == kind:
            less, clauses = length_beside(passed), [*asked.clauses]
            if clauses and clauses[end].kind == "straight":
                clauses[end] = _shorter(clauses[end], less, ROAD_LENGTH_SLACK)
            asked = _shorter(asked.model_copy(update={"clauses": tuple(clauses)}), less, 0.0)
    return asked


def _shorter(asked: Asked, less: float, slack: float) -> Asked:
    """Returns the requirements with a length that is ``less`` metres shorter and differs by ``slack``."""
    if asked.length is None:
        return asked
    low, high = span(asked.length).lo - less, span(asked.length).hi - less
    if asked.length.exact:
        low, high = low - slack * (low + less), high + slack * (high + less)
    return asked.model_copy(update={"length": between(max(low, 0.0), max(high, SHORT_ROAD))})
