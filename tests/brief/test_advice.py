"""What the reader says of words that it cannot read, and of wishes that exclude each other."""

import pytest

from roadgpt.brief.grammar.lexicon import similar
from roadgpt.brief.readers.grammar import GrammarReader
from roadgpt.errors import BriefError


@pytest.mark.parametrize(
    ("words", "advice"),
    [
        ("threee trns uphil", "'trns' is not understood; did you mean 'turns'"),
        ("3 rught trns", "did you mean"),
        ("first half flat, second half uphill", "give each part a length"),
        ("ends where it starts", "ask for a U-turn instead"),
        ("a flat road with a steep climb", "say the slope of each part"),
        ("a mostly flat road with one steep climb", "say the slope of each part"),
        ("a flat road with a steep climb at the end", "say the slope of each part"),
        ("1000000 turns", "1,000,000 of one kind"),
    ],
)
def test_refusals_say_what_to_do(words: str, advice: str) -> None:
    with pytest.raises(BriefError) as refusal:
        GrammarReader().read(words)
    assert advice in str(refusal.value)


@pytest.mark.parametrize(
    "words",
    [
        "a flat straight, then a steep climb, then a flat straight",  # as the advice has it
        "flat for 100 m, then uphill for 100 m",
    ],
)
def test_advice_can_be_followed(words: str) -> None:
    assert GrammarReader().read(words).unused == ()


@pytest.mark.parametrize(("word", "meant"), [("trns", "turns"), ("hairpn", "hairpin"), ("xyzzy", None)])
def test_similar_words(word: str, meant: str | None) -> None:
    assert similar(word) == meant


@pytest.mark.parametrize(
    ("words", "unused"),
    [
        ("3 turns, the last one tighter", ("tighter",)),
        ("an icy road with 3 turns", ("icy",)),
        ("a snowy downhill road", ("snowy",)),
        ("two bends back to back", ("back", "to", "back")),
        ("a constant-radius left turn", ("constant", "radius")),
        ("4 turns, increasingly sharp", ("increasingly", "sharp")),
        ("6 turns, the radii getting tighter", ("getting", "tighter")),
        ("a road that turns 300 degrees in total", ("300", "degrees", "in", "total")),
    ],
)
def test_nothing_that_changes_the_road_is_dropped(words: str, unused: tuple[str, ...]) -> None:
    assert GrammarReader().read(words).unused == unused
