"""Joins the roads of an OpenDRIVE map: with each other, and by junctions with their signs and lights.

The kind of a junction follows from the angles between its roads. Signs are those of the German catalogue,
which most maps use (205 give way, 206 stop, 301 and 306 priority), of the American one (R1-1, R1-2), or have
such a name and no type; in countries with numbers of their own, only these count. Lights are those for cars.
A sign applies to the junction behind it, also over roads that lead there without a junction between."""

import math
import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from xml.etree.ElementTree import Element

import numpy as np

from roadgpt.errors import UsageError
from roadgpt.geometry.curve import Point, wrapped
from roadgpt.language.names import Control
from roadgpt.network import (
    Arm,
    Connection,
    Continuation,
    Junction,
    LaneLink,
    Network,
    NetworkRoad,
    RoadEnd,
    Roundabout,
)
from roadgpt.network.markings import CROSSWALK, STOP_LINE, line_before
from roadgpt.network.network import OTHER_CONTACT, Kind, kinds_of
from roadgpt_formats.opendrive.roads import UNLINKED, FileRoad, OneWay, RoadBuilder
from roadgpt_formats.opendrive.tree import MapRemarks, number

PARALLEL = 30.0  # degrees; arms that are closer together belong to a merge or an exit
BEFORE = 60.0  # m before a junction, within which a sign or a light applies to it
FARTHEST = 150.0  # m, the same for a sign if there is none within ``BEFORE``
MOVED = 0.1  # m; a stop line that is farther from its usual place keeps its own
CROSSING = 25.0  # m from a junction, within which a crosswalk belongs to it
SIGNS: Mapping[str, Control] = {
    **dict.fromkeys(("206", "r1-1"), "stop"),
    **dict.fromkeys(("205", "r1-2"), "yield"),
    **dict.fromkeys(("306", "301"), "priority"),
    **dict.fromkeys(("gb 601.1", "no 204"), "stop"),
    **dict.fromkeys(("gb 602", "no 202"), "yield"),
    "no 206": "priority",
}
OWN_NUMBERS = {"uk": "gb", "gbr": "gb", "nor": "no", "chn": "cn", "jpn": "jp", "kor": "kr", "fin": "fi"}
"""The countries whose catalogues have other numbers than the German one, by their other codes."""
NAMED: Mapping[str, Control] = {"stop": "stop", "yield": "yield", "give way": "yield", "giveway": "yield"}
SAYS_NOTHING = ("", "-1", "0", "none", "unknown")  # types that leave it to the name what a sign means
AROUND_NAMES = {"sign", "signs", "traffic", "road", "stencil", "post", "us", "de", "stvo"}
LIGHTS = re.compile(r"10000(01|09|10|11|12|20)|traffic.?light.*")
"""The types of lights for cars in OpenDRIVE's own catalogue of signals; 1000002, 1000007 and 1000013 are for
people on foot and on bicycles, 1000008 only flashes yellow."""
NOT_FOR_CARS = re.compile(r"pedestrian|bicycle|bike|cycl|tram|crosswalk")
STRONGEST: tuple[Control, ...] = ("lights", "stop", "yield", "priority", "none")
PAINTED = ("294", "341")  # stop line, give-way line
LARGEST_RING = 100.0  # m, radius
FULL = 0.35  # rad, by which the roads and ways around a roundabout may fail to make a full turn
ROUND = 0.15  # ratio by which the distances from the middle of a roundabout may differ

Lanes = dict[int, int]
"""Ids of lanes of the network, by their ids in the file."""


class Joining:
    """The roads of a file as those of a network, and what joins them."""

    def __init__(self, roads: Sequence[FileRoad], junctions: Sequence[Element], remarks: MapRemarks) -> None:
        self.remarks = remarks
        self.files = {road.id: road for road in roads}
        if len(self.files) < len(roads):
            raise UsageError("two of its roads have the same id; give each one of its own")
        known = [each for each in (*self.files, *(j.get("id", "") for j in junctions)) if _is_number(each)]
        self._last = max(map(int, known), default=0)
        self.members: dict[int, NetworkRoad] = {}
        self.parts: dict[str, list[int]] = defaultdict(list)
        self.file_of: dict[int, FileRoad] = {}
        self.ways: dict[str, list[tuple[int, OneWay]]] = {}
        self.continuations: dict[frozenset[RoadEnd], Continuation] = {}
        self.used = set[Element]()  # the signals and lines that a junction has
        self.junctions: dict[str, Junction] = {}
        for road in roads:
            if not road.junction:
                self._add_road(road)
        for one in self.files.values():
            for name in ("predecessor", "successor"):
                self._continue(one, name)
        for node in junctions:
            self._add_junction(node)

    def numbers(self, network: Network) -> dict[str, tuple[int, ...]]:
        """Returns the ids of the roads of a network by those of the file."""
        there = {each.id for each in network.roads}
        return {name: own for name, ids in self.parts.items() if (own := tuple(n for n in ids if n in there))}

    def _number(self, road: FileRoad) -> int:
        if _is_number(road.id) and not self.parts[road.id] and int(road.id) not in self.members:
            return int(road.id)
        self._last += 1
        return self._last

    def _add(self, road: FileRoad, made: NetworkRoad) -> int:
        self.members[made.id] = made
        self.file_of[made.id] = road
        self.parts[road.id].append(made.id)
        return made.id

    def _add_road(self, road: FileRoad) -> None:
        builder = RoadBuilder(road, self.remarks)
        for stretch in road.stretches:
            own, (stretch.lanes, *_) = builder.build(stretch.parts)
            made = self._add(road, NetworkRoad(self._number(road), own))
            profile = self.members[made].profile
            if not (profile.along_ids or profile.against_ids):  # they are too narrow
                del self.members[made]
                self.remarks.add("left out: parts of roads without a lane for cars", f"road {road.id}")
        for n, joint in enumerate(road.joints):
            one, two = (RoadEnd(self.parts[road.id][n + at], "start" if at else "end") for at in (0, 1))
            here, after = road.stretches[n].lanes, road.stretches[n + 1].lanes
            self._join(one, two, [(here[a], after[b]) for a, b in joint if a in here and b in after])

    def _join(self, one: RoadEnd, two: RoadEnd, pairs: Iterable[tuple[int, int]]) -> None:
        """Lets lanes continue each other, of which the first one is of ``one``; lanes for cars only."""
        if one.road not in self.members or two.road not in self.members:
            return
        first, second = self.members[one.road], self.members[two.road]
        into, out = first.ids_towards(one.contact), second.ids_towards(OTHER_CONTACT[two.contact])
        back_in, back_out = second.ids_towards(two.contact), first.ids_towards(OTHER_CONTACT[one.contact])
        own = {(a, b) for a, b in pairs if (a in into and b in out) or (a in back_out and b in back_in)}
        lanes = sorted(own)
        taken = {end for known in self.continuations for end in known}
        if not lanes or frozenset((one, two)) in self.continuations:
            return
        if one in taken or two in taken or one == two:
            where = f"road {self.file_of[one.road].id}"
            self.remarks.add("left out: a second road that continues the same end of a road", where)
            return
        self.continuations[frozenset((one, two))] = Continuation(one, two, tuple(lanes))

    def _end(self, road: str, contact: str) -> RoadEnd | None:
        """Returns the end of a road of the file that is no connecting road."""
        own = self.parts.get(road) if road in self.files and not self.files[road].junction else None
        if not own or contact not in ("start", "end"):
            return None
        end = RoadEnd(own[0], "start") if contact == "start" else RoadEnd(own[-1], "end")
        return end if end.road in self.members else None

    def _lanes_at(self, road: str, contact: str) -> Lanes:
        """Returns the lanes at an end of a road of the file."""
        file, begins = self.files[road], contact == "start"
        lanes = file.stretches[0 if begins else -1].lanes
        return {a: lanes[b] for a, b in (file.entry if begins else file.exit).items() if b in lanes}

    def _continue(self, road: FileRoad, name: str) -> None:
        link, contact = road.ends(name), "start" if name == "predecessor" else "end"
        if road.junction or link is None or link[0] != "road":
            return
        other, own = self._end(link[1], link[2]), self._end(road.id, contact)
        if other is None or own is None:
            if link[1] not in self.files:
                self.remarks.add("it is linked to a road that is left out or not there", f"road {road.id}")
            return
        here, there = self._lanes_at(road.id, contact), self._lanes_at(link[1], link[2])
        next_road = self.files[link[1]]
        pairs = road.links_at(contact, next_road)
        pairs |= {(b, a) for a, b in next_road.links_at(link[2], road)}
        if not pairs:
            self.remarks.add(UNLINKED, f"road {road.id}")
            same = 1 if contact != link[2] else -1
            pairs = {(lane, same * lane) for lane in here}
        self._join(own, other, [(here[a], there[b]) for a, b in pairs if a in here and b in there])

    def _add_junction(self, node: Element) -> None:
        name = node.get("id", "?")[:40]
        where = f"junction {name}"
        kind = node.get("type", "default")
        if kind in ("direct", "virtual", "crossing"):
            self.remarks.add(f"left out: {kind} junctions", where)
            return
        found: dict[int, Connection] = {}
        for each in node.findall("connection"):
            made = self._connection(each, node.get("id", ""), where)
            if made is not None:
                known = found.get(made.road)
                links = made.lanes if known is None else dict.fromkeys((*known.lanes, *made.lanes))
                found[made.road] = replace(made, lanes=tuple(links))
        if not found:
            self.remarks.add("left out: junctions without a way through them that can be read", where)
            return
        is_free = _is_number(name) and int(name) not in {each.id for each in self.junctions.values()}
        self._last += not is_free
        junction = int(name) if is_free else self._last
        for road in found:
            self.members[road] = replace(self.members[road], junction=junction)
        self.junctions[name] = self._made(junction, list(found.values()), node)

    def _connection(self, node: Element, junction: str, where: str) -> Connection | None:
        """Returns a way through a junction; None, with a remark, if it cannot be read."""
        file = self.files.get(node.get("connectingRoad", ""))
        contact = node.get("contactPoint", "start")
        none = "left out: ways that lead from or to no road, or on which no lane does"
        if file is None or not file.junction or file.junction != junction:
            self.remarks.add("left out: ways on roads that are left out or are not of the junction", where)
            return None
        if file.id not in self.ways:
            made = RoadBuilder(file, self.remarks).ways()
            self.ways[file.id] = [
                (self._add(file, NetworkRoad(self._number(file), way.road, 0)), way) for way in made
            ]
        found = next((each for each in self.ways[file.id] if each[1].is_along == (contact == "start")), None)
        names = ("predecessor", "successor") if contact == "start" else ("successor", "predecessor")
        links = [file.ends(name) for name in names]
        before, after = (self._end(*each[1:]) if each and each[0] == "road" else None for each in links)
        if found is None or before is None or after is None or links[0] is None or links[1] is None:
            self.remarks.add(none, where)
            return None
        road, way = found
        first, last = (way.at_start, way.at_end) if way.is_along else (way.at_end, way.at_start)
        here, there = self._lanes_at(*links[0][1:]), self._lanes_at(*links[1][1:])
        from_road, next_road = (self.files[each[1]] for each in (links[0], links[1]))
        one, two = (-1 if each.is_swapped else 1 for each in (from_road, file))
        into = {
            (one * int(number(each, "from")), two * int(number(each, "to")))
            for each in node.findall("laneLink")
        }
        first_end, last_end = ("start", "end") if way.is_along else ("end", "start")
        into = into or {(b, a) for a, b in file.links_at(first_end, from_road)}
        out = file.links_at(last_end, next_road)
        name = "predecessor" if links[1][2] == "start" else "successor"
        if next_road.ends(name) == ("road", file.id, last_end):
            out |= {(b, a) for a, b in next_road.links_at(links[1][2], file)}
        onward = {last[a]: there[b] for a, b in sorted(out) if a in last and b in there}
        incoming, outgoing = self.members[before.road], self.members[after.road]
        lanes = tuple(
            LaneLink(here[a], first[b], onward[first[b]])
            for a, b in sorted(into, key=lambda pair: (abs(pair[1]), abs(pair[0])))
            if a in here
            and b in first
            and first[b] in onward
            and here[a] in incoming.ids_towards(before.contact)
            and onward[first[b]] in outgoing.ids_towards(OTHER_CONTACT[after.contact])
        )
        if not lanes:
            self.remarks.add(none, where)
            return None
        return Connection(road, before, after, lanes)

    def _made(self, junction: int, connections: Sequence[Connection], node: Element) -> Junction:
        ends = list(dict.fromkeys(end for each in connections for end in (each.incoming, each.outgoing)))
        places = np.array([self._pose(end)[:2] for end in ends])
        middle = places.mean(axis=0)
        around = np.arctan2(*(places - middle).T[::-1])
        order = [ends[n] for n in np.argsort(around, kind="stable")]
        controls = self._controls(order, connections, node)
        lines = {end: self._line(end) if controls[end] not in ("none", "priority") else None for end in order}
        arms = tuple(Arm(end, self._pose(end)[2], controls[end], False, lines[end]) for end in order)
        point = self._meeting(order)
        return Junction(junction, self._kind(arms), arms, tuple(connections), point, 0.0)

    def _pose(self, end: RoadEnd) -> tuple[float, float, float]:
        """Returns x, y and the heading out of the junction at an end of a road."""
        road = self.members[end.road].road
        s = 0.0 if end.contact == "start" else road.length
        x, y = road.plan.at(s).tolist()
        return x, y, float(road.heading(s)) + (math.pi if end.contact == "end" else 0.0)

    def _meeting(self, ends: Sequence[RoadEnd]) -> Point:
        """Returns the point nearest to the lines that go on from the ends of roads into a junction."""
        poses = np.array([self._pose(end) for end in ends])
        normal = np.stack([-np.sin(poses[:, 2]), np.cos(poses[:, 2])], axis=1)
        found, _, rank, _ = np.linalg.lstsq(normal, (normal * poses[:, :2]).sum(axis=1), rcond=1e-2)
        middle = poses[:, :2].mean(axis=0)
        reach = 2 * np.linalg.norm(poses[:, :2] - middle, axis=1).max() + 1.0
        if rank < 2 or np.linalg.norm(found - middle) > reach:
            found = middle
        roads = [(self.members[end.road].road, end.contact == "start") for end in ends]
        heights = [float(road.elevation.height(0.0 if begins else road.length)) for road, begins in roads]
        return float(found[0]), float(found[1]), float(np.mean(heights))

    def _kind(self, arms: Sequence[Arm]) -> Kind:
        directions = sorted(math.degrees(arm.direction) % 360 for arm in arms)
        gaps = [(b - a) % 360 for a, b in pairwise([*directions, directions[0]])]
        if len(arms) == 3:
            ends = [(self.members[arm.end.road], arm.end.contact) for arm in arms]
            into = sum(bool(road.ids_towards(contact)) for road, contact in ends)
            out = sum(bool(road.ids_towards(OTHER_CONTACT[contact])) for road, contact in ends)
            if min(gaps) < PARALLEL:
                return "junction" if into == out else "merge" if into > out else "diverge"
        return next(iter(kinds_of(gaps)), "junction") if len(arms) > 2 else "junction"

    def _controls(
        self, ends: Sequence[RoadEnd], connections: Sequence[Connection], node: Element
    ) -> dict[RoadEnd, Control]:
        found: dict[RoadEnd, set[Control]] = {end: {"none"} for end in ends}
        for end in ends:
            before = self._signals(end)
            signs = [(said, away, each) for away, each in before if (said := self._meaning(each))]
            near = [each for each in signs if each[1] <= BEFORE]
            far = [each for each in signs if each[0] != "lights" and each[1] <= FARTHEST]
            for control, _, signal in near or far[:1]:
                found[end].add(control)
                self.used.add(signal)
        for each in connections:
            file = self.file_of[each.road]
            way = next(way for road, way in self.ways[file.id] if road == each.road)
            for signal in file.node.findall("signals/*"):
                said, its_way = self._meaning(signal), signal.get("orientation", "none")
                if said and its_way in ("none", "+" if way.is_along else "-"):
                    found[each.incoming].add(said)
                    self.used.add(signal)
        ranks: tuple[tuple[str, Control], ...] = (("high", "priority"), ("low", "yield"))
        for priority in node.findall("priority"):
            for name, control in ranks:
                for end in ends:
                    if self.file_of[end.road].id == priority.get(name) and found[end] == {"none"}:
                        found[end] = {control}
        chosen = {end: next(each for each in STRONGEST if each in own) for end, own in found.items()}
        into = {end: self.members[end.road].ids_towards(end.contact) for end in ends}
        return {end: control if into[end] else "none" for end, control in chosen.items()}

    def _signals(self, end: RoadEnd, path: str = "signals/*") -> list[tuple[float, Element]]:
        """Returns the signals, or the objects, for traffic towards an end of a road and of those that lead
        there without a junction, with their distances from it in metres; the nearest is the first one."""
        found, passed, away, at = list[tuple[float, Element]](), set[RoadEnd](), 0.0, end
        while at not in passed and away <= FARTHEST:
            passed.add(at)
            file, ends = self.file_of[at.road], at.contact == "end"
            if at.road != self.parts[file.id][-1 if ends else 0]:
                break
            length = file.whole.sections[-1].end
            for node in file.node.findall(path):
                if node.get("orientation", "none") in ("none", "+" if ends else "-"):
                    s = number(node, "s")
                    found.append((away + (length - s if ends else s), node))
            away += length
            start = RoadEnd(self.parts[file.id][0 if ends else -1], OTHER_CONTACT[at.contact])
            at = self._joined.get(start, end)
        return sorted(found, key=lambda each: each[0])

    @cached_property
    def _joined(self) -> dict[RoadEnd, RoadEnd]:
        pairs = [tuple(each) for each in self.continuations]
        return {one: two for pair in pairs for one, two in (pair, pair[::-1])}

    def _line(self, end: RoadEnd) -> float | None:
        """Returns the distance in metres from an end of a road to the stop line of the file; None without."""
        painted = [each for each in self._signals(end) if each[1].get("type") in PAINTED]
        painted += [each for each in self._signals(end, "objects/object") if _is_line(each[1])]
        near = [each for each in painted if each[0] <= BEFORE]
        self.used |= {node for _, node in near}
        return max(min(away for away, _ in near) - STOP_LINE / 2, 0.0) if near else None

    def _meaning(self, signal: Element) -> Control | None:
        """Returns what a signal or a reference to one means at a junction; None if nothing."""
        if signal.tag == "signalReference":
            return self._signal_types.get(signal.get("id", ""))
        return _control(signal) if signal.tag == "signal" else None

    @cached_property
    def _signal_types(self) -> Mapping[str, Control]:
        return {
            node.get("id", ""): control
            for file in self.files.values()
            for node in file.node.findall("signals/signal")
            if (control := _control(node)) is not None
        }

    def network(self) -> Network:
        """Returns the network of all roads and junctions."""
        crossed = self._crosswalks()
        junctions = []
        for each in self.junctions.values():
            arms = [replace(arm, crosswalk=arm.end in crossed) for arm in each.arms]
            usual = [line_before(replace(arm, line=None)) for arm in arms]
            arms = [
                replace(arm, line=None) if arm.line is not None and abs(arm.line - place) < MOVED else arm
                for arm, place in zip(arms, usual, strict=True)
            ]
            junctions.append(replace(each, arms=tuple(arms)))
        for file in self.files.values():
            tell_unread(file.node, self.remarks, f"road {file.id}", self.used)
            if file.junction and file.id not in self.ways:
                self.remarks.add("left out: connecting roads that no junction names", f"road {file.id}")
        at_junctions = {arm.end for junction in junctions for arm in junction.arms}
        known = self.continuations.values()
        joined = [
            replace(each, crosswalk=each.before in crossed)
            for each in known
            if not {each.before, each.after} & at_junctions
        ]
        used = {each.road for junction in junctions for each in junction.connections}
        roads = [each for each in self.members.values() if each.junction is None or each.id in used]
        whole = Network(tuple(sorted(roads, key=lambda each: each.id)), tuple(junctions), (), tuple(joined))
        return _with_roundabouts(whole)

    def _crosswalks(self) -> set[RoadEnd]:
        found = set[RoadEnd]()
        arms = [arm.end for junction in self.junctions.values() for arm in junction.arms]
        places = np.array([self._pose(end)[:2] for end in arms]).reshape(-1, 2)
        for file in self.files.values():
            for node in file.node.findall("objects/object"):
                if node.get("type") != "crosswalk":
                    continue
                at = file.line.plan.at(file.line.station(number(node, "s")))
                away = np.linalg.norm(places - at, axis=1)
                own = [n for n, end in enumerate(arms) if end.road in self.parts[file.id]]
                usual = CROSSWALK[0] + CROSSWALK[1] / 2 if own else 0.0
                nearest = min(own or range(len(arms)), key=lambda n: abs(away[n] - usual), default=None)
                joints = [
                    each.before
                    for each in self.continuations.values()
                    if abs(math.dist(self._pose(each.before)[:2], at) - CROSSWALK[0] - CROSSWALK[1] / 2) < 1.0
                ]
                if nearest is not None and away[nearest] <= CROSSING:
                    found.add(arms[nearest])
                elif joints:
                    found.add(joints[0])
                else:
                    self.remarks.add("left out: crosswalks away from junctions", f"road {file.id}")
        return found


def tell_unread(road: Element, remarks: MapRemarks, where: str, used: Collection[Element] | None) -> None:
    """Adds remarks about objects and signs of a road that are not used; None says that there is no junction
    to which crosswalks, signs and lights would belong."""
    for node in road.findall("objects/object"):
        kind = node.get("type", "")
        if used is None or kind not in ("crosswalk", "roadMark"):
            remarks.add(f"left out: objects {_of_type(kind)}", where)
    for node in road.findall("signals/*"):
        if node not in (used or ()):
            no_place = used is not None and node.tag == "signal" and _control(node) is not None
            more = " that stand before no junction" if no_place else ""
            remarks.add(f"left out: signs {_of_type(node.get('type', ''))}{more}", where)


def _of_type(kind: str) -> str:
    return "without a type" if kind in ("", "-1", "none") else f"of type {kind[:30]}"


def _is_number(name: str) -> bool:
    return name.isascii() and name.isdigit() and len(name) <= 9


def _control(node: Element) -> Control | None:
    """Returns what a signal means at a junction; None if nothing."""
    kind, name = node.get("type", "").strip().lower(), node.get("name", "")
    if LIGHTS.fullmatch(kind.replace(".", "")) and node.get("dynamic", "yes") == "yes":
        return None if NOT_FOR_CARS.search(f"{kind} {name.lower()}") else "lights"
    country = node.get("country", "").strip().lower()
    country = OWN_NUMBERS.get(country, country)
    own = f"{country} " if country in OWN_NUMBERS.values() and kind[:1].isdigit() else ""
    for said in (kind, f"{kind}-{node.get('subtype', '').strip().lower()}"):
        if f"{own}{said}" in SIGNS:
            return SIGNS[f"{own}{said}"]
    words = re.findall("[A-Z]?[a-z]+|[A-Z]+", name if kind in SAYS_NOTHING else node.get("type", ""))
    return NAMED.get(" ".join(word.lower() for word in words if word.lower() not in AROUND_NAMES))


def _is_line(node: Element) -> bool:
    """Returns whether an object is a line across a road at which traffic stops or gives way."""
    said = re.sub("[^a-z]", "", f"{node.get('subtype', '')} {node.get('name', '')}".lower())
    return node.get("type") in ("roadMark", *SAYS_NOTHING) and bool(re.search("signalline|stopline", said))


def _with_roundabouts(network: Network) -> Network:
    """Returns a network in which rings of one-way roads that turn about a middle are roundabouts. Each of
    their junctions must have one road besides those of the ring."""
    side, found = (-1 if network.left_hand else 1), list[Roundabout]()
    starts = {
        end.road: network.junction(number)
        for end, number in network.junction_at.items()
        if end.contact == "start" and not network.road(end.road).profile.against_ids
    }
    taken = set[int]()
    for first in starts:
        ring = _ring(network, first, starts, side) if first not in taken else None
        if ring is not None:
            taken |= {*ring.ring}
            found.append(ring)
    on_ring = {road for ring in found for road in ring.ring}
    centres = {number: ring.centre for ring in reversed(found) for number in ring.junctions}
    junctions = list(network.junctions)
    for n, each in enumerate(junctions):
        if each.id in centres:
            first = next(k for k, arm in enumerate(each.arms) if arm.end.road not in on_ring)
            arms = (*each.arms[first:], *each.arms[:first])
            junctions[n] = replace(each, kind="roundabout", arms=arms, node=centres[each.id])
    return replace(network, junctions=tuple(junctions), roundabouts=tuple(found))


def _ring(network: Network, first: int, starts: Mapping[int, Junction], side: int) -> Roundabout | None:
    ring, junctions, ways, turned = [first], [starts[first].id], list[int](), 0.0
    while True:
        road = network.road(ring[-1]).road
        turned += float(road.heading(road.length) - road.heading(0.0)) * side
        at = network.junction_at.get(RoadEnd(ring[-1], "end"))
        if at is None or len(ring) > 12 or turned > 2 * math.pi + FULL:
            return None
        ways_on = [each for each in network.junction(at).connections if each.outgoing.contact == "start"]
        end = RoadEnd(ring[-1], "end")
        onward = [each for each in ways_on if each.incoming == end and each.outgoing.road in starts]
        bends = [_turn(network, each.road) * side for each in onward]
        if not bends:
            return None
        way = onward[int(np.argmax(bends))]
        ways.append(way.road)
        turned += max(bends)
        if way.outgoing.road == first:
            break
        ring.append(way.outgoing.road)
        junctions.append(at)
    if abs(turned - 2 * math.pi) > FULL or len(set(junctions)) < len(ring):
        return None
    if any(len([a for a in network.junction(n).arms if a.end.road not in ring]) != 1 for n in junctions):
        return None
    lines = [network.road(each).road for each in (*ring, *ways)]
    points = np.concatenate([road.centreline() for road in lines])
    # the circle x^2 + y^2 - 2 x0 x - 2 y0 y = c that fits best
    plan = points[:, :2] - points[:, :2].mean(axis=0)
    terms = np.column_stack([2 * plan, np.ones(len(plan))])
    x, y = np.linalg.lstsq(terms, (plan**2).sum(axis=1), rcond=None)[0][:2] + points[:, :2].mean(axis=0)
    away = np.hypot(points[:, 0] - x, points[:, 1] - y)
    edges = network.road(first).profile.edges(0.0)
    inner = max(side * float(edges.left if side > 0 else edges.right), 0.0)
    if np.ptp(away) > ROUND * away.mean() or away.mean() > LARGEST_RING:
        return None
    centre, radius = (float(x), float(y), float(points[:, 2].mean())), float(away.mean()) - inner
    return Roundabout(tuple(junctions), tuple(ring), centre, radius, float(edges.left - edges.right))


def _turn(network: Network, road: int) -> float:
    own = network.road(road).road
    return float(wrapped(float(own.heading(own.length) - own.heading(0.0))))
