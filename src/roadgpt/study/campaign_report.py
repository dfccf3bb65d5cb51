"""Writes the report of a campaign. SQL queries count the tests in the campaign's database, so that a
report on a million tests needs little memory."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from roadgpt.campaign.faults.fault import faults_in
from roadgpt.campaign.record import Record
from roadgpt.campaign.status import CellStatus, Status, status_of
from roadgpt.plural import plural
from roadgpt.report.page import write
from roadgpt.report.page.forest import forest
from roadgpt.report.page.model import Block, Figure, Page, Section, Table, TableCell, linked
from roadgpt.run import Request
from roadgpt.study.chapters.campaign_tests import (
    boundary,
    coverage,
    failures,
    margins,
    nearest,
    nearest_sentence,
)
from roadgpt.study.chapters.faults import Steps, fault_summaries, faults, headline, what_to_try
from roadgpt.study.chapters.out_of_lane import outside_sentences, outside_table, passed_tests
from roadgpt.study.chapters.same_roads import compared, same_roads
from roadgpt.study.chapters.wording import (
    decimal,
    drawn_share,
    driver_names,
    interval_cell,
    near_and_far,
    p_value,
    percent,
    row,
    share_cells,
    share_of,
)
from roadgpt.study.statistics import chi_squared, wilson

COMPARED = 2000  # failures, evenly spread, that are grouped before they are tested; this takes seconds
MOST_CELLS = 12  # whose curves and shares are drawn
TABLES = ("results.csv", "cells.csv")


def write_store_report(folder: Path, command: str = "", next_steps: Steps = ()) -> Path:
    """Writes the report of a campaign into its folder and returns the path of the HTML page.

    The report shows ``command``, which repeats the campaign, and ``next_steps``, the commands to try if no
    test failed. An empty argument is not shown.

    Raises:
        UsageError: the folder holds no campaign, or the campaign has no finished test.
        RoadGPTError: a file cannot be written.
    """
    status = status_of(folder)
    with Record.opened(folder) as record:
        page = _page(folder, record, status, command, next_steps)
    return write(page, folder)


def _page(folder: Path, record: Record, status: Status, command: str, next_steps: Steps) -> Page:
    first, is_paired = record.cell(record.names()[0]).request, record.plan().paired
    goes_on = first.setup.keep_driving  # whether cars drive on after they have left their lane
    fields = [c for c in status.cells if c.done]
    words = list(dict.fromkeys(c.words for c in status.cells if c.words))
    title = words[0] if len(words) == 1 else f"A campaign of {plural(len(status.cells), 'cell')}"
    lead = f"{status.done:,} tests in {plural(len(status.cells), 'cell')}"
    lead += "" if status.is_finished else "; the campaign is unfinished"
    found = faults_in(folder, COMPARED)
    summaries = fault_summaries(folder, found)
    pairs = nearest(record, [each for each in fields if each.goal == "boundary"][:MOST_CELLS])
    gallery, covered = faults(folder, found, summaries), coverage(record, status.done)
    sections = [same_roads(folder, record)] if is_paired else []
    sections += [gallery] if gallery else []
    sections += [Section("Feature map", covered)] if covered else []
    sections += what_to_try(next_steps)
    sections.append(Section("Outcomes", _outcomes(record, status, fields, is_paired)))
    if any(_driven(each)[1] for each in fields):
        sections.append(Section("Failures", failures(folder, record, fields[:MOST_CELLS], goes_on)))
        near: list[Block] = [*outside_table(passed_tests(record)), margins(record, goes_on)]
        sections.append(Section("How near to failing", near))
    sections += [Section("At the boundary", boundary(folder, pairs))] if pairs else []
    summary = compared(record) if is_paired else []
    summary += headline(found, summaries) if _driven(status)[1] else []
    summary += [*_summary(record, first, status, fields), *nearest_sentence(pairs)]
    return Page(title, summary, sections, _card(command, record, status), lead)


def _summary(record: Record, first: Request, status: Status, cells: Sequence[CellStatus]) -> list[str]:
    counts, (failed, driven) = status.outcomes, _driven(status)
    told = ", ".join(f"{number:,} {outcome}" for outcome, number in sorted(counts.items()))
    out = [f"{status.done:,} tests: {told or 'nothing yet'}."]
    if driven:
        out.append(f"The car failed on {share_of(failed, driven)} of the roads that were driven.")
        if other := sum(cell.handed_over for cell in status.cells):
            out.append(f"On {other:,} of them the driver had handed over: they are not its failures.")
        best = max(cells, key=_failing)
        if len(cells) > 1:
            out.append(f"Most fail in {best.name}: {percent(_failing(best))} of its driven roads.")
        out += outside_sentences(passed_tests(record), first.world)
        farthest = _least(record, "FAIL") if first.setup.keep_driving else None
        out += near_and_far(_least(record, "PASS"), farthest)
    out += [sentence for each in cells if (sentence := each.remark)]
    wrong = counts.get("INVALID", 0) + counts.get("ERROR", 0)
    out.append(f"Of all tests {share_of(wrong, status.done)} were invalid or ended in an error.")
    if status.seconds:
        out.append(f"It took {status.seconds:,.0f} s, {status.done / status.seconds:.1f} tests a second.")
    return out


def _least(record: Record, outcome: str) -> tuple[float, str] | None:
    """Returns the smallest margin, in metres, of all tests with this outcome, and the name of that test."""
    found = record.query(
        "SELECT margin, cell, number FROM tests WHERE outcome = ? AND margin IS NOT NULL "
        "ORDER BY margin, cell, number LIMIT 1",
        (outcome,),
    )
    return (found[0][0], f"test {found[0][1]}/{found[0][2]}") if found else None


def _driven(of: Status | CellStatus) -> tuple[int, int]:
    """Returns the number of roads on which the car failed, and the number of all driven roads."""
    failed = of.outcomes.get("FAIL", 0)
    return failed, failed + of.outcomes.get("PASS", 0)


def _failing(of: CellStatus) -> float:
    failed, driven = _driven(of)
    return failed / driven if driven else 0.0


def _outcomes(record: Record, status: Status, cells: Sequence[CellStatus], is_paired: bool) -> list[Block]:
    seconds = dict(record.query("SELECT name, seconds FROM cells"))
    names = driver_names(each.driver for each in status.cells)
    differing, note = _what_differs(status.cells, names)
    rows: list[list[TableCell]] = []
    for each in status.cells:
        failed, driven = _driven(each)
        about = _about(each, names)
        invalid, errors = (each.outcomes.get(name, 0) for name in ("INVALID", "ERROR"))
        rows.append(
            row(
                each.name,
                *(about[head] for head in differing),
                each.done,
                invalid,
                errors,
                *share_cells(failed, driven)[:3],
                interval_cell(wilson(failed, driven)) if driven else None,
                decimal(each.least_margin),
                decimal(seconds.get(each.name), 0),
            )
        )
    heads = ["cell", *differing, "tests", "invalid", "error", "failed", "driven", "share", "Wilson 95 %",
             "nearest when kept, m", "s"]  # fmt: skip
    blocks: list[Block] = [Table("outcomes", "Outcomes, cell by cell", heads, rows, note)]
    if len(cells) > 1 and not is_paired:  # its test is for roads that are not the same
        found = chi_squared([[failed, driven - failed] for failed, driven in map(_driven, cells)])
        blocks.append(
            f"Do cells differ in how many roads fail? χ² = {found.statistic:.2f} with {found.freedom} "
            f"degrees of freedom, {p_value(found.p)}, Cramér's V = {found.cramers_v:.2f}."
            + ("" if found.is_sound or not found.freedom else " Expected counts are small.")
        )
    if len(cells) > 1:
        blocks.append(_forest(cells[:MOST_CELLS], names))
    beside = [linked(name, name) for name in TABLES if (record.folder / name).is_file()]
    if beside:
        between = " and " if len(beside) > 1 else ""
        blocks.append(["Every test stands in ", beside[0], between, *beside[1:], "."])
    return blocks


def _about(of: CellStatus, names: Mapping[str, str]) -> dict[str, str]:
    """Returns the settings of a cell as texts; the keys are the headings of a table. ``names`` has a name for
    each driver."""
    return {
        "description": of.words or "roads that were given",
        "generator": of.generator,
        "driver": names[of.driver],
        "oracle": of.oracle,
        "seed": str(of.seed),
        "friction": f"{of.friction:g}",
    }


def _what_differs(cells: Sequence[CellStatus], names: Mapping[str, str]) -> tuple[list[str], str]:
    """Returns the headings of settings that differ between cells, and a sentence with all other settings."""
    every = [_about(each, names) for each in cells]
    differing = [head for head in every[0] if len({about[head] for about in every}) > 1]
    same = [
        f"{head} “{text}”" if head == "description" else f"{head} {text}"
        for head, text in every[0].items()
        if head not in differing
    ]
    whose = "In all cells: " if len(cells) > 1 else f"{cells[0].name}: "
    return differing, whose + ", ".join(same) + "." if same else ""


def _forest(cells: Sequence[CellStatus], names: Mapping[str, str]) -> Figure:
    groups = []
    for each in cells:
        failed, driven = _driven(each)
        if driven:
            share = drawn_share(0, failed, driven, f"{failed:,} of {driven:,}")
            groups.append((f"{each.name} · {each.generator} · {names[each.driver]}", [share]))
    caption = "Share of driven roads on which the car failed, with Wilson's 95 % intervals."
    return Figure("failed", caption, forest(groups, ["failed"], caption))


def _card(command: str, record: Record, status: Status) -> dict[str, str]:
    recorded = (record.versions(driver) for driver in {each.driver: None for each in status.cells})
    versions = (", ".join(f"{name} {its}" for name, its in each.items()) for each in recorded)
    seeds = sorted({each.seed for each in status.cells})
    return {
        **({"command": command} if command else {}),
        "seeds": ", ".join(map(str, seeds[:20])),
        "tests": f"{status.done:,}",
        "language models": f"{status.tokens:,} tokens, {status.cost_usd:.4f} USD"
        if status.tokens
        else "none",
        "versions": "; ".join(dict.fromkeys(versions)),
    }
