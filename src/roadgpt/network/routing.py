"""Finds routes through a network: over named roads, from one point to another, or drawn at random.

A route leads from the start of its first road to the end of its last one. It changes lanes as rarely as
possible, only where the marking may be crossed, and only on roads that are long enough for that. It leads
along no part of a lane that is too narrow for a car, such as the beginning of a turn lane."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from heapq import heappop, heappush
from itertools import groupby

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.network.lanes import Cost, Lane, Lanes, cheapest
from roadgpt.network.network import Leg

CHANGE = 30.0  # m of road for each change of lanes
LEAST = 2.0  # m; where a lane is narrower, no route leads along it
NEAR = 10.0  # m; a point farther away from all lanes is on no road
LENGTHS = (150.0, 100.0)  # m; a route that is drawn at random has at least the first, else the second
LONGEST = 2_000.0  # m, of such a route
PLACES = 9  # at which the width of half a lane is looked at
TRIES = 40  # drawn starts for each route that is wanted
State = tuple[Leg, int]
"""A lane, and how many of the named roads the route has reached, or 0 if none are named."""


def over_roads(lanes: Lanes, roads: Sequence[Sequence[int]]) -> tuple[Leg, ...]:
    """Returns the route over roads in this order, each given by the ids of its parts; the roads inside
    junctions and on rings of roundabouts are found. Raises UsageError if no way leads from one road to the
    next."""
    named = [set(each) for each in roads]
    for number, own in enumerate(named):
        if any(lanes.network.road(each).junction is not None for each in own):
            raise UsageError(f"road {number + 1} of the route is inside a junction; name roads outside")
    reached = 0

    def onward(state: State, lane: Leg) -> State | None:
        nonlocal reached
        place = state[1]
        if lane.road in named[place] or lanes.by_id[lane].member.junction is not None:
            return lane, place
        if place + 1 < len(named) and lane.road in named[place + 1]:
            reached = max(reached, place + 1)
            return lane, place + 1
        return (lane, place) if lane.road in lanes.network.roundabout_of else None

    starts = [(lane.id, 0) for lane in _driving(lanes) if lane.id.road in named[0]]
    goals = {(lane.id, len(named) - 1) for lane in lanes if lane.id.road in named[-1]}
    found = _shortest(lanes, starts, goals, onward)
    if found is None:
        raise UsageError(f"no way leads on from road {reached + 1} of the route to the next; name others")
    return found


def between(lanes: Lanes, start: tuple[float, float], goal: tuple[float, float]) -> tuple[Leg, ...]:
    """Returns the route from the road at one point to the road at another, x and y in metres, in whichever
    directions of traffic are shortest. Raises UsageError if a point is on no road, or no way leads there."""
    starts, goals = ({(lane, 0) for lane in _near(lanes, point)} for point in (start, goal))
    if (found := _shortest(lanes, starts, goals)) is None:
        raise UsageError("no way leads from the one point to the other; exchange them, or give others")
    return found


def random_routes(lanes: Lanes, count: int, seed: int) -> list[tuple[Leg, ...]]:
    """Returns up to ``count`` different routes of 150 to 2,000 m through a junction, or of 100 m at least; if
    none leads through a junction, without one; and if the network has none of 100 m, as long as possible. The
    same seed gives the same routes."""
    rng = np.random.default_rng(seed)
    plain = [lane for lane in _driving(lanes) if lane.member.junction is None]
    outside = [lane for lane in plain if lane.id.road not in lanes.network.roundabout_of] or plain
    goals = {lane.id for lane in outside}
    found = dict[tuple[int, ...], tuple[Leg, ...]]()
    for through, lengths in ((True, LENGTHS), (False, LENGTHS), (False, (0.0,))):
        for least in lengths if not found else ():
            for _ in range(TRIES * count if outside else 0):
                if len(found) == count:
                    break
                start = outside[int(rng.integers(len(outside)))].id
                reached = [each for each in _reached(lanes, start, LONGEST) if each[0] in goals]
                most = max((metres for _, metres, _ in reached), default=0.0)
                ends = [each for each in reached if each[1] >= (least or most) and each[2] >= through]
                if ends:
                    goal = ends[int(rng.integers(len(ends)))][0]
                    way = _shortest(lanes, [(start, 0)], {(goal, 0)})
                    if way is not None and _length(lanes, way) <= LONGEST:
                        found.setdefault(tuple(dict.fromkeys(leg.road for leg in way)), way)
    return list(found.values())


def _driving(lanes: Lanes) -> Iterator[Lane]:
    return (lane for lane in lanes if lane.kind == "driving")


def _near(lanes: Lanes, point: tuple[float, float]) -> set[Leg]:
    import shapely

    outside = [lane for lane in _driving(lanes) if lane.member.junction is None]
    away = shapely.distance(shapely.Point(point), [lane.area for lane in outside])
    if not len(away) or away.min() > NEAR:
        raise UsageError(f"there is no road within {NEAR:g} m of ({point[0]:g}, {point[1]:g})")
    nearest = {outside[n].id.road for n in np.flatnonzero(away <= away.min() + 1e-6)}
    return {lane.id for lane in outside if lane.id.road in nearest}


def _length(lanes: Lanes, way: Sequence[Leg]) -> float:
    return sum(lanes.network.road(number).road.length for number, _ in groupby(leg.road for leg in way))


def _steps(lanes: Lanes, lane: Leg) -> Iterator[tuple[Leg, float, float]]:
    """Yields the lanes to which one can go on from a lane, with the number of changes and the metres. Lanes
    are changed in the middle of a road."""
    own = lanes.by_id[lane]
    for each in own.successors if _is_wide(own, 0.5, 1.0) else ():
        if _is_wide(lanes.by_id[each], 0.0, 0.5):
            yield each, 0.0, own.length
    if own.member.junction is None and own.length >= CHANGE:
        for beside, may in ((own.left, own.may_change_left), (own.right, own.may_change_right)):
            if beside is not None and may:
                yield beside, 1.0, 0.0


def _is_wide(lane: Lane, start: float, end: float) -> bool:
    """Returns whether a car has room in a lane between two shares of its length."""
    return float(lane.width(lane.length * np.linspace(start, end, PLACES)).min()) >= LEAST


def _shortest(
    lanes: Lanes,
    starts: Iterable[State],
    goals: set[State],
    onward: Callable[[State, Leg], State | None] = lambda _, lane: (lane, 0),
) -> tuple[Leg, ...] | None:
    def steps(here: State) -> Iterator[tuple[State, Cost]]:
        for lane, changes, metres in _steps(lanes, here[0]):
            if (there := onward(here, lane)) is not None:
                yield there, (changes, metres)

    way = cheapest(
        (state for state in starts if _is_wide(lanes.by_id[state[0]], 0.0, 0.5)),
        lambda here: here in goals and _is_wide(lanes.by_id[here[0]], 0.5, 1.0),
        steps,
    )
    return None if way is None else tuple(lane for lane, _ in way)


def _reached(lanes: Lanes, start: Leg, most: float) -> list[tuple[Leg, float, bool]]:
    """Returns the lanes that are reached from a lane without changes of lane, with the metres to their ends,
    up to ``most``, and whether the way leads through a junction."""
    found, waiting = dict[Leg, tuple[float, bool]](), [(lanes.by_id[start].length, start, False)]
    while waiting:
        metres, lane, through = heappop(waiting)
        if lane in found or metres > most:
            continue
        found[lane] = metres, through or lanes.by_id[lane].member.junction is not None
        for each, changes, _ in _steps(lanes, lane):
            if not changes:
                heappush(waiting, (metres + lanes.by_id[each].length, each, found[lane][1]))
    return [(lane, *said) for lane, said in found.items()]
