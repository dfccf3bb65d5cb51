"""Numbers written in words in five languages, and measures with fractions and decimals in words."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.readers.model.numerals import LANGUAGES, begins_number, numbers_in_words, plain, spell
from roadgpt.brief.readers.model.slots import slotted

IN_METRES = {
    "{} metres": (
        ("two thousand", 2000), ("twenty-five hundred", 2500), ("two thousand five hundred", 2500),
        ("fifteen hundred", 1500), ("three thousand and twenty", 3020), ("two hundred and three", 203),
        ("one thousand two hundred", 1200), ("a thousand", 1000),
        ("nine thousand nine hundred and ninety-nine", 9999),
        ("seven hundred and eighty-six", 786), ("four thousand and one", 4001), ("ten thousand", 10000),
        ("one and a half thousand", 1500), ("2 thousand", 2000), ("25 hundred", 2500),
    ),
    "{} Meter": (
        ("zweitausend", 2000), ("eintausendzweihundert", 1200), ("zweitausendfünfhundert", 2500),
        ("fünfzehnhundert", 1500), ("dreitausendzwanzig", 3020), ("zweihundertdrei", 203), ("tausend", 1000),
        ("neuntausendneunhundertneunundneunzig", 9999), ("siebenhundertsechsundachtzig", 786),
        ("viertausendeins", 4001), ("zehntausend", 10000), ("zwoelfhundert", 1200), ("zwei tausend", 2000),
        ("eineinhalbtausend", 1500), ("dreitausenddreissig", 3030),
    ),
    "{} mètres": (
        ("deux mille", 2000), ("deux mille cinq cents", 2500), ("quinze cents", 1500),
        ("mille deux cents", 1200),
        ("trois mille vingt", 3020), ("deux cent trois", 203), ("mille", 1000),
        ("neuf mille neuf cent quatre-vingt-dix-neuf", 9999), ("sept cent quatre-vingt-six", 786),
        ("quatre mille un", 4001), ("dix mille", 10000), ("soixante et onze", 71), ("huitante-deux", 82),
        ("deux mille septante", 2070), ("un millier de", 1000),
    ),
    "{} metros": (
        ("dos mil", 2000), ("dos mil quinientos", 2500), ("mil doscientos", 1200), ("tres mil veinte", 3020),
        ("doscientos tres", 203), ("mil", 1000), ("nueve mil novecientos noventa y nueve", 9999),
        ("setecientos ochenta y seis", 786), ("cuatro mil uno", 4001), ("diez mil", 10000),
        ("mil quinientos", 1500), ("treinta y un", 31), ("cien", 100), ("ciento diez", 110),
        ("cinco mil trescientos cuarenta", 5340),
    ),
    "{} metri": (
        ("duemila", 2000), ("duemilacinquecento", 2500), ("milleduecento", 1200), ("tremilaventi", 3020),
        ("duecentotré", 203), ("mille", 1000), ("novemilanovecentonovantanove", 9999),
        ("settecentoottantasei", 786), ("quattromilauno", 4001), ("diecimila", 10000),
        ("millecinquecento", 1500),
        ("mille e cinquecento", 1500), ("centottanta", 180), ("due mila", 2000), ("ventun", 21),
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    ("words", "metres"),
    [(unit.format(words), metres) for unit, rows in IN_METRES.items() for words, metres in rows],
)
def test_numbers_in_words_are_read_as_people_mean_them(words: str, metres: float) -> None:
    assert [each.value for each in slotted(words).slots] == [metres]


@given(st.integers(2, 9999), st.sampled_from(LANGUAGES))
def test_numbers_begin_with_words_that_begin_numbers(number: int, language: str) -> None:
    assert begins_number(plain(spell(number, language)).replace("-", " ").split()[0])


def test_other_words_begin_no_number() -> None:
    assert not any(map(begins_number, ("road", "links", "virage", "curva", "and", "und", "hairpin")))


@given(st.integers(2, 9999), st.sampled_from(LANGUAGES))
def test_every_number_that_is_spelled_is_read_back(number: int, language: str) -> None:
    key = tuple(plain(spell(number, language)).replace("-", " ").split())
    assert numbers_in_words(key)[language] == number


@pytest.mark.parametrize(
    ("words", "metres"),
    [
        ("two and a half kilometres", [2500]), ("two kilometres and a half", [2500]),
        ("three and a quarter kilometres", [3250]), ("two and three quarter miles", [4425.7]),
        ("a mile and a half", [2414.0]), ("two point five kilometres", [2500]),
        ("one point two five km", [1250]),
        ("zweieinhalb Kilometer", [2500]), ("dreieinhalb Kilometer", [3500]),
        ("anderthalb Kilometer", [1500]),
        ("zweieinviertel Kilometer", [2250]), ("dreiviertel Kilometer", [750]),
        ("zwei Komma fünf Kilometer", [2500]),
        ("zwei und eine halbe Meile", [4023.4]), ("un kilomètre et demi", [1500]),
        ("deux kilomètres et demi", [2500]),
        ("deux virgule vingt-cinq kilomètres", [2250]), ("un kilómetro y medio", [1500]),
        ("dos kilómetros y medio", [2500]), ("uno coma cinco kilómetros", [1500]),
        ("un chilometro e mezzo", [1500]),
        ("due chilometri e mezzo", [2500]), ("due virgola cinque chilometri", [2500]),
    ],
)  # fmt: skip
def test_fractions_and_decimals_belong_to_their_measure(words: str, metres: list[float]) -> None:
    assert [each.value for each in slotted(words).slots] == metres


@pytest.mark.parametrize(
    ("words", "metres"),
    [
        ("between one thousand and twelve hundred metres", [1000, 1200]),
        ("between a hundred and two hundred metres", [100, 200]),
        ("zwischen tausend und fünfzehnhundert Metern", [1000, 1500]),
        ("a kilometre and half a mile", [1000, 804.7]), ("two kilometres and a half turn", [2000]),
        ("un kilomètre et demi-tour", [1000]), ("deux kilomètres et un virage", [2000]),
        ("dos kilómetros y media vuelta", [2000]), ("from one point to another", []),
        ("the cents and the mil", []),
    ],
)  # fmt: skip
def test_two_numbers_stay_two_and_other_words_stay_words(words: str, metres: list[float]) -> None:
    assert [each.value for each in slotted(words).slots] == metres


@pytest.mark.parametrize(
    ("words", "read"),
    [
        ("einen neuen Motor", "einen neuen motor"),
        ("my 2 cents", "my 2 cents"),
        ("three-quarters of a km", "[unused1] metres"),
    ],
)
def test_words_that_resemble_numbers_stay(words: str, read: str) -> None:
    assert slotted(words).text == read


def test_a_numbered_point_is_no_decimal() -> None:
    text = slotted("point one a dip point two a left of radius thirty point three a right")
    assert 30.0 in [each.value for each in text.slots]
