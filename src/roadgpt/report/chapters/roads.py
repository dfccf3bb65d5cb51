"""Makes the sections that show roads: the overview at the start of a report, thumbnails of roads, and
feature maps."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from roadgpt.campaign.columns import bounds_of_columns
from roadgpt.campaign.record import Record
from roadgpt.plural import plural
from roadgpt.report.overview import Thumbnail
from roadgpt.report.page.charts import AxisRange, heat, is_map
from roadgpt.report.page.maps import gallery
from roadgpt.report.page.model import Block, Cards, Figure, FigureCard, Section, Table, linked
from roadgpt.report.road_record import RoadGroup, RoadRecord

SHOWN = 3  # pictures of the first section
SIDE = 3  # roads along each side of such a picture
MOST, MOST_PARTS = 100, 30  # roads in one picture of all roads, and number of such pictures
CELLS = 25  # along each side of a feature map
MAPS = (("MAX_CURV", "DIR_COV"), ("STD_SA", "MEAN_LP"))
"""Pairs of features, each shown as one map: the first along the horizontal axis, the second along the
vertical."""
LABELS = {
    "MAX_CURV": "largest curvature, 1/m",
    "DIR_COV": "share of directions",
    "STD_SA": "steering, standard deviation, degrees",
    "MEAN_LP": "mean distance to the lane's edge, m",
}
SAMPLE = 100_000  # tests whose features are read, evenly spread


def overview(parts: Sequence[RoadGroup], *tables: Table) -> Section:
    """Returns the section at the start of a report: one picture with some roads for each of the first three
    groups that have roads, and ``tables``."""
    made = [part for part in parts if part.roads]
    return Section("At a glance", [Cards([_card(part) for part in made[:SHOWN]]), *tables])


def _card(part: RoadGroup) -> FigureCard:
    first = sorted(part.roads, key=lambda road: (not road.has_left, road.index))[: SIDE * SIDE]
    chosen = sorted(first, key=lambda road: road.index)
    label = f"{plural(len(chosen), 'road')} of “{part.words}”"
    picture = gallery([_thumbnail(road) for road in chosen], part.size, label, SIDE)
    left, driven = part.count("has_left"), part.count("is_driven")
    said = f"The car left its lane on {left} of {driven}." if driven else "They were not driven."
    return FigureCard(part.words, picture, [f"{plural(len(part.roads), 'road')} by {part.designer}. {said}"])


def _thumbnail(road: RoadRecord) -> Thumbnail:
    its = road.result
    return Thumbnail(road.index, its.outcome, road.points, road.failed_at, road.href, its.max_oob)


def every_road(parts: Sequence[RoadGroup]) -> Section:
    """Returns a section with thumbnails of the first roads of the first groups, which link to the roads'
    bird's-eye views."""
    blocks: list[Block] = [
        "A dot is where a road starts, a cross where the car left it; “62 %” is a PASS with so much of "
        "the car outside its lane. Each leads to its bird's-eye view; "
        "roadgpt view shows it in 3-D with its drive."
    ]
    for number, part in enumerate(parts[:MOST_PARTS], 1):
        if not part.roads:
            continue
        shown = [_thumbnail(road) for road in part.roads[:MOST]]
        more = f" The first {MOST} of {len(part.roads)}." if len(part.roads) > MOST else ""
        caption = f"{part.designer}, “{part.words}”.{more}"
        blocks.append(Figure(f"roads-{number}", caption, gallery(shown, part.size, caption)))
    return Section("Roads", blocks)


def named_roads(parts: Sequence[RoadGroup], says: Callable[[RoadRecord], str]) -> list[Block]:
    """Returns a line with a link for each road for which ``says`` returns a sentence."""
    return [
        [linked(part.name_of(road), road.href), f": {sentence}"]
        for part in parts
        for road in part.roads
        if (sentence := says(road))
    ]


def coverage(records: Sequence[Record]) -> Section | None:
    """Returns maps of the features of all tests, or of every n-th if more than SAMPLE are done; None if no
    two of them lie apart."""
    tests = sum(count for record in records for ((count,),) in [record.query("SELECT count(*) FROM details")])
    every, bounds, blocks = max(1, -(-tests // SAMPLE)), bounds_of_columns(), list[Block]()
    part = f" of every {every:,}th test" if every > 1 else ""
    for pair in MAPS:
        counts = sum((_counts(record, pair, bounds, every) for record in records), np.zeros((CELLS, CELLS)))
        caption = f"Tests{part} by {pair[0]} and {pair[1]}: {{}} are filled; the stronger, the more tests."
        blocks += feature_map("coverage", counts, pair, bounds, "tests", caption)
    return Section("Feature map", blocks) if blocks else None


def _counts(
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


def feature_map(
    name: str,
    counts: NDArray[np.float64],
    pair: tuple[str, str],
    bounds: Mapping[str, tuple[float, float]],
    what: str,
    caption: str,
) -> list[Block]:
    """Returns a map of two features as a figure; empty if too few cells of the map are filled.

    Args:
        name: first part of the name of the figure's file.
        counts: number of roads or tests in each map cell, ``(CELLS, CELLS)``; rows are the second feature.
        pair: the features along the horizontal and the vertical axis.
        bounds: smallest and largest value of each feature on the map.
        what: what is counted, such as "roads".
        caption: caption of the figure, in which {} stands for the number of filled cells."""
    if not is_map(counts):
        return []
    caption = caption.format(f"{int(np.count_nonzero(counts))} of {CELLS * CELLS} cells")
    across, upwards = (AxisRange(LABELS[feature], *bounds[feature]) for feature in pair)
    return [Figure(f"{name}-{pair[0].lower()}", caption, heat(counts, across, upwards, what, caption))]
