"""Pages: one file that needs nothing else, the same tables in every form, charts that are to scale."""

import base64
import csv
import io
import re
import xml.etree.ElementTree as ET
from html.parser import HTMLParser
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.image import imread
from numpy.typing import NDArray

from roadgpt.campaign.columns import bounds_of_columns
from roadgpt.cli.screen import COLOURS
from roadgpt.errors import RoadGPTError
from roadgpt.report.canvas import OUTCOMES, VERMILLION
from roadgpt.report.chapters.roads import MAPS, feature_map
from roadgpt.report.overview import Thumbnail
from roadgpt.report.page import STYLE, csv_of, html_of, latex_of, write
from roadgpt.report.page.charts import AxisRange, Share, bars, forest, heat, is_map, lines, palette
from roadgpt.report.page.maps import close_up, gallery
from roadgpt.report.page.model import (
    Cards,
    Details,
    Figure,
    FigureCard,
    Page,
    Section,
    ShellCommand,
    Table,
    cell,
    linked,
)
from roadgpt.report.plan_view import ASPHALT, PAINT
from roadgpt.road import CrossSection, Road, World
from roadgpt.run import Outcome, Setup, prove

NASTY = "<script>alert(1)</script> & \"100 %\" | $x_1$ \\ {y} 'z'"
TABLE = Table(
    "counts",
    NASTY,
    ["what", "n"],
    [[cell(NASTY, href="a b/c.png"), cell(3)], [cell(None), cell(0.25, "25 %")]],
    "a note",
    has_total=True,
)


def page(*blocks: object) -> Page:
    return Page(NASTY, [NASTY, ["see ", linked("it", "x.png")]], [Section(NASTY, blocks)], {"command": NASTY})  # type: ignore[arg-type]


class PageParser(HTMLParser):
    """Text and tags of a page; complains where tags do not close."""

    EMPTY = ("meta", "br", "rect", "line", "circle", "path", "polyline")

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[str] = []
        self.text = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag not in self.EMPTY:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def test_nothing_in_the_words_becomes_markup() -> None:
    reader = PageParser()
    reader.feed(html_of(page(NASTY, TABLE, Details(NASTY, [TABLE, NASTY]))))
    assert reader.open == []
    assert "script" not in reader.tags
    assert reader.text.count(NASTY) >= 6


@pytest.mark.parametrize("start", ["=", "+", "-", "@", "\t"])
def test_words_are_no_formulas_in_a_spreadsheet(start: str) -> None:
    told = Table("t", "", ["a", "b"], [[cell(f"{start}cmd|' /C calc'!A0"), cell(-0.25)]])
    rows = list(csv.reader(io.StringIO(csv_of(told), newline="")))
    assert rows[1] == [f"'{start}cmd|' /C calc'!A0", "-0.25"]


def test_a_page_asks_for_nothing() -> None:
    text = html_of(page(TABLE, Figure("f", "c", gallery([], 250, "none"))))
    assert "default-src 'none'" in text
    assert not re.search(r"\b(src|href)=\"(https?:)?//", text)
    assert "@import" not in text
    assert "url(" not in text


def test_every_form_of_a_table_has_its_numbers() -> None:
    rows = list(csv.reader(io.StringIO(csv_of(TABLE))))
    assert rows == [["what", "n"], [NASTY, "3"], ["", "0.25"]]
    latex = latex_of(TABLE)
    assert r"100 \%" in latex
    assert r"\$x\_1\$ \textbackslash{} \{y\}" in latex
    assert latex.count(r"\\") == 3
    assert latex.index(r"\midrule", latex.index("3 ")) < latex.index(r"25 \%")


def test_writing_puts_all_of_it_into_a_folder(tmp_path: Path) -> None:
    told = page(TABLE, Details("more", [Table("inside", "x", ["a"], [[cell(1)]])]))
    assert write(told, tmp_path / "new") == tmp_path / "new" / "report.html"
    assert {path.name for path in (tmp_path / "new" / "tables").iterdir()} == {
        "counts.csv",
        "counts.tex",
        "inside.csv",
        "inside.tex",
    }
    (tmp_path / "file").write_text("")
    with pytest.raises(RoadGPTError, match="name another folder"):
        write(told, tmp_path / "file")


def parsed(svg: str) -> ET.Element:
    return ET.fromstring(svg)


def all_of(svg: str, tag: str) -> list[ET.Element]:
    return parsed(svg).findall(f".//{{http://www.w3.org/2000/svg}}{tag}")


HREF = "{http://www.w3.org/1999/xlink}href"


def styled(svg: str, tag: str, colour: str) -> list[ET.Element]:
    """Elements of a colour of the page."""
    return [each for each in all_of(svg, tag) if f"var(--{colour})" in each.get("style", "")]


def corners(path: ET.Element) -> np.ndarray:
    """The points of a path, px."""
    return np.array(re.findall(r"[ML] (-?[\d.]+) (-?[\d.]+)", path.get("d", "")), float)


def opacities(svg: str, number: int = 0) -> np.ndarray:
    """Of the pixels of the first picture in a chart, row by row from its top; 0 is empty, 1 full."""
    picture = all_of(svg, "image")[number]
    _, _, data = picture.get(HREF, "").partition(",")
    shades = imread(io.BytesIO(base64.b64decode(data)), format="png")[..., 3]
    upright = float(picture.get("transform", "").split()[3]) > 0
    return np.asarray(shades if upright else shades[::-1], float)


def test_every_colour_of_a_chart_is_one_of_the_page_in_light_and_in_dark() -> None:
    svg = lines([("a", [0, 1], [0, 1]), ("b", [0, 2], [0, 2])], "x", "y", "label")
    assert not re.search("#[0-9a-f]{6}", svg)
    assert {"ink", "soft", "line", "s0", "s1"} <= set(re.findall(r"var\(--(\w+)\)", svg))
    text = STYLE.read_text(encoding="utf-8")
    light, dark = (dict(re.findall(r"--(\w+): (#\w{6});", part)) for part in text.split("}")[:2])
    assert palette() == light
    for one in light:  # a chart's variable is found by its light colour alone
        for other in light:
            assert light[one] != light[other] or dark[one] == dark[other], (one, other)


def test_charts_have_the_letters_of_the_page_and_harm_nothing_beside_them() -> None:
    svg = bars([0, 1, 2], [1, 4], "x & y", "n", 'say "label"')
    assert svg == bars([0, 1, 2], [1, 4], "x & y", "n", 'say "label"')
    assert parsed(svg).get("aria-label") == 'say "label"'
    assert "x & y" in [text.text for text in all_of(svg, "text")]
    assert "font-family" not in svg
    assert "<style" not in svg
    assert "<metadata" not in svg
    other = bars([0, 1, 2], [1, 4], "x & y", "n", "another")
    named = [set(re.findall(r' id="([^"]*)"', each)) for each in (svg, other)]
    assert not named[0] & named[1], "two charts of one page share no names"


def test_what_is_counted_has_whole_numbers_at_its_axes() -> None:
    svgs = [
        heat(np.ones((3, 3)), AxisRange("road", 0.5, 3.5, True), AxisRange("road", 0.5, 3.5, True), "n", "l"),
        lines([("a", [0, 1, 2], [0, 0, 1])], "tests", "failures", "label"),
        bars([0, 10, 20, 30], [1, 0, 2], "x", "tests", "label"),
    ]
    for svg, least in zip(svgs, ({"1", "2", "3"}, {"0", "1", "2"}, {"0", "1", "2"}), strict=True):
        shown = [text.text or "" for text in styled(svg, "text", "soft")]
        assert least <= set(shown)
        assert [number for number in shown if "." in number] == []


def test_shares_lie_where_they_should() -> None:
    svg = forest([("a", [Share(0, 0.0, 0.0, 0.1, "0"), Share(1, 1.0, 0.9, 1.0, "1")])], ["x", "y"], "label")
    dots = [each for hue in ("s0", "s1") for each in styled(svg, "use", hue)]
    grid = [corners(path) for path in styled(svg, "path", "line")]
    first, second = (float(dot.get("x", "nan")) for dot in dots)
    assert (first, second) == (min(line[0, 0] for line in grid), max(line[0, 0] for line in grid))
    (interval,) = [line for path in styled(svg, "path", "s0") if len(line := corners(path)) == 2]
    assert np.ptp(interval[:, 0]) == pytest.approx(0.1 * (second - first))
    assert parsed(svg).get("aria-label") == "label"


def test_heat_fills_each_cell_with_its_shade() -> None:
    values = np.array([[np.nan, 1.0, 2.0], [4.0, 0.0, 4.0]])
    shades = np.array([[1.0, 0.0, 1.0], [0.0, 0.1 + 0.9 / 4, 0.1 + 0.9 / 2]])  # row 1 is on top
    x, y = AxisRange("x", 0, 3), AxisRange("y", 0, 2)
    assert opacities(heat(values, x, y, "n", "label")) == pytest.approx(shades, abs=0.01)
    down = heat(values, x, y, "n", "label", downwards=True)
    assert opacities(down) == pytest.approx(shades[::-1], abs=0.01)
    bar = opacities(down, 1)[:, 0]
    assert (bar[0], bar[-1]) == pytest.approx((1.0, 0.1), abs=0.01), "strong is high"
    assert {"0", "4"} <= {text.text for text in styled(down, "text", "soft")}
    assert not opacities(heat(np.full((2, 2), np.nan), x, y, "n", "l")).any()


def test_bars_are_as_high_as_their_counts() -> None:
    svg = bars([0, 1, 2, 3], [1, 0, 4], "x", "n", "label", mark=1.5)
    high = [np.ptp(corners(bar)[:, 1]) for bar in styled(svg, "path", "s0")]
    assert high[1] == pytest.approx(4 * high[0], rel=0.01)
    assert len(high) == 2
    (mark,) = [each for each in styled(svg, "path", "soft") if "dasharray" in each.get("style", "")]
    axis = [corners(each) for each in styled(svg, "path", "soft") if np.ptp(corners(each)[:, 0]) > 100]
    assert corners(mark)[0, 0] == pytest.approx(axis[0][:, 0].mean()), "halfway from 0 to 3"


def test_every_outcome_has_its_colour_on_pages_in_pictures_and_on_terminals() -> None:
    roads = [
        Thumbnail(n, each, np.array([[0.0, 0.0], [9.0, 9.0]])) for n, each in enumerate(get_args(Outcome))
    ]
    svg = gallery(roads, 250.0, "label")
    used, defined = (
        set(re.findall(pattern, text))
        for pattern, text in ((r"var\((--[^)]*)\)", svg), (r"(--[\w-]+):", STYLE.read_text(encoding="utf-8")))
    )
    assert used <= defined
    assert {*get_args(Outcome)} <= {*OUTCOMES} & {*COLOURS}
    assert len({OUTCOMES[each] for each in get_args(Outcome)}) == len(get_args(Outcome))


def test_every_road_of_a_gallery_leads_somewhere() -> None:
    road = np.array([[0.0, 0.0], [125.0, 125.0], [250.0, 250.0]])
    small = [
        Thumbnail(
            n, outcome, road if n else road[:0], (125.0, 125.0) if outcome == "FAIL" else None, f"r{n}.png"
        )
        for n, outcome in enumerate(("ERROR", "PASS", "FAIL", "INVALID", "VALID"))
    ]
    svg = gallery(small, 250.0, "label", columns=2)
    assert [link.get("href") for link in all_of(svg, "a")] == [f"r{n}.png" for n in range(5)]
    assert len(all_of(svg, "polyline")) == 4
    assert len(all_of(svg, "path")) == 1


def test_cards_stand_beside_each_other_with_what_can_be_typed() -> None:
    """Nothing of the words is taken for markup."""
    card = FigureCard(
        ["2 · ", linked("3 tests", "a b.png")], "<svg><rect/></svg>", [NASTY, [ShellCommand(NASTY)]]
    )
    whole = page(Cards([card, card]))
    text = html_of(whole)
    assert text.count("<article><svg><rect/></svg><h3>2 · <a") == 2
    reader = PageParser()
    reader.feed(text)
    assert reader.text.count(NASTY) >= 4
    assert "<script" not in text
    assert "<code>" in text


@pytest.mark.parametrize(
    ("filled", "is_one"),
    [
        ([], False),
        ([3.0], False),
        ([1.0] * 9, False),
        ([1.0] * 10, True),
        ([1.0, 2.0], True),
        ([np.nan, 2.0], False),
    ],
)
def test_a_map_that_shows_nothing_is_none(filled: list[float], is_one: bool) -> None:
    values = np.zeros(25)
    values[: len(filled)] = filled
    assert is_map(values.reshape(5, 5)) is is_one
    figures = feature_map("map", values.reshape(5, 5), MAPS[0], bounds_of_columns(), "tests", "Tests in {}.")
    assert len(figures) == is_one


def shown_in(svg: str) -> NDArray[np.int_]:
    """The pixels of the picture in an svg element, as bytes."""
    data = re.search(r"base64,([^\"]+)", svg)
    assert data is not None
    return np.rint(255 * imread(io.BytesIO(base64.b64decode(data[1])))[..., :3]).astype(int)


def like(pixels: NDArray[np.int_], colour: str) -> NDArray[np.bool_]:
    return np.asarray((np.abs(pixels - 255 * np.array(to_rgb(colour))) < 12).all(axis=-1))


def test_the_place_of_a_failure_is_to_scale_with_the_road_s_own_lanes() -> None:
    """A road to the east with 2+1 lanes of 3 m; the middle of the picture is that of the outer right lane."""
    road = Road.through([(20, 60), (80, 60), (140, 60), (200, 60)])
    world = World(section=CrossSection(lanes="2+1", lane_width=3.0))
    run = prove(road, 1, world, Setup(drives=False))
    picture = shown_in(close_up(run, 90.0, "a place"))
    per_metre = len(picture) / 52.0
    dark = like(picture[:, int(30 * per_metre)], ASPHALT) | like(picture[:, int(30 * per_metre)], PAINT)
    rows = np.flatnonzero(dark) / per_metre  # m from the northern border
    middle = float(world.profile_of(road).middle(90.0))
    assert rows.min() == pytest.approx(26 - (3.0 - middle), abs=0.4)
    assert rows.max() == pytest.approx(26 + (middle + 6.0), abs=0.4)


def test_the_place_of_a_failure_has_the_car_a_cross_and_its_name() -> None:
    road = Road.through([(20, 60), (80, 60), (110, 62), (112, 92), (112, 150)])
    run = prove(road, 1, World().changed(friction=0.3), despite_findings=True)
    assert run.verdict is not None
    assert run.verdict.at_s is not None
    made = close_up(run, run.verdict.at_s, 'it "failed"')
    assert ET.fromstring(made).get("aria-label") == 'it "failed"'
    where = np.argwhere(like(shown_in(made), VERMILLION))
    assert len(where) > 20
    assert np.abs(where.mean(axis=0) / len(shown_in(made)) - 0.5).max() < 0.1
