"""A Brief says itself in a plain sentence, and its normal form is one of a kind."""

import pytest
from hypothesis import given, settings

from roadgpt.brief import Brief, normal, sentence
from roadgpt.brief.plan import read_plan
from strategies import briefs
from tables import rows


@settings(deadline=None)
@given(briefs())
def test_everything_has_a_sentence(brief: Brief) -> None:
    said = sentence(brief)
    assert said.endswith(".")
    assert said[0] == "A"
    assert "None" not in said
    assert "  " not in said


@pytest.mark.parametrize(("one", "other"), rows(__file__, "same"))
def test_same_meaning_same_normal_form(one: str, other: str) -> None:
    assert normal(read_plan(one)) == normal(read_plan(other))


@pytest.mark.parametrize(("one", "other"), rows(__file__, "other"))
def test_other_meaning_other_normal_form(one: str, other: str) -> None:
    assert normal(read_plan(one)) != normal(read_plan(other))
