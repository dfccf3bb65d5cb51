"""Reads the roads of an OpenDRIVE map, with all their lanes.

A road of a network has the same lanes from its start to its end. So a road of the file becomes one road for
each stretch of its lane sections that have the same lanes, and these are joined. A connecting road inside a
junction becomes one road for each direction of its traffic; if its lanes change on the way, these roads have
only the lanes that lead all the way through."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry import CubicProfile, ElevationProfile, Piece, PieceCurve, project
from roadgpt.geometry.curve import Array
from roadgpt.geometry.elevation import Row, closed, shifted
from roadgpt.network.stretch import turned
from roadgpt.road import Profile, Road
from roadgpt.road.opendrive.line import (
    exact,
    fitted,
    misses,
    reference_line,
    smoothed,
    turns_back,
    walk,
)
from roadgpt.road.opendrive.profile import (
    MARKS,
    UNITS,
    LaneElement,
    Stretch,
    combined,
    elevation,
    jumps,
    lane_elements,
    limited,
    longest_first,
    plain,
    width_rows,
)
from roadgpt.road.opendrive.tree import DRIVING, cubics, in_order, number
from roadgpt.road.profile import FASTEST, MOST_LANES, STEEPEST, WIDEST, Kind, Lane, Marking
from roadgpt.road.road import check_grade

SHORT = 0.05  # m; a shorter lane section is left out, and the lanes before it go on in those behind it
NO_WIDTH = 1e-3  # m; a lane that is nowhere wider is left out
MEETS, SAME_WAY = 0.002, 0.001  # m and rad, between the elements of a line that stays as it is
FAR = 0.1  # m, that a line may be rounded off without saying how much
TOLD = 3  # places that a remark lists
THIN = 0.25  # m; a lane that is nowhere wider is no lane that a car could use
UNLINKED = "no lane is linked to those behind it, and lanes with the same ids continue each other"
KINDS: Mapping[str, Kind] = {
    **dict.fromkeys(DRIVING, "driving"),
    "shoulder": "shoulder",
    "stop": "shoulder",
    "border": "border",
    "parking": "parking",
    "biking": "biking",
    "sidewalk": "sidewalk",
    "walking": "sidewalk",
    "median": "median",
    "curb": "curb",
    **dict.fromkeys(("restricted", "bus", "taxi", "HOV"), "restricted"),
    **dict.fromkeys(("tram", "rail"), "rail"),
}
"""What the lanes are for, by their type in the file; lanes of all other types are strips for nothing."""

Pairs = set[tuple[int, int]]
"""Ids of lanes in the file, each with the id of the lane that continues it."""


class Remarks:
    """Sentences about what was changed or left out, each with the roads on which that happened."""

    def __init__(self) -> None:
        self._where = defaultdict[str, list[str]](list)

    def add(self, what: str, where: str) -> None:
        """Adds a sentence about one place, such as a road."""
        self._where[what].append(where)

    def sentences(self) -> tuple[str, ...]:
        """Returns one sentence for each remark, with the first places and the number of all others."""
        return tuple(f"{what} ({_listed(list(dict.fromkeys(at)))})" for what, at in self._where.items())


def _listed(places: Sequence[str]) -> str:
    more = f" and {len(places) - TOLD:,} more" if len(places) > TOLD else ""
    return f"{', '.join(places[:TOLD])}{more}"


class FileSection(NamedTuple):
    """One lane section of a road, between two stations of the file in metres. If sections beside it were left
    out, it reaches over them with what its own part says, from station ``own[0]`` to ``own[1]``."""

    start: float
    end: float
    own: tuple[float, float]
    left: tuple[LaneElement, ...]  # from the centre line outwards
    right: tuple[LaneElement, ...]
    centre: tuple[Element, ...]

    @property
    def ids(self) -> dict[int, LaneElement]:
        """The lanes by their ids in the file."""
        return {int(number(lane.node, "id")): lane for lane in (*self.left, *self.right)}

    @property
    def driving(self) -> set[int]:
        """The ids of the lanes that cars may use."""
        return {lane for lane, own in self.ids.items() if own.kind in DRIVING}

    def links(self, name: str) -> Pairs:
        """Returns the links of the lanes, as pairs of an own id and the id in the neighbouring section."""
        found: Pairs = set()
        for lane, own in self.ids.items():
            for node in own.node.findall(f"link/{name}"):
                found.add((lane, int(number(node, "id"))))
        return found


@dataclass
class LaneStretch:
    """Lane sections of a road, one after another, that have the same lanes."""

    sections: list[FileSection]
    road: Road | None = None
    lanes: dict[int, int] = field(default_factory=dict)
    """The ids of the lanes in the network, by their ids in the file."""

    @property
    def start(self) -> float:
        """The station in metres at which it begins in the file."""
        return self.sections[0].start

    @property
    def end(self) -> float:
        """The station in metres at which it ends in the file."""
        return self.sections[-1].end


@dataclass
class FileRoad:
    """A road of the file."""

    id: str
    node: Element
    junction: str  # the id of its junction; empty if it is no connecting road
    left_hand: bool
    line: "PlacedLine"
    heights: CubicProfile
    offset: CubicProfile
    angle: CubicProfile | None  # the superelevation in radians, positive where it falls to the right
    stretches: list[LaneStretch]
    joints: list[Pairs]  # which lanes continue each other from one stretch to the next
    entry: dict[int, int]  # the lanes of the first stretch, by the ids in the first section of the file
    exit: dict[int, int]  # the same at the end
    speeds: list[tuple[float, float | None]]  # stations in metres, and the speed limit in m/s from there on

    def ends(self, name: str) -> tuple[str, str, str] | None:
        """Returns type, id and contact point of the ``predecessor`` or ``successor``; None without one."""
        node = self.node.find(f"link/{name}")
        if node is None:
            return None
        kind = node.get("elementType", "road")
        return kind, node.get("elementId", ""), node.get("contactPoint", "start")


class PlacedLine(NamedTuple):
    """The reference line of a road, and the stations of the file at stations of the line, both in metres."""

    plan: PieceCurve
    of_file: Array
    own: Array

    def station(self, s: float) -> float:
        """Returns the station on the line of a station in the file."""
        return float(np.interp(s, self.of_file, self.own))


def read_road(node: Element, remarks: Remarks) -> FileRoad | None:
    """Returns a road of the file, or None if it has no lane that cars may use. Raises UsageError if its line
    or its lanes cannot be read."""
    road_id = node.get("id", "?")[:40]
    where = f"road {road_id}"
    for remark in in_order(node):
        remarks.add(remark.partition(" (")[0], where)
    line = _line(node, remarks, where)
    length = float(line.of_file[-1])
    sections = _sections(node, length)
    if not any(section.driving for section in sections):
        remarks.add("left out: roads without a lane for cars", where)
        return None
    heights = elevation(node)
    check_grade(heights, length)
    if jumps(heights, length):
        remarks.add("its height jumps", where)
    if not all(_linked(one, two) for one, two in pairwise(sections)):
        remarks.add(UNLINKED, where)
    stretches, joints, entry, leaving = _stretches(sections)
    junction = node.get("junction", "-1")
    return FileRoad(
        road_id,
        node,
        "" if junction in ("-1", "") else junction,
        node.get("rule", "RHT") == "LHT",
        line,
        heights,
        cubics(node.findall("lanes/laneOffset"), "s") or CubicProfile.constant(0.0),
        cubics(node.findall("lateralProfile/superelevation"), "s"),
        stretches,
        joints,
        entry,
        leaving,
        [
            (number(each, "s", 0.0), speed_of(found, remarks, where))
            for each in node.findall("type")
            if (found := each.find("speed")) is not None
        ],
    )


def _line(node: Element, remarks: Remarks, where: str) -> PlacedLine:
    line = reference_line(node)
    plan = exact(line, MEETS, SAME_WAY)
    if plan is not None:
        ends = np.array([0.0, plan.length])
        return PlacedLine(plan, ends, ends)
    walked = walk(line, None)
    if turns_back(walked) is not None:
        raise UsageError("its line turns back")
    fit = fitted(walked) or smoothed(walked)
    if fit is None:
        raise UsageError("its line has gaps or kinks so close together that no curve follows it")
    if misses(walked):
        apart = float(np.abs(project(fit[0], walked.poses[:, :2])[1]).max())
        by = f", by more than {FAR:g} m" if apart > FAR else ""
        remarks.add(f"its line has kinks or gaps, and is rounded off there{by}", where)
    return PlacedLine(*fit)


def _sections(node: Element, length: float) -> list[FileSection]:
    nodes = node.findall("lanes/laneSection")
    if not nodes:
        raise UsageError("it has no lane section")
    starts = [max(number(each, "s"), 0.0) for each in nodes]
    found = []
    for each, (start, end) in zip(nodes, pairwise([*starts, length]), strict=True):
        left, right = (lane_elements(each, side, start) for side in ("left", "right"))
        if max(len(left), len(right)) > MOST_LANES:
            raise UsageError(f"it has more than {MOST_LANES} lanes on one side")
        found.append(FileSection(start, end, (start, end), left, right, tuple(each.findall("center/lane"))))
    return found


def _stretches(
    sections: list[FileSection],
) -> tuple[list[LaneStretch], list[Pairs], dict[int, int], dict[int, int]]:
    """Joins sections that have the same lanes, and leaves out those that are shorter than ``SHORT``; returns
    the stretches, the links between them, and the lanes at both ends by their ids in the file."""
    joints = [_joint(one, two) for one, two in pairwise(sections)]
    entry, leaving = ({lane: lane for lane in sections[at].ids} for at in (0, -1))
    kept = list(sections)
    n = 0
    while n < len(kept):
        own = kept[n]
        if own.end - own.start >= SHORT or len(kept) == 1:
            n += 1
            continue
        if n == 0:
            entry = _followed(entry, joints[0])
            kept[1] = kept[1]._replace(start=own.start)
            del joints[0]
        elif n == len(kept) - 1:
            leaving = _followed(leaving, {(b, a) for a, b in joints[-1]})
            kept[-2] = kept[-2]._replace(end=own.end)
            del joints[-1]
        else:
            joints[n - 1 : n + 1] = [{(a, d) for a, b in joints[n - 1] for c, d in joints[n] if b == c}]
            kept[n - 1] = kept[n - 1]._replace(end=own.end)
        del kept[n]
    stretches, between = [LaneStretch([kept[0]])], list[Pairs]()
    for joint, section in zip(joints, kept[1:], strict=True):
        before = stretches[-1].sections[-1]
        same = [(lane, own.kind) for lane, own in before.ids.items()]
        goes_on = same == [(lane, own.kind) for lane, own in section.ids.items()]
        if goes_on and joint >= {(lane, lane) for lane in section.driving} and len(joint) <= len(same):
            stretches[-1].sections.append(section)
        else:
            stretches.append(LaneStretch([section]))
            between.append(joint)
    return stretches, between, entry, leaving


def _followed(lanes: dict[int, int], joint: Pairs) -> dict[int, int]:
    onward = dict(joint)
    return {lane: onward[at] for lane, at in lanes.items() if at in onward}


def _linked(one: FileSection, two: FileSection) -> Pairs:
    found = one.links("successor") | {(b, a) for a, b in two.links("predecessor")}
    return {(a, b) for a, b in found if a in one.ids and b in two.ids}


def _joint(one: FileSection, two: FileSection) -> Pairs:
    return _linked(one, two) or {(lane, lane) for lane in one.ids.keys() & two.ids.keys()}


def speed_of(node: Element, remarks: Remarks, where: str) -> float | None:
    """Returns the speed limit in m/s of an element ``speed``; None if it states none."""
    text = node.get("max", "undefined")
    if text in ("no limit", "undefined"):
        return None
    if (unit := node.get("unit", "m/s")) not in UNITS:
        remarks.add(f"a speed limit is in '{unit[:20]}', and is taken as one in m/s", where)
    return _usable(number(node, "max") / UNITS.get(unit, 1.0), "speed limit", remarks, where)


def _usable(value: float, what: str, remarks: Remarks, where: str) -> float | None:
    if 0 < value <= FASTEST:
        return value
    remarks.add(f"a {what} of {value:.4g} is not used", where)
    return None


class _Scale(NamedTuple):
    """How stations of the file become stations of one road of the network."""

    start: float
    end: float
    length: float  # m, of the road

    def moved(self, rows: Sequence[Row]) -> CubicProfile:
        ratio = self.length / (self.end - self.start)
        return closed(
            [
                ((s - self.start) * ratio, (a, b / ratio, c / ratio**2, d / ratio**3))
                for s, (a, b, c, d) in rows
            ],
            self.length,
        )


def _part(line: PlacedLine, start: float, end: float) -> PieceCurve:
    """Returns the reference line between two stations of the file."""
    a, b = line.station(start), line.station(end)
    pieces, at = list[Piece](), 0.0
    for piece in line.plan.pieces:
        low, high = max(a - at, 0.0), min(b - at, piece.length)
        if high - low > 1e-9:
            bend = (piece.k1 - piece.k0) / piece.length
            pieces.append(Piece(high - low, piece.k0 + low * bend, piece.k0 + high * bend))
        at += piece.length
    x, y = line.plan.at(a).tolist()
    return PieceCurve(x, y, float(line.plan.heading(a)), tuple(pieces))


def _reaching(rows: list[Row], start: float) -> list[Row]:
    """Returns rows of which the first one begins at another station, with the same cubic."""
    (s, cubic), *rest = rows
    a, b, c, d = shifted(np.array(cubic), start - s).tolist()
    return [(start, (a, b, c, d)), *rest]


def _constant(width: CubicProfile) -> float | CubicProfile:
    varies = len(width.stations) > 1 or any(width.coefficients[0][1:])
    return width if varies else width.coefficients[0][0]


def _marking(lanes: Sequence[tuple[float, float, Element]]) -> Marking:
    """Returns the marking that a lane has on the longest part of its sections, given by start, end and XML
    element."""
    found: dict[Marking, float] = {}
    for start, end, node in lanes:
        marks = node.findall("roadMark")
        at = [start, *(min(max(start + number(each, "sOffset", 0.0), start), end) for each in marks), end]
        kinds: list[Marking] = ["none", *(MARKS.get(each.get("type", "none"), "none") for each in marks)]
        for kind, (a, b) in zip(kinds, pairwise(at), strict=True):
            found[kind] = found.get(kind, 0.0) + b - a
    return max(found, key=lambda kind: found[kind])


class RoadBuilder:
    """Makes the roads of a network from those of a file."""

    def __init__(self, road: FileRoad, remarks: Remarks) -> None:
        self.file, self.remarks = road, remarks

    def _widths(self, stretch: LaneStretch, lane: int) -> list[Row]:
        """Returns the width of a lane of a stretch, on the stations of the file."""
        rows = list[Row]()
        for section in stretch.sections:
            side = section.left if lane > 0 else section.right
            place = next(n for n, own in enumerate(side) if int(number(own.node, "id")) == lane)
            rows += _reaching(width_rows(side, place, *section.own), section.start)
        if closed(rows, stretch.end).beyond(0.0, WIDEST):
            self.remarks.add("the width of a lane is negative or above 100 m, and is limited", self.name)
        return limited(rows, stretch.end, 0.0, WIDEST)

    def _offset(self, stretch: LaneStretch) -> list[Row]:
        """Returns the offset of the line between the directions, on the stations of the file."""
        parts = [
            _reaching(combined([(1.0, self.file.offset)], *section.own), section.start)
            for section in stretch.sections
        ]
        return [row for part in parts for row in part]

    @property
    def name(self) -> str:
        """What remarks call the road."""
        return f"road {self.file.id}"

    def build(self, stretch: LaneStretch) -> Road:
        """Returns the road of a stretch, and stores the ids of its lanes there."""
        plan = _part(self.file.line, stretch.start, stretch.end)
        scale = _Scale(stretch.start, stretch.end, plan.length)
        first = stretch.sections[0]
        sides = list[tuple[Lane, ...]]()
        for sign, lanes in ((1, first.left), (-1, first.right)):
            made = list[Lane]()
            for own in lanes:
                lane = int(number(own.node, "id"))
                found = self._lane(stretch, lane, own, scale)
                if found is not None:
                    made.append(found)
                    stretch.lanes[lane] = sign * len(made)
            sides.append(tuple(made))
        offset = _constant(scale.moved(self._offset(stretch)))
        centre = [(each.start, each.end, each.centre[0]) for each in stretch.sections if each.centre]
        return self._road(plan, scale, sides, offset, _marking(centre) if centre else "none")

    def _lane(self, stretch: LaneStretch, lane: int, own: LaneElement, scale: _Scale) -> Lane | None:
        width = scale.moved(self._widths(stretch, lane))
        widest = max(width.extremes()[1], 0.0)
        if widest <= NO_WIDTH:
            return None
        kind = KINDS.get(own.kind, "none")
        if kind == "driving" and widest <= THIN:
            kind = "none"
            self.remarks.add(
                f"a lane for cars that is nowhere wider than {THIN:g} m is a strip here", self.name
            )
        parts = [(each.start, each.end, each.ids[lane]) for each in stretch.sections]
        nodes = [(start, end, part.node) for start, end, part in parts]
        if kind != "driving":
            return Lane(kind, _constant(width), _marking(nodes))
        limit, friction = (self._stated(nodes, tag) for tag in ("speed", "material"))
        middle = (stretch.start + stretch.end) / 2
        if limit is None:
            limit = next((v for s, v in reversed(self.file.speeds) if s <= middle), None)
        for name in ("access", "rule"):
            if any(node.find(name) is not None for _, _, node in nodes):
                self.remarks.add(f"left out: the element {name} of lanes", self.name)
        return Lane(kind, _constant(width), _marking(nodes), limit, friction)

    def _stated(self, lanes: Sequence[tuple[float, float, Element]], tag: str) -> float | None:
        """Returns the speed limit in m/s, or the friction, that holds for most of a lane."""
        found = list[Stretch]()
        for start, end, node in lanes:
            nodes = node.findall(tag)
            at = [*(min(start + number(each, "sOffset", 0.0), end) for each in nodes), end]
            for each, (a, b) in zip(nodes, pairwise(at), strict=True):
                value = speed_of(each, self.remarks, self.name) if tag == "speed" else None
                if tag == "material" and "friction" in each.attrib:
                    value = _usable(number(each, "friction"), "friction", self.remarks, self.name)
                found.append(Stretch(a, b, value))
        values = longest_first(found)
        if len(values) > 1:
            what = "the speed limit" if tag == "speed" else "the friction"
            said = f"{what} of a lane changes on its way, and the one for most of it is taken"
            self.remarks.add(said, self.name)
        return values[0] if values else None

    def _road(
        self,
        plan: PieceCurve,
        scale: _Scale,
        sides: Sequence[tuple[Lane, ...]],
        offset: float | CubicProfile,
        centre: Marking,
    ) -> Road:
        start, end = scale.start, scale.end
        heights: ElevationProfile = scale.moved(combined([(1.0, self.file.heights)], start, end))
        assert isinstance(heights, CubicProfile)
        angle = None
        if self.file.angle is not None:
            rows = combined([(1.0, self.file.angle)], start, end)
            angle = scale.moved(limited(rows, end, -STEEPEST, STEEPEST))
            angle = angle if any(any(cubic) for cubic in angle.coefficients) else None
        left, right = sides
        along = left if self.file.left_hand else right
        driven = max((n for n, lane in enumerate(along) if lane.kind == "driving"), default=0)
        profile = Profile(left, right, driven, centre, angle, offset, self.file.left_hand)
        return Road(plan, plain(heights, plan.length), profile=profile)

    def ways(self) -> "list[Way]":
        """Returns the roads of a connecting road, one for each direction in which lanes lead through it."""
        side = 1 if self.file.left_hand else -1
        return [way for sign in (side, -side) if (way := self._way(sign, sign == side)) is not None]

    def _way(self, sign: int, is_along: bool) -> "Way | None":
        stretches, joints = self.file.stretches, self.file.joints
        first = stretches[0].sections[0]
        chains = [[lane] for lane in sorted(first.driving, key=abs) if lane * sign > 0]
        for joint, stretch in zip(joints, stretches[1:], strict=True):
            onward = {a: b for a, b in joint if b in stretch.sections[0].driving and b * sign > 0}
            if any(chain[-1] not in onward for chain in chains):
                self.remarks.add("left out: lanes that begin or end inside a junction", self.name)
            chains = [[*chain, onward[chain[-1]]] for chain in chains if chain[-1] in onward]
        start, end = stretches[0].start, stretches[-1].end
        plan = _part(self.file.line, start, end)
        scale = _Scale(start, end, plan.length)
        edges = [[self._edges(stretch, chain[n]) for n, stretch in enumerate(stretches)] for chain in chains]
        lanes, ids, outer = list[Lane](), dict[int, int](), list[Row]()
        for chain, own in zip(chains, edges, strict=True):
            inside, beyond = ([row for part in own for row in part[n]] for n in (0, 1))
            width = _difference(beyond, inside, start, end, sign)
            if max(scale.moved(width).extremes()[1], 0.0) <= THIN:
                self.remarks.add("left out: lanes that are too narrow for cars", self.name)
                continue
            if lanes:
                gap = scale.moved(limited(_difference(inside, outer, start, end, sign), end, 0.0, WIDEST))
                if gap.extremes()[1] > NO_WIDTH:
                    lanes.append(Lane("none", _constant(gap)))
            else:
                offset = _constant(scale.moved(inside))
            element = first.ids[chain[0]]
            model = self._lane(stretches[0], chain[0], element, scale) if len(stretches) == 1 else None
            made = Lane("driving", _constant(scale.moved(limited(width, end, 0.0, WIDEST))))
            if model is not None:
                made = replace(made, speed_limit=model.speed_limit, friction=model.friction)
            nodes = [
                (each.start, each.end, each.ids[lane].node)
                for stretch, lane in zip(stretches, chain, strict=True)
                for each in stretch.sections
            ]
            lanes.append(replace(made, marking=_marking(nodes)))
            ids[chain[0]] = sign * len(lanes)
            outer = beyond
        if not ids:
            return None
        last = {chain[-1]: ids[chain[0]] for chain in chains if chain[0] in ids}
        sides = (tuple(lanes), ()) if sign > 0 else ((), tuple(lanes))
        road = self._road(plan, scale, sides, offset, "none")
        at_start = {a: ids[b] for a, b in self.file.entry.items() if b in ids}
        at_end = {a: last[b] for a, b in self.file.exit.items() if b in last}
        if is_along:
            return Way(road, True, at_start, at_end)
        return Way(turned(road), False, *({a: -b for a, b in each.items()} for each in (at_start, at_end)))

    def _edges(self, stretch: LaneStretch, lane: int) -> tuple[list[Row], list[Row]]:
        """Returns the offsets of the inner and the outer edge of a lane, on the stations of the file."""
        sign = 1 if lane > 0 else -1
        inside = [each for each in stretch.sections[0].ids if each * sign > 0 and abs(each) < abs(lane)]
        terms = [(float(sign), CubicProfile.of_rows(self._widths(stretch, each))) for each in inside]
        own = (float(sign), CubicProfile.of_rows(self._widths(stretch, lane)))
        whole = [(1.0, CubicProfile.of_rows(self._offset(stretch))), *terms]
        inner, outer = (combined(some, stretch.start, stretch.end) for some in (whole, [*whole, own]))
        return inner, outer


class Way(NamedTuple):
    """A road for one direction of a connecting road, from where its traffic enters the junction."""

    road: Road
    is_along: bool  # whether it leads along the road of the file
    at_start: dict[int, int]  # ids of its lanes, by those in the first section of the file
    at_end: dict[int, int]  # ids of its lanes, by those in the last section of the file


def _difference(one: list[Row], other: list[Row], start: float, end: float, sign: int) -> list[Row]:
    terms = [(float(sign), CubicProfile.of_rows(one)), (-float(sign), CubicProfile.of_rows(other))]
    return combined(terms, start, end)
