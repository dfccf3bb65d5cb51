"""Bus bays: how long and deep the file has them, and that a bus stands in one and pulls out."""

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from roadgpt.brief.plan import plan, read_plan
from roadgpt.errors import DesignError
from roadgpt.export import save
from roadgpt.network import read_map
from roadgpt.run import Run, Setup, perform
from roadgpt.traffic import SIZES

DEEP, INTO, STANDS, OUT = 3.0, 25.0, 18.0, 15.0  # m: RASt 06, a bay for a bus of 18 m in a town
WORDS = "straight len=80 // bus_bay // straight len=160"


@pytest.fixture(scope="module", params=["right", "left"])
def passed(request: pytest.FixtureRequest) -> Run:
    hand = " || left_hand" if request.param == "left" else ""
    words = f"{WORDS}{hand} && ego v=40; bus parked {request.param} s=114: pull_out"
    return perform(words, seed=7, setup=Setup(driver="reference", reader="plan"))


def test_the_file_has_a_bay_of_that_size_beside_the_lane(passed: Run, tmp_path: Path) -> None:
    assert passed.road is not None
    save(passed.road, tmp_path, ["opendrive"], passed.world, "a")
    root = ET.parse(tmp_path / "a.xodr").getroot()
    (bay,) = [lane for lane in root.iter("lane") if lane.attrib["type"] == "parking"]
    is_left = passed.world.profile_of(passed.road).left_hand
    assert int(bay.attrib["id"]) == (2 if is_left else -2)  # beside the only lane of its direction
    rows = [[float(each.attrib[n]) for n in ("sOffset", "a", "b", "c", "d")] for each in bay.iter("width")]
    s = np.arange(0.0, INTO + STANDS + OUT + 20.0, 0.5)
    row = np.searchsorted([each[0] for each in rows], s, side="right") - 1
    depth = np.array([np.polyval(rows[n][:0:-1], at - rows[n][0]) for n, at in zip(row, s, strict=True)])
    full = s[depth > DEEP - 1e-6]
    assert (full.min(), full.max()) == pytest.approx((INTO, INTO + STANDS), abs=0.5)
    assert depth[s >= INTO + STANDS + OUT] == pytest.approx(0.0, abs=1e-9)
    assert (np.diff(depth[s <= INTO]) >= 0).all()
    assert (np.diff(depth[s >= INTO + STANDS]) <= 1e-12).all()
    assert [
        len(each.road.profile.lanes)
        for each in read_map(tmp_path / "a.xodr").network.roads
        if each.road.profile
    ] == [4, 5]


def test_the_bus_stands_in_it_and_pulls_out(passed: Run) -> None:
    road, drive = passed.road, passed.drive
    assert road is not None
    assert drive is not None
    assert drive.others is not None
    assert passed.outcome == "PASS"
    states, profile = drive.others.states[:, 0], passed.world.profile_of(road)
    s, t = (each[0] for each in road.locate(states[:1, 0], states[:1, 1]))
    half, side = SIZES["bus"].width / 2, 1 if profile.left_hand else -1
    edge = float(profile.edges(s).left if side > 0 else profile.edges(s).right)
    inner, outer = side * (t - edge) - half, side * (t - edge) + half
    assert 0.0 < inner < outer < DEEP
    assert s - SIZES["bus"].length / 2 > 80.0 + INTO
    assert s + SIZES["bus"].length / 2 < 80.0 + INTO + STANDS
    there = states[~np.isnan(states[:, 0])][-1]
    _, last = road.locate(there[:1], there[1:2])
    assert float(last[0]) == pytest.approx(side * 2.0, abs=0.5)  # in the middle of its lane


def test_its_plan_is_read_and_written_and_a_short_road_is_refused() -> None:
    assert plan(read_plan(WORDS)) == WORDS
    with pytest.raises(DesignError, match="a bus bay needs 58 m of the road behind it"):
        perform("straight 60 // bus_bay // straight 40", seed=1, setup=Setup(reader="plan"))


def test_a_bus_that_is_parked_stands_in_the_bay_if_nothing_else_is_said() -> None:
    words = f"{WORDS} && ego v=40; bus parked right: pull_out gap=20; bus parked left"
    run = perform(words, seed=7, setup=Setup(driver="robot", reader="plan"))
    assert run.road is not None
    assert run.drive is not None
    assert run.drive.others is not None
    s, t = run.road.locate(*run.drive.others.states[0, :, :2].T)
    assert s[0] == pytest.approx(80.0 + INTO + STANDS / 2, abs=2.5)
    assert t[0] < -2.0 < 2.0 < t[1]


def test_a_crosswalk_that_comes_too_soon_is_told_with_its_place() -> None:
    words = "straight 90 // crosswalk // straight 90 && adult crosswalk right: cross"
    run = perform(words, seed=1, setup=Setup(driver="robot", reader="plan"))
    assert run.outcome == "INVALID"
    (place,) = re.findall(r"its last crosswalk at (\d+) m", run.description)
    assert 85 < int(place) < 95
