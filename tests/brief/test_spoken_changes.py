"""Changes in words: what messages say of a plan that a reader wrote."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roadgpt.brief.change.parser import MEASURES
from roadgpt.brief.change.plan import read_change_plan
from roadgpt.brief.change.spoken import spoken
from roadgpt.errors import EditError

SAID = [
    ("turn 2: radius x0.75", "the radius of turn 2 times 0.75"),
    ("turn -1: angle +10", "the angle of the last turn 10 degrees more"),
    ("turn 1,2: swap", "turns 1 and 2 swapped"),
    ("straight 1: length =straight 2", "the length of straight 1 that of straight 2"),
    ("turn 2: angle -10 =turn 1", "the angle of turn 2 10 degrees less than that of turn 1"),
    ("turn all but(turn 1): side left", "all turns except turn 1 to the left"),
    ("turn left: x4", "4 left turns"),
    ("turn: x..6", "at most 6 turns"),
    ("start len=60: slope flat", "the first 60 m level"),
    ("road half2: slope steeply_down", "the second half of the road steeply downhill"),
    ("turn 1: at_end", "turn 1 moved to the end"),
    ("turn 2: after(turn 3)", "turn 2 moved after turn 3"),
    ("turn -1,-12: remove", "the last and 12th-last turn removed"),
    ("straight 1: length 40..", "the length of straight 1 at least 40 m"),
    ("turn x2 sharpest: radius much more", "the radius of the 2 sharpest turns much larger"),
    ("add turn x2 left gentle deg=60 at_end", "2 new gentle left turns of 60 degrees at the end"),
    ("add straight len=50 between(turn 1, turn 2)", "a new straight of 50 m between turn 1 and turn 2"),
]


@pytest.mark.parametrize(("plan", "words"), SAID)
def test_a_change_is_said_in_words(plan: str, words: str) -> None:
    assert [change.words for change in spoken(read_change_plan(plan)).changes] == [words]


PLACES = st.sampled_from(
    ["turn 2", "turn all", "hairpin", "straight -1", "road", "end len=80", "turn left gentle"]
)
WISHES = st.sampled_from(
    [
        "slope more",
        "slope up",
        "remove",
        "straighten",
        "side other",
        "shape hairpin",
        "swap =turn 3",
        "reverse",
    ]
    + [f"{name} {value}" for name in MEASURES[:3] for value in ("=30", "..30", "-5", "x2", "less", "=turn 1")]
)


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
