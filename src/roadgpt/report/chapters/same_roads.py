"""Makes the section that compares drivers on the same roads."""

from collections.abc import Sequence
from hashlib import sha256
from itertools import combinations
from math import nan
from typing import NamedTuple

import numpy as np

from roadgpt.campaign.record import Record
from roadgpt.errors import RoadGPTError, explained
from roadgpt.geometry.curve import Array
from roadgpt.plural import plural
from roadgpt.report.canvas import save_all
from roadgpt.report.chapters import Chapter
from roadgpt.report.chapters.wording import decimal, driver_names, p_value, row
from roadgpt.report.page.maps import embedded_png
from roadgpt.report.page.model import Block, Figure, Section, Table, TableCell
from roadgpt.report.pair import SIZE
from roadgpt.report.pair import pair as side_by_side
from roadgpt.report.statistics import friedman, holm, mcnemar, wilcoxon
from roadgpt.road.world import oracle_in_words
from roadgpt.run.atomic import refuse_links, remove_numbered

PICTURES = "differ"
SHOWN = 3  # roads with a picture
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


def same_roads(record: Record) -> Chapter:
    """Returns the chapter that compares drivers on the same roads; its pictures are also in ``differ``."""
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
    remove_numbered(record.folder / PICTURES)
    spread = np.nan_to_num(np.ptp(failed, axis=1) * 1e6 + np.ptp(margins, axis=1))
    for rank, at in enumerate(np.argsort(-spread, kind="stable")[:SHOWN], 1):
        if spread[at]:
            order = np.lexsort((margins[at], -failed[at]))
            blocks.append(_figure(record, rank, roads[at], names, (int(order[-1]), int(order[0]))))
    return Chapter(Section("Drivers on the same roads", blocks), tuple(compared(record)), True)


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


def _figure(record: Record, rank: int, road: Road, names: Sequence[str], which: tuple[int, int]) -> Figure:
    one, other = (record.run(road[at].cell, road[at].number) for at in which)
    place = record.folder / PICTURES
    with explained(RoadGPTError, f"cannot write into {place}", "make room there"):
        refuse_links(place)
        place.mkdir(exist_ok=True)
        figure = side_by_side(one, other, drivers=(names[which[0]], names[which[1]]))
        png, _ = save_all(figure, place / f"{rank}.png", ("png", "pdf"))
    tests = [f"{names[at]} (test {road[at].cell}/{road[at].number})" for at in which]
    caption = f"The same road, driven by {' and '.join(tests)}: {PICTURES}/{png.name}, .pdf."
    return Figure("differ", caption, embedded_png(png.read_bytes(), *SIZE, caption))
