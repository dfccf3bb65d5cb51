"""Numbers written in words in five languages, and measures with fractions and decimals in words."""

from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.readers.model.number_words import LANGUAGES, begins_number, numbers_in_words, plain
from roadgpt.brief.readers.model.slots import slotted
from roadgpt_training.spelling import spell


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
