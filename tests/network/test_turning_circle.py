"""Roads that end in a turning circle: as large as the guide has it, and one turns back there."""

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
import shapely

from roadgpt.brief.plan import plan, read_plan
from roadgpt.errors import BriefError, UsageError
from roadgpt.export import save
from roadgpt.network import build_route, is_route, read_map
from roadgpt.network.paved import areas_of
from roadgpt.road import World, read_design
from roadgpt.run import Run, Setup, perform

GUIDE = (10.0, 15.0)  # m: AASHTO 2018, outside radius of a cul-de-sac where people live, and of others
WORDS = "straight len=70 // turning_circle"


@pytest.fixture(scope="module", params=["", " || left_hand"])
def ended(request: pytest.FixtureRequest) -> Run:
    return perform(WORDS + request.param, seed=4, setup=Setup(driver="reference", reader="plan"))


def test_the_file_has_a_circle_of_the_guides_size_with_one_arm(ended: Run, tmp_path: Path) -> None:
    assert ended.road is not None
    save(ended.road, tmp_path, ["opendrive"], ended.world, "a")
    root = ET.parse(tmp_path / "a.xodr").getroot()
    roads = {each.attrib["id"]: each for each in root.iter("road")}
    outside, arms = [road for road in roads.values() if road.attrib["junction"] == "-1"], []
    for road in outside:
        length = sum(float(each.attrib["length"]) for each in road.iter("geometry"))
        arcs = [float(each.attrib["curvature"]) for each in road.iter("arc")]
        if len(arcs) == 1 and abs(arcs[0]) > 0.05:
            (width,) = {float(each.attrib["a"]) for each in road.iter("width") if float(each.attrib["a"])}
            assert GUIDE[0] - 0.1 <= 1 / abs(arcs[0]) + width <= GUIDE[1] + 0.1
            assert length > np.pi / abs(arcs[0])  # more than half of the circle
        else:
            arms.append(road)
    assert len(arms) == len(outside) - 1 == 1
    (junction,) = root.iter("junction")
    into = [
        each for each in junction.iter("connection") if each.attrib["incomingRoad"] == arms[0].attrib["id"]
    ]
    assert len(into) == 1
    read = read_map(tmp_path / "a.xodr").network
    assert [kind for kind, _ in read.nodes] == ["roundabout"]


def test_the_car_turns_back_there_and_stays_on_the_road(ended: Run) -> None:
    road, drive = ended.road, ended.drive
    assert road is not None
    assert is_route(road)
    assert drive is not None
    assert ended.outcome == "PASS"
    turned = np.unwrap(drive["heading"])
    assert abs(abs(turned[-1] - turned[0]) - np.pi) < 0.15
    sign = -1 if road.network.left_hand else 1
    assert sign * (turned[-1] - turned[0]) > 0  # the way round on which one drives
    paved = areas_of([each.road for each in road.network.roads])
    assert shapely.covers(shapely.union_all(paved), shapely.points(drive["x"], drive["y"])).all()
    far = np.hypot(drive["x"] - drive["x"][0], drive["y"] - drive["y"][0])
    assert far[-1] < 10.0 < far.max()


def test_its_plan_is_read_and_written() -> None:
    assert plan(read_plan(WORDS)) == f"{WORDS} back"
    for wrong in ("turning_circle left", "turning_circle lights", "turning_circle // straight 50"):
        with pytest.raises(BriefError):
            perform(f"straight 50 // {wrong}", seed=1, setup=Setup(reader="plan"))


def test_a_design_and_a_map_can_have_them() -> None:
    straight = {"distance": 50, "direction": "straight", "incline": 0, "turn_degrees": 0}
    design = {"starting_point": [0, 0, 0], "theta": 0, "road_segment1": straight}
    ends = {"junction1": {"after": 1, "kind": "turning_circle", "take": 1, "radius": 7}}
    route = build_route(read_design({**design, **ends})[0], World())
    assert route.length > 100 + np.pi * 7
    ends["junction1"]["arms"] = [{"angle": 0}]
    with pytest.raises(UsageError, match="turning_circle has 0 arms besides"):
        read_design({**design, **ends})
    nodes = {
        "node1": {"at": [0, 0, 0], "kind": "turning_circle", "radius": 8},
        "node2": {"at": [100, 0, 0], "kind": "end"},
    }
    made = build_route(read_design({**nodes, "roads": [[1, 2]], "route": [2, 1, 2]})[0], World())
    assert made.length > 160
