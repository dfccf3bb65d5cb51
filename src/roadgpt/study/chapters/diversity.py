"""Makes the section on diversity: how different the roads of one description, and of two descriptions,
are."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from roadgpt.report.page import Block, Details, Figure, Section, Table, TableCell, cell, linked
from roadgpt.report.page.heat import AxisRange, heat, is_map
from roadgpt.study.chapters.roads import Compared
from roadgpt.study.chapters.wording import decimal, plural, row
from roadgpt.study.road_record import RoadRecord, StudyPartRecord
from roadgpt.study.similarity import Likeness, Spread, between, spread

MOST = 150  # roads of a part that are compared, each with every other
MOST_BETWEEN = 40  # of a part that are compared with those of another one
MOST_NAMED = 50
MOST_DRAWN = 30  # parts whose distances are drawn


def spread_of(part: StudyPartRecord) -> Compared:
    """Returns the roads of a part that are compared, 150 at most, and how different they are."""
    roads = [road for road in part.roads if road.likeness is not None][:MOST]
    return roads, spread([road.likeness for road in roads if road.likeness is not None])


def diversity(parts: Sequence[StudyPartRecord], found: Sequence[Compared]) -> Section:
    """Returns the section: differences within every part, near duplicates, and differences between
    descriptions."""
    blocks: list[Block] = [
        "Two plans are superimposed by the best shift, turn and mirroring and compared at equal "
        "shares of their lengths. Their distance is the root mean square in metres. Near duplicates are "
        "pairs less than 5.5 m and 2 percentage points of grade apart with the same number of turns. "
        "Similarity, from 0 to 1, is the mean of number, sequence and direction of turns, length, incline "
        "and shape.",
    ]
    blocks += [table for table in (_within(parts, found), _between(parts)) if table.rows]
    twins = _twins(parts, found)
    if twins:
        blocks.append(Details(f"Near duplicates ({plural(len(twins), 'pair')})", twins[:MOST_NAMED]))
    else:
        blocks.append("There are no near duplicates.")
    pictures = [_matrix(part, *own) for part, own in list(zip(parts, found, strict=True))[:MOST_DRAWN]]
    shown: list[Block] = [picture for picture in pictures if picture is not None]
    blocks += shown[:1]
    if shown[1:]:
        blocks.append(Details(f"Distances of the other prompts ({len(shown) - 1})", shown[1:]))
    return Section("Diversity", blocks)


def _within(parts: Sequence[StudyPartRecord], found: Sequence[Compared]) -> Table:
    rows = []
    for part, (roads, own) in zip(parts, found, strict=True):
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


def _some(part: StudyPartRecord) -> list[Likeness]:
    return [road.likeness for road in part.roads if road.likeness is not None][:MOST_BETWEEN]


def _between(parts: Sequence[StudyPartRecord]) -> Table:
    """Returns a table of pairs of prompts of one designer, limited to a readable number."""
    rows: list[list[TableCell]] = []
    for designer in dict.fromkeys(part.designer for part in parts):
        own = [part for part in parts if part.designer == designer and part.roads][:6]
        for one, other in combinations(own, 2):
            found = between(_some(one), _some(other))
            numbers = row(decimal(found.general), decimal(found.metres, 1), found.duplicates)
            rows.append(row(one.words, other.words, designer, *numbers))
    heads = ["prompt", "and", "made by", "mean similarity", "nearest pair, m", "near duplicates"]
    note = f"The first {MOST_BETWEEN} roads of either, each with each."
    return Table("diversity-between", "Roads of different descriptions", heads, rows, note)


def _twins(parts: Sequence[StudyPartRecord], found: Sequence[Compared]) -> list[Block]:
    return [
        [
            f"{part.part.name}: roads ",
            linked(str(roads[i].index), part.href(roads[i])),
            " and ",
            linked(str(roads[j].index), part.href(roads[j])),
            f", {own.metres[i, j]:.1f} m apart",
        ]
        for part, (roads, own) in zip(parts, found, strict=True)
        for i, j in own.duplicates
    ]


def _matrix(part: StudyPartRecord, roads: list[RoadRecord], own: Spread) -> Figure | None:
    if len(roads) < 3:
        return None
    lower = np.where(np.tri(len(roads), k=-1, dtype=bool), own.metres, np.nan)
    if not is_map(lower):
        return None
    axis = AxisRange("road", 0.5, len(roads) + 0.5, is_count=True)
    caption = (
        f"{part.designer}, “{part.words}”: distance between every two roads, metres; "
        "the fainter, the more similar."
    )
    return Figure(f"distances-{part.part.number}", caption, heat(lower, axis, axis, "metres", caption, True))
