"""The chapter of reports on pairs at the boundary, against distances that are worked out by hand."""

import csv
from pathlib import Path

from page_words import words_of
from roadgpt.campaign.model import Cell, CellBudget, Proposal, Result
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import Store
from roadgpt.campaign.single_test import FinishedTest
from roadgpt.report.report import write_report
from roadgpt.road import Design, Segment
from roadgpt.run.model import Request, Seconds


def straight_turn_straight(first: float, incline: float = 0.0) -> Design:
    legs = [
        Segment(distance=first, direction="straight"),
        Segment(distance=40, direction="left", turn_degrees=60),
        Segment(distance=30, direction="straight", incline=incline),
    ]
    return Design(starting_point=(60, 60, 0), theta=0, segments=tuple(legs))


def test_the_nearest_pairs_of_a_search_for_the_boundary_are_listed(tmp_path: Path) -> None:
    """By the weights of the explanation: 10 m of a straight and 1 % of a grade are 1 each."""
    roads = {
        1: ("PASS", straight_turn_straight(50)),
        2: ("PASS", straight_turn_straight(50, 7)),
        3: ("FAIL", straight_turn_straight(90, 7)),
        4: ("FAIL", straight_turn_straight(50, 2)),
        5: ("INVALID", straight_turn_straight(50)),
    }
    plan = Plan(prompts=("a road with a turn",), goal="boundary", budget=CellBudget(tests=5))
    request = Request(words="a road with a turn")
    cell = Cell("c01", request, None, "quality_diversity", "boundary", budget=CellBudget(tests=5))
    with Store.new(tmp_path, plan.model_dump_json(), [cell], {"any": {"roadgpt": "1"}}) as store:
        store.begin_session(1)
        proposals = {number: Proposal(design, number, "draft") for number, (_, design) in roads.items()}
        store.add_batch("c01", 0, 1, [*proposals.values()])
        for number, (outcome, design) in roads.items():
            margin = {"PASS": 0.25, "FAIL": -1e-5}.get(outcome)
            result = Result(
                number, 0, proposals[number], outcome, outcome, design, 120.0, margin,  # type: ignore[arg-type]
                at_s=52.0 if outcome == "FAIL" else None, cause="out of lane" if outcome == "FAIL" else None,
            )  # fmt: skip
            store.keep([("c01", FinishedTest(result, seconds=Seconds(0.01, 0.1)))], None, {"c01": 1.0})
        store.finish()
    write_report(tmp_path)
    _, *rows = csv.reader((tmp_path / "tables" / "pairs.csv").read_text(encoding="utf-8").splitlines())
    assert rows == [
        ["c01/1", "0.25", "c01/4", "52.0", "2.0", "straight 2: grade 0 %, then 2 %"],
        ["c01/2", "0.25", "c01/3", "52.0", "4.0", "straight 1: length 50 m, then 90 m"],
    ]
    text = words_of(tmp_path)
    assert "c01/1, where the car kept its lane, and c01/4, where it did not" in text
    assert f"roadgpt view {tmp_path}/c01/1 {tmp_path}/c01/4" in text
