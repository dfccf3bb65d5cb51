"""Bounds that words say, and those that a plan has."""

import pytest

from roadgpt.brief.readers.model.bounds import bound_before, bounded
from roadgpt.brief.readers.model.slots import slotted
from roadgpt.brief.readers.model.vocabulary import plan_of


def said(text: str) -> str | None:
    words = [word.text for word in slotted(text).words]
    return bound_before(words, next(at for at, word in enumerate(words) if word.startswith("[unused1]")))


@pytest.mark.parametrize(
    ("text", "bound"),
    [
        ("a bend whose radius is no larger than 20 m", "hi"),
        ("no radius below 25 m", "lo"),
        ("nowhere steeper than 8 %, and nothing above 6 percent", None),
        ("no gradient above 8 %", "hi"),
        ("at least 40 m of straight", "lo"),
        ("at most 45 degrees", "hi"),
        ("a radius of at least 30 m", "lo"),
        ("the others stay below 90 degrees", "hi"),
        ("keine Kurve unter 30 m Radius", "lo"),
        ("mindestens 40 m gerade", "lo"),
        ("jamais plus de 6 %", "hi"),
        ("al menos 40 m de recta", "lo"),
        ("non più di 50 m", "hi"),
        ("straight over 60 m", None),
        ("more than 8 % breaks the engine", None),
        ("free of radii under 50 m", None),
        ("40 m straight", None),
    ],
)
def test_what_words_before_a_number_say(text: str, bound: str | None) -> None:
    assert said(text) == bound


@pytest.mark.parametrize(
    ("words", "tokens", "plan"),
    [
        ("radius no larger than 20 m, left", ["turn", "left", "r=", "[1]", ".."], "turn left r=..20"),
        ("each below 90 degrees", ["turn", "deg=", "[1]"], "turn deg=..90"),
        ("no radius below 25 m", ["turn", "r=", "..", "[1]"], "turn r=25.."),
        ("40 to at most 60 m straight", ["straight", "len=", "[1]", "..", "[2]"], "straight len=40..60"),
        ("straights of 40 m or more", ["straight", "len=", "[1]"], "straight len=40.."),
        ("to the right, 60 degrees or so", ["turn", "right", "deg=", "[1]", ".."], "turn right deg=60"),
        ("8 % or less, uphill", ["|", "steepest=", "[1]"], "| steepest=..8"),
        ("falls by at least 8 m", ["turn", "|", "climb=", "-", "[1]"], "turn | climb=-8"),
        ("straight over 60 m", ["straight", "len=", "[1]"], "straight len=60"),
    ],
)
def test_a_plan_takes_the_bound_that_was_said(words: str, tokens: list[str], plan: str) -> None:
    text = slotted(words)
    assert plan_of(bounded(tokens, text), text.slots) == plan
