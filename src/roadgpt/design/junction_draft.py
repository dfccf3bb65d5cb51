"""Draws junctions at random, within the requirements for each."""

from collections.abc import Collection, Sequence
from itertools import pairwise
from math import ceil, pi
from typing import Literal, cast

import numpy as np

from roadgpt.brief.junction_check import ANGLES, FORK_GAPS, MOST_ARMS_OF_MINI
from roadgpt.brief.junctions import ARMS, SIDE, SIZES, JunctionKind, PlainKind, bends_as, is_about, side_of
from roadgpt.brief.model import JunctionClause, span
from roadgpt.brief.ranges import Range, overlap
from roadgpt.network import JunctionDesign
from roadgpt.network.design import ASTERN, ArmDesign
from roadgpt.network.growing import controls_of
from roadgpt.network.ring import BETWEEN, MOST_LANES, MOUTH, ring_width, smallest_radius

Rng = np.random.Generator
ANY: tuple[PlainKind, ...] = ("t_junction", "t_junction", "crossroads", "y_junction", "star")
"""The kinds from which a junction is drawn if none is required. T-junctions are twice as frequent."""

KERBS = (8.0, 14.0)  # m, radius of kerbs between neighbouring arms
TIGHT_KERB = 6.0  # m, where there is little room
STUBS = (20.0, 35.0)  # m, length of the arms on which the route does not go on
SHORT_STUB = 17.0  # m, where there is little room
STRAIGHT = 14.0  # degrees, greatest deviation of an arm that leads straight on
CLEAR = 40.0  # degrees, least turn of an arm to the left or right
SLIGHTEST = SIDE + 3  # degrees, least turn of such an arm where angles are required
ACROSS = 9.0  # degrees, greatest deviation of other arms of T-junctions and crossroads from 90 degrees
SLANTS = (48.0, 62.0)  # degrees, between two neighbouring arms of skew crossroads
FORK = (95.0, 145.0)  # degrees, between neighbouring arms of a Y-junction
MANY_ARMS = 5  # besides the arm of arrival; with so many, several arms may lead to the same side
STAR = 50.0  # degrees, least gap of a star junction
NARROW_STAR = 38.0  # degrees, least gap of a star junction where angles are required
EVEN = 3.0  # concentration of a Dirichlet distribution of the gaps; the larger, the more alike they are
USUALLY_MOST = 5.0  # arms of a roundabout at most, if no number is required
RING_GAP = 55.0  # degrees, least gap of a roundabout
ISLANDS = (12.0, 20.0)  # m, radius of the central island where no size is required
ROUNDS = 200  # draws of the arms of one junction


def drawn_junction(
    asked: JunctionClause, rng: Rng, haste: float, others: Collection[JunctionKind] = ()
) -> JunctionDesign | None:
    """Returns a random junction that meets its requirements; None if 200 draws found none. The larger
    ``haste``, from 0 to 1, the smaller the junction. If no kind is required, the kinds in ``others`` are
    avoided, provided that a T-junction or crossroads remains possible."""
    for _ in range(ROUNDS):
        kind = _kind(asked, rng, others)
        clause = asked.model_copy(update={"kind": kind})
        angles = [round(angle, 1) for angle in _angles(clause, rng)]
        taken = _taken(clause, angles, rng) if _has_ways(clause, angles) else None
        if taken is None:
            continue
        one_way = _one_way(clause, angles)
        if taken < len(angles) and one_way[taken]:
            continue
        least, most = STUBS[0] - haste * (STUBS[0] - SHORT_STUB), STUBS[1] - haste * (STUBS[1] - STUBS[0])
        arms = tuple(
            ArmDesign(
                angle=angle,
                # one-way arms are long, so that there is room for an arrow
                length=None
                if n == taken
                else round(most if one_way[n] else float(rng.uniform(least, most)), 1),
                control=clause.control if clause.all_way else None,
                one_way=one_way[n],
            )
            for n, angle in enumerate(angles)
        )
        radius = ceil(10 * _radius(clause, angles, rng, haste)) / 10
        if kind == "roundabout" and radius < smallest_radius(np.radians([-180.0, *angles]).tolist()):
            continue
        kerb = float(rng.uniform(*KERBS))
        drawn = JunctionDesign(
            after=1,  # whoever places the junction sets the number of segments before it
            kind=kind,
            take=taken + 1,
            control=clause.control or "none",
            kerb=round(kerb + haste * (TIGHT_KERB - kerb), 1),
            radius=radius,
            ring_lanes=_ring_lanes(clause),
            crosswalk=clause.crosswalk,
            arms=arms,
        )
        return _with_stops(drawn) if clause.others_stop else drawn
    return None


def _with_stops(junction: JunctionDesign) -> JunctionDesign:
    arms = tuple(
        arm.model_copy(update={"control": "stop"}) if control == "yield" else arm
        for arm, control in zip(junction.all_arms, controls_of(junction)[1:], strict=True)
    )
    return junction.model_copy(update={"arms": arms})


def _kind(asked: JunctionClause, rng: Rng, others: Collection[JunctionKind]) -> PlainKind:
    """Returns the kind of a junction; where the description names none, one of those that have its arms."""
    if asked.kind != "junction":
        return cast(PlainKind, asked.kind)
    arms = span(asked.arms)
    is_bent = asked.take in ("sharp_left", "sharp_right", "slight_left", "slight_right")
    fit = [kind for kind in ANY if not is_bent or kind in ("y_junction", "star")]
    kinds = [kind for kind in fit if arms.lo <= ARMS[kind].hi and arms.hi >= ARMS[kind].lo]
    if asked.ways:  # at crossroads, the roads that are not named would be one-way
        number = 1 + len({*asked.ways, *asked.only_in, *asked.only_out})
        kinds = [kind for kind in kinds if ARMS[kind].lo <= number <= ARMS[kind].hi] or kinds
    new = [kind for kind in kinds if kind not in others]
    kinds = new if {"t_junction", "crossroads"} & {*new} else kinds
    return kinds[int(rng.integers(len(kinds)))]


def _angles(clause: JunctionClause, rng: Rng) -> list[float]:
    """Returns the directions of the arms in degrees from the direction of arrival, from right to left."""
    if (across := _across(clause, rng)) is not None:
        angles = [across - 180, 0.0, across]
        left_out = _missing_arm(clause, rng) if clause.kind == "t_junction" else None
        return [angle for n, angle in enumerate(angles) if n != left_out]
    if clause.kind == "t_junction":
        missing = _missing_arm(clause, rng)
        usual = [angle for n, angle in enumerate((-90.0, 0.0, 90.0)) if n != missing]
        return [_near(angle, STRAIGHT if angle == 0 else ACROSS, rng) for angle in usual]
    if clause.kind == "crossroads":
        if clause.skew:
            slant = float(rng.uniform(*SLANTS)) * (1 if rng.random() < 0.5 else -1)
            return sorted([slant - 180 if slant > 0 else slant, 0.0, slant if slant > 0 else slant + 180])
        across = float(rng.uniform(90 - ACROSS, 90 + ACROSS))
        return [across - 180, _near(0.0, ACROSS / 2, rng), across]
    if clause.kind == "y_junction":
        gaps = FORK if clause.degrees is None and clause.angle is None else FORK_GAPS
        left, right = (float(gap) for gap in rng.uniform(*gaps, size=2))
        while not gaps[0] <= 360 - left - right <= gaps[1]:
            left, right = (float(gap) for gap in rng.uniform(*gaps, size=2))
        return [-180 + right, 180 - left]
    return _around(clause, rng)


def _missing_arm(clause: JunctionClause, rng: Rng) -> int:
    """Returns which of the ways to the right, straight on and to the left a T-junction does not have. "At the
    T-junction turn left" usually means that the road ends there; a priority road goes on."""
    drawn = int(rng.integers(3))
    ends = clause.take in ("left", "right") and not clause.ways and clause.control != "priority"
    return 1 if ends and not (clause.only_in or clause.only_out) else drawn


def _across(clause: JunctionClause, rng: Rng) -> float | None:
    """Returns the angle in degrees by which a road leads to the left from a T-junction or from crossroads at
    which an angle is required; None at others."""
    if clause.kind not in ("t_junction", "crossroads") or (clause.degrees or clause.angle) is None:
        return None
    asked = span(clause.degrees or clause.angle)
    low, high = ANGLES[clause.kind].lo, 180 - ANGLES[clause.kind].lo
    drawn = float(rng.uniform(max(asked.lo, low), max(asked.lo, low, min(asked.hi, high))))
    side = (clause.take or "").rpartition("_")[2]
    leaves = clause.degrees is not None or "straight" in clause.ways  # it turns by the angle, not by the rest
    is_left = side == "left" if leaves and side else rng.random() < 0.5
    return drawn if is_left else 180 - drawn


def _near(angle: float, most: float, rng: Rng) -> float:
    return angle + float(rng.uniform(-most, most))


def _around(clause: JunctionClause, rng: Rng) -> list[float]:
    """Returns the arms of a star junction or a roundabout, spread around it."""
    possible = Range(ARMS[clause.kind].lo, MOST_ARMS_OF_MINI) if clause.size == "mini" else ARMS[clause.kind]
    counts = overlap(possible, span(clause.arms)) or possible
    asked = span(clause.exit)
    if clause.take == "back" and clause.exit is not None:
        counts, asked = overlap(counts, asked) or counts, Range()
    fewest = max(counts.lo, min(asked.lo + 1, counts.hi))  # the last exit would lead back
    if clause.kind == "roundabout" and clause.arms is None and clause.take is not None:
        fewest = max(fewest, 4.0 if clause.take == "straight" else 3.0)
    most = counts.hi
    if clause.kind == "roundabout" and clause.arms is None:
        most = max(USUALLY_MOST, fewest)
    count = int(rng.integers(int(fewest), int(most) + 1))
    if clause.arms is None and clause.kind == "roundabout" and int(fewest) <= 4:
        count = 4 if rng.random() < 0.6 else count
    if count == 4 and clause.kind == "roundabout":
        return [_near(angle, ACROSS, rng) for angle in (-90.0, 0.0, 90.0)]
    least = STAR if clause.kind == "star" else RING_GAP
    if clause.kind == "star" and (clause.degrees or clause.angle) is not None:
        least = NARROW_STAR
    gaps = least + (360 - count * least) * rng.dirichlet(np.full(count, EVEN))
    return [-180 + float(angle) for angle in np.cumsum(gaps)[:-1]]


def _has_ways(clause: JunctionClause, angles: Sequence[float]) -> bool:
    """Returns whether no arm is too near to another, and all arms lead where they are required."""
    least = min(b - a for a, b in pairwise([-180.0, *angles, 180.0]))
    has_angle = clause.angle is None or is_about(least, clause.angle)
    unclear = [angle for angle in angles if STRAIGHT < abs(angle) < _clear(clause)]
    is_clear = clause.kind in ("roundabout", "star", "y_junction") or not unclear
    sides, asked = [side_of(angle) for angle in angles], (*clause.only_in, *clause.only_out)
    if clause.ways and clause.kind != "crossroads":
        has_ways = sorted([*clause.ways, *clause.only_in]) == sorted(sides)
    else:
        has_ways = {*clause.ways, *asked} <= {*sides}
    return least >= ASTERN + 1 and is_clear and has_ways and has_angle


def _clear(clause: JunctionClause) -> float:
    """Returns the least turn in degrees of an arm that leads to the left or right."""
    return CLEAR if clause.degrees is None and clause.angle is None else SLIGHTEST


def _one_way(clause: JunctionClause, angles: Sequence[float]) -> list[Literal["in", "out"] | None]:
    """Returns for each arm whether its traffic only drives to the junction, or only away from it. Where the
    ways on of crossroads are required, traffic only arrives on the other arms."""
    is_listed = clause.ways and clause.kind == "crossroads"
    into = {"left", "right", "straight"} - {*clause.ways} if is_listed else {*clause.only_in}
    sides = [side_of(angle) for angle in angles]
    return ["in" if side in into else "out" if side in clause.only_out else None for side in sides]


def _taken(clause: JunctionClause, angles: Sequence[float], rng: Rng) -> int | None:
    """Returns the index of the arm on which the route goes on; None if no arm will do. It is that of the last
    arm and one more if the route turns back at a roundabout."""
    count = len(angles)
    exits = span(clause.exit)
    if clause.take == "back":
        return count if clause.exit is None or count + 1 in exits else None
    allowed = [n for n in range(count) if n + 1 in exits]
    if clause.exit is not None and not allowed:
        return count if count + 1 in exits else None
    if clause.take is None:
        one_way = _one_way(clause, angles)
        allowed = [n for n in allowed if one_way[n] is None and _turns(clause, angles[n])]
        return allowed[int(rng.integers(len(allowed)))] if allowed else None
    taken = _towards(clause, angles)
    return taken if taken in allowed and _turns(clause, angles[taken]) else None


def _turns(clause: JunctionClause, angle: float) -> bool:
    return clause.degrees is None or is_about(abs(angle), clause.degrees)


def _towards(clause: JunctionClause, angles: Sequence[float]) -> int | None:
    take = clause.take
    if clause.kind == "y_junction":
        side = (take or "").removeprefix("slight_")
        found = {"left": len(angles) - 1, "right": 0}.get(side)
        return found if found is not None and bends_as(take, angles[found]) else None
    sides = [side_of(angle) for angle in angles]
    lefts = [n for n, angle in enumerate(angles) if angle > _clear(clause)]
    rights = [n for n, angle in enumerate(angles) if angle < -_clear(clause)]
    if take == "straight":
        ahead = [n for n, angle in enumerate(angles) if abs(angle) <= STRAIGHT]
        return ahead[0] if len(ahead) == 1 else None
    if take in ("left", "right") and clause.degrees is not None:
        same = [n for n, angle in enumerate(angles) if sides[n] == take and _turns(clause, angle)]
        return same[0] if same else None
    if take in ("left", "right"):
        same = lefts if take == "left" else rights
        if len(angles) >= MANY_ARMS:
            return min(same, key=lambda n: abs(abs(angles[n]) - 90), default=None)
        return same[0] if len(same) == 1 and sides.count(take) == 1 else None
    same = sorted(lefts if take in ("sharp_left", "slight_left") else rights, key=lambda n: abs(angles[n]))
    same = [n for n in same if bends_as(take, angles[n])]
    return (same[-1] if take in ("sharp_left", "sharp_right") else same[0]) if same else None


def _radius(clause: JunctionClause, angles: Sequence[float], rng: Rng, haste: float) -> float:
    if clause.kind != "roundabout":
        return ISLANDS[0]
    allowed = span(clause.radius)
    if clause.outer is not None:
        allowed = _island(span(clause.outer), _ring_lanes(clause))
    elif clause.size is not None:
        outer = SIZES[clause.size].drawn_in(0.5, 0.1)
        allowed = overlap(allowed, _island(outer, _ring_lanes(clause))) or allowed
    elif clause.radius is None:
        allowed = Range(*ISLANDS)
    gaps = [b - a for a, b in pairwise([-180.0, *angles, 180.0])]
    usual = (2 * MOUTH + BETWEEN) / (min(gaps) * pi / 180)
    low, high = max(allowed.lo, 3.0), min(allowed.hi, max(allowed.lo, 3.0) * 1.5 + 5)
    drawn = low + (high - low) * float(rng.random()) * (1 - haste)
    is_free = clause.radius is None and clause.outer is None
    return min(max(drawn, min(usual, high)), high) if is_free else drawn


def _ring_lanes(clause: JunctionClause) -> int:
    return 1 if clause.kind != "roundabout" or span(clause.lanes).lo <= 1 else MOST_LANES


def _island(outer: Range, lanes: int) -> Range:
    """Returns the radii of islands for outer diameters in metres and a ring with this number of lanes."""
    low, high = (each / 2 - ring_width(each / 2 - 5.0, lanes) for each in (outer.lo, outer.hi))
    return Range(low, high)
