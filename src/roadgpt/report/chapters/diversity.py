"""Makes the section on diversity: how much roads differ within one description, and between two
descriptions."""

from collections.abc import Sequence
from itertools import combinations, product

import numpy as np

from roadgpt.plural import plural
from roadgpt.report.chapters.wording import decimal, row
from roadgpt.report.page.charts import AxisRange, heat, is_map
from roadgpt.report.page.model import Block, Details, Figure, Section, Table, TableCell, cell, linked
from roadgpt.report.road_record import StudyPartRecord
from roadgpt.report.similarity import similarity

MOST_BETWEEN = 40  # roads of a study part that are compared with those of another part
MOST_NAMED = 50
MOST_DRAWN = 30  # parts whose distances are drawn


def diversity(parts: Sequence[StudyPartRecord]) -> Section:
    """Returns the section on diversity: how much the roads of one description differ, which of them are
    near duplicates, and how much the roads of different descriptions differ."""
    blocks: list[Block] = [
        "Two plans are superimposed by the best shift, turn and mirroring and compared at equal "
        "shares of their lengths. Their distance is the root mean square in metres. Near duplicates are "
        "pairs less than 5.5 m and 2 percentage points of grade apart with the same number of turns. "
        "Similarity, from 0 to 1, is the mean of number, sequence and direction of turns, length, incline "
        "and shape.",
    ]
    blocks += [table for table in (_within(parts), _between(parts)) if table.rows]
    twins = _twins(parts)
    if twins:
        blocks.append(Details(f"Near duplicates ({plural(len(twins), 'pair')})", twins[:MOST_NAMED]))
    else:
        blocks.append("There are no near duplicates.")
    shown: list[Block] = [picture for part in parts[:MOST_DRAWN] if (picture := _matrix(part)) is not None]
    blocks += shown[:1]
    if shown[1:]:
        blocks.append(Details(f"Distances of the other prompts ({len(shown) - 1})", shown[1:]))
    return Section("Diversity", blocks)


def _within(parts: Sequence[StudyPartRecord]) -> Table:
    rows = []
    for part in parts:
        roads, own = part.compared, part.spread
        if len(roads) < 2:
            continue
        nearest = own.nearest
        i = int(np.argmin(nearest))
        j = int(np.nanargmin(own.metres[i]))
        rows.append(
            row(
                cell(part.words, href=part.overview),
                part.designer,
                len(roads),
                decimal(float(nearest.min()), 1, part.href(roads[i])),
                cell(f"{roads[i].index} and {roads[j].index}", href=part.href(roads[j])),
                decimal(float(np.median(nearest)), 1),
                len(own.duplicates),
                decimal(own.general),
                decimal(own.sparseness, 1),
            )
        )
    heads = [
        "prompt", "made by", "roads", "nearest pair, m", "which", "nearest, median, m", "near duplicates",
        "mean similarity", "sparseness",
    ]  # fmt: skip
    note = (
        "Sparseness is the SBFT competition's weighted Levenshtein distance to the road that differs most, "
        "computed for whole roads in steps of 5 m; theirs is for 60 m around failures, in steps of 1 m."
    )
    return Table("diversity", "Roads of the same description", heads, rows, note)


def _between(parts: Sequence[StudyPartRecord]) -> Table:
    rows: list[list[TableCell]] = []
    for designer in dict.fromkeys(part.designer for part in parts):
        own = [part for part in parts if part.designer == designer and part.roads][:6]
        for one, other in combinations(own, 2):
            compared = product(one.likenesses[:MOST_BETWEEN], other.likenesses[:MOST_BETWEEN])
            found = [similarity(*pair, mirror=True) for pair in compared]
            general = decimal(float(np.mean([each.general for each in found])) if found else None)
            nearest = decimal(min((each.metres for each in found), default=None), 1)
            duplicates = sum(each.is_duplicate for each in found)
            rows.append(row(one.words, other.words, designer, general, nearest, duplicates))
    heads = ["prompt", "and", "made by", "mean similarity", "nearest pair, m", "near duplicates"]
    note = f"The first {MOST_BETWEEN} roads of either, each with each."
    return Table("diversity-between", "Roads of different descriptions", heads, rows, note)


def _twins(parts: Sequence[StudyPartRecord]) -> list[Block]:
    return [
        [
            f"{part.part.name}: roads ",
            linked(str(part.compared[i].index), part.href(part.compared[i])),
            " and ",
            linked(str(part.compared[j].index), part.href(part.compared[j])),
            f", {part.spread.metres[i, j]:.1f} m apart",
        ]
        for part in parts
        for i, j in part.spread.duplicates
    ]


def _matrix(part: StudyPartRecord) -> Figure | None:
    n = len(part.compared)
    lower = np.where(np.tri(n, k=-1, dtype=bool), part.spread.metres, np.nan)
    if n < 3 or not is_map(lower):
        return None
    axis = AxisRange("road", 0.5, n + 0.5, is_count=True)
    caption = (
        f"{part.designer}, “{part.words}”: distance between every two roads, metres; "
        "the fainter, the more similar."
    )
    return Figure(f"distances-{part.part.number}", caption, heat(lower, axis, axis, "metres", caption, True))
