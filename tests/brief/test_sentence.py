"""A Brief says itself in a plain sentence, and its normal form is one of a kind."""

import pytest
from hypothesis import given, settings

from roadgpt.brief import (
    Amount,
    Brief,
    Clause,
    at_least,
    at_most,
    between,
    exactly,
    normal,
    sentence,
)
from strategies import briefs


@settings(deadline=None)
@given(briefs())
def test_the_normal_form_is_its_own(brief: Brief) -> None:
    assert normal(normal(brief)) == normal(brief)


@settings(deadline=None)
@given(briefs())
def test_everything_has_a_sentence(brief: Brief) -> None:
    said = sentence(brief)
    assert said.endswith(".")
    assert said[0] == "A"
    assert "None" not in said
    assert "  " not in said


@pytest.mark.parametrize(
    ("brief", "said"),
    [
        (Brief(), "A road."),
        (Brief(clauses=(Clause(kind="turn", count=exactly(3)),), slope="up"), "An uphill road with 3 turns."),
        (Brief(turns=exactly(0), slope="flat"), "A flat road; no turns."),
        (
            Brief(clauses=(Clause(kind="hairpin", side="left"), Clause(kind="straight", length=exactly(60)))),
            "A road with a left hairpin, then a straight of 60 metres.",
        ),
        (
            Brief(clauses=(Clause(kind="u_turn"),), length=exactly(250), hard=True),
            "A 250 metre road with a U-turn; hard for a lane keeper.",
        ),
        (
            Brief(clauses=(Clause(kind="s_bend", sharpness="gentle", count=exactly(2)),), climb=exactly(-6)),
            "A road with 2 gentle S-bends; a net drop of 6 metres.",
        ),
    ],
)
def test_the_words_are_plain(brief: Brief, said: str) -> None:
    assert sentence(brief) == said


TURN, LEFT, RIGHT = Clause(kind="turn"), Clause(kind="turn", side="left"), Clause(kind="turn", side="right")


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (Brief(clauses=(TURN, TURN, TURN)), Brief(clauses=(TURN.model_copy(update={"count": exactly(3)}),))),
        (Brief(turns=exactly(3)), Brief(clauses=(TURN.model_copy(update={"count": exactly(3)}),))),
        (Brief(), Brief(turns=at_least(1))),
        (Brief(words="a", unused=("b",), confidence=0.5), Brief(words="c")),
        (Brief(clauses=(LEFT,), turns=exactly(1), left=exactly(1), right=exactly(0)), Brief(clauses=(LEFT,))),
        (
            Brief(clauses=(Clause(kind="turn", slope="steeply_up", incline=exactly(9)),)),
            Brief(clauses=(Clause(kind="turn", incline=exactly(9)),)),
        ),
        (Brief(clauses=(Clause(kind="turn", slope="up"),), slope="up"), Brief(clauses=(TURN,), slope="up")),
        (
            Brief(clauses=(Clause(kind="turn", count=exactly(3), side="left", alternating=True),)),
            Brief(clauses=(LEFT, RIGHT, LEFT)),
        ),
        (
            Brief(clauses=(Clause(kind="serpentine", count=at_least(4), alternating=True),)),
            Brief(clauses=(Clause(kind="serpentine"),)),
        ),
        (
            Brief(clauses=(TURN, Clause(kind="straight")), sharpness="sharp"),
            Brief(clauses=(Clause(kind="turn", sharpness="sharp"), Clause(kind="straight"))),
        ),
        (
            Brief(clauses=(Clause(kind="turn", count=exactly(3)),), ends=LEFT),
            Brief(clauses=(Clause(kind="turn", count=exactly(2)), LEFT)),
        ),
        (
            Brief(clauses=(Clause(kind="straight"),)),
            Brief(clauses=(Clause(kind="straight"),), turns=exactly(0)),
        ),
    ],
)
def test_same_meaning_same_normal_form(one: Brief, other: Brief) -> None:
    assert normal(one) == normal(other)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (Brief(turns=exactly(3)), Brief(turns=at_least(3))),
        (Brief(clauses=(LEFT, RIGHT)), Brief(clauses=(RIGHT, LEFT))),
        (Brief(clauses=(LEFT, LEFT)), Brief(clauses=(LEFT, RIGHT))),
        (Brief(slope="up"), Brief(slope="gently_up")),
        (Brief(clauses=(TURN,)), Brief(clauses=(Clause(kind="hairpin"),))),
        (Brief(turns=between(2, 3)), Brief(turns=between(2, 4))),
        (Brief(clauses=(TURN,), hard=True), Brief(clauses=(TURN,))),
        (Brief(clauses=(Clause(kind="straight"), TURN)), Brief(clauses=(TURN, Clause(kind="straight")))),
    ],
)
def test_other_meaning_other_normal_form(one: Brief, other: Brief) -> None:
    assert normal(one) != normal(other)


@pytest.mark.parametrize(
    ("amount", "said"),
    [
        (at_most(1), "at most 1 right turn in all"),
        (at_least(1), "at least 1 right turn in all"),
        (at_most(2), "at most 2 right turns in all"),
        (between(1, 2), "1 to 2 right turns in all"),
    ],
)
def test_one_of_a_thing_is_singular(amount: Amount, said: str) -> None:
    assert said in sentence(Brief(turns=exactly(3), right=amount))
