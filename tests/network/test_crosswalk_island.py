"""Crosswalks with an island: how wide the file has it, and how the lanes lead around it."""

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.errors import BriefError, UsageError
from roadgpt.export import save
from roadgpt.network import build_route, read_map
from roadgpt.road import World, read_design
from roadgpt.run import Run, Setup, perform

LEAST = 2.0  # m, RASt 06: where persons wait in the middle of a road
WORDS = "straight len=140 // crosswalk island // straight len=140"
LANE, LENGTH = 4.0, 140.0


@pytest.fixture(scope="module", params=["", " || left_hand"])
def crossed(request: pytest.FixtureRequest) -> Run:
    words = f"{WORDS}{request.param} && ego v=40; adult crosswalk right v=5"
    return perform(words, seed=5, setup=Setup(driver="reference", reader="plan"))


def polynomial(rows: list[ET.Element], s: float, at: str) -> float:
    """The value at a station of an element that OpenDRIVE gives by cubics."""
    before = [each for each in rows if float(each.attrib[at]) <= s + 1e-9]
    if not before:
        return 0.0
    row = before[-1]
    return float(np.polyval([float(row.attrib[n]) for n in "dcba"], s - float(row.attrib[at])))


def across(road: ET.Element, s: float) -> dict[str, list[float]]:
    """The right and the left edge of the lanes of each type at a station."""
    (section,) = road.iter("laneSection")
    edges: dict[str, list[float]] = {}
    for side, sign in (("left", 1), ("right", -1)):
        t = polynomial([*road.iter("laneOffset")], s, "s")
        lanes = {abs(int(each.attrib["id"])): each for each in section.iterfind(f"{side}/lane")}
        for _, lane in sorted(lanes.items()):
            far = t + sign * polynomial([*lane.iter("width")], s, "sOffset")
            edges.setdefault(lane.attrib["type"], []).extend(sorted((t, far)))
            t = far
    return edges


def test_the_file_has_an_island_and_lanes_of_the_same_width_around_it(crossed: Run, tmp_path: Path) -> None:
    assert crossed.road is not None
    save(crossed.road, tmp_path, ["opendrive"], crossed.world, "a")
    root = ET.parse(tmp_path / "a.xodr").getroot()
    begin, found, (object_,) = 0.0, {}, [*root.iter("object")]
    roads = {each.attrib["id"]: each for each in root.iter("road")}
    after = {
        number: end.attrib["elementId"]
        for number, road in roads.items()
        if (end := road.find("link/successor")) is not None
    }
    (first,) = {*roads} - {*after.values()}
    ways = [first]
    while ways[-1] in after:
        ways.append(after[ways[-1]])
    for road in map(roads.__getitem__, ways):
        length = float(road.attrib["length"])
        for s in np.linspace(0.0, length, 80):
            found[begin + s] = across(road, float(s))
        if object_ in [*road.iter("object")]:
            walked = begin + float(object_.attrib["s"])
            here = across(road, float(object_.attrib["s"]))
            wide, t = float(object_.attrib["width"]), float(object_.attrib["t"])
        begin += length
    assert begin == pytest.approx(2 * LENGTH, rel=0.1)
    assert np.ptp(here["median"]) >= LEAST - 1e-6
    ends = here["driving"]
    assert (t - wide / 2, t + wide / 2) == pytest.approx((min(ends), max(ends)), abs=0.01)
    for s, edges in found.items():
        lanes = np.sort(edges["driving"])
        assert lanes[[1, 3]] - lanes[[0, 2]] == pytest.approx([LANE, LANE], abs=1e-6)
        island = np.ptp(edges.get("median", [0.0]))
        assert lanes[2] - lanes[1] == pytest.approx(island, abs=1e-6)
        assert island == 0.0 or abs(s - walked) < 45.0
    for less, more in zip(sorted(found), sorted(found)[1:], strict=False):  # nothing jumps
        change = np.abs(np.sort(found[more]["driving"]) - np.sort(found[less]["driving"])).max()
        assert change <= 0.1 * (more - less) + 1e-6
    read = read_map(tmp_path / "a.xodr")
    assert len(read.network.crossed) == 1


def test_the_car_leads_around_it_and_gives_way_there(crossed: Run) -> None:
    road, drive = crossed.road, crossed.drive
    assert road is not None
    assert drive is not None
    assert drive.others is not None
    assert crossed.outcome == "PASS"
    (place,) = road.crosswalks
    begin, beside = (int(np.abs(drive["s"] - s).argmin()) for s in (15.0, place.s))
    x, y = drive["x"], drive["y"]
    along = np.arctan2(y[begin + 50] - y[begin], x[begin + 50] - x[begin])
    aside = (y[beside] - y[begin]) * np.cos(along) - (x[beside] - x[begin]) * np.sin(along)
    outward = 1 if road.network.left_hand else -1
    assert outward * aside == pytest.approx(LEAST / 2, abs=0.6)
    walker = drive.others.states[:, 0]
    assert np.nanmin(np.linalg.norm(walker[:, :2] - road.at(place.s)[:2], axis=1)) < 0.5
    assert drive["speed"][drive["s"] < place.s].min() < 0.7 * drive["speed"][0]


def test_plans_say_it_of_crosswalks_of_their_own_and_roads_that_can_have_it() -> None:
    assert plan(read_plan(WORDS)) == WORDS
    with pytest.raises(BriefError, match="no crossroads can be built as"):
        perform("crossroads left island", seed=1, setup=Setup(reader="plan"))
    straight = {"distance": 60, "direction": "straight", "incline": 0, "turn_degrees": 0}
    design = {
        "starting_point": [0, 0, 0],
        "theta": 0,
        "road_segment1": straight,
        "road_segment2": straight,
        "junction1": {"after": 1, "kind": "crosswalk", "island": True},
    }
    assert build_route(read_design(design)[0], World()).length == pytest.approx(120)
    with pytest.raises(UsageError, match="an island divides the two directions"):
        build_route(read_design({**design, "lanes": {"forward": 1, "backward": 0}})[0], World())
    design["road_segment2"] = {**straight, "distance": 30}
    with pytest.raises(UsageError, match="needs 42 m of the roads before and behind it, and one is 30 m"):
        build_route(read_design(design)[0], World())
