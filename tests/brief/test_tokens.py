"""Words and numbers as they are written: decimal marks, thousands, nothing lost."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.brief.grammar.tokens import tokens


@pytest.mark.parametrize(
    ("words", "value"),
    [
        ("a road of 1.250 km", 1.25),
        ("a turn with a radius of 12.500 m", 12.5),
        ("a road of 1,250 m", 1250),
        ("a road of 0,250 km", 0.25),
        ("a road of 1.234.567 m", 1234567),
        ("eine Strasse von 1.250 m", 1250),
        ("eine Kurve mit 17,500 m Radius", 17.5),
        ("una carretera de 1.250 m", 1250),
        ("une route de 1,250 km", 1.25),
        ("a road of 1.25 km", 1.25),
        ("eine Strasse von 1,25 km", 1.25),
    ],
)
def test_three_digits_behind_a_mark_are_a_thousand_where_the_language_says_so(
    words: str, value: float
) -> None:
    assert [token.value for token in tokens(words) if token.sort == "number"] == [value]


@given(st.text(max_size=60))
@settings(max_examples=300)
def test_tokens_are_as_they_were_written_and_in_order(text: str) -> None:
    at = 0
    for token in tokens(text):
        at = text.index(token.raw, at)
        assert token.raw
