"""The one-line language of a Brief."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.model import Amount, Brief, Clause, Kind, Sharpness, Side, Slope, at_least, exactly
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan
from roadgpt.errors import BriefError
from tables import rows

numbers = st.integers(0, 400).map(lambda n: n / 2)
amounts = (
    numbers.map(exactly)
    | numbers.map(at_least)
    | numbers.map(lambda n: Amount(hi=n))
    | st.tuples(numbers, numbers).map(lambda pair: Amount(lo=min(pair), hi=max(pair)))
)


def maybe(strategy: st.SearchStrategy[object]) -> st.SearchStrategy[object]:
    return st.none() | strategy


shared = {
    "alternating": st.booleans(),
    "sharpness": maybe(st.sampled_from(Sharpness.__args__)),
    "degrees": maybe(amounts),
    "radius": maybe(amounts),
    "length": maybe(amounts),
    "slope": maybe(st.sampled_from(Slope.__args__)),
    "incline": maybe(amounts),
}
clauses = st.builds(
    Clause,
    kind=st.sampled_from(Kind.__args__),
    count=amounts,
    side=maybe(st.sampled_from(Side.__args__)),
    size=maybe(st.sampled_from(["long", "short"])),
    **shared,
)
counted = ("turns", "left", "right", "steepest", "climb", "hills")
briefs = st.builds(
    Brief,
    clauses=st.lists(clauses, max_size=4).map(tuple),
    hard=st.booleans(),
    starts=maybe(clauses),
    ends=maybe(clauses),
    **{name: maybe(amounts) for name in counted},
    **shared,
)


@given(briefs)
def test_a_brief_comes_back_from_its_line(brief: Brief) -> None:
    line = plan(brief)
    assert "\n" not in line
    assert read_plan(line) == brief


@given(briefs)
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
        BriefError, match=r"no clause 'crosroads'; .*hairpin.* a junction with one of crossroads"
    ):
        read_plan("crosroads left")


@pytest.mark.parametrize(("line", "kept"), rows(__file__, "figure_every_turn"))
def test_a_figure_for_every_turn_is_never_lost(line: str, kept: str) -> None:
    assert plan(normal(read_plan(line))) == kept
    assert normal(normal(read_plan(line))) == normal(read_plan(line))
