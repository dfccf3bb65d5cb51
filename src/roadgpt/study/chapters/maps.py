"""Makes the sections with pictures: all roads, and the feature maps that they cover."""

from collections.abc import Sequence

import numpy as np

from roadgpt.report.page import Block, Figure, Section
from roadgpt.report.page.gallery import Thumbnail, gallery
from roadgpt.report.page.heat import AxisRange, heat, is_map
from roadgpt.study.road_record import RoadRecord, StudyPartRecord

CELLS = 25  # along each side of a map
MOST, MOST_PARTS = 100, 30  # roads in a picture, and pictures
MAPS = (
    ("MAX_CURV", "largest curvature, 1/m", 0.0, 0.07, "DIR_COV", "share of directions", 0.0, 1.0),
    (
        "STD_SA",
        "steering, standard deviation, degrees",
        0.0,
        200.0,
        "MEAN_LP",
        "mean distance to the lane's edge, m",
        0.0,
        2.5,
    ),
)
CALLED = {name: label for row in MAPS for name, label in (row[:2], row[4:6])}
"""Labels of features, with their units."""


def coverage(parts: Sequence[StudyPartRecord]) -> Section | None:
    """Returns feature maps of all roads together, by designer; None if no road has features."""
    blocks: list[Block] = []
    for designer in dict.fromkeys(part.part.designer for part in parts):
        roads = [road for part in parts if part.part.designer == designer for road in part.roads]
        for places in MAPS:
            figure = _map(designer, roads, places)
            blocks += [figure] if figure is not None else []
    if not blocks:
        return None
    says = "Cells of the competition's features that valid roads fall into; the stronger, the more roads."
    return Section("Coverage", [says, *blocks])


def _map(
    designer: str, roads: Sequence[RoadRecord], places: tuple[str, str, float, float, str, str, float, float]
) -> Figure | None:
    across, across_name, x0, x1, upwards, upwards_name, y0, y1 = places
    found = [(r.features[across], r.features[upwards]) for r in roads if {across, upwards} <= {*r.features}]
    if not found:
        return None
    values = np.clip(np.array(found), [x0, y0], [x1, y1])
    counts, _, _ = np.histogram2d(values[:, 1], values[:, 0], CELLS, ((y0, y1), (x0, x1)))
    if not is_map(counts):
        return None
    filled = int(np.count_nonzero(counts))
    caption = f"{designer}: {len(found)} roads in {filled} of {CELLS * CELLS} cells ({across}, {upwards})."
    picture = heat(counts, AxisRange(across_name, x0, x1), AxisRange(upwards_name, y0, y1), "roads", caption)
    return Figure(f"coverage-{across.lower()}", caption, picture)


def road_thumbnail(part: StudyPartRecord, road: RoadRecord) -> Thumbnail:
    """Returns one road as a small map that links to its run."""
    failed_at = road.failed_at if road.has_left else None
    return Thumbnail(road.index, road.outcome, road.points, failed_at, part.href(road), road.max_oob)


def roads(parts: Sequence[StudyPartRecord], size: float) -> Section:
    """Returns every road as a small map that links to its run."""
    blocks: list[Block] = [
        "A dot is where a road starts, a cross where the car left it; “62 %” is a PASS with so much of "
        "the car outside its lane. Each leads to its bird's-eye view; "
        "roadgpt view shows it in 3-D with its drive."
    ]
    for part in parts[:MOST_PARTS]:
        if not part.roads:
            continue
        shown = [road_thumbnail(part, road) for road in part.roads[:MOST]]
        more = f" The first {MOST} of {len(part.roads)}." if len(part.roads) > MOST else ""
        caption = f"{part.part.designer}, “{part.part.prompt.prompt}”.{more}"
        blocks.append(Figure(f"roads-{part.part.number}", caption, gallery(shown, size, caption)))
    return Section("Roads", blocks)
