"""The table of words, as data and as a page."""

from pathlib import Path
from typing import get_args

from roadgpt.brief.words import FEATURE, KINDS, ROAD, SHARPNESS, SIZES, SLOPES
from roadgpt.language.names import Kind, Sharpness, Size, Slope
from roadgpt.language.table import SURFACES

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "words.md"


def test_the_page_says_what_the_words_mean() -> None:
    """Each row of the page has the names and the numbers of its word."""
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in PAGE.read_text("utf-8").splitlines()]
    cells = {row[0]: row[1:] for row in rows if row}
    for meaning in (*KINDS.values(), *SHARPNESS.values()):
        turns = str(meaning.turns or "-") + (", alternating" if meaning.alternating else "")
        numbers = [turns, str(meaning.degrees or "-"), str(meaning.radius or "-")]
        of_straight = [str(meaning.degrees or "-"), str(meaning.length or "-")]
        assert cells[", ".join(meaning.names)] == (of_straight if meaning.length else numbers)
    for meaning in SLOPES.values():
        assert cells[", ".join(meaning.names)] == [str(meaning.grade)]
    for meaning in SIZES.values():
        assert cells[", ".join(meaning.names)] == ["-", str(meaning.length)]
    for name, surface in SURFACES.items():
        assert cells[name][0] == f"{surface.friction:g}"
    for quantity in (*FEATURE.values(), *(row for row in ROAD.values() if row.said)):
        assert any(
            key.endswith(f": {quantity.asked.format('N')}") and quantity.tolerance in cells[key]
            for key in cells
        )


def test_every_word_of_a_brief_has_a_meaning() -> None:
    assert set(KINDS) == set(get_args(Kind))
    assert set(SHARPNESS) == set(get_args(Sharpness))
    assert set(SIZES) == set(get_args(Size))
    assert set(SLOPES) == set(get_args(Slope))


def test_aims_lie_within_promises() -> None:
    for meaning in (*KINDS.values(), *SHARPNESS.values()):
        if meaning.aim and meaning.degrees:
            assert meaning.degrees.lo <= meaning.aim.lo < meaning.aim.hi <= meaning.degrees.hi
