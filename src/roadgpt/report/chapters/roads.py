"""Makes the sections that show roads: the overview at the start of a report, thumbnails of roads, and
feature maps."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from roadgpt.plural import plural
from roadgpt.report.chapters.wording import decimal, row
from roadgpt.report.overview import Thumbnail
from roadgpt.report.page.charts import AxisRange, heat, is_map
from roadgpt.report.page.maps import gallery
from roadgpt.report.page.model import (
    Block,
    Cards,
    Figure,
    FigureCard,
    Section,
    Table,
    TableCell,
    cell,
    linked,
)
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
BOUNDS = {"MAX_CURV": (0.0, 0.07), "DIR_COV": (0.0, 1.0), "STD_SA": (0.0, 200.0), "MEAN_LP": (0.0, 2.5)}
"""Smallest and largest value of each feature on the maps of studies; values beyond count at the edge."""


def overview(parts: Sequence[RoadGroup], size: float) -> Section | None:
    """Returns the section at the start of a report: a table of all groups that have roads, and one
    picture with some roads for each of the first three; ``size`` is the side of the square map in metres."""
    made = [part for part in parts if part.roads]
    if not made:
        return None
    heads = [
        "description", "made by", "roads", "valid", "keep every word", "driven", "left the lane",
        "nearest two plans, m", "near duplicates",
    ]  # fmt: skip
    note = (
        "Nearest two plans: root mean square distance of the two most similar roads, after the best shift, "
        "turn and mirroring. The sections below contain intervals, tests and every road."
    )
    table = Table("glance", "Roads by description", heads, [*map(_row, made)], note)
    return Section("At a glance", [Cards([_card(part, size) for part in made[:SHOWN]]), table])


def _card(part: RoadGroup, size: float) -> FigureCard:
    first = sorted(part.roads, key=lambda road: (not road.has_left, road.index))[: SIDE * SIDE]
    chosen = sorted(first, key=lambda road: road.index)
    label = f"{plural(len(chosen), 'road')} of “{part.words}”"
    picture = gallery([_thumbnail(part, road) for road in chosen], size, label, SIDE)
    left, driven = part.count("has_left"), part.count("is_driven")
    said = f"The car left its lane on {left} of {driven}." if driven else "They were not driven."
    return FigureCard(part.words, picture, [f"{plural(len(part.roads), 'road')} by {part.designer}. {said}"])


def _row(part: RoadGroup) -> list[TableCell]:
    good, driven, several = part.kept("general"), part.count("is_driven"), len(part.compared) > 1
    return row(
        cell(part.words, href=part.overview),
        part.designer,
        len(part.roads),
        part.count("is_valid"),
        sum(good) if good else None,
        driven or None,
        part.count("has_left") if driven else None,
        decimal(float(np.min(part.spread.nearest)) if several else None, 1),
        len(part.spread.duplicates) if several else None,
    )


def _thumbnail(part: RoadGroup, road: RoadRecord) -> Thumbnail:
    verdict = road.verdict
    left_at = verdict.at_xy if verdict is not None and road.has_left else None
    max_oob = verdict.max_oob if verdict is not None else None
    return Thumbnail(road.index, road.outcome, road.points, left_at, part.href(road), max_oob)


def every_road(parts: Sequence[RoadGroup], size: float) -> Section:
    """Returns a section with thumbnails of the first roads of the first groups, which link to the roads'
    bird's-eye views; ``size`` is the side of the square map in metres."""
    blocks: list[Block] = [
        "A dot is where a road starts, a cross where the car left it; “62 %” is a PASS with so much of "
        "the car outside its lane. Each leads to its bird's-eye view; "
        "roadgpt view shows it in 3-D with its drive."
    ]
    for part in parts[:MOST_PARTS]:
        if not part.roads:
            continue
        shown = [_thumbnail(part, road) for road in part.roads[:MOST]]
        more = f" The first {MOST} of {len(part.roads)}." if len(part.roads) > MOST else ""
        caption = f"{part.designer}, “{part.words}”.{more}"
        blocks.append(Figure(f"roads-{part.number}", caption, gallery(shown, size, caption)))
    return Section("Roads", blocks)


def named_roads(parts: Sequence[RoadGroup], says: Callable[[RoadRecord], str]) -> list[Block]:
    """Returns a line with a link for each road for which ``says`` returns a sentence."""
    return [
        [linked(f"{part.name}, road {road.index}", part.href(road)), f": {sentence}"]
        for part in parts
        for road in part.roads
        if (sentence := says(road))
    ]


def coverage(parts: Sequence[RoadGroup]) -> Section | None:
    """Returns feature maps of all roads of each designer; None if no road has features."""
    blocks: list[Block] = []
    for designer in dict.fromkeys(part.designer for part in parts):
        roads = [road.features for part in parts if part.designer == designer for road in part.roads]
        for pair in MAPS:
            found = [[features[name] for name in pair] for features in roads if {*pair} <= {*features}]
            if found:
                (x0, x1), (y0, y1) = (BOUNDS[name] for name in pair)
                x, y = np.clip(np.array(found), [x0, y0], [x1, y1]).T
                counts, _, _ = np.histogram2d(y, x, CELLS, ((y0, y1), (x0, x1)))
                lead = f"{designer}: {len(found)} roads in {{}} ({', '.join(pair)})."
                blocks += feature_map("coverage", counts, pair, BOUNDS, "roads", lead)
    if not blocks:
        return None
    says = "Cells of the competition's features that valid roads fall into; the stronger, the more roads."
    return Section("Coverage", [says, *blocks])


def feature_map(
    name: str,
    counts: NDArray[np.float64],
    pair: tuple[str, str],
    bounds: dict[str, tuple[float, float]],
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
