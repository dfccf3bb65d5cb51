"""OpenDRIVE files of roads with cross-sections of their own, and what our import makes of them."""

import xml.etree.ElementTree as ET
from dataclasses import replace

import pytest

from profiled import smooth
from roadgpt.export.exporters.opendrive import document
from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve
from roadgpt.road import Profile, Road, World

LENGTH = 150.0
PLAN = PieceCurve(60.0, 60.0, 0.3, (Piece(50.0), Piece(100.0, 0.0, 1 / 60)))
CLIMB = GradeProfile(0.0, (0.0, LENGTH), (0.02, 0.05))
BANK = CubicProfile(
    (0.0, LENGTH), ((0.0, 0.0, -3 * 0.06 / LENGTH**2, 2 * 0.06 / LENGTH**3), (-0.06, 0, 0, 0))
)


def element(road: Road) -> ET.Element:
    found = ET.fromstring(document(road, World()).to_text()).find("road")
    assert found is not None
    return found


def lanes(road: ET.Element) -> dict[int, ET.Element]:
    return {int(lane.attrib["id"]): lane for lane in road.iter("lane")}


def marks(road: ET.Element) -> dict[int, tuple[str, str] | None]:
    found = {id_: lane.find("roadMark") for id_, lane in lanes(road).items()}
    return {
        id_: None if mark is None else (mark.attrib["type"], mark.attrib["laneChange"])
        for id_, mark in found.items()
    }


def value(rows: list[ET.Element], station: str, s: float) -> float:
    """A cubic by the formula of the standard."""
    row = [row for row in rows if float(row.attrib[station]) <= s][-1]
    u = s - float(row.attrib[station])
    return sum(float(row.attrib[letter]) * u**n for n, letter in enumerate("abcd"))


def test_three_and_two_lanes_have_their_ids_kinds_marks_limits_and_friction() -> None:
    road = element(Road(PLAN, CLIMB, profile=Profile.of(3, 2, 3.5, 1.5)))
    kinds = {id_: lane.attrib["type"] for id_, lane in lanes(road).items()}
    assert list(kinds) == [3, 2, 1, 0, -1, -2, -3, -4]  # from left to right, as the standard wants
    assert [id_ for id_, kind in kinds.items() if kind == "shoulder"] == [3, -4]
    assert [id_ for id_, kind in kinds.items() if kind == "driving"] == [2, 1, -1, -2, -3]
    broken, solid = ("broken", "both"), ("solid", "none")
    assert marks(road) == {
        3: None, 2: solid, 1: broken, 0: solid, -1: broken, -2: broken, -3: solid, -4: None,
    }  # fmt: skip
    for id_, lane in lanes(road).items():
        has_limit = kinds[id_] == "driving"
        assert (lane.find("speed") is not None, lane.find("material") is not None) == (has_limit, has_limit)
    assert road.attrib["rule"] == "RHT"
    assert road.find("lateralProfile") is None


def test_widths_and_superelevation_are_cubics_of_the_station() -> None:
    profile = replace(Profile.of(1, 1, smooth(3.0, 4.0, LENGTH)), superelevation_angle=BANK)
    road = element(Road(PLAN, CLIMB, profile=profile))
    rows = road.findall("lateralProfile/superelevation")
    for s in (0.0, 40.0, 100.0, 149.9):
        share = s / LENGTH
        smoothed = 3 * share**2 - 2 * share**3
        assert value(rows, "s", s) == pytest.approx(-0.06 * smoothed, abs=1e-12)
        for id_ in (1, -1):
            width = value(lanes(road)[id_].findall("width"), "sOffset", s)
            assert width == pytest.approx(3.0 + smoothed, abs=1e-12)
