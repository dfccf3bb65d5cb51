"""OpenDRIVE files become Roads: those we wrote, those of other tools, and each element by hand."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from scipy.integrate import quad

from exported import ROADS, WORLD
from roadgpt.check.describing import describe
from roadgpt.errors import UsageError
from roadgpt.export import save
from roadgpt.export.exporters.opendrive import document
from roadgpt.geometry import GradeProfile
from roadgpt.network import ImportedRoad, read_map, read_opendrive, read_source
from roadgpt.road import Road, World, build
from strategies import designs
from tables import rows

DATA = Path(__file__).parent / "data"
LANES = """<lanes>{offset}<laneSection s="0">
<left><lane id="1" type="driving"><width sOffset="0" a="3"/></lane></left>
<center><lane id="0" type="none"><roadMark sOffset="0" type="broken"/></lane></center>
<right>{right}</right></laneSection></lanes>"""
RIGHT = """<lane id="-1" type="driving"><width sOffset="0" a="3"/></lane>
<lane id="-2" type="border"><width sOffset="0" a="0.5"/></lane>"""
LINE = '<geometry s="0" x="1" y="2" hdg="0.5" length="40"><line/></geometry>'


def file(
    folder: Path, line: str = LINE, rest: str = "", right: str = RIGHT, offset: str = "", road: str = ""
) -> Path:
    lanes = LANES.format(right=right, offset=offset)
    path = folder / "some.xodr"
    path.write_text(
        f'<?xml version="1.0"?><OpenDRIVE><header revMajor="1" revMinor="4"/><road id="1" {road}>'
        f"<planView>{line}</planView>{rest}{lanes}</road></OpenDRIVE>"
    )
    return path


def written(road: Road, folder: Path, world: World = WORLD) -> ImportedRoad:
    *_, path = save(road, folder, ["opendrive"], world)
    return read_opendrive(path)


def apart(one: Road, other: Road) -> float:
    assert one.length == pytest.approx(other.length, abs=1e-3)
    s = np.linspace(0, min(one.length, other.length), 1000)
    return float(np.abs(one.at(s) - other.at(s)).max())


@given(designs())
@settings(max_examples=20)
def test_what_we_export_comes_back_as_it_was(
    tmp_path_factory: pytest.TempPathFactory, design: object
) -> None:
    road = build(design)
    path = tmp_path_factory.mktemp("trip") / "road.xodr"
    path.write_text(document(road, WORLD).to_text())
    found = read_opendrive(path)
    assert found.remarks == ()
    assert apart(found.road, road) < 1e-5
    assert isinstance(found.road.elevation, GradeProfile)


@pytest.mark.parametrize("name", ROADS)
def test_every_kind_of_road_comes_back_within_a_millimetre(tmp_path: Path, name: str) -> None:
    found = written(ROADS[name], tmp_path)
    assert apart(found.road, ROADS[name]) < 1e-3
    assert apart(Road.from_json(found.road.to_json()), found.road) == 0
    assert apart(written(found.road, tmp_path / "again").road, found.road) < 1e-3


def test_a_road_file_may_be_opendrive(tmp_path: Path) -> None:
    *_, path = save(ROADS["arcs"], tmp_path, ["opendrive"], WORLD)
    road, remarks, world, *_ = read_source(path)
    assert isinstance(road, Road)
    assert apart(road, ROADS["arcs"]) < 1e-6
    assert remarks == ()
    assert world == {
        "speed_limit": pytest.approx(50 / 3.6),
        "friction": 0.6,
        "lane_width": 4.0,
        "shoulder": 3.0,
    }


def test_poly3_is_a_height_over_the_chord(tmp_path: Path) -> None:
    line = LINE.replace("<line/>", '<poly3 a="0" b="0" c="0.01" d="-0.0001"/>')
    road = read_opendrive(file(tmp_path, line)).road
    assert road.length == pytest.approx(40, abs=1e-4)

    def slope(u: float) -> float:
        return 0.02 * u - 0.0003 * u * u

    for u in (5.0, 20.0, 30.0):
        s = quad(lambda w: math.hypot(1, slope(w)), 0, u)[0]
        v = 0.01 * u**2 - 0.0001 * u**3
        cos, sin = math.cos(0.5), math.sin(0.5)
        expected = (1 + u * cos - v * sin, 2 + u * sin + v * cos)
        assert road.at(s)[:2] == pytest.approx(expected, abs=1e-4)
        assert float(road.heading(s)) == pytest.approx(0.5 + math.atan(slope(u)), abs=1e-4)


@pytest.mark.parametrize(("range_", "end"), [("normalized", 1.0), ("arcLength", 50.0)])
def test_parametric_cubics_of_either_range(tmp_path: Path, range_: str, end: float) -> None:
    u, v = (0.0, 50.0, -8.0, 4.0), (0.0, 0.0, 20.0, -5.0)

    def at(p: float) -> tuple[float, float]:
        return sum(k * p**i for i, k in enumerate(u)), sum(k * p**i for i, k in enumerate(v))

    def speed(p: float) -> float:
        return math.hypot(*(sum(i * k * p ** (i - 1) for i, k in enumerate(c) if i) for c in (u, v)))

    length = quad(speed, 0, 1)[0]
    told = [
        f'{letter}{axis}="{c[i] / end**i!r}"'
        for axis, c in (("U", u), ("V", v))
        for i, letter in enumerate("abcd")
    ]
    line = (
        f'<geometry s="0" x="0" y="0" hdg="0" length="{length if end == 1 else end}">'
        f'<paramPoly3 {" ".join(told)} pRange="{range_}"/></geometry>'
    )
    road = read_opendrive(file(tmp_path, line)).road
    assert road.length == pytest.approx(length, abs=1e-3)
    for p in (0.1, 0.5, 0.9, 1.0):
        assert road.at(quad(speed, 0, p)[0])[:2] == pytest.approx(at(p), abs=1e-3)


def test_cubic_heights_are_kept_and_steps_are_told_of(tmp_path: Path) -> None:
    heights = (
        '<elevationProfile><elevation s="0" a="3" b="0.02" c="0.001" d="-2e-5"/>'
        '<elevation s="20" a="9" b="0" c="0" d="0"/></elevationProfile>'
    )
    found = read_opendrive(file(tmp_path, rest=heights))
    assert float(found.road.at(10.0)[2]) == pytest.approx(3 + 0.2 + 0.1 - 0.02, abs=1e-9)
    assert float(found.road.at(30.0)[2]) == 9
    assert found.remarks == ("its height jumps (by 5.36 m at s = 20.0)",)
    assert apart(Road.from_json(found.road.to_json()), found.road) == 0


def test_all_lanes_lie_beside_the_line_of_the_file(tmp_path: Path) -> None:
    """A median of 1.5 m widens to 2.5 m; lane 0 lies 0.5 m to the left of the line."""
    right = (
        '<lane id="-1" type="median"><width sOffset="0" a="1.5" b="0.025"/></lane>'
        '<lane id="-2" type="driving"><width sOffset="0" a="3.2"/></lane>'
    )
    arc = '<geometry s="0" x="0" y="0" hdg="0" length="40"><arc curvature="0.02"/></geometry>'
    found = read_opendrive(file(tmp_path, arc, right=right, offset='<laneOffset s="0" a="0.5"/>'))
    assert found.lane_width == 3.2
    assert found.shoulder == 0
    profile, s = found.road.profile, np.linspace(0, 40, 41)
    assert profile is not None
    assert [each.kind for each in profile.lanes.values()] == ["driving", "median", "driving"]
    x, y, _ = found.road.at(s, profile.lane(s).left).T
    assert np.arctan2(x, 50 - y) == pytest.approx(s / 50, abs=1e-9)
    assert np.hypot(x, y - 50) == pytest.approx(50 + 1.0 + 0.025 * s, abs=1e-9)


def test_a_road_with_left_lanes_only_is_taken_the_other_way(tmp_path: Path) -> None:
    heights = '<elevationProfile><elevation s="0" a="3" b="0.02" c="0.001" d="-2e-5"/></elevationProfile>'
    spiral = LINE.replace("<line/>", '<spiral curvStart="0.01" curvEnd="0.03"/>')
    there = read_opendrive(file(tmp_path, spiral, heights)).road
    found = read_opendrive(file(tmp_path, spiral, heights, right=""))
    assert "direction of its left lanes" in found.remarks[0]
    s = np.linspace(0, 40, 99)
    assert found.road.at(s, 1.0) == pytest.approx(there.at(40 - s, -1.0), abs=1e-9)
    assert found.road.grade(s) == pytest.approx(-there.grade(40 - s), abs=1e-12)
    assert found.road.curvature(s[1:-1]) == pytest.approx(-there.curvature(40 - s[1:-1]), abs=1e-12)


def test_what_a_road_cannot_show_is_told_by_name_and_number(tmp_path: Path) -> None:
    rest = (
        '<lateralProfile><superelevation s="0" a="0.05" b="0" c="0" d="0"/>'
        '<shape s="0" t="1" a="0.1" b="0" c="0" d="0"/></lateralProfile>'
        '<objects><object id="1" s="1"/><object id="2" s="2"/><tunnel id="3"/></objects>'
        '<signals><signal id="1" s="3"/><signalReference id="2" s="4"/></signals><railroad/>'
        "<surface><CRG/></surface><link><successor/></link>"
    )
    wide = (
        '<lane id="-1" type="driving"><width sOffset="0" a="3" b="0.025"/></lane>'
        '<lane id="-2" type="driving"><width sOffset="0" a="3"/><height sOffset="0" inner="1"/></lane>'
        '<lane id="-3" type="sidewalk"><width sOffset="0" a="2"/></lane>'
        '<lane id="-4" type="sidewalk"><width sOffset="0" a="2"/></lane>'
    )
    path = file(tmp_path, rest=rest, right=wide, road='junction="7"')
    header = "<geoReference><![CDATA[+proj=utm]]></geoReference><offset x='1' y='2'/>"
    path.write_text(path.read_text().replace('revMinor="4"/>', f'revMinor="4">{header}</header>'))
    assert read_opendrive(path).remarks == (
        "the car keeps to lane 2 from the centre line, the outermost that is 2 m wide everywhere",
        "left out: objects without a type",
        "left out: signs without a type",
        "left out: 1 <height>, 1 <shape>, 1 railway, 1 surface, 1 tunnel, <geoReference> of the map, "
        "<offset> of the map, junction 7",
    )


@pytest.mark.parametrize("right", [RIGHT, ""], ids=["two lanes", "left lane only"])
def test_a_single_road_with_traffic_on_the_left_is_driven_on_the_left(tmp_path: Path, right: str) -> None:
    """The car keeps to the lane on the left of the line, along the line."""
    bent = LINE.replace("<line/>", '<arc curvature="0.02"/>')
    found = read_opendrive(file(tmp_path, bent, road='rule="LHT"', right=right)).road
    there = read_opendrive(file(tmp_path, bent)).road
    assert found.profile is not None
    s = np.linspace(0, 40, 30)
    assert found.at(s, found.profile.middle(s)) == pytest.approx(there.at(s, 1.5), abs=1e-9)


def test_our_own_road_with_traffic_on_the_left_comes_back(tmp_path: Path) -> None:
    left = read_opendrive(file(tmp_path, road='rule="LHT"')).road
    *_, path = save(left, tmp_path / "one", ["opendrive"], WORLD)
    *_, again = save(read_opendrive(path).road, tmp_path / "two", ["opendrive"], WORLD)
    assert again.read_bytes() == path.read_bytes()
    assert 'rule="LHT"' in path.read_text()


@pytest.mark.parametrize("version", ["2.0", "3.1"])
def test_a_later_major_version_is_refused_by_its_number(tmp_path: Path, version: str) -> None:
    path = file(tmp_path)
    major, minor = version.split(".")
    newer = f'revMajor="{major}" revMinor="{minor}"'
    path.write_text(path.read_text().replace('revMajor="1" revMinor="4"', newer))
    for reader in (read_opendrive, read_map):
        with pytest.raises(UsageError, match=f"it is OpenDRIVE {version}; only 1.1 to 1.9 are read"):
            reader(path)


def test_the_permanent_layer_of_a_road_is_read_and_the_temporary_one_is_named(tmp_path: Path) -> None:
    """ASAM OpenDRIVE 1.9, 11.2: each road has one permanent layer, and at most one temporary one over it."""
    there = read_opendrive(file(tmp_path, right=RIGHT))
    path = file(tmp_path, right=RIGHT)
    layer = LANES.format(right=RIGHT.replace('a="3"', 'a="2.6"'), offset="")
    text = path.read_text().replace("<lanes>", '<lanes layer="permanent">')
    for both in (
        text.replace("</lanes>", "</lanes>" + layer.replace("<lanes>", '<lanes layer="temporary">')),
        text.replace(
            '<lanes layer="p', layer.replace("<lanes>", '<lanes layer="temporary">') + '<lanes layer="p'
        ),
    ):
        path.write_text(both)
        found = read_opendrive(path)
        assert found.lane_width == there.lane_width
        assert found.remarks == (*there.remarks, "left out: 1 temporary <lanes>")


def test_lanes_for_both_directions_are_named(tmp_path: Path) -> None:
    found = read_opendrive(file(tmp_path, right=RIGHT.replace("driving", "bidirectional")))
    assert any("lanes for both directions are driven in one only here" in each for each in found.remarks)


SECTIONS = """<OpenDRIVE><road id="1" length="90"><planView>
<geometry s="0" x="0" y="0" hdg="0" length="90"><line/></geometry></planView><lanes>
{}</lanes></road></OpenDRIVE>"""


def section(s: float, right: str, left: str = "driving") -> str:
    width = '<width sOffset="0" a="3"/>'
    return (
        f'<laneSection s="{s}"><left><lane id="1" type="{left}">{width}</lane></left>'
        f'<right><lane id="-1" type="{right}">{width}</lane></right></laneSection>'
    )


def test_the_default_road_is_the_longest_with_a_driving_lane(tmp_path: Path) -> None:
    def road(id_: int, length: float, kind: str, junction: int = -1) -> str:
        return SECTIONS.format(section(0, kind, "none")).replace(
            '<road id="1" length="90">', f'<road id="{id_}" length="{length}" junction="{junction}">'
        )[len("<OpenDRIVE>") : -len("</OpenDRIVE>")]

    path = tmp_path / "choice.xodr"
    roads = [road(1, 900, "rail"), road(2, 90, "driving"), road(3, 95, "driving", 4), road(4, 80, "driving")]
    path.write_text(f"<OpenDRIVE>{''.join(roads)}</OpenDRIVE>")
    found = read_opendrive(path)
    assert found.id == "2"
    assert (
        found.remarks[0] == "road 2 is taken, the longest of 4 with a driving lane; use --road ID for another"
    )
    path.write_text(f"<OpenDRIVE>{roads[0]}{roads[2]}</OpenDRIVE>")
    assert read_opendrive(path).id == "3"
    path.write_text(f"<OpenDRIVE>{roads[0].replace('900', 'nan')}{roads[1]}</OpenDRIVE>")
    assert read_opendrive(path).id == "2"


@pytest.mark.parametrize("path", sorted(DATA.glob("*.xodr")), ids=lambda path: path.stem)
def test_files_of_other_tools_are_read_whole(path: Path) -> None:
    """SUMO's netconvert 1.28 and scenariogeneration 0.16.7 wrote them; every road is described."""
    import re

    ids = re.findall(r'<road [^>]*?\bid="(\d+)"', path.read_text())
    assert ids
    for id_ in ids:
        road = read_opendrive(path, id_).road
        assert describe(road).length
        assert np.isfinite(road.centreline()).all()


@pytest.mark.parametrize(
    ("line", "sentence"),
    rows(__file__, "what_cannot_be_read_is_named"),
)
def test_what_cannot_be_read_is_named(tmp_path: Path, line: str, sentence: str) -> None:
    with pytest.raises(UsageError, match=rf"some\.xodr: road 1: .*{sentence}"):
        read_opendrive(file(tmp_path, line))


def test_a_road_that_nobody_drives_on_is_told_of(tmp_path: Path) -> None:
    path = file(tmp_path)
    path.write_text(path.read_text().replace('"driving"', '"sidewalk"'))
    with pytest.raises(UsageError, match=r"no lane of type driving \(its lanes are: border, sidewalk\)"):
        read_opendrive(path)
