"""Odd OpenDRIVE files, one oddity each: what is in them is read rightly, or its name and place are told.

The order of records does not matter, what a road has only one of is chosen in a sentence, and values beyond a
limit come back as the limit. The expected values are those of the standard, computed here from the numbers in
the file.
"""

import math
import random
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.errors import UsageError
from roadgpt.network import ImportedRoad, read_opendrive
from roadgpt.road import Profile, World
from roadgpt_formats.opendrive.roads import UNREAD
from roadgpt_formats.opendrive.tree import COUNTED, DRIVING, READ, SILENT

LENGTH = 200.0
LINE = '<geometry s="0" x="0" y="0" hdg="0" length="200"><line/></geometry>'
WIDTH = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>'
MARK = '<roadMark sOffset="0" type="solid" width="0.12"/>'


def lane(number: int, inside: str = WIDTH + MARK, kind: str = "driving", more: str = "") -> str:
    return f'<lane id="{number}" type="{kind}" {more}>{inside}</lane>'


def section(s: float = 0, right: str | None = None, left: str = "", more: str = "") -> str:
    sides = {"left": left, "right": lane(-1) if right is None else right}
    inside = "".join(f"<{side}>{lanes}</{side}>" for side, lanes in sides.items() if lanes)
    centre = f'<center><lane id="0" type="none">{MARK}</lane></center>'
    return f'<laneSection s="{s!r}" {more}>{centre}{inside}</laneSection>'


def read(
    folder: Path, lanes: str | None = None, line: str = LINE, rest: str = "", road: str = ""
) -> ImportedRoad:
    path = folder / "odd.xodr"
    path.write_text(
        f'<OpenDRIVE><header revMajor="1" revMinor="8"/><road id="1" {road}><planView>{line}</planView>{rest}'
        f"<lanes>{lanes or section()}</lanes></road></OpenDRIVE>"
    )
    return read_opendrive(path)


def own(found: ImportedRoad) -> Profile:
    return World().changed(**found.world_values).profile_of(found.road)


def rows(tag: str, station: str, records: list[tuple[float, ...]]) -> str:
    """Records of cubics: station, a, b, c, d."""
    return "".join(
        f'<{tag} {station}="{s!r}" a="{a!r}" b="{b!r}" c="{c!r}" d="{d!r}"/>' for s, a, b, c, d in records
    )


def told(found: ImportedRoad, *words: str) -> bool:
    """Whether one remark has all these words."""
    return any(all(word in remark for word in words) for remark in found.remarks)


PIECES = [(0.0, 40.0, 0.0), (40.0, 60.0, 0.01), (100.0, 55.0, -0.008), (155.0, 45.0, 0.0)]


def geometries() -> list[str]:
    """A line, an arc, an arc and a line that meet, from elementary geometry."""
    x, y, heading, out = 3.0, -4.0, 0.3, []
    for s, length, bend in PIECES:
        shape = f'<arc curvature="{bend!r}"/>' if bend else "<line/>"
        out.append(
            f'<geometry s="{s!r}" x="{x!r}" y="{y!r}" hdg="{heading!r}" length="{length!r}">'
            f"{shape}</geometry>"
        )
        if bend:
            x += (math.sin(heading + bend * length) - math.sin(heading)) / bend
            y -= (math.cos(heading + bend * length) - math.cos(heading)) / bend
        else:
            x, y = x + length * math.cos(heading), y + length * math.sin(heading)
        heading += bend * length
    return out


HEIGHTS = [(0.0, 1.0, 0.02, 0.0, 0.0), (50.0, 2.0, 0.02, 0.0002, 0.0), (120.0, 4.38, 0.048, 0.0, 0.0)]
BANKS = [(0.0, 0.0, 0.001, 0.0, 0.0), (30.0, 0.03, 0.0, 0.0, 0.0), (150.0, 0.03, -0.0006, 0.0, 0.0)]
WIDTHS = [(0.0, 3.0, 0.01, 0.0, 0.0), (50.0, 3.5, 0.0, 0.0, 0.0), (150.0, 3.5, -0.01, 0.0, 0.0)]
OFFSETS = [(0.0, 0.0, 0.0, 0.0, 0.0), (60.0, 0.0, 0.01, 0.0, 0.0), (90.0, 0.3, 0.0, 0.0, 0.0)]


def whole(order: Callable[[list[str]], list[str]], folder: Path) -> ImportedRoad:
    """A road with every kind of record, in this order."""

    def records(tag: str, station: str, table: list[tuple[float, ...]]) -> str:
        return "".join(order([rows(tag, station, [row]) for row in table]))

    def plain(tag: str, records: list[str]) -> str:
        return "".join(order([f"<{tag} {each}/>" for each in records]))

    marks = plain(
        "roadMark", ['sOffset="0" type="solid"', 'sOffset="30" type="broken"', 'sOffset="190" type="none"']
    )
    stone = plain(
        "material",
        ['sOffset="0" friction="0.9"', 'sOffset="20" friction="0.5"', 'sOffset="180" friction="0.7"'],
    )
    speeds = plain("speed", ['sOffset="0" max="10"', 'sOffset="20" max="20"', 'sOffset="180" max="30"'])
    first = lane(-1, records("width", "sOffset", WIDTHS) + marks + stone + speeds)
    return read(
        folder,
        "".join(order([*(rows("laneOffset", "s", [row]) for row in OFFSETS)]))
        + "".join(order([section(0.0, first, lane(1)), section(199.0, lane(-1), lane(1))])),
        "".join(order(geometries())),
        f"<elevationProfile>{records('elevation', 's', HEIGHTS)}</elevationProfile>"
        f"<lateralProfile>{records('superelevation', 's', BANKS)}</lateralProfile>"
        + "".join(order(['<type s="0" type="rural"/>', '<type s="100" type="town"/>'])),
    )


@given(st.integers(0, 10**6))
@settings(max_examples=15, deadline=None)
def test_the_order_of_records_changes_nothing(tmp_path_factory: pytest.TempPathFactory, seed: int) -> None:
    folder, rng = tmp_path_factory.mktemp("order"), random.Random(seed)
    sorted_, mixed = whole(list, folder), whole(lambda each: rng.sample(each, len(each)), folder)
    assert mixed.road.to_json() == sorted_.road.to_json()
    assert (mixed.speed_limit, mixed.friction) == (sorted_.speed_limit, sorted_.friction) == (20.0, 0.5)
    assert not told(sorted_, "sorted")
    assert {*sorted_.remarks} <= {*mixed.remarks}


def at_each_metre(table: list[tuple[float, ...]], s: np.ndarray) -> np.ndarray:
    """The piecewise cubic of records in any order; of several at one station, the last holds."""
    out = np.empty_like(s)
    kept = {row[0]: row for row in table}
    for n, each in enumerate(s):
        start, a, b, c, d = kept[max(at for at in kept if at <= each)]
        u = each - start
        out[n] = a + b * u + c * u**2 + d * u**3
    return out


S = np.linspace(0.5, 199.5, 200)
SHUFFLED = [WIDTHS[2], WIDTHS[0], WIDTHS[1]]
TWICE = [WIDTHS[0], (50.0, 9.9, 0.0, 0.0, 0.0), *WIDTHS[1:]]


@pytest.mark.parametrize("table", [WIDTHS, SHUFFLED, TWICE])
def test_widths_are_those_of_the_standard(tmp_path: Path, table: list[tuple[float, ...]]) -> None:
    found = read(tmp_path, section(0.0, lane(-1, rows("width", "sOffset", table) + MARK)))
    assert own(found).width(S) == pytest.approx(at_each_metre(table, S), abs=1e-9)
    assert told(found, "<width>", "lane -1", "sorted") == (table is SHUFFLED)
    assert told(found, "several <width>", "s = 50 m of lane -1", "last one") == (table is TWICE)


@pytest.mark.parametrize("table", [HEIGHTS, HEIGHTS[::-1]])
def test_heights_are_those_of_the_standard(tmp_path: Path, table: list[tuple[float, ...]]) -> None:
    rest = f"<elevationProfile>{rows('elevation', 's', table)}</elevationProfile>"
    found = read(tmp_path, rest=rest)
    assert found.road.elevation.height(S) == pytest.approx(at_each_metre(table, S), abs=1e-9)
    assert told(found, "<elevation>", "sorted") == (table is not HEIGHTS)


@pytest.mark.parametrize("table", [BANKS, BANKS[::-1]])
def test_superelevation_is_that_of_the_standard(tmp_path: Path, table: list[tuple[float, ...]]) -> None:
    rest = f"<lateralProfile>{rows('superelevation', 's', table)}</lateralProfile>"
    found = read(tmp_path, rest=rest)
    assert own(found).superelevation(S) == pytest.approx(at_each_metre(table, S), abs=1e-9)


@pytest.mark.parametrize("begins", [-5.0, 5.0, 0.05])
def test_a_line_that_does_not_begin_at_0_keeps_its_stations(tmp_path: Path, begins: float) -> None:
    """A step of the height and of the width 60 m behind the station at which the line begins."""
    heights = rows("elevation", "s", [(begins, 1.0, 0.0, 0.0, 0.0), (begins + 60, 1.0, 0.05, 0.0, 0.0)])
    widths = rows("width", "sOffset", [(0.0, 3.0, 0.0, 0.0, 0.0), (60.0, 4.0, 0.0, 0.0, 0.0)])
    found = read(
        tmp_path, section(begins, lane(-1, widths + MARK)), LINE.replace('s="0"', f's="{begins}"'),
        f"<elevationProfile>{heights}</elevationProfile>",
    )  # fmt: skip
    assert found.road.length == pytest.approx(200)
    assert found.road.elevation.height(np.array([59.0, 60.0, 70.0])) == pytest.approx([1, 1, 1.5], abs=1e-3)
    assert own(found).width(np.array([59.9, 60.1])) == pytest.approx([3, 4])


FRICTION = [
    # records, friction that is taken, words that are told
    ([(0, 1.0), (100, 0.2)], 1.0, ["lane -1 from 1 to 0.2 at s = 100 m", "; 1 is taken"]),
    ([(0, 1.0), (90, 0.2)], 0.2, ["from 1 to 0.2 at s = 90 m", "; 0.2 is taken"]),
    ([(90, 0.2), (0, 1.0)], 0.2, ["from 1 to 0.2 at s = 90 m"]),
    ([(120, 0.2)], 0.2, ["from none to 0.2 at s = 120 m"]),
    ([(0, 1.0), (0, 0.3)], 0.3, ["several <material>", "s = 0 m"]),
    ([(0, 3.5)], 2.0, ["its friction of 3.5 is taken as 2"]),
    ([(0, 0.8), (150, 3.5)], 0.8, ["to 3.5 at s = 150 m"]),
    ([(0, 0)], None, ["a friction of 0 is not used"]),
    ([(0, -0.5), (50, 0.4)], 0.4, ["a friction of -0.5 is not used", "from none to 0.4"]),
    ([(0, 0.01)], 0.01, []),
    ([(0, 2.0)], 2.0, []),
    ([(0, 0.4), (250, 0.9)], 0.4, ["<material> begins beyond the end", "s = 250 m"]),
    ([(0, 0.4), (50, 0.4)], 0.4, []),
    ([(20 * n, 0.1 + 0.1 * n) for n in range(9)], 0.9, ["and so on (8 changes)"]),
]  # fmt: skip


@pytest.mark.parametrize(("records", "taken", "words"), FRICTION)
def test_one_friction_is_taken_and_the_others_are_told(
    tmp_path: Path, records: list[tuple[float, float]], taken: float | None, words: list[str]
) -> None:
    stone = "".join(f'<material sOffset="{s}" friction="{value}"/>' for s, value in records)
    found = read(tmp_path, section(0.0, lane(-1, WIDTH + MARK + stone)))
    assert found.friction == (None if taken is None else pytest.approx(taken))
    assert all(told(found, word) for word in words), found.remarks
    assert words or not found.remarks


SPEEDS = [
    ([(0, "50", "km/h")], 50, []),
    ([(0, "50", "km/h"), (150, "30", "km/h")], 50, ["from 50 km/h to 30 km/h at s = 150 m"]),
    ([(150, "30", "km/h"), (0, "50", "km/h")], 50, ["from 50 km/h to 30 km/h at s = 150 m"]),
    ([(0, "500", "km/h")], 300, ["speed limit of 500 km/h is taken as 300 km/h"]),
    ([(0, "2", "km/h")], 5, ["speed limit of 2 km/h is taken as 5 km/h"]),
    ([(0, "300", "km/h")], 300, []),
    ([(0, "no limit", "km/h")], None, ["a speed limit of 0, or of no limit, is not used"]),
    ([(0, "0", "km/h")], None, ["a speed limit of 0, or of no limit, is not used"]),
    ([(0, "20", "knots")], 72, ["a speed limit is in 'knots', and is taken as one in m/s"]),
    ([(0, "no limit", "km/h"), (100, "80", "km/h")], 80, ["from none to 80 km/h at s = 100 m"]),
]


@pytest.mark.parametrize(("records", "taken", "words"), SPEEDS)
@pytest.mark.parametrize("of_lane", [True, False])
def test_one_speed_limit_is_taken_and_the_others_are_told(
    tmp_path: Path,
    records: list[tuple[float, str, str]],
    taken: float | None,
    words: list[str],
    of_lane: bool,
) -> None:
    if of_lane:
        speeds = "".join(f'<speed sOffset="{s}" max="{most}" unit="{unit}"/>' for s, most, unit in records)
        found = read(tmp_path, section(0.0, lane(-1, WIDTH + MARK + speeds)))
    else:
        types = (f'<type s="{s}"><speed max="{most}" unit="{unit}"/></type>' for s, most, unit in records)
        found = read(tmp_path, rest="".join(types))
    assert found.speed_limit == (None if taken is None else pytest.approx(taken / 3.6))
    assert all(told(found, word) for word in words), found.remarks
    assert words or not found.remarks


def test_a_lane_s_own_speed_limit_goes_before_that_of_the_road(tmp_path: Path) -> None:
    own_limit = '<speed sOffset="120" max="30" unit="km/h"/>'
    rest = '<type s="0" type="rural"><speed max="90" unit="km/h"/></type>'
    found = read(tmp_path, section(0.0, lane(-1, WIDTH + MARK + own_limit)), rest=rest)
    assert found.speed_limit == pytest.approx(90 / 3.6)
    assert told(found, "from 90 km/h to 30 km/h at s = 120 m")


@pytest.mark.parametrize("kind", ["driving", "shoulder"])
def test_a_friction_of_further_lanes_alone_is_theirs(tmp_path: Path, kind: str) -> None:
    ice = lane(-2, WIDTH + MARK + '<material sOffset="0" friction="0.3"/>', kind)
    ice = ice if kind == "shoulder" else ice.replace('"-2"', '"1"')
    found = read(tmp_path, section(0.0, lane(-1) + ice) if kind == "shoulder" else section(0.0, None, ice))
    assert found.friction is None
    if kind == "driving":
        assert own(found).lanes[1].friction == 0.3
    else:
        assert told(found, "left out: speed limits and frictions of lanes that are not for cars")


TOLD = {
    "late height": ("", '<elevationProfile><elevation s="50" a="3"/></elevationProfile>',
        "first <elevation> begins late"),
    "height beyond": (
        "", '<elevationProfile><elevation s="0" a="3"/><elevation s="300" a="9"/></elevationProfile>',
        "<elevation> begins beyond the end",
    ),
    "crossfall": ("", '<lateralProfile><crossfall s="0" a="0" b="0.001"/></lateralProfile>', "1 <crossfall>"),
    "shape": ("", '<lateralProfile><shape s="0" t="-3" a="0" b="0.02"/></lateralProfile>', "1 <shape>"),
    "surface": (
        "", "<lateralProfile><crossSectionSurface><surfaceStrips/></crossSectionSurface></lateralProfile>",
        "1 <crossSectionSurface>",
    ),
    "access": (lane(-1, WIDTH + MARK + '<access sOffset="0" rule="deny" restriction="truck"/>'), "",
        "1 <access>"),
    "rule": (lane(-1, WIDTH + MARK + '<rule sOffset="0" value="no stopping"/>'), "", "1 <rule>"),
    "height": (lane(-1, WIDTH + MARK + '<height sOffset="0" inner="0.1" outer="0.1"/>'), "",
        "1 <height>"),
    "rough": (
        lane(-1, WIDTH + MARK + '<material sOffset="0" friction="1" roughness="0.4"/>'), "",
        "the attribute roughness",
    ),
    "direction": (lane(-1, more='direction="reversed"'), "", "the attribute direction"),
    "one side": (
        lane(-1) + "</right></laneSection><laneSection s='9' singleSide='true'><right>" + lane(-1), "",
        "the attribute singleSide",
    ),
    "unknown": ("", "<weather><rain/></weather>", "left out: 1 <weather>"),
    "include": ("", '<include file="more.xml"/>', "1 included file"),
    "kerb": (lane(-1, WIDTH + '<roadMark sOffset="0" type="curb"/>'), "",
        "what road marks of type curb look like"),
    "dots": (lane(-1, WIDTH + '<roadMark sOffset="0" type="botts dots"/>'), "",
        "what road marks of type botts dots look like"),
    "yellow": (lane(-1, WIDTH + '<roadMark sOffset="0" type="solid" color="yellow"/>'), "",
        "the attribute color"),
    "broad": (lane(-1, WIDTH + '<roadMark sOffset="0" type="solid" width="0.3"/>'), "",
        "the width of broad road marks"),
    "late mark": (
        lane(-1, WIDTH + '<roadMark sOffset="300" type="solid"/>'), "", "<roadMark> begins beyond the end",
    ),
    "late width": (lane(-1, rows("width", "sOffset", [(9.0, 3.5, 0, 0, 0)]) + MARK), "",
        "first <width> begins late"),
    "negative": (
        lane(-1) + lane(-2, rows("width", "sOffset", [(0.0, 1.0, -0.01, 0, 0)]) + MARK), "",
        "the width of a lane is limited (lane -2: -1 m at s = 200 m, outside 0 to 100 m)",
    ),
    "twice": (lane(-1) + lane(-1), "", "several lanes of a section have the same id"),
}  # fmt: skip


@pytest.mark.parametrize(
    "rest",
    [
        '<lateralProfile><crossfall side="both" s="0" a="0.0" b="-0.0e+00" c="0" d="0"/></lateralProfile>',
        "<objects><objectReference/></objects><link><successor/></link><userData code='1'/>",
        '<elevationProfile><elevation s="0" a="0"/></elevationProfile><elevationProfile/>',
    ],
)
def test_what_says_nothing_needs_no_remark(tmp_path: Path, rest: str) -> None:
    assert read(tmp_path, rest=rest).remarks == ()


@pytest.mark.parametrize("name", TOLD)
def test_what_is_left_out_or_changed_is_told(tmp_path: Path, name: str) -> None:
    right, rest, words = TOLD[name]
    found = read(tmp_path, section(0.0, right or lane(-1)), rest=rest)
    assert told(found, words), found.remarks


@pytest.mark.parametrize(("length", "is_told"), [("200", False), ("199.95", False), ("150", True)])
def test_a_length_that_is_not_that_of_the_line_is_told(tmp_path: Path, length: str, is_told: bool) -> None:
    found = read(tmp_path, road=f'length="{length}"')
    assert found.road.length == 200
    assert told(found, "its length is not that of its line", length) == is_told


@pytest.mark.parametrize(
    ("lanes", "sentence"),
    [
        (section(0.0, lane(-1, '<width sOffset="NaN" a="3"/>')), "in a <width>, sOffset is 'NaN'"),
        (section(0.0, lane(-1, '<width sOffset="0" a="wide"/>')), "in a <width>, a is 'wide'"),
        (section(0.0, lane(-1, WIDTH + '<material sOffset="0" friction="inf"/>')), "friction is 'inf'"),
        (section(0.0, lane(-1, WIDTH + '<speed sOffset="0" max="fast"/>')), "max is 'fast'"),
        (section(0.0, lane(-1, WIDTH + '<speed sOffset="x" max="9"/>')), "sOffset is 'x'"),
        (section(0.0, lane(-1, WIDTH + '<roadMark sOffset="x" type="solid"/>')), "sOffset is 'x'"),
        (section(0.0, lane(-1, kind="sidewalk")), r"no lane of type driving \(its lanes are: sidewalk\)"),
    ],
)
def test_what_is_no_number_is_refused_by_name(tmp_path: Path, lanes: str, sentence: str) -> None:
    with pytest.raises(UsageError, match=sentence):
        read(tmp_path, lanes)


def test_the_documents_name_every_element_that_is_read_or_passed_over() -> None:
    page = Path(__file__).parents[3] / "docs/reference/export-formats.md"
    names = {*READ, *SILENT, *COUNTED, *UNREAD, *DRIVING}
    assert {name for name in names if f"`{name}`" not in page.read_text()} == set()
