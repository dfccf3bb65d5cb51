"""Makes the sections on the tests of a campaign: failures, margins and feature maps. SQL queries count the
tests in the campaign's database."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from roadgpt.campaign.behaviour import BOUNDS
from roadgpt.campaign.boundary_pairs import BoundaryPair, pairs_of, weightiest
from roadgpt.campaign.model import Result
from roadgpt.campaign.record import Record
from roadgpt.campaign.status import CellStatus
from roadgpt.design.elements import elements_of
from roadgpt.errors import command_line
from roadgpt.report.page.lines import bars, lines
from roadgpt.report.page.model import Block, Figure, Table, TableCell, cell
from roadgpt.study.chapters.roads import CELLS, MAPS, feature_map
from roadgpt.study.chapters.wording import decimal, percent, row

NAMED = 30  # failures, and pairs of roads of a campaign with one cell, that are shown one by one
STEPS = 200  # of a curve
SAMPLE = 100_000  # tests whose features are read, evenly spread
MARGINS = (-2.0, 2.0, 0.1)  # m: from, to, width of a bar; what lies beyond is in the outermost
MOST_SEARCHED = (
    1000  # tests of all cells in which pairs are searched; tests half-way between two others come first
)
FEW_PAIRS = 10  # pairs that are shown per cell for a campaign with several cells
NEAR = (
    "tests.number IN (SELECT number FROM tests JOIN details USING (cell, number) WHERE tests.cell = ? "
    "AND outcome IN ('PASS', 'FAIL') ORDER BY origin LIKE 'between %' DESC, number DESC LIMIT ?)"
)
EXPLAINED = (
    "Distance: the root of the summed squares of all differences, where 10 m of a straight, 2 m of a radius "
    "or a clothoid, 10 degrees of a turn and 1 % of a grade are 1 each. Each road stands in one pair."
)


def failures(
    folder: Path, record: Record, cells: Sequence[CellStatus], drives_on: bool = False
) -> list[Block]:
    """Returns a chart of failures over the number of tests, one line for each of ``cells``, a table of
    causes, and a table of individual failures.

    The last table lists the worst failures if cars drive on after they have left their lane. Otherwise, no
    failure is worse than another, and the table lists the first failures.
    """
    blocks: list[Block] = [_curves(record, cells), _causes(record, drives_on)]
    order = "margin IS NULL, margin, cell, number" if drives_on else "cell, number"
    some = record.query(
        "SELECT cell, number, margin, max_oob, cause, side, at_s, description FROM "  # noqa: S608 - our words
        f"(SELECT * FROM tests WHERE outcome = 'FAIL' ORDER BY {order} LIMIT ?) JOIN details "
        f"USING (cell, number) ORDER BY {order}",
        (NAMED,),
    )
    rows = [
        row(
            cell(f"{name}/{number}", href=again(folder, name, number)),
            *_how_far(margin, outside, drives_on),
            cause or "",
            side or "",
            decimal(at_s, 0),
            says or "",
        )
        for name, number, margin, outside, cause, side, at_s, says in some
    ]
    if rows:
        note = f"To see one: {command_line('view', f'{folder}/{rows[0][0].value}')}"
        heads = ["test", *_far_heads(drives_on), "cause", "side", "at, m", "what happened"]
        ((every,),) = record.query("SELECT count(*) FROM tests WHERE outcome = 'FAIL'")
        blocks.append(Table("failures", _caption(len(rows), every, drives_on), heads, rows, note))
    return blocks


def _caption(shown: int, every: int, drives_on: bool) -> str:
    """Returns the caption of a table of failures that shows only some of them."""
    if every == 1:
        return "The one failure"
    if shown == every:
        return f"All {every} failures" + (", the worst first" if drives_on else "")
    return (
        f"The {shown} worst of {every:,} failures"
        if drives_on
        else f"The first {shown} of {every:,} failures"
    )


def again(folder: Path, name: str, number: int) -> str:
    """Returns the path of the picture of a test that was driven a second time with ``roadgpt drive
    --again``; empty if there is no such picture."""
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
    """Returns the cells under ``_far_heads``.

    They show the largest share of the car outside its lane and, if cars drive on after leaving their lane,
    how many metres the car was beyond the limit. If a drive ends where the car leaves its lane, this distance
    is at most a few centimetres and says nothing.
    """
    share = cell(None) if outside is None else cell(round(outside, 4), percent(outside, 0))
    far = None if margin is None or margin >= 0 else -margin
    return [share, *([decimal(far)] if drives_on else [])]


def _causes(record: Record, drives_on: bool) -> Table:
    found = record.query(
        "SELECT cause, side, count(*), min(margin), max(max_oob) FROM tests WHERE outcome = 'FAIL' "
        "GROUP BY 1, 2 ORDER BY 3 DESC, 1, 2"
    )
    rows = [
        row(cause or "other", side or "–", count, *_how_far(least, outside, drives_on))
        for cause, side, count, least, outside in found
    ]
    return Table("causes", "How the car failed", ["cause", "side", "tests", *_far_heads(drives_on)], rows)


def margins(record: Record, drives_on: bool = False) -> Figure:
    """Returns a histogram of the margins of all tests, in metres. A margin is the smallest sideways shift
    that would have made the car fail; it is negative if the car left its lane or fell."""
    low, high, width = MARGINS
    n = round((high - low) / width)
    found: Mapping[int, int] = dict(
        record.query(
            "SELECT CAST((max(min(margin, ?), ?) - ?) / ? AS INTEGER), count(*) FROM tests "
            "WHERE margin IS NOT NULL GROUP BY 1",
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
    """Returns feature maps of all tests, or of every n-th test if more than 100,000 are done; empty if the
    tests have no features. ``done`` is the number of tests that are done."""
    known = {*record.feature_names()}
    every = max(1, -(-done // SAMPLE))
    part = f" of every {every:,}th test" if every > 1 else ""
    blocks: list[Block] = []
    for pair in MAPS:
        if {*pair} <= known:
            caption = f"Tests{part} by {pair[0]} and {pair[1]}: {{}} are filled."
            blocks += feature_map("map", _map(record, *pair, every), pair, BOUNDS, "tests", caption)
    return blocks


def _map(record: Record, across: str, upwards: str, every: int) -> NDArray[np.float64]:
    """Returns the number of tests in each cell of a map ``(CELLS, CELLS)``, counted by the database."""
    (x0, x1), (y0, y1) = BOUNDS[across], BOUNDS[upwards]
    rows = record.query(
        "SELECT CAST((x - ?) * ? AS INTEGER), CAST((y - ?) * ? AS INTEGER), count(*) FROM "
        "(SELECT json_extract(features, ?) AS x, json_extract(features, ?) AS y FROM details "
        "WHERE number % ? = 0 AND features IS NOT NULL) WHERE x IS NOT NULL AND y IS NOT NULL GROUP BY 1, 2",
        (x0, CELLS / (x1 - x0), y0, CELLS / (y1 - y0), f"$.{across}", f"$.{upwards}", every),
    )
    out = np.zeros((CELLS, CELLS))
    for column, line, count in rows:
        out[min(max(line, 0), CELLS - 1), min(max(column, 0), CELLS - 1)] += count
    return out


class Side(NamedTuple):
    """Two similar roads from one campaign cell (one combination of prompt, designer, driver and so on), with
    their test results: ``kept`` is the test that passed, ``lost`` the test that failed."""

    cell: str
    pair: BoundaryPair
    kept: Result
    lost: Result


def nearest(record: Record, cells: Sequence[CellStatus]) -> list[Side]:
    """Returns the pairs of a road with a passed test and a road with a failed test that differ least: up to
    30 pairs for one campaign cell, otherwise up to 10 pairs per cell. ``campaign.boundary_pairs`` measures
    the difference."""
    out = []
    for each in cells:
        some = (each.name, MOST_SEARCHED // len(cells))
        results = {result.number: result for result in record.results(each.name, NEAR, some)}
        for pair in pairs_of([*results.values()])[: NAMED if len(cells) == 1 else FEW_PAIRS]:
            out.append(Side(each.name, pair, results[pair.kept], results[pair.lost]))
    return out


def nearest_sentence(pairs: Sequence[Side]) -> list[str]:
    """Returns a sentence for the summary about the pair of roads that differ least; empty if there is no
    pair."""
    if not pairs:
        return []
    best = min(pairs, key=lambda side: side.pair.distance)
    return [
        f"Nearest to each other on either side of the boundary are tests {best.cell}/{best.pair.kept}, where "
        f"the car kept its lane, and {best.cell}/{best.pair.lost}, where it did not: "
        f"their distance, as told below, is {best.pair.distance:.2f}."
    ]


def boundary(folder: Path, pairs: Sequence[Side]) -> list[Block]:
    """Returns a table with one row per pair of roads, which names the largest difference between the two
    roads; empty if there is no pair."""
    if not pairs:
        return []
    rows = [_row(folder, *side) for side in pairs]
    names = [f"{folder}/{pairs[0].cell}/{at}" for at in (pairs[0].pair.kept, pairs[0].pair.lost)]
    note = f"{EXPLAINED} To see a pair: {command_line('view', *names)}"
    heads = ["kept", "margin, m", "lost", "at, m", "distance", "what differs most, kept then lost"]
    return [Table("pairs", "Nearest pairs of a road that was kept and one that was lost", heads, rows, note)]


def _row(folder: Path, name: str, pair: BoundaryPair, kept: Result, lost: Result) -> list[TableCell]:
    assert kept.plain_design is not None
    assert lost.plain_design is not None
    return row(
        cell(f"{name}/{pair.kept}", href=again(folder, name, pair.kept)),
        decimal(kept.margin),
        cell(f"{name}/{pair.lost}", href=again(folder, name, pair.lost)),
        decimal(lost.at_s, 0),
        decimal(pair.distance),
        weightiest(elements_of(kept.plain_design.segments), elements_of(lost.plain_design.segments)),
    )
