"""Cross-sections of foreign OpenDRIVE files, written by hand, with the answers by hand."""

import math
from pathlib import Path

import pytest

from roadgpt.network import ImportedRoad, read_opendrive
from roadgpt.road import Profile

LENGTH = 90.0
ROAD = """<OpenDRIVE><road id="1" length="90"><planView>
<geometry s="0" x="0" y="0" hdg="0" length="90"><line/></geometry></planView>{rest}<lanes>{lanes}</lanes>
</road></OpenDRIVE>"""
SOLID, BROKEN = '<roadMark sOffset="0" type="solid"/>', '<roadMark sOffset="0" type="broken"/>'


def lane(id_: int, width: str | float, kind: str = "driving", mark: str = "", before: int = 0) -> str:
    """A lane; ``width`` is a number, or the attributes of several elements."""
    rows = [f'sOffset="0" a="{width}"'] if isinstance(width, float | int) else width.split(";")
    widths = "".join(f"<width {row}/>" for row in rows)
    link = f'<link><predecessor id="{before}"/></link>' if before else ""
    return f'<lane id="{id_}" type="{kind}">{link}{widths}{mark}</lane>'


def section(*lanes: str, s: float = 0.0, centre: str = BROKEN) -> str:
    left = "".join(each for each in lanes if 'id="-' not in each)
    right = "".join(each for each in lanes if 'id="-' in each)
    middle = f'<center><lane id="0" type="none">{centre}</lane></center>'
    sides = (f"<left>{left}</left>" if left else "") + middle + (f"<right>{right}</right>" if right else "")
    return f'<laneSection s="{s}">{sides}</laneSection>'


def read(folder: Path, *sections: str, rest: str = "") -> tuple[ImportedRoad, Profile]:
    path = folder / "road.xodr"
    path.write_text(ROAD.format(rest=rest, lanes="".join(sections)))
    found = read_opendrive(path)
    assert found.road.profile is not None
    return found, found.road.profile


def test_all_lanes_with_their_widths_and_marks(tmp_path: Path) -> None:
    found, profile = read(
        tmp_path,
        section(
            lane(1, 3.5, mark=SOLID),
            lane(-1, 3.0, mark=BROKEN),
            lane(-2, 'sOffset="0" a="3" b="0.01";sOffset="50" a="3.5"', mark=SOLID),
            lane(-3, 2.0, "shoulder"),
            centre=SOLID,
        ),
    )
    assert profile.count == (2, 1)
    assert profile.driven == 1
    assert [each.marking for each in profile.right] == ["broken", "solid", "none"]
    assert profile.centre_marking == "solid"
    for s, width in ((0.0, 3.0), (25.0, 3.25), (50.0, 3.5), (89.0, 3.5)):
        assert profile.lane(s).right == pytest.approx(-3.0 - width)
        assert profile.rims(s).right == pytest.approx(-5.0 - width)
    assert found.lane_width == 3.45  # half of the road is narrower
    assert found.remarks == (
        "the car keeps to lane 2 from the centre line, the outermost that is 2 m wide everywhere",
    )


def test_borders_are_edges(tmp_path: Path) -> None:
    borders = (
        '<lane id="-1" type="driving"><border sOffset="0" a="-3" b="-0.01"/></lane>'
        '<lane id="-2" type="shoulder"><border sOffset="0" a="-4.5"/></lane>'
    )
    _, profile = read(tmp_path, section(lane(1, 3), borders))
    for s in (0.0, 40.0, 90.0):
        assert profile.edges(s).right == pytest.approx(-3 - 0.01 * s)
        assert profile.rims(s).right == pytest.approx(-4.5)


def test_a_lane_added_between_two_others_leaves_them_where_they_are(tmp_path: Path) -> None:
    """From s = 40 on, a lane grows between lane -1 and the outer lane, which becomes lane -3."""
    first = section(lane(1, 3), lane(-1, 3), lane(-2, 3.5))
    grows = 'sOffset="0" a="0" b="0.1";sOffset="30" a="3"'
    second = section(
        lane(1, 3, before=1), lane(-1, 3, before=-1), lane(-2, grows), lane(-3, 3.5, before=-2), s=40.0
    )
    _, profile = read(tmp_path, first, second)
    assert profile.count == (3, 1)
    assert profile.driven == 2
    for s, between in ((0.0, 0.0), (39.9, 0.0), (50.0, 1.0), (80.0, 3.0)):
        assert profile.width(s) == pytest.approx(3.5)
        assert profile.middle(s) == pytest.approx(-3 - between - 1.75)


def test_lanes_behind_a_median_are_oncoming_lanes(tmp_path: Path) -> None:
    found, profile = read(tmp_path, section(lane(1, 1.0, "median"), lane(2, 3), lane(-1, 3), lane(-2, 3)))
    assert profile.count == (2, 1)
    assert [each.kind for each in profile.left] == ["median", "driving"]
    assert profile.edges(10.0).left == pytest.approx(4.0)
    assert not any("left out" in remark for remark in found.remarks)


def test_superelevation_turns_the_surface_about_the_reference_line(tmp_path: Path) -> None:
    """The lanes begin 5 m to the right of the line about which the surface is turned by 0.1 rad."""
    bank = '<lateralProfile><superelevation s="0" a="0.1" b="0" c="0" d="0"/></lateralProfile>'
    found, profile = read(tmp_path, section(lane(-1, 5, "median"), lane(-2, 3)), rest=bank)
    assert profile.lane(9.0).left == pytest.approx(-5.0)
    for s, t in ((0.0, 0.0), (30.0, -8.0), (85.0, -6.5)):
        wanted = (s, t * math.cos(0.1), t * math.sin(0.1))
        assert found.road.at(s, t) == pytest.approx(wanted, abs=1e-6)
    assert profile.superelevation(20.0) == pytest.approx(0.1)


def test_superelevation_of_a_road_that_is_turned_round(tmp_path: Path) -> None:
    """Only left lanes: the road runs the other way, and what fell to its right falls to its left."""
    bank = '<lateralProfile><superelevation s="0" a="0" b="0.001" c="0" d="0"/></lateralProfile>'
    width = 'sOffset="0" a="3" b="0.01"'
    found, profile = read(tmp_path, section(lane(1, width), lane(2, 1.0, "shoulder")), rest=bank)
    for s in (0.0, 30.0, 90.0):
        there = 90.0 - s  # the station in the file
        angle, t = 0.001 * there, 3 + 0.01 * there
        wanted = (there, t * math.cos(angle), t * math.sin(angle))
        assert found.road.at(s, profile.edges(s).right) == pytest.approx(wanted, abs=1e-6)


def test_the_longest_road_mark_is_taken(tmp_path: Path) -> None:
    marks = '<roadMark sOffset="0" type="broken"/><roadMark sOffset="20" type="solid solid"/>'
    found, profile = read(tmp_path, section(lane(1, 3, mark=SOLID), lane(-1, 3), centre=marks))
    assert profile.centre_marking == "double"
    assert found.remarks == ("its road marks change along the road, and the most frequent ones are painted",)
