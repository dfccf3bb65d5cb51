"""A failure while the person at the wheel drove is not the driver's: every table and count says so."""

import csv
import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from click.testing import CliRunner

from campaign.quick import a_design
from page_words import words_of
from roadgpt.campaign.csv_tables import write_tables
from roadgpt.campaign.model import Cell, CellBudget, Proposal, Result
from roadgpt.campaign.plan import Plan
from roadgpt.campaign.record import Store
from roadgpt.campaign.single_test import FinishedTest
from roadgpt.cli import app
from roadgpt.run import Request, Setup
from roadgpt_search.faults.failures import failures_of

WORDS = "turn left, then a roundabout"


def result(number: int, outcome: str, own: float | None, by: str | None) -> Result:
    failed: dict[str, object] = {"cause": "out of lane", "side": "left", "at_s": 20.0}
    return Result(
        number=number,
        batch=0,
        proposal=Proposal(a_design(1), number, "draft"),
        outcome=outcome,  # type: ignore[arg-type]
        description=f"test {number}",
        design=a_design(1),
        length=100.0,
        margin=-0.1 if outcome == "FAIL" else 1.0,
        max_oob=0.6 if outcome == "FAIL" else 0.0,
        own_share=own,
        handed_to=by,
        **(failed if outcome == "FAIL" else {}),  # type: ignore[arg-type]
    )


RESULTS = [
    result(1, "PASS", 0.4, None), result(2, "FAIL", 0.5, "reference"), result(3, "FAIL", 0.6, None),
    result(4, "FAIL", None, None), result(5, "FAIL", 0.25, "reference"),
]  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("handed")
    setup = Setup(driver="lane_centring", reader="plan")
    budget = CellBudget(tests=len(RESULTS))
    cell = Cell("c01", Request(words=WORDS, setup=setup), None, "words", None, budget=budget)
    plan = Plan(prompts=(WORDS,), budget=budget)
    with Store.new(folder, plan.model_dump_json(), [cell], {"any": {"roadgpt": "1"}}) as store:
        store.begin_session(1)
        store.add_batch("c01", 0, 1, [each.proposal for each in RESULTS])
        store.keep([("c01", FinishedTest(each)) for each in RESULTS])
        store.finish()
        write_tables(store, folder)
    return folder


def roadgpt(*words: object) -> str:
    done = CliRunner().invoke(app, [str(word) for word in words], prog_name="roadgpt")
    assert done.exit_code == 0, done.output
    return done.stdout


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return [*csv.DictReader(file)]


def test_tables_say_who_drove_and_count_what_is_not_the_drivers(folder: Path) -> None:
    assert [(row["own_share"], row["handed_to"]) for row in rows(folder / "results.csv")] == [
        ("0.4", ""), ("0.5", "reference"), ("0.6", ""), ("", ""), ("0.25", "reference"),
    ]  # fmt: skip
    (cell,) = rows(folder / "cells.csv")
    assert (cell["failed"], cell["failed_handed_over"]) == ("4", "2")
    assert (cell["driver"], cell["oracle"]) == ("lane_centring", "half")


def test_the_screen_says_it(folder: Path) -> None:
    said = roadgpt("show", folder)
    assert "  in 2 FAIL the driver had handed over: they are not its failures\n" in said
    assert "driver lane_centring, oracle half: FAIL when more than half of the car" in said
    (status,) = [json.loads(line) for line in roadgpt("show", folder, "--json").splitlines()]
    assert [(cell["oracle"], cell["handed_over"]) for cell in status["cells"]] == [("half", 2)]
    listed = roadgpt("show", f"{folder}/c01").splitlines()[-len(RESULTS) :]
    assert [line.split("  ")[1].split("   ")[0].strip() for line in listed] == [
        "PASS", "FAIL (out of lane, reference drove)", "FAIL (out of lane)", "FAIL (out of lane)",
        "FAIL (out of lane, reference drove)",
    ]  # fmt: skip


def test_the_report_and_junit_say_it(folder: Path, tmp_path: Path) -> None:
    roadgpt("report", folder, "--junit", tmp_path / "j.xml")
    text = words_of(folder)
    assert "On 2 of them the driver had handed over: they are not its failures." in text
    assert "driver lane_centring, oracle half" in text
    cases = [*ET.parse(tmp_path / "j.xml").iter("testcase")]
    told = [{each.attrib["name"]: each.attrib["value"] for each in case.iter("property")} for case in cases]
    assert [(one.get("own_share"), one.get("handed_to")) for one in told] == [
        ("0.4", None), ("0.5", "reference"), ("0.6", None), (None, None), ("0.25", "reference"),
    ]  # fmt: skip


def test_a_failure_of_the_person_is_no_fault_of_the_driver(folder: Path) -> None:
    found, count = failures_of(folder)
    assert count == 4
    systems = {each.name.number: each.system for each in found}
    assert systems[2] == systems[5]
    assert systems[3] == systems[4]
    assert systems[2] != systems[3]
