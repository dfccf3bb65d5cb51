"""The tables, written fast, against the same written slowly; and what they count."""

import csv
import io
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import given, settings
from hypothesis import strategies as st

from campaign.quick import a_design, plan
from campaign.test_store import BRIEFS, a_store, proposals, results
from roadgpt.campaign.csv_tables import COLUMNS, write_tables
from roadgpt.campaign.model import Proposal, Result
from roadgpt.campaign.record import Record
from roadgpt.campaign.single_test import FinishedTest, seed_of_driver


def computes(text: str) -> bool:
    """Whether a spreadsheet would compute a text; a sign alone begins a number, or a list in prose."""
    if text[:1] in ("+", "-"):
        return any(mark in text.split("\n")[0] for mark in "(|!")
    return text[:1] in ("=", "@")


def slowly(record: Record) -> str:
    """results.csv by Python's own csv module, from whole results."""
    features = record.feature_names()
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*COLUMNS, *(f"'{each}" if computes(each) else each for each in features)])
    for cell, one in ((name, one) for name in record.names() for one in record.results(name)):
        asked = (one.batch, one.proposal.origin, "", "", seed_of_driver(one.number, one.proposal))
        margin = None if one.cause == "collision" else one.margin
        came = (one.outcome, one.cause, one.side, one.length, margin, one.max_oob, one.beyond, one.at_s)
        known = [one.own_share, one.handed_to, one.description, *map(one.features.get, features)]
        line = [cell, one.number, *asked, *came, *known]
        table.writerow(f"'{each}" if isinstance(each, str) and computes(each) else each for each in line)
    return text.getvalue()


@settings(max_examples=10)
@given(st.data())
def test_the_table_is_that_of_a_slow_writer(data: st.DataObject) -> None:
    asked = data.draw(st.lists(proposals(), min_size=1, max_size=5))
    done = [data.draw(results(number, made)) for number, made in enumerate(asked, 1)]
    with TemporaryDirectory() as name, a_store(Path(name)) as store:
        store.begin_session(1)
        store.add_batch("c01", 0, 1, asked)
        store.keep([("c01", FinishedTest(result)) for result in done])
        write_tables(store, Path(name))
        assert (Path(name) / "results.csv").read_bytes().decode() == slowly(store)


def test_cells_count_what_the_results_say(tmp_path: Path) -> None:
    """Failing cells are those of failures alone; the least margin is that of drives that kept their lane."""
    places = [("FAIL", 0.01, -0.02), ("FAIL", 0.011, -0.5), ("FAIL", 0.05, -0.03), ("PASS", 0.03, 0.4)]
    places += [("PASS", 0.06, 0.2), ("INVALID", 0.02, None), ("ERROR", 0.02, None), ("VALID", 0.02, None)]
    places += [("PASS", 0.03, 0.3), ("INVALID", 0.02, None), ("NOT TESTED", 0.02, 0.1)]
    outside = [1.0, 0.96, 0.97, 0.0, 0.7, None, None, None, 0.3, None, 0.9]
    made = [Proposal(a_design(number), number, "draft") for number in range(len(places))]
    done = [
        Result(
            number,
            0,
            one,
            outcome,  # type: ignore[arg-type]
            "",
            one.design,
            margin=margin,
            max_oob=outside[number - 1],
            beyond=None if outside[number - 1] is None else 2 * outside[number - 1],
            side=(None, "left", "left", "right")[number % 4] if outcome == "FAIL" else None,
            features={"MAX_CURV": curvature, "STD_SA": 3.0},
        )
        for number, (one, (outcome, curvature, margin)) in enumerate(zip(made, places, strict=True), 1)
    ]
    with a_store(tmp_path) as store:
        store.begin_session(1)
        store.add_batch("c01", 0, 1, made)
        store.keep([("c01", FinishedTest(result)) for result in done])
        write_tables(store, tmp_path)
    (row,) = csv.DictReader((tmp_path / "cells.csv").open())
    request = plan(99).cells(BRIEFS)[0].request
    assert row == {
        "cell": "c01",
        "description": request.words,
        "designer": request.setup.designer,
        "driver": request.setup.driver,
        "simulator": request.setup.simulator,
        "generator": "search",
        "goal": "",
        "seed": str(request.seed),
        "tests": "11",
        "valid": "8",
        "passed": "3",
        "failed": "3",
        "unavoidable": "0",
        "not_tested": "1",
        "invalid": "2",
        "in_error": "1",
        "not_driven": "1",
        "failed_left": "2",
        "failing_cells": "2",
        "least_margin_m": "0.2",
        "passed_partly_outside": "1",
        "passed_mostly_outside": "1",
        "passed_max_oob": "0.7",
        "passed_beyond_m": "1.4",
        "friction": "1.0",
        "failed_handed_over": "0",
        "oracle": "half",
    }
