"""OpenDRIVE files, read with nothing but an XML parser and the formulas of the standard."""

import math
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from scipy.integrate import quad

from exported import ROADS, WORLD
from roadgpt.errors import ExportError
from roadgpt.export import save
from roadgpt.export.exporters.opendrive import document
from roadgpt.geometry import CubicProfile, GradeProfile, Piece, PieceCurve
from roadgpt.road import Road, World, build
from strategies import designs

LEVEL = GradeProfile(0.0, (0.0, 1.0), (0.0, 0.0))


def parsed(road: Road, world: World = WORLD) -> ET.Element:
    return ET.fromstring(document(road, world).to_text())


def numbers(element: ET.Element, *names: str) -> list[float]:
    return [float(element.attrib[name]) for name in names]


def by_the_standard(geometry: ET.Element, u: float) -> tuple[float, float]:
    """Where an element is after u metres, integrated numerically from the standard's definitions."""
    x, y, heading, length = numbers(geometry, "x", "y", "hdg", "length")
    (shape,) = geometry
    if shape.tag == "paramPoly3":
        assert shape.attrib["pRange"] == "arcLength"
        a, b = (
            sum(float(shape.attrib[f"{letter}{axis}"]) * u**i for i, letter in enumerate("abcd"))
            for axis in "UV"
        )
        return (
            x + a * math.cos(heading) - b * math.sin(heading),
            y + a * math.sin(heading) + b * math.cos(heading),
        )
    k0, k1 = {
        "line": lambda: [0.0, 0.0],
        "arc": lambda: numbers(shape, "curvature", "curvature"),
        "spiral": lambda: numbers(shape, "curvStart", "curvEnd"),
    }[shape.tag]()

    def angle(v: float) -> float:
        return heading + k0 * v + (k1 - k0) * v * v / (2 * length)

    return x + quad(lambda v: math.cos(angle(v)), 0, u)[0], y + quad(lambda v: math.sin(angle(v)), 0, u)[0]


@pytest.mark.parametrize("name", ROADS)
def test_the_reference_line_is_ours(name: str) -> None:
    road = ROADS[name]
    root = parsed(road)
    near = 1e-6 if road.nodes is None else 2e-4
    reached = 0.0
    for geometry in root.iter("geometry"):
        s, length = numbers(geometry, "s", "length")
        assert s == pytest.approx(reached, abs=1e-9)
        reached = s + length
        for u in (0.0, 0.3 * length, length):
            x, y, _ = road.at(min(s + u, road.length))
            assert by_the_standard(geometry, u) == pytest.approx((x, y), abs=near)
    assert reached == pytest.approx(road.length, abs=1e-9)
    assert float(root.find("road").attrib["length"]) == road.length


@pytest.mark.parametrize("name", ROADS)
def test_the_heights_are_ours(name: str) -> None:
    road = ROADS[name]
    rows = np.array([numbers(each, *"sabcd") for each in parsed(road).iter("elevation")])
    assert rows[0, 0] == 0
    assert (np.diff(rows[:, 0]) > 0).all()
    s = np.linspace(0, road.length, 501)
    s0, a, b, c, d = rows[np.searchsorted(rows[:, 0], s, side="right") - 1].T
    u = s - s0
    near = 1e-9 if road.nodes is None else 2e-4
    assert a + b * u + c * u**2 + d * u**3 == pytest.approx(road.at(s)[:, 2], abs=near)


@given(designs())
@settings(max_examples=30)
def test_a_design_becomes_its_own_lines_arcs_and_spirals(design: object) -> None:
    road = build(design)
    shapes = [geometry[0] for geometry in parsed(road).iter("geometry")]
    assert {shape.tag for shape in shapes} <= {"line", "arc", "spiral"}
    for shape in shapes:  # CommonRoad refuses spirals whose curvatures numpy calls close
        if shape.tag == "spiral":
            assert not np.isclose(*numbers(shape, "curvStart", "curvEnd"))


def test_a_spiral_that_hardly_bends_is_told_as_arcs_that_stay_on_it() -> None:
    plan = PieceCurve(0, 0, 0, (Piece(20, 0, 0.05), Piece(300, 0.05, 0.0500004), Piece(20, 0.0500004, 0)))
    road = Road(plan, LEVEL)
    geometries = list(parsed(road).iter("geometry"))
    tags = [geometry[0].tag for geometry in geometries]
    assert tags[0] == tags[-1] == "spiral"
    assert len(tags) > 3
    assert set(tags[1:-1]) == {"arc"}
    for geometry in geometries:
        s, length = numbers(geometry, "s", "length")
        assert by_the_standard(geometry, length) == pytest.approx(plan.at(s + length), abs=2e-5)


@pytest.mark.parametrize("short", [2e-6, 1e-4, 0.01])
def test_the_shortest_pieces_that_are_told_are_told_as_they_are(short: float) -> None:
    pieces = (
        Piece(short),
        Piece(10),
        Piece(short, 0, 1 / 50),
        Piece(short, 1 / 50, 1 / 50),
        Piece(10, 1 / 50, 0),
    )
    geometries = list(parsed(Road(PieceCurve(5, 6, 1, pieces), LEVEL)).iter("geometry"))
    assert [float(each.attrib["length"]) for each in geometries] == [piece.length for piece in pieces]


def test_the_header_says_where_and_of_what_revision_and_not_when() -> None:
    road = ROADS["arcs"]
    header = parsed(road).find("header")
    assert (header.attrib["revMajor"], header.attrib["revMinor"]) == ("1", "8")
    assert "date" not in header.attrib
    assert header.find("geoReference").text.startswith("+proj=tmerc +lat_0=48 +lon_0=9")
    assert "+no_defs" not in header.find("geoReference").text
    reach = WORLD.section.lane_width + WORLD.section.shoulder
    x, y = road.at(np.linspace(0, road.length, 999)[:, None], np.array([-reach, reach])).T[:2]
    west, east, south, north = numbers(header, "west", "east", "south", "north")
    assert west <= x.min() + 0.01
    assert east >= x.max() - 0.01
    assert south <= y.min() + 0.01
    assert north >= y.max() - 0.01


def test_numbers_that_are_not_finite_are_refused(tmp_path: Path) -> None:
    road = Road(PieceCurve(0, 0, 0, (Piece(10),)), CubicProfile((0.0,), ((math.nan, 0, 0, 0),)))
    with pytest.raises(ExportError, match="not finite"):
        save(road, tmp_path, ["opendrive"], WORLD)
    assert list(tmp_path.iterdir()) == []
