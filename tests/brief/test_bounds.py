"""Bounds that words give are in the plan that is read."""

import pytest

from roadgpt.brief import read
from roadgpt.brief.normal import normal
from roadgpt.brief.plan import plan, read_plan


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        ("a bend whose radius is no larger than 20 m", "turn r=..20"),
        ("radius no larger than 20 m, left", "turn left r=..20"),
        ("no radius below 25 m", "| turns=1.. r=25.."),
        ("keine Kurve unter 30 m Radius", "| turns=1.. r=30.."),
        ("three bends, each of at most 45 degrees", "turn x3 deg=..45"),
        ("no gradient above 8 %", "| turns=1.. steepest=..8"),
        ("8 % or less, uphill", "| up turns=1.. steepest=..8"),
        ("jamais plus de 6 %", "| turns=1.. steepest=..6"),
        ("at least 40 m of straight", "straight len=40.."),
        ("mindestens 40 m gerade", "straight len=40.."),
        ("al menos 40 m de recta", "straight len=40.."),
        ("straights of 40 m or more", "straight len=40.."),
        ("40 to at most 60 m straight", "straight len=40..60"),
        ("non più di 50 m", "| turns=1.. len=..50"),
    ],
)
def test_a_bound_that_words_give_is_read(words: str, wanted: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(wanted)))


@pytest.mark.parametrize(
    ("words", "wanted"),
    [("40 m straight", "straight len=40"), ("to the right, 60 degrees or so", "turn right deg=60")],
)
def test_a_number_without_a_bound_is_exact(words: str, wanted: str) -> None:
    assert plan(normal(read(words))) == plan(normal(read_plan(wanted)))
