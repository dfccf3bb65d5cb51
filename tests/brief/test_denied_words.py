"""Refusals that are due to a denial which contradicts nothing, and those that are real."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.plan import plan
from roadgpt.brief.readers.model.denied_words import without_denials
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.errors import BriefError

MEANINGS = {
    "left": ("left",),
    "right": ("right",),
    "down": ("down",),
    "up": ("up",),
    "rights": ("2", "right"),
}
SIDES, CLIMB = "!contradiction sides", "!contradiction climb"


@pytest.mark.parametrize(
    ("words", "why", "offered", "rest"),
    [
        ("three left, no rights at all", SIDES, ["turn", "x", "3", "left"], "3 left ,"),
        ("up by a bit and never down", CLIMB, ["up", "climb=", "S0"], "up by a bit and"),
        ("not right, but left", SIDES, ["turn", "left"], ", but left"),
        ("never up: it ends lower", CLIMB, ["|", "down", "climb=", "-", "[1]"], ": it ends lower"),
        ("no up in it, two bends", CLIMB, ["turn", "x", "2", "|", "flat"], ", 2 bends"),
    ],
)
def test_a_denial_of_what_is_not_asked_for_is_left_out(
    words: str, why: str, offered: list[str], rest: str
) -> None:
    found = without_denials(slotted(words), why, offered, MEANINGS)
    assert found is not None
    assert found.text == rest


@pytest.mark.parametrize(
    ("words", "why", "offered"),
    [
        ("three left, no left", SIDES, ["turn", "left"]),  # what is denied is asked for
        ("a slalom that never goes left", SIDES, ["slalom"]),  # it goes to both sides
        ("gently up, never up", CLIMB, ["gently_up"]),
        ("hilly, never down", CLIMB, ["|", "hills=", "2"]),
        ("higher by 10 m, never up", CLIMB, ["|", "climb=", "[1]"]),
        ("left and right", SIDES, ["turn", "left"]),  # nothing is denied
        ("left without a wall", SIDES, ["turn", "left"]),  # nothing is denied that a plan could ask for
        ("left, no right", "!contradiction turns", ["turn", "left"]),  # another cause
        ("left, no right", "!contradiction", ["turn", "left"]),  # no cause is named
    ],
)
def test_other_refusals_stay(words: str, why: str, offered: list[str]) -> None:
    assert without_denials(slotted(words), why, offered, MEANINGS) is None


def test_a_road_whose_denial_fits_is_read_with_a_doubt() -> None:
    brief = read("Bitte eine ebene Strecke ohne Rechtskurven, dafür mit drei Linkskurven.")
    assert plan(brief) == "turn x3 left | flat"
    assert brief.confidence <= 0.5


def test_a_road_that_denies_what_it_asks_for_is_refused() -> None:
    with pytest.raises(BriefError, match="left and right"):
        read("Eine Straße ohne Linkskurven mit zwei Linkskurven")
