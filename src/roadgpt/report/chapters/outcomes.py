"""Makes the sections on what became of the tests: outcomes, failures, and how near others came to failing.

SQL queries count the tests of a Record, so that a report on a million tests needs little memory."""

from collections.abc import Mapping, Sequence

import numpy as np

from roadgpt.campaign.columns import told_of
from roadgpt.campaign.model import NumberedTest
from roadgpt.campaign.record import Record, reading_store
from roadgpt.campaign.status import CellStatus, Status
from roadgpt.errors import command_line
from roadgpt.plural import plural
from roadgpt.reading import json_of
from roadgpt.report.chapters.validity import Count, Source, outside_table, passed_tests, shares_forest
from roadgpt.report.chapters.wording import (
    SHARE_HEADS,
    decimal,
    driver_names,
    p_value,
    percent,
    row,
    share_cells,
)
from roadgpt.report.page.charts import bars, lines
from roadgpt.report.page.model import Block, Figure, Section, Table, TableCell, cell, linked
from roadgpt.report.road_record import file_of, named
from roadgpt.report.statistics import chi_squared

MOST_CELLS = 12  # whose curves and shares are drawn
TABLES = ("results.csv", "cells.csv")
NAMED = 30  # tests that are shown one by one
STEPS = 200  # of a curve
MARGINS = (-2.0, 2.0, 0.1)  # m: from, to, width of a bar; what lies beyond is in the outermost


def driven(of: Status | CellStatus) -> tuple[int, int]:
    """Returns the number of roads on which the car failed, and of all driven roads."""
    failed = of.outcomes.get("FAIL", 0)
    return failed, failed + of.outcomes.get("PASS", 0)


def outcomes(record: Record, status: Status, are_same: bool) -> Section:
    """Returns the section on the outcomes of each cell; ``are_same``: whether their roads are the same."""
    seconds = dict(record.query("SELECT name, seconds FROM cells"))
    names = driver_names(each.driver for each in status.cells)
    abouts = [_about(each, names) for each in status.cells]
    differing = [head for head in abouts[0] if len({about[head] for about in abouts}) > 1]
    same = ", ".join(f"{head} {text}" for head, text in abouts[0].items() if head not in differing)
    note = f"{'In all cells: ' * (len(abouts) > 1)}{same}." if same else ""
    rows: list[list[TableCell]] = []
    for each, about in zip(status.cells, abouts, strict=True):
        rows.append(
            row(
                each.name or "all",
                *(about[head] for head in differing),
                each.done,
                *(each.outcomes.get(name, 0) for name in ("INVALID", "ERROR")),
                *share_cells(*driven(each)),
                decimal(each.least_margin),
                decimal(seconds.get(each.name), 0),
            )
        )
    heads = ["cell", *differing, "tests", "invalid", "error", "failed", *SHARE_HEADS, "nearest when kept, m",
             "s"]  # fmt: skip
    heads[heads.index("of")] = "driven"
    blocks: list[Block] = [Table("outcomes", "Outcomes, cell by cell", heads, rows, note)]
    some = [each for each in status.cells if driven(each)[1]]
    if len(some) > 1 and not are_same:  # its test is for roads that are not the same
        found = chi_squared([[failed, of - failed] for failed, of in map(driven, some)])
        blocks.append(
            f"Do cells differ in how many roads fail? χ² = {found.statistic:.2f} with {found.freedom} "
            f"degrees of freedom, {p_value(found.p)}, Cramér's V = {found.cramers_v:.2f}."
            + ("" if found.is_sound or not found.freedom else " Expected counts are small.")
        )
    if some:
        counts = [
            Count(f"{each.name} · {each.generator} · {names[each.driver]}".lstrip(" ·"), *driven(each))
            for each in some[:MOST_CELLS]
        ]
        source = Source("failed", tuple(counts), "failed")
        blocks.append(shares_forest("failed", "on which the car failed", [source]))
    beside = [linked(name, name) for name in TABLES if (record.folder / name).is_file()]
    if beside:
        between = " and " if len(beside) > 1 else ""
        blocks.append(["Every test stands in ", beside[0], between, *beside[1:], "."])
    if status.scenarios:
        (*heads,), *counted = status.scenario_table
        note = "Refused is what cannot happen on its road; results.csv has the parameters of each test."
        blocks.append(
            Table("scenarios", "Outcomes by scenario", heads, [row(*each) for each in counted], note)
        )
    return Section("Outcomes", blocks)


def _about(of: CellStatus, names: Mapping[str, str]) -> dict[str, str]:
    return {
        "description": f"“{of.about}”",
        "generator": of.generator,
        "driver": names[of.driver],
        "oracle": of.oracle,
        "seed": str(of.seed),
        "friction": "of each road" if of.friction is None else f"{of.friction:g}",
    }


def failures(record: Record, status: Status, drives_on: bool) -> list[Section]:
    """Returns the sections on failures, and on how near the others came to failing: failures over the number
    of tests, their causes, the worst tests, and margins. ``drives_on`` says whether cars drive on after they
    have left their lane."""
    (failed, every), blocks = driven(status), list[Block]()
    if failed:
        cells = [each for each in status.cells if each.done][:MOST_CELLS]
        blocks += [_curves(record, cells), _causes(record, drives_on)]
    worst = _worst(record, status.done, drives_on)
    keys = worst.heads[6:-1]
    out = [Section("Failures" if failed else "The nearest tests", [*blocks, worst])] if every or keys else []
    near: list[Block] = [
        *outside_table(passed_tests([record])),
        *([_margins(record, drives_on)] if every else []),
    ]
    return [*out, *([Section("How near to failing", near)] if near else [])]


def _worst(record: Record, done: int, drives_on: bool) -> Table:
    folder, least = record.folder, "margin" if drives_on else "CASE outcome WHEN 'PASS' THEN margin END"
    order = f"outcome != 'FAIL', outcome != 'UNAVOIDABLE', {least} IS NULL, {least}, cell, number"
    some = record.query(
        "SELECT cell, number, outcome, margin, max_oob, cause, side, at_s, description, features FROM "  # noqa: S608
        "(SELECT * FROM tests WHERE outcome NOT IN ('INVALID', 'ERROR') "
        f"ORDER BY {order} LIMIT ?) JOIN details USING (cell, number) ORDER BY {order}",
        (NAMED,),
    )
    with reading_store(record.path):
        numbers = [{its.key: its.value for its in told_of(json_of(found))} for *_, found in some]
    keys = [*dict.fromkeys(key for own in numbers for key in own)]
    rows = []
    for (name, number, outcome, margin, outside, cause, side, at_s, says, _), own in zip(
        some, numbers, strict=True
    ):
        test = str(NumberedTest(name, number))
        has_margin = cause != "collision" and (drives_on or outcome == "PASS")
        rows.append(
            row(
                cell(test, href=file_of(folder, name, number)),
                outcome,
                _outside(outside),
                decimal(margin if has_margin else None),
                " ".join(filter(None, (cause, side))) or None,
                decimal(at_s, 0),
                *(decimal(own.get(key)) for key in keys),
                says or "",
            )
        )
    note = "Failures first, " + ("the farthest out before others" if drives_on else "in order")
    note += ", then the drives that came nearest to failing."
    if rows:
        note += f" To see one: {command_line('view', named(folder, NumberedTest(*some[0][:2])))}"
    heads = ["test", "outcome", "outside at most", "margin, m", "cause", "at, m", *keys, "what happened"]
    caption = f"The worst {len(rows)} of {plural(done, 'test')}" if len(rows) < done else "All tests"
    return Table("failures", caption, heads, rows, note)


def _outside(share: float | None) -> TableCell:
    return cell(None) if share is None else cell(round(share, 4), percent(share, 0))


def _curves(record: Record, cells: Sequence[CellStatus]) -> Figure:
    curves = []
    for each in cells:
        width = max(1, -(-each.asked // STEPS))
        found = record.query(
            "SELECT (number - 1) / ?, sum(outcome = 'FAIL') FROM tests WHERE cell = ? AND outcome IS NOT "
            "NULL GROUP BY 1 ORDER BY 1",
            (width, each.name),
        )
        at = np.array([0, *((step + 1) * width for step, _ in found)], float)
        at[-1] = min(at[-1], each.asked) if len(at) > 1 else at[-1]
        curves.append((each.name, at, np.cumsum([0, *(failed for _, failed in found)])))
    caption = "Failures found over the tests of each cell, in the order in which they were asked for."
    return Figure("found", caption, lines(curves, "tests", "failures found", caption))


def _causes(record: Record, drives_on: bool) -> Table:
    found = record.query(
        "SELECT cause, side, count(*), coalesce(min(margin), 0), max(max_oob) FROM tests "
        "WHERE outcome = 'FAIL' GROUP BY 1, 2 ORDER BY 3 DESC, 1, 2"
    )
    rows = [
        row(
            cause or "other",
            side or "–",
            count,
            _outside(outside),
            *([decimal(-min(least, 0.0) or None)] if drives_on else []),
        )
        for cause, side, count, least, outside in found
    ]
    heads = ["cause", "side", "tests", "outside at most", *(["farthest out, m"] if drives_on else [])]
    return Table("causes", "How the car failed", heads, rows)


def _margins(record: Record, drives_on: bool) -> Figure:
    """Returns a histogram of the margins of all tests, in metres. A margin is the smallest sideways shift
    that would have made the car fail; it is negative if the car left its lane or fell."""
    low, high, width = MARGINS
    n = round((high - low) / width)
    found: Mapping[int, int] = dict(
        record.query(
            "SELECT CAST((max(min(margin, ?), ?) - ?) / ? AS INTEGER), count(*) FROM tests "
            "WHERE margin IS NOT NULL AND cause IS NOT 'collision' GROUP BY 1",
            (high - width / 2, low, low, width),
        )
    )
    counts = [found.get(step, 0) for step in range(n)]
    caption = (
        "Margins: how far sideways the car still was from failing where it came closest; negative where it "
        "failed. The outermost bars hold what lies beyond."
    )
    if not drives_on:
        caption += (
            " A drive ends where the car leaves its lane, so such failures lie within centimetres of 0."
        )
    edges = np.linspace(low, high, n + 1)
    return Figure("margins", caption, bars(edges, counts, "margin, m", "tests", caption, 0.0))
