"""OpenDRIVE files of networks, read with nothing but an XML parser and the formulas of the standard."""

import math
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator
from functools import cache, cached_property

import numpy as np
import pytest
import shapely

from network.changing import built, design
from network.random_designs import random_design, random_lanes_design
from network.random_maps import map_route
from roadgpt.export.exporters.opendrive import document
from roadgpt.network import Network, Route, build_route
from roadgpt.road import Design, Segment, World, build, read_design

WORLD = World()
MAPS = range(1000, 1002)
LANES = range(2000, 2008)
"""Seeds of networks with several lanes, ramps, and lanes that end or begin."""
SEEDS = [*range(5), 18, *MAPS]  # 18: a roundabout where one yields, a star with a stop
NEAR = 0.01  # m, between a boundary and the paved area: both are polygons
NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
SIGNS = {
    "stop": ("DE", "206"),
    "yield": ("DE", "205"),
    "priority": ("DE", "306"),
    "lights": ("OpenDRIVE", "1000001"),
}


def cubic(element: ET.Element, s: float, name: str, station: str) -> float:
    """The value of the cubic that applies at s."""
    rows = [[float(row.attrib[key]) for key in (station, *"abcd")] for row in element.findall(name)]
    s0, a, b, c, d = [row for row in rows if row[0] <= s + 1e-9][-1]
    return a + b * (s - s0) + c * (s - s0) ** 2 + d * (s - s0) ** 3


class WrittenRoad:
    """A road as the file has it."""

    def __init__(self, element: ET.Element) -> None:
        self.element = element
        self.id, self.junction = element.attrib["id"], element.attrib["junction"]
        self.length = float(element.attrib["length"])
        self.links = {link.tag: link.attrib for link in element.findall("./link/*")}
        self.lanes = {int(lane.attrib["id"]): lane for lane in element.iter("lane")}
        self.has_offset = self.element.find("lanes/laneOffset") is not None
        self.driven = {n for n, lane in self.lanes.items() if lane.attrib["type"] == "driving"}

    @cached_property
    def pieces(self) -> list[tuple[list[float], float, float]]:
        """Station, x, y, heading and length of each piece, and its curvatures."""
        found = []
        for piece in self.element.iter("geometry"):
            (shape,) = piece
            k0 = float(shape.get("curvStart") or shape.get("curvature") or 0)
            k1 = float(shape.get("curvEnd") or shape.get("curvature") or 0)
            assert shape.tag in ("line", "arc", "spiral")
            found.append(([float(piece.attrib[key]) for key in ("s", "x", "y", "hdg", "length")], k0, k1))
        return found

    def pose(self, s: float) -> tuple[float, float, float]:
        """x, y and heading of the reference line, integrated from the definition of the curvature."""
        (s0, x, y, heading, length), k0, k1 = [p for p in self.pieces if p[0][0] <= s + 1e-9][-1]
        u = s - s0
        v = u * (NODES + 1) / 2
        angle = heading + k0 * v + (k1 - k0) * v**2 / (2 * length)
        x, y = x + u / 2 * WEIGHTS @ np.cos(angle), y + u / 2 * WEIGHTS @ np.sin(angle)
        return float(x), float(y), heading + k0 * u + (k1 - k0) * u**2 / (2 * length)

    def height(self, s: float) -> float:
        return cubic(self.element.find("elevationProfile"), s, "elevation", "s")

    def width(self, lane: int, s: float) -> float:
        return cubic(self.lanes[lane], s, "width", "sOffset")

    def border(self, lane: int, s: float) -> float:
        """The offset t of the outer edge of a lane; the edge of lane 0 lies where laneOffset says."""
        sign = 1 if lane > 0 else -1
        offset = cubic(self.element.find("lanes"), s, "laneOffset", "s") if self.has_offset else 0.0
        return offset + sign * sum(
            self.width(n, s) for n in self.lanes if n * sign > 0 and abs(n) <= abs(lane)
        )

    def at(self, s: float, t: float) -> tuple[float, float]:
        x, y, heading = self.pose(s)
        return x - t * math.sin(heading), y + t * math.cos(heading)

    def end(self, contact: str) -> float:
        return 0.0 if contact == "start" else self.length

    def into(self, contact: str) -> set[int]:
        """The lanes whose traffic leaves the road at this end; traffic keeps to the right."""
        return {n for n in self.driven if (n < 0) == (contact == "end")}


class WrittenMap:
    """A file with its roads."""

    def __init__(self, text: str) -> None:
        self.root = ET.fromstring(text)
        self.roads = {road.attrib["id"]: WrittenRoad(road) for road in self.root.iter("road")}
        self.junctions = {each.attrib["id"]: each for each in self.root.iter("junction")}

    def ways(self) -> Iterator[tuple[ET.Element, WrittenRoad]]:
        """Every connection of every junction, with its connecting road."""
        for junction in self.junctions.values():
            for connection in junction.iter("connection"):
                yield connection, self.roads[connection.attrib["connectingRoad"]]

    def meets(self, junction: str) -> set[tuple[str, str]]:
        """The ends of roads that are linked to a junction."""
        return {
            (road.id, contact)
            for road in self.roads.values()
            for tag, contact in (("predecessor", "start"), ("successor", "end"))
            if road.links.get(tag, {}).get("elementType") == "junction"
            and road.links[tag]["elementId"] == junction
        }


@cache
def route_of(seed: int) -> Route:
    if seed in MAPS:
        return map_route(seed)
    data = random_lanes_design(seed - LANES[0]) if seed in LANES else random_design(seed)
    return build_route(read_design(data)[0], WORLD)


@cache
def written(seed: int) -> WrittenMap:
    return WrittenMap(document(route_of(seed), WORLD).to_text())


def turned(heading: float) -> float:
    """An angle, between -pi and pi."""
    return math.remainder(heading, 2 * math.pi)


def boundary_of(here: WrittenMap, junction: ET.Element) -> list[list[tuple[float, float]]]:
    """The points of each segment of a junction's boundary."""
    found = []
    for segment in junction.find("boundary"):
        road, data = here.roads[segment.attrib["roadId"]], segment.attrib
        if data["type"] == "joint":
            s, first, last = (
                road.end(data["contactPoint"]),
                int(data["jointLaneStart"]),
                int(data["jointLaneEnd"]),
            )
            found.append([road.at(s, road.border(first, s)), road.at(s, road.border(last, s))])
        else:
            told = [data[key] for key in ("sStart", "sEnd")]
            ends = [road.end(each) if each in ("start", "end") else float(each) for each in told]
            stations = np.linspace(*ends, max(2, round(road.length / 0.2))).tolist()
            lane = int(data["boundaryLane"])
            found.append([road.at(s, road.border(lane, s)) for s in stations])
    return found


@pytest.mark.parametrize("seed", SEEDS)
def test_a_boundary_encloses_what_is_paved(seed: int) -> None:
    here, network = written(seed), route_of(seed).network
    for name, junction in here.junctions.items():
        segments = boundary_of(here, junction)
        for one, two in zip(segments, [*segments[1:], segments[0]], strict=True):
            assert one[-1] == pytest.approx(two[0], abs=NEAR / 10)
        points = np.array([point for segment in segments for point in segment])
        is_new = np.hypot(*(np.roll(points, -1, axis=0) - points).T) > 1e-6
        ring = shapely.LinearRing(points[is_new])
        paved = shapely.Polygon(network.outline(int(name)))
        assert ring.is_ccw
        assert shapely.Polygon(ring).is_valid
        assert shapely.hausdorff_distance(ring, paved.exterior, densify=0.1) < NEAR
        joints = [each for each in junction.find("boundary") if each.attrib["type"] == "joint"]
        assert {(each.attrib["roadId"], each.attrib["contactPoint"]) for each in joints} == here.meets(name)


def check_signs(here: WrittenMap, network: Network) -> None:
    """Every sign, light and line of a file stands where traffic comes to a junction, and none is missing."""
    wanted = Counter(
        (str(arm.end.road), arm.end.contact, *SIGNS[arm.control])
        for junction in network.junctions
        for arm in junction.arms
        if arm.control != "none"
    )
    found: Counter[tuple[str, ...]] = Counter()
    at_rings = ring_lines(here, network)
    for road in here.roads.values():
        objects = {each.attrib["id"]: each.attrib for each in road.element.iter("object")}
        for signal in road.element.iter("signal"):
            data = signal.attrib
            contact = "end" if data["orientation"] == "+" else "start"
            into = road.into(contact)
            (validity,) = signal.findall("validity")
            lanes = [int(validity.attrib[key]) for key in ("fromLane", "toLane")]
            assert into
            assert set(range(lanes[0], lanes[1] + 1)) == into
            s, t = float(data["s"]), float(data["t"])
            assert abs(s - road.end(contact)) == pytest.approx(1.0)
            outermost = max(road.lanes, key=lambda n: n if contact == "start" else -n)
            side = 1 if contact == "start" else -1
            assert side * (t - road.border(outermost, s)) == pytest.approx(0.6)
            found[road.id, contact, data["country"], data["type"]] += 1
            if data["type"] == "306":  # traffic that has priority does not stop
                assert data["id"] not in objects
                continue
            if data["id"] in at_rings:  # gives way to a ring, where its line lies
                assert data["type"] == "205"
                assert data["id"] not in objects
                at_rings.remove(data["id"])
                continue
            line = objects.pop(data["id"])
            assert line["orientation"] == data["orientation"]
            nearest, farthest = min(into, key=abs), max(into, key=abs)
            at = float(line["s"])
            edges = road.border(nearest - (1 if nearest > 0 else -1), at), road.border(farthest, at)
            assert float(line["t"]) == pytest.approx(sum(edges) / 2)
            assert float(line["width"]) == pytest.approx(abs(edges[1] - edges[0]))
            assert abs(at - road.end(contact)) == pytest.approx(float(line["length"]) / 2)
        others = {"arrow"} if road.junction == "-1" else {"give-way line"}  # these have tests of their own
        assert {each.get("name") for each in objects.values()} <= others
    assert found == wanted
    assert not at_rings


def ring_lines(here: WrittenMap, network: Network) -> set[str]:
    """The ids of the lines where traffic gives way to roundabouts; all lie on the roads into the ring."""
    onto = {
        str(way.road)
        for ring in network.roundabouts
        for junction in map(network.junction, ring.junctions)
        for arm in junction.arms
        for way in junction.connections
        if arm.control == "yield" and way.incoming == arm.end
    }
    found = {
        each.attrib["id"]: road.id
        for road in here.roads.values()
        for each in road.element.iter("object")
        if each.attrib["name"] == "give-way line" and road.junction != "-1"
    }
    assert set(found.values()) == onto
    return set(found)


@pytest.mark.parametrize("seed", SEEDS)
def test_lights_of_a_junction_have_one_controller(seed: int) -> None:
    here = written(seed)
    lights = {each.attrib["id"]: each.attrib for each in here.root.iter("signal")}
    lit = {n for n, each in lights.items() if each["type"] == "1000001"}
    assert all((each["dynamic"] == "yes") == (n in lit) for n, each in lights.items())
    controlled = [c.attrib["signalId"] for c in here.root.findall("controller/control")]
    assert sorted(controlled) == sorted(lit)
    named = [c.attrib["id"] for c in here.root.findall("junction/controller")]
    assert sorted(named) == sorted(c.attrib["id"] for c in here.root.findall("controller"))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_route_file_leads_along_lanes_that_are_linked(seed: int) -> None:
    here = written(seed)
    legs = route_of(seed).to_json()["route"]
    ways = {
        (int(c.attrib["incomingRoad"]), int(link.attrib["from"]), int(way.id), int(link.attrib["to"])): way
        for c, way in here.ways()
        for link in c.iter("laneLink")
    }
    assert len(legs) % 2 == 1
    for before, inside, after in zip(legs[::2], legs[1::2], legs[2::2], strict=False):
        way = ways[(*before, *inside)]
        assert int(way.links["successor"]["elementId"]) == after[0]
        assert int(way.lanes[inside[1]].find("link/successor").attrib["id"]) == after[1]


def test_version_1_7_differs_by_its_number_and_the_boundaries() -> None:
    new, old = (ET.fromstring(document(route_of(3), WORLD, minor).to_text()) for minor in (8, 7))
    assert new.find("header").attrib.pop("revMinor") == "8"
    assert old.find("header").attrib.pop("revMinor") == "7"
    bounded = [junction for junction in new.iter("junction") if junction.find("boundary") is not None]
    assert len(bounded) == len(list(new.iter("junction"))) > 0
    for junction in bounded:
        junction.remove(junction.find("boundary"))
    assert ET.canonicalize(ET.tostring(new), strip_text=True) == ET.canonicalize(
        ET.tostring(old), strip_text=True
    )


@pytest.mark.parametrize("one_way", [None, "in"])
def test_an_arm_with_segments_is_written_as_they_say(one_way: str | None) -> None:
    segment = {"distance": 60, "direction": "left", "incline": 5, "turn_degrees": 50}
    arm = {"angle": -90, "road_segment1": segment, **({"one_way": one_way} if one_way else {})}
    junction = {"kind": "t_junction", "take": "straight", "arms": [arm, {"angle": 0}]}
    route = built(design(80.0, junction, 60.0))
    here = WrittenMap(document(route, WORLD).to_text())
    (road,) = [each for each in here.roads.values() if each.length == pytest.approx(60)
               and each.id not in {str(leg.road) for leg in route.legs}]  # fmt: skip
    near, far = (road.length, 0.0) if one_way else (0.0, road.length)
    x, y, _ = road.pose(near)
    single = Design(starting_point=(x, y, 0), theta=-90, segments=(Segment.model_validate(segment),))
    assert road.pose(far)[:2] == pytest.approx(build(single).at(60.0)[:2], abs=1e-6)
    # 6 m of level road, and a parabola with a radius of 250 m up to a grade of 5 %
    assert road.height(near) == pytest.approx(0, abs=1e-9)
    assert road.height(far) == pytest.approx(0.05 * (60 - 6 - 12.5 / 2), abs=1e-9)
