"""The chapter of reports on boundary pairs: similar roads on either side of the boundary of failure."""

from collections.abc import Iterator, Sequence

from roadgpt.campaign.model import Result
from roadgpt.campaign.record import Record
from roadgpt.design.elements import elements_of
from roadgpt.errors import command_line
from roadgpt.report.chapters import Chapter
from roadgpt.report.chapters.wording import decimal, row
from roadgpt.report.page.model import Section, Table, cell
from roadgpt.report.road_record import file_of
from roadgpt_search.boundary_pairs import BoundaryPair, pairs_of, weightiest

MOST_CELLS = 12  # that are searched
NAMED = 30  # pairs that are shown for a campaign with one cell
MOST_SEARCHED = 1000  # tests of all cells in which pairs are searched, those between two others first
FEW_PAIRS = 10  # pairs that are shown per cell for a campaign with several cells
NEAR = (
    "tests.number IN (SELECT number FROM tests JOIN details USING (cell, number) WHERE tests.cell = ? "
    "AND outcome IN ('PASS', 'FAIL') ORDER BY origin LIKE 'between %' DESC, number DESC LIMIT ?)"
)
EXPLAINED = (
    "Distance: the root of the summed squares of all differences, where 10 m of a straight, 2 m of a radius "
    "or a clothoid, 10 degrees of a turn and 1 % of a grade are 1 each. Each road stands in one pair."
)


def chapter(record: Record) -> Chapter | None:
    """Returns the chapter on the pairs of a passed and a failed test that differ least, in cells that search
    for the boundary; None if there are none."""
    goals = {each.name: each.goal for each in record.cells()}
    begun = [name for name in goals if goals[name] == "boundary" and next(record.results(name), None)]
    pairs = [*_nearest(record, begun[:MOST_CELLS])]
    if not pairs:
        return None
    folder, (name, nearest, *_) = record.folder, min(pairs, key=lambda side: side[1].distance)
    said = (
        f"Nearest to each other on either side of the boundary are tests {name}/{nearest.kept}, where the "
        f"car kept its lane, and {name}/{nearest.lost}, where it did not: their distance, as told below, is "
        f"{nearest.distance:.2f}."
    )
    name, first, *_ = pairs[0]
    view = command_line("view", *(f"{folder}/{name}/{at}" for at in (first.kept, first.lost)))
    rows = [
        row(
            cell(f"{name}/{pair.kept}", href=file_of(folder, name, pair.kept)),
            decimal(kept.margin),
            cell(f"{name}/{pair.lost}", href=file_of(folder, name, pair.lost)),
            decimal(lost.at_s, 0),
            decimal(pair.distance),
            weightiest(*(elements_of(its.plain_design.segments) for its in (kept, lost) if its.plain_design)),
        )
        for name, pair, kept, lost in pairs
    ]
    heads = ["kept", "margin, m", "lost", "at, m", "distance", "what differs most, kept then lost"]
    caption = "Nearest pairs of a road that was kept and one that was lost"
    table = Table("pairs", caption, heads, rows, f"{EXPLAINED} To see a pair: {view}")
    return Chapter(Section("At the boundary", [table]), (said,))


def _nearest(record: Record, cells: Sequence[str]) -> Iterator[tuple[str, BoundaryPair, Result, Result]]:
    """Yields cell, pair, passed and failed test: up to NAMED for one cell, or up to FEW_PAIRS per cell."""
    for name in cells:
        some = (name, MOST_SEARCHED // len(cells))
        results = {result.number: result for result in record.results(name, NEAR, some)}
        for pair in pairs_of([*results.values()])[: NAMED if len(cells) == 1 else FEW_PAIRS]:
            yield name, pair, results[pair.kept], results[pair.lost]
