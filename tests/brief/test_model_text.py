"""Before and after the network: numbers taken out of text, plans cut into tokens, the grammar of plans."""

from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from random_plans import random_plan
from roadgpt.brief import model
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model import vocabulary
from roadgpt.brief.readers.model.numerals import spell
from roadgpt.brief.readers.model.slots import NumberSlot, slotted
from roadgpt.brief.readers.model.vocabulary import TOKENS, plan_of, tokens_of
from roadgpt.brief.readers.model.wordpiece import WordPieces
from roadgpt.errors import BriefError


@pytest.mark.parametrize(
    ("number", "language", "said"),
    [
        (21, "en", "twenty-one"), (350, "en", "three hundred and fifty"), (45, "de", "fünfundvierzig"),
        (120, "de", "hundertzwanzig"), (71, "fr", "soixante et onze"), (80, "fr", "quatre-vingts"),
        (91, "fr", "quatre-vingt-onze"), (35, "es", "treinta y cinco"), (500, "es", "quinientos"),
        (28, "it", "ventotto"), (200, "it", "duecento"), (1500, "it", "millecinquecento"),
    ],
)  # fmt: skip
def test_numbers_are_spelled_as_in_a_dictionary(number: int, language: str, said: str) -> None:
    assert spell(number, language) == said


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("300 ft", [(91.4, "metres")]), ("half a mile", [(804.7, "metres")]),
        ("a climb of 1:8", [(12.5, "percent")]),
        ("one in ten", [(10.0, "percent")]), ("0.25 km", [(250.0, "metres")]),
        ("1,500 m", [(1500.0, "metres")]),
        ("12,5 %", [(12.5, "percent")]), ("ninety degrees", [(90.0, "degrees")]), ("R30", [(30.0, "")]),
        ("40 to 60 metres", [(40.0, "metres"), (60.0, "metres")]), ("dreihundert Meter", [(300.0, "metres")]),
        ("soixante mètres", [(60.0, "metres")]), ("medio kilómetro", [(500.0, "metres")]),
        ("dieci per cento", [(10.0, "percent")]), ("fifty yards", [(45.7, "metres")]),
        ("70 km/h", [(70.0, "kmh")]),
        ("50 m / left R30 / 2 km / h", [(50.0, "metres"), (30.0, ""), (2.0, "kmh")]),
        ("12 m/s", [(12.0, "kmh")]),
        ("Distances in feet: 250 straight, 3 bends, 250 straight", [(76.2, "metres"), (76.2, "metres")]),
        ("in metres and degrees: 100, L 30", [(100.0, ""), (30.0, "")]),
        ("lengths in yards; 50 m, then 40", [(50.0, "metres"), (40.0, "")]),
        ("3 turns, the 2nd left", []), ("once over the top", []), ("très serré", []),
        ("cent mètres", [(100.0, "metres")]), ("a cien metros, T", [(100.0, "metres")]),
        ("fra cento metri", [(100.0, "metres")]), ("mille mètres", [(1000.0, "metres")]),
        ("due to rain", []), ("not a cent", []), ("ten per cent", [(10.0, "percent")]),
    ],
)  # fmt: skip
def test_numbers_become_slots_in_metres_percent_and_degrees(
    text: str, values: list[tuple[float, str]]
) -> None:
    assert [(slot.value, slot.unit) for slot in slotted(text).slots] == values


@pytest.mark.parametrize(
    ("text", "seen"),
    [
        ("Three bends", "3 bends"), ("half a dozen bends", "6 bends"),
        ("une demi-douzaine de virages", "6 virages"),
        ("sechs Kurven", "6 kurven"), ("60 m", "[unused1] metres"),
        ("a 40 % climb", "a [unused1] percent [unused21] climb"),
    ],
)  # fmt: skip
def test_small_counts_stay_visible(text: str, seen: str) -> None:
    assert slotted(text).text == seen


@given(st.text(max_size=300))
def test_any_text_can_be_slotted(text: str) -> None:
    found = slotted(text)
    assert len(found.slots) <= 12


@pytest.mark.parametrize(
    "line",
    [
        "turn x3 left; straight len=91.4 | up", "| turns=1.. ends(straight up)",
        "turn deg=15..30; dip | climb=-8",
        "hairpin x2..5 right sharp r=25.. | hard steepest=..8", "!nonsense",
    ],
)  # fmt: skip
def test_tokens_write_the_plan_that_they_were_cut_from(line: str) -> None:
    slots = [
        NumberSlot(91.4, "metres"),
        NumberSlot(25.0, "metres"),
        NumberSlot(8.0, "percent"),
        NumberSlot(8.0, "metres"),
    ]
    tokens = tokens_of(line, slots)
    assert tokens is not None
    assert {*tokens} <= {*TOKENS}
    assert plan_of(tokens, slots) == line


def test_a_number_that_nobody_said_has_no_token() -> None:
    assert tokens_of("straight len=77", [NumberSlot(60.0, "metres")]) is None


@given(st.integers(0, 10_000), st.lists(st.floats(1, 900).map(lambda x: round(x, 1)), max_size=4))
def test_whatever_the_grammar_allows_is_a_brief(seed: int, values: list[float]) -> None:
    line = random_plan(seed, values)
    if line and not line.startswith("!"):
        try:
            brief = read_plan(line)
        except BriefError as error:
            if "'halfway' in a plan needs" not in str(error):
                raise
            return
        assert plan(brief) == line or "halfway" in line or "d=" in line
        assert read_plan(plan(brief)) == brief
        assert plan(normal(brief))


def test_word_pieces_are_the_longest_that_fit() -> None:
    pieces = WordPieces(["[PAD]", "[UNK]", "[CLS]", "[SEP]", "hair", "##pin", "##p", "##in", "road"])
    assert pieces.encode(["hairpin", "road", "xyz"]) == ([2, 4, 5, 8, 1, 3], [-1, 0, 0, 1, 2, -1])


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (vocabulary.KINDS, model.Kind),
        (vocabulary.SIDES, model.Side),
        (vocabulary.SHARPNESS, model.Sharpness),
        (vocabulary.SIZES, model.Size),
        (vocabulary.SLOPES, model.Slope),
    ],
)
def test_the_network_has_a_word_for_whatever_a_brief_can_say(words: list[str], meant: object) -> None:
    assert sorted(words) == sorted(get_args(meant))


def test_a_radius_does_not_take_the_unit_of_what_follows() -> None:
    found = slotted("left (R 40, 60 deg), then 30 to 50 degrees")
    assert [(slot.value, slot.unit) for slot in found.slots] == [
        (40, ""),
        (60, "degrees"),
        (30, "degrees"),
        (50, "degrees"),
    ]


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("curve 1: fifty-five degrees", [(55.0, "degrees")]),
        ("the final one: eighty-five degrees", [(85.0, "degrees")]),
        ("one in twenty-five", [(4.0, "percent")]),
        ("le 4e de 50°", [(50.0, "degrees")]),
        ("la 2.ª de 40 grados", [(40.0, "degrees")]),
        ("a hump of 80 cm", [(0.8, "metres")]),
        ("un dosso di 120 centimetri", [(1.2, "metres")]),
    ],
)
def test_ordinals_and_figures_in_words_are_no_other_numbers(text: str, read: list[tuple[float, str]]) -> None:
    assert [(slot.value, slot.unit) for slot in slotted(text).slots] == read
