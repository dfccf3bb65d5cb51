"""The one-line language of a Brief, its normal form, and the sentence in which it says itself."""

from contextlib import suppress
from typing import get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roadgpt.brief.model import Brief, Clause, at_least, exactly
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import CLAUSE, plan, read_plan
from roadgpt.brief.sentence import sentence
from roadgpt.errors import BriefError
from roadgpt.language.names import Compass, Kind
from strategies import amounts, briefs, maybe
from tables import rows

shaped = st.builds(
    lambda brief, **more: brief.model_copy(update=more),
    briefs(),
    degrees=maybe(amounts(20, 170)),
    radius=maybe(amounts(12, 90)),
    speed=maybe(st.floats(20, 130).map(lambda kmh: round(kmh, 1)), 6),
    comes_from=maybe(st.sampled_from(get_args(Compass)), 6),
)


@given(shaped)
def test_a_brief_comes_back_from_its_line(brief: Brief) -> None:
    line = plan(brief)
    assert "\n" not in line
    assert read_plan(line) == brief


@given(shaped, st.sampled_from([("country", 80), ("residential", 30)]))
def test_a_kind_of_road_has_a_usual_design_speed_unless_one_is_given(
    brief: Brief, kind: tuple[str, int]
) -> None:
    where, usual = kind
    asked = Brief.model_validate({**brief.model_dump(), "motorway": False, "surroundings": where})
    assert asked.speed == (brief.speed or usual)
    assert read_plan(plan(asked)) == asked
    assert {"country": "country road", "residential": "residential street"}[where] in sentence(asked)


@given(shaped)
def test_any_brief_has_a_normal_form_that_is_its_own(brief: Brief) -> None:
    form = normal(brief)
    assert normal(form) == form


@pytest.mark.parametrize(
    ("line", "brief"),
    [
        ("", Brief()),
        ("| turns=1..", Brief(turns=at_least(1))),
        (
            "turn x3 | up climb=-12.5",
            Brief(clauses=(Clause(kind="turn", count=exactly(3)),), slope="up", climb=exactly(-12.5)),
        ),
        ("| ends(hairpin left)", Brief(ends=Clause(kind="hairpin", side="left"))),
    ],
)
def test_lines_by_hand(line: str, brief: Brief) -> None:
    assert read_plan(line) == brief


@given(st.text(max_size=60))
def test_any_text_is_a_brief_or_a_sentence(line: str) -> None:
    try:
        brief = read_plan(line)
    except BriefError:
        return
    assert read_plan(plan(brief)) == brief


def test_a_misspelt_junction_is_answered_with_the_kinds_of_junctions() -> None:
    with pytest.raises(
        BriefError, match=r"no clause 'crosroads'; .*hairpin.* a junction with one of .*crossroads"
    ):
        read_plan("crosroads left")


@pytest.mark.parametrize(("line", "kept"), rows(__file__, "figure_every_turn"))
def test_a_figure_for_every_turn_is_never_lost(line: str, kept: str) -> None:
    assert plan(normal(read_plan(line))) == kept
    assert normal(normal(read_plan(line))) == normal(read_plan(line))


@settings(deadline=None)
@given(shaped)
def test_everything_has_a_sentence(brief: Brief) -> None:
    said = sentence(brief)
    assert said.endswith(".")
    assert said[0] == "A"
    assert "None" not in said
    assert "  " not in said


@pytest.mark.parametrize("kind", get_args(Kind))
@pytest.mark.parametrize("count", ["", " x3"])
def test_each_word_that_means_something_is_in_the_sentence(kind: str, count: str) -> None:
    without = normal(read_plan(f"{kind}{count}"))
    means_something = 0
    for word in (*CLAUSE.words, "90", "r30", "len=50", "climb=4", "pct=5"):
        with suppress(BriefError):
            brief = normal(read_plan(f"{kind}{count} {word}"))
            means_something += brief != without
            assert (sentence(brief) != sentence(without)) == (brief != without), word
    assert means_something


@pytest.mark.parametrize(("one", "other"), rows(__file__, "same"))
def test_same_meaning_same_normal_form(one: str, other: str) -> None:
    assert normal(read_plan(one)) == normal(read_plan(other))


@pytest.mark.parametrize(("one", "other"), rows(__file__, "other"))
def test_other_meaning_other_normal_form(one: str, other: str) -> None:
    assert normal(read_plan(one)) != normal(read_plan(other))
