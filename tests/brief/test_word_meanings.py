"""Which words a plan has understood although it would be the same without them."""

import pytest

from roadgpt.brief.plan import read_plan
from roadgpt.brief.readers.model import ModelReader
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.used_words import understood, with_groups
from roadgpt.brief.readers.model.vocabulary import tokens_of
from roadgpt.learn.pair import Pair
from roadgpt.learn.word_meanings import filler_words, word_meanings

MEANINGS = {
    "lights": frozenset({"lights"}),
    "left": frozenset({"left"}),
    "priority": frozenset({"priority", "yield"}),
    "line": frozenset({"centre="}),
    "fork": frozenset({"y_junction"}),
    "turning": frozenset({"@take"}),
    "long": frozenset({"long"}),
}


def covered(words: str, plan: str) -> set[str]:
    """The words that count as understood if the plan depends on none of them."""
    text = slotted(words)
    assert read_plan(plan)
    places = understood(text, tokens_of(plan, text.slots) or (), range(len(text.words)), MEANINGS)
    return {text.words[place].written for place in places}


@pytest.mark.parametrize(
    ("words", "plan", "wanted"),
    [
        ("a road 900 m long", "| len=900", {"long"}),
        ("a straight 900 m long and another long one", "straight len=900; straight", {"long"}),
        ("a long straight, a left of 80 degrees", "straight; turn left deg=80", {"left"}),
        ("a road 900 m long", "straight long", {"long"}),
        ("a long straight on a road of 900 m", "straight | len=900", set()),
        ("the lights of a crossroads", "crossroads lights", {"lights"}),
        ("the lights of a crossroads", "crossroads", set()),
        ("left, and left again", "crossroads left", set()),
        ("left, and left again", "crossroads left // crossroads left", {"left"}),
        ("a crossroads without lights", "crossroads", {"without", "lights"}),
        ("a crossroads without lights", "crossroads lights", set()),
        ("a road without a line", "crossroads", set()),
        ("a road without a line", "crossroads // | centre=none", {"without", "line"}),
        ("no priority at the crossroads", "crossroads yield", {"no", "priority"}),
        ("I have priority", "crossroads", set()),
        ("turning at four arms", "crossroads right", {"turning", "four"}),
        ("turning at five arms", "crossroads right", {"turning"}),
        ("two forks", "y_junction // y_junction", {"two"}),
        ("two of them", "y_junction // y_junction // y_junction", set()),
        ("5 arms", "star arms=5", {"5"}),
        ("8 of them: 4 hairpins, 4 gentle ones", "hairpin x4; turn x4 gentle", {"8", "4"}),
        ("8 of them: 4 hairpins, 5 gentle ones", "hairpin x4; turn x5 gentle", {"4", "5"}),
        (
            "6 of them, 3 left, 3 right",
            "turn x2 left; straight; turn x3 right; turn left",
            {"6", "3", "left"},
        ),
        ("3 bends and 2 straights, 5 things", "turn x3; straight x2", {"3", "2"}),
        ("1 bend, 2 bends", "turn; straight; turn | turns=2", {"1", "2"}),
    ],
)
def test_what_a_plan_has_is_understood(words: str, plan: str, wanted: set[str]) -> None:
    assert covered(words, plan) == wanted


def test_a_group_counts_each_of_its_tokens() -> None:
    found = with_groups(["crossroads", "left", "//", "roundabout", "exit=", "2"])
    assert (found["@take"], found["@junction"], found["//"]) == (2, 2, 1)


def test_meanings_are_what_plans_have_where_the_words_occur() -> None:
    zebras = [Pair(f"zig {n}", "crossroads lights", "a", "en") for n in range(20)]
    others = [Pair(f"zag {n}", "turn left", "a", "en") for n in range(80)]
    both = [Pair(f"hm zig {n}", "crossroads lights", "a", "en") for n in range(10)]
    both += [Pair(f"hm zag {n}", "turn left", "a", "en") for n in range(40)]
    found = word_meanings([*zebras, *others, *both])
    assert found["zig"] == ["crossroads", "lights"]
    assert "hm" not in found
    assert "hm" in filler_words([*zebras, *others, *both])
    assert "zig" not in filler_words([*zebras, *others, *both])


def test_no_words_are_named_where_a_plan_has_all_that_is_said() -> None:
    reader = ModelReader()
    for words in ("a crossroads with lights, turn left", "an der Kreuzung mit Ampel biege ich links ab"):
        assert reader.read(words).unused == ()
