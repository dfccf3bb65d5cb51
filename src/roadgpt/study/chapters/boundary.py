"""Makes the section on the boundary between passing and failing: pairs of similar roads of which one
passed its test and one failed."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from roadgpt.campaign.boundary_pairs import BoundaryPair, pairs_of, weightiest
from roadgpt.campaign.cell_status import CellStatus
from roadgpt.campaign.model import Result
from roadgpt.campaign.record import Record
from roadgpt.design.elements import elements_of
from roadgpt.report.page import Block, Table, TableCell, cell
from roadgpt.study.chapters.campaign_tests import again
from roadgpt.study.chapters.wording import decimal, row

MOST = 1000  # tests of all cells in which pairs are searched; tests half-way between two others come first
NAMED = 30  # pairs that are shown for a campaign with one cell
FEW = 10  # pairs that are shown per cell for a campaign with several cells
NEAR = (
    "tests.number IN (SELECT number FROM tests JOIN details USING (cell, number) WHERE tests.cell = ? "
    "AND outcome IN ('PASS', 'FAIL') ORDER BY origin LIKE 'between %' DESC, number DESC LIMIT ?)"
)
EXPLAINED = (
    "Distance: the root of the summed squares of all differences, where 10 m of a straight, 2 m of a radius "
    "or a clothoid, 10 degrees of a turn and 1 % of a grade are 1 each. Each road stands in one pair."
)


class Side(NamedTuple):
    """Two similar roads from one campaign cell (one combination of prompt, designer, driver and so on), with
    their test results: ``kept`` is the test that passed, ``lost`` the test that failed."""

    cell: str
    pair: BoundaryPair
    kept: Result
    lost: Result


def nearest(record: Record, cells: Sequence[CellStatus]) -> list[Side]:
    """Returns the pairs of roads that differ least: up to 30 if there is one campaign cell, else up to 10 per
    cell. The test on one road of a pair passed, that on the other failed; ``campaign.boundary_pairs``
    measures the difference."""
    out = []
    for each in cells:
        some = (each.name, MOST // len(cells))
        results = {result.number: result for result in record.results(each.name, NEAR, some)}
        for pair in pairs_of([*results.values()])[: NAMED if len(cells) == 1 else FEW]:
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
    names = [f"{pairs[0].cell}/{number}" for number in (pairs[0].pair.kept, pairs[0].pair.lost)]
    note = f"{EXPLAINED} To see a pair: {shlex.join(['roadgpt', 'drive', '--again', str(folder), *names])}"
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
