"""Changes in words: what messages say of a plan that a reader wrote."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.change.plan import MEASURES, read_change_plan
from roadgpt.brief.change.spoken import spoken
from roadgpt.errors import EditError
from tables import rows

SAID = rows(__file__, "said")


@pytest.mark.parametrize(("plan", "words"), SAID)
def test_a_change_is_said_in_words(plan: str, words: str) -> None:
    assert [change.words for change in spoken(read_change_plan(plan)).changes] == [words]


PLACES = st.sampled_from(
    ["turn 2", "turn all", "hairpin", "straight -1", "road", "end len=80", "turn left gentle"]
)
WISHES = st.sampled_from(
    [
        "slope more", "slope up", "remove", "straighten", "side other", "shape hairpin", "swap =turn 3",
        "reverse",
    ]
    + [f"{name} {value}" for name in MEASURES[:3] for value in ("=30", "..30", "-5", "x2", "less", "=turn 1")]
)  # fmt: skip


@given(PLACES, WISHES)
def test_no_syntax_of_plans_is_said(place: str, wish: str) -> None:
    try:
        request = spoken(read_change_plan(f"{place}: {wish}"))
    except EditError:
        return  # this place has no such value
    for change in request.changes:
        said = [change.words, *(each.words for each in (change.target, change.like) if each)]
        assert not set("=:_;") & set("".join(said))
        assert ".." not in "".join(said)
