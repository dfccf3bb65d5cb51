"""Networks for CommonRoad and Lanelet2: their own libraries read them and find a way along the route.

What the lanelets should be is counted in the OpenDRIVE file of the same network.
"""

import warnings
import xml.etree.ElementTree as ET
from collections import Counter
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree

from roadgpt.brief.plan import read_plan
from roadgpt.design import draft
from roadgpt.export import save
from roadgpt.export.exporters.opendrive import LATITUDE, LONGITUDE
from roadgpt.network import Route, made_from
from roadgpt.road import Site, World
from tables import rows

WORLD = World(site=Site(map_size=700))
PLANS = rows(__file__, "plans")
KINDS = {"stop": "206", "yield": "205", "priority": "306", "lights": "1000001"}


@pytest.fixture(scope="module", params=PLANS)
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Route, Path]:
    """A route, and a folder with the network in three formats."""
    route = made_from(draft(read_plan(request.param), WORLD, seed=1), WORLD)
    assert isinstance(route, Route)
    folder = tmp_path_factory.mktemp("lanelets")
    save(route, folder, ["commonroad", "lanelet2", "opendrive"], WORLD, "x")
    return route, folder


def commonroad(folder: Path) -> ET.Element:
    return ET.parse(folder / "x.cr.xml").getroot()


def signals(folder: Path) -> Counter[str]:
    """How many signs and lights of each type the OpenDRIVE file has."""
    return Counter(each.get("type") for each in ET.parse(folder / "x.xodr").getroot().iter("signal"))


def refs(element: ET.Element, name: str) -> list[int]:
    return [int(each.attrib["ref"]) for each in element.findall(name)]


def bound(lanelet: ET.Element, side: str) -> np.ndarray:
    points = lanelet.findall(f"{side}Bound/point")
    return np.array([[float(point.find(axis).text) for axis in "xy"] for point in points])


def test_lanelets_that_follow_each_other_meet(made: tuple[Route, Path]) -> None:
    lanelets = {int(each.attrib["id"]): each for each in commonroad(made[1]).findall("lanelet")}
    for number, lanelet in lanelets.items():
        for other in refs(lanelet, "successor"):
            assert number in refs(lanelets[other], "predecessor")
            for side in ("left", "right"):
                gap = bound(lanelet, side)[-1] - bound(lanelets[other], side)[0]
                assert np.hypot(*gap) < 0.01
        for side in ("Left", "Right"):
            beside = lanelet.find(f"adjacent{side}")
            if beside is None:
                continue
            is_same = beside.attrib["drivingDir"] == "same"
            other_side = {"Left": "right", "Right": "left"}[side] if is_same else side.lower()
            shared = bound(lanelets[int(beside.attrib["ref"])], other_side)
            assert (bound(lanelet, side.lower()) == (shared if is_same else shared[::-1])).all()


def test_the_sides_of_ways_are_those_to_which_they_lead(made: tuple[Route, Path]) -> None:
    route, folder = made
    root = commonroad(folder)
    lanelets = {int(each.attrib["id"]): each for each in root.findall("lanelet")}
    rings = bool(route.network.roundabouts)
    for way_in in root.iter("incoming"):
        entered = {
            other for one in refs(way_in, "incomingLanelet") for other in refs(lanelets[one], "successor")
        }
        named = []
        for side in ("Right", "Straight", "Left"):
            for number in refs(way_in, f"successors{side}"):
                named.append(number)
                line = (bound(lanelets[number], "left") + bound(lanelets[number], "right")) / 2
                first, last = line[1] - line[0], line[-1] - line[-2]
                turn = np.degrees(np.angle(complex(*last) / complex(*first)))
                if not rings and "ramp" not in str(route):
                    limit = 25 if len(entered) > 0 and abs(turn) > 12 else 5
                    assert {"Right": turn < -limit, "Left": turn > limit}.get(side, abs(turn) < 26)
        assert {*named} == entered


def test_commonroad_files_keep_to_the_schema(made: tuple[Route, Path]) -> None:
    io = pytest.importorskip("commonroad")
    schema = Path(io.__file__).parent / "xml_definition_files" / "XML_commonRoad_XSD.xsd"
    etree.XMLSchema(etree.parse(schema)).assertValid(etree.parse(made[1] / "x.cr.xml"))


def test_lines_to_stop_at_reach_across_the_lanes(made: tuple[Route, Path]) -> None:
    """They are as far from the junction, and as long, as the tool's own verdicts take them."""
    route, folder = made
    root = ET.parse(folder / "x.osm").getroot()
    nodes = {
        node.attrib["id"]: [float({t.attrib["k"]: t.attrib["v"] for t in node}[f"local_{k}"]) for k in "xy"]
        for node in root.iter("node")
    }
    found = []
    for way in root.iter("way"):
        if any(tag.attrib["v"] == "stop_line" for tag in way.iter("tag")):
            points = np.array([nodes[nd.attrib["ref"]] for nd in way.iter("nd")])
            found.append(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    arms = [
        (junction, arm)
        for junction in route.network.junctions
        for arm in junction.arms
        if arm.control in ("stop", "yield", "lights")
        and route.network.road(arm.end.road).ids_towards(arm.end.contact)
    ]
    assert len(found) == len(arms)
    for length, (junction, arm) in zip(found, arms, strict=True):
        lanes = len(route.network.road(arm.end.road).ids_towards(arm.end.contact))
        if junction.id not in route.network.roundabout_of:
            assert length == pytest.approx(
                4 * lanes, abs=0.25
            )  # lanes are 4 m wide; an edge line is left free
        else:
            assert length > 3
    for line in commonroad(folder).iter("stopLine"):
        points = line.findall("point")
        assert len(points) in (0, 2)


def test_there_are_as_many_ways_through_the_junctions_as_in_opendrive(made: tuple[Route, Path]) -> None:
    _, folder = made
    root = commonroad(folder)
    found = [
        len(refs(each, f"successors{side}"))
        for each in root.iter("incoming")
        for side in ("Right", "Straight", "Left")
    ]
    links = ET.parse(folder / "x.xodr").getroot().findall("junction/connection/laneLink")
    assert sum(found) == len(links)
    assert len(root.findall("intersection")) == len(ET.parse(folder / "x.xodr").findall("junction"))


def test_signs_and_lights_are_those_of_opendrive(made: tuple[Route, Path]) -> None:
    _, folder = made
    root, wanted = commonroad(folder), signals(folder)
    signs = Counter(each.text for each in root.iter("trafficSignID"))
    assert signs.pop("274") == 1
    assert signs == Counter({type_: n for type_, n in wanted.items() if type_ != KINDS["lights"]})
    assert len(root.findall("trafficLight")) == wanted[KINDS["lights"]]
    there = {
        int(each.attrib["id"]) for name in ("trafficSign", "trafficLight") for each in root.findall(name)
    }
    used = {
        int(each.attrib["ref"]) for name in ("trafficSignRef", "trafficLightRef") for each in root.iter(name)
    }
    assert used == there
    rules = ET.parse(folder / "x.osm").getroot().findall("relation/tag[@v='regulatory_element']")
    assert len(rules) == sum(wanted.values())


def test_commonroad_leads_from_the_start_to_the_goal(made: tuple[Route, Path]) -> None:
    warnings.simplefilter("ignore")
    reader = pytest.importorskip("commonroad.common.file_reader")
    route, folder = made
    scenario, problems = reader.CommonRoadFileReader(str(folder / "x.cr.xml")).open()
    (problem,) = problems.planning_problem_dict.values()
    lanelets = {each.lanelet_id: each for each in scenario.lanelet_network.lanelets}
    place = problem.initial_state.position
    reached = [id_ for id_, each in lanelets.items() if each.polygon.contains_point(place)]
    assert reached
    for id_ in reached:
        one = lanelets[id_]
        left = one.adj_left if one.adj_left_same_direction else None
        right = one.adj_right if one.adj_right_same_direction else None
        more = [*one.successor, *(each for each in (left, right) if each is not None)]
        reached += [each for each in more if each not in reached]
    (goal,) = (ids[0] for ids in problem.goal.lanelets_of_goal_position.values())
    assert goal in reached
    end = route.at(route.length, float(world_middle(route)))[:2]
    middle = lanelets[goal].center_vertices[-1]
    assert np.hypot(*(middle - end)) < 0.05


def world_middle(route: Route) -> float:
    """The offset of the middle of the route's lane at its end, in metres."""
    return float(WORLD.profile_of(route).middle(route.length))


def test_lanelet2_finds_the_route(made: tuple[Route, Path]) -> None:
    library = pytest.importorskip("lanelet2")
    for part in ("core", "geometry", "io", "projection", "routing", "traffic_rules"):
        pytest.importorskip(f"lanelet2.{part}")
    route, folder = made
    projector = library.projection.UtmProjector(library.io.Origin(LATITUDE, LONGITUDE))
    map_, errors = library.io.loadRobust(str(folder / "x.osm"), projector)
    assert list(errors) == []
    which = library.traffic_rules
    rules = which.create(which.Locations.Germany, which.Participants.Vehicle)
    graph = library.routing.RoutingGraph(map_, rules)
    assert not list(graph.checkValidity(False))

    def lanelet_at(s: float) -> Any:
        x, y, _ = route.at(s, float(WORLD.profile_of(route).middle(s)))
        near = library.geometry.findNearest(
            map_.laneletLayer, library.core.BasicPoint2d(float(x), float(y)), 3
        )
        heading = np.array([np.cos(route.heading(s)), np.sin(route.heading(s))])
        for distance, found in near:
            points = np.array([[p.x, p.y] for p in found.centerline])
            if distance < 0.01 and (points[-1] - points[0]) @ heading > 0:
                return found
        raise AssertionError(f"no lanelet at {s}")

    outside = [
        (a + b) / 2
        for leg, (a, b) in zip(route.legs, pairwise(route.starts), strict=True)
        if route.network.road(leg.road).junction is None
    ]
    for s, t in pairwise([0.5, *outside, route.length - 0.5]):
        way = graph.shortestPath(lanelet_at(s), lanelet_at(t))
        assert way is not None, (s, t)
        driven = sum(library.geometry.length2d(each) for each in list(way)[1:-1])
        assert driven <= 1.1 * (t - s) + 50  # a lane change counts a section twice
