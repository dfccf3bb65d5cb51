"""What comes first: how many roads, how varied, how often the car left its lane; and three pictures."""

from collections.abc import Sequence

import numpy as np

from roadgpt.report.page import Cards, FigureCard, Line, Section, Table, TableCell, cell
from roadgpt.report.page.gallery import gallery
from roadgpt.study.chapters.alignment import kept
from roadgpt.study.chapters.maps import small
from roadgpt.study.chapters.saying import decimal, plural
from roadgpt.study.looking import Looked, LookedPart
from roadgpt.study.similarity import Spread

SHOWN = 3  # pictures
SIDE = 3  # roads along each side of a picture

Found = tuple[list[Looked], Spread]


def glance(parts: Sequence[LookedPart], found: Sequence[Found], size: float) -> Section | None:
    """Three pictures of roads and one line for each description; None where there are no roads.

    Args:
        parts: what was made, description by description.
        found: of each, how different its roads are.
        size: side of the map, metres.
    """
    made = [(part, own) for part, own in zip(parts, found, strict=True) if part.roads]
    if not made:
        return None
    cards = [_card(part, size) for part, _ in made[:SHOWN]]
    return Section("At a glance", [Cards(cards), _table(made)])


def _card(part: LookedPart, size: float) -> FigureCard:
    """Some roads of a description: all that the car left, as far as there is room, then the first ones."""
    first = sorted(part.roads, key=lambda road: (not road.has_left, road.index))[: SIDE * SIDE]
    chosen = sorted(first, key=lambda road: road.index)
    words = part.part.prompt.prompt
    label = f"{plural(len(chosen), 'road')} of “{words}”"
    picture = gallery([small(part, road) for road in chosen], size, label, SIDE)
    left = part.count("has_left")
    driven = part.count("is_driven")
    said = f"The car left its lane on {left} of {driven}." if driven else "Nobody drove them."
    lines: list[Line] = [f"{plural(len(part.roads), 'road')} by {part.part.designer}. {said}"]
    return FigureCard(words, picture, lines)


def _table(made: Sequence[tuple[LookedPart, Found]]) -> Table:
    heads = [
        "description", "made by", "roads", "valid", "keep every word", "driven", "left the lane",
        "nearest two plans, m", "near duplicates",
    ]  # fmt: skip
    rows = [_row(part, own) for part, own in made]
    note = (
        "Nearest two plans: root mean square distance of the two roads most alike, after the best shift, "
        "turn and mirroring. The sections below hold intervals, tests and every road."
    )
    return Table("glance", "Roads by description", heads, rows, note)


def _row(part: LookedPart, found: Found) -> list[TableCell]:
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
