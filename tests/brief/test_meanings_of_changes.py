"""Words of change requests count as understood if the plan has what they usually ask for."""

import pytest

from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.used_words import understood
from roadgpt.brief.readers.model.vocabulary import tokens_of
from roadgpt.learn.pair import Pair
from roadgpt.learn.word_meanings import word_meanings

MEANINGS = {
    "radius": ("radius",),
    "shorten": ("length", "straight"),
    "remove": ("remove",),
    "tighter": ("less", "radius"),
    "touch": ("all",),
}


@pytest.mark.parametrize(
    ("words", "plan", "wanted"),
    [
        ("set the radius of turn 2 to 20 m", "turn 2: radius =20", {"radius"}),
        ("shorten straight 1 to 20 m", "straight 1: length =20", {"shorten"}),
        ("shorten straight 1, remove turn 2", "straight 1: length less", {"shorten"}),
        ("remove turn 2, and do not touch the radius", "turn 2: remove", {"remove"}),
        ("turn 2 tighter, don't remove turn 3", "turn 2: radius less", {"tighter"}),
        ("shorten straight 1 and shorten straight 2", "straight 1: length less", set()),
    ],
)
def test_what_a_plan_of_changes_has_is_understood(words: str, plan: str, wanted: set[str]) -> None:
    text = slotted(words, is_change=True)
    tokens = tokens_of(plan, text.slots)
    assert tokens is not None
    found = understood(text, tokens, range(len(text.words)), MEANINGS)
    assert {
        text.words[place].text for place in found if text.words[place].text in {*MEANINGS, "not"}
    } == wanted


def test_meanings_of_changes_are_counted_apart_from_those_of_descriptions() -> None:
    changes = [Pair(f"zig {n}", "turn 2: radius less", "a", "en", is_change=True) for n in range(20)]
    changes += [Pair(f"zag {n}", "road: mirror", "a", "en", is_change=True) for n in range(40)]
    roads = [Pair(f"zig {n}", "crest | turns=0", "a", "en") for n in range(20)]
    roads += [Pair(f"zag {n}", "turn left", "a", "en") for n in range(40)]
    pairs = [*changes, *roads]
    assert "crest" in word_meanings(pairs)["zig"]
    of_changes = word_meanings(pairs, of_changes=True)
    assert {*of_changes["zig"]} >= {"radius", "less"}
    assert "crest" not in of_changes["zig"]
    assert "mirror" in of_changes["zag"]
