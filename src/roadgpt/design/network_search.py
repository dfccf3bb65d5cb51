"""Searches for a network, a route through junctions or a map of roads, by random drafts until one fits on the
map and breaks no rule, and finds how large the map has to be.

Each road of a route is drafted like any road, and each junction is drawn within its requirements. A road
whose climb is required is made steeper, because its ends at junctions are level. The sketch of the whole is
checked first: nothing may overlap, and it must fit on the map.

A map is a grid, or junctions joined by roads, rotated and moved into a square with sides of ``map_size``,
with random heights and a random route. If the description says where the route turns, it takes these turns;
otherwise, it passes several junctions and turns to both sides where possible.

The rules must then accept the network that is built from the draft."""

import cmath
import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache, partial
from itertools import accumulate, islice, pairwise
from math import inf, sqrt
from typing import TypeVar

import numpy as np

from roadgpt import check
from roadgpt.brief.amount import Amount, at_least, between, exactly, span
from roadgpt.brief.design_speed import limits_at
from roadgpt.brief.junction_check import check_junction, faults_beside_ramps
from roadgpt.brief.junctions import LANE_KINDS, RAMPS, RINGS, JunctionClause, MapClause, side_of
from roadgpt.brief.map_fit import EDGE, LEADS
from roadgpt.brief.model import Brief, Clause, mirrored
from roadgpt.brief.normal import BUMPS
from roadgpt.brief.words import LARGEST_MAP, ROAD_LENGTH_SLACK, heading_from
from roadgpt.check.matching import length_range
from roadgpt.check.measures import measured_map
from roadgpt.design.advice import larger_map, main_reason
from roadgpt.design.elements import start_height
from roadgpt.design.junction_draft import (
    SHORT_ROAD,
    counted_from_lanes,
    drawn_change,
    drawn_junction,
    drawn_ramp,
    drawn_turn_length,
    lanes_of_roads,
    main_roads,
    with_roads_continued,
    with_side_of_change,
)
from roadgpt.design.layout import (
    MapPose,
    PlacedPlan,
    PlanLine,
    drawn_ground,
    first_that_fits,
    place,
    smallest_box,
)
from roadgpt.design.map_draft import (
    LEAST_BLOCK,
    MapDraft,
    Rng,
    can_be_carved,
    draft_carved,
    draft_grid,
    draft_village,
)
from roadgpt.design.network_sketch import sketched
from roadgpt.design.road_search import DraftSearch
from roadgpt.design.unbuilt import check_lanes_across
from roadgpt.design.variety import Shapes
from roadgpt.errors import BriefError, DesignError, RoadGPTError, UsageError
from roadgpt.language.names import Way
from roadgpt.network import build_route
from roadgpt.network.building import BESIDE, length_at_ramp, length_beside, length_of_turn_lanes
from roadgpt.network.growing import BEFORE_TURN_LANES, length_inside
from roadgpt.network.stretch import level_ends, profiles_between, refuse_other_lanes
from roadgpt.plural import plural
from roadgpt.road import Design, Profile, Segment, World
from roadgpt.road.design import (
    ACCELERATION,
    LanesDesign,
    MapNode,
    PlaceDesign,
    RampDesign,
    ends_route,
    vertical_curves_of,
)

LANES_DIFFER = (
    "at a junction, lanes of one road would lead nowhere or nothing would lead to them, because the roads "
    "have different numbers of lanes"
)
"""The reason why a draft fails if a lane does not continue at a junction (rule ``unreachable``)."""
RUN_TOGETHER = "two of its roads would meet where no junction is, and bridges cannot be built yet"
"""The reason why a draft fails if two roads overlap outside junctions (rule ``conflicting_overlap``)."""
REASONS = {"unreachable": LANES_DIFFER, "conflicting_overlap": RUN_TOGETHER}
NUMBER = re.compile(r"\d[\d.]*")
PLACE = re.compile(r"^at s = [\d.]+ m: | near \([^)]*\)")
"""Matches the place of a fault in a message; it is cut out, because the user never sees the draft."""


STEADY = 1.0  # percent; a road whose mean grade is less remains unchanged
ROUNDS = 4  # of steepening, since each round also makes the level ends a little longer
TENTH = 10.0  # per percentage point: grades are written to the tenth
DRAFTS = 400  # for one route, at most
DRAFTS_OF_LENGTH = 1200  # the same, if a length of the whole route is required
NO_HASTE = 12  # drafts without haste
STRETCHES = 12  # drafts of one road between junctions
HEIGHTS_ASKED = ("slope", "incline", "steepest", "climb", "hills", "hard")
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
TURNS_OF_FAST = 2.0  # times the shortest turn of a design speed more, for a road with one and such a turn
PARTS = 250.0  # m, side of the usual map
ROOM_TO_TURN = 20.0  # m of a road of required length that must remain beyond the lane of a ramp
TOO_LARGE, OVERLAPS, UNDRAFTED = "too large", "its roads would overlap", "one of its roads cannot be drafted"
NO_LENGTH = "the length that was asked for leaves too little for the roads between the junctions"
FOR_ROOM = (TOO_LARGE, OVERLAPS, UNDRAFTED)
"""Reasons for failure that may disappear on a larger map."""
Asked = TypeVar("Asked", Brief, Clause)
RoadDraft = tuple[DraftSearch, PlacedPlan]
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
    radius = segment.vertical_radius
    changed = {
        "incline": round(TENTH * segment.incline * factor) / TENTH,
        "vertical_radius": None if radius is None else math.floor(TENTH * radius / factor) / TENTH,
    }
    return segment.model_copy(update=changed)


def _fitted(segments: tuple[Segment, ...]) -> tuple[Segment, ...]:
    found = list(segments)
    for curve in vertical_curves_of(segments):
        asked = found[curve.number].vertical_radius
        if asked is not None and curve.radius < asked:
            fits = math.floor(TENTH * curve.radius) / TENTH
            found[curve.number] = found[curve.number].model_copy(update={"vertical_radius": fits})
    return tuple(found)


class _Search:
    """A search for a network. ``failed`` counts the drafts that failed for each reason, and ``boxes`` are the
    sides in metres of squares around those that were too large."""

    def __init__(self, brief: Brief, world: World, rng: np.random.Generator) -> None:
        self.brief, self.world, self.rng = brief, world, rng
        self.failed: Counter[str] = Counter()
        self.boxes: list[float] = []

    def _first_accepted(
        self, drafts: Iterable[Design | None], most: int, advice: Callable[[str], str]
    ) -> Design:
        """Returns the first draft whose route can be built and breaks no rule.

        A draft of None did not fit on the map, and is skipped; at most ``most`` drafts are built. Reasons for
        failure that differ only in places and numbers count together, under the first of them; so do findings
        of one rule. If none was accepted, raises DesignError with the advice for the most frequent reason."""
        reasons: dict[str, str] = {}
        for draft in islice((draft for draft in drafts if draft is not None), most):
            try:
                findings = check.inspect(build_route(draft, self.world), self.brief, self.world)
            except UsageError as error:
                why = PLACE.sub("", str(error))
                rule = NUMBER.sub("", why)
            else:
                if not findings:
                    return draft
                rule = findings[0].rule
                why = REASONS.get(rule) or PLACE.sub("", findings[0].sentence)
            self.failed[reasons.setdefault(rule, why)] += 1
        why, _ = max(self.failed.items(), key=lambda item: item[1], default=("nothing could be drafted", 0))
        raise DesignError(advice(why))


class NetworkSearch(_Search):
    """The search for one route."""

    is_modest = False
    """Whether drafts are level, and lanes beside ramps short, where nothing else is required."""
    tried = 40
    """Number of drafts in a search that tests whether the World's map is large enough."""

    def __init__(self, brief: Brief, world: World, rng: np.random.Generator) -> None:
        """Prepares the search. Raises BriefError if a junction cannot meet its requirements, and DesignError
        if lanes of a road would lead nowhere at a junction."""
        for clause in brief.junctions:
            check_junction(clause)
        super().__init__(with_roads_continued(brief), world, rng)
        self.has_wide_bends = main_roads(brief.junctions)
        self.usual = LanesDesign(width=world.section.lane_width)
        self.lanes = lanes_of_roads(brief, world.section.lane_width)
        self.has_usual_lanes = all(each == self.usual for each in self.lanes)
        self.others = Shapes().of(())
        check_lanes_across(brief.junctions, self.lanes)

    def run(self, drafts: int | None = None) -> Design:
        """Returns the first of up to ``drafts`` drafts that is accepted. None stands for the usual number,
        and as many modest drafts of a route with ramps if none of those was accepted. Raises DesignError if
        no draft was accepted, for the most frequent reason, or no road can have the required lanes."""
        is_trial = drafts is not None
        drafts = drafts or (DRAFTS if self.brief.length is None else DRAFTS_OF_LENGTH)
        least = HURRIED * max(len(self.brief.junctions) - 2, 0)
        calm = min(NO_HASTE, drafts // 3)
        hastes = [max(0.0, (n - calm) / (drafts - calm)) ** 0.5 for n in range(drafts)]
        tried = (self._draft(min(max(haste, least), 1.0)) for haste in hastes)
        try:
            return self._first_accepted(tried, BUILT, self._advice)
        except UsageError as error:  # no draft can have such lanes
            raise DesignError(str(error)) from error
        except DesignError:
            if self.is_modest or is_trial or not self.has_wide_bends:
                raise
            self.is_modest = True
            self.failed.clear()
            return self.run()

    def _draft(self, haste: float) -> Design | None:
        if (junctions := self._places(haste)) is None:
            return None
        if (drafts := self._stretches(junctions, haste)) is None:
            return None
        if (pose := self._place(drafts, junctions)) is None or (segments := self._segments(drafts)) is None:
            return None
        numbered = [
            junction.model_copy(update={"after": number})
            for junction, number in zip(junctions, accumulate(map(len, segments)), strict=False)
        ]
        driven = segments[:-1] if any(map(ends_route, junctions)) else segments
        every = tuple(segment for part in driven for segment in part)
        return Design(
            starting_point=(pose.x, pose.y, start_height(every, drawn_ground(self.world, self.rng))),
            theta=pose.theta,
            segments=every,
            junctions=tuple(numbered),
            lanes=None if self.has_usual_lanes else self.lanes[0],
        )

    @property
    def lacks_room(self) -> bool:
        """Whether most drafts failed for a reason that may disappear on a larger map."""
        return main_reason(self.failed) in FOR_ROOM

    def _places(self, haste: float) -> list[PlaceDesign] | None:
        found: list[PlaceDesign] = []
        # "five junctions, two of them forks" has no third fork
        named = {clause.kind for clause in self.brief.junctions}
        for number, clause in enumerate(self.brief.junctions):
            drawn: PlaceDesign | None
            if clause.kind in LANE_KINDS:
                around = self.brief.roads[number : number + 2]
                drawn = drawn_change(with_side_of_change(self.brief.junctions, number), around)
            elif clause.kind in RAMPS:
                drawn = drawn_ramp(clause, 0.0 if self.is_modest else self._room_beside(number))
            else:
                drawn = drawn_junction(self._asked_of(number), self.rng, haste, named)
            if drawn is None:
                is_small = clause.kind in RINGS and not (clause.take and clause.exit)
                why = "such an island is too small for so many arms" if is_small else "it has no such ways on"
                self.failed[f"{why} at a {clause.name}"] += 1
                return None
            if clause.turn_lanes:
                length = drawn_turn_length(clause, self.brief.roads[number], self.usual.width)
                drawn = drawn.model_copy(update={"turn_length": length})
            lanes = None if self.has_usual_lanes else self.lanes[number + 1]
            found.append(drawn.model_copy(update={"lanes": lanes}))
        return found

    def _asked_of(self, number: int) -> JunctionClause:
        """Returns what is required of a junction: a ring has as many lanes as its roads need, and the ramp is
        the stem of a T-junction at the end of a motorway's exit, if nothing else is said."""
        clause = self.brief.junctions[number]
        if clause.kind == "roundabout" and clause.lanes is None:
            most = max(max(each.forward, each.backward) for each in self.lanes[number : number + 2])
            return clause.model_copy(update={"lanes": exactly(most)}) if most > 1 else clause
        before = self.brief.junctions[number - 1] if number else None
        is_exit = before is not None and before.kind == "diverge" and before.take != "main"
        is_free = clause.take in ("left", "right") and not clause.ways and clause.angle is None
        if clause.kind != "t_junction" or not is_exit or not is_free:
            return clause
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

    def _stretches(self, junctions: Sequence[PlaceDesign], haste: float) -> list[RoadDraft] | None:
        """Returns a draft of each road between the junctions; None if one of them cannot be drafted. The
        roads of which nothing is required, or else those of which no length is, are drafted last: they make
        up the length of the whole route. If one is required, straight roads of any length do so too."""
        briefs = counted_from_lanes(self.brief, junctions, self.usual.width)
        rest = self._rest(junctions)
        free = [n for n, brief in enumerate(briefs) if brief.has_free_shape]
        if free and rest is not None:
            free = [n for n, brief in enumerate(briefs) if n in free or brief.is_straight_of_any_length]
        free = free or [n for n, brief in enumerate(briefs) if brief.length is None]
        wide = [length_of_turn_lanes(place, self.usual.width) for place in junctions]
        lasts = [each and each + BEFORE_TURN_LANES for each in (*wide, 0.0)]
        found: dict[int, RoadDraft] = {}
        for n in sorted(range(len(briefs)), key=lambda n: (n in free, n)):
            share = None
            if rest is not None and n in free:
                left = rest - sum(drafted.line.s[-1] for _, drafted in found.values())
                others = [each for each in free if each not in found]
                share = lasts[n] + (left - sum(lasts[each] for each in others)) / len(others)
                if share < max(SHORTEST, lasts[n]):
                    self.failed[NO_LENGTH] += 1
                    return None
            draft = self._stretch(_without_ramps(briefs[n], n, junctions), n, haste, share, lasts[n])
            if draft is None:
                self.failed[UNDRAFTED] += 1
                return None
            found[n] = draft
        return [found[n] for n in range(len(briefs))]

    def _shortest(self, n: int, haste: float) -> float:
        """Returns the least length in metres of a road of which no length is required. The larger ``haste``,
        from 0 to 1, the shorter a road with several lanes on which none ends, begins or is changed."""
        kinds = [place.kind for place in self.brief.junctions[max(n - 1, 0) : n + 1]]
        if self._lies_between_ramps(n):  # and beside those that the route does not take
            return BESIDE * ((kinds[0] == "diverge") + (kinds[1] == "merge")) + BETWEEN_RAMPS
        if any(kind in LANE_KINDS for kind in kinds):
            return SHORTEST_WITH_LANES
        return max(SHORTEST_WITH_LANES * (1 - haste), SHORTEST) if self.lanes[n].forward > 1 else SHORTEST

    def _lies_between_ramps(self, n: int) -> bool:
        kinds = [place.kind for place in self.brief.junctions[max(n - 1, 0) : n + 1]]
        return len(kinds) == 2 and all(kind in RAMPS for kind in kinds) and kinds != ["merge", "diverge"]

    def _rest(self, junctions: Sequence[PlaceDesign]) -> float | None:
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

    def _stretch(
        self, brief: Brief, n: int, haste: float, length: float | None, last: float
    ) -> RoadDraft | None:
        """Returns a draft of road number ``n`` between junctions; None if no draft was accepted. If a ramp
        joins or leaves the road, turns that are not required are sweeping. ``length`` is what the road should
        have in metres; None if it is open. The ``last`` metres, for turn lanes, are straight if they can be.
        """
        wanted, shortest = brief, max(self._shortest(n, haste), last)
        kinds = {place.kind for place in self.brief.junctions[max(n - 1, 0) : n + 1]}
        is_bare = not brief.clauses and brief.turns is None
        if length is not None:
            is_short = brief.speed is not None and length < limits_at(brief.speed).shortest_turn + LEADS
            turns = exactly(0) if (brief.motorway or is_short) and is_bare else brief.turns
            long = between(0.97 * length, 1.03 * length)
            wanted = brief.model_copy(update={"length": long, "turns": turns})
        elif brief.has_free_shape:
            wanted = self._open(haste, shortest, brief.motorway, brief.speed)
        elif brief.length is None and is_bare:
            free = self._open(haste, shortest, is_straight=True)
            own = free.length if brief.hills is None and brief.climb is None else None
            wanted = brief.model_copy(update={"length": own, "turns": free.turns})
        elif is_bare:
            is_straight = brief.motorway or self.rng.random() > CURVED * (1 - haste)
            wanted = brief.model_copy(update={"turns": exactly(0) if is_straight else at_least(1)})
        if n in self.has_wide_bends and brief.turns is None and wanted.turns not in (None, exactly(0)):
            wanted = wanted.model_copy(update={"sharpness": "sweeping"})
        # the level ends of a road with a ramp or a lane that changes are passed at full speed
        is_fast = brief.speed is not None and bool(kinds & {*RAMPS, *LANE_KINDS})
        if (is_fast and _leaves_heights_open(brief)) or (self.is_modest and _leaves_heights_open(wanted)):
            wanted = wanted.model_copy(update={"slope": "flat"})
        if self.is_modest and wanted.length is None:
            wanted = wanted.model_copy(update={"length": at_least(shortest)})
        tried = [wanted]
        if last and wanted.ends is None and wanted.turns != exactly(0):
            ends = Clause(kind="straight", length=at_least(last))
            tried.insert(0, wanted.model_copy(update={"ends": ends}))
        for search in (DraftSearch(each, self.world, self.others, self.rng) for each in tried):
            for _ in range(STRETCHES):
                if (found := search.stretch(haste, plain=span(wanted.length).lo < LONG)) is not None:
                    return search, found
        return None

    def _segments(self, drafts: Sequence[RoadDraft]) -> list[tuple[Segment, ...]] | None:
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

    def _open(
        self, haste: float, shortest: float, is_straight: bool = False, speed: float | None = None
    ) -> Brief:
        count = len(self.brief.roads)
        most = min(MOST, ROOM * self.world.site.map_size / PARTS / count)
        most = max(most, shortest)
        high = shortest + 5 + (most - shortest) * (1 - haste) * float(self.rng.random())
        if is_straight or self.rng.random() > CURVED * (1 - haste):
            return Brief(turns=exactly(0), length=between(shortest * (1 - 0.3 * haste), high), speed=speed)
        more = TURNING if speed is None else max(TURNING, TURNS_OF_FAST * limits_at(speed).shortest_turn)
        length = between(shortest, high + more)
        return Brief(turns=exactly(1), degrees=between(18, 70), length=length, speed=speed)

    def _place(self, drafts: Sequence[RoadDraft], junctions: Sequence[PlaceDesign]) -> MapPose | None:
        if any(map(ends_route, junctions)) and not self.brief.stretches[-1].is_open:
            self.failed["it turns back, so it cannot go on on another road"] += 1
            return None
        lines = [drafted.line for _, drafted in drafts]
        profiles = self._profiles(junctions, [float(line.s[-1]) for line in lines])
        sketch = sketched(lines, junctions, profiles)
        if sketch is None:
            self.failed[OVERLAPS] += 1
            return None
        z, reach = sketch
        line = PlanLine(np.arange(len(z), dtype=float), z)
        start = self.brief.comes_from and heading_from(self.brief.comes_from)
        pose = place(line, self.world, self.rng, reach, start)
        if pose is None:
            self.failed[TOO_LARGE] += 1
            self.boxes.append(smallest_box(line))
        return pose

    def _advice(self, why: str) -> str:
        size = self.world.site.map_size
        if why in FOR_ROOM and size < LARGEST_MAP:
            largest = self.world.changed(map_size=LARGEST_MAP)
            try:
                larger = NetworkSearch(self.brief, largest, self.rng)
                larger.is_modest = self.is_modest
                larger.run(TRIED_LARGER)
            except DesignError as error:  # room is not what it lacks
                return str(error)
        for n, road in enumerate(self.brief.roads):
            if (
                why == OVERLAPS
                and self._lies_between_ramps(n)
                and span(road.length).hi < self._shortest(n, 0)
            ):
                return (
                    f"beside the road between an exit and an entry, {road.length} m long, there is no room "
                    f"for their ramps; ask for {self._shortest(n, 0):g} m or more"
                )
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


def _leaves_heights_open(asked: Brief) -> bool:
    parts = (asked, *asked.clauses, *asked.both_ends)
    has_bump = any(clause.kind in BUMPS or clause.bump for clause in asked.clauses)
    return not has_bump and not any(getattr(part, name, None) for part in parts for name in HEIGHTS_ASKED)


def _without_ramps(asked: Brief, n: int, places: Sequence[PlaceDesign]) -> Brief:
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
    if asked.length is None:
        return asked
    low, high = span(asked.length).lo - less, span(asked.length).hi - less
    if asked.length.exact:
        low, high = low - slack * (low + less), high + slack * (high + less)
    return asked.model_copy(update={"length": between(max(low, 0.0), max(high, SHORT_ROAD))})


WALKS = 60  # number of random walks, of which the best is taken
PASSED = (3, 6)  # number of junctions that a route passes, where possible
LONG_ROUTE = 120.0  # m; a shorter route counts as worse
DRAFTS_OF_MAP = 200  # for one map, at most
BUILT_MAPS = 30  # drafts that fit and break a rule, after which the search is given up
PER_JUNCTION = 80.0  # m; n junctions fill a map whose side is this length times the square root of n
NO_HASTE_ON_MAP = 8  # drafts without haste
HURRIED_MAP = 0.12  # least haste for each junction beyond the first ``FEW``
FEW = 2.0  # number of junctions that need no haste on the usual map
ACROSS = 0.2  # side of the smallest map that is tried, as a share of the length of all its roads
WITHIN = 0.9  # where only one limit of a length is given, the other one is this share of it
LEANING = 14.0  # degrees, greatest rotation of a grid; its columns still run from south to north
TURNS = 24  # number of rotations that are tried
TIGHTEST = 1.05  # least radius of bends, as a multiple of the smallest radius allowed
CARVED = 0.7  # share of drafts with few dead ends that are carved out of a grid
LEVEL = 0.4  # share of maps that are level
TILT = 0.02  # ratio, greatest slope of the plane in which the nodes of a map lie


def drawn_route(draft: MapDraft, rng: Rng) -> list[int] | None:
    """Returns the numbers of the nodes along a random route from one end to another; None if none was found.
    If the map has fewer than two ends, the route leads from one junction to another, or to an end. No node is
    passed twice."""
    ends = [n for n, node in enumerate(draft.nodes) if node.kind == "end"]
    to_end = len(ends) > 1
    starts = ends if to_end else [n for n, node in enumerate(draft.nodes) if node.is_junction]
    if not starts:
        return None
    wanted = int(rng.integers(PASSED[0], PASSED[1] + 1))
    neighbours = draft.neighbours()
    walks = (
        _walk(draft, neighbours, starts[int(rng.integers(len(starts)))], wanted, to_end, rng)
        for _ in range(WALKS)
    )
    found = [walk for walk in walks if walk is not None]
    return max(found, key=lambda walk: _worth(draft, walk, wanted), default=None)


def named_route(draft: MapDraft, ways: Sequence[Way], rng: Rng) -> list[int] | None:
    """Returns the numbers of the nodes along a route that turns as ``ways`` says at its junctions, in order;
    None if there is no such route. It starts and finishes at ends where possible, and otherwise at junctions.
    No node is passed twice."""
    neighbours = draft.neighbours()
    starts = [n for n, node in enumerate(draft.nodes) if node.kind != "bend"]
    found = [walk for n in starts for walk in _named(draft, neighbours, [n], ways)]
    if not found:
        return None
    ends = [sum(draft.nodes[walk[n]].kind == "end" for n in (0, -1)) for walk in found]
    best = [walk for walk, number in zip(found, ends, strict=True) if number == max(ends)]
    return best[int(rng.integers(len(best)))]


def _named(
    draft: MapDraft, neighbours: Sequence[Sequence[int]], walk: list[int], ways: Sequence[Way]
) -> Iterator[list[int]]:
    here = draft.nodes[walk[-1]]
    is_first = len(walk) == 1
    if not is_first and not ways and here.kind != "bend":
        yield walk
        return
    if here.kind == "end" and not is_first:
        return
    passes = here.is_junction and not is_first
    for other in neighbours[walk[-1]]:
        if other in walk:
            continue
        if passes:
            z = [draft.nodes[n].z for n in (walk[-2], walk[-1], other)]
            if side_of(_degrees(z[0], z[1], z[2])) != ways[0]:
                continue
        yield from _named(draft, neighbours, [*walk, other], ways[1:] if passes else ways)


def _walk(
    draft: MapDraft, neighbours: Sequence[Sequence[int]], start: int, wanted: int, to_end: bool, rng: Rng
) -> list[int] | None:
    walk, passed = [start], 0
    while True:
        ways = [n for n in neighbours[walk[-1]] if n not in walk]
        if not ways:
            break
        walk.append(ways[int(rng.integers(len(ways)))])
        kind = draft.nodes[walk[-1]].kind
        if kind == "end":
            return walk
        if kind != "bend":
            if not to_end and passed == wanted:
                return walk
            passed += 1
    if to_end:
        return None
    while len(walk) > 1 and not draft.nodes[walk[-1]].is_junction:
        walk.pop()
    return walk if len(walk) > 1 else None


def _worth(draft: MapDraft, walk: Sequence[int], wanted: int) -> tuple[float, ...]:
    inner = [n for n in range(1, len(walk) - 1) if draft.nodes[walk[n]].is_junction]
    z = [draft.nodes[n].z for n in walk]
    sides = {side_of(_degrees(z[n - 1], z[n], z[n + 1])) for n in inner}
    length = sum(abs(b - a) for a, b in pairwise(z))
    near = -abs(len(inner) - wanted)
    turns = len(sides & {"left", "right"})
    return float(bool(inner)), float(length >= LONG_ROUTE), float(turns), float(near)


def _degrees(before: complex, here: complex, after: complex) -> float:
    return cmath.phase((after - here) / (here - before)) * 180 / cmath.pi


class MapSearch(_Search):
    """The search for one map."""

    tried = 24
    """Number of drafts in a search that tests whether the World's map is large enough."""

    def __init__(self, brief: Brief, world: World, rng: np.random.Generator) -> None:
        assert brief.map is not None
        super().__init__(brief, world, rng)
        self.asked = brief.map

    def run(self, drafts: int = DRAFTS_OF_MAP) -> Design:
        """Returns the first of up to ``drafts`` drafts that is accepted. Raises DesignError if none was, and
        UsageError if the World has lanes or superelevation that networks cannot have."""
        refuse_other_lanes(self.world)
        share = PARTS / self.world.site.map_size
        # without haste, many junctions would not fit on the map
        least = HURRIED_MAP * max(_least_count(self.asked) * share**2 - FEW, 0.0)
        hastes = (max(0.0, (n - NO_HASTE_ON_MAP) / (drafts / 2)) ** 0.5 for n in range(drafts))
        tried = (self._draft(min(max(haste, least), 1.0)) for haste in hastes)
        return self._first_accepted(tried, BUILT_MAPS, self._advice)

    @property
    def lacks_room(self) -> bool:
        """Whether drafts were too large for the map, so that a larger one may help."""
        return self.failed[TOO_LARGE] > 0

    def _draft(self, haste: float) -> Design | None:
        world = self.world
        room = world.site.map_size - world.section.road_width - 2 * EDGE
        radius = TIGHTEST * world.limits.min_radius
        if self.asked.junctions:
            is_carved = can_be_carved(self.asked) and self.rng.random() < CARVED
            draft = (
                draft_carved(self.asked, room, radius, self.rng, haste)
                if is_carved
                else draft_village(self.asked, world, radius, self.rng, haste)
            )
            turns = self.rng.uniform(0, 360, TURNS)
        else:
            draft = draft_grid(self.asked, room, radius, self.rng, haste)
            turns = self.rng.uniform(-LEANING, LEANING, TURNS) * np.linspace(1, 0, TURNS)
        length = self.brief.length
        if draft is None or (length is not None and not self._stretch(draft, length)):
            self.failed["its roads would overlap or bend too much"] += 1
            return None
        found = first_that_fits(draft.corners(), turns, room)
        if found is None:
            self.failed[TOO_LARGE] += 1
            return None
        turn, left, low, width, height = found
        spin = np.exp(1j * np.radians(turn))
        border = (world.site.map_size - room) / 2
        x, y = (
            border - edge + float(self.rng.random()) * max(room - size, 0.0)
            for edge, size in ((left, width), (low, height))
        )
        for node in draft.nodes:
            moved = node.z * spin + complex(x, y)
            node.z = complex(round(moved.real, 2), round(moved.imag, 2))
        ways = self.asked.route
        route = named_route(draft, ways, self.rng) if ways else drawn_route(draft, self.rng)
        if route is None:
            which = f"no route {', '.join(ways)}" if ways else "no route"
            self.failed[f"{which} leads through it"] += 1
            return None
        return _design(draft, self._heights(draft, haste), route)

    def _stretch(self, draft: MapDraft, length: Amount) -> bool:
        """Makes a draft larger or smaller, so that all its roads together have the required length. Only the
        roads between its nodes change: junctions and the radii of bends stay as they are. Returns whether the
        draft can be built, which shows how long its roads are."""
        route = drawn_route(draft, self.rng)
        if route is None:
            return False
        try:
            flat = _design(draft, [0.0] * len(draft.nodes), route)
            built = measured_map(build_route(flat, self.world).network).length
        except UsageError:
            return False
        asked = length_range(length)
        if built not in asked:
            low = asked.lo if asked.lo > 0 else WITHIN * asked.hi
            wanted = (low + min(asked.hi, low / WITHIN)) / 2
            between = sum(abs(draft.nodes[one].z - draft.nodes[other].z) for one, other in draft.roads)
            for node in draft.nodes:
                node.z *= (between + wanted - built) / between
        return True

    def _heights(self, draft: MapDraft, haste: float) -> list[float]:
        ground = drawn_ground(self.world, self.rng)
        tilt = TILT * (1 - haste) * float(self.rng.random()) if self.rng.random() > LEVEL else 0.0
        way = np.exp(2j * np.pi * self.rng.random())
        along = np.array([(node.z * way).real for node in draft.nodes])
        return [round(float(each), 2) for each in ground + tilt * (along - along.min())]

    def _advice(self, why: str) -> str:
        size = self.world.site.map_size
        if why == TOO_LARGE:
            fewer = "junctions" if self.asked.junctions else "or shorter blocks"
            larger = ", or give a larger map with --map-size" if size < LARGEST_MAP else ""
            return f"this map of roads found no place on a map of {size:g} m; ask for fewer {fewer}{larger}"
        return f"no draft of this map was accepted: {why}; leave something out or give other numbers"


def _design(draft: MapDraft, heights: Sequence[float], route: Sequence[int]) -> Design:
    nodes = []
    for node, height in zip(draft.nodes, heights, strict=True):
        own = {"control": node.control, "kerb": node.kerb} if node.is_junction else {}
        at = (node.z.real, node.z.imag, height)
        nodes.append(MapNode.model_validate({"at": at, "kind": node.kind, "radius": node.radius, **own}))
    return Design(
        starting_point=(0.0, 0.0, 0.0),
        theta=0.0,
        segments=(),
        nodes=tuple(nodes),
        roads=tuple((one + 1, other + 1) for one, other in draft.roads),
        route=tuple(number + 1 for number in route),
    )


def _likely_room(asked: MapClause, length: Amount | None) -> float:
    """Returns the side in metres of a square that a map of roads may just fit into."""
    if asked.junctions:
        usual = PER_JUNCTION * sqrt(_least_count(asked))
    else:
        block = span(asked.length).lo
        blocks = max(span(asked.columns).lo, span(asked.rows).lo, 1.0)
        usual = blocks * (block if 0 < block < inf else LEAST_BLOCK)
    return max(usual, ACROSS * max(span(length).lo, 0.0))


def _least_count(asked: MapClause) -> float:
    return sum(max(span(each.count).lo, 1.0) for each in asked.junctions)


TRIALS = (1, 2)  # seeds of the short searches that test whether a map is large enough
USUAL_ROAD = 90.0  # m, assumed length of a road whose length is not required
DIAGONAL = 1.25  # greatest length of a straight route, as a multiple of the side of the map
WINDING = 3.5  # greatest length of a route with turns, as a multiple of the side of the map
EDGES = 40.0  # m, kept free at the edges of the map


def draft_network(brief: Brief, world: World, rng: np.random.Generator) -> Design:
    """Returns a valid route that meets the Brief, or a valid map of roads if the Brief asks for a map. Raises
    DesignError if no draft was accepted, BriefError if a junction cannot meet its requirements, and
    UsageError if the World has lanes or banked bends that a map of roads cannot have."""
    # traffic on the left is the mirror image of traffic on the right
    made = _search(mirrored(brief) if brief.left_hand else brief, world, rng).run()
    return made.mirrored(world.site.map_size / 2) if brief.left_hand else made


def _search(brief: Brief, world: World, rng: np.random.Generator) -> NetworkSearch | MapSearch:
    for fault in faults_beside_ramps(brief):
        raise BriefError(fault)
    return (NetworkSearch if brief.map is None else MapSearch)(brief, world, rng)


@lru_cache(maxsize=256)
def room_for_network(brief: Brief, world: World) -> float | None:
    """Returns the side in metres of a map that is large enough for a network; None if the World's map is
    large enough, or if no larger map would help."""
    if brief.map is not None:
        likely = _likely_room(brief.map, brief.length)
    else:
        brief = mirrored(brief) if brief.left_hand else brief  # drafts are made with traffic on the right
        total = sum(map(_least, (brief, *brief.roads)))
        likely = max(_straightest(brief) / DIAGONAL + EDGES, total / WINDING)
    try:
        failed = _failed(brief, world) if likely <= world.site.map_size else None
        if likely <= world.site.map_size and (failed is None or not failed.lacks_room):
            return None
        found = larger_map(brief, world, _failed, likely)
        if found is None and main_roads(brief.junctions):
            return larger_map(brief, world, partial(_failed, is_modest=True), likely)
        return found
    except RoadGPTError:  # the design itself refuses what cannot be built, with its reason
        return None


def _failed(brief: Brief, world: World, is_modest: bool = False) -> NetworkSearch | MapSearch | None:
    for seed in TRIALS:
        search = _search(brief, world, np.random.default_rng(seed))
        if isinstance(search, NetworkSearch):
            search.is_modest = is_modest
        try:
            search.run(search.tried)
        except DesignError:
            return search
    return None


def _straightest(brief: Brief) -> float:
    """Returns the length in metres of the longest part of a route that must be nearly straight: straights of
    required length, and roads joined by ramps or by places where lanes change."""
    longest, run = 0.0, 0.0
    for passed, road in zip((None, *brief.junctions), brief.roads, strict=True):
        is_beside = passed is not None and passed.kind in (*RAMPS, *LANE_KINDS)
        if not is_beside:
            run = 0.0
        elif passed is not None and passed.kind in RAMPS:
            run += length_at_ramp(drawn_ramp(passed, ACCELERATION))
        run += _least(road) or USUAL_ROAD
        straights = [span(each.length).lo for each in road.clauses if each.kind == "straight"]
        straights += [_least(road)] if road.turns is not None and span(road.turns).hi == 0 else []
        longest = max(longest, run if is_beside else 0.0, *(s for s in straights if s < inf), 0.0)
    return longest


def _least(brief: Brief) -> float:
    low = span(brief.length).lo
    return low if 0 < low < inf else 0.0
