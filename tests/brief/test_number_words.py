"""Numbers in words of five languages, as the network reads them; and what the grammar of plans allows."""

from math import degrees

import pytest
from hypothesis import given
from hypothesis import strategies as st

from random_plans import random_plan
from roadgpt.brief import reader_of
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.brief.readers.model.neural_network import WordPieces
from roadgpt.brief.readers.model.number_words import LANGUAGES, begins_number, numbers_in_words, plain
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.errors import BriefError
from roadgpt_training.spelling import spell
from tables import rows


@given(st.integers(2, 9999), st.sampled_from(LANGUAGES))
def test_numbers_begin_with_words_that_begin_numbers(number: int, language: str) -> None:
    assert begins_number(plain(spell(number, language)).replace("-", " ").split()[0])


def test_other_words_begin_no_number() -> None:
    assert not any(map(begins_number, ("road", "links", "virage", "curva", "and", "und", "hairpin")))


@given(st.integers(2, 9999), st.sampled_from(LANGUAGES))
def test_every_number_that_is_spelled_is_read_back(number: int, language: str) -> None:
    key = tuple(plain(spell(number, language)).replace("-", " ").split())
    assert numbers_in_words(key)[language] == number


def test_a_numbered_point_is_no_decimal() -> None:
    text = slotted("point one a dip point two a left of radius thirty point three a right")
    assert 30.0 in [each.value for each in text.slots]


@given(st.integers(2, 9), st.integers(1, 8), st.sampled_from(["± {}", "plus or minus {}", "give or take {}"]))
def test_any_tolerance_below_the_count(count: int, off: int, sign: str) -> None:
    if off < count:
        text = slotted(f"{count} turns {sign.format(off)}").text
        assert text == f"{count - off} to {count + off} turns"


@pytest.mark.parametrize("text", rows(__file__, "slope_degrees_tangent"))
@pytest.mark.parametrize("angle", [3, 5, 8])
def test_a_slope_in_degrees_is_the_tangent_in_percent(text: str, angle: int) -> None:
    from scipy.special import tandg

    (slot,) = slotted(text.format(angle)).slots
    assert slot.unit == "percent"
    assert slot.value == pytest.approx(100 * float(tandg(angle)), abs=0.051)
    assert degrees(slot.value / 100) == pytest.approx(angle, abs=0.1)  # for small angles both are alike


def test_a_negative_number_of_turns_is_refused_with_its_words() -> None:
    with pytest.raises(BriefError, match="'minus four bends'"):
        reader_of("model").read("I need a road with minus four bends, please.")


@pytest.mark.parametrize(
    "text", ["two million bends", "Bend left by a million degrees", "ochocientas horquillas"]
)
def test_absurd_numbers_in_words_are_refused(text: str) -> None:
    with pytest.raises(BriefError):
        reader_of("model").read(text)


@pytest.mark.parametrize(("number", "language", "said"), rows(__file__, "numbers_spelled_dictionary"))
def test_numbers_are_spelled_as_in_a_dictionary(number: int, language: str, said: str) -> None:
    assert spell(number, language) == said


@given(st.text(max_size=300))
def test_any_text_can_be_slotted(text: str) -> None:
    found = slotted(text)
    assert len(found.slots) <= 12


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
        # "climb=3" comes back as "up climb=3"
        assert plan(brief) == line or any(each in line for each in ("halfway", "d=", "climb="))
        assert read_plan(plan(brief)) == brief
        assert plan(normal(brief))


def test_word_pieces_are_the_longest_that_fit() -> None:
    pieces = WordPieces(["[PAD]", "[UNK]", "[CLS]", "[SEP]", "hair", "##pin", "##p", "##in", "road"])
    assert pieces.encode(["hairpin", "road", "xyz"]) == [[2, 4, 5, 8, 1, 3]]


@pytest.mark.parametrize(
    ("words", "unit", "value"),
    [
        ("at 20 metres per second", "kmh", 72),
        ("mit 25 Meter pro Sekunde", "kmh", 90),
        ("à 10 mètres par seconde", "kmh", 36),
        ("a 20 metros por segundo", "kmh", 72),
        ("a 15 metri al secondo", "kmh", 54),
        ("mit 80 Kilometer pro Stunde", "kmh", 80),
        ("with 6 metres per second squared", "mps2", 6),
        ("with 2 meters per second per second", "mps2", 2),
        ("turns of 40 m per side", "metres", 40),
    ],
)
def test_speeds_in_words_are_no_lengths(words: str, unit: str, value: float) -> None:
    (slot,) = slotted(words).slots
    assert (slot.unit, slot.value) == (unit, value)
