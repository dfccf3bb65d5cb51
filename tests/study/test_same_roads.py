"""Drivers on the same roads: every figure of the table from statsmodels and scipy, and a real campaign."""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from scipy import stats

from roadgpt.campaign.lifecycle import begin, work
from roadgpt.campaign.model import Cell, CellBudget, Proposal, Result
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import Record, Store
from roadgpt.campaign.single_test import FinishedTest
from roadgpt.campaign.workers import InProcess
from roadgpt.cli import app
from roadgpt.report.chapters import same_roads
from roadgpt.report.page import write
from roadgpt.report.page.model import Figure, Page
from roadgpt.road import Design, Segment
from roadgpt.run.model import Seconds

DRIVERS = ("reference", "/srv/me/one/driver.py:Mine", "/srv/me/two/driver.py:Mine")
SHORT = ["reference", "one/driver.py:Mine", "two/driver.py:Mine"]
ROADS = 40
OTHER, BROKEN, INVALID = 3, 5, 7
"""Roads of which one driver got another one, on which one driver broke down, and that is invalid."""


def margin_of(driver: int, road: int) -> float:
    return float(np.random.default_rng([driver, road]).normal((1.2, 0.5, 0.1)[driver], 0.6))


def result_of(driver: int, road: int) -> Result:
    metres = 100.0 + road + (road == OTHER and driver == 1)
    margin: float | None = margin_of(driver, road)
    outcome: Any = "FAIL" if margin is not None and margin < 0 else "PASS"
    if road == INVALID or (road == BROKEN and driver == 2):
        outcome, margin = "INVALID" if road == INVALID else "ERROR", None
    design = Design(
        starting_point=(0, 0, 0), theta=0, segments=(Segment(distance=metres, direction="straight"),)
    )
    proposal = Proposal(None, 7, "draft")
    return Result(road, 0, proposal, outcome, "", design, margin=margin)


def stored(folder: Path, result_of: Callable[[int, int], Result]) -> Path:
    """A campaign of such results; the last road is not there for the last driver."""
    cells: list[Cell] = []
    plan = Plan(prompts=("a road",), drivers=DRIVERS, budget=CellBudget(tests=ROADS), paired=True)
    for number, (request, generator) in enumerate(plan.requests(), 1):
        cells.append(Cell(f"c0{number}", request, None, generator, None))
    versions = {driver: {"roadgpt": "1"} for driver in DRIVERS}
    with Store.new(folder, plan.model_dump_json(), cells, versions) as store:
        for driver, cell in enumerate(cells):
            results = [result_of(driver, road) for road in range(1, ROADS + 1 - (driver == 2))]
            store.add_batch(cell.name, 0, 1, [result.proposal for result in results])
            ended = [(cell.name, FinishedTest(result, seconds=Seconds(0.0, 0.1))) for result in results]
            store.keep(ended)
        store.finish()
    return folder


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return stored(tmp_path_factory.mktemp("paired"), result_of)


def test_every_figure_is_that_of_others(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from statsmodels.stats.contingency_tables import cochrans_q, mcnemar
    from statsmodels.stats.multitest import multipletests

    drawn: list[tuple[int, tuple[int, int]]] = []

    def figure(record: Record, rank: int, road: Any, names: list[str], which: tuple[int, int]) -> Figure:
        drawn.append((road[0].number, which))
        return Figure("x", "", "<svg/>")

    monkeypatch.setattr(same_roads, "_figure", figure)
    with Record.opened(folder) as record:
        section, said, _ = same_roads.same_roads(record)
    write(Page("", [], [section]), tmp_path)
    with (tmp_path / "tables" / "pairs-of-drivers.csv").open(encoding="utf-8") as file:
        rows = [*csv.DictReader(file)]
    same = [road for road in range(1, ROADS) if road != OTHER]
    assert (
        f"3 drivers got the same {len(same)} roads: equal seeds, and designs equal byte for byte" in said[0]
    )
    assert "; 2 other roads left out, not the same for all or not finished" in said[0]
    every = [road for road in same if road not in (BROKEN, INVALID)]
    assert said[1] == (
        f"All of them drove {len(every)} roads; 1 invalid; ended in an error: two/driver.py:Mine on 1."
    )
    failed = np.array([[margin_of(driver, road) < 0 for driver in range(3)] for road in every])
    q = cochrans_q(failed.astype(int))
    assert f"Cochran's Q = {q.statistic:.2f} with 2 degrees of freedom on {len(every)} roads" in said[2]
    pairs, outcome_p, margin_p = [(0, 1), (0, 2), (1, 2)], [], []
    for row, (a, b) in zip(rows, pairs, strict=True):
        own = [road for road in same if road != INVALID and not (road == BROKEN and 2 in (a, b))]
        x, y = (np.array([margin_of(driver, road) for road in own]) for driver in (a, b))
        crossed = [[((x < 0) & (y < 0)).sum(), ((x < 0) & (y >= 0)).sum()],
                   [((x >= 0) & (y < 0)).sum(), ((x >= 0) & (y >= 0)).sum()]]  # fmt: skip
        outcome_p.append(mcnemar(crossed, exact=True).pvalue)
        assert [row["A"], row["B"], int(row["roads"])] == [SHORT[a], SHORT[b], len(own)]
        counted = [int(row[head]) for head in ("A failed", "B failed", "only A", "only B")]
        assert counted == [(x < 0).sum(), (y < 0).sum(), crossed[0][1], crossed[1][0]]
        apart = np.maximum(x, 0) - np.maximum(y, 0)
        assert float(row["median of A - B, m"]) == pytest.approx(np.median(apart), abs=1e-4)
        moved = apart[apart != 0]
        margin_p.append(stats.wilcoxon(moved, method="exact").pvalue)
        ranks = stats.rankdata(np.abs(moved)) * np.sign(moved)
        assert float(row["r"]) == pytest.approx(ranks.sum() / np.abs(ranks).sum(), abs=1e-4)
    for head, p in (("McNemar p", outcome_p), ("Wilcoxon p", margin_p)):
        found = [float(row[head]) for row in rows]
        assert found == pytest.approx(multipletests(p, method="holm")[1], abs=1e-6)
    far = {road: [max(margin_of(driver, road), 0.0) for driver in range(3)] for road in every}
    apart = {road: (min(far[road]) == 0 < max(far[road]), np.ptp(far[road])) for road in every}
    assert [road for road, _ in drawn] == sorted(every, key=lambda road: apart[road], reverse=True)[:3]
    for road, (best, worst) in drawn:
        assert margin_of(best, road) == max(margin_of(driver, road) for driver in range(3))
        assert margin_of(worst, road) < 0
    latex = (tmp_path / "tables" / "pairs-of-drivers.tex").read_text(encoding="utf-8")
    assert "oracle half: FAIL when more than half of the car is outside its lane" in latex
    assert "/srv" not in latex + "".join(said) + str(rows)


def test_a_campaign_of_pairs_goes_on_and_ends_with_its_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("roadgpt.campaign.executors.processes.Processes", InProcess)
    monkeypatch.setattr(Store, "group_seconds", 0.0)
    words = ["campaign", "turn right r=15", "--reader", "plan", "-n", "2", "--friction", "0.5", "--paired",
             "--drivers", "reference, pure_pursuit"]  # fmt: skip
    whole = CliRunner().invoke(app, [*words, "--out", str(tmp_path / "whole")])
    assert whole.exit_code == 0, whole.output
    assert "2 cells, the same roads for each driver" in whole.output
    assert "2 drivers got the same 2 roads: equal seeds, and designs equal byte for byte" in whole.output
    assert f"report: {tmp_path / 'whole' / 'report.html'}" in whole.output
    with Record.opened(tmp_path / "whole") as record:
        plan = record.plan()
        designs = [[result.design for result in record.results(cell)] for cell in ("c01", "c02")]
    assert designs[0] == designs[1]
    begin(plan, tmp_path / "cut")
    next(steps := work(tmp_path / "cut"))
    steps.close()  # as Ctrl-C does
    done = CliRunner().invoke(app, ["resume", str(tmp_path / "cut"), "-q"])
    assert done.exit_code == 0, done.output
    assert done.output == ""
    for name in (
        "tables/pairs-of-drivers.csv",
        "tables/pairs-of-drivers.tex",
        "differ/1.png",
        "differ/1.pdf",
    ):
        assert (tmp_path / "cut" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    page = (tmp_path / "cut" / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == len([*(tmp_path / "cut" / "differ").glob("*.png")]) > 0
    assert "χ²" not in page, "a test for roads that are not the same"
