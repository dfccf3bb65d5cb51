"""Makes the first section of a report: counts, diversity, lane departures, and three pictures."""

from collections.abc import Sequence

import numpy as np

from roadgpt.report.page import Cards, FigureCard, Line, Section, Table, TableCell, cell
from roadgpt.report.page.gallery import gallery
from roadgpt.study.chapters.alignment import kept
from roadgpt.study.chapters.maps import road_thumbnail
from roadgpt.study.chapters.wording import decimal, plural
from roadgpt.study.road_record import RoadRecord, StudyPartRecord
from roadgpt.study.similarity import Spread

SHOWN = 3  # pictures
SIDE = 3  # roads along each side of a picture

Found = tuple[list[RoadRecord], Spread]


def overview(parts: Sequence[StudyPartRecord], found: Sequence[Found], size: float) -> Section | None:
    """Returns three pictures of roads and one table row for each description; None if there are no roads.

    Args:
        parts: the parts of the study.
        found: for each part, the compared roads and how different they are.
        size: side of the map, metres.
    """
    made = [(part, own) for part, own in zip(parts, found, strict=True) if part.roads]
    if not made:
        return None
    cards = [_card(part, size) for part, _ in made[:SHOWN]]
    return Section("At a glance", [Cards(cards), _table(made)])


def _card(part: StudyPartRecord, size: float) -> FigureCard:
    """Returns a picture of up to nine roads: those on which the car left its lane come first."""
    first = sorted(part.roads, key=lambda road: (not road.has_left, road.index))[: SIDE * SIDE]
    chosen = sorted(first, key=lambda road: road.index)
    words = part.part.prompt.prompt
    label = f"{plural(len(chosen), 'road')} of “{words}”"
    picture = gallery([road_thumbnail(part, road) for road in chosen], size, label, SIDE)
    left = part.count("has_left")
    driven = part.count("is_driven")
    said = f"The car left its lane on {left} of {driven}." if driven else "They were not driven."
    lines: list[Line] = [f"{plural(len(part.roads), 'road')} by {part.part.designer}. {said}"]
    return FigureCard(words, picture, lines)


def _table(made: Sequence[tuple[StudyPartRecord, Found]]) -> Table:
    heads = [
        "description", "made by", "roads", "valid", "keep every word", "driven", "left the lane",
        "nearest two plans, m", "near duplicates",
    ]  # fmt: skip
    rows = [_row(part, own) for part, own in made]
    note = (
        "Nearest two plans: root mean square distance of the two most similar roads, after the best shift, "
        "turn and mirroring. The sections below contain intervals, tests and every road."
    )
    return Table("glance", "Roads by description", heads, rows, note)


def _row(part: StudyPartRecord, found: Found) -> list[TableCell]:
    roads, spread = found
    good = kept(part, "general")
    driven = part.count("is_driven")
    nearest = float(np.min(spread.nearest)) if len(roads) > 1 else None
    return [
        cell(part.part.prompt.prompt, href=part.overview),
        cell(part.part.designer),
        cell(len(part.roads)),
        cell(part.count("is_valid")),
        cell(sum(good)) if good else cell(None),
        cell(driven) if driven else cell(None),
        cell(part.count("has_left")) if driven else cell(None),
        decimal(nearest, 1),
        cell(len(spread.duplicates)) if len(roads) > 1 else cell(None),
    ]
