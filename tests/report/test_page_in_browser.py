"""Pages in a real browser: nothing is asked for, nothing sticks out, both colour schemes, phone and desk."""

import json
from pathlib import Path

import numpy as np
import pytest

from chromium import FOUND, browser, opened
from roadgpt.report.page import write
from roadgpt.report.page.charts import AxisRange, Share, forest, heat
from roadgpt.report.page.model import Figure, Page, Section, Table, cell

pytestmark = pytest.mark.skipif(FOUND is None, reason="there is no chromium")
SIDES = ((1100, 800, False), (360, 740, True))


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    chart = forest([("a road", [Share(0, 0.5, 0.3, 0.7, "5 of 10")])], ["planner"], "x")
    matrix = heat(np.eye(9) + 1, AxisRange("road", 0, 9), AxisRange("road", 0, 9), "m", "x")
    rows = [[cell("a description of many words " * 4), *(cell(n) for n in range(9))]]
    table = Table("wide", "A wide table", ["prompt", *(f"number {n}" for n in range(9))], rows)
    sections = [Section("One", [table, Figure("f", "A figure.", chart), Figure("h", "Another.", matrix)])]
    return write(
        Page("A report", ["The first line.", "word" * 60], sections, {"seed": "1"}),
        tmp_path_factory.mktemp("r"),
    )


def test_it_fits_every_screen_in_both_schemes_and_prints(report: Path) -> None:
    with browser() as page:
        shades = set()
        for wide, high, is_phone in SIDES:
            for scheme in ("light", "dark"):
                page.size(wide, high, is_phone)
                feature = {"name": "prefers-color-scheme", "value": scheme}
                page.send("Emulation.setEmulatedMedia", features=[feature])
                opened(page, report)
                assert page.run("document.documentElement.scrollWidth") <= wide
                assert page.run("document.querySelectorAll('h2').length") == 2
                colours = "(s => s.color + s.backgroundColor)(getComputedStyle(document.body))"
                shades.add(page.run(colours))
                sticks_out = """[...document.querySelectorAll('p, li, h1, h2, dd, figcaption')].filter(
                    e => e.getBoundingClientRect().right > innerWidth + 1).map(e => e.textContent)"""
                assert page.run(f"JSON.stringify({sticks_out})") == json.dumps([])
        assert len(shades) == 2
        assert page.told == []
        assert {url.split(":")[0] for url in page.asked} <= {"file", "about", "data"}
        page.send("Emulation.setEmulatedMedia", media="print")
        assert page.run("getComputedStyle(document.querySelector('nav')).display") == "none"
        assert page.send("Page.printToPDF")["data"]


def test_the_last_column_of_a_usual_table_is_seen_on_a_phone_and_that_of_a_wide_one_is_reached(
    tmp_path: Path,
) -> None:
    heads = ["where the car was", "passed", "share", "outside at most", "beyond the marking, m"]
    rows = [["at most 10 % outside", 7, "87.5 %", "3 %", 0.12], ["mostly outside", 0, "0.0 %", "–", "–"]]
    many = [f"number {n}" for n in range(12)]
    tables = [
        Table("usual", "Five columns", heads, [[cell(each) for each in row] for row in rows]),
        Table("many", "Twelve columns", many, [[cell(n) for n in range(12)]]),
    ]
    path = write(Page("A report", [], [Section("One", tables)], {}), tmp_path)
    heads = "[...document.querySelectorAll('th:last-child')]"
    last = f"{heads}.map(each => each.getBoundingClientRect().right)"
    with browser() as page:
        page.size(380, 740, is_phone=True)
        opened(page, path)
        usual, wide = page.run(last)
        assert usual <= 380
        assert wide > 380
        page.run("document.querySelectorAll('.wide').forEach(e => e.scrollLeft = 1e4)")
        assert page.run(last)[1] <= 380
