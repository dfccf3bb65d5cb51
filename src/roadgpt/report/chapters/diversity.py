"""Makes the section on diversity: how much the roads of one description differ."""

from collections.abc import Sequence

import numpy as np

from roadgpt.plural import plural
from roadgpt.report.chapters.wording import decimal, row
from roadgpt.report.page.charts import AxisRange, heat, is_map
from roadgpt.report.page.model import Block, Details, Figure, Section, Table, cell, linked
from roadgpt.report.road_record import RoadGroup

MOST_NAMED = 50  # pairs
MOST_DRAWN = 30  # parts whose distances are drawn


def diversity(parts: Sequence[RoadGroup], between: Sequence[Table] = ()) -> Section:
    """Returns the section on diversity: how much the roads of one description differ, which of them are
    near duplicates, and the tables ``between`` descriptions."""
    blocks: list[Block] = [
        "Two plans are superimposed by the best shift, turn and mirroring and compared at equal "
        "shares of their lengths. Their distance is the root mean square in metres. Near duplicates are "
        "pairs less than 5.5 m and 2 percentage points of grade apart with the same number of turns. "
        "Similarity, from 0 to 1, is the mean of number, sequence and direction of turns, length, incline "
        "and shape."
    ]
    blocks += [table for table in (_within(parts), *between) if table.rows]
    twins: list[Block] = [
        [
            f"{part.words}: roads ",
            linked(str(part.compared[i].index), part.compared[i].href),
            " and ",
            linked(str(part.compared[j].index), part.compared[j].href),
            f", {part.spread.metres[i, j]:.1f} m apart",
        ]
        for part in parts
        for i, j in part.spread.duplicates
    ]
    if twins:
        blocks.append(Details(f"Near duplicates ({plural(len(twins), 'pair')})", twins[:MOST_NAMED]))
    else:
        blocks.append("There are no near duplicates.")
    shown: list[Block] = [
        picture
        for number, part in enumerate(parts[:MOST_DRAWN], 1)
        if (picture := _matrix(number, part)) is not None
    ]
    blocks += shown[:1]
    if shown[1:]:
        blocks.append(Details(f"Distances of the other prompts ({len(shown) - 1})", shown[1:]))
    return Section("Diversity", blocks)


def _within(parts: Sequence[RoadGroup]) -> Table:
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
                decimal(float(nearest.min()), 1, roads[i].href),
                cell(f"{roads[i].index} and {roads[j].index}", href=roads[j].href),
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


def _matrix(number: int, part: RoadGroup) -> Figure | None:
    n = len(part.compared)
    lower = np.where(np.tri(n, k=-1, dtype=bool), part.spread.metres, np.nan)
    if n < 3 or not is_map(lower):
        return None
    axis = AxisRange("road", 0.5, n + 0.5, is_count=True)
    caption = (
        f"{part.designer}, “{part.words}”: distance between every two roads, metres; "
        "the fainter, the more similar."
    )
    return Figure(f"distances-{number}", caption, heat(lower, axis, axis, "metres", caption, True))
