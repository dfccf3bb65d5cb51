"""Finds contradictions and impossible requirements in the junctions of a Brief, and says what to change."""

from math import isfinite

from roadgpt.brief.amount import Amount, meets, span
from roadgpt.brief.arm_check import check_angles, check_one_way_arms
from roadgpt.brief.junction_plan import KEY_OF
from roadgpt.brief.junction_ranges import ACROSS, ARMS, SIZES
from roadgpt.brief.junctions import LANE_KINDS, NAMES, RAMPS, SIGNS, JunctionClause, JunctionKind, MapClause
from roadgpt.brief.model import Brief
from roadgpt.brief.ranges import Range, overlap
from roadgpt.errors import BriefError

POSSIBLE: dict[JunctionKind, tuple[str, ...]] = {
    "t_junction": ("left", "right", "straight"),
    "y_junction": ("left", "right"),
    "crossroads": ("left", "right", "straight"),
    "merge": ("ramp", "main"),
    "diverge": ("ramp", "main"),
    "lane_drop": (),
    "lane_gain": (),
    "lane_change": ("left", "right"),
}
"""The values of ``take`` that are possible at a kind of junction. At kinds that are not listed, all values
except "ramp" and "main" are possible; "back" is possible only at a roundabout."""
MOST_BLOCKS = 8
MOST_OF_KIND = 12
MOST_ARMS_OF_MINI = 4  # with more, kerbs between them would have radii below 3 m
CIRCULATORY = 10.0  # m, about: the outer diameter of a roundabout minus the diameter of its island
STEPS = {"lane_drop": -1, "lane_gain": 1, "lane_change": 0}
"""The number of lanes behind a lane drop, gain or change, minus the number of lanes before."""
LEAST_BESIDE_RAMP = 28.0  # m; source: the rule ``ramp_too_short``
LEAST_LANE = 17.0  # m, before the taper; with the wide part of a taper of 60 m, these are the required 28 m
WIDE_IN_TAPER = 0.196  # of the taper: the share in which the lane is still wider than 0.9 of its full width


def check_network(brief: Brief) -> None:
    """Raises BriefError if the junctions and lanes of a route, or the map, contradict themselves or cannot be
    built; the message says what to change.
    """
    for junction in brief.junctions:
        check_junction(junction)
    _check_turning_back(brief)
    _check_lane_sequence(brief)
    if brief.map is not None and not brief.junctions:
        _check_map(brief.map)


def check_junction(junction: JunctionClause) -> None:
    """Raises BriefError if a junction cannot meet its requirements; the message says what to change."""
    name, possible = junction.name, ARMS[junction.kind]
    is_ring = junction.kind == "roundabout"
    if junction.kind in (*RAMPS, *LANE_KINDS):
        _check_fields_of_lanes(junction)
    arms = overlap(possible, span(junction.arms))
    if arms is None or arms.lo > arms.hi:
        raise BriefError(f"a {name} has {possible} arms, not {junction.arms}; change one of them")
    _check_take(junction, name)
    if not is_ring:
        for field in ("size", "radius", "outer", "exit", "lanes"):
            if getattr(junction, field) is not None:
                raise BriefError(f"a {name} has no {field}, only a roundabout has; leave it out")
    elif junction.exit is not None:
        _check_exit(junction.exit, arms)
        if junction.take == "back" and not meets(junction.exit, arms):
            raise BriefError(
                f"the last exit of a roundabout leads back, not exit {junction.exit} of {arms}; leave one of "
                "them out"
            )
    if junction.size == "mini" and arms.lo > MOST_ARMS_OF_MINI:
        raise BriefError(
            f"a mini roundabout is too small for {junction.arms} arms, it has room for {MOST_ARMS_OF_MINI}; "
            "ask for a normal one, or for fewer arms"
        )
    if not meets(junction.lanes, Range(1, 2)):
        raise BriefError(f"the ring of a roundabout has one or two lanes, not {junction.lanes}; change it")
    if junction.taper is not None and junction.kind not in RAMPS:
        raise BriefError(f"a {name} has no taper, only a merge or an exit has; remove taper=")
    if (junction.side or junction.length) and junction.kind not in (*RAMPS, *LANE_KINDS):
        raise BriefError(
            f"a {name} has no side and no length; give the length with the road before or behind it"
        )
    if junction.all_way and junction.control not in ("stop", "yield", "lights"):
        raise BriefError("all arms have the same sign or light: give stop or lights beside all_way")
    if junction.others_stop and (junction.control != "priority" or junction.kind == "roundabout"):
        raise BriefError(
            "others_stop means that the roads which give way have stop signs: give it beside priority, not "
            "at a roundabout"
        )
    if junction.skew and junction.kind != "crossroads":
        raise BriefError(f"only crossroads are skew, not a {name}; leave it out")
    _check_diameter(junction)
    check_one_way_arms(junction)
    check_angles(junction)


LENGTHS = Range(10, 1500)  # m, of a lane for acceleration or deceleration, and of tapers
OF_LANES = ("kind", "take", "side", "length", "taper")
"""The fields of a JunctionClause that can be set for merges, exits, lane drops, gains and changes."""


def _check_fields_of_lanes(junction: JunctionClause) -> None:
    """Raises BriefError if a merge, an exit, or a place where lanes change has what only junctions have."""
    usual = JunctionClause(kind=junction.kind)
    for field in JunctionClause.model_fields:
        if field not in OF_LANES and getattr(junction, field) != getattr(usual, field):
            raise BriefError(f"a {junction.name} has no {KEY_OF.get(field, field)}; leave it out")
    is_short = junction.kind in RAMPS and span(junction.length).hi < LENGTHS.lo  # see _check_lane_sequence
    for word, metres in (("len", None if is_short else junction.length), ("taper", junction.taper)):
        if not meets(metres, LENGTHS):
            raise BriefError(f"{word} of a {junction.name} is {LENGTHS} m, not {metres} m; change it")
    if junction.kind == "lane_change" and (junction.side or junction.length):
        raise BriefError(
            "a lane change goes left or right, and its length is not asked for; leave side and len out"
        )


def _check_turning_back(brief: Brief) -> None:
    """Raises BriefError if anything follows after a route has turned back at a roundabout."""
    backs = [n for n, junction in enumerate(brief.junctions) if junction.take == "back"]
    if backs and (backs[0] < len(brief.junctions) - 1 or not brief.stretches[-1].is_open):
        raise BriefError(
            "a route that turns back at a roundabout ends on the road on which it came; leave out what "
            "follows"
        )


def _check_lane_sequence(brief: Brief) -> None:
    """Checks the number of lanes along a route, and the length of the additional lanes at ramps."""
    for n, place in enumerate(brief.junctions):
        before, after = brief.stretches[n : n + 2]
        step = 0 if place.take == "main" else STEPS.get(place.kind)
        if step is not None:
            _check_step(place, before, after, step)
        if place.kind in RAMPS and span(place.length).hi < LEAST_BESIDE_RAMP:
            raise BriefError(
                f"the additional lane of a {place.name} is {LEAST_BESIDE_RAMP:g} m long or longer, not "
                f"{place.length} m; change it"
            )
        least = LEAST_LANE + WIDE_IN_TAPER / (1 - WIDE_IN_TAPER) * max(span(place.taper).lo, 0.0)
        if place.taper is not None and span(place.length).hi < least:
            raise BriefError(
                f"with a taper of {place.taper} m, the additional lane of a {place.name} is {least:.0f} m "
                f"long or longer, not {place.length} m; change one of them"
            )


def _check_step(place: JunctionClause, before: Brief, after: Brief, step: int) -> None:
    if before.lanes is None or after.lanes is None:
        return
    own = span(before.lanes)
    if not meets(after.lanes, Range(own.lo + step, own.hi + step)):
        what = {-1: "one lane fewer", 0: "as many lanes", 1: "one lane more"}[step]
        raise BriefError(
            f"behind a {place.name} the road has {what}, but the road before it has {before.lanes} and the "
            f"one behind it {after.lanes}; change one of them"
        )


def _check_take(junction: JunctionClause, name: str) -> None:
    take, ways = junction.take, junction.ways
    possible = POSSIBLE.get(junction.kind)
    if take == "back" and junction.kind != "roundabout":
        raise BriefError(f"one cannot turn back at a {name}, only at a roundabout; leave it out")
    if take in ("ramp", "main") and junction.kind not in RAMPS:
        raise BriefError(f"a {name} has no ramp, only a merge or an exit has; leave '{take}' out")
    if take is not None and possible is not None and take not in (*possible, "back"):
        where = f"at a {name} one can go {' or '.join(possible)}" if possible else f"a {name} has no ways on"
        raise BriefError(f"{where}, not {take}; change one of them")
    if not ways:
        return
    arms = ARMS[junction.kind]
    least = 1 if junction.kind == "crossroads" else arms.lo - 1 - len(junction.only_in)
    needed = Range(least, arms.hi - 1)
    if len(ways) not in needed or len(set(ways)) != len(ways) or (possible and not {*ways} <= {*possible}):
        raise BriefError(f"a {name} has {needed} different ways on, other than {' and '.join(ways)}")
    if take in ("left", "right", "straight") and take not in ways:
        raise BriefError(f"a {name} with ways on {' and '.join(ways)} has none {take}; change one of them")


def _check_map(asked: MapClause) -> None:
    for blocks in (asked.columns, asked.rows):
        if not meets(blocks, Range(1, MOST_BLOCKS)):
            raise BriefError(f"a grid has 1 to {MOST_BLOCKS} blocks a side, not {blocks}; change it")
    for each in asked.junctions:
        if not meets(each.count, Range(1, MOST_OF_KIND)):
            raise BriefError(
                f"a map has 1 to {MOST_OF_KIND} junctions of one kind, not {each.count}; change it"
            )
    if asked.signed:
        _check_signed(asked)
    if asked.blocks is not None:
        _check_blocks(asked, span(asked.blocks))
    if asked.dead_ends is not None:
        _check_dead_ends(asked, span(asked.dead_ends))


def _check_signed(asked: MapClause) -> None:
    """Checks the junctions of a grid that have signs of their own.

    A grid has four junctions fewer than corners of blocks, unless roads lead out at its own corners. Only
    where a road leads out, the junctions at its border are crossroads.
    """
    columns, rows = (min(span(each).hi, MOST_BLOCKS) for each in (asked.columns, asked.rows))
    out = min(span(asked.dead_ends).hi, 2 * (columns + rows))
    most = {"junction": (columns + 1) * (rows + 1) - max(4 - out, 0)}
    most["t_junction"] = most["junction"]
    most["crossroads"] = (columns - 1) * (rows - 1) + min(out, 2 * (columns + rows - 2))
    usual, total = asked.control or "none", 0.0
    for each in asked.signed:
        name, wanted = NAMES[each.kind][0], span(each.count).lo
        if each.kind not in most:
            raise BriefError(f"a grid has T-junctions and crossroads, no {name}; leave the {name} out")
        if wanted > most[each.kind]:
            raise BriefError(
                f"this grid has {most[each.kind]:g} of the kind {name} at most, not {each.count}; "
                "ask for fewer or a larger grid"
            )
        if (each.control, usual) in ((usual, usual), ("priority", "yield"), ("yield", "priority")):
            raise BriefError(
                f"all junctions of the grid have {SIGNS[usual]}; give others to those that are counted"
            )
        total += wanted
    if total > most["junction"]:
        raise BriefError(
            f"this grid has {most['junction']:g} junctions at most, not {total:g}; give fewer of them signs"
        )


def _check_blocks(asked: MapClause, wanted: Range) -> None:
    if any(isfinite(each) and (each < 0 or each % 1) for each in (wanted.lo, wanted.hi)):
        raise BriefError(f"roads enclose 0, 1, 2 or more blocks, not {asked.blocks}; change it")
    most = most_ends(asked)
    if sum(span(each.count).hi for each in asked.junctions) == 1 and wanted.lo > 0:
        raise BriefError(
            "the roads of a single junction enclose no block; leave blocks= out, or add a junction"
        )
    if 2 * wanted.lo > most:
        raise BriefError(
            f"the roads of these junctions enclose at most {most // 2:g} blocks, not {asked.blocks}; "
            "change it"
        )
    if asked.dead_ends is not None and has_fixed_arms(asked):
        allowed = asked.ends_of_tree(most)
        if not any(number in allowed for number in range(int(most), -1, -2)):
            raise BriefError(
                f"these junctions have {most:g} dead ends without blocks, and each block takes two, so they "
                f"cannot have blocks={asked.blocks} and dead_ends={asked.dead_ends}; leave one of them out"
            )


def most_ends(asked: MapClause) -> float:
    """Returns the greatest number of dead ends of a map of junctions: the number if no block is enclosed."""
    counts = [span(each.count) for each in asked.junctions]
    arms = sum(ARMS[each.kind].hi * n.hi for each, n in zip(asked.junctions, counts, strict=True))
    return arms - 2 * (sum(n.hi for n in counts) - 1)


def least_ends(asked: MapClause) -> float:
    """Returns the least number of dead ends of a map of junctions whose roads enclose no block."""
    counts = [span(each.count) for each in asked.junctions]
    return 2 + sum((ARMS[each.kind].lo - 2) * n.lo for each, n in zip(asked.junctions, counts, strict=True))


def has_fixed_arms(asked: MapClause) -> bool:
    """Returns whether the number of arms of all junctions of a map is fixed."""
    return all(ARMS[each.kind].lo == ARMS[each.kind].hi and each.count.exact for each in asked.junctions)


def _check_dead_ends(asked: MapClause, wanted: Range) -> None:
    bounds = [each for each in (wanted.lo, wanted.hi) if isfinite(each)]
    if any(each < 0 or each % 1 for each in bounds):
        raise BriefError(f"a map has 0, 1, 2 or more dead ends, not {asked.dead_ends}; change it")
    if asked.columns is not None and asked.rows is not None:
        columns, rows = span(asked.columns), span(asked.rows)
        most = 2 * (min(columns.hi, MOST_BLOCKS) + min(rows.hi, MOST_BLOCKS))
        if wanted.lo > most:
            raise BriefError(
                f"{most:g} roads at most lead out of this grid, not {asked.dead_ends}; change it"
            )
        if wanted.hi < 1 and columns.hi == rows.hi == 1:
            raise BriefError("one block without dead ends has no junction; ask for more blocks, or dead ends")
        return
    counts = [span(each.count) for each in asked.junctions]
    least, number = sum(max(each.lo, 1) for each in counts), sum(each.hi for each in counts)
    most = most_ends(asked)
    if least == number == 1 and not meets(asked.dead_ends, ARMS[asked.junctions[0].kind]):
        raise BriefError(
            f"all arms of the only junction of a map are dead ends, {ARMS[asked.junctions[0].kind]} of them, "
            f"not {asked.dead_ends}; change the number, or add a junction"
        )
    if wanted.lo > most:
        raise BriefError(
            f"the roads of these junctions leave {most:g} dead ends at most, not {asked.dead_ends}; change it"
        )
    if has_fixed_arms(asked) and not any(number in wanted for number in range(int(most), -1, -2)):
        raise BriefError(
            f"the roads of these junctions leave an {'odd' if most % 2 else 'even'} number of dead ends, "
            f"{most:g} at most, not {asked.dead_ends}; change the number, or add a junction"
        )


def _check_diameter(junction: JunctionClause) -> None:
    if junction.radius is not None and junction.outer is not None:
        raise BriefError("the radius of the island and the outer diameter are given; leave one of them out")
    if not meets(junction.outer, ACROSS):
        raise BriefError(f"a roundabout is {ACROSS} m across, not {junction.outer} m; change it")
    if junction.size is None:
        return
    size = SIZES[junction.size]
    if not meets(junction.outer, Range(size.lo - 1, size.hi + 1)):  # so that none lies between two sizes
        raise BriefError(
            f"a {junction.size} roundabout is {size} m across, not {junction.outer} m; leave one of them out"
        )
    if not meets(junction.radius, Range((size.lo - CIRCULATORY) / 2, (size.hi - CIRCULATORY) / 2)):
        raise BriefError(
            f"a {junction.size} roundabout is {size} m wide; with a radius of {junction.radius} m it is not; "
            "leave one of them out"
        )


def _check_exit(number: Amount, arms: Range) -> None:
    exits = span(number)
    if exits.lo > arms.hi or exits.hi < 1:
        raise BriefError(
            f"a roundabout with {arms} arms has no exit {number}; its last exit leads back to where one came "
            "from"
        )
