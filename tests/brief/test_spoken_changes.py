"""Changes in words: what messages say of a plan that a reader wrote."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.change import read_request
from roadgpt.brief.change.plan import MEASURES, read_change_plan
from roadgpt.brief.change.spoken import spoken
from roadgpt.brief.readers.model import ChangeReading, ModelReader
from roadgpt.errors import EditError
from tables import rows

SAID = rows(__file__, "said")


@pytest.mark.parametrize(("plan", "words"), SAID)
def test_a_change_is_said_in_words(plan: str, words: str) -> None:
    assert [change.words for change in spoken(read_change_plan(plan)).changes] == [words]


@pytest.mark.parametrize(
    ("plan", "others", "said"),
    [
        ("!contradiction sides", (), "contradicts itself about left and right; leave one of the wishes out"),
        ("!contradiction", (), "'wider' contradicts itself; leave one of the wishes out"),
        ("!impossible loop", (), "cannot be done: a closed loop, or a road that crosses itself; leave that"),
        ("!impossible", (), "cannot be done: no road can be like that; leave that out"),
        ("!unclear", ("turn 1: remove",), '--plan "turn 1: remove"'),
        ("!unclear", (), "does not say what is to change where; say for example"),
        ("!nonsense", (), "'wider' is no change of a road that I know; say for example"),
    ],
)
def test_a_refused_request_is_told_why(
    plan: str, others: tuple[str, ...], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    read = lambda _self, _words, _key: ChangeReading(plan, 0.9, (), others)  # noqa: E731
    monkeypatch.setattr(ModelReader, "read_change", read)
    with pytest.raises(EditError, match=re.escape(said)):
        read_request("wider")


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
