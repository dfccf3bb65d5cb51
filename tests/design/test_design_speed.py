"""Roads of a design speed, and roads that come from somewhere: measured on the OpenDRIVE file."""

import math
from xml.etree.ElementTree import Element, fromstring

import numpy as np
import pytest

from network.ruled import findings
from paper_roads import road_of, straight, turn
from roadgpt.brief import read
from roadgpt.brief.design_speed import SIGHT, limits_at
from roadgpt.brief.model import Brief, exactly
from roadgpt.design import draft
from roadgpt.design.room import speed_remark, world_for
from roadgpt.export.exporters.opendrive import document
from roadgpt.network import Route, build_route
from roadgpt.road import World, build
from slow_opendrive import cubic, line

GREEN_BOOK = {
    30: (21, 2, 6, 35),
    40: (43, 4, 9, 50),
    50: (79, 7, 13, 65),
    60: (123, 11, 18, 85),
    70: (184, 17, 23, 105),
    80: (252, 26, 30, 130),
    90: (336, 39, 38, 160),
    100: (437, 52, 45, 185),
    110: (560, 74, 55, 220),
    120: (756, 95, 63, 250),
    130: (951, 124, 73, 285),
}
"""Printed tables, by km/h: least radius at 6 % (m), K of crests and of sags (m per %), sight distance (m)."""
HEADINGS = {"east": 180, "northeast": 225, "south": 90, "southwest": 45, "northwest": 315, "west": 0}
FAR = 5.0  # m between points: coordinates in files are rounded to the millimetre
AT_JUNCTION = 45.0  # m: roads are level there
PLANS = [
    "turn left 60; turn left; turn right gentle | speed=100 from=south",
    "turn up; dip; turn | speed=50 from=northwest",
    "| hills=2 speed=80 from=east",
    "straight up; straight down | speed=120",
    "turn x2; straight 300 down | speed=30 hard",
    "| len=3000 speed=50 from=west",
    "turn // crossroads left // | hills=1 // t_junction right // turn x2 | down || speed=80 from=southwest",
    "| speed=50 // crossroads left // turn left || speed=50 left_hand from=northeast",
    "turn left; turn right | country",
    "turn | residential // crossroads left // turn x2 || residential",
]
USUAL = {"country": 80, "residential": 30}  # km/h, on a country road and in a 30 km/h zone


@pytest.mark.parametrize("kmh", GREEN_BOOK)
def test_the_limits_are_those_of_the_printed_tables(kmh: int) -> None:
    radius, crest, sag, sight = GREEN_BOOK[kmh]
    limits = limits_at(float(kmh))
    assert abs(limits.radius - radius) < 1
    assert -1 < limits.crest / 100 - crest < 0.05  # printed ones are rounded up
    assert -1 < limits.sag / 100 - sag < 0.05
    stopping = 0.278 * kmh * 2.5 + 0.039 * kmh**2 / 3.4  # 2.5 s, then 3.4 m/s2
    assert SIGHT[kmh // 10 - 2] == sight
    assert -0.5 < sight - stopping < 5


def test_limits_between_two_rows_lie_between_theirs() -> None:
    speeds = [20 + step / 4 for step in range(441)]
    rows = np.array([limits_at(kmh) for kmh in speeds])
    assert (np.diff(rows, axis=0) > 0).all()
    assert (np.diff(rows, axis=0) < 0.05 * rows[1:]).all()


def measured(road: Element) -> tuple[float, float, float]:
    """The least radius, and the least vertical radii of crests and sags, off the level ends at junctions."""
    rows = line(road)
    stations = np.arange(0.0, rows[-1, 0], FAR)
    x, y = (np.interp(stations, rows[:, 0], rows[:, at]) for at in (1, 2))
    steps = np.hypot(np.diff(x), np.diff(y))
    bends = np.diff(np.unwrap(np.arctan2(np.diff(y), np.diff(x)))) / ((steps[1:] + steps[:-1]) / 2)
    links = [road.find(f"link/{way}[@elementType='junction']") for way in ("predecessor", "successor")]
    off = [AT_JUNCTION if link is not None else 0.0 for link in links]
    s = np.arange(off[0], rows[-1, 0] - off[1], 1.0)
    heights = [cubic(road.findall("elevationProfile/elevation"), at, 0.0, "s") for at in s.tolist()]
    curves = np.append(np.diff(heights, 2), 0.0)
    most = (float(np.abs(bends).max()), float(-curves.min()), float(curves.max()))
    radius, crest, sag = (1 / max(each, 1e-9) for each in most)
    return radius, crest, sag


@pytest.mark.parametrize("plan", PLANS)
def test_roads_of_a_design_speed_have_its_radii_and_come_from_where_they_should(plan: str) -> None:
    brief = read(plan, "plan", is_map_fixed=False)
    world = world_for(brief, World())
    design = draft(brief, world, seed=2)
    road = build(design) if design.is_plain else build_route(design, world)
    rings = {str(name) for name in road.network.roundabout_of} if isinstance(road, Route) else set()
    roads = fromstring(document(road, world).to_text()).findall("road")
    roads = [each for each in roads if each.get("junction") == "-1" and each.get("id") not in rings]
    said = plan.partition("speed=")[2].split()[:1] or [USUAL[word] for word in plan.split() if word in USUAL]
    limits = limits_at(float(said[0]))
    long = [each for each in roads if float(each.get("length", "0")) > 2 * AT_JUNCTION + FAR]
    assert long
    for each in long:
        radius, crest, sag = measured(each)
        assert radius > 0.99 * limits.radius
        assert crest > 0.98 * limits.crest
        assert sag > 0.98 * limits.sag
    if brief.comes_from:
        x, y = (road.at(3.0) - road.at(0.0))[:2]
        off = math.degrees(math.atan2(y, x)) - HEADINGS[brief.comes_from]
        assert abs((off + 180) % 360 - 180) < 22.5


SLOPE = (straight(100, 3.0), straight(100, 0.0))


@pytest.mark.parametrize(
    ("brief", "segments", "said"),
    [
        (Brief(speed=50, turns=exactly(1)), (straight(50), turn(60, 76), straight(50)), "79 m or more"),
        (Brief(speed=50, turns=exactly(1)), (straight(50), turn(60, 80), straight(50)), None),
        (Brief(speed=50, turns=exactly(0)), (straight(50), turn(4, 60), straight(50)), "radius of 79 m"),
        (
            Brief(speed=60, turns=exactly(0)),
            SLOPE,
            "crest of 1098 m or more for 60 km/h",
        ),
        (Brief(speed=50, turns=exactly(0)), SLOPE, None),
        (Brief(speed=50, turns=exactly(0)), SLOPE[::-1], "vertical radius of a sag of 1216 m or more"),
        (Brief(comes_from="west", turns=exactly(0)), SLOPE, None),
        (Brief(comes_from="northwest", turns=exactly(0)), SLOPE, "from the northwest, a heading of 315"),
    ],
)
def test_the_finished_geometry_is_compared_with_what_was_asked(brief, segments, said) -> None:
    rounded = [each.model_copy(update={"vertical_radius": 700.0}) for each in segments]
    found = [each.sentence for each in findings("promises", road_of(*rounded), World(), brief)]
    assert found == [] if said is None else any(said in sentence for sentence in found)


def test_a_design_speed_leaves_the_speed_limit_and_says_so() -> None:
    brief, world = Brief(speed=100), World()
    found = world_for(brief, world)
    assert found.limits == world.limits
    assert "designed for 100 km/h, but driven at 70 km/h" in speed_remark(brief, world, found)
    assert not speed_remark(brief, world.changed(speed_limit=100 / 3.6), found)
    assert not speed_remark(Brief(), world, found)
