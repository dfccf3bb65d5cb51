"""Requires crests and dips to cause a vertical acceleration of the car of at most 3 m/s^2.

The vertical radius R of the parabola between two grades is 1 / (change of grade per metre). At speed v, the
vertical acceleration is v^2 / R. Where the description asks for a crest or a dip, accelerations of up to 1 g
are allowed; beyond that, the wheels would lose contact with the road.

v is the speed expected at this place: the car starts from rest, respects the speed limit and slows down only
for bends (``road.speed_profile.expected_speed``). A route is checked as one road, so the turns at its
junctions limit the speed. On every other road the car starts from rest. Sources:
``docs/decisions/0028-vertical-radii.md``."""

import numpy as np

from roadgpt.brief.model import Brief
from roadgpt.brief.normal import BUMPS
from roadgpt.brief.outline import outline
from roadgpt.check.extremes import vertical_bends
from roadgpt.check.finding import Finding, road_finding, single_road
from roadgpt.check.measures import measure
from roadgpt.geometry import GradeProfile
from roadgpt.network import Network, legs_of
from roadgpt.road import Road, World
from roadgpt.road.speed_profile import GRAVITY, expected_speed

CURVE = 30.0  # m by which a parabola may reach from its straight into the turns at its ends
MOST = 3.0  # m/s^2
STEP = 1.0  # m between the stations at which the expected speed is computed
ROUNDING = 1e-3  # of the limit


def asks_for_bumps(brief: Brief | None) -> bool:
    """Returns whether the description asks for a crest, a dip or a hump anywhere."""
    if brief is None:
        return False
    return any(clause.bump or clause.kind in BUMPS for clause in (*brief.clauses, *brief.both_ends))


def bumps_asked(road: Road, brief: Brief | None) -> list[tuple[float, float]]:
    """Returns the start and end stations, in metres, of the parts of a road where a crest, a dip or a hump is
    requested.

    A part reaches from one turn to the next, or to an end of the road, and 30 m into the turns beside it;
    where the crest lies in a turn, from 30 m before to 30 m behind the turn. If the description does not fix
    the number of turns before a crest, dip or hump, all such parts are returned."""
    if brief is None or not asks_for_bumps(brief):
        return []
    found = measure(road.centreline())
    begins = [0.0, *(turn.end - CURVE for turn in found.turns)]
    ends = [*(turn.start + CURVE for turn in found.turns), road.length]
    parts = list(zip(begins, ends, strict=True))
    for number, turn in enumerate(found.turns):  # each between the two parts beside it
        parts.insert(2 * number + 1, (turn.start - CURVE, turn.end + CURVE))
    gaps, turns, wanted = range(0, len(parts), 2), range(1, len(parts), 2), set[int]()
    for end, at in ((brief.starts, 0), (brief.ends, -1)):
        if end and (end.bump or end.kind in BUMPS):
            wanted |= {*(turns if end.bump else gaps)[at:][:1]}
    for index, clause in enumerate(brief.clauses):
        before, behind = _turns_before(brief, index), _turns_before(brief, index + 1)
        if clause.bump:
            wanted |= {*turns[before:behind]}
        elif clause.kind in BUMPS:
            wanted |= {*(gaps if before is None else gaps[min(before, len(gaps) - 1) :][:1])}
    return [parts[number] for number in sorted(wanted)]


def _turns_before(brief: Brief, index: int) -> int | None:
    if not outline(brief).names_all_turns:
        return None
    before = outline(brief.model_copy(update={"clauses": brief.clauses[:index]})).groups
    counts = [(group.lo, group.hi) for group in before if group.feature.kind == "turn"]
    return sum(lo for lo, _ in counts) if all(lo == hi for lo, hi in counts) else None


def inspect(network: Network, route: Road | None, brief: Brief | None, world: World) -> tuple[Finding, ...]:
    """Reports the crest or dip that exceeds its limit by the largest factor, on the route and on each other
    road."""
    found, driven = [], set[int]()
    if route is not None:
        driven = {leg.road for leg in legs_of(route, world)}
        asked = None if single_road(route) is None else brief  # of a route, each road has clauses of its own
        if (abrupt := abrupt_place(route, asked, world)) is not None:
            s, what = abrupt
            x, y = route.at(s)[:2].tolist()
            found.append(Finding("too_abrupt", f"at s = {s:.0f} m: {what}", s, x, y))
    for member in network.plain_roads:
        heights = member.road.elevation
        if member.id in driven or (isinstance(heights, GradeProfile) and not any(heights.grades)):
            continue
        if (abrupt := abrupt_place(member.road, None, world)) is not None:
            found.append(road_finding("too_abrupt", route, member, *abrupt))
    return tuple(found)


def abrupt_place(road: Road, brief: Brief | None, world: World) -> tuple[float, str] | None:
    """Returns the station in metres of the crest or dip that exceeds its limit by the largest factor, and
    what is wrong there; None if there is none."""
    begin, end, bend = vertical_bends(road)
    suspects = np.flatnonzero(np.abs(bend) * world.limits.speed_limit**2 > MOST * (1 + ROUNDING))
    if not suspects.size:
        return None
    s = np.linspace(0.0, road.length, max(1, round(road.length / STEP)) + 1)
    speed = expected_speed(road.curvature(s), road.grade(s), float(s[1]), world, road.profile)
    inside = (speed[(s > begin[i]) & (s < end[i])].max(initial=0.0) for i in suspects)
    at_ends = np.interp(np.stack((begin[suspects], end[suspects])), s, speed).max(axis=0)
    fastest = np.maximum(at_ends, np.fromiter(inside, float))
    felt = fastest**2 * np.abs(bend[suspects])
    if felt.max() <= MOST * (1 + ROUNDING):
        return None
    middle = (begin[suspects] + end[suspects]) / 2
    spans = bumps_asked(road, brief)
    most = np.array([GRAVITY if any(a <= s <= b for a, b in spans) else MOST for s in middle.tolist()])
    worst = int((felt / most).argmax())
    if felt[worst] <= most[worst] * (1 + ROUNDING):
        return None
    what, radius = "crest" if bend[suspects[worst]] < 0 else "dip", 1 / abs(bend[suspects[worst]])
    return float(middle[worst]), (
        f"the vertical radius of the {what} is {radius:.1f} m, which is {felt[worst]:.1f} m/s2 at the "
        f"{3.6 * fastest[worst]:.0f} km/h expected there; {fastest[worst] ** 2 / most[worst]:.0f} m would be "
        f"enough for {most[worst]:.3g} m/s2"
    )
