"""The page to print is one sheet of A4, whatever the campaign, and says how to repeat the tests."""

import base64
import re
from html import unescape
from pathlib import Path

import pytest

from chromium import FOUND, browser, opened
from roadgpt.brief import read
from roadgpt.campaign.model import Cell, CellBudget, Proposal, Result
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import Store
from roadgpt.campaign.single_test import FinishedTest
from roadgpt.design import draft
from roadgpt.errors import UsageError
from roadgpt.report.brief_page import write_brief
from roadgpt.road import World

LONG = "a winding road that climbs to a pass and comes down again " * 20
UNBROKEN = "/srv/" + "drivers" * 60 + ".py:Mine"


def stored(folder: Path, words: str, drivers: list[str], outcomes: list[str]) -> Path:
    """A campaign with a cell for each driver, and a test with each outcome; the last test is the worst."""
    plan = Plan(prompts=(words,), drivers=tuple(drivers), budget=CellBudget(tests=len(outcomes) or 1))
    cells = [
        Cell(f"c{number:02}", request, None, generator, None)
        for number, (request, generator) in enumerate(plan.requests(), 1)
    ]
    folder.mkdir()
    versions = {driver: {"roadgpt": "1.2.3", "library": "4" * 600} for driver in drivers}
    design = draft(read("two turns"), World(), seed=1)
    with Store.new(folder, plan.model_dump_json(), cells, versions) as store:
        for cell in cells:
            for number, outcome in enumerate(outcomes, 1):
                proposal = Proposal(None, number, "draft")
                failed = outcome == "FAIL"
                result = Result(
                    number, number - 1, proposal, outcome, f"{outcome}: {words}", design, 100.0,  # type: ignore[arg-type]
                    margin=-number - 0.01 * (cell is cells[-1]) if failed else 1.0,
                    at_s=40.0 if failed else None, cause="out of lane" if failed else None,
                    side="left" if failed else None,
                )  # fmt: skip
                store.add_batch(cell.name, number - 1, number, [proposal])
                store.keep([(cell.name, FinishedTest(result))])
        store.finish()
    return folder


@pytest.mark.skipif(FOUND is None, reason="there is no chromium")
def test_it_is_one_sheet_whose_picture_is_seen(tmp_path: Path) -> None:
    every = ["PASS", "INVALID", "ERROR", "UNAVOIDABLE", "NOT TESTED", "FAIL", "FAIL"]
    pages = [
        write_brief(
            stored(tmp_path / "small", "two turns", ["reference"], ["PASS"]), "roadgpt run 'two turns'"
        ),
        write_brief(stored(tmp_path / "none", "two turns", ["reference"], ["INVALID"])),
        write_brief(
            stored(tmp_path / "large", LONG, [UNBROKEN, *map(str, range(15))], every), "roadgpt " + LONG
        ),
    ]
    with browser() as page:
        for path in pages:
            opened(page, path)
            pdf = base64.b64decode(page.send("Page.printToPDF", preferCSSPageSize=True)["data"])
            assert len(re.findall(rb"/Type\s*/Page\b", pdf)) == 1, path
            (box,) = {*re.findall(rb"/MediaBox\s*\[([^]]+)\]", pdf)}
            assert [float(side) for side in box.split()] == pytest.approx(
                [0, 0, 595, 842], abs=1.5
            )  # pt of A4
            page.send(
                "Emulation.setDeviceMetricsOverride",
                width=688,
                height=1017,
                deviceScaleFactor=1,
                mobile=False,
            )
            page.send("Emulation.setEmulatedMedia", media="print")
            bottom = "document.querySelector('main').lastElementChild.getBoundingClientRect().bottom"
            assert page.run(bottom) < 1017, "nothing is cut"
            tall = page.run("document.querySelector('figure svg')?.getBoundingClientRect().height ?? 999")
            assert tall > 150, "px"
            page.send("Emulation.setEmulatedMedia", media="")
        assert page.told == []


def test_it_says_what_was_tested_the_worst_and_how_to_repeat_it(tmp_path: Path) -> None:
    folder = stored(tmp_path / "c", "two turns", ["reference", "pure_pursuit"], ["PASS", "FAIL", "FAIL"])
    page = unescape(write_brief(folder, "roadgpt campaign 'two turns'").read_text(encoding="utf-8"))
    for said in (
        "two turns", "reference", "pure_pursuit", "roadgpt 1.2.3", "6 tests: 4 FAIL, 2 PASS",
        "Test c02/3, FAIL: FAIL: two turns.", "Cause: out of lane, left, at 40 m along the road",
        f"roadgpt drive --again {folder}/c02/3", "<code>roadgpt campaign 'two turns'</code>",
    ):  # fmt: skip
        assert said in page, said
    assert page.count("data:image/png;base64,") == 1
    with pytest.raises(UsageError, match="holds no finished test yet; say first: roadgpt resume"):
        write_brief(stored(tmp_path / "empty", "two turns", ["reference"], []), "roadgpt resume x")
