"""The report of a campaign of many tests says what stands in its store, counted by another way."""

import csv
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from page_words import words_of
from roadgpt.campaign.model import Cell, CellBudget, Proposal, Result
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import Record, Store
from roadgpt.campaign.single_test import FinishedTest
from roadgpt.report.report import write_report
from roadgpt.run.model import Request, Seconds

CELLS, TESTS = ("c01", "c02"), 300
DRIVERS = ("beamng_like", "pure_pursuit")


def drawn(goes_on: bool = False) -> Iterator[tuple[str, Result]]:
    """Results as they might be: the second driver fails more often; drives end where they fail, or go on."""
    rng = np.random.default_rng(3)
    for cell in CELLS:
        for number in range(1, TESTS + 1):
            margin = float(rng.normal(0.8 if cell == "c01" else 0.3, 0.6))
            outcome = "INVALID" if rng.random() < 0.1 else "FAIL" if margin < 0 else "PASS"
            features = {"MAX_CURV": float(rng.uniform(0, 0.08)), "DIR_COV": float(rng.uniform(0, 0.5))}
            yield (
                cell,
                Result(
                    number=number,
                    batch=0,
                    proposal=Proposal(None, number, "draft"),
                    outcome=outcome,  # type: ignore[arg-type]
                    description=f"what happened in <{number}>",
                    length=200.0,
                    margin=None if outcome == "INVALID" else margin if goes_on else max(margin, -1e-5),
                    max_oob=None if outcome == "INVALID" else 0.96 if margin < 0 else 0.1,
                    beyond=None if outcome == "INVALID" else 1.9 if margin < 0 else 0.2,
                    cause="out of lane" if outcome == "FAIL" else None,
                    side="left" if outcome == "FAIL" else None,
                    at_s=50.0 if outcome == "FAIL" else None,
                    features={} if outcome == "INVALID" else features,
                ),
            )


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("many"))


def written(folder: Path, goes_on: bool = False) -> Path:
    """A campaign of such results."""
    plan = Plan(prompts=("a winding road",), drivers=DRIVERS, budget=CellBudget(tests=TESTS))
    cells = []
    for name, driver in zip(CELLS, DRIVERS, strict=True):
        request = Request(words="a winding road")
        setup = request.setup.model_copy(update={"driver": driver, "keep_driving": goes_on})
        request = request.model_copy(update={"setup": setup})
        cells.append(Cell(name, request, None, "words", None, budget=CellBudget(tests=TESTS)))
    store = Store.new(folder, plan.model_dump_json(), cells, {key: {"roadgpt": "1"} for key in DRIVERS})
    with store:
        store.begin_session(1)
        results = list(drawn(goes_on))
        for cell in CELLS:
            proposals = [result.proposal for name, result in results if name == cell]
            store.add_batch(cell, 0, 1, proposals)
        ended = [(cell, FinishedTest(result, seconds=Seconds(0.01, 0.1))) for cell, result in results]
        store.keep(ended, None, {"c01": 3.0, "c02": 4.0})
        store.finish()
    return folder


def rows(folder: Path, name: str) -> list[dict[str, str]]:
    return list(csv.DictReader((folder / "tables" / f"{name}.csv").open()))


def test_counts_are_those_of_the_results(campaign: Path) -> None:
    write_report(campaign)
    found = rows(campaign, "outcomes")
    for row in found:
        own = [result for cell, result in drawn() if cell == row["cell"]]
        failed = [result for result in own if result.outcome == "FAIL"]
        driven = [result for result in own if result.outcome in ("PASS", "FAIL")]
        assert (int(row["tests"]), int(row["failed"]), int(row["driven"])) == (
            TESTS,
            len(failed),
            len(driven),
        )
        least = min(result.margin for result in driven if result.outcome == "PASS" and result.margin)
        assert float(row["nearest when kept, m"]) == pytest.approx(least, abs=1e-4)
    page = (campaign / "report.html").read_text()
    total = sum(result.outcome == "FAIL" for _, result in drawn())
    assert f"{total} FAIL" in page
    assert "Most fail in c02" in page
    assert "&lt;" in page
    assert not re.search(r"<\d+>", page)


def test_failures_stand_in_order_and_lead_to_their_runs(campaign: Path) -> None:
    every = [(r.max_oob, f"{c}/{r.number}") for c, r in drawn() if r.outcome == "FAIL"]
    cell, number = every[0][1].split("/")
    there = campaign / "again" / cell / "runs" / f"{int(number):04d}"
    there.mkdir(parents=True)
    (there / "birds_eye.png").write_bytes(b"")
    write_report(campaign)
    found = rows(campaign, "failures")
    assert [row["test"] for row in found] == [name for _, name in every[:30]]
    assert [float(row["outside at most"]) for row in found] == pytest.approx(
        [share for share, _ in every[:30]], abs=1e-4
    )
    page = (campaign / "report.html").read_text()
    found = {*re.findall(r'href="(again[^"]+)"', page)}
    assert found == {f"again/{cell}/runs/{int(number):04d}/birds_eye.png"}
    assert f"roadgpt view {campaign}/{every[0][1]}" in page


def test_a_drive_that_ended_where_it_failed_has_no_margin_to_tell(campaign: Path) -> None:
    """It ends within a step of its lane's edge, whatever would have come: a number of no meaning."""
    write_report(campaign)
    text = words_of(campaign)
    assert not re.search(r"[-−]0\.0+\b", text)
    kept = [(r.margin, f"{c}/{r.number}") for c, r in drawn() if r.outcome == "PASS"]
    least, where = min(kept)  # type: ignore[type-var]
    assert f"Of the drives that kept their lane, test {where} came nearest to failing" in text
    assert least is not None
    assert (f"{least:.2f} m" if least >= 0.01 else "less than 1 cm") in text
    assert "Farthest out" not in text
    assert "96 %" in text


def test_bars_and_cells_hold_every_test(campaign: Path) -> None:
    """The curve ends at all failures, and maps hold all tests that have features."""
    from roadgpt.campaign.columns.execution import columns
    from roadgpt.report.chapters.roads import _counts, coverage

    with Record.opened(campaign) as record:
        sums = _counts(record, ("MAX_CURV", "DIR_COV"), columns.bounds, 1)
        section = coverage([record])
    assert section is not None
    figures = section.blocks
    told = [r for _, r in drawn() if r.features]
    assert sums.sum() == len(told)
    theirs, _, _ = np.histogram2d(
        [r.features["DIR_COV"] for r in told],
        np.clip([r.features["MAX_CURV"] for r in told], 0, 0.07 - 1e-9),
        25,
        ((0, 1), (0, 0.07)),
    )
    assert np.abs(sums - theirs).sum() <= 2  # rounding at the border of a cell
    assert len(figures) == 1
    assert "largest curvature, 1/m" in figures[0].svg
