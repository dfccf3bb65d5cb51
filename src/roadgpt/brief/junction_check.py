"""Finds contradictions and impossible requirements in the junctions of a Brief, and says what to change."""

from collections.abc import Iterator
from itertools import product
from math import isfinite

from roadgpt.brief.amount import meets, span
from roadgpt.brief.junctions import (
    ACROSS,
    ARMS,
    BENDS,
    FORMS,
    RAMPS,
    RINGS,
    SIZES,
    SKEW,
    TAKES,
    JunctionClause,
    MapClause,
    is_about,
)
from roadgpt.brief.model import Brief
from roadgpt.brief.plan import junction_plan, map_plan
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import ROAD_LENGTH_SLACK
from roadgpt.errors import BriefError
from roadgpt.language.names import JunctionKind
from roadgpt.language.table import PARTS, ROADS

MOST_BLOCKS = 8
MOST_OF_KIND = 12
MOST_ARMS_OF_MINI = 4  # with more, kerbs between them would have radii below 3 m
CIRCULATORY = 10.0  # m, about: the outer diameter of a roundabout minus the diameter of its island
LEAST_BESIDE_RAMP = 28.0  # m; source: the rule ``ramp_too_short``
LEAST_LANE = 17.0  # m, before the taper; with the wide part of a taper of 60 m, these are the required 28 m
LEAST_NARROW = 8.0  # m, of the lane, where it has less than 0.9 of its width, if no taper is required
WIDE_IN_TAPER = 0.196  # of the taper: the share in which the lane is still wider than 0.9 of its full width


ANGLES, TURNS = (
    dict[JunctionKind, Range](
        (kind, Range(*row[name])) for kind, row in ROADS["junctions"].items() if name in row
    )
    for name in ("angles", "turns")
)
"""Ranges in degrees of the smallest angle between two arms of a junction, and of that by which a route can
turn left or right there."""
FORMED = {**ROADS["forms"], **ROADS["forms_of_plans"]}
"""What can be asked of each form."""
TURN_LENGTHS = Range(15, 300)
"""The lengths in metres in which a turn lane can have more than 0.9 of its width: at least two waiting cars
(AASHTO, A Policy on Geometric Design of Highways and Streets, 2018, section 9.7)."""
FORK_GAPS = (87.0, 153.0)  # degrees between neighbouring arms of a fork for which an angle is required


def faults_of_network(brief: Brief) -> Iterator[str]:
    """Yields how the junctions and lanes of a route, or the map, contradict themselves or cannot be built, as
    sentences that say what to change."""
    for junction in brief.junctions:
        yield from faults_of_junction(junction)
    backs = [n for n, junction in enumerate(brief.junctions) if junction.take == "back"]
    if backs and (backs[0] < len(brief.junctions) - 1 or not brief.stretches[-1].is_open):
        name = brief.junctions[backs[0]].name
        yield f"a route that turns back at a {name} ends on the road on which it came; leave out the rest"
    yield from _faults_of_lanes(brief)
    if brief.map is not None and not brief.junctions:
        yield from _faults_of_map(brief.map)


def check_junction(junction: JunctionClause) -> None:
    """Raises BriefError if a junction cannot meet its requirements; the message says what to change."""
    if fault := next(faults_of_junction(junction), ""):
        raise BriefError(fault)


def faults_of_junction(junction: JunctionClause) -> Iterator[str]:
    """Yields why a junction cannot meet its requirements, as sentences that say what to change."""
    name, possible, take = junction.name, ARMS[junction.kind], junction.take
    arms = overlap(possible, span(junction.arms)) or possible
    if arms.lo > arms.hi:
        yield f"a {name} has {possible} arms, not {junction.arms}; change one of them"
    if take == "back" and junction.kind not in RINGS:
        yield f"one cannot turn back at a {name}, only at a roundabout or a turning circle; leave it out"
    ways, is_any = TAKES[junction.kind], "back" in TAKES[junction.kind]
    if ways and not is_any and take is not None and take not in (*ways, "back"):
        yield f"at a {name} one can go {' or '.join(ways)}, not {take}; change one of them"
    if junction.exit is not None and not meets(junction.exit, Range(1, arms.hi)):
        yield (
            f"a {name} with {arms} arms has no exit {junction.exit}; its last exit leads back to where one"
            " came from"
        )
    if junction.size is not None and not _is_as_wide(junction, SIZES[junction.size]):
        size = SIZES[junction.size]
        yield f"a {junction.size} {name} is {size} m across; leave out its size, or the number"
    if junction.turn_lanes or junction.turn_length:
        yield from _faults_of_turn_lanes(junction)
    is_possible = _is_ring_possible(junction, arms) and _are_signs_possible(junction)
    is_possible = is_possible and _are_ways_possible(junction) and _are_one_way_arms_possible(junction)
    if not (is_possible and _has_only_its_fields(junction) and _are_angles_possible(junction)):
        asked = junction_plan(junction)
        yield f"no {name} can be built as '{asked}' asks; leave some of it out"


def _faults_of_turn_lanes(junction: JunctionClause) -> Iterator[str]:
    sides, kind = {*junction.turn_lanes}, junction.kind
    ways = {*(junction.ways or TAKES[kind])} - {*junction.only_in}
    if kind not in ("t_junction", "crossroads"):
        yield f"turn lanes are built at T-junctions and crossroads, not at a {junction.name}; leave them out"
    elif not sides or len(sides) < len(junction.turn_lanes) or "straight" in sides:
        yield "turn lanes are turn_lane=left, right or left+right, and turn_len= is their length; change it"
    elif lost := sorted(sides - ways):
        yield f"no road leads to the {lost[0]} there, so leave the turn lane to the {lost[0]} out"
    elif sides == ways or (kind == "t_junction" and len(sides) + len(junction.only_in) > 1):
        yield (
            f"the other lanes would lead nowhere at a {junction.name} with turn lanes to the"
            f" {' and '.join(junction.turn_lanes)}; ask for fewer turn lanes or for more ways on"
        )
    if not meets(junction.turn_length, TURN_LENGTHS):
        yield f"a turn lane is {TURN_LENGTHS} m long, not {junction.turn_length} m; change it"


def _has_only_its_fields(junction: JunctionClause) -> bool:
    usual, its = JunctionClause(kind=junction.kind), FORMED[FORMS[junction.kind]]
    others = (name for name in PARTS["junction"] if name not in ("take", *its))
    is_way = junction.take in (None, "back") or junction.take in TAKES[junction.kind]
    return is_way and all(getattr(junction, name) == getattr(usual, name) for name in others)


def _is_as_wide(junction: JunctionClause, size: Range) -> bool:
    """Returns whether the diameters of a roundabout go with the word for its size."""
    island = Range((size.lo - CIRCULATORY) / 2, (size.hi - CIRCULATORY) / 2)
    is_wide = meets(junction.outer, Range(size.lo - 1, size.hi + 1))  # so that none lies between two sizes
    return is_wide and (junction.kind not in RINGS or meets(junction.radius, island))


def _are_ways_possible(junction: JunctionClause) -> bool:
    take, ways, arms = junction.take, junction.ways, ARMS[junction.kind]
    least = 1 if junction.kind == "crossroads" else arms.lo - 1 - len(junction.only_in)
    possible = TAKES[junction.kind]
    return not ways or (
        len(ways) in Range(least, arms.hi - 1)
        and len({*ways}) == len(ways)
        and {*ways} <= {*possible}
        and (take not in ("left", "right", "straight") or take in ways)
    )


LENGTHS = Range(10, 1500)  # m, of a lane for acceleration or deceleration, and of tapers


def _is_ring_possible(junction: JunctionClause, arms: Range) -> bool:
    turns_back = junction.take == "back" and junction.exit is not None
    is_crowded = junction.size == "mini" and arms.lo > MOST_ARMS_OF_MINI
    is_long = junction.kind not in RAMPS or span(junction.length).hi >= LENGTHS.lo  # see _check_lane_sequence
    return (
        not is_crowded
        and (junction.radius is None or junction.outer is None)
        and meets(junction.outer, ACROSS)
        and (not turns_back or meets(junction.exit, arms))
        and meets(junction.lanes, Range(1, 2))
        and (not is_long or meets(junction.length, LENGTHS))
        and meets(junction.taper, LENGTHS)
    )


def _are_signs_possible(junction: JunctionClause) -> bool:
    is_ring = junction.kind == "roundabout"
    return (
        (not junction.all_way or junction.control in ("stop", "yield", "lights"))
        and (not junction.others_stop or (junction.control == "priority" and not is_ring))
        and (not junction.skew or junction.kind == "crossroads")
    )


def _are_one_way_arms_possible(junction: JunctionClause) -> bool:
    """Returns whether a junction can have the one-way arms that it asks for. The road behind it makes the arm
    of the route one-way, so that arm cannot be listed."""
    into, out, ways = {*junction.only_in}, {*junction.only_out}, {*junction.ways}
    count = len(junction.only_in) + len(junction.only_out)
    return not count or (
        junction.kind in ("t_junction", "crossroads")
        and len(into | out) == count <= ARMS[junction.kind].lo - 2
        and junction.take not in into | out
        and not into & ways
        and (not ways or out < ways)
    )


def _are_angles_possible(junction: JunctionClause) -> bool:
    if junction.angle is None and junction.degrees is None:
        return True
    return (
        junction.kind != "roundabout"
        and (junction.angle is None or junction.kind != "junction")
        and meets(junction.angle, ANGLES.get(junction.kind, Range()))
        and (junction.degrees is None or junction.take != "straight")
        and meets(junction.degrees, _turns(junction))
        and _go_together(junction)
    )


def _turns(junction: JunctionClause) -> Range:
    """Returns the angles in degrees by which the route can turn at the junction in the required direction."""
    kinds = [kind for kind in TURNS if junction.kind in (kind, "junction")]
    found = [TURNS[kind] for kind in kinds if meets(junction.arms, ARMS[kind])] or [TURNS["star"]]
    turns = Range(min(each.lo for each in found), max(each.hi for each in found))
    return overlap(turns, BENDS.get((junction.take or "").partition("_")[0])) or turns


def _go_together(junction: JunctionClause) -> bool:
    if junction.kind == "crossroads":
        turns = range(int(TURNS["crossroads"].lo), int(TURNS["crossroads"].hi) + 1)
        return any(_allows(junction, turn, min(turn, 180 - turn)) for turn in turns)
    if junction.kind == "y_junction":
        gaps = range(int(FORK_GAPS[0]), int(FORK_GAPS[1]) + 1)
        thirds = ((gap, other, 360 - gap - other) for gap, other in product(gaps, gaps))
        return any(_allows(junction, 180 - parts[0], min(parts)) for parts in thirds if max(parts) in gaps)
    if junction.kind == "star":
        return max(span(junction.angle).lo, 0) * max(span(junction.arms).lo, ARMS["star"].lo) <= 360
    return True


def _allows(junction: JunctionClause, turn: float, least: float) -> bool:
    """Returns whether the route may turn by an angle where the closest roads are ``least`` degrees apart."""
    turns = is_about(turn, junction.degrees) and is_about(least, junction.angle)
    return turns and (not junction.skew or least < SKEW)


def _faults_of_lanes(brief: Brief) -> Iterator[str]:
    for n, place in enumerate(brief.junctions):
        before, after = brief.stretches[n : n + 2]
        step = 0 if place.take == "main" else ROADS["junctions"][place.kind].get("step")
        own = span(before.lanes)
        wanted = before.lanes and step is not None and Range(own.lo + step, own.hi + step)
        if wanted and not meets(after.lanes, wanted):
            what = {-1: "one lane fewer", 0: "as many lanes", 1: "one lane more"}[step or 0]
            yield (
                f"behind a {place.name} the road has {what}, but the road before it has {before.lanes} and"
                f" the one behind it {after.lanes}; change one of them"
            )
        taper = max(span(place.taper).lo, 0.0)
        least = LEAST_LANE + WIDE_IN_TAPER / (1 - WIDE_IN_TAPER) * taper if place.taper else 0.0
        least = max(least, LEAST_BESIDE_RAMP if place.kind in RAMPS else 0.0)
        if span(place.length).hi < least:
            yield (
                f"the additional lane of a {place.name} is {least:.0f} m long or longer, not"
                f" {place.length} m; change it, or its taper"
            )


def faults_beside_ramps(brief: Brief) -> Iterator[str]:
    """Yields a sentence for each road of a route that is too short for the additional lanes of its ramps.
    These are no faults of a Brief, as words may mean a length that is measured elsewhere."""
    for n, road in enumerate(brief.stretches):
        beside = [place for place in brief.junctions[max(n - 1, 0) : n] if place.kind == "merge"]
        beside += [place for place in brief.junctions[n : n + 1] if place.kind == "diverge"]
        needed = sum(max(span(each.length).lo, LEAST_BESIDE_RAMP) for each in beside)
        needed += sum(max(span(each.taper).lo, LEAST_NARROW) for each in beside)
        longest = span(road.length).hi
        if beside and needed > (1 + ROAD_LENGTH_SLACK) * longest:
            lanes = " and ".join(f"the additional lane of the {each.name}" for each in beside)
            yield (
                f"{lanes} with {'their tapers need' if beside[1:] else 'its taper needs'} {needed:.0f} m of a"
                f" road of {road.length} m; ask for a longer road, or for shorter lanes"
            )


def _faults_of_map(asked: MapClause) -> Iterator[str]:
    for blocks in (asked.columns, asked.rows):
        if not meets(blocks, Range(1, MOST_BLOCKS)):
            yield f"a grid has 1 to {MOST_BLOCKS} blocks a side, not {blocks}; change it"
    is_possible = _are_signed_possible(asked)
    is_possible = is_possible and all(meets(each.count, Range(1, MOST_OF_KIND)) for each in asked.junctions)
    for amount, look in ((asked.blocks, _are_blocks_possible), (asked.dead_ends, _are_dead_ends_possible)):
        if amount is not None:
            bounds = [each for each in (span(amount).lo, span(amount).hi) if isfinite(each)]
            is_whole = all(each >= 0 and not each % 1 for each in bounds)
            is_possible = is_possible and is_whole and look(asked, span(amount))
    if not is_possible:
        yield f"no map can be built as '{map_plan(asked)}' asks; change one of the numbers"


def _are_signed_possible(asked: MapClause) -> bool:
    """Returns whether a grid can have the junctions that have signs of their own.

    A grid has four junctions fewer than corners of blocks, unless roads lead out at its own corners. Only
    where a road leads out, the junctions at its border are crossroads."""
    if not asked.signed:
        return True
    columns, rows = (min(span(each).hi, MOST_BLOCKS) for each in (asked.columns, asked.rows))
    out = min(span(asked.dead_ends).hi, 2 * (columns + rows))
    every = (columns + 1) * (rows + 1) - max(4 - out, 0)
    across = (columns - 1) * (rows - 1) + min(out, 2 * (columns + rows - 2))
    most = {"junction": every, "t_junction": every, "crossroads": across}
    usual = asked.control or "none"
    alike = ((usual, usual), ("priority", "yield"), ("yield", "priority"))
    return sum(span(each.count).lo for each in asked.signed) <= every and all(
        span(each.count).lo <= most.get(each.kind, -1) and (each.control, usual) not in alike
        for each in asked.signed
    )


def _are_blocks_possible(asked: MapClause, wanted: Range) -> bool:
    most = most_ends(asked)
    is_one = sum(span(each.count).hi for each in asked.junctions) == 1
    if (is_one and wanted.lo > 0) or 2 * wanted.lo > most:
        return False
    if asked.dead_ends is None or not has_fixed_arms(asked):
        return True
    allowed = asked.ends_of_tree(most)
    return any(number in allowed for number in range(int(most), -1, -2))


def most_ends(asked: MapClause) -> float:
    """Returns the greatest number of dead ends of a map of junctions: the number if no block is enclosed."""
    counts = [span(each.count) for each in asked.junctions]
    arms = sum(ARMS[each.kind].hi * n.hi for each, n in zip(asked.junctions, counts, strict=True))
    return arms - 2 * (sum(n.hi for n in counts) - 1)


def has_fixed_arms(asked: MapClause) -> bool:
    """Returns whether the number of arms of all junctions of a map is fixed."""
    return all(ARMS[each.kind].lo == ARMS[each.kind].hi and each.count.exact for each in asked.junctions)


def _are_dead_ends_possible(asked: MapClause, wanted: Range) -> bool:
    if asked.columns is not None and asked.rows is not None:
        columns, rows = span(asked.columns), span(asked.rows)
        most = 2 * (min(columns.hi, MOST_BLOCKS) + min(rows.hi, MOST_BLOCKS))
        return wanted.lo <= most and not (wanted.hi < 1 and columns.hi == rows.hi == 1)
    counts = [span(each.count) for each in asked.junctions]
    least, number = sum(max(each.lo, 1) for each in counts), sum(each.hi for each in counts)
    most = most_ends(asked)
    if least == number == 1 and not meets(asked.dead_ends, ARMS[asked.junctions[0].kind]):
        return False
    is_even = not has_fixed_arms(asked) or any(each in wanted for each in range(int(most), -1, -2))
    return wanted.lo <= most and is_even
