"""Compares what is measured on a road, a route or a map with what a description requires of it.

Roads: turns are matched one to one and in order. A requested straight matches either the whole straight
between two turns of the road, or a piece of it that goes up, is flat or goes down throughout. If several
straights are requested between two turns, they are matched with such pieces in order, each piece at most
once. Requested straights in a row that all go up, or all go down, with different grades may also be parts of
one piece. If the description leaves a count open ("at least three right turns, then a hairpin"), the turns of
the road are assigned to the requested groups so that as few turns as possible violate a requirement. Finally,
turns and straights that a description wants to be alike are compared with each other.

Routes: each junction, and each place where lanes change, is compared with the one that is asked for there.
Maps: numbers of junctions by kind and by sign, blocks, dead ends and distances are compared."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from itertools import chain, pairwise
from math import inf, isfinite
from operator import itemgetter
from typing import NamedTuple

from roadgpt.brief.amount import about
from roadgpt.brief.design_speed import SpeedLimits
from roadgpt.brief.junctions import (
    LANE_KINDS,
    NAMES,
    RAMPS,
    SIGNS,
    SIZES,
    SKEW,
    JunctionCount,
    MapClause,
    bends_as,
    is_about,
)
from roadgpt.brief.model import OTHER_SIDE, Amount, Brief, JunctionClause, span
from roadgpt.brief.outline import Feature, Group, Outline, both
from roadgpt.brief.ranges import Range, overlap
from roadgpt.brief.words import COUNTS, FEATURE, NO_TURN, OVER, ROAD, WHOLE_SLOPES
from roadgpt.check.extremes import tightest, vertical_bends
from roadgpt.check.measures import (
    LEVEL,
    GradeChange,
    MeasuredFeature,
    MeasuredJunction,
    MeasuredLanes,
    MeasuredMap,
    MeasuredNode,
    RoadMeasures,
)
from roadgpt.language.names import Control
from roadgpt.language.table import ROADS
from roadgpt.plural import plural
from roadgpt.road import Profile, Road

ANGLES = 6.0  # degrees by which the angles of like turns may differ
RATIO = 1.2  # of the largest radius or length of like parts to the smallest
METRES = 5.0  # by which the lengths of like straights may differ in any case
OPEN_TURN = Feature("turn", "turn")
SLACK = 0.15  # ratio, allowed deviation from the radius of an island that is given as one number
ROUNDING_OF_CURVATURE = 1e-6
ROUNDING = 0.5  # m, allowed deviation from a range of outer diameters
SHARE = 0.1  # ratio by which a distance between junctions may differ from the requested distance
NEVER_USUAL = ("lights", "stop")
"""Signs that a junction has only on request; a roundabout has signs to give way even without a request."""
CORNERS = 4  # corners of a grid; at each, the road may bend without a junction
Wanted = Sequence[Feature | None]


class Complaint(NamedTuple):
    """A requirement that the road does not meet: a sentence with the requested and the measured value.

    ``s`` is the station in metres; None if the requirement concerns the whole road."""

    sentence: str
    s: float | None = None
    on_heights: bool = False  # whether the requirement could be met by changing only the heights of the road
    place: tuple[float, float] | None = None  # of a junction of a map, in metres


Match = tuple[float, tuple[Complaint, ...]]
"""A way to match the turns and straights of a road, or of a part of it, with those of an Outline: the number
of features that are not as requested, infinite if the match is impossible; and what is wrong with them."""


def _joined(*parts: Match) -> Match:
    return sum(wrong for wrong, _ in parts), tuple(chain.from_iterable(told for _, told in parts))


def fits(stretch: MeasuredFeature, feature: Feature) -> bool:
    """Returns whether ``stretch``, a measured turn or straight, meets all requirements of ``feature``."""
    if stretch.kind != feature.kind or feature.side not in (None, stretch.side):
        return False
    wrong = _wrong(stretch, feature)
    return not wrong or (wrong == ["grade"] and _is_rounded_off(stretch, feature.grade))


def _wrong(stretch: MeasuredFeature, feature: Feature) -> list[str]:
    own = {name: asked for name in FEATURE if (asked := getattr(feature, name))}
    of_slopes = ("grade", "climb") if feature.bump else ()
    wrong = [
        name for name, asked in own.items() if name not in of_slopes and getattr(stretch, name) not in asked
    ]
    has_slopes = len(stretch.slopes) == 2 and all(map(fits, stretch.slopes, feature.slopes))
    return wrong if has_slopes or not feature.bump else [*wrong, "bump"]


def _is_rounded_off(stretch: MeasuredFeature, asked: Range | None) -> bool:
    """Returns whether a straight is too gentle as a whole, but as steep as asked over its middle half."""
    if stretch.kind != "straight" or asked is None or stretch.inner_grade not in asked:
        return False
    least = asked.lo if asked.lo > 0 else -asked.hi if asked.hi < 0 else 0.0
    return LEVEL < least > abs(stretch.grade)  # who only goes up or down does so on average


def turn_complaints(
    number: int, turn: MeasuredFeature, feature: Feature, side: str | None = None
) -> tuple[Complaint, ...]:
    """Returns one complaint for each requirement that a turn, counted from 1, does not meet. ``side`` is the
    required side if turns must alternate; None for the side that ``feature`` states."""
    side, out = side or feature.side, list[Complaint]()
    if side and turn.side != side:
        out.append(Complaint(f"turn {number} goes {turn.side}, asked for {side}", turn.start))
    for name in _wrong(turn, feature):
        if name == "bump" and feature.bump:
            has = " and ".join(f"{slope.length:.0f} m at {slope.grade:.1f} %" for slope in turn.slopes)
            wanted = f"{OVER[feature.bump]} in its middle half{feature.slopes[0].limits()}"
            text = f"turn {number} does not lead {wanted}; its slopes: {has or 'none'}"
            out.append(Complaint(text, turn.start, on_heights=True))
            continue
        row = FEATURE[name]
        measured, asked = row.measured.format(getattr(turn, name)), getattr(feature, name)
        text = f"turn {number} {measured}, asked for {asked}{row.unit}"
        out.append(Complaint(text, turn.start, row.on_heights))
    return tuple(out)


def sequence_complaints(found: RoadMeasures, asked: Outline) -> tuple[Complaint, ...]:
    """Returns the Complaints about the turns and straights of an Outline, in driving order. The road is
    matched so that the fewest of them are not as requested; the only Complaint is about the number of turns
    if no match is possible."""
    groups, turns, gaps = asked.groups, found.turns, found.gaps
    turns_are_free = not asked.names_all_turns

    def of_turns(group: Group, first: int, number: int) -> Match:
        side = other = group.feature.side
        if group.alternating:  # the first turn may go either way, unless its side is stated
            side = side or turns[first].side
            other = OTHER_SIDE[side] if side else None
        told = [
            turn_complaints(n + 1, turns[n], group.feature, (side, other)[(n - first) % 2])
            for n in range(first, first + number)
        ]
        return sum(map(bool, told)), tuple(chain.from_iterable(told))

    @cache
    def best(group: int, turn: int, wanted: tuple[Feature, ...]) -> Match:
        """Returns the best match from this group on, with this turn next and these straights before it."""
        here = _of_gap(found, gaps[turn], wanted, turn)
        if group == len(groups):
            return here if turns_are_free or turn == len(turns) else (inf, ())
        ways = [_joined(here, best(group, turn + 1, ()))] if turns_are_free and turn < len(turns) else []
        now = groups[group]
        if now.feature.kind == "straight":
            ways += [best(group + 1, turn, wanted + (now.feature,) * now.lo)]
        else:
            if now.lo == 0:
                ways += [best(group + 1, turn, wanted)]
            left = len(turns) - turn
            for number in range(max(now.lo, 1), (left if now.hi is None else min(now.hi, left)) + 1):
                ways.append(_joined(here, of_turns(now, turn, number), best(group + 1, turn + number, ())))
        return min(ways, key=itemgetter(0), default=(inf, ()))

    wrong, told = best(0, 0, ()) if groups else (0, ())
    if wrong == inf:
        return (Complaint(f"the {len(turns)} turns cannot be matched with what was asked for"),)
    return told


def _of_gap(
    found: RoadMeasures, gap: tuple[MeasuredFeature, ...], wanted: tuple[Feature, ...], turn: int
) -> Match:
    if not wanted or (len(wanted) == 1 and any(fits(straight, wanted[0]) for straight in gap)):
        return 0, ()
    pieces = [piece for straight in gap for piece in straight.pieces]
    at, missing = 0, list[Feature]()
    for ramp in _ramps(wanted):
        whole = next((i for i in range(at, len(pieces)) if _fit(found, pieces[i], ramp)), None)
        if whole is not None:
            at = whole + 1
            continue
        for wish in ramp:
            place = next((i for i in range(at, len(pieces)) if fits(pieces[i], wish)), None)
            if place is None:
                missing.append(wish)
            else:
                at = place + 1
    where = f"after turn {turn}" if turn else "at the start"
    s = gap[0].start if gap else None
    pieces_told = (f"{each.length:.0f} m at {each.grade:.1f} %" for each in (gap[0].pieces if gap else ()))
    has = ", then ".join(pieces_told) if gap else "none"
    return len(missing), tuple(
        Complaint(f"asked for a straight {where}{wish.limits()}, has {has}", s, wish.grade is not None)
        for wish in missing
    )


def _ramps(wanted: tuple[Feature, ...]) -> list[list[Feature]]:
    out = [[wanted[0]]]
    for one, other in pairwise(wanted):
        if change_of_grade(one.grade, other.grade) is None:
            out.append([])
        out[-1].append(other)
    return out


def _fit(found: RoadMeasures, piece: MeasuredFeature, ramp: Sequence[Feature]) -> bool:
    if len(ramp) == 1:
        return fits(piece, ramp[0])
    changes = [change_of_grade(one.grade, other.grade) for one, other in pairwise(ramp)]
    parts = found.cut(piece, [change for change in changes if change is not None])
    return len(parts) == len(ramp) and all(map(fits, parts, ramp))


def change_of_grade(one: Range | None, other: Range | None) -> GradeChange | None:
    """Returns the change of grade between two straights in a row that both go up, or both go down, with
    different grades; None for all other straights."""
    if one is None or other is None:
        return None
    if min(one.lo, other.lo) < LEVEL and max(one.hi, other.hi) > -LEVEL:
        return None
    grade = (one.usual + other.usual) / 2
    return (
        GradeChange(grade, one.usual < other.usual) if one.usual != other.usual and isfinite(grade) else None
    )


class LikeGroup(list[int]):
    """The indices of features that must be alike; all features must meet the ranges in ``common``."""

    def __init__(self, common: Feature, place: int) -> None:
        super().__init__([place])
        self.common = common


def like_groups(features: Wanted) -> list[LikeGroup]:
    """Returns the groups of two or more features that must be alike: those that have the same name and whose
    ranges overlap. A None in ``features`` belongs to no group."""
    groups: list[LikeGroup] = []
    for place, feature in enumerate(features):
        if feature is None:
            continue
        for group in groups:
            common = _common(group.common, feature)
            if common is not None:
                group.append(place)
                group.common = common
                break
        else:
            groups.append(LikeGroup(feature, place))
    return [group for group in groups if len(group) > 1]


def _common(one: Feature, other: Feature) -> Feature | None:
    if (one.kind, one.name) != (other.kind, other.name):
        return None
    degrees, radius, length = (
        overlap(getattr(one, name), getattr(other, name)) for name in ("degrees", "radius", "length")
    )
    if any(span is not None and span.lo >= span.hi for span in (degrees, radius, length)):
        return None
    return replace(one, degrees=degrees, radius=radius, length=length)


def like_straights(gaps: Sequence[Sequence[Feature]]) -> list[LikeGroup]:
    """Groups the gaps before, between and after the turns whose straights must be equally long. Gaps with
    exactly one required straight are grouped by ``like_groups``. If no straight is required between the
    turns, all gaps between turns are one group, whose ``common`` has no length."""
    groups = like_groups([gap[0] if len(gap) == 1 else None for gap in gaps])
    inner = range(1, len(gaps) - 1)
    if len(inner) < 2 or any(gaps[place] for place in inner):
        return groups
    even = LikeGroup(Feature("straight", "straight"), inner[0])
    even.extend(inner[1:])
    return [*groups, even]


def likeness_complaints(found: RoadMeasures, asked: Outline) -> Iterator[Complaint]:
    """Yields a complaint for each group of turns or straights that should be alike and is not. If the number
    of turns is open, a road is compared only if all required turns have one name and no straight is required.
    """
    wanted = _wanted(asked, len(found.turns))
    if wanted is None:
        return
    turns, gaps = wanted
    for group in like_groups(turns):
        alike = [found.turns[place] for place in group]
        angles, radii = [turn.degrees for turn in alike], [turn.radius for turn in alike]
        if max(angles) - min(angles) > ANGLES:
            text = f"asked for turns alike, they turn {min(angles):.0f} to {max(angles):.0f} degrees"
            yield Complaint(text, alike[0].start)
        if max(radii) > RATIO * min(radii):
            text = f"asked for turns alike, their radii are {min(radii):.0f} to {max(radii):.0f} m"
            yield Complaint(text, alike[0].start)
    for group in like_straights(gaps):
        lengths = [max((straight.length for straight in found.gaps[place]), default=0.0) for place in group]
        if max(lengths) - min(lengths) > max(METRES, (RATIO - 1) * min(lengths)):
            yield Complaint(
                f"asked for straights alike, they have {min(lengths):.0f} to {max(lengths):.0f} m"
            )


def _wanted(asked: Outline, count: int) -> tuple[list[Feature], list[list[Feature]]] | None:
    """Returns the required turns, and the straights required in each gap; None if it is not known which turn
    is which."""
    turns: list[Feature] = []
    gaps: list[list[Feature]] = [[]]
    for group in asked.groups:
        for _ in range(group.lo):
            if group.feature.kind == "straight":
                gaps[-1].append(group.feature)
            else:
                turns.append(group.feature)
                gaps.append([])
    if not turns and not gaps[0]:
        turns, gaps = [OPEN_TURN] * count, [[] for _ in range(count + 1)]
    if len(turns) != count:
        kinds = {turn.name for turn in turns}
        if len(kinds) != 1 or any(gaps) or len(like_groups(turns)) > 1:
            return None
        turns, gaps = turns[:1] * count, [[] for _ in range(count + 1)]
    for end, place in ((asked.starts, 0), (asked.ends, -1)):
        if end is not None and end.kind == "turn" and turns:
            turns[place] = both(turns[place], end)
        elif end is not None and end.kind == "straight":
            gaps[place] = [both(gaps[place][0], end)] if len(gaps[place]) == 1 else [*gaps[place], end]
    return turns, gaps


def complaints(found: RoadMeasures, asked: Outline) -> list[Complaint]:
    """Returns one Complaint for each requirement of an Outline that a measured road does not meet."""
    out = list(_counts(found, asked))
    if len(found.turns) in asked.turns:
        out += sequence_complaints(found, asked)
        if asked.alike:
            out += likeness_complaints(found, asked)
    for number, turn in enumerate(found.turns, 1):
        out += turn_complaints(number, turn, asked.each_turn)
    out += _slopes(found, asked)
    for name, row in ROAD.items():
        span, value = getattr(asked, name), getattr(found, name)
        if span and value not in span:
            text = f"asked for {row.asked.format(span)}, has {row.measured.format(value)}"
            out.append(Complaint(text, on_heights=row.on_heights))
    return out + list(_ends(found, asked))


def speed_complaints(road: Road, speed: SpeedLimits) -> Iterator[Complaint]:
    """Yields a complaint about the tightest place, the sharpest crest and the sharpest sag of a road, if the
    design speed requires a larger radius."""
    s, bend = tightest(road)
    begin, end, changes = vertical_bends(road)
    worst = int(changes.argmin()), int(changes.argmax())
    middles = [float(begin[at] + end[at]) / 2 for at in worst]
    for what, at, curvature, least in (
        ("radius", s, abs(bend), speed.radius),
        ("vertical radius of a crest", middles[0], -float(changes[worst[0]]), speed.crest),
        ("vertical radius of a sag", middles[1], float(changes[worst[1]]), speed.sag),
    ):
        if curvature * least > 1 + ROUNDING_OF_CURVATURE:
            asked = f"asked for a {what} of {least:.0f} m or more for {speed.kmh:g} km/h"
            yield Complaint(f"{asked}, has {1 / curvature:.0f} m", at, on_heights=what != "radius")


def _counts(found: RoadMeasures, asked: Outline) -> Iterator[Complaint]:
    number = len(found.turns)
    counts = {"turns": number, "left": found.count("left"), "right": found.count("right")}
    for name, has in counts.items():
        span: Range = getattr(asked, name)
        if has not in span:
            plural = "" if span.lo == span.hi == 1 else "s"
            yield Complaint(f"asked for {span} {COUNTS[name]}{plural}, has {has}")
    if number in asked.turns and asked.turns.hi == 0 and found.turning not in NO_TURN:
        yield Complaint(f"asked for a straight road, turns {found.turning:.1f} degrees in all")
    for second, (one, other) in enumerate(pairwise(found.turns), 2):
        if asked.alternating and one.side == other.side:
            text = f"asked for turns to alternate, turns {second - 1} and {second} both go {one.side}"
            yield Complaint(text, other.start)


def _slopes(found: RoadMeasures, asked: Outline) -> Iterator[Complaint]:
    """Checks the whole road: up or down on average and nowhere the other way, or level everywhere."""
    low, high, mean = found.lowest_grade, found.highest_grade, found.grade
    whole = 100 * found.climb / found.length
    is_so = {
        "up": whole >= LEVEL and low > -LEVEL,
        "down": whole <= -LEVEL and high < LEVEL,
        "flat": low > -LEVEL and high < LEVEL,
    }
    if asked.grade and not is_so[asked.grade]:
        grades = f"{whole:.1f} % on average and {low:.1f} to {high:.1f} % over 20 m"
        yield Complaint(
            f"asked for a road that {WHOLE_SLOPES[asked.grade]} all the way, has {grades}", on_heights=True
        )
    if asked.grade in ("up", "down") and asked.grade_range and mean not in asked.grade_range:
        yield Complaint(f"asked for a mean grade of {asked.grade_range} %, has {mean:.1f} %", on_heights=True)


def _ends(found: RoadMeasures, asked: Outline) -> Iterator[Complaint]:
    for feature, index, says in ((asked.starts, 0, "start"), (asked.ends, -1, "end")):
        if feature is None:
            continue
        among = found.turns if feature.kind == "turn" else found.features
        last = among[index] if among else None
        if last is None or last.kind != feature.kind:
            yield Complaint(f"asked to {says} with a {feature.name}, does not")
        elif feature.kind == "turn":
            number = len(found.turns) if index else 1
            yield from turn_complaints(number, last, feature)
        elif not (fits(last, feature) or fits(last.pieces[index], feature)):
            text = f"asked to {says} with another straight than the one it has"
            yield Complaint(text, last.start, on_heights=feature.grade is not None)


def lane_complaints(profile: Profile, asked: Brief) -> Iterator[Complaint]:
    """Yields a complaint for each requirement of lanes that the cross-section of a road does not meet."""
    forward, backward = profile.count
    if forward not in span(asked.lanes):
        yield Complaint(f"asked for {asked.lanes} lanes, has {forward}")
    if backward not in span(asked.against):
        yield Complaint(f"asked for {asked.against} oncoming lanes, has {backward}")
    if asked.divided and not profile.is_divided:
        yield Complaint("asked for a median, has none")
    if asked.centre is not None and backward and profile.centre_marking != asked.centre:
        yield Complaint(f"asked for a {asked.centre} centre line, has a {profile.centre_marking} one")


def place_complaints(found: MeasuredJunction | MeasuredLanes, asked: JunctionClause) -> Iterator[str]:
    """Yields each requirement that a junction or a place where lanes change does not meet."""
    if isinstance(found, MeasuredLanes):
        if found.kind != asked.kind:
            yield f"asked for a {asked.name}, has a {NAMES[found.kind][0]}"
        side = asked.take or asked.side
        if side is not None and found.side != side:
            yield f"asked for the {side} side, is on the {found.side}"
    elif asked.kind in LANE_KINDS:
        yield f"asked for a {asked.name}, has a {found.kinds[0] if found.kinds else 'junction'}"
    else:
        yield from junction_complaints(found, asked)


def length_range(length: Amount | None) -> Range:
    """Returns the range of measured lengths in metres that meet a required length."""
    return about(length, ROAD["length"].slack)


def junction_complaints(found: MeasuredJunction, asked: JunctionClause) -> Iterator[str]:
    """Yields each requirement that a junction does not meet."""
    is_any = asked.kind == "junction" and not {"roundabout", *RAMPS} & {*found.kinds}
    if not is_any and asked.kind not in found.kinds:
        gaps = ", ".join(f"{gap:.0f}" for gap in found.gaps)
        yield f"asked for a {asked.name}, has arms {gaps} degrees apart"
    if found.arms not in span(asked.arms):
        yield f"asked for {asked.arms} arms, has {found.arms}"
    if asked.ways and sorted(found.ways_on) != sorted(asked.ways):
        yield f"asked for ways to the {' and '.join(asked.ways)}, has {' and '.join(found.ways_on)}"
    for sides, said, own in (
        (asked.only_in, "towards", found.only_in),
        (asked.only_out, "away from", found.only_out),
    ):
        if not {*sides} <= {*own}:
            yield f"asked for a one-way road {said} the junction on the {' and '.join(sides)}, has none there"
    if found.exit not in span(asked.exit):
        yield f"asked for exit {asked.exit}, takes exit {found.exit}"
    if asked.take is not None and not takes(found, asked):
        yield f"asked to {ROADS['takes'][asked.take]}, turns {found.turn:.0f} degrees"
    control = asked.control
    if control in ("none", "priority") and "roundabout" in found.kinds:
        control = "yield"  # everybody gives way to those on the ring
    if control not in (None, found.control):
        yield f"asked for {asked.control}, has {found.control}"
    if asked.skew and min(found.gaps) >= SKEW:
        yield f"asked for skew crossroads, the least angle is {min(found.gaps):.0f} degrees"
    if not is_about(abs(found.turn), asked.degrees):
        yield f"asked for a turn of {asked.degrees} degrees, is {abs(found.turn):.0f} degrees"
    if not is_about(min(found.gaps), asked.angle):
        yield f"asked for roads {asked.angle} degrees apart, the least angle is {min(found.gaps):.0f} degrees"
    yield from _sizes(found, asked)
    yield from _of_ramp(found, asked)
    yield from _of_turn_lanes(found, asked)
    if asked.all_way and set(found.all_controls) != {asked.control}:
        yield f"asked for {asked.control} at every arm, has {', '.join(found.all_controls)}"
    give_way = {*found.all_controls} - {"priority"}
    nobody_does = bool(asked.only_out) and not give_way  # all other roads lead away only
    if asked.others_stop and give_way != {"stop"} and not nobody_does:
        yield f"asked for stop signs for the others, has {', '.join(found.all_controls)}"


def _of_ramp(found: MeasuredJunction, asked: JunctionClause) -> Iterator[str]:
    side, lane, taper = (None, None, None) if found.ramp is None else found.ramp[1:]
    if asked.side not in (None, side):
        yield f"asked for a ramp on the {asked.side}, is on the {side}"
    for name, length, own in (("lane", asked.length, lane), ("taper", asked.taper, taper)):
        if own is not None and own not in length_range(length):
            yield f"asked for a {name} of {length} m, has {own:.0f} m"


def _of_turn_lanes(found: MeasuredJunction, asked: JunctionClause) -> Iterator[str]:
    from roadgpt.brief.junction_check import TURN_LENGTHS

    allowed = TURN_LENGTHS if asked.turn_length is None else length_range(asked.turn_length)
    for side in asked.turn_lanes:
        length = max((own for way, own in found.turn_lanes if way == side), default=None)
        if length is None:
            yield f"asked for a lane that leads to the {side} only, has none"
        elif length not in allowed:
            yield f"asked for a {side}-turn lane of {allowed} m, has {length:.0f} m"


def takes(found: MeasuredJunction, asked: JunctionClause) -> bool:
    """Returns whether the route leaves a junction in the required direction."""
    take, turn = asked.take, found.turn
    if take in ("ramp", "main"):
        return found.ramp is not None and found.is_ramp is (take == "ramp")
    if take == "back":
        return found.exit == found.arms
    if found.exit == found.arms:
        return False
    if take is not None and take.startswith(("sharp", "slight")):
        side = take.rpartition("_")[2]
        same = [each for each, way in zip(found.ways, found.sides, strict=True) if way == side]
        pick = max if take.startswith("sharp") else min
        return bool(same) and turn == pick(same, key=abs) and bends_as(take, turn)
    if asked.kind == "y_junction" and take in ("left", "right"):
        return turn == (max(found.ways) if take == "left" else min(found.ways))
    return take == found.sides[found.exit - 1]


def _sizes(found: MeasuredJunction, asked: JunctionClause) -> Iterator[str]:
    if found.ring is None:
        return
    island, outer = found.ring.radius, 2 * (found.ring.radius + found.ring.width)
    if found.ring_lanes not in span(asked.lanes):
        yield f"asked for a ring with {asked.lanes} lanes, has {found.ring_lanes}"
    if asked.size is not None:
        size = SIZES[asked.size]
        if outer not in Range(size.lo - ROUNDING, size.hi + ROUNDING):
            yield f"asked for a {asked.size} roundabout, {size} m wide, is {outer:.1f} m wide"
    if asked.outer is not None:
        wanted = span(asked.outer)
        if outer not in Range(wanted.lo - ROUNDING, wanted.hi + ROUNDING):
            yield f"asked for a roundabout {asked.outer} m across, is {outer:.1f} m across"
    if island not in about(asked.radius, lambda radius: SLACK * radius):
        yield f"asked for an island of {asked.radius} m radius, has {island:.1f} m"


def map_complaints(
    found: MeasuredMap, asked: MapClause, length: Amount | None, goes: Sequence[str]
) -> Iterator[Complaint]:
    """Yields a complaint for each requirement that a map does not meet. ``length`` is the required length in
    metres of all roads outside junctions. ``goes`` are the sides to which the route goes at its junctions."""
    yield from map(Complaint, _whole_map(found, asked))
    if asked.route and [*goes] != [*asked.route]:
        ways = f"{', '.join(asked.route)}, goes {', '.join(goes) or 'nowhere'}"
        yield Complaint(f"asked for a route that goes {ways}")
    if found.length not in length_range(length):
        yield Complaint(f"asked for {length} m of roads in all, has {found.length:.0f} m")
    if asked.signed or any(each.control for each in asked.junctions):
        yield from map(Complaint, _controls(found, asked))
        return
    for node in found.nodes:
        if asked.control is not None and not _has_control(node, asked.control):
            x, y = node.place
            has = " and ".join(SIGNS[each] for each in sorted(node.controls))
            text = f"asked for {SIGNS[asked.control]} at all junctions, near ({x:.0f}, {y:.0f}): {has}"
            yield Complaint(text, place=node.place)


def _whole_map(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    if found.parts > 1:
        yield f"asked for one map, has {found.parts} parts that no road joins"
    yield from _kinds(found, asked) if asked.junctions else _grid(found, asked)
    if found.blocks not in span(asked.blocks):
        yield f"asked for {asked.blocks} enclosed blocks, has {found.blocks}"
    if found.ends not in span(asked.dead_ends):
        yield f"asked for {asked.dead_ends} dead ends, has {found.ends}"
    if asked.length is not None:
        allowed = _allowed(asked.length)
        wrong = [each for each in found.distances if each not in allowed]
        if wrong:
            worst = max(wrong, key=lambda each: max(allowed.lo - each, each - allowed.hi))
            yield f"asked for {asked.length} m between junctions, two are {worst:.0f} m apart"


def _grid(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    columns, rows = span(asked.columns), span(asked.rows)
    blocks = Range(max(columns.lo, 1) * max(rows.lo, 1), columns.hi * rows.hi)
    if found.blocks not in blocks:
        yield f"asked for {asked.columns} by {asked.rows} blocks, has {found.blocks}"
    low, high = ((side + 1) * (other + 1) for side, other in ((columns.lo, rows.lo), (columns.hi, rows.hi)))
    if math.isfinite(low) and len(found.nodes) not in Range(low - CORNERS, high):
        count = plural(len(found.nodes), "junction")
        wanted = f"{low - CORNERS:g} to {high:g}"
        yield f"a grid of {asked.columns} by {asked.rows} blocks has {wanted} junctions, not {count}"


def _kinds(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    total = _in_all(asked.junctions)
    if len(found.nodes) not in total:
        yield f"asked for {total} junctions in all, has {len(found.nodes)}"
    free = sum(span(each.count).hi for each in asked.junctions if each.kind == "junction")
    named = [each for each in asked.junctions if each.kind != "junction"]
    for kind in dict.fromkeys(each.kind for each in named):
        own = _in_all(each for each in named if each.kind == kind)
        allowed = Range(own.lo, own.hi + free)
        number = sum(kind in node.kinds for node in found.nodes)
        if number not in allowed:
            yield f"asked for {allowed} of the kind {NAMES[kind][0]}, has {number}"


def _in_all(asked: Iterable[JunctionCount]) -> Range:
    counts = [span(each.count) for each in asked]
    return Range(sum(each.lo for each in counts), sum(each.hi for each in counts))


def _controls(found: MeasuredMap, asked: MapClause) -> Iterator[str]:
    """Checks the signs of a map whose kinds of junctions have their own, or of a grid some of whose junctions
    have; all other junctions of a grid have the sign of the grid, or none."""
    kinds, left = asked.signed or asked.junctions, len(found.nodes)
    wanted = [control for control in map(asked.control_of, kinds) if control is not None]
    for control in dict.fromkeys(wanted):
        allowed = _in_all(each for each in kinds if asked.control_of(each) == control)
        number = sum(_has_control(node, control) for node in found.nodes)
        left -= number
        is_too_often = number > allowed.hi and (bool(asked.signed) or control in NEVER_USUAL)
        if number < allowed.lo or is_too_often:
            where = "of the junctions of the grid" if asked.signed else "junctions"
            yield f"asked for {SIGNS[control]} at {allowed} {where}, has {number}"
    for each in kinds:
        held, is_any = asked.control_of(each), each.kind == "junction"  # any but a roundabout
        own = [n for n in found.nodes if ("roundabout" not in n.kinds if is_any else each.kind in n.kinds)]
        if held is not None and (number := sum(_has_control(n, held) for n in own)) < span(each.count).lo:
            yield f"asked for {SIGNS[held]} at {each.count} of the kind {NAMES[each.kind][0]}, has {number}"
    usual: Control = asked.control or "none"
    number = sum(_has_control(node, usual) for node in found.nodes)
    if asked.signed and number != left:
        yield f"asked for {SIGNS[usual]} at the {left} other junctions of the grid, has {number}"


def _allowed(length: Amount) -> Range:
    asked = span(length)
    slack = max(ROAD["length"].slack(asked.lo), SHARE * asked.lo) if asked.lo > 0 else 0.0
    return Range(asked.lo - slack, asked.hi + (slack or SHARE * asked.hi))


def _has_control(node: MeasuredNode, control: Control) -> bool:
    """Returns whether a junction has the requested signs: lights and "none" at all arms, others at one at
    least."""
    if control in ("none", "priority", "yield") and "roundabout" in node.kinds:
        return node.controls == {"yield"}  # everybody gives way to those on the ring
    if control in ("lights", "none"):
        return node.controls == {control}
    return ("yield" if control == "priority" else control) in node.controls
