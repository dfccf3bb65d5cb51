"""Writes the report of a campaign. SQL queries count the tests in the campaign's database, so that a
report on a million tests needs little memory."""

from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from hashlib import sha256
from itertools import combinations
from math import nan
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.campaign.columns import bounds_of_columns, told_of
from roadgpt.campaign.folder_record import kept_run
from roadgpt.campaign.record import Record, reading_store
from roadgpt.campaign.status import CellStatus, Status, no_failure, status_of
from roadgpt.errors import RoadGPTError, command_line, explained
from roadgpt.plural import plural
from roadgpt.reading import json_of
from roadgpt.report.canvas import save_all
from roadgpt.report.chapters import with_chapters
from roadgpt.report.chapters.roads import CELLS, MAPS, feature_map
from roadgpt.report.chapters.validity import outside_sentences, outside_table, passed_tests
from roadgpt.report.chapters.wording import (
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
from roadgpt.report.page import write
from roadgpt.report.page.charts import bars, forest, lines
from roadgpt.report.page.maps import chart, tag
from roadgpt.report.page.model import Block, Figure, Page, Section, Table, TableCell, cell, linked
from roadgpt.report.pair import SIZE
from roadgpt.report.pair import pair as side_by_side
from roadgpt.report.statistics import Array, chi_squared, friedman, holm, mcnemar, wilcoxon, wilson
from roadgpt.road.world import oracle_in_words
from roadgpt.run import Request
from roadgpt.run.atomic import refuse_links, remove_numbered

MOST_CELLS = 12  # whose curves and shares are drawn
TABLES = ("results.csv", "cells.csv")
NAMED = 30  # failures, and pairs of roads of a campaign with one cell, that are shown one by one
STEPS = 200  # of a curve
SAMPLE = 100_000  # tests whose features are read, evenly spread
MARGINS = (-2.0, 2.0, 0.1)  # m: from, to, width of a bar; what lies beyond is in the outermost


def write_store_report(folder: Path, command: str = "") -> Path:
    """Writes the report of a campaign into its folder and returns the path of the HTML page. It shows
    ``command``, which repeats the campaign."""
    status = status_of(folder)
    with Record.opened(folder) as record:
        page = _page(folder, record, status, command)
    return write(page, folder)


def _page(folder: Path, record: Record, status: Status, command: str) -> Page:
    first, is_paired = record.cell(record.names()[0]).request, record.plan().paired
    goes_on = first.setup.keep_driving  # whether cars drive on after they have left their lane
    fields = [c for c in status.cells if c.done]
    words = list(dict.fromkeys(c.words for c in status.cells if c.words))
    title = words[0] if len(words) == 1 else f"A campaign of {plural(len(status.cells), 'cell')}"
    lead = f"{status.done:,} tests in {plural(len(status.cells), 'cell')}"
    lead += "" if status.is_finished else "; the campaign is unfinished"
    covered = coverage(record, status.done)
    sections = [Section("Feature map", covered)] if covered else []
    sections.append(Section("Outcomes", _outcomes(record, status, fields, is_paired)))
    if status.scenarios:
        heads, *rows = status.scenario_table
        note = "Refused is what cannot happen on its road; results.csv has the parameters of each test."
        table = Table("scenarios", "Outcomes by scenario", heads, [row(*each) for each in rows], note)
        sections.append(Section("Scenarios", [table]))
    if any(_driven(each)[1] for each in fields):
        sections.append(Section("Failures", failures(folder, record, fields[:MOST_CELLS], goes_on)))
        near: list[Block] = [*outside_table(passed_tests(record)), margins(record, goes_on)]
        sections.append(Section("How near to failing", near))
    failed, driven = _driven(status)
    summary = no_failure(status.outcomes) or ["No road failed."] if driven and not failed else []
    summary += _summary(record, first, status, fields)
    sections, summary = with_chapters(record, sections, summary)
    if is_paired:
        sections, summary = [same_roads(folder, record), *sections], [*compared(record), *summary]
    return Page(title, summary, sections, _card(command, record, status), lead)


def _summary(record: Record, first: Request, status: Status, cells: Sequence[CellStatus]) -> list[str]:
    counts, (failed, driven) = status.outcomes, _driven(status)
    told = ", ".join(f"{number:,} {outcome}" for outcome, number in sorted(counts.items()))
    out = [f"{status.done:,} tests: {told or 'nothing yet'}."]
    if apart := counts.get("UNAVOIDABLE", 0):
        out.append(f"{plural(apart, 'collision')} no careful driver could have avoided: counted apart.")
    if untested := counts.get("NOT TESTED", 0):
        out.append(
            f"{plural(untested, 'test')} NOT TESTED: the driver was not as fast as the scene prescribes."
        )
    if driven:
        out.append(f"The car failed on {share_of(failed, driven)} of the roads that were driven.")
        if other := sum(cell.handed_over for cell in status.cells):
            out.append(f"On {other:,} of them the driver had handed over: they are not its failures.")
        best = max(cells, key=_failing)
        if failed and len(cells) > 1:
            out.append(f"Most fail in {best.name}: {percent(_failing(best))} of its driven roads.")
        out += outside_sentences(passed_tests(record), first.world)
        farthest = _least(record, "FAIL") if first.setup.keep_driving else None
        out += near_and_far(_least(record, "PASS"), farthest)
    out += [sentence for each in cells if (sentence := each.remark)]
    out += [f"Left out: {each}." for each in record.plan().left_out.values()]
    wrong = counts.get("INVALID", 0) + counts.get("ERROR", 0)
    out.append(f"Of all tests {share_of(wrong, status.done)} were invalid or ended in an error.")
    if status.seconds:
        out.append(f"It took {status.seconds:,.0f} s, {status.done / status.seconds:.1f} tests a second.")
    return out


def _least(record: Record, outcome: str) -> tuple[float, str] | None:
    found = record.query(
        "SELECT margin, cell, number FROM tests WHERE outcome = ? AND margin IS NOT NULL "
        "ORDER BY margin, cell, number LIMIT 1",
        (outcome,),
    )
    return (found[0][0], f"test {found[0][1]}/{found[0][2]}") if found else None


def _driven(of: Status | CellStatus) -> tuple[int, int]:
    """Returns the number of roads on which the car failed, and of all driven roads."""
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
    return {
        "description": of.about,
        "generator": of.generator,
        "driver": names[of.driver],
        "oracle": of.oracle,
        "seed": str(of.seed),
        "friction": "of each road" if of.friction is None else f"{of.friction:g}",
    }


def _what_differs(cells: Sequence[CellStatus], names: Mapping[str, str]) -> tuple[list[str], str]:
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
    spent = f"{status.tokens:,} tokens, {status.cost_usd:.4f} USD" if status.tokens else "none"
    return {
        **({"command": command} if command else {}),
        "seeds": ", ".join(map(str, seeds[:20])),
        "tests": f"{status.done:,}",
        "language models": spent,
        "versions": "; ".join(dict.fromkeys(versions)),
    }


def failures(
    folder: Path, record: Record, cells: Sequence[CellStatus], drives_on: bool = False
) -> list[Block]:
    """Returns a chart of failures over the number of tests, one line for each of ``cells``, a table of
    causes, and one of failures: the worst if cars drive on after they have left their lane, or the first."""
    blocks: list[Block] = [_curves(record, cells), *_causes(record, drives_on)]
    order = "margin IS NULL, margin, cell, number" if drives_on else "cell, number"
    some = record.query(
        "SELECT cell, number, margin, max_oob, cause, side, at_s, description, features FROM "  # noqa: S608 - ours
        f"(SELECT * FROM tests WHERE outcome = 'FAIL' ORDER BY {order} LIMIT ?) JOIN details "
        f"USING (cell, number) ORDER BY {order}",
        (NAMED,),
    )
    with reading_store(record.path):
        numbers = [{its.key: its.value for its in told_of(json_of(found))} for *_, found in some]
    keys = [*dict.fromkeys(key for own in numbers for key in own)]
    rows = [
        row(
            cell(f"{name}/{number}", href=again(folder, name, number)),
            *_how_far(margin, outside, drives_on),
            cause or "",
            side or "",
            decimal(at_s, 0),
            *(decimal(own.get(key)) for key in keys),
            says or "",
        )
        for (name, number, margin, outside, cause, side, at_s, says, _), own in zip(
            some, numbers, strict=True
        )
    ]
    if rows:
        note = f"To see one: {command_line('view', f'{folder}/{rows[0][0].value}')}"
        heads = ["test", *_far_heads(drives_on), "cause", "side", "at, m", *keys, "what happened"]
        ((every,),) = record.query("SELECT count(*) FROM tests WHERE outcome = 'FAIL'")
        blocks.append(Table("failures", _caption(len(rows), every, drives_on), heads, rows, note))
    return blocks


def _caption(shown: int, every: int, drives_on: bool) -> str:
    if every == 1:
        return "The one failure"
    if shown == every:
        return f"All {every} failures" + (", the worst first" if drives_on else "")
    which = f"{shown} worst" if drives_on else f"first {shown}"
    return f"The {which} of {every:,} failures"


def again(folder: Path, name: str, number: int) -> str:
    """Returns the path of the picture of a test that was driven again; empty if there is none."""
    place = f"again/{name}/runs/{number:04d}/birds_eye.png"
    return place if (folder / place).is_file() else ""


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


def _far_heads(drives_on: bool) -> list[str]:
    return ["outside at most", *(["farthest out, m"] if drives_on else [])]


def _how_far(margin: float | None, outside: float | None, drives_on: bool) -> list[TableCell]:
    share = cell(None) if outside is None else cell(round(outside, 4), percent(outside, 0))
    far = None if margin is None or margin >= 0 else -margin
    return [share, *([decimal(far)] if drives_on else [])]


def _causes(record: Record, drives_on: bool) -> Iterator[Table]:
    found = record.query(
        "SELECT cause, side, count(*), min(margin), max(max_oob) FROM tests WHERE outcome = 'FAIL' "
        "GROUP BY 1, 2 ORDER BY 3 DESC, 1, 2"
    )
    rows = [
        row(cause or "other", side or "–", count, *_how_far(least, outside, drives_on))
        for cause, side, count, least, outside in found
    ]
    if rows:
        yield Table("causes", "How the car failed", ["cause", "side", "tests", *_far_heads(drives_on)], rows)


def margins(record: Record, drives_on: bool = False) -> Figure:
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


def coverage(record: Record, done: int) -> list[Block]:
    """Returns feature maps of all tests, or of every n-th test if more than SAMPLE are done."""
    known = {*record.feature_names()}
    every = max(1, -(-done // SAMPLE))
    part = f" of every {every:,}th test" if every > 1 else ""
    blocks, bounds = list[Block](), bounds_of_columns()
    for pair in MAPS:
        if {*pair} <= known:
            caption = f"Tests{part} by {pair[0]} and {pair[1]}: {{}} are filled."
            counts = _map(record, pair, bounds, every)
            blocks += feature_map("map", counts, pair, bounds, "tests", caption)
    return blocks


def _map(
    record: Record, pair: tuple[str, str], bounds: Mapping[str, tuple[float, float]], every: int
) -> NDArray[np.float64]:
    (x0, x1), (y0, y1) = (bounds[axis] for axis in pair)
    rows = record.query(
        "SELECT CAST((x - ?) * ? AS INTEGER), CAST((y - ?) * ? AS INTEGER), count(*) FROM "
        "(SELECT json_extract(features, ?) AS x, json_extract(features, ?) AS y FROM details "
        "WHERE number % ? = 0 AND features IS NOT NULL) WHERE x IS NOT NULL AND y IS NOT NULL GROUP BY 1, 2",
        (x0, CELLS / (x1 - x0), y0, CELLS / (y1 - y0), *(f"$.{axis}" for axis in pair), every),
    )
    out = np.zeros((CELLS, CELLS))
    for column, line, count in rows:
        out[min(max(line, 0), CELLS - 1), min(max(column, 0), CELLS - 1)] += count
    return out


PICTURES = "differ"
SHOWN = 3  # roads with a picture
WIDE, HIGH = (90 * inches for inches in SIZE)  # px of a picture on the page
FAILED = {"PASS": 0.0, "FAIL": 1.0}
HEADS = (
    "A", "B", "roads", "A failed", "B failed", "only A", "only B", "McNemar p", "median of A - B, m", "r",
    "Wilcoxon p",
)  # fmt: skip
NOTE = (
    "McNemar's exact test compares failures, Wilcoxon's signed-rank test margins; both p are corrected for "
    "the number of pairs (Holm). r: matched-pairs rank-biserial correlation, positive if A is farther from "
    "failing."
)
CLAMPED = " Drives end where the car leaves its lane, so the margin of every failure counts as 0."


class DrivenTest(NamedTuple):
    """The test of one driver on one road."""

    cell: str
    number: int
    outcome: str
    margin: float | None
    seed: int
    design: str  # the road's design as stored; empty if there is none


Road = Sequence[DrivenTest]
"""The tests on one road, in the order of the drivers."""


def same_roads(folder: Path, record: Record) -> Section:
    """Returns the section that compares drivers on the same roads, with pictures that are also in
    ``differ``."""
    first = record.cells()[0].request
    names, roads, failed, _ = _roads(record)
    margins = np.array([[one.margin for one in road] for road in roads], float).reshape(failed.shape)
    if not first.setup.keep_driving:
        margins = np.maximum(margins, 0.0)
    how = f"Pairs of drivers on the same {plural(len(roads), 'road')}, in {first.setup.simulator}"
    oracle = oracle_in_words(first.world.limits.oracle)
    note = NOTE + CLAMPED * (not first.setup.keep_driving)
    rows = _pairs(names, failed, margins)
    blocks: list[Block] = [Table("pairs-of-drivers", f"{how}; oracle {oracle}", HEADS, rows, note)]
    remove_numbered(folder / PICTURES)
    spread = np.nan_to_num(np.ptp(failed, axis=1) * 1e6 + np.ptp(margins, axis=1))
    for rank, at in enumerate(np.argsort(-spread, kind="stable")[:SHOWN], 1):
        if spread[at]:
            order = np.lexsort((margins[at], -failed[at]))
            blocks.append(_figure(folder, rank, roads[at], names, (int(order[-1]), int(order[0]))))
    return Section("Drivers on the same roads", blocks)


def _roads(record: Record) -> tuple[list[str], list[Road], Array, int]:
    """Returns the drivers' names; the roads that are the same for all; for each road and driver 1 if the car
    failed, 0 if it passed, NaN if it was not driven; and the number of other roads."""
    cells = {cell.name: cell for cell in record.cells()}
    drivers = [*dict.fromkeys(cell.request.setup.driver for cell in cells.values())]
    found: dict[object, dict[str, DrivenTest]] = {}
    for values in record.stream(
        "SELECT cell, number, outcome, margin, seed, coalesce(design, '') FROM tests "
        "JOIN details USING (cell, number) WHERE outcome IS NOT NULL ORDER BY cell, number"
    ):
        test = DrivenTest(*values)
        request, setup = cells[test.cell].request, cells[test.cell].request.setup
        its = request.words, request.seed, setup.designer, setup.simulator, cells[test.cell].generator
        found.setdefault((its, test.number), {})[setup.driver] = test
    whole: list[Road] = [
        [its[driver] for driver in drivers] for its in found.values() if len(its) == len(drivers)
    ]
    same = [road for road in whole if len({(one.seed, one.design) for one in road}) == 1]
    failed = np.array([[FAILED.get(one.outcome, nan) for one in road] for road in same], float)
    names = [*driver_names(drivers).values()]
    return names, same, failed.reshape(-1, len(names)), len(found) - len(same)


def compared(record: Record) -> list[str]:
    """Returns sentences: on how many roads drivers are compared, and whether they fail equally often."""
    names, roads, failed, left_out = _roads(record)
    designs = sha256("\n".join(road[0].design for road in roads).encode()).hexdigest()
    invalid = sum(road[0].outcome == "INVALID" for road in roads)
    errors = [sum(road[at].outcome == "ERROR" for road in roads) for at in range(len(names))]
    broken = ", ".join(f"{name} on {n:,}" for name, n in zip(names, errors, strict=True) if n) or "no driver"
    other = f"; {plural(left_out, 'other road')} left out, not the same for all or not finished"
    driven = int((~np.isnan(failed)).all(axis=1).sum())
    out = [
        f"{len(names)} drivers got the same {plural(len(roads), 'road')}: equal seeds, and designs equal "
        f"byte for byte (SHA-256 {designs[:16]}){other * bool(left_out)}.",
        f"All of them drove {plural(driven, 'road')}; {invalid:,} invalid; ended in an error: {broken}.",
    ]
    if len(names) > 2:
        found = friedman(failed)
        out.append(
            f"Do the drivers fail equally often? Cochran's Q = {found.statistic:.2f} with {found.freedom} "
            f"degrees of freedom on {plural(found.people, 'road')}, {p_value(found.p)}."
        )
    return out


def _pairs(names: Sequence[str], failed: Array, margins: Array) -> list[list[TableCell]]:
    pairs = [*combinations(range(len(names)), 2)]
    outcomes = [failed[:, pair][~np.isnan(failed[:, pair]).any(axis=1)] for pair in pairs]
    only = [(int((own[:, 0] > own[:, 1]).sum()), int((own[:, 0] < own[:, 1]).sum())) for own in outcomes]
    far = [wilcoxon(margins[:, a], margins[:, b]) for a, b in pairs]
    p, q = holm([mcnemar(*each) for each in only]), holm([each.p for each in far])
    return [
        row(
            names[a], names[b], len(own), *map(int, own.sum(axis=0)), *only[at], decimal(float(p[at]), 4),
            decimal(float(np.nanmedian(margins[:, a] - margins[:, b])) if len(own) else None),
            decimal(far[at].effect), decimal(float(q[at]), 4),
        )
        for at, ((a, b), own) in enumerate(zip(pairs, outcomes, strict=True))
    ]  # fmt: skip


def _figure(folder: Path, rank: int, road: Road, names: Sequence[str], which: tuple[int, int]) -> Figure:
    one, other = (kept_run(folder, road[at].cell, road[at].number) for at in which)
    with explained(RoadGPTError, f"cannot write into {folder / PICTURES}", "make room there"):
        refuse_links(folder / PICTURES)
        (folder / PICTURES).mkdir(exist_ok=True)
        figure = side_by_side(one, other, drivers=(names[which[0]], names[which[1]]))
        png, _ = save_all(figure, folder / PICTURES / f"{rank}.png", ("png", "pdf"))
    tests = [f"{names[at]} (test {road[at].cell}/{road[at].number})" for at in which]
    caption = f"The same road, driven by {' and '.join(tests)}: {PICTURES}/{png.name}, .pdf."
    data = f"data:image/png;base64,{b64encode(png.read_bytes()).decode()}"
    return Figure(
        "differ", caption, chart(WIDE, HIGH, tag("image", href=data, width=WIDE, height=HIGH), caption)
    )
