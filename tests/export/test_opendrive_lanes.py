"""OpenDRIVE files of networks with several lanes, ramps, and lanes that end or begin."""

import math

import numpy as np
import pytest
import shapely
import shapely.affinity

from export.test_opendrive_networks import (
    LANES,
    SEEDS,
    WORLD,
    WrittenMap,
    boundary_of,
    check_signs,
    route_of,
    turned,
    written,
)
from network.changing import design
from roadgpt.export.exporters.opendrive import document
from roadgpt.network import Junction, build_route
from roadgpt.network.markings import STOP_LINE, arrows, strokes
from roadgpt.network.paved import paved_by
from roadgpt.road import read_design
from roadgpt.road.profile import LINE

NEAR = 0.05  # m, between two segments of a boundary
TIP = 0.2  # m^2, between two ways that touch each other at an acute angle


def has_gap(junction: Junction) -> bool:
    """Whether an arm has a lane that no way joins between two that ways join; it is not paved behind."""
    links = [(way, link) for way in junction.connections for link in way.lanes]
    for arm in junction.arms:
        lanes = {link.incoming for way, link in links if way.incoming == arm.end}
        lanes |= {link.outgoing for way, link in links if way.outgoing == arm.end}
        if {*range(min(lanes), max(lanes) + 1)} - {0} - lanes:
            return True
    return False


@pytest.mark.parametrize("seed", LANES)
def test_a_boundary_encloses_what_is_paved(seed: int) -> None:
    here, network = written(seed), route_of(seed).network
    for each in network.junctions:
        paved = paved_by([network.road(way.road).road for way in each.connections])
        is_ramp = each.kind in ("merge", "diverge")
        if not is_ramp and (has_gap(each) or paved.geom_type != "Polygon"):
            continue
        segments = boundary_of(here, here.junctions[str(each.id)])
        for one, two in zip(segments, [*segments[1:], segments[0]], strict=True):
            assert math.dist(one[-1], two[0]) < NEAR
        points = np.array([point for segment in segments for point in segment])
        is_new = np.hypot(*(np.roll(points, -1, axis=0) - points).T) > 1e-6
        inside = shapely.Polygon(points[is_new])
        assert inside.exterior.is_ccw
        around = paved if is_ramp else shapely.Polygon(paved.exterior)
        assert shapely.symmetric_difference(inside.buffer(0), around).area < TIP


def lane_of(here: WrittenMap, road: int, contact: str, lane: int) -> tuple[float, ...]:
    """x and y of both borders of a lane at an end of a road, and the road's height there."""
    member = here.roads[str(road)]
    s = member.end(contact)
    inner = member.border(lane + (1 if lane < 0 else -1), s)
    return (*member.at(s, inner), *member.at(s, member.border(lane, s)), member.height(s))


def linked(here: WrittenMap, road: int, lane: int, tag: str) -> int | None:
    link = here.roads[str(road)].lanes[lane].find(f"link/{tag}")
    return None if link is None else int(link.attrib["id"])


@pytest.mark.parametrize("seed", LANES)
def test_roads_that_continue_each_other_are_linked_lane_by_lane(seed: int) -> None:
    here, network = written(seed), route_of(seed).network
    for each in network.continuations:
        one, two = each.before.road, each.after.road
        for road, other, tag, contact in ((one, two, "successor", "start"), (two, one, "predecessor", "end")):
            link = here.roads[str(road)].links[tag]
            assert (link["elementType"], link["elementId"]) == ("road", str(other))
            assert link["contactPoint"] == contact
        assert each.lanes
        for before, after in each.lanes:
            assert (linked(here, one, before, "successor"), linked(here, two, after, "predecessor")) == (
                after,
                before,
            )
            assert lane_of(here, one, "end", before) == pytest.approx(
                lane_of(here, two, "start", after), abs=1e-6
            )
        for road, contact, tag in ((one, "end", "successor"), (two, "start", "predecessor")):
            member = here.roads[str(road)]
            for lane in member.driven:
                has_width = member.width(lane, member.end(contact)) > 1e-6
                assert (linked(here, road, lane, tag) is not None) == has_width


@pytest.mark.parametrize("seed", [*SEEDS, *LANES])
def test_lanes_lead_through_junctions_without_a_step(seed: int) -> None:
    """And where every lane leads on, no lane is left out."""
    here = written(seed)
    used: dict[tuple[str, str], set[tuple[str, int]]] = {}
    for connection, way in here.ways():
        pairs = {(int(link.attrib["from"]), int(link.attrib["to"])) for link in connection.iter("laneLink")}
        assert {own for _, own in pairs} == way.driven
        for tag, contact in (("predecessor", "start"), ("successor", "end")):
            link = way.links[tag]
            other = here.roads[link["elementId"]]
            heading = way.pose(way.end(contact))[2] - other.pose(other.end(link["contactPoint"]))[2]
            is_same_way = (link["contactPoint"] == "end") == (tag == "predecessor")
            assert turned(heading - (0 if is_same_way else math.pi)) == pytest.approx(0, abs=1e-6)
            for own in way.driven:
                lane = linked(here, int(way.id), own, tag)
                assert lane is not None
                used.setdefault((way.junction, tag), set()).add((other.id, lane))
                assert tag == "successor" or (lane, own) in pairs
                assert lane_of(here, int(way.id), contact, own) == pytest.approx(
                    lane_of(here, int(other.id), link["contactPoint"], lane), abs=1e-6
                )
    for name in here.junctions if seed in SEEDS else ():
        for tag, ends in (("predecessor", ("start", "end")), ("successor", ("end", "start"))):
            lanes = {(r, n) for r, end in here.meets(name) for n in here.roads[r].into(ends[end == "end"])}
            assert used[name, tag] == lanes


@pytest.mark.parametrize("seed", [*SEEDS, *LANES])
def test_signs_and_lines_stand_where_traffic_comes_to_the_junction(seed: int) -> None:
    check_signs(written(seed), route_of(seed).network)


def ways_of(here: WrittenMap, road: str, lane: str, ramps: set[str]) -> str:
    """The ways on from a lane, as the name of an arrow tells them: by the headings of connecting roads."""
    found = set()
    for connection, way in here.ways():
        if connection.attrib["incomingRoad"] == road and lane in {
            link.attrib["from"] for link in connection.iter("laneLink")
        }:
            turn = math.degrees(turned(way.pose(way.length)[2] - way.pose(0.0)[2]))
            straight = 2 if way.junction in ramps else 25  # degrees
            found.add("Left" if turn > straight else "Right" if turn < -straight else "Straight")
    return "arrow" + "".join(way for way in ("Straight", "Left", "Right") if way in found)


@pytest.mark.parametrize("seed", LANES)
def test_arrows_lie_in_the_middle_of_lanes_and_show_the_ways_on(seed: int) -> None:
    here = written(seed)
    ramps = {str(each.id) for each in route_of(seed).network.junctions if each.kind == "diverge"}
    count = 0
    for road in here.roads.values():
        for each in road.element.iter("object"):
            if each.attrib["name"] != "arrow":
                continue
            count += 1
            (validity,) = each.findall("validity")
            lane = int(validity.attrib["fromLane"])
            assert validity.attrib["toLane"] == str(lane)
            contact = "end" if each.attrib["orientation"] == "+" else "start"
            assert lane in road.into(contact)
            assert float(each.attrib["hdg"]) == pytest.approx(0.0 if contact == "end" else math.pi)
            s, t = float(each.attrib["s"]), float(each.attrib["t"])
            edges = road.border(lane, s), road.border(lane - (1 if lane > 0 else -1), s)
            assert t == pytest.approx(sum(edges) / 2)
            assert float(each.attrib["width"]) < abs(edges[1] - edges[0])
            assert abs(s - road.end(contact)) - float(each.attrib["length"]) / 2 > 10.0
            assert (each.attrib["type"], each.attrib["subtype"]) == (
                "roadMark",
                ways_of(here, road.id, str(lane), ramps),
            )
    assert count == len(arrows(route_of(seed).network))
    check_ids(here)


def test_the_corners_of_a_crosswalk_are_those_of_its_length_and_width() -> None:
    data = design(60.0, {"kind": "t_junction", "take": "left", "crosswalk": True}, 60.0)
    here = WrittenMap(document(build_route(read_design(data)[0], WORLD), WORLD).to_text())
    found = [each for each in here.root.iter("object") if each.attrib["type"] == "crosswalk"]
    assert len(found) == 3
    for each in found:
        corners = [(float(c.attrib["u"]), float(c.attrib["v"])) for c in each.iter("cornerLocal")]
        ring = shapely.Polygon(corners)
        u, v = (float(each.attrib[name]) / 2 for name in ("length", "width"))
        assert len(corners) == 4
        assert ring.is_valid
        assert ring.bounds == pytest.approx((-u, -v, u, v))
        assert ring.area == pytest.approx(4 * u * v)


def check_ids(here: WrittenMap) -> None:
    """No two roads, junctions, signs, lights or objects have the same id, but a sign and its line."""
    signs = [each.attrib["id"] for each in here.root.iter("signal")]
    tags = ("road", "junction", "object")
    ids = [
        each.attrib["id"]
        for tag in tags
        for each in here.root.iter(tag)
        if each.get("subtype") != "signalLines"
    ]
    assert len({*signs, *ids}) == len(signs) + len(ids)


@pytest.mark.parametrize("left_hand", [False, True])
@pytest.mark.parametrize(
    ("kind", "control", "count"),
    [
        ("roundabout", "yield", 4),
        ("roundabout", "stop", 1),
        ("crossroads", "yield", 2),
        ("crossroads", "lights", 4),
    ],
)
def test_lines_to_stop_at_lie_where_they_are_painted(
    kind: str, control: str, count: int, left_hand: bool
) -> None:
    junction = {"kind": kind, "take": "left", "control": control, "crosswalk": True}
    data = design(60.0, junction, 60.0) | ({"left_hand": True} if left_hand else {})
    route = build_route(read_design(data)[0], WORLD)
    drawn, name = ("give_way", "give-way line") if control == "yield" else ("stop", "stop line")
    strips = [shapely.LineString(each.points[:, :2]) for each in strokes(route.network) if each.kind == drawn]
    painted = shapely.union_all([each.buffer(STOP_LINE / 2, cap_style="flat") for each in strips])
    here = WrittenMap(document(route, WORLD).to_text())
    found = []
    for road in here.root.iter("road"):
        own = route.network.road(int(road.attrib["id"])).road
        for each in road.iter("object"):
            if each.attrib["name"] != name:
                continue
            s, t, u, v = (float(each.attrib[name]) for name in ("s", "t", "length", "width"))
            corners = [(float(c.attrib["u"]), float(c.attrib["v"])) for c in each.iter("cornerLocal")]
            corners = corners or [(-u / 2, -v / 2), (u / 2, -v / 2), (u / 2, v / 2), (-u / 2, v / 2)]
            line = shapely.affinity.rotate(shapely.Polygon(corners), own.heading(s), (0, 0), use_radians=True)
            found.append(shapely.affinity.translate(line, *own.at(s, t)[:2]))
    written = shapely.union_all(found)
    assert all(each.is_valid for each in found)
    assert len(found) == count
    assert shapely.difference(painted, written).area < 0.01 * painted.area
    if control == "yield":  # between its blocks is a third of a give-way line
        assert painted.area > 0.6 * written.area
    else:  # the paint ends at the edge line, the object at the edge of the lane
        assert written.area - painted.area == pytest.approx(len(found) * STOP_LINE * LINE, rel=0.01)
