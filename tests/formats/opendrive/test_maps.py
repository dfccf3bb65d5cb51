"""Maps written by hand, with what tools write and RoadGPT does not: where everything is, by arithmetic."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from shapely import GeometryCollection, LineString, MultiPolygon, box, points

from roadgpt import judge, simulate
from roadgpt.errors import UsageError
from roadgpt.network import ImportedMap, Leg, Route, read_map, road_from_json
from roadgpt.network.lanes import lanes_of
from roadgpt.network.paved import filled
from roadgpt.network.routing import between, over_roads, random_routes
from roadgpt.road import World
from slow_opendrive import SlowMap

LINE = '<geometry s="0" x="{x}" y="{y}" hdg="{heading}" length="{length}"><line/></geometry>'


def lane(number: int, width: float = 3.5, kind: str = "driving", more: str = "", **links: int) -> str:
    link = "".join(f'<{name} id="{to}"/>' for name, to in links.items())
    return (
        f'<lane id="{number}" type="{kind}"><link>{link}</link><width sOffset="0" a="{width}"/>'
        f'<roadMark sOffset="0" type="{"broken" if number else "solid"}"/>{more}</lane>'
    )


def section(s: float, *lanes: str) -> str:
    sides = {"left": "", "center": '<lane id="0" type="none"/>', "right": ""}
    for each in lanes:
        sides["right" if 'id="-' in each[:12] else "left"] += each
    return (
        f'<laneSection s="{s}">'
        + "".join(f"<{k}>{v}</{k}>" for k, v in sides.items() if v)
        + "</laneSection>"
    )


def road(
    number: object,
    place: tuple[float, float, float, float],
    sections: str,
    links: str = "",
    junction: int = -1,
    more: str = "",
    rule: str = "RHT",
    plan: str = LINE,
) -> str:
    x, y, heading, length = place
    return (
        f'<road id="{number}" junction="{junction}" rule="{rule}" length="{length}"><link>{links}</link>'
        f"<planView>{plan.format(x=x, y=y, heading=heading, length=length)}</planView>"
        f"<lanes>{sections}</lanes>{more}</road>"
    )


def to(name: str, kind: str, number: object, contact: str = "") -> str:
    return f'<{name} elementType="{kind}" elementId="{number}" contactPoint="{contact}"/>'


def read(folder: Path, *parts: str) -> ImportedMap:
    path = folder / "map.xodr"
    path.write_text(f"<OpenDRIVE>{''.join(parts)}</OpenDRIVE>")
    return read_map(path)


TWO = section(0, lane(1), lane(-1))


def test_a_lane_that_begins_cuts_the_road_in_two(tmp_path: Path) -> None:
    """From 60 m on there are two lanes along the road; the inner one goes on from the one before."""
    lanes = section(0, lane(1, predecessor=1, successor=1), lane(-1, successor=-1))
    lanes += section(
        60, lane(1, predecessor=1), lane(-1, predecessor=-1), lane(-2), lane(-3, 2.0, "sidewalk")
    )
    found = read(tmp_path, road(7, (10, 20, 0, 100), lanes), road(8, (0, 90, 0, 30), TWO))
    one, two = (found.network.road(number) for number in found.roads["7"])
    assert one.id == 7
    assert (one.road.length, two.road.length) == pytest.approx((60, 40))
    assert [lane.kind for lane in two.profile.lanes.values()] == ["driving"] * 3 + ["sidewalk"]
    assert two.road.at(0.0, 0.0)[:2] == pytest.approx((70, 20))
    lanes_there = lanes_of(found.network)
    assert lanes_there[Leg(7, -1)].successors == (Leg(two.id, -1),)
    assert lanes_there[Leg(two.id, 1)].successors == (Leg(7, 1),)
    assert lanes_there[Leg(two.id, -2)].predecessors == ()
    assert lanes_there[Leg(two.id, -2)].verge == Leg(two.id, -3)
    assert found.remarks == ()


def test_sections_that_change_nothing_or_are_very_short_cut_nothing(tmp_path: Path) -> None:
    """The last 3 cm have a section of their own with other ids and another offset, as tools write it."""
    lanes = '<laneOffset s="0" a="1"/><laneOffset s="99.97" a="-2.5"/>'
    lanes += section(0, lane(1, successor=1), lane(-1, successor=-1))
    lanes += section(50, lane(1), lane(-1, successor=-2))
    lanes += section(99.97, lane(-1, 3.5, "none"), lane(-2, predecessor=-1, successor=-1))
    after = road(2, (100, 0, 0, 50), '<laneOffset s="0" a="1"/>' + TWO, to("predecessor", "road", 1, "end"))
    before = road(1, (0, 0, 0, 100), lanes, to("successor", "road", 2, "start"))
    found = read(tmp_path, before, after)
    assert found.roads == {"1": (1,), "2": (2,)}
    own = found.network.road(1)
    assert own.profile.edges_of(-1, [0.0, 50.0, 99.99]).left == pytest.approx(1.0)
    assert lanes_of(found.network)[Leg(1, -1)].successors == (Leg(2, -1),)


def crossing(kind: str = "default", contact: str = "start", inner: str = "", signals: str = "") -> list[str]:
    """A road from the west to the east, with a connecting road of 20 m between its two parts."""
    inner = inner or section(0, lane(-1, predecessor=-1, successor=-1))
    links = to("predecessor", "road", 1, "end") + to("successor", "road", 2, "start")
    named = f'<connection id="0" incomingRoad="1" connectingRoad="5" contactPoint="{contact}"><laneLink '
    named += 'from="-1" to="-1"/></connection>'
    return [
        road(1, (0, 0, 0, 80), TWO, to("successor", "junction", 9), more=signals),
        road(5, (80, 0, 0, 20), inner, links, junction=9),
        road(2, (100, 0, 0, 80), TWO, to("predecessor", "junction", 9)),
        f'<junction id="9" type="{kind}">{named}</junction>',
    ]


def test_a_way_through_a_junction(tmp_path: Path) -> None:
    found = read(tmp_path, *crossing())
    (junction,) = found.network.junctions
    assert junction.kind == "junction"
    assert [arm.end.road for arm in junction.arms] in ([1, 2], [2, 1])
    assert found.network.road(5).junction == 9
    assert lanes_of(found.network)[Leg(5, -1)].successors == (Leg(2, -1),)
    assert over_roads(lanes_of(found.network), [(1,), (2,)]) == (Leg(1, -1), Leg(5, -1), Leg(2, -1))


def test_lanes_of_both_directions_on_one_connecting_road_are_two_roads(tmp_path: Path) -> None:
    inner = section(
        0,
        lane(1, predecessor=1, successor=1),
        lane(-1, predecessor=-1, successor=-1),
        lane(-2, 1.0, "shoulder"),
    )
    parts = crossing(inner=inner)
    back = '<connection id="1" incomingRoad="2" connectingRoad="5" contactPoint="end">'
    back += '<laneLink from="1" to="1"/>'
    parts[-1] = parts[-1].replace("</junction>", f"{back}</connection></junction>")
    found = read(tmp_path, *parts)
    one, two = (found.network.road(number) for number in found.roads["5"])
    assert one.profile.count == two.profile.count == (1, 0)
    assert one.road.at([0.0, 20.0], -1.75)[:, :2] == pytest.approx(np.array([[80, -1.75], [100, -1.75]]))
    assert two.road.at([0.0, 20.0], -1.75)[:, :2] == pytest.approx(np.array([[100, 1.75], [80, 1.75]]))
    lanes = lanes_of(found.network)
    assert lanes[Leg(2, 1)].successors == (Leg(two.id, -1),)
    assert lanes[Leg(two.id, -1)].successors == (Leg(1, 1),)
    route = Route.along(found.network, over_roads(lanes, [(2,), (1,)]))
    assert route.at([0.0, route.length])[:, :2] == pytest.approx(np.array([[180, 0], [0, 0]]))


def test_lanes_that_change_inside_a_junction_lead_through_it_where_they_go_on(tmp_path: Path) -> None:
    """On the way the lane gets a neighbour on its left, so that it is the second one at the end."""
    inner = '<laneOffset s="0" a="0"/><laneOffset s="12" a="3.5"/>'
    inner += section(0, lane(-1, predecessor=-1, successor=-2))
    inner += section(12, lane(-1), lane(-2, predecessor=-1, successor=-1))
    found = read(tmp_path, *crossing(inner=inner))
    own = found.network.road(5)
    assert own.profile.count == (1, 0)
    lane_there = lanes_of(found.network)[Leg(5, own.profile.along_ids[0])]
    assert lane_there.at([0.0, 13.0, 20.0])[:, 1] == pytest.approx(-1.75)
    assert lane_there.successors == (Leg(2, -1),)


def test_strips_need_no_links_to_go_on_inside_a_junction(tmp_path: Path) -> None:
    """Every metre has a section of its own, whose inner strips are not linked to the next ones."""
    lanes = lane(-3, predecessor=-3, successor=-3), lane(-1, 0.5, "none"), lane(-2, 1.0, "median")
    parts = crossing(inner="".join(section(s, *lanes[1:], lanes[0]) for s in range(20)))
    parts[1] = parts[1].replace('predecessor id="-3"', 'predecessor id="-1"', 1)
    parts[1] = '"-1"'.join(parts[1].rsplit('"-3"', 1))
    parts[-1] = parts[-1].replace('to="-1"', 'to="-3"')
    found = read(tmp_path, *parts)
    own = found.network.road(5)
    assert own.profile.count == (1, 0)
    assert own.road.at([0.0, 20.0], own.profile.edges_of(-1, [0.0, 20.0]).left)[:, 1] == pytest.approx(-1.5)
    assert lanes_of(found.network)[Leg(1, -1)].successors == (Leg(5, -1),)


SIGN = '<signal id="1" s="{s}" t="-4" orientation="{way}" dynamic="{changes}" type="{kind}"/>'
TREE = '<objects><object id="1" type="tree" s="1"/></objects>'
BROKEN = "<geometry s='0' x='a'/>"
SHAPELESS = "<geometry s='0' x='0' y='9' hdg='0' length='9'/>"
FAST, ICE = '<speed sOffset="0" max="1000"/>', '<material sOffset="0" friction="0"/>'
CLIFF = '<elevationProfile><elevation s="0" a="0" b="46"/></elevationProfile>'


@pytest.mark.parametrize(
    ("kind", "changes", "way", "s", "control"),
    [
        ("206", "no", "+", 75, "stop"),
        ("205", "no", "+", 75, "yield"),
        ("R1-1", "no", "none", 75, "stop"),
        ("306", "no", "+", 75, "priority"),
        ("1000001", "yes", "+", 70, "lights"),
        ("206", "no", "-", 75, "none"),
        ("206", "no", "+", 5, "stop"),
        ("1000001", "yes", "+", 5, "none"),
        ("274", "no", "+", 75, "none"),
        ("1000002", "yes", "+", 75, "none"),
        ("1000007", "yes", "+", 75, "none"),
        ("1000013", "yes", "+", 75, "none"),
        ("1000011", "yes", "+", 75, "lights"),
        ("trafficLight_pedestrian", "yes", "+", 75, "none"),
        ('224" name="bus stop', "no", "+", 75, "none"),
        ('283" name="No Stopping', "no", "+", 75, "none"),
        ('286" name="stop restricted', "no", "+", 75, "none"),
        ('-1" name="bus stop', "no", "+", 75, "none"),
        ('-1" name="Sign_Stop', "no", "+", 75, "stop"),
        ('-1" name="YieldSign_01', "no", "+", 75, "yield"),
        ('-1" name="give way sign', "no", "+", 75, "yield"),
        ('R1" subtype="1" country="US', "no", "+", 75, "stop"),
        ('206" country="NO', "no", "+", 75, "priority"),
        ('204" country="NO', "no", "+", 75, "stop"),
        ('206" country="CN', "no", "+", 75, "none"),
        ('601.1" country="GB', "no", "+", 75, "stop"),
    ],
)
def test_signs_and_lights(tmp_path: Path, kind: str, changes: str, way: str, s: float, control: str) -> None:
    sign = SIGN.format(s=s, way=way, changes=changes, kind=kind)
    found = read(tmp_path, *crossing(signals=f"<signals>{sign}</signals>"))
    arms = {arm.end.road: arm.control for arm in found.network.junctions[0].arms}
    assert arms == {1: control, 2: "none"}  # no lane of road 2 leads into the junction
    number = kind.partition('"')[0]
    named = f"left out: signs {'without a type' if number == '-1' else f'of type {number}'}"
    assert any(remark.startswith(named) for remark in found.remarks) == (control == "none")


def test_a_sign_before_a_joint_applies_to_the_junction_behind_it(tmp_path: Path) -> None:
    """The road ends 80 m before the junction, and another one goes on; the sign stands 120 m before it."""
    sign = SIGN.format(s=40, way="-", changes="no", kind="206")  # against the road, which is driven backwards
    lanes = section(0, lane(1, predecessor=-1), lane(-1))
    before = road(
        3,
        (0, 0, math.pi, 60),
        lanes,
        to("predecessor", "road", 1, "start"),
        more=f"<signals>{sign}</signals>",
    )
    parts = [before, *crossing()]
    parts[1] = parts[1].replace("<link>", "<link>" + to("predecessor", "road", 3, "start"), 1)
    found = read(tmp_path, *parts)
    assert over_roads(lanes_of(found.network), [(3,), (1,), (2,)])[0] == Leg(3, 1)
    assert {arm.end.road: arm.control for arm in found.network.junctions[0].arms} == {1: "stop", 2: "none"}


PAINTED = '<object id="9" type="roadMark" subtype="signalLines" s="{s}" orientation="{way}"/>'


@pytest.mark.parametrize("kind", ["206", "205", "1000001"])
@pytest.mark.parametrize("as_object", [False, True])
def test_a_stop_line_lies_where_the_file_has_it(tmp_path: Path, kind: str, as_object: bool) -> None:
    """The line 0.5 m wide whose middle lies at 75 m is entered at 74.75 m; the road ends at 80 m."""
    signs = SIGN.format(s=79, way="+", changes="yes", kind=kind)
    line = SIGN.format(s=75, way="+", changes="no", kind="294") if not as_object else ""
    more = f"<signals>{signs}{line}</signals>"
    more += f"<objects>{PAINTED.format(s=75, way='+')}</objects>" if as_object else ""
    found = read(tmp_path, *crossing(signals=more))
    assert found.remarks == ()
    route = Route.along(found.network, over_roads(lanes_of(found.network), [(1,), (2,)]))
    assert route.passages[0].line == pytest.approx(74.75)
    again = road_from_json(route.to_json())
    assert isinstance(again, Route)
    assert lanes_of(again.network)[Leg(1, -1)].before_line == pytest.approx(5.25)
    alone = read(tmp_path, *crossing(signals=f"<signals>{line}</signals>"))
    assert any("signs of type 294" in each for each in alone.remarks) != as_object


@pytest.mark.parametrize("both", [False, True])
def test_lanes_with_ids_of_the_wrong_sign_are_those_of_their_sides(tmp_path: Path, both: bool) -> None:
    """All ids and links of the map with the other sign, or those on the right alone where there are no left
    ones."""
    right = section(0, lane(-1, successor=-1, predecessor=-1))
    parts = crossing()
    if not both:
        parts = [each.replace(TWO, right) for each in parts]
    there = read(tmp_path, *parts)
    swapped = [
        re.sub('(id|from|to)="(-?)1"(?= type="dr| to|/>)', lambda m: f'{m[1]}="{"" if m[2] else "-"}1"', each)
        for each in parts
    ]
    found = read(tmp_path, *swapped)
    assert found.network.following == there.network.following
    assert [each for each in found.remarks if "ids of its lanes have the wrong sign" in each]
    for one, two in zip(there.network.roads, found.network.roads, strict=True):
        assert one.road.at([0.0, 9.0], -1.75) == pytest.approx(two.road.at([0.0, 9.0], -1.75))
        assert one.profile.lanes.keys() == two.profile.lanes.keys()


def test_what_a_map_says_of_speed_and_friction_is_that_of_its_lanes(tmp_path: Path) -> None:
    own = '<speed sOffset="0" max="30" unit="km/h"/><material sOffset="0" friction="0.6"/>'
    lanes = section(0, lane(1), lane(-1, more=own))
    kinds = '<type s="0" type="town"><speed max="50" unit="km/h"/></type>'
    parts = road(1, (0, 0, 0, 80), lanes, more=kinds), road(2, (0, 50, 0, 10), TWO)
    found = read(tmp_path, *parts)
    there = found.network.road(1).profile.lanes
    assert there[-1].speed_limit == pytest.approx(30 / 3.6)
    assert there[1].speed_limit == pytest.approx(50 / 3.6)
    assert (there[-1].friction, there[1].friction) == (0.6, None)
    values, told = found.world_values([Leg(1, -1)])
    # the lanes of road 2 have no limit, so that of the route is not written as theirs
    assert values == pytest.approx({"speed_limit": 30 / 3.6, "friction": 0.6, "limit_stated": False})
    assert told == ()
    values, told = found.world_values()
    assert told == ("its speed limit is 30 to 50 km/h; 50 km/h is used everywhere",)


@pytest.mark.parametrize(
    ("parts", "sentence"),
    [
        (crossing("direct"), "left out: direct junctions (junction 9)"),
        ([*crossing(), road(3, (0, 9, 0, 9), section(0, lane(-1, 2.0, "sidewalk")))],
         "left out: roads without a lane for cars (road 3)"),
        ([crossing()[-1].replace('"9"', '"8"'), *crossing()], "not of the junction (junction 8)"),
        ([*crossing(), road(3, (0, 9, 0, 9), TWO, to("successor", "road", 77, "start"))],
         "it is linked to a road that is left out or not there (road 3)"),
        ([*crossing(), road(3, (0, 9, 0, 9), TWO, more=TREE)],
         "left out: objects of type tree (road 3)"),
        ([*crossing(), road(3, (0, 9, 0, 9), TWO, more='<signals><signal s="nan" type="206"/></signals>')],
         "left out: what has no place: in a <signal>, s is 'nan', which is not a number (road 3)"),
        ([*crossing(), road(3, (0, 9, 0, 9), TWO, plan=BROKEN)], "left out: roads of which"),
        ([*crossing(), road(3, (0, 9, 0, 9), TWO, plan=SHAPELESS)],
         "left out: roads of which the geometry has no shape (road 3)"),
        ([*crossing(), road(3, (0, 9, 0, 9), TWO, to("predecessor", "road", 3, "start"))],
         "a second road that continues the same end of a road (road 3)"),
        ([*crossing(), road(3, (0, 9, 0, 9), TWO, more=CLIFF)], "roads of which the road has a grade of 46"),
        ([*crossing(), road(3, (0, 9, 0, 9), section(0, lane(-1, more=FAST)))],
         "a speed limit of 3600 km/h is not used (road 3)"),
        ([*crossing(), road(3, (0, 9, 0, 9), section(0, lane(-1, more=ICE)))],
         "a friction of 0 is not used (road 3)"),
        ([*crossing(), road(3, (0, 9, 0, 9), section(0, lane(-1), lane(-2, 0.04)))],
         "a lane for cars that is nowhere wider than 0.25 m is a strip here (road 3)"),
        ([*crossing(), road(3, (0, 9, 0, 9), section(0, lane(-1)) + section(4, lane(-1), lane(-2)))],
         "no lane is linked to those behind it, and lanes with the same ids continue each other (road 3)"),
        ([*crossing(), road(3, (0, 9, 0, 9), TWO, to("successor", "road", 4, "start")),
          road(4, (9, 9, 0, 9), TWO)],
         "no lane is linked to those behind it, and lanes with the same ids continue each other (road 3)"),
    ],
)  # fmt: skip
def test_what_is_left_out_is_said_by_name(tmp_path: Path, parts: list[str], sentence: str) -> None:
    assert any(sentence in remark for remark in read(tmp_path, *parts).remarks)


@pytest.mark.parametrize(
    ("parts", "sentence"),
    [
        ([], "there is no road in it"),
        ([road(1, (0, 0, 0, 9), section(0, lane(-1, 2.0, "sidewalk")))], "no road that can be read"),
        ([road(1, (0, 0, 0, 9), TWO), road(2, (0, 9, 0, 9), TWO, rule="LHT")], "on some of its roads only"),
        ([road(1, (0, 0, 0, 9), TWO), road(1, (0, 9, 0, 9), TWO)], "two of its roads have the same id"),
        (["<!DOCTYPE x>"], "well-formed"),
    ],
)  # fmt: skip
def test_maps_that_cannot_be_read_are_refused_in_one_sentence(
    tmp_path: Path, parts: list[str], sentence: str
) -> None:
    with pytest.raises(UsageError, match=sentence):
        read(tmp_path, *parts)


SHAPES = [
    '<arc curvature="0.02"/>',
    '<spiral curvStart="-0.01" curvEnd="0.04"/>',
    '<poly3 a="0" b="0" c="0.004" d="-0.00003"/>',
    '<paramPoly3 pRange="normalized" aU="0" bU="58" cU="3" dU="-4" aV="0" bV="0" cV="12" dV="-5"/>',
    '<paramPoly3 pRange="arcLength" aU="0" bU="1" cU="0" dU="-2e-5" aV="0" bV="0" cV="0.006" dV="-4e-5"/>',
]


@pytest.mark.parametrize("shape", SHAPES)
def test_lines_lie_where_a_slow_reader_has_them(tmp_path: Path, shape: str) -> None:
    """Of a paramPoly3 the length that the file states is wrong by a little, as in real files."""
    plan = '<geometry s="0" x="{x}" y="{y}" hdg="{heading}" length="60">' + shape + "</geometry>"
    found = read(tmp_path, road(1, (5, 6, 0.7, 60), TWO, plan=plan), road(2, (0, 99, 0, 9), TWO))
    slow = SlowMap(tmp_path / "map.xodr")
    own = found.network.road(1).road
    away = LineString(slow.lines["1"][:, 1:3]).distance(
        points(own.at(np.linspace(0, own.length, 300))[:, :2])
    )
    assert away.max() < 1e-3
    back = np.abs(own.locate(*slow.lines["1"][:, 1:3].T)[1])
    assert back.max() < 1e-3


def test_a_route_follows_its_lane_where_reference_lines_jump_aside(tmp_path: Path) -> None:
    """The second road has its line 7 m to the right of the first one, on the right edge of its lanes."""
    aside = '<laneOffset s="0" a="7"/>' + section(0, lane(1, predecessor=1), lane(-1, predecessor=-1))
    found = read(
        tmp_path,
        road(1, (0, 0, 0, 80), section(0, lane(1, successor=1), lane(-1, successor=-1)),
             to("successor", "road", 2, "start")),
        road(2, (80, -7, 0, 80), aside, to("predecessor", "road", 1, "end")),
    )  # fmt: skip
    lanes = lanes_of(found.network)
    route = Route.along(found.network, over_roads(lanes, [(1,), (2,)])).on_ground()
    s = np.linspace(0.0, route.length, 200)
    assert route.profile is not None
    assert route.at(s, route.profile.middle(s))[:, 1] == pytest.approx(-1.75, abs=1e-6)
    assert route.profile.width(s) == pytest.approx(3.5, abs=1e-6)
    assert route.at(s, route.profile.edges(s).left)[:, 1] == pytest.approx(3.5, abs=1e-6)
    assert route.starts == pytest.approx((0.0, 80.0, 160.0))
    world = World().changed(speed_limit=50 / 3.6)
    assert judge(route, simulate(route, world, "reference", seed=1), world).kept


def test_the_ground_lies_under_every_lane_also_where_a_road_shrinks_to_a_line(tmp_path: Path) -> None:
    """A lane that narrows to nothing leaves a line behind in the union of all areas."""
    thin = '<lane id="-1" type="driving"><width sOffset="0" a="3"/><width sOffset="20" a="0"/></lane>'
    found = read(
        tmp_path, *crossing(), road(3, (0, 40, 0, 60), section(0, thin)), road(4, (0, 90, 0, 30), TWO)
    )
    collection = GeometryCollection(
        [MultiPolygon([box(0, 0, 2, 2), box(5, 0, 7, 2)]), LineString([(9, 0), (9, 5)])]
    )
    assert filled(collection).area == pytest.approx(8.0)
    for lane_there in lanes_of(found.network):
        s = np.linspace(2, lane_there.length - 2, 50)  # a step of the width is drawn as a short taper
        wide = np.minimum(lane_there.width(s - 2), lane_there.width(s + 2)) > 0.3
        under = points(lane_there.at(s)[wide, :2])
        assert found.network.paved.buffer(0.01).contains(under).all()


def test_routes_between_points_and_at_random(tmp_path: Path) -> None:
    found = read(tmp_path, *crossing())
    lanes = lanes_of(found.network)
    way = (Leg(1, -1), Leg(5, -1), Leg(2, -1))
    assert between(lanes, (10, -2), (150, -2)) == way
    for start, goal, said in (
        ((150, 2), (10, 2), "no way leads from the one point to the other"),
        ((10, 40), (150, 2), "no road within 10 m of"),
    ):
        with pytest.raises(UsageError, match=said):
            between(lanes, start, goal)
    assert way in random_routes(lanes, 5, 0)
    assert random_routes(lanes, 5, 0) == random_routes(lanes, 5, 0)
    long = [road(11 + n, (0, 50 + 20 * n, 0, 400), TWO) for n in range(9)]
    ways = random_routes(lanes_of(read(tmp_path, *crossing(), *long).network), 9, 0)
    assert ways == [way]  # the one way through the junction, not the long roads beside it
    short = [road(11 + n, (0, 50 + 20 * n, 0, 90 if n else 110), TWO) for n in range(4)]
    only = lanes_of(read(tmp_path, *short).network)
    assert {leg.road for found in random_routes(only, 5, 0) for leg in found} == {11}
    with pytest.raises(UsageError, match="no way leads on from road 1 of the route"):
        over_roads(lanes, [(2,), (1,)])
    with pytest.raises(UsageError, match="inside a junction"):
        over_roads(lanes, [(1,), (5,)])


def test_a_route_leads_along_no_lane_that_is_too_narrow(tmp_path: Path) -> None:
    """A turn lane begins with no width, so a route changes to it, and does not begin on it."""
    taper = '<lane id="-2" type="driving"><link><successor id="-1"/></link>'
    taper += (
        '<width sOffset="0" a="0" b="0.07"/><width sOffset="50" a="3.5"/><roadMark sOffset="0" type="none"/>'
    )
    lanes = section(0, lane(1), lane(-1), taper + "</lane>")
    one = road(1, (0, 0, 0, 120), lanes, to("successor", "road", 2, "start"))
    two = road(
        2, (120, -3.5, 0, 60), section(0, lane(-1, predecessor=-2)), to("predecessor", "road", 1, "end")
    )
    found = read(tmp_path, one, two)
    way = over_roads(lanes_of(found.network), [(1,), (2,)])
    assert way == (Leg(1, -1), Leg(1, -2), Leg(2, -1))
    route = Route.along(found.network, way)
    assert route.profile is not None
    ends = route.at([0.0, route.length], route.profile.middle([0.0, route.length]))
    assert ends[:, 1] == pytest.approx([-1.75, -5.25], abs=1e-6)
    assert math.isclose(route.length, 180, abs_tol=0.2)
